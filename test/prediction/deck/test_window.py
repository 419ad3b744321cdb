"""Slopes and ends of sampled signals against polynomials that have them exactly, numpy's fits, and known noise."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from impact_predictor.prediction.deck.motion import slope_weights


@given(st.lists(st.floats(-0.99, 0.99), min_size=1, max_size=30))
@settings(max_examples=200, deadline=None)
def test_weights_are_those_of_the_least_squares_parabola(inner: list[float]) -> None:
    x = [-1.0, *inner, 1.0]
    weights = np.array(slope_weights(x))
    powers = np.vander(x, 3, increasing=True)
    if np.linalg.cond(powers) < 100.0:
        wanted = np.array([0.0, 1.0, 2.0]) @ np.linalg.pinv(powers)
        assert weights == pytest.approx(wanted, abs=1e-10)  # rounding times the square of the condition


def test_noise_and_lag_of_a_slope_are_those_that_its_window_is_chosen_by() -> None:
    x = np.linspace(-1.0, 1.0, 81)
    weights = np.array(slope_weights(x.tolist()))
    # With n samples over T s 13.9 s/(T sqrt(n)), and 0.1 (w T)^2 of a derivative of frequency w: here T is 2.
    assert np.linalg.norm(weights) == pytest.approx(13.9 / (2.0 * 9.0), rel=0.03)
    for w in (0.1, 0.05):
        assert weights @ np.sin(w * (x - 1.0)) / w - 1.0 == pytest.approx(0.1 * (2.0 * w) ** 2, rel=0.05)
