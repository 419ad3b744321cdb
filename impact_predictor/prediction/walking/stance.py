"""A point of a foot: whether it stands, as its gaps and velocities tell, and the landing that it announces."""

from __future__ import annotations

from collections import deque
from math import sqrt
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..planar import hardly
from ..scene import Scene
from ..types import Vector3
from ..vectors import add, dot, total
from .cubic import Fit, GapNoise, PointFrame
from .trajectory import NEAREST, Arrival, ArrivalFit, DescentPrior, FootTrajectory

LEAST = GapNoise(gap=1e-5, rate=2e-4)  # by so much a planned course differs from a cubic over few frames: no noise
GUESS = 0.2  # until feet have stood their gaps are taken to scatter by this part of the contact tolerance ...
GUESS_RATE = 0.02  # ... and the rates of those by so much, in m/s
DRIFT = 1.0  # contact tolerances in a second by which a standing foot may shift the level: an estimator's drift
MEMORY = 100  # frames of standing feet over which level and noise are averaged ...
FEWEST = 10  # ... and from how many on that is believed
FAR = 3.0  # a point was off the ground when its gap was so many standard deviations above it
SETTLED = (
    3  # a frame shows the ground when the point is still near it, and has not begun to lift, so many dead times later
)

# A landing is announced when it is no further ahead than so many times as long as the point has descended: from less
# the cubic of a foot that need not follow one tells nothing.
AHEAD = 1.5
SOON = 0.5  # ... where noise leaves doubt that it lands at all
LASTS = 0.8  # ... once it has shown in every sample for the dead time


class Ground:
    """The level at which feet stand and the noise of their gaps, as the standing ones show both."""

    def __init__(self, scene: Scene) -> None:
        self.level = 0.0
        self.noise = GapNoise(GUESS * scene.tolerance, GUESS_RATE)
        self.prior = DescentPrior()
        self._tolerance = scene.tolerance
        self._seen = 0
        self._square = self._square_rate = 0.0

    def is_near(self, frame: PointFrame) -> bool:
        """Whether a point is within the contact tolerance above the ground."""
        return frame.gap - self.level <= self._tolerance

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
            rate = max(LEAST.rate, sqrt(self._square_rate))
        if self._seen >= FEWEST:
            self.noise = GapNoise(max(LEAST.gap, sqrt(self._square)), rate)


class ExpectedLanding(NamedTuple):
    """A landing that is announced: `stamp` in ns, and where and how fast the point will be then (m, m/s)."""

    stamp: int
    position: Vector3
    velocity: Vector3


class FootPoint:
    """A point of a foot: its trajectory, whether it stands, and the landing that it announces.

    A change of the stance is believed when it has lasted for the dead time. A point comes to stand when it has stayed
    within the contact tolerance above the ground and has hardly moved; it stands until it has stayed further away.
    """

    def __init__(self, scene: Scene, dead_time: int) -> None:
        """Follow a point of a scene; `dead_time` in ns."""
        self.trajectory = FootTrajectory()
        self.stands = False
        self.since = 0
        """Stamp in ns of the last change of the stance, 0 where there was none."""
        self.due: ExpectedLanding | None = None
        """The landing last announced, until the point stands or the announcement is withdrawn."""
        self.arrival: Arrival | None = None
        """How the point came to stand last."""
        self.closed = False
        """Whether it was to land by now and is near the ground: it stands, though not yet for the dead time."""
        self._scene, self._slow = scene, hardly(scene)
        self._dead_time = dead_time
        # Stamps in ns since when the other stance shows, the announcement is in doubt, and a landing shows.
        self._other: int | None = None
        self._doubted: int | None = None
        self._shown: int | None = None
        self._last: Fit | None = None
        self._arriving: ArrivalFit | None = None
        self._standing: deque[PointFrame] = deque()

    @property
    def landed(self) -> int | None:
        """Stamp in ns since which it stands, or has just closed, if it does."""
        if self.stands:
            return self.since
        return self.due.stamp if self.closed and self.due is not None else None

    @property
    def lands(self) -> int | None:
        """Stamp in ns at which it lands, as announced, or has landed."""
        return self.landed if self.due is None else self.due.stamp

    def stood(self, stamp: int) -> bool:
        """Whether it stood at a stamp in ns, as its last change tells."""
        landed = self.landed
        return self.since > stamp if landed is None else landed <= stamp

    def add(self, frame: PointFrame, ground: Ground) -> bool:
        """Take the next frame; whether the point has come to stand.

        A foot that brakes before it lands seems to rest before it does: while its landing is surely ahead it swings.
        """
        trajectory, near = self.trajectory, ground.is_near(frame)
        trajectory.frames.append(frame)
        awaited = self.due is not None and self._doubted is None and self.due.stamp > frame.stamp
        changed = self._changes(ground, awaited)
        if not near:
            self._arriving = None
        elif (self._arriving is None or not self._arriving.add(frame)) and (changed or not self.stands):
            begin = trajectory.top if self._last is None else max(trajectory.top, self._last.begin)
            frames = trajectory.last(NEAREST)
            self._arriving = ArrivalFit(frames, begin, ground.level, self._scene.tolerance, ground.noise)
        if not self.stands:
            if changed:
                self._standing.clear()
            trajectory.follow()
            return False
        if changed and self._arriving is not None:
            if self._last is not None:
                ground.prior.learn(self._last)
            self.arrival = self._arriving.arrival()
            self.since, self._last, self._arriving = self.arrival.stamp, None, None
        trajectory.rest()
        if near:
            self._standing.append(frame)
            if frame.stamp - self._standing[0].stamp > SETTLED * self._dead_time:
                ground.add(self._standing.popleft(), self._standing[0])
        self.due = self._doubted = self._shown = None
        self.closed = False
        return changed

    def revise(self, stamp: int, ground: Ground) -> ExpectedLanding | None:
        """The landing ahead of a stamp in ns."""
        if self.stands:
            return None
        trajectory, due = self.trajectory, self.due
        near = ground.is_near(trajectory.frames[-1])
        self.closed = due is not None and due.stamp <= stamp and near
        if self.closed:
            return None  # What its trajectory shows is the ground already.
        fit = trajectory.fit(ground.noise, ground.prior)
        if fit is not None and not near:
            self._last = fit
        # Near the ground it may be landing already where it breaks off its course: its last announcement stands.
        if due is None or not (near and trajectory.broke):
            self._announce(fit, stamp, near, ground)
        due = self.due
        return due if due is not None and due.stamp > stamp else None

    def _announce(self, fit: Fit | None, stamp: int, near: bool, ground: Ground) -> None:
        """Announce the landing that a fit shows, if that is sure enough, or withdraw what was announced."""
        trajectory, due = self.trajectory, self.due
        landing = None
        if fit is not None:
            landing = fit.landing(ground.level, self._scene.tolerance, self._scene.horizon)
        if fit is None or landing is None:
            self._shown = None
            if self._doubted_for(stamp):
                self.due = self._doubted = None
            return
        self._shown = stamp if self._shown is None else self._shown
        descended, wait = fit.stamp - trajectory.top, landing.time * NANOSECONDS
        sure = landing.sure and (due is not None or wait < AHEAD * descended)
        sure |= landing.precise and wait < SOON * descended
        sure |= stamp - self._shown >= self._dead_time and wait < LASTS * descended
        # So near to the ground a little noise makes the curve of a foot that brakes pass through it at once.
        leaps = near and due is not None and due.stamp - fit.stamp - wait > self._dead_time
        if sure and not (trajectory.broke or leaps):
            self._doubted = None
        elif not self._doubted_for(stamp):
            return
        position, velocity = trajectory.motion(fit, landing.time)
        velocity = add(velocity, self._scene.normal, landing.rate - dot(velocity, self._scene.normal))
        self.due = ExpectedLanding(fit.stamp + round(landing.time * NANOSECONDS), position, velocity)

    def _doubted_for(self, stamp: int) -> bool:
        """Whether what is announced has not surely shown for the dead time."""
        if self.due is None:
            return False
        if self._doubted is None:
            self._doubted = stamp
        return stamp - self._doubted >= self._dead_time

    def _changes(self, ground: Ground, awaited: bool) -> bool:
        """Whether the last frame changes the stance; not to standing while that is still `awaited`."""
        frames = self.trajectory.frames
        frame = frames[-1]
        near = ground.is_near(frame)
        if len(frames) == 1:
            self.stands = near and (frame.rate is None or abs(frame.rate) <= self._slow + 3.0 * ground.noise.rate)
            return False
        if near is self.stands:
            self._other = None
            return False
        if self._other is None:
            self._other = frame.stamp
        if frame.stamp - self._other < self._dead_time or (near and (awaited or not self._rests(ground.noise))):
            return False
        self.stands, self.since, self._other = near, self._other if near else self._left(ground), None
        return True

    def _left(self, ground: Ground) -> int:
        """The stamp in ns of the last frame in which the point was on the ground: the tolerance is left later."""
        for frame in reversed(self.trajectory.frames):
            if frame.stamp < self.since or frame.gap - ground.level <= FAR * ground.noise.gap:
                break
        return max(frame.stamp, self.since)

    def _rests(self, noise: GapNoise) -> bool:
        """Whether the point has hardly moved along the normal within the dead time."""
        frames = self.trajectory.frames
        begin = frames[-1].stamp - self._dead_time
        lasted = [frame for frame in frames if frame.stamp >= begin]
        if len(lasted) < 2:
            lasted = self.trajectory.last(2)
        rates = [frame.rate for frame in lasted if frame.rate is not None]
        if rates:
            return abs(total(rates)) / len(rates) <= self._slow + 3.0 * noise.rate / sqrt(len(rates))
        half = len(lasted) // 2
        late, early = lasted[-half:], lasted[:half]
        span = (sum([f.stamp for f in late]) - sum([f.stamp for f in early])) / half / NANOSECONDS
        rise = (total([f.gap for f in late]) - total([f.gap for f in early])) / half
        return abs(rise) <= self._slow * span + 3.0 * noise.gap * sqrt(2.0 / half)
