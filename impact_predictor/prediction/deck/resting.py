"""A support at rest, told as a moving one is: what the watch over the bodies on it asks for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..types import Felt, Moment, Vector3

Forecast = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]

_NOTHING: Vector3 = (0.0, 0.0, 0.0)


class Resting:
    """Gravity (m/s^2) and nothing else is felt, now and later."""

    def __init__(self, gravity: Vector3) -> None:
        self._felt = Felt(gravity, _NOTHING, _NOTHING)

    def at(self, stamp: int) -> Moment:
        """The support at a stamp in ns, in its own frame."""
        return Moment(stamp, "", "", _NOTHING, (0.0, 0.0, 0.0, 1.0), _NOTHING, self._felt, lambda time: self._felt)

    def forecast(self, times: NDArray[np.float64]) -> Forecast:
        """Gravity, angular velocity and acceleration at times ahead, of shape (n,), as three arrays of (n, 3)."""
        shape = (len(times), 3)
        return np.broadcast_to(np.array(self._felt.gravity), shape), np.zeros(shape), np.zeros(shape)
