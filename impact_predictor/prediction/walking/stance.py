"""Which points of the feet stand, from their gaps and velocities; what a planner and force sensors say of it.

Neither of these decides a stance: landings are compared with a schedule, and a force confirms them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import sqrt

from ...stamps import NANOSECONDS
from ..checks import LARGEST, PAUSE, order_of
from ..planar import hardly
from ..scene import Scene, Walking
from ..types import Schedule, Status, Wrench
from ..vectors import dot, total
from .cubic import GapNoise, PointFrame
from .trajectory import DescentPrior

LEAST = 1e-5
"""Noise of a gap in m below which none counts: by so much a planned course differs from a cubic over few frames ..."""

LEAST_RATE = 2e-4
"""... and its rate by so much, in m/s."""

GUESS = 0.2
"""Until feet have stood their gaps are taken to scatter by this part of the contact tolerance ..."""

GUESS_RATE = 0.02
"""... and the rates of those by so much, in m/s."""

DRIFT = 1.0
"""Contact tolerances in a second by which a standing foot may shift the level, which follows an estimator's drift."""

MEMORY = 100
"""Frames of standing feet over which level and noise are averaged."""

FEWEST = 10
"""... and from how many on that is believed."""

FAR = 3.0
"""A point was off the ground when its gap was so many standard deviations above it."""

LONGEST = 10_000_000_000
"""ns for which what was planned is remembered."""

FURTHEST = 1_000_000_000
"""ns from a planned landing beyond which a landing is another one, which nobody planned."""


class Ground:
    """The level at which feet stand and the noise of their gaps, as the standing ones show both."""

    def __init__(self, scene: Scene) -> None:
        self.level = 0.0
        self.noise = GapNoise(GUESS * scene.tolerance, GUESS_RATE)
        self.prior = DescentPrior()
        self._tolerance = scene.tolerance
        self._seen = 0
        self._square = self._square_rate = 0.0

    def add(self, frame: PointFrame, before: PointFrame) -> None:
        """Take two frames of a standing point that follow each other."""
        self._seen = min(self._seen + 1, MEMORY)
        share = 1.0 / self._seen
        # The height of a base drifts, and the ground that its feet show with it.
        limit = self._tolerance
        if self._seen > FEWEST:
            limit *= DRIFT * abs(frame.stamp - before.stamp) / NANOSECONDS
        self.level += max(-limit, min(share * (frame.gap - self.level), limit))
        # Differences of two frames leave the motion of the base's drift out, and have twice the square of the noise.
        self._square += share * (0.5 * (frame.gap - before.gap) ** 2 - self._square)
        rate = self.noise.rate
        if frame.rate is not None:
            self._square_rate += share * (frame.rate**2 - self._square_rate)
            rate = max(LEAST_RATE, sqrt(self._square_rate))
        if self._seen >= FEWEST:
            self.noise = GapNoise(max(LEAST, sqrt(self._square)), rate)


class StanceDetector:
    """Whether one point stands. A change is believed when it has lasted for the dead time.

    A point comes to stand when it has stayed within the contact tolerance above the ground and has hardly moved; it
    stands until it has stayed further away.
    """

    def __init__(self, scene: Scene, dead_time: int) -> None:
        """Believe changes of a point of a scene after a `dead_time` in ns."""
        self.stands = False
        self.since = 0
        self._dead_time = dead_time
        self._tolerance = scene.tolerance
        self._slow = hardly(scene)
        self._begun = False
        self._other: int | None = None

    def update(self, frames: Sequence[PointFrame], ground: Ground, awaited: bool = False) -> bool:
        """Whether the last of the frames changes the stance; not to standing while that is still `awaited`."""
        frame = frames[-1]
        near = frame.gap - ground.level <= self._tolerance
        if not self._begun:
            self._begun = True
            self.stands = near and (frame.rate is None or abs(frame.rate) <= self._slow + 3.0 * ground.noise.rate)
            return False
        if near is self.stands:
            self._other = None
            return False
        if self._other is None:
            self._other = frame.stamp
        if frame.stamp - self._other < self._dead_time or (near and (awaited or not self._rests(frames, ground.noise))):
            return False
        self.stands, self.since, self._other = near, self._other if near else self._left(frames, ground), None
        return True

    def _left(self, frames: Sequence[PointFrame], ground: Ground) -> int:
        """The stamp in ns of the last frame in which the point was on the ground: the tolerance is left later."""
        since = frames[-1].stamp
        for frame in reversed(frames):
            since = frame.stamp
            if since < self.since or frame.gap - ground.level <= FAR * ground.noise.gap:
                break
        return max(since, self.since)

    def _rests(self, frames: Sequence[PointFrame], noise: GapNoise) -> bool:
        """Whether the point has hardly moved along the normal within the dead time."""
        begin = frames[-1].stamp - self._dead_time
        lasted = [frame for frame in frames if frame.stamp >= begin]
        count = len(lasted)
        if count < 2:
            lasted, count = list(frames)[-2:], 2
        rates = [frame.rate for frame in lasted if frame.rate is not None]
        if rates:
            return abs(total(rates)) / len(rates) <= self._slow + 3.0 * noise.rate / sqrt(len(rates))
        half = count // 2
        late, early = lasted[-half:], lasted[:half]
        span = (sum([f.stamp for f in late]) - sum([f.stamp for f in early])) / half / NANOSECONDS
        rise = (total([f.gap for f in late]) - total([f.gap for f in early])) / half
        return abs(rise) <= self._slow * span + 3.0 * noise.gap * sqrt(2.0 / half)


class LandingSchedule:
    """The planned landings of some feet; a schedule replaces what was planned from its first time on."""

    def __init__(self, feet: Sequence[str]) -> None:
        self._stances: dict[str, list[tuple[int, bool]]] = {foot: [] for foot in feet}
        self._landings: dict[str, list[int]] = {foot: [] for foot in feet}

    def set(self, schedule: Schedule) -> Status:
        """Take a schedule; what became of it."""
        times = schedule.times
        if not set(schedule.feet) <= set(self._stances):
            return Status.FEET_CHANGED
        if any(b <= a for a, b in pairwise(times)) or len(schedule.stands) != len(times):
            return Status.MALFORMED
        if any(len(stands) != len(schedule.feet) for stands in schedule.stands):
            return Status.MALFORMED
        if not times:
            return Status.ACCEPTED
        for number, foot in enumerate(schedule.feet):
            kept = [one for one in self._stances[foot] if times[0] - LONGEST < one[0] < times[0]]
            following = [(time, stands[number]) for time, stands in zip(times, schedule.stands, strict=True)]
            # Planners tell the same stance again and again: only its changes are kept.
            told = [*kept, *following]
            planned = told[:1] + [one for before, one in pairwise(told) if one[1] is not before[1]]
            self._stances[foot] = planned
            self._landings[foot] = [time for (_, before), (time, now) in pairwise(planned) if now and not before]
        return Status.ACCEPTED

    def late(self, foot: str, stamp: int) -> float | None:
        """How much later than planned, in s, a foot lands at a stamp in ns; None where none is planned near it."""
        late = min([stamp - planned for planned in self._landings[foot]], key=abs, default=None)
        return None if late is None or abs(late) > FURTHEST else late / NANOSECONDS


class FootForces:
    """The last force on each foot of a machine."""

    def __init__(self, walking: Walking) -> None:
        self._feet = walking.feet
        self._least = walking.force**2
        self._timeout = round(walking.timeout * NANOSECONDS)
        self._pressed: dict[str, tuple[int, bool]] = {}

    def set(self, wrench: Wrench) -> Status:
        """Take the force on a foot; what became of the message."""
        foot, square = wrench.frame_id, dot(wrench.force, wrench.force)
        if foot not in self._feet:
            return Status.WRONG_FRAME
        if not square < LARGEST:
            return Status.NOT_FINITE
        last = self._pressed[foot][0] if foot in self._pressed else None
        status = order_of(wrench.stamp, last)
        if status is Status.ACCEPTED:
            self._pressed[foot] = wrench.stamp, square >= self._least
        elif last is not None and last - wrench.stamp > PAUSE:
            del self._pressed[foot]
        return status

    def agree(self, foot: str, stands: bool, stamp: int) -> bool | None:
        """Whether the sensor of a foot shows the same stance near a stamp in ns; None where it shows nothing then."""
        pressed = self._pressed.get(foot)
        if pressed is None or abs(stamp - pressed[0]) > self._timeout:
            return None
        return pressed[1] is stands
