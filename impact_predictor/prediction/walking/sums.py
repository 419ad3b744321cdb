"""Sums over the frames of a point, from which the cubic nearest to them is found without going over them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from ...stamps import NANOSECONDS
from .cubic import SCALE, Cubic, Factor, Frame


class Gaps:
    """Sums over frames that follow each other, from which the cubic nearest to their gaps is found.

    Times are counted from the first frame in units of `SCALE`, gaps from the first frame's.
    """

    def __init__(self, first: Frame) -> None:
        self.first = first
        self.count = 0
        self.measured = True
        """Whether every frame has a velocity."""
        self.powers = [0.0] * 7
        self.gaps = [0.0] * 4
        self.rates = [0.0] * 4
        self.square = self.square_rate = 0.0
        self.add(first)

    def add(self, frame: Frame) -> None:
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
        summed(self.gaps, gap, s, s2, s3)
        if frame.rate is None:
            self.measured = False
            return
        rate = SCALE * frame.rate
        self.square_rate += rate * rate
        inclined(self.rates, rate, s, s2)

    def normal(self, ratio: float) -> Factor:
        """The matrix of the least squares, with `ratio` the weight of rates: its lower triangle by rows."""
        p0, p1, p2, p3, p4, p5, p6 = self.powers
        n11, n12, n13 = p2 + ratio * p0, p3 + 2.0 * ratio * p1, p4 + 3.0 * ratio * p2
        n22, n23, n33 = p4 + 4.0 * ratio * p2, p5 + 6.0 * ratio * p3, p6 + 9.0 * ratio * p4
        return p0, p1, n11, p2, n12, n22, p3, n13, n23, n33

    def right(self, ratio: float) -> Cubic:
        """Their right-hand side for the gaps."""
        return beside(self.gaps, self.rates, ratio)


class Sums(Gaps):
    """The sums of the positions of frames too, which are counted from the first frame's."""

    def __init__(self, first: Frame) -> None:
        self.places = [[0.0] * 4 for _ in range(3)]
        self.speeds = [[0.0] * 4 for _ in range(3)]
        super().__init__(first)

    def add(self, frame: Frame) -> None:
        super().add(frame)
        first = self.first
        s = (frame.stamp - first.stamp) / (SCALE * NANOSECONDS)
        s2 = s * s
        for sums, now, then in zip(self.places, frame.position, first.position, strict=True):
            summed(sums, now - then, s, s2, s * s2)
        if frame.velocity is not None:
            for sums, speed in zip(self.speeds, frame.velocity, strict=True):
                inclined(sums, SCALE * speed, s, s2)

    def along(self, axis: int, ratio: float) -> Cubic:
        """The right-hand side of the least squares for a coordinate."""
        return beside(self.places[axis], self.speeds[axis], ratio)


Kind = TypeVar("Kind", bound=Gaps)


def sums_of(kind: type[Kind], frames: Sequence[Frame]) -> Kind:
    """The sums of a kind over some frames, of which there is at least one."""
    sums = kind(frames[0])
    for frame in frames[1:]:
        sums.add(frame)
    return sums


def summed(sums: list[float], value: float, s: float, s2: float, s3: float) -> None:
    """Add a value at a time to those that a cubic is fitted to."""
    sums[0] += value
    sums[1] += s * value
    sums[2] += s2 * value
    sums[3] += s3 * value


def inclined(sums: list[float], rate: float, s: float, s2: float) -> None:
    """Add a rate at a time to those that the slope of a cubic is fitted to."""
    sums[1] += rate
    sums[2] += 2.0 * s * rate
    sums[3] += 3.0 * s2 * rate


def beside(values: list[float], rates: list[float], ratio: float) -> Cubic:
    """The right-hand side of least squares, with `ratio` the weight of the rates."""
    a, b, c, d = values
    _, q, r, t = rates
    return a, b + ratio * q, c + ratio * r, d + ratio * t
