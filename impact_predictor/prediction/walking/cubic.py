"""The cubic nearest to the last frames of a point, from sums over them, and where its gap comes down."""

from __future__ import annotations

from collections.abc import Sequence
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


class GapNoise(NamedTuple):
    """Standard deviations of a gap (m) and of its rate (m/s)."""

    gap: float
    rate: float


class PointFrame(NamedTuple):
    """A point at one instant: its gap, the rate of that, position and velocity; SI units, in the frame of odom.

    Where no velocity is measured both are None.
    """

    stamp: int
    gap: float
    rate: float | None
    position: Vector3
    velocity: Vector3 | None


class Series:
    """Sums of a coordinate of the frames and of its rates over powers of time: the right side of least squares."""

    def __init__(self) -> None:
        self._values = [0.0] * 4
        self._rates = [0.0] * 3

    def add(self, value: float, s: float, s2: float, s3: float) -> None:
        """Take the coordinate at a time."""
        values = self._values
        values[0] += value
        values[1] += s * value
        values[2] += s2 * value
        values[3] += s3 * value

    def add_rate(self, rate: float, s: float, s2: float) -> None:
        """Take its rate at a time."""
        rates = self._rates
        rates[0] += rate
        rates[1] += 2.0 * s * rate
        rates[2] += 3.0 * s2 * rate

    def right(self, ratio: float) -> Cubic:
        """The right side, with `ratio` the weight of the rates."""
        a, b, c, d = self._values
        p, q, r = self._rates
        return a, b + ratio * p, c + ratio * q, d + ratio * r


class CubicSums:
    """Sums over frames that follow each other, from which the cubic nearest to their gaps is found.

    Times are counted from the first frame in units of `SCALE`, gaps and positions from the first frame's; positions
    only where cubics of the `places` are wanted too.
    """

    def __init__(self, frames: Sequence[PointFrame], places: bool = True) -> None:
        """Take one frame or more."""
        self.first = frames[0]
        self.count = 0
        self.measured = True
        """Whether every frame has a velocity."""
        self.powers = [0.0] * 7
        self.gaps = Series()
        self.places = [Series() for _ in range(3)] if places else []
        self.square = self.square_rate = 0.0
        for frame in frames:
            self.add(frame)

    def add(self, frame: PointFrame) -> None:
        """Take the next frame."""
        first = self.first
        s = (frame.stamp - first.stamp) / (SCALE * NANOSECONDS)
        s2 = s * s
        s3 = s * s2
        self.count += 1
        powers = self.powers
        powers[0] += 1.0
        powers[1] += s
        powers[2] += s2
        powers[3] += s3
        powers[4] += s2 * s2
        powers[5] += s2 * s3
        powers[6] += s3 * s3
        gap = frame.gap - first.gap
        self.square += gap * gap
        self.gaps.add(gap, s, s2, s3)
        if frame.rate is None:
            self.measured = False
        else:
            rate = SCALE * frame.rate
            self.square_rate += rate * rate
            self.gaps.add_rate(rate, s, s2)
        for axis, series in enumerate(self.places):
            series.add(frame.position[axis] - first.position[axis], s, s2, s3)
            if frame.velocity is not None:
                series.add_rate(SCALE * frame.velocity[axis], s, s2)

    def normal(self, ratio: float) -> Factor:
        """The matrix of the least squares, with `ratio` the weight of rates: its lower triangle by rows."""
        p0, p1, p2, p3, p4, p5, p6 = self.powers
        n11, n12, n13 = p2 + ratio * p0, p3 + 2.0 * ratio * p1, p4 + 3.0 * ratio * p2
        n22, n23, n33 = p4 + 4.0 * ratio * p2, p5 + 6.0 * ratio * p3, p6 + 9.0 * ratio * p4
        return p0, p1, n11, p2, n12, n22, p3, n13, n23, n33


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

    def deviation_of(self, order: int, time: float) -> float:
        """Standard deviation `time` s after the stamp: of the gap in m, of its first or of its second derivative."""
        s = self.end + time / SCALE
        powers = ((1.0, s, s * s, s * s * s), (0.0, 1.0, 2.0 * s, 3.0 * s * s), (0.0, 0.0, 2.0, 6.0 * s))[order]
        return self.deviation / SCALE**order * sqrt(square_of(self.factor, powers))

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
            if depth > tolerance and depth > tolerance + REACH * self.deviation_of(0, lowest):
                return None
            rests = depth >= 0.0
            if not rests:
                time = first_below(a, b, c, d, lowest)
                if depth > -DOUBT * self.deviation_of(0, lowest):
                    rate = b + time * (2.0 * c + 3.0 * d * time)
                    bend = 2.0 * c + 6.0 * d * lowest
                    rests = self.deviation_of(0, time) * bend > -rate * self.deviation_of(1, lowest)
            if rests:
                return self._descent(a, b, c, d, lowest, 0.0)
        elif a + horizon * (b + horizon * (c + horizon * d)) < 0.0:
            time = first_below(a, b, c, d, horizon)
        else:
            return None
        return self._descent(a, b, c, d, time, min(0.0, b + time * (2.0 * c + 3.0 * d * time)))

    def _descent(self, a: float, b: float, c: float, d: float, time: float, rate: float) -> Descent:
        """A landing, and how well it is known; speed and braking are taken to be less by their standard deviations."""
        later = time + SPREAD
        below = a + later * (b + later * (c + later * d)) < -SURE * self.deviation_of(0, later)
        turned = b + later * (2.0 * c + 3.0 * d * later) > SURE * self.deviation_of(1, later)
        if rate < 0.0:
            precise = self.deviation_of(0, time) < PRECISE * (-rate - self.deviation_of(1, time))
        else:
            bend = 2.0 * c + 6.0 * d * time
            precise = self.deviation_of(1, time) < PRECISE * (bend - self.deviation_of(2, time))
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
