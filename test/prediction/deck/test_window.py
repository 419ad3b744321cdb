"""Slopes and ends of sampled signals against polynomials that have them exactly, numpy's fits, and known noise."""

from __future__ import annotations

from math import inf, isfinite

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from impact_predictor.prediction.deck.window import MotionWindow, slope_weights

STEPS = st.lists(st.integers(1, 60), min_size=3, max_size=40)
"""ms between stamps"""


def filled(span: float, stamps: list[int], *signals: list[float]) -> MotionWindow:
    window = MotionWindow(span, len(signals))
    for stamp, *values in zip(stamps, *signals, strict=True):
        window.add(stamp, tuple(values))
    return window


def test_a_large_constant_leaves_no_rounding_in_the_slope() -> None:
    times = np.arange(21) / 100.0
    stamps = (np.arange(21) * 10_000_000).tolist()
    assert filled(0.2, stamps, [1e9] * 21).slopes()[0] == 0.0
    slope = filled(0.2, stamps, (1e4 + 2.0 * times).tolist()).slopes()[0]
    assert slope == pytest.approx(2.0, abs=1e-9)  # rounding of 1e4 is 2e-12, times 13.9/(0.2 sqrt(21))


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


def test_stamps_in_two_clumps_give_the_slope_of_the_line_between_them() -> None:
    stamps = [0, 10, 199_999_990, 200_000_000]
    window = filled(0.2, stamps, [1.0, 1.0, 3.0, 3.0])
    assert window.slopes()[0] == pytest.approx(10.0, rel=1e-6)  # the clumps are 1e-7 of the span wide


def test_the_end_of_a_line_is_exact() -> None:
    rng = np.random.default_rng(1)
    stamps = np.cumsum(rng.integers(5, 15, 40) * 1_000_000).tolist()
    values = [2.0 - 3.0 * stamp / 1e9 for stamp in stamps]
    assert filled(0.2, stamps, values).ends()[0] == pytest.approx(values[-1], abs=1e-13)  # roundings of 2


@given(st.lists(st.tuples(st.integers(1, 2**62), st.floats(-1e12, 1e12)), min_size=3, max_size=20))
@settings(max_examples=200, deadline=None)
def test_whatever_the_stamps_and_values_slopes_and_ends_are_numbers(samples: list[tuple[int, float]]) -> None:
    window = MotionWindow(1e-9, 1)
    last = -1
    for stamp, value in sorted(samples):
        if stamp > last:
            last = stamp
            if window.add(stamp, (value,)):
                assert all(isfinite(number) and abs(number) < inf for number in (*window.slopes(), *window.ends()))
