"""The cubic nearest to some frames of a point, from sums over them, and symmetric 4 x 4 matrices."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..types import Vector3

SCALE = 0.1
"""Times are counted in so many s while sums of their powers are taken, which keeps those near one."""

SINGULAR = 1e-12  # a pivot below this part of its diagonal is rounding: the frames are too few instants for a cubic

Cubic = tuple[float, float, float, float]
"""Coefficients, from that of the zeroth power."""

Triangle = tuple[float, float, float, float, float, float, float, float, float, float]
"""The lower triangle of a 4 x 4 matrix by rows: of a symmetric one, or its Cholesky factor, which has the inverse of
its diagonal in the place of that."""


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

    def normal(self, ratio: float, weight: float = 0.0) -> Triangle:
        """The lower triangle of the matrix of the least squares by rows, with `ratio` the weight of the rates.

        `weight` is that of what is expected of the third power's coefficient.
        """
        p0, p1, p2, p3, p4, p5, p6 = self._powers
        n11, n12, n13 = p2 + ratio * p0, p3 + 2.0 * ratio * p1, p4 + 3.0 * ratio * p2
        n22, n23, n33 = p4 + 4.0 * ratio * p2, p5 + 6.0 * ratio * p3, p6 + 9.0 * ratio * p4
        return p0, p1, n11, p2, n12, n22, p3, n13, n23, n33 + weight

    def fit(self, ratio: float, weight: float = 0.0, expected: float = 0.0) -> tuple[Cubic, Triangle, float] | None:
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

    def motion(self, factor: Triangle, ratio: float, s: float) -> tuple[Vector3, Vector3]:
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


def value_of(cubic: Cubic, x: float) -> float:
    a, b, c, d = cubic
    return a + x * (b + x * (c + x * d))


def slope_of(cubic: Cubic, x: float) -> float:
    _, b, c, d = cubic
    return b + x * (2.0 * c + 3.0 * d * x)


def factored(n: Triangle) -> Triangle | None:
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


def halfway(factor: Triangle, b: Cubic) -> Cubic:
    i0, l10, i1, l20, l21, i2, l30, l31, l32, i3 = factor
    y0 = b[0] * i0
    y1 = (b[1] - l10 * y0) * i1
    y2 = (b[2] - l20 * y0 - l21 * y1) * i2
    return y0, y1, y2, (b[3] - l30 * y0 - l31 * y1 - l32 * y2) * i3


def square_of(factor: Triangle, b: Cubic) -> float:
    y0, y1, y2, y3 = halfway(factor, b)
    return y0 * y0 + y1 * y1 + y2 * y2 + y3 * y3


def solved(factor: Triangle, b: Cubic) -> Cubic:
    """The solution x of N x = b."""
    i0, l10, i1, l20, l21, i2, l30, l31, l32, i3 = factor
    y0, y1, y2, y3 = halfway(factor, b)
    x3 = y3 * i3
    x2 = (y2 - l32 * x3) * i2
    x1 = (y1 - l21 * x2 - l31 * x3) * i1
    return (y0 - l10 * x1 - l20 * x2 - l30 * x3) * i0, x1, x2, x3
