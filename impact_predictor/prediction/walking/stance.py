"""Which points of the feet stand, from their gaps and velocities alone."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from ..planar import hardly
from ..scene import Scene
from .cubic import NANOSECONDS, Frame, Noise

LEAST = 1e-7
"""Noise of a gap in m below which no record is: what a float32 leaves of a leg."""

LEAST_RATE = 1e-6
"""... and that of its rate, in m/s."""

GUESS = 0.2
"""Until feet have stood their gaps are taken to scatter by this part of the contact tolerance ..."""

GUESS_RATE = 0.02
"""... and the rates of those by so much, in m/s."""

MEMORY = 100
"""Frames of standing feet over which level and noise are averaged."""

FEWEST = 10
"""... and from how many on that is believed."""

STILL = 0.1
"""A gap is the same when it differs by less than this part of the contact tolerance, besides its noise."""


class Ground:
    """The level at which feet stand and the noise of their gaps, as the standing ones show both."""

    def __init__(self, scene: Scene) -> None:
        self.level = 0.0
        self.noise = Noise(GUESS * scene.tolerance, GUESS_RATE)
        self._tolerance = scene.tolerance
        self._seen = 0
        self._square = self._square_rate = 0.0

    def add(self, frame: Frame, before: Frame) -> None:
        """Take two frames of a standing point that follow each other."""
        self._seen = min(self._seen + 1, MEMORY)
        share = 1.0 / self._seen
        level = self.level + share * (frame.gap - self.level)
        self.level = max(-self._tolerance, min(level, self._tolerance))
        # Differences of two frames leave the motion of the base's drift out, and have twice the square of the noise.
        self._square += share * (0.5 * (frame.gap - before.gap) ** 2 - self._square)
        rate = self.noise.rate
        if frame.rate is not None:
            self._square_rate += share * (frame.rate**2 - self._square_rate)
            rate = max(LEAST_RATE, sqrt(self._square_rate))
        if self._seen >= FEWEST:
            self.noise = Noise(max(LEAST, sqrt(self._square)), rate)


class Stance:
    """Whether one point stands. A change is believed when it has lasted for the dead time.

    A point comes to stand when it has stayed within the contact tolerance above the ground and has hardly moved; it
    stands until it has stayed further away.
    """

    def __init__(self, scene: Scene) -> None:
        assert scene.walking is not None
        self.stands = False
        self.since = 0
        self._dead_time = round(scene.walking.dead_time * NANOSECONDS)
        self._tolerance = scene.tolerance
        self._slow = hardly(scene)
        self._begun = False
        self._other: int | None = None

    def update(self, frames: Sequence[Frame], ground: Ground, awaited: bool = False) -> bool:
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
        self.stands, self.since, self._other = near, self._came(frames, ground.noise) if near else self._other, None
        return True

    def _came(self, frames: Sequence[Frame], noise: Noise) -> int:
        """The stamp in ns from which on the gap is what it is now."""
        gap, since = frames[-1].gap, frames[-1].stamp
        for frame in reversed(frames):
            if abs(frame.gap - gap) > STILL * self._tolerance + 3.0 * noise.gap:
                break
            since = frame.stamp
        return since

    def _rests(self, frames: Sequence[Frame], noise: Noise) -> bool:
        """Whether the point has hardly moved along the normal within the dead time."""
        begin = frames[-1].stamp - self._dead_time
        lasted = [frame for frame in frames if frame.stamp >= begin]
        count = len(lasted)
        if count < 2:
            lasted, count = list(frames)[-2:], 2
        rates = [frame.rate for frame in lasted if frame.rate is not None]
        if rates:
            return abs(sum(rates)) / len(rates) <= self._slow + 3.0 * noise.rate / sqrt(len(rates))
        half = count // 2
        late, early = lasted[-half:], lasted[:half]
        span = (sum([f.stamp for f in late]) - sum([f.stamp for f in early])) / half / NANOSECONDS
        rise = (sum([f.gap for f in late]) - sum([f.gap for f in early])) / half
        return abs(rise) <= self._slow * span + 3.0 * noise.gap * sqrt(2.0 / half)
