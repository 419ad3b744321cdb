"""What one impact with uncertain inputs does, by the points that carry the uncertainty of predictions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from impact_predictor.mechanics.types import Twist, TwoPointBody
from impact_predictor.prediction.types import Covariance
from impact_predictor.prediction.uncertainty import factor_of, impacts, moments, normal_points, probabilities, product


class Spread(NamedTuple):
    """What an uncertain impact does.

    `probabilities` of the modes, by their numbers; `mean` and `covariance` (3, 3) of the twist after it, in m/s and
    rad/s; what became of the covariance of the twist before it.
    """

    probabilities: tuple[float, ...]
    mean: Twist
    covariance: NDArray[np.float64]
    given: Covariance


def propagate(
    body: TwoPointBody,
    twist: Twist,
    covariance: NDArray[np.float64] | Sequence[Sequence[float]],
    friction: float = 0.0,
    restitution: float = 0.0,
    law: str = "path",
    samples: int = 128,
) -> Spread:
    """What an impact does whose inputs are uncertain.

    `covariance` (3, 3) is that of the twist before it, in m/s and rad/s; `friction` the standard deviation of the
    friction of both contacts, which vary together, and `restitution` that of the new contact's; `samples` as in
    `normal_points`; the rest as in `solve_impact`.
    """
    factor, given = factor_of(tuple(np.asarray(covariance, np.float64).ravel().tolist()))
    points = normal_points(samples, 5)
    outcomes = impacts(body, twist, product(factor, points[:3]), friction * points[3], restitution * points[4], law)
    mean, spread = moments(outcomes.twist.T)
    return Spread(probabilities(outcomes), Twist(*mean.tolist()), spread, given)
