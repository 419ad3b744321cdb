"""The course of a point of a foot over the ground: where it was, and the cubic that it follows now.

A cubic is the simplest curve that has a foot brake before it lands, and begin to brake before that.
"""

from __future__ import annotations

from collections import deque
from itertools import islice
from math import sqrt

from ...stamps import NANOSECONDS
from ..types import Vector3
from .cubic import SCALE, Fit, Frame, Noise, factored, solved
from .habit import Habit
from .sums import Gaps, Sums, sums_of

FEWEST = 5
"""Frames that a cubic is fitted to at least: four would leave nothing to tell how well it fits."""

MOST = 200
"""... and at most: half a second at 400 Hz."""

SHORTER = 3
"""Quarters of the frames that are kept where one cubic does not fit them all."""

MISFIT = 4.0
"""A cubic does not fit where the mean square of its residuals is further above that of the noise than so many standard
deviations of it."""

BROKE = 2.0
"""The last frame did not follow the others where it makes them scatter so many times more about their cubic."""

TURNED = 3.0
"""A rate is surely not zero when it is so many standard deviations from it."""


class Course:
    """The last frames of a point over a ground with a unit `normal`, and the longest stretch of them one cubic fits."""

    def __init__(self, normal: Vector3) -> None:
        self.frames: deque[Frame] = deque(maxlen=MOST)
        self._normal = normal
        self._sums: Sums | None = None
        self._falls = False
        self._deviation = 0.0
        self.top = 0
        """Stamp in ns of the highest place that the point descends from."""
        self.broke = False
        """Whether the last frame did not follow the cubic of those before it."""

    def add(self, frame: Frame) -> None:
        """Take the next frame, in the order of their stamps."""
        self.frames.append(frame)

    @property
    def rate(self) -> float:
        """The rate of the gap now, in m/s: measured, or else from the last two frames; 0 from one."""
        last = self.frames[-1]
        if last.rate is not None or len(self.frames) < 2:
            return last.rate or 0.0
        before = self.frames[-2]
        return (last.gap - before.gap) / (last.stamp - before.stamp) * NANOSECONDS

    def follow(self) -> None:
        """Fit the last frame together with those that were followed before it."""
        frame = self.frames[-1]
        if self._sums is None:
            self._sums = Sums(frame)
        else:
            self._sums.add(frame)

    def rest(self) -> None:
        """Follow the point no more; what comes later is another course."""
        self._sums = None
        self._falls = False
        self._deviation = 0.0

    def fit(self, noise: Noise, habit: Habit) -> Fit | None:
        """The cubic of the last frames once the point descends; None before, and while there are too few of them."""
        sums = self._sums
        if sums is None or sums.count < FEWEST:
            return None
        rate = self.frames[-1].rate
        if not self._falls and rate is not None and rate > TURNED * noise.rate:
            return None
        if sums.count >= MOST:
            sums = self._again(SHORTER * MOST // 4)
        fit = self._fit_of(sums, noise, habit)
        self.broke = fit is not None and not fit.fits and fit.deviation > BROKE * self._deviation
        count = sums.count
        while fit is not None and not (fit.fits or count == FEWEST):
            count = max(FEWEST, SHORTER * count // 4)
            fit = self._fit_of(sums_of(Gaps, self.last(count)), noise, habit)
        if count < sums.count:
            self._again(count)
        if fit is None:
            return None
        self._deviation = fit.deviation
        return fit if self._descends(fit) else None

    def motion(self, fit: Fit, time: float) -> tuple[Vector3, Vector3]:
        """Position and velocity of the point `time` s after the fit's stamp, by the cubic through the same frames."""
        sums = self._sums
        assert sums is not None
        s = fit.end + time / SCALE
        # What is usual of the gap says nothing of the motion along the ground.
        factor = factored(sums.normal(fit.ratio)) or fit.factor
        places, speeds = [], []
        for axis in range(3):
            a, b, c, d = solved(factor, sums.along(axis, fit.ratio))
            places.append(sums.first.position[axis] + a + s * (b + s * (c + s * d)))
            speeds.append((b + s * (2.0 * c + 3.0 * d * s)) / SCALE)
        return (places[0], places[1], places[2]), (speeds[0], speeds[1], speeds[2])

    def last(self, count: int) -> list[Frame]:
        """The last `count` frames."""
        return list(islice(self.frames, max(0, len(self.frames) - count), None))

    def _again(self, count: int) -> Sums:
        """The sums over the last `count` frames alone, from now on."""
        sums = self._sums = sums_of(Sums, self.last(count))
        return sums

    def _fit_of(self, sums: Gaps, noise: Noise, habit: Habit) -> Fit | None:
        """The cubic nearest to the gaps, and to their rates where all are measured (weighted least squares)."""
        # A rate in units of the scale weighs as the square of how much surer it is than a gap.
        ratio = (noise.gap / (noise.rate * SCALE)) ** 2 if sums.measured else 0.0
        weight, usual = habit.prior(noise.gap)
        n00, n10, n11, n20, n21, n22, n30, n31, n32, n33 = sums.normal(ratio)
        factor = factored((n00, n10, n11, n20, n21, n22, n30, n31, n32, n33 + weight))
        if factor is None:
            return None
        b0, b1, b2, b3 = sums.right(ratio)
        b = b0, b1, b2, b3 + weight * usual
        c = solved(factor, b)
        square = sums.square + ratio * sums.square_rate + weight * usual * usual
        left = max(0.0, square - c[0] * b[0] - c[1] * b[1] - c[2] * b[2] - c[3] * b[3])
        free = (2 if sums.measured else 1) * sums.count - 3
        share = left / (free * noise.gap * noise.gap)
        fits = share <= 1.0 + MISFIT * sqrt(2.0 / free)
        stamp = self.frames[-1].stamp
        return Fit(
            stamp,
            (stamp - sums.first.stamp) / (SCALE * NANOSECONDS),
            (sums.first.gap + c[0], c[1], c[2], c[3]),
            factor,
            ratio,
            noise.gap if fits else noise.gap * sqrt(share),
            fits,
            (weight, usual),
        )

    def _descends(self, fit: Fit) -> bool:
        """Whether the point descends, and has not just begun to.

        At its highest place a planner goes over from lifting the foot to lowering it, by another curve: what came
        before tells nothing of the landing, and is left out of the fits from then on.
        """
        _, slope, bend, _ = fit.now()
        if slope > TURNED * fit.rate_deviation(0.0):
            self._falls = False
        elif not self._falls and slope < -TURNED * fit.rate_deviation(0.0):
            self._falls = True
            top = fit.stamp + 0.5 * slope / -bend * NANOSECONDS if bend < 0.0 else 0.0
            self.top = round(top)
            since = sum([frame.stamp >= top for frame in self.frames])
            if self._sums is not None and since < self._sums.count:
                self._again(max(1, since))
            return False
        return self._falls
