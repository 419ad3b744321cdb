"""How the feet of a machine usually come down, as their landings show it."""

from __future__ import annotations

from math import sqrt

from .cubic import SCALE, Fit

JERK = 1000.0
"""Standard deviation in m/s^3 of how the acceleration of a foot changes, as long as none has landed."""

DIFFERENCE = 0.2
"""A foot comes down otherwise than before by this part of the mean at least."""

FORGETS = 0.98
"""Part of what was known before that counts beside one more landing."""

LEAST = 0.01
"""A descent tells something by itself from this part of what is known in the end."""

SURELY = 100.0
"""m/s^3 by which the next descent may differ, however alike the last ones were: a machine may change its gait."""

UNIT = SCALE**3 / 6.0
"""The third power's coefficient in a fit of a jerk of 1 m/s^3."""


class Habit:
    """Mean and deviation of the jerk of feet that come down: what noise hides of it in one descent, many show."""

    def __init__(self) -> None:
        self._mean = 0.0
        self._square = JERK * JERK
        self._precision = 1.0 / self._square

    def learn(self, fit: Fit) -> None:
        """Take the cubic of a descent that has ended on the ground.

        What the descent itself tells is learnt, without the habit that was in its fit: else that would confirm itself.
        """
        weight, usual = fit.prior
        whole = 1.0 / fit.factor[9] ** 2
        own = whole - weight
        if own <= LEAST * whole:
            return
        jerk, doubt = (whole * fit.gap[3] - weight * usual) / own / UNIT, fit.deviation / sqrt(own) / UNIT
        # What noise adds to a jerk is none of the habit: an unsure one counts less, and spreads less than it seems to.
        precision = 1.0 / (doubt * doubt + SURELY * SURELY)
        self._precision = FORGETS * self._precision + precision
        share, off = precision / self._precision, jerk - self._mean
        self._mean += share * off
        self._square = max(0.0, self._square + share * (off * off - doubt * doubt - self._square))

    def prior(self, noise: float) -> tuple[float, float]:
        """Weight and value of the third power's coefficient, before the frames of noise (m) are seen."""
        deviation = max(SURELY, sqrt(self._square) + DIFFERENCE * abs(self._mean))
        return (noise / (deviation * UNIT)) ** 2, self._mean * UNIT
