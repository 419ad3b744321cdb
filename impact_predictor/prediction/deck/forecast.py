"""What will be felt on a moving support over the next seconds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..types import Moment
from .usual import Usual

Array = NDArray[np.float64]


def forecast(moment: Moment, usual: Usual | None, times: Array) -> tuple[Array, Array, Array]:
    """Gravity felt, angular velocity and angular acceleration at times (n,) after a moment, each (n, 3).

    Where what is `usual` is given, what `ahead` says goes over to it, and to no rotation, as exp(-(t / quarter)^2).
    """
    felt = np.array([moment.ahead(time) for time in times.tolist()]).reshape(len(times), 3, 3)
    if usual is not None:
        rest = np.array((usual.mean, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
        felt = rest + np.exp(-np.square(times / usual.quarter))[:, None, None] * (felt - rest)
    return felt[:, 0], felt[:, 1], felt[:, 2]
