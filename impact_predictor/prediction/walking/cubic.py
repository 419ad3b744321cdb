"""The cubic nearest to the last frames of a point, from sums over them, and where its gap comes down."""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..types import Vector3

SCALE = 0.1
"""Times are counted in so many s while sums of their powers are taken, which keeps those near one."""

DOUBT = 2.0
"""Standard deviations within which the lowest point of a course may be a foot that brakes to rest on the ground."""

REACH = 1.0
"""Standard deviations by which the lowest point of a foot that brakes may seem to lie above the tolerance."""

SURE = 2.5
"""A landing is sure when so many standard deviations of the course ..."""

SPREAD = 0.03
"""... leave no doubt that so many s after the announced time the foot would be through the ground, or rise again."""

PRECISE = 0.01
"""A time is known well when its standard deviation is below so many s."""

SINGULAR = 1e-12
"""A pivot below this part of its diagonal is rounding: the frames are too few instants for a cubic."""

Cubic = tuple[float, float, float, float]
"""Coefficients, from that of the zeroth power."""

Factor = tuple[float, float, float, float, float, float, float, float, float, float]
"""The Cholesky factor of a 4 x 4 matrix by rows, with the inverse of its diagonal in the place of that."""


class Noise(NamedTuple):
    """Standard deviations of a gap (m) and of its rate (m/s)."""

    gap: float
    rate: float


class Frame(NamedTuple):
    """A point at one instant: its gap, the rate of that, position and velocity; SI units, in the frame of odom.

    Where no velocity is measured both are None.
    """

    stamp: int
    gap: float
    rate: float | None
    position: Vector3
    velocity: Vector3 | None


class Descent(NamedTuple):
    """Where a course comes down: `time` in s from the fit's stamp, and the `rate` (m/s) of the gap then.

    `sure` where the foot has surely come through the level, or turned, soon after it; `precise` where at least the time
    is known well if it lands at all.
    """

    time: float
    rate: float
    sure: bool
    precise: bool


class Fit(NamedTuple):
    """The cubic nearest to the last frames of a point, in units of `SCALE` s from the first of them.

    `gap` has the coefficients of the gap in m, `end` the time in those units of the last frame, whose stamp is `stamp`;
    `deviation` (m) is what the gaps scatter about it, and `fits` whether that is their noise. `prior` has the weight
    and the value with which the third power's coefficient went into it.
    """

    stamp: int
    end: float
    gap: Cubic
    factor: Factor
    ratio: float
    deviation: float
    fits: bool
    prior: tuple[float, float] = (0.0, 0.0)

    @property
    def begin(self) -> int:
        """Stamp in ns of the first of the frames."""
        return self.stamp - round(self.end * SCALE * NANOSECONDS)

    def gap_deviation(self, time: float) -> float:
        """Standard deviation in m of the gap `time` s after the stamp."""
        s = self.end + time / SCALE
        return self.deviation * sqrt(square_of(self.factor, (1.0, s, s * s, s * s * s)))

    def rate_deviation(self, time: float) -> float:
        """Standard deviation in m/s of the gap's rate `time` s after the stamp."""
        s = self.end + time / SCALE
        return self.deviation / SCALE * sqrt(square_of(self.factor, (0.0, 1.0, 2.0 * s, 3.0 * s * s)))

    def bend_deviation(self, time: float) -> float:
        """Standard deviation in m/s^2 of the gap's acceleration `time` s after the stamp."""
        s = self.end + time / SCALE
        return self.deviation / SCALE**2 * sqrt(square_of(self.factor, (0.0, 0.0, 2.0, 6.0 * s)))

    def now(self) -> Cubic:
        """Coefficients of the gap over the time in s since the stamp."""
        a, b, c, d = self.gap
        s, unit = self.end, 1.0 / SCALE
        return (
            a + s * (b + s * (c + s * d)),
            (b + s * (2.0 * c + 3.0 * d * s)) * unit,
            (c + 3.0 * d * s) * unit**2,
            d * unit**3,
        )

    def landing(self, level: float, tolerance: float, horizon: float) -> Descent | None:
        """When the gap first descends through a `level`, or comes to its lowest point within the `tolerance` above it.

        A lowest point so near to the level that the noise could put it there is one of a foot that brakes to rest,
        unless the time at which the curve, which nearly touches, comes through is known better. None where it does not
        come down within the `horizon`.
        """
        a, b, c, d = self.now()
        a -= level
        if b >= 0.0:
            return None
        square = c * c - 3.0 * b * d
        lowest = inf
        if square >= 0.0 and c + sqrt(square) > 0.0:
            lowest = -b / (c + sqrt(square))
        if lowest < horizon:
            depth = a + lowest * (b + lowest * (c + lowest * d))
            if depth > tolerance and depth > tolerance + REACH * self.gap_deviation(lowest):
                return None
            rests = depth >= 0.0
            if not rests:
                time = first_below(a, b, c, d, lowest)
                if depth > -DOUBT * self.gap_deviation(lowest):
                    rate = b + time * (2.0 * c + 3.0 * d * time)
                    bend = 2.0 * c + 6.0 * d * lowest
                    rests = self.gap_deviation(time) * bend > -rate * self.rate_deviation(lowest)
            if rests:
                return self._told(a, b, c, d, lowest, 0.0)
        elif a + horizon * (b + horizon * (c + horizon * d)) < 0.0:
            time = first_below(a, b, c, d, horizon)
        else:
            return None
        return self._told(a, b, c, d, time, min(0.0, b + time * (2.0 * c + 3.0 * d * time)))

    def _told(self, a: float, b: float, c: float, d: float, time: float, rate: float) -> Descent:
        """A landing, and how well it is known; speed and braking are taken to be less by their standard deviations."""
        later = time + SPREAD
        below = a + later * (b + later * (c + later * d)) < -SURE * self.gap_deviation(later)
        turned = b + later * (2.0 * c + 3.0 * d * later) > SURE * self.rate_deviation(later)
        if rate < 0.0:
            precise = self.gap_deviation(time) < PRECISE * (-rate - self.rate_deviation(time))
        else:
            bend = 2.0 * c + 6.0 * d * time
            precise = self.rate_deviation(time) < PRECISE * (bend - self.bend_deviation(time))
        return Descent(time, rate, below or turned, precise)


def first_below(a: float, b: float, c: float, d: float, end: float) -> float:
    """Where a + b t + c t^2 + d t^3, which falls until `end` and is below zero there, passes zero; 0 if it is now."""
    if a <= 0.0:
        return 0.0
    low, high = 0.0, end
    time = min(end, -a / b)
    for _ in range(60):
        value = a + time * (b + time * (c + time * d))
        if value > 0.0:
            low = time
        else:
            high = time
        slope = b + time * (2.0 * c + 3.0 * d * time)
        following = time - value / slope if slope < 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - time) <= 1e-9:
            return following
        time = following
    return time


def factored(n: Factor) -> Factor | None:
    """The Cholesky factor of the symmetric matrix whose lower triangle is `n`, by rows; None where it is singular."""
    n00, n10, n11, n20, n21, n22, n30, n31, n32, n33 = n
    i0 = 1.0 / sqrt(n00)
    l10, l20, l30 = n10 * i0, n20 * i0, n30 * i0
    pivot = n11 - l10 * l10
    if pivot <= SINGULAR * n11:
        return None
    i1 = 1.0 / sqrt(pivot)
    l21, l31 = (n21 - l20 * l10) * i1, (n31 - l30 * l10) * i1
    pivot = n22 - l20 * l20 - l21 * l21
    if pivot <= SINGULAR * n22:
        return None
    i2 = 1.0 / sqrt(pivot)
    l32 = (n32 - l30 * l20 - l31 * l21) * i2
    pivot = n33 - l30 * l30 - l31 * l31 - l32 * l32
    if pivot <= SINGULAR * n33:
        return None
    return i0, l10, i1, l20, l21, i2, l30, l31, l32, 1.0 / sqrt(pivot)


def _halfway(factor: Factor, b: Cubic) -> Cubic:
    i0, l10, i1, l20, l21, i2, l30, l31, l32, i3 = factor
    y0 = b[0] * i0
    y1 = (b[1] - l10 * y0) * i1
    y2 = (b[2] - l20 * y0 - l21 * y1) * i2
    return y0, y1, y2, (b[3] - l30 * y0 - l31 * y1 - l32 * y2) * i3


def square_of(factor: Factor, b: Cubic) -> float:
    """b^T N^-1 b."""
    y0, y1, y2, y3 = _halfway(factor, b)
    return y0 * y0 + y1 * y1 + y2 * y2 + y3 * y3


def solved(factor: Factor, b: Cubic) -> Cubic:
    """The solution x of N x = b."""
    i0, l10, i1, l20, l21, i2, l30, l31, l32, i3 = factor
    y0, y1, y2, y3 = _halfway(factor, b)
    x3 = y3 * i3
    x2 = (y2 - l32 * x3) * i2
    x1 = (y1 - l21 * x2 - l31 * x3) * i1
    return (y0 - l10 * x1 - l20 * x2 - l30 * x3) * i0, x1, x2, x3
