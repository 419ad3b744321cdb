"""The cubic nearest to values and their rates, from sums over them, and symmetric 4 x 4 matrices."""

from __future__ import annotations

from math import sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..types import Vector3

SCALE: Final = 0.1
"""Times are counted in so many s while sums of their powers are taken, which keeps those near one."""

SINGULAR: Final = (
    1e-12  # a pivot below this part of its diagonal is rounding: the frames are too few instants for a cubic
)

Cubic = tuple[float, float, float, float]
"""Coefficients, from that of the zeroth power."""

Triangle = tuple[float, float, float, float, float, float, float, float, float, float]
"""The lower triangle of a 4 x 4 matrix by rows: of a symmetric one, or its Cholesky factor, which has the inverse of
its diagonal in the place of that."""


class GapNoise:
    """Standard deviations of a gap (m) and of its rate (m/s)."""

    def __init__(self, gap: float, rate: float) -> None:
        self.gap, self.rate = gap, rate

    @property
    def ratio(self) -> float:
        """What the square of a rate in units of the scale counts beside that of a gap, by how much surer it is."""
        return (self.gap / (self.rate * SCALE)) ** 2


class PointFrame:
    """A point at one instant: its gap, the rate of that, position and velocity; SI units, in the frame of odom.

    Where no velocity is measured both are None.
    """

    def __init__(self, stamp: int, gap: float, rate: float | None, position: Vector3, velocity: Vector3 | None) -> None:
        self.stamp, self.gap, self.rate, self.position, self.velocity = stamp, gap, rate, position, velocity


class CubicSums:
    """Sums over values at stamps that follow each other, from which the cubic nearest to them is found.

    Times are counted from the first stamp (ns) in units of `SCALE`, values from the first one.
    """

    def __init__(self, stamp: int, value: float, rate: float | None) -> None:
        self._stamp, self._value = stamp, value
        self.count = 0
        self.measured = True
        """Whether every value has a rate."""
        self._powers = (0.0,) * 6
        # The values, and their rates, times powers of the time.
        self._values, self._rates = (0.0,) * 4, (0.0,) * 3
        self._square = self._square_rate = 0.0
        self.add(stamp, value, rate)

    def add(self, stamp: int, value: float, rate: float | None) -> None:
        s = (stamp - self._stamp) / (SCALE * NANOSECONDS)
        s2 = s * s
        s3 = s * s2
        self.count += 1
        p1, p2, p3, p4, p5, p6 = self._powers
        self._powers = p1 + s, p2 + s2, p3 + s3, p4 + s2 * s2, p5 + s2 * s3, p6 + s3 * s3
        value -= self._value
        a, b, c, d = self._values
        self._values = a + value, b + s * value, c + s2 * value, d + s3 * value
        self._square += value * value
        if rate is None:
            self.measured = False
            return
        rate *= SCALE
        p, q, r = self._rates
        self._rates = p + rate, q + 2.0 * s * rate, r + 3.0 * s2 * rate
        self._square_rate += rate**2

    def fit(self, ratio: float, weight: float = 0.0, expected: float = 0.0) -> tuple[Cubic, Triangle, float] | None:
        """The cubic nearest to the values (weighted least squares), the factor of its matrix, and what it leaves of the
        squares; None where these are too few instants.

        `ratio` is the weight of the rates; the third power's coefficient is `expected` with another weight.
        """
        p0, (p1, p2, p3, p4, p5, p6) = float(self.count), self._powers
        n11, n12, n13 = p2 + ratio * p0, p3 + 2.0 * ratio * p1, p4 + 3.0 * ratio * p2
        n22, n23, n33 = p4 + 4.0 * ratio * p2, p5 + 6.0 * ratio * p3, p6 + 9.0 * ratio * p4
        factor = factored((p0, p1, n11, p2, n12, n22, p3, n13, n23, n33 + weight))
        if factor is None:
            return None
        (b0, b1, b2, b3), (r1, r2, r3) = self._values, self._rates
        b1, b2, b3 = b1 + ratio * r1, b2 + ratio * r2, b3 + ratio * r3 + weight * expected
        c0, c1, c2, c3 = cubic = solved(factor, (b0, b1, b2, b3))
        square = self._square + ratio * self._square_rate + weight * expected * expected
        return cubic, factor, max(0.0, square - c0 * b0 - c1 * b1 - c2 * b2 - c3 * b3)


def value_of(cubic: Cubic, x: float) -> float:
    a, b, c, d = cubic
    return a + x * (b + x * (c + x * d))


def slope_of(cubic: Cubic, x: float) -> float:
    _, b, c, d = cubic
    return b + x * (2.0 * c + 3.0 * d * x)


def factored(n: Triangle) -> Triangle | None:
    """The Cholesky factor of the symmetric matrix whose lower triangle is `n`, by rows; None where it is singular."""
    n00, n10, n11, n20, n21, n22, n30, n31, n32, n33 = n
    if not n00 > 0.0:
        return None
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
    return back(factor, halfway(factor, b))


def back(factor: Triangle, y: Cubic) -> Cubic:
    """The solution of N x = b, from halfway to it."""
    i0, l10, i1, l20, l21, i2, l30, l31, l32, i3 = factor
    y0, y1, y2, y3 = y
    x3 = y3 * i3
    x2 = (y2 - l32 * x3) * i2
    x1 = (y1 - l21 * x2 - l31 * x3) * i1
    return (y0 - l10 * x1 - l20 * x2 - l30 * x3) * i0, x1, x2, x3
