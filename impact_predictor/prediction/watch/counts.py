"""Counts of onsets and impacts per hour.

Onsets are counted as motion-induced interruptions are: each time that the part of the margin which is used up passes 1,
a body that stands freely would begin to slide or to tip (Graham, Motion-induced interruptions as ship operability
criteria, Naval Engineers Journal, 1990; Graham, Baitis and Meyers, On the development of seakeeping criteria, Naval
Engineers Journal, 1992). Here each body feels its own acceleration, and the next onset counts once the part has been
below 1 by a hysteresis.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST: Final = 60.0
"""s: a shorter watch is told as one of a minute, so that a single onset is not a thousand per hour."""

HOUR: Final = 3600.0


class OnsetCounts:
    """How often each of some bodies began to tip and to slide, and struck."""

    def __init__(self, hysteresis: Array) -> None:
        count = len(hysteresis)
        self._again = 1.0 - hysteresis
        self._over = np.zeros((2, count), dtype=bool)
        self._onsets = np.zeros((2, count), dtype=np.int64)
        self._impacts = [0] * count
        self._seconds = 0.0

    def update(self, tip: Array, slide: Array, seconds: float) -> None:
        """Take the parts (n,) of the margins used up, so many s after those before."""
        self._seconds += seconds
        used = np.array((tip, slide))
        over = used >= 1.0
        begun = over > self._over
        if begun.any():
            self._onsets += begun
        self._over = over | (self._over & (used > self._again))

    def struck(self, number: int) -> None:
        """Count an impact of a body."""
        self._impacts[number] += 1

    def per_hour(self, number: int) -> tuple[float, float, float]:
        """Tips, slides and impacts of a body per hour of the time watched."""
        scale = HOUR / max(self._seconds, LEAST)
        tips, slides = self._onsets[:, number].tolist()
        return tips * scale, slides * scale, self._impacts[number] * scale
