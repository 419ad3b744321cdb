"""What is usual on a moving support: to where its motion returns, and how soon."""

from __future__ import annotations

from math import sqrt

from ..types import Vector3
from ..vectors import dot, to_body
from .motion import Known, blend

MEAN = 60.0
"""s over which means are taken, about ten waves."""

START = 5.0
"""s for which the support counts as level and slow before its first message: a mean does not begin with a wave."""

SLOW = 1e-6, 1e-6
"""Mean squares of the angular velocity (rad/s) and of its derivative then: waves of 6 s, too low to be seen."""

QUARTER = 1.4
"""rad after which a wave is no longer like what it was: nearly a quarter of it."""


class Usual:
    """The `mean` of the gravity felt, along the support's axes, and the mean frequency with which it turns."""

    def __init__(self, still: Vector3) -> None:
        self.mean = still
        self._time = START
        self._angular, self._turning = SLOW

    @property
    def quarter(self) -> float:
        """The time in s after which what is felt now says nothing. Noise of the accelerations makes it shorter."""
        return QUARTER * sqrt(self._angular / self._turning)

    def add(self, known: Known, time: float) -> None:
        """Take what was known for a time in s."""
        self._time = min(self._time + time, MEAN)
        part = min(time / self._time, 1.0)
        self.mean = blend(self.mean, to_body(known.axes, known.felt), part)
        self._angular += part * (dot(known.angular, known.angular) - self._angular)
        self._turning += part * (dot(known.turning, known.turning) - self._turning)
