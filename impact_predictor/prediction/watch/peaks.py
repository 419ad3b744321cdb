"""Peaks of margins over time, and what they tell of the hour ahead: how likely 1 is passed, and the likeliest maximum.

In a Gaussian sea the peaks of what is linear in it are Rayleigh's (Longuet-Higgins, "On the statistical distribution of
the heights of sea waves", Journal of Marine Research 11, 1952), beyond a threshold t like P(x > u) =
exp(-(u^2 - t^2) / mean(x^2 - t^2)). Where the Anderson-Darling test refuses that, those beyond a higher threshold are
taken for generalised Pareto ones (Hosking and Wallis, "Parameter and quantile estimation for the generalized Pareto
distribution", Technometrics 29, 1987).
"""

from __future__ import annotations

from math import exp, inf, log, sqrt
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

KEPT: Final = 400  # peaks of each body: 20 to 40 minutes
ENOUGH: Final = 60  # peaks that tell of others
ANEW: Final = 8  # peaks after which they are looked at again
AVERAGED: Final = 300.0  # s over which the level is averaged that a peak rises from
APART: Final = 0.045  # s at least between two looks at the margins: waves are slower
CLEAR: Final = 0.5  # mean deviations below that level that end a peak: noise does not
MOST: Final = 3.0  # of a margin: it is far beyond 1 then, however far
ALIKE: Final = 4.0  # peaks that tell as much as one alone: waves come in groups, and roll has two peaks in each
REJECTED: Final = 1.321
"""The statistic of Anderson and Darling above which 5 % of exponential samples lie, their mean not being known
(Stephens, "EDF statistics for goodness of fit and some comparisons", Journal of the American Statistical Association
69, 1974)."""

BULK, TAIL = 0.5, 0.75
"""Parts of the peaks that lie below the thresholds of the two laws."""

SHAPES: Final = (-0.5, 0.1)
"""Between what Pareto's shape is trusted: so few peaks tell no end of a tail, which a larger one would have."""

SOON: Final = 30.0
HOUR: Final = 3600.0


class PeakLaw(NamedTuple):
    """How peaks of a margin beyond a `threshold`, `rate` of them per s, are distributed.

    "rayleigh": the mean of x^2 - threshold^2 is `scale`; "pareto" with `scale` and `shape` (below 0 the tail is heavy);
    both from so many `independent` peaks. "unknown": there are too few.
    """

    name: str = "unknown"
    rate: float = 0.0
    threshold: float = 0.0
    scale: float = 1.0
    shape: float = 0.0
    independent: float = 1.0

    def passing(self, level: float) -> float:
        """How often per s a level not below the threshold is passed; its own uncertainty makes that more likely."""
        if self.name == "rayleigh":
            beyond = (level**2 - self.threshold**2) / (self.independent * self.scale)
            return self.rate * exp(-self.independent * log(1.0 + beyond))
        left = 1.0 - self.shape * (level - self.threshold) / self.scale
        return self.rate * exp(log(left) / self.shape) if left > 0.0 else 0.0

    def probability(self, seconds: float) -> float:
        """That 1 is passed within so many s."""
        if self.name == "unknown":
            return 0.0
        if self.threshold >= 1.0:
            return 1.0 - exp(-self.rate * seconds)
        return 1.0 - exp(-self.passing(1.0) * seconds)

    @property
    def maximum(self) -> float:
        """The most probable maximum of an hour."""
        number = max(1.0, self.rate * HOUR)
        if self.name == "rayleigh":
            return sqrt(self.threshold**2 + self.scale * log(number))
        return self.threshold + self.scale / self.shape * (1.0 - exp(-self.shape * log(number)))

    def values(self, name: str, soon: float, hour: float) -> dict[str, str]:
        """What a report tells of a margin by its name, which passes 1 in 30 s (`soon`) and in an `hour` so likely."""
        known = self.name != "unknown"
        return {
            f"{name}_probability_30_s": f"{soon:.3f}",
            f"{name}_probability_hour": f"{hour:.3f}" if known else "unknown",
            f"{name}_maximum_hour": f"{self.maximum:.3f}" if known else "unknown",
            f"{name}_peaks": self.name,
        }


class MarginPeaks:
    """Collects the peaks of the margins of some bodies, in bounded memory."""

    def __init__(self, count: int) -> None:
        self._peaks: NDArray[np.float64] = np.zeros((count, KEPT))
        self._times: NDArray[np.float64] = np.zeros((count, KEPT))
        self._seen: NDArray[np.int64] = np.zeros(count, dtype=np.int64)
        self._level, self._deviation, self._top = np.zeros(count), np.zeros(count), np.zeros(count)
        self._seconds = self._waiting = 0.0
        self._laws = [(0, PeakLaw())] * count

    def update(self, used: NDArray[np.float64], seconds: float) -> None:
        """Take the parts (n,) of the margins used up, so many s after those before."""
        self._waiting += seconds
        if self._waiting < APART:
            return
        used, seconds, self._waiting = np.minimum(used, MOST), self._waiting, 0.0
        self._seconds += seconds
        part = min(1.0, seconds / min(max(self._seconds, 1e-9), AVERAGED))
        off = used - self._level
        self._level += part * off
        self._deviation += part * (np.abs(off) - self._deviation)
        ended = (self._top > 0.0) & (off < -CLEAR * self._deviation)
        for number in np.flatnonzero(ended).tolist():
            place = self._seen[number] % KEPT
            self._peaks[number, place], self._times[number, place] = self._top[number], self._seconds
            self._seen[number] += 1
            self._top[number] = 0.0
        np.maximum(self._top, used, out=self._top, where=off > 0.0)

    def law(self, number: int) -> PeakLaw:
        """The law of the peaks of a body."""
        seen, (then, law) = int(self._seen[number]), self._laws[number]
        if seen >= ENOUGH and seen >= then + ANEW:
            begin = float(self._times[number, seen % KEPT]) if seen >= KEPT else 0.0
            law = law_of(self._peaks[number, : min(seen, KEPT)], self._seconds - begin)
            self._laws[number] = seen, law
        return law


def law_of(peaks: NDArray[np.float64], seconds: float) -> PeakLaw:
    """The law of peaks (n,) that came within so many s."""
    peaks = np.sort(peaks)
    threshold = float(peaks[int(BULK * len(peaks))])
    squares = peaks[peaks > threshold] ** 2 - threshold**2
    count = len(squares)
    if count < ENOUGH // 4:
        return PeakLaw()
    scale = float(squares.mean())
    # Of peaks that are alike the statistic is as many times larger.
    if _anderson_darling(squares / scale) <= ALIKE * REJECTED:
        return PeakLaw("rayleigh", count / seconds, threshold, scale, independent=count / ALIKE)
    threshold = float(peaks[int(TAIL * len(peaks))])
    above = peaks[peaks > threshold] - threshold
    count = len(above)
    if count < ENOUGH // 8:
        return PeakLaw()
    mean = float(above.mean())
    # Weights of a peak by the part of the others that are higher.
    higher = float((above * (np.arange(count, 0.0, -1.0) - 0.65) / count).mean())
    shape = mean / (mean - 2.0 * higher) - 2.0 if mean > 2.0 * higher else inf
    shape = min(max(shape, SHAPES[0]), SHAPES[1]) or 1e-9
    return PeakLaw("pareto", count / seconds, threshold, mean * (1.0 + shape), shape, count / ALIKE)


def _anderson_darling(sorted_ones: NDArray[np.float64]) -> float:
    """The statistic of an exponential distribution with the mean 1, which was found from the sample."""
    count = len(sorted_ones)
    lower = np.log(-np.expm1(-np.maximum(sorted_ones, 1e-12)))
    weights = 2.0 * np.arange(1, count + 1) - 1.0
    return float(-count - (weights * (lower - sorted_ones[::-1])).sum() / count) * (1.0 + 0.6 / count)
