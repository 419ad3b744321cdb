"""How far gaps and their rates scatter in a record: what is as small cannot be told from none."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import sqrt
from typing import Final

from ..stamps import NANOSECONDS
from .checks import PAUSE
from .planar import Posture, hardly
from .scene import Scene

SLACK: Final = 3.0
"""What is less than so many standard deviations is not told from none."""

ENOUGH: Final = 100
"""Samples that tell their scatter, and gaps of standing points from which on theirs is known."""

OFTEN: Final = 10
"""After so many samples what they tell is told anew, by as many as there are until `ENOUGH` were taken."""

OF_MEDIAN: Final = 1.4826
"""Standard deviation of normal noise, by the median of its amounts."""

OF_STEP, OF_MIDDLE = sqrt(2.0), sqrt(1.5)
"""How far the difference of two numbers scatters, and that of one from the middle of two others, by each one's own."""


class Scatter:
    """The scatter of the gaps of a body's points.

    Whatever the body does, samples that follow each other tell it: by what a gap differs from what its rates have made
    of the one before, and a rate from the middle of its neighbours. Points that stand tell also what stays from sample
    to sample, as where a point is wrong on the body.
    """

    def __init__(self, scene: Scene) -> None:
        self.gap, self.rate = 0.0, 0.0
        """Differences of gaps (m) and of rates (m/s) that cannot be told from none, as far as it is known ..."""
        self.noise = 0.0
        """... and those of gaps from one sample to the next."""
        self.deviation: float | None = None
        """Standard deviation of the gaps of standing points in m, once it is known."""
        self._tolerance, self._slowest = scene.tolerance, hardly(scene)
        self._last: list[tuple[int, Posture]] = []
        self._heard = self._taken = 0
        self._steps, self._middles = deque[float](maxlen=ENOUGH), deque[float](maxlen=ENOUGH)
        self._seen, self._mean, self._squares = 0, 0.0, 0.0

    @property
    def is_known(self) -> bool:
        """Whether enough samples have shown it."""
        return self._heard >= OFTEN + 2

    def take(self, stamp: int, posture: Posture) -> None:
        """Take the next sample, with a stamp in ns."""
        self._heard += 1
        last, gaps, rates = self._last, posture.gaps, posture.rates
        last.append((stamp, posture))
        slow = max(self._slowest, self.rate)
        if all(-slow <= rate <= slow for rate in rates):
            self._stand(gaps)
        if len(last) < 3:
            return
        (first, before), (middle, between), _ = last
        del last[0]
        if not first < middle < stamp <= first + PAUSE or not len(before.gaps) == len(between.gaps) == len(gaps):
            return
        self._taken += 1
        i = self._taken % len(gaps)  # one point for each sample is enough
        step, share = (stamp - middle) / NANOSECONDS, (middle - first) / (stamp - first)
        self._steps.append(abs(gaps[i] - between.gaps[i] - 0.5 * step * (rates[i] + between.rates[i])))
        self._middles.append(abs(between.rates[i] - before.rates[i] - share * (rates[i] - before.rates[i])))
        if self._taken % OFTEN == 0:
            half = len(self._steps) // 2
            self.noise = SLACK * OF_MEDIAN / OF_STEP * sorted(self._steps)[half]
            self.rate = SLACK * OF_MEDIAN / OF_MIDDLE * sorted(self._middles)[half]
            self.gap = max(self.noise, SLACK * (self.deviation or 0.0))

    def forget(self) -> None:
        """Begin anew with the next sample; what was learnt stays known."""
        self._last.clear()

    def _stand(self, gaps: list[float]) -> None:
        """Learn from points that stand."""
        tolerance = max(self._tolerance, self.noise)
        for gap in gaps:
            if -tolerance <= gap <= tolerance:
                self._seen += 1
                change = gap - self._mean
                self._mean += change / self._seen
                self._squares += change * (gap - self._mean)
        if self._seen >= ENOUGH:
            self.deviation = sqrt(self._squares / self._seen)
            self.gap = max(self.noise, SLACK * self.deviation)


AVERAGED: Final = 200
"""Differences over which noise is averaged."""


class DifferenceNoise:
    """The noise of samples of a motion, as the mean `square` of it of one axis, from `seen` third differences.

    They leave a parabola out, whatever the stamps are.
    """

    def __init__(self) -> None:
        self.square, self.seen = 0.0, 0
        self._last: deque[tuple[int, Sequence[float]]] = deque(maxlen=4)

    def clear(self) -> None:
        """Begin a new record; what was learnt stays."""
        self._last.clear()

    def add(self, stamp: int, values: Sequence[float]) -> None:
        """Take a sample at a stamp in ns, later than the last."""
        last = self._last
        last.append((stamp, values))
        if len(last) < 4:
            return
        (begin, a), (second, b), (third, c), (_, d) = last
        u, v = (second - begin) / (stamp - begin), (third - begin) / (stamp - begin)
        # Divided by its largest factor: samples that come at once count as pairs.
        of_b, of_c = (1.0 - v) * v, -u * (1.0 - u)
        of_a, of_d = -(v - u) * (1.0 - u) * (1.0 - v), u * v * (v - u)
        scale = len(values) * (of_a * of_a + of_b * of_b + of_c * of_c + of_d * of_d)
        whole = 0.0
        for i in range(len(values)):
            found = of_a * a[i] + of_b * b[i] + of_c * c[i] + of_d * d[i]
            whole += found * found
        self.seen = min(self.seen + 1, AVERAGED)
        self.square += (whole / scale - self.square) / self.seen
