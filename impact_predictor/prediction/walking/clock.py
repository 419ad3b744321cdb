"""By how much the stamps of the feet are later than those of the trunk, as standing feet show it: `FeetClock`."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from math import hypot, sqrt
from typing import Final, NamedTuple

from ...stamps import NANOSECONDS
from ..types import Sample, Vector3
from ..vectors import add, axes_of, cross, dot, lines, to_body, total
from .stance import FootPoint

APART: Final = 4_000_000  # ns between the frames that are looked at: more of them cost more than they tell
LONGEST: Final = 80  # frames after which a stance is taken to be another one ...
FEWEST: Final = 8  # ... and that it has at least
ENOUGH: Final = 8  # stances from which on the delay is told
MEMORY: Final = 100  # stances over which it is averaged
LEAST: Final = 2.5e-3  # s: below that it may be feet that yield or bounce a little, which move with the trunk ...
CLOSER: Final = 0.5e-3  # ... but a delay that is there is worth to be taken out better than that
SURE: Final = 3.0  # standard deviations that tell a delay from what is taken out


class Delay(NamedTuple):
    """How much later the feet are, the standard deviation of that, and how much of it is taken out, in s."""

    time: float
    deviation: float
    taken: float = 0.0

    def __str__(self) -> str:
        way = "later" if self.time >= 0.0 else "earlier"
        return f"{1e3 * abs(self.time):.1f} +- {1e3 * self.deviation:.1f} ms {way} than the trunk"


class FeetClock:
    """How much later than the trunk feet are stamped, as their points show while they stand.

    A standing point does not rise. Placed by a base that is d s too late it seems to, by d times the velocity u that a
    point fixed to the base would have there (first order in d): d is the slope of its height over u within a stance.
    A straight line in time is taken out of both before, for odometry drifts; along the ground feet roll and slip. Noise
    of u would flatten the slope, so that the u of the frame before stands for it, whose noise is another one (a lagged
    instrumental variable; Reiersol, Econometrica 9 (1941) 1-24). The deviation is that between stances, and half of how
    much their first halves differ from their second ones: a foot that yields or bounces shows in one of them.
    """

    def __init__(self, points: int, normal: Vector3, dead_time: int, delay: float) -> None:
        """Watch some `points` over a ground with a `normal`; their frames `dead_time` ns near a change tell nothing.

        A `delay` in s is taken out from the beginning.
        """
        self.taken = delay
        """The delay in s that is taken out of the stamps."""
        self.left = 0.0
        """How much in s the stamps of the feet are surely off all the same."""
        self._normal, self._dead_time = normal, dead_time
        self._frames: list[list[tuple[int, float, float]]] = [[] for _ in range(points)]
        self._seen = self._stances = 0
        # Sums over stances of n, m, n^2, n m, m^2, where n / m is the slope, and of n and m in the first halves.
        self._sums = [0.0] * 7

    @property
    def delay(self) -> Delay | None:
        """How much later the feet are; None until enough stances have shown it."""
        n, m, nn, nm, mm, n1, m1 = self._sums
        if self._stances < ENOUGH or not 0.0 < m1 < m:
            return None
        time = n / m
        apart = n1 / m1 - (n - n1) / (m - m1)
        return Delay(time, hypot(sqrt(max(0.0, nn - 2.0 * time * nm + time * time * mm)) / m, 0.5 * apart), self.taken)

    @property
    def is_wrong(self) -> bool:
        """Whether the feet are surely later or earlier than what is taken out of their stamps."""
        delay = self.delay
        least = CLOSER if self.taken else LEAST
        return delay is not None and abs(delay.time - self.taken) > max(least, SURE * delay.deviation)

    def follow(self, other: FeetClock) -> None:
        """Take over what another one of the same points has learnt."""
        self._stances, self._sums = other._stances, other._sums

    def begin(self) -> None:
        """Begin anew with frames; what stances have shown stays."""
        for frames in self._frames:
            frames.clear()

    def correct(self) -> bool:
        """Take out what is known of the delay; whether that is something else than before."""
        delay = self.delay
        if delay is None or not self.is_wrong:
            return False
        self.taken, self.left = delay.time, 0.0
        return True

    def see(self, base: Sample, arms: Sequence[Vector3], points: Sequence[FootPoint]) -> None:
        """Take the last frames of the points, which lie at their `arms` (m) from the origin of the base."""
        stamp = base.stamp
        if 0 <= stamp - self._seen < APART:
            return
        self._seen = stamp
        normal = to_body(axes_of(base.orientation), self._normal)
        for i, point in enumerate(points):
            frames = self._frames[i]
            if not point.stands:
                if frames:
                    self._end(i, point.since)
                    frames.clear()
            elif stamp >= point.since + self._dead_time:
                swept = add(base.linear, cross(base.angular, arms[i]))
                frames.append((stamp, point.trajectory.frames[-1].gap, dot(normal, swept)))
                if len(frames) >= LONGEST:
                    self._end(i, stamp - self._dead_time)

    def _end(self, i: int, stamp: int) -> None:
        """Learn from the frames of a point up to a dead time before a stamp in ns."""
        frames = [frame for frame in self._frames[i] if frame[0] <= stamp - self._dead_time]
        del self._frames[i][: len(frames)]
        if len(frames) < FEWEST:
            return
        stamps, gaps, speeds = zip(*frames, strict=True)
        times = [(one - stamps[0]) / NANOSECONDS for one in stamps[1:]]
        columns = [one - gaps[0] for one in gaps[1:]], speeds[1:], speeds[:-1]
        off = [
            [one - now - rate * time for one, time in zip(column, times, strict=True)]
            for column, (now, rate) in zip(columns, lines(times, columns), strict=True)
        ]
        n, m = (list(map(operator.mul, off[2], one)) for one in off[:2])
        half = len(n) // 2
        m1, m2 = total(m[:half]), total(m[half:])
        n1, n2 = total(n[:half]) + self.taken * m1, total(n[half:]) + self.taken * m2
        n12, m12 = n1 + n2, m1 + m2
        self._stances += 1
        share = 1.0 - 1.0 / MEMORY
        new = n12, m12, n12 * n12, n12 * m12, m12 * m12, n1, m1
        self._sums = [share * old + one for old, one in zip(self._sums, new, strict=True)]
        delay = self.delay
        self.left = abs(delay.time - self.taken) if delay is not None and self.is_wrong else 0.0
