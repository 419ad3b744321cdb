"""The rhythm in which a point lands, and how true the deviations are that its landings were told with."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from itertools import pairwise
from math import exp, hypot
from statistics import median
from typing import Final

from ...stamps import NANOSECONDS

STRIDES: Final = 5  # the last ones that tell the rhythm ...
FEWEST: Final = 4  # ... and how many of them it takes
LEAST: Final = 1e-3  # s by which a rhythm is off at least ...
SURE: Final = 6e-3  # ... and at most, to count at all: on uneven ground no stride is like another
UNLIKE: Final = 3.0  # standard deviations by which what is measured speaks against the rhythm

UNSEEN: Final = 7e-4  # s by which a landing comes before a sample shows it: a contact sinks in, and samples are rare
BIN: Final = 0.01  # s of lead time that are learnt of together ...
BINS: Final = 12  # ... and how many there are
BEYOND, PART = 1.44, 0.15  # this part of normal deviates lies so many standard deviations off, or further
STEP: Final = 5.0  # change of the logarithm of the scale where all are further off, over the landings learnt of ...
KNOWN: Final = 2.0  # ... with those that the deviation as it is computed counts for ...
MEMORY: Final = 10.0  # ... and that are remembered


class StrideRhythm:
    """How long after each other a point lands: a prior of its next landing, and no more than that."""

    def __init__(self) -> None:
        self._stamps: deque[int] = deque(maxlen=STRIDES + 1)
        self._stride = self._square = 0.0

    def learn(self, stamp: int) -> None:
        """Take that the point has landed at a stamp in ns."""
        self._stamps.append(stamp)
        strides = [(b - a) / NANOSECONDS for a, b in pairwise(self._stamps)]
        if len(strides) >= FEWEST:
            self._stride = median(strides)
            # One that is out of step is enough to doubt it.
            self._square = max([(one - self._stride) ** 2 for one in strides]) + LEAST * LEAST

    def weighed(self, stamp: int, time: float, variance: float) -> tuple[float, float]:
        """A time in s from a stamp until the landing, and its variance, with what the rhythm says of it.

        Where that is another landing than the measured one the measured one counts, and is as unsure.
        """
        if not 0.0 < self._square < SURE * SURE:
            return time, variance
        off = self._stride - (stamp - self._stamps[-1]) / NANOSECONDS - time
        whole = variance + self._square
        if off * off > UNLIKE * UNLIKE * whole:
            return time, variance
        return time + off * variance / whole, variance * self._square / whole


class DeviationScale:
    """By how much told deviations are too small or too large, by lead time, as the landings of all feet show it.

    A quantile is tracked (Robbins and Monro, 1951) and no mean square, which few landings that nobody could know of
    would make too large for all others.
    """

    def __init__(self) -> None:
        self._logarithm = [0.0] * BINS
        self._count = [0.0] * BINS

    def told(self, time: float, deviation: float) -> float:
        """The deviation to be told of a landing `time` s ahead, of which one is computed."""
        return hypot(deviation * exp(self._logarithm[min(int(time / BIN), BINS - 1)]), UNSEEN)

    def learn(self, found: Iterable[tuple[float, float, float]]) -> None:
        """Take a landing: of some samples the time in s until then, its deviation as computed, and the true time."""
        bins: list[list[bool]] = [[] for _ in range(BINS)]
        scales = [exp(one) for one in self._logarithm]
        for time, deviation, true in found:
            k = min(int(time / BIN), BINS - 1)
            bins[k].append(abs(time - true) > BEYOND * hypot(deviation * scales[k], UNSEEN))
        for k, ones in enumerate(bins):
            if ones:
                count = self._count[k] = min(self._count[k] + 1.0, MEMORY)
                self._logarithm[k] += STEP * (sum(ones) / len(ones) - PART) / (count + KNOWN)
