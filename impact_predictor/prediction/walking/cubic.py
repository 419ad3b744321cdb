"""The cubic nearest to the last frames of a point, from sums over them, and where its gap comes down."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..types import Vector3

SCALE = 0.1
"""Times are counted in so many s while sums of their powers are taken, which keeps those near one."""

DOUBT = 2.0  # standard deviations within which a lowest point may be a foot that brakes to rest on the ground
REACH = 1.0  # standard deviations by which the lowest point of a foot that brakes may seem to lie above the tolerance
SURE = 2.5  # a landing is sure when so many standard deviations of the course leave no doubt ...
SPREAD = 0.03  # ... that so many s after the announced time the foot would be through the ground, or rise again
PRECISE = 0.01  # a time is known well when its standard deviation is below so many s
SINGULAR = 1e-12  # a pivot below this part of its diagonal is rounding: the frames are too few instants for a cubic

Cubic = tuple[float, float, float, float]
"""Coefficients, from that of the zeroth power."""

Factor = tuple[float, float, float, float, float, float, float, float, float, float]
"""The Cholesky factor of a 4 x 4 matrix by rows, with the inverse of its diagonal in the place of that."""


class GapNoise(NamedTuple):
    """Standard deviations of a gap (m) and of its rate (m/s)."""

    gap: float
    rate: float

    @property
    def ratio(self) -> float:
        """What the square of a rate in units of the scale counts beside that of a gap, by how much surer it is."""
        return (self.gap / (self.rate * SCALE)) ** 2


class PointFrame(NamedTuple):
    """A point at one instant: its gap, the rate of that, position and velocity; SI units, in the frame of odom.

    Where no velocity is measured both are None.
    """

    stamp: int
    gap: float
    rate: float | None
    position: Vector3
    velocity: Vector3 | None


class CubicSums:
    """Sums over frames that follow each other, from which the cubic nearest to their gaps is found.

    Times are counted from the first frame in units of `SCALE`, gaps and positions from the first frame's; positions
    only where cubics of the `places` are wanted too.
    """

    def __init__(self, frames: Sequence[PointFrame], places: bool = True) -> None:
        self.first = frames[0]
        self.count = 0
        self.measured = True
        """Whether every frame has a velocity."""
        self._powers = [0.0] * 7
        # Of the gap, and of the three coordinates: its values and its rates times powers of the time.
        self._values = [[0.0] * 4 for _ in range(4 if places else 1)]
        self._rates = [[0.0] * 3 for _ in self._values]
        self._square = self._square_rate = 0.0
        for frame in frames:
            self.add(frame)

    def add(self, frame: PointFrame) -> None:
        first = self.first
        s = (frame.stamp - first.stamp) / (SCALE * NANOSECONDS)
        s2 = s * s
        s3 = s * s2
        self.count += 1
        powers = self._powers
        powers[0] += 1.0
        powers[1] += s
        powers[2] += s2
        powers[3] += s3
        powers[4] += s2 * s2
        powers[5] += s2 * s3
        powers[6] += s3 * s3
        gap = frame.gap - first.gap
        self._square += gap * gap
        (x, y, z), (x0, y0, z0) = frame.position, first.position
        for sums, value in zip(self._values, (gap, x - x0, y - y0, z - z0)):  # noqa: B905 (places may be left out)
            sums[0] += value
            sums[1] += s * value
            sums[2] += s2 * value
            sums[3] += s3 * value
        if frame.rate is None or frame.velocity is None:
            self.measured = False
            return
        self._square_rate += (SCALE * frame.rate) ** 2
        for sums, speed in zip(self._rates, (frame.rate, *frame.velocity)):  # noqa: B905
            rate = SCALE * speed
            sums[0] += rate
            sums[1] += 2.0 * s * rate
            sums[2] += 3.0 * s2 * rate

    def normal(self, ratio: float, weight: float = 0.0) -> Factor:
        """The lower triangle of the matrix of the least squares by rows, with `ratio` the weight of the rates.

        `weight` is that of what is expected of the third power's coefficient.
        """
        p0, p1, p2, p3, p4, p5, p6 = self._powers
        n11, n12, n13 = p2 + ratio * p0, p3 + 2.0 * ratio * p1, p4 + 3.0 * ratio * p2
        n22, n23, n33 = p4 + 4.0 * ratio * p2, p5 + 6.0 * ratio * p3, p6 + 9.0 * ratio * p4
        return p0, p1, n11, p2, n12, n22, p3, n13, n23, n33 + weight

    def fit(self, ratio: float, weight: float = 0.0, expected: float = 0.0) -> tuple[Cubic, Factor, float] | None:
        """The cubic nearest to the gaps (weighted least squares), the factor of its matrix, and what it leaves of the
        squares; None where the frames are too few instants. The third power's coefficient is `expected` with a weight.
        """
        factor = factored(self.normal(ratio, weight))
        if factor is None:
            return None
        b0, b1, b2, b3 = self._right(0, ratio)
        b3 += weight * expected
        c0, c1, c2, c3 = cubic = solved(factor, (b0, b1, b2, b3))
        square = self._square + ratio * self._square_rate + weight * expected * expected
        return cubic, factor, max(0.0, square - c0 * b0 - c1 * b1 - c2 * b2 - c3 * b3)

    def motion(self, factor: Factor, ratio: float, s: float) -> tuple[Vector3, Vector3]:
        """Position and velocity at a time, in units of `SCALE`, by the cubics nearest to the positions."""
        places, speeds = [], []
        for axis in range(3):
            cubic = solved(factor, self._right(1 + axis, ratio))
            places.append(self.first.position[axis] + value_of(cubic, s))
            speeds.append(slope_of(cubic, s) / SCALE)
        return (places[0], places[1], places[2]), (speeds[0], speeds[1], speeds[2])

    def _right(self, axis: int, ratio: float) -> Cubic:
        """The right side of the least squares of the gap (axis 0) or of a coordinate."""
        a, b, c, d = self._values[axis]
        p, q, r = self._rates[axis]
        return a, b + ratio * p, c + ratio * q, d + ratio * r


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
    """The cubic nearest to the last frames of a point.

    `gap` has the coefficients of the gap (m) over the time in s since the last frame, whose stamp is `stamp`; `end` is
    the time in units of `SCALE` s from the first of the frames to that. `deviation` (m) is what the gaps scatter about
    it, and `fits` whether that is their noise. `prior` has the weight and the value with which the third power's
    coefficient went into it, in those units.
    """

    stamp: int
    end: float
    gap: Cubic
    factor: Factor
    ratio: float
    deviation: float
    fits: bool
    prior: tuple[float, float]

    @property
    def begin(self) -> int:
        """Stamp in ns of the first of the frames."""
        return self.stamp - round(self.end * SCALE * NANOSECONDS)

    def deviation_of(self, order: int, time: float) -> float:
        """Standard deviation `time` s after the stamp: of the gap in m, of its first or of its second derivative."""
        s = self.end + time / SCALE
        powers = ((1.0, s, s * s, s * s * s), (0.0, 1.0, 2.0 * s, 3.0 * s * s), (0.0, 0.0, 2.0, 6.0 * s))[order]
        return self.deviation / SCALE**order * sqrt(square_of(self.factor, powers))

    def landing(self, level: float, tolerance: float, horizon: float) -> Descent | None:
        """When the gap first descends through a `level`, or comes to its lowest point within the `tolerance` above it.

        A lowest point so near to the level that the noise could put it there is one of a foot that brakes to rest,
        unless the time at which the curve, which nearly touches, comes through is known better. None where it does not
        come down within the `horizon`.
        """
        height, b, c, d = self.gap
        off = height - level, b, c, d
        if b >= 0.0:
            return None
        square = c * c - 3.0 * b * d
        lowest = -b / (c + sqrt(square)) if square >= 0.0 and c + sqrt(square) > 0.0 else inf
        end = min(lowest, horizon)
        depth = value_of(off, end)
        if depth >= 0.0:
            if lowest >= horizon or (depth > tolerance and depth > tolerance + REACH * self.deviation_of(0, lowest)):
                return None
            return self._descent(off, lowest, 0.0)
        time = first_below(off, end)
        rate = min(0.0, slope_of(off, time))
        if lowest < horizon and depth > -DOUBT * self.deviation_of(0, lowest):
            bend = 2.0 * c + 6.0 * d * lowest
            if self.deviation_of(0, time) * bend > -slope_of(off, time) * self.deviation_of(1, lowest):
                time, rate = lowest, 0.0
        return self._descent(off, time, rate)

    def _descent(self, off: Cubic, time: float, rate: float) -> Descent:
        """A landing, and how well it is known; speed and braking are taken to be less by their standard deviations."""
        later = time + SPREAD
        below = value_of(off, later) < -SURE * self.deviation_of(0, later)
        turned = slope_of(off, later) > SURE * self.deviation_of(1, later)
        if rate < 0.0:
            precise = self.deviation_of(0, time) < PRECISE * (-rate - self.deviation_of(1, time))
        else:
            bend = 2.0 * off[2] + 6.0 * off[3] * time
            precise = self.deviation_of(1, time) < PRECISE * (bend - self.deviation_of(2, time))
        return Descent(time, rate, below or turned, precise)


def value_of(cubic: Cubic, x: float) -> float:
    a, b, c, d = cubic
    return a + x * (b + x * (c + x * d))


def slope_of(cubic: Cubic, x: float) -> float:
    _, b, c, d = cubic
    return b + x * (2.0 * c + 3.0 * d * x)


def shifted(cubic: Cubic, x: float, unit: float) -> Cubic:
    """The coefficients over (x' - x) / unit of a cubic in x'."""
    _, _, c, d = cubic
    return value_of(cubic, x), slope_of(cubic, x) * unit, (c + 3.0 * d * x) * unit**2, d * unit**3


def first_below(cubic: Cubic, end: float) -> float:
    """Where a cubic that falls until `end`, and is below zero there, passes zero; 0 if it is below now."""
    if cubic[0] <= 0.0:
        return 0.0
    low, high = 0.0, end
    time = min(end, -cubic[0] / cubic[1])
    for _ in range(60):
        value, slope = value_of(cubic, time), slope_of(cubic, time)
        if value > 0.0:
            low = time
        else:
            high = time
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
