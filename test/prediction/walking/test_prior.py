"""What is learnt of how feet come down."""

from __future__ import annotations

import numpy as np
import pytest

from impact_predictor.prediction.walking.cubic import SCALE, Fit, factored
from impact_predictor.prediction.walking.trajectory import JERK_UNIT, LEAST_DEVIATION, DescentPrior

NOISE = 1e-4


def descent(jerk: float, prior: DescentPrior, doubt: float = 20.0) -> Fit:
    """A descent whose frames alone show a jerk (m/s^3) to a doubt, fitted with the prior so far."""
    weight, expected = prior.coefficient(NOISE)
    own = (NOISE / (doubt * JERK_UNIT)) ** 2
    c3 = (own * jerk * JERK_UNIT + weight * expected) / (own + weight)
    factor = factored((1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, own + weight))
    assert factor is not None
    return Fit(0, 1.0, (0.1, 0.0, 0.0, c3 / SCALE**3), factor, 0.0, NOISE, True, (weight, expected))


def mean_jerk(prior: DescentPrior) -> float:
    return prior.coefficient(NOISE)[1] / JERK_UNIT


def deviation(prior: DescentPrior) -> float:
    return NOISE / np.sqrt(prior.coefficient(NOISE)[0]) / JERK_UNIT


def test_feet_that_come_down_alike_are_learnt() -> None:
    prior = DescentPrior()
    for _ in range(30):
        prior.learn(descent(500.0, prior))
    # The first guess of 0 has the weight of a landing known to 1000 m/s^3.
    assert mean_jerk(prior) == pytest.approx(500.0, rel=0.01)
    assert deviation(prior) < 300.0


def test_a_prior_does_not_confirm_itself_when_the_gait_changes() -> None:
    prior = DescentPrior()
    for _ in range(20):
        prior.learn(descent(0.0, prior))
    assert deviation(prior) == pytest.approx(LEAST_DEVIATION)
    for _ in range(150):
        prior.learn(descent(800.0, prior))
    assert mean_jerk(prior) == pytest.approx(800.0, rel=0.1)


def test_the_noise_of_descents_is_no_spread_of_the_prior() -> None:
    prior, source = DescentPrior(), np.random.default_rng(0)
    for _ in range(200):
        prior.learn(descent(500.0 + source.normal(0.0, 2000.0), prior, doubt=2000.0))
    assert mean_jerk(prior) == pytest.approx(500.0, abs=600.0)
    assert deviation(prior) < 1300.0


def test_a_descent_that_tells_nothing_by_itself_teaches_nothing() -> None:
    prior = DescentPrior()
    before = prior.coefficient(NOISE)
    prior.learn(descent(1e6, prior, doubt=1e6))
    assert prior.coefficient(NOISE) == before
