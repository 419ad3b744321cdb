"""The trajectory of a point of a foot over the ground: where it was, and the cubic that it follows now.

A cubic is the simplest curve that has a foot brake before it lands, and begin to brake before that.
"""

from __future__ import annotations

from collections import deque
from itertools import islice
from math import sqrt

from ...stamps import NANOSECONDS
from ..types import Vector3
from .cubic import SCALE, CubicSums, Fit, GapNoise, PointFrame, factored, solved

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

JERK = 1000.0
"""Standard deviation in m/s^3 of how the acceleration of a foot changes, as long as none has landed."""

DIFFERENCE = 0.2
"""A foot comes down otherwise than before by this part of the mean at least."""

FORGETS = 0.98
"""Part of what was known before that counts beside one more landing."""

TELLING = 0.01
"""A descent tells something by itself from this part of what is known in the end."""

LEAST_DEVIATION = 100.0
"""m/s^3 by which the next descent may differ, however alike the last ones were: a machine may change its gait."""

JERK_UNIT = SCALE**3 / 6.0
"""The third power's coefficient in a fit of a jerk of 1 m/s^3."""


class DescentPrior:
    """Mean and deviation of the jerk of feet that come down: what noise hides of it in one descent, many show."""

    def __init__(self) -> None:
        self._mean = 0.0
        self._square = JERK * JERK
        self._precision = 1.0 / self._square

    def learn(self, fit: Fit) -> None:
        """Take the cubic of a descent that has ended on the ground.

        What the descent itself tells is learnt, without the prior that was in its fit: else that would confirm itself.
        """
        weight, expected = fit.prior
        whole = 1.0 / fit.factor[9] ** 2
        own = whole - weight
        if own <= TELLING * whole:
            return
        jerk, doubt = (whole * fit.gap[3] - weight * expected) / own / JERK_UNIT, fit.deviation / sqrt(own) / JERK_UNIT
        # What noise adds to a jerk is none of the prior: an unsure one counts less, and spreads less than it seems to.
        precision = 1.0 / (doubt * doubt + LEAST_DEVIATION * LEAST_DEVIATION)
        self._precision = FORGETS * self._precision + precision
        share, off = precision / self._precision, jerk - self._mean
        self._mean += share * off
        self._square = max(0.0, self._square + share * (off * off - doubt * doubt - self._square))

    def coefficient(self, noise: float) -> tuple[float, float]:
        """Weight and value of the third power's coefficient, before the frames of noise (m) are seen."""
        deviation = max(LEAST_DEVIATION, sqrt(self._square) + DIFFERENCE * abs(self._mean))
        return (noise / (deviation * JERK_UNIT)) ** 2, self._mean * JERK_UNIT


class FootTrajectory:
    """The last frames of a point over its ground, and the longest stretch of them that one cubic fits."""

    def __init__(self) -> None:
        self.frames: deque[PointFrame] = deque(maxlen=MOST)
        self._sums: CubicSums | None = None
        self._falls = False
        self._deviation = 0.0
        self.top = 0
        """Stamp in ns of the highest place that the point descends from."""
        self.broke = False
        """Whether the last frame did not follow the cubic of those before it."""

    def add(self, frame: PointFrame) -> None:
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
            self._sums = CubicSums([frame])
        else:
            self._sums.add(frame)

    def rest(self) -> None:
        """Follow the point no more; what comes later is another trajectory."""
        self._sums = None
        self._falls = False
        self._deviation = 0.0

    def fit(self, noise: GapNoise, prior: DescentPrior) -> Fit | None:
        """The cubic of the last frames once the point descends; None before, and while there are too few of them."""
        sums = self._sums
        if sums is None or sums.count < FEWEST:
            return None
        rate = self.frames[-1].rate
        if not self._falls and rate is not None and rate > TURNED * noise.rate:
            return None
        if sums.count >= MOST:
            sums = self._sums = CubicSums(self.last(SHORTER * MOST // 4))
        fit = self._fit_of(sums, noise, prior)
        self.broke = fit is not None and not fit.fits and fit.deviation > BROKE * self._deviation
        count = sums.count
        while fit is not None and not (fit.fits or count == FEWEST):
            count = max(FEWEST, SHORTER * count // 4)
            fit = self._fit_of(CubicSums(self.last(count), places=False), noise, prior)
        if count < sums.count:
            self._sums = CubicSums(self.last(count))
        if fit is None:
            return None
        self._deviation = fit.deviation
        return fit if self._descends(fit) else None

    def motion(self, fit: Fit, time: float) -> tuple[Vector3, Vector3]:
        """Position and velocity of the point `time` s after the fit's stamp, by the cubic through the same frames."""
        sums = self._sums
        assert sums is not None
        s = fit.end + time / SCALE
        # What is expected of the gap says nothing of the motion along the ground.
        factor = factored(sums.normal(fit.ratio)) or fit.factor
        places, speeds = [], []
        for axis in range(3):
            a, b, c, d = solved(factor, sums.places[axis].right(fit.ratio))
            places.append(sums.first.position[axis] + a + s * (b + s * (c + s * d)))
            speeds.append((b + s * (2.0 * c + 3.0 * d * s)) / SCALE)
        return (places[0], places[1], places[2]), (speeds[0], speeds[1], speeds[2])

    def last(self, count: int) -> list[PointFrame]:
        """The last `count` frames."""
        return list(islice(self.frames, max(0, len(self.frames) - count), None))

    def _fit_of(self, sums: CubicSums, noise: GapNoise, prior: DescentPrior) -> Fit | None:
        """The cubic nearest to the gaps, and to their rates where all are measured (weighted least squares)."""
        # A rate in units of the scale weighs as the square of how much surer it is than a gap.
        ratio = (noise.gap / (noise.rate * SCALE)) ** 2 if sums.measured else 0.0
        weight, expected = prior.coefficient(noise.gap)
        n00, n10, n11, n20, n21, n22, n30, n31, n32, n33 = sums.normal(ratio)
        factor = factored((n00, n10, n11, n20, n21, n22, n30, n31, n32, n33 + weight))
        if factor is None:
            return None
        b0, b1, b2, b3 = sums.gaps.right(ratio)
        b = b0, b1, b2, b3 + weight * expected
        c = solved(factor, b)
        square = sums.square + ratio * sums.square_rate + weight * expected * expected
        left = max(0.0, square - c[0] * b[0] - c[1] * b[1] - c[2] * b[2] - c[3] * b[3])
        free = (2 if sums.measured else 1) * sums.count - 3
        share = left / (free * noise.gap * noise.gap)
        fits = share <= 1.0 + MISFIT * sqrt(2.0 / free)
        stamp = self.frames[-1].stamp
        return Fit(
            stamp=stamp,
            end=(stamp - sums.first.stamp) / (SCALE * NANOSECONDS),
            gap=(sums.first.gap + c[0], c[1], c[2], c[3]),
            factor=factor,
            ratio=ratio,
            deviation=noise.gap if fits else noise.gap * sqrt(share),
            fits=fits,
            prior=(weight, expected),
        )

    def _descends(self, fit: Fit) -> bool:
        """Whether the point descends, and has not just begun to.

        At its highest place a planner goes over from lifting the foot to lowering it, by another curve: what came
        before tells nothing of the landing, and is left out of the fits from then on.
        """
        _, slope, bend, _ = fit.now()
        if slope > TURNED * fit.deviation_of(1, 0.0):
            self._falls = False
        elif not self._falls and slope < -TURNED * fit.deviation_of(1, 0.0):
            self._falls = True
            top = fit.stamp + 0.5 * slope / -bend * NANOSECONDS if bend < 0.0 else 0.0
            self.top = round(top)
            since = sum([frame.stamp >= top for frame in self.frames])
            if self._sums is not None and since < self._sums.count:
                self._sums = CubicSums(self.last(max(1, since)))
            return False
        return self._falls
