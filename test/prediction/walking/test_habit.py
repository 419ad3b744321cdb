"""What is learnt of how feet come down."""

from __future__ import annotations

import numpy as np
import pytest

from impact_predictor.prediction.walking.cubic import Fit, factored
from impact_predictor.prediction.walking.habit import SURELY, UNIT, Habit

NOISE = 1e-4


def descent(jerk: float, habit: Habit, doubt: float = 20.0) -> Fit:
    """A descent whose frames alone show a jerk (m/s^3) to a doubt, fitted with the habit so far."""
    weight, usual = habit.prior(NOISE)
    own = (NOISE / (doubt * UNIT)) ** 2
    c3 = (own * jerk * UNIT + weight * usual) / (own + weight)
    factor = factored((1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, own + weight))
    assert factor is not None
    return Fit(0, 1.0, (0.1, 0.0, 0.0, c3), factor, 0.0, NOISE, True, (weight, usual))


def usual_jerk(habit: Habit) -> float:
    return habit.prior(NOISE)[1] / UNIT


def deviation(habit: Habit) -> float:
    return NOISE / np.sqrt(habit.prior(NOISE)[0]) / UNIT


def test_feet_that_come_down_alike_are_learnt() -> None:
    habit = Habit()
    for _ in range(30):
        habit.learn(descent(500.0, habit))
    # The first guess of 0 has the weight of a landing known to 1000 m/s^3.
    assert usual_jerk(habit) == pytest.approx(500.0, rel=0.01)
    assert deviation(habit) < 300.0


def test_a_habit_does_not_confirm_itself_when_the_gait_changes() -> None:
    habit = Habit()
    for _ in range(20):
        habit.learn(descent(0.0, habit))
    assert deviation(habit) == pytest.approx(SURELY)
    for _ in range(150):
        habit.learn(descent(800.0, habit))
    assert usual_jerk(habit) == pytest.approx(800.0, rel=0.1)


def test_the_noise_of_descents_is_no_spread_of_the_habit() -> None:
    habit, source = Habit(), np.random.default_rng(0)
    for _ in range(200):
        habit.learn(descent(500.0 + source.normal(0.0, 2000.0), habit, doubt=2000.0))
    assert usual_jerk(habit) == pytest.approx(500.0, abs=600.0)
    assert deviation(habit) < 1300.0


def test_a_descent_that_tells_nothing_by_itself_teaches_nothing() -> None:
    habit = Habit()
    before = habit.prior(NOISE)
    habit.learn(descent(1e6, habit, doubt=1e6))
    assert habit.prior(NOISE) == before
