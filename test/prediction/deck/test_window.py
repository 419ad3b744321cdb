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


@given(STEPS, st.tuples(*[st.floats(-10.0, 10.0)] * 3))
@settings(max_examples=200, deadline=None)
def test_the_slope_of_a_parabola_is_exact_at_irregular_stamps(steps: list[int], factors: tuple[float, ...]) -> None:
    a, b, c = factors
    stamps = (np.cumsum(steps) * 1_000_000).tolist()
    times = [stamp / 1e9 for stamp in stamps]
    window = MotionWindow(0.2, 1)
    full = False
    for stamp, t in zip(stamps, times, strict=True):
        full = window.add(stamp, (a + b * t + c * t * t,))
    if full:
        # Clumps are told apart from 1e-6 of an even determinant on, so rounding of 1e-15 grows to 1e-9 at most, over
        # a span of 0.2 s.
        assert window.slopes()[0] == pytest.approx(b + 2.0 * c * times[-1], abs=1e-7)


def test_the_slope_is_exact_to_rounding_where_stamps_are_even() -> None:
    times = np.arange(21) / 100.0
    window = filled(0.2, (np.arange(21) * 10_000_000).tolist(), (7.0 + 3.0 * times - 5.0 * times**2).tolist())
    assert window.slopes()[0] == pytest.approx(3.0 - 10.0 * times[-1], abs=1e-12)  # 20 roundings of 7, over 0.2 s


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


def test_stamps_in_two_clumps_give_the_slope_of_the_line_between_them() -> None:
    stamps = [0, 10, 199_999_990, 200_000_000]
    window = filled(0.2, stamps, [1.0, 1.0, 3.0, 3.0])
    assert window.slopes()[0] == pytest.approx(10.0, rel=1e-6)  # the clumps are 1e-7 of the span wide


def test_the_end_of_a_line_is_exact() -> None:
    rng = np.random.default_rng(1)
    stamps = np.cumsum(rng.integers(5, 15, 40) * 1_000_000).tolist()
    values = [2.0 - 3.0 * stamp / 1e9 for stamp in stamps]
    assert filled(0.2, stamps, values).ends()[0] == pytest.approx(values[-1], abs=1e-13)  # roundings of 2


@pytest.mark.parametrize(("rate", "span"), [(100, 0.2), (100, 0.5), (10, 0.5), (200, 0.1)])
def test_noise_of_the_slope_is_as_documented(rate: int, span: float) -> None:
    count = round(rate * span) + 1
    x = np.linspace(-1.0, 1.0, count)
    deviation = float(np.linalg.norm(slope_weights(x.tolist()))) * 2.0 / span
    told = 13.9 / (span * count**0.5)
    assert 0.65 * told < deviation < 1.02 * told  # the formula is that of many samples; few have less


@pytest.mark.parametrize("omega", [0.5, 1.0, 2.0])
def test_the_error_of_the_slope_of_a_harmonic_is_as_documented(omega: float) -> None:
    span = 0.2
    times = np.arange(-20, 1) / 100.0
    weights = np.array(slope_weights((1.0 + 2.0 * times / span).tolist())) * 2.0 / span
    errors = [abs(weights @ np.sin(omega * times + p) - omega * np.cos(p)) for p in np.linspace(0.0, np.pi, 60)]
    assert max(errors) / omega == pytest.approx(0.1 * (omega * span) ** 2, rel=0.1)


def test_it_is_full_when_three_samples_span_it_and_keeps_no_more_than_needed() -> None:
    window = MotionWindow(0.2, 1)
    assert not window.add(0, (0.0,))
    assert not window.add(300_000_000, (0.0,))  # it spans, but two tell no parabola
    assert window.add(310_000_000, (1.0,))
    window.clear()
    answers = [window.add(stamp * 10_000_000, (0.0,)) for stamp in range(30)]
    assert answers == [False] * 20 + [True] * 10


def test_samples_older_than_the_window_are_forgotten() -> None:
    times = np.arange(100) / 100.0
    bent = np.where(times < 0.7, 100.0 * np.sin(40.0 * times), 3.0 * times)
    assert filled(0.2, (np.arange(100) * 10_000_000).tolist(), bent.tolist()).slopes()[0] == pytest.approx(3.0)


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
