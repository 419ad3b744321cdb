"""The harmonic prediction of a support's motion: on sums of waves, where it begins, and between its steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from impact_predictor.prediction.deck import harmonic as deck_harmonic
from impact_predictor.prediction.deck.harmonic import STEP, Harmonic, predicted
from impact_predictor.prediction.deck.motion import SupportState
from impact_predictor.prediction.types import Felt
from impact_predictor.prediction.vectors import axes_of, to_body, turned

Array = NDArray[np.float64]

NOTHING = (0.0, 0.0, 0.0)
LEVEL = (0.0, 0.0, 0.0, 1.0)
WAVES = np.array([[0.55, 0.3, 0.1], [0.8, 1.0, 2.0], [1.3, 0.4, 4.0], [1.9, 0.1, 1.0]])
"""Frequency in rad/s, height and phase."""


def signals(times: Array) -> Array:
    """Gravity felt and angular velocity, (n, 6), of a deck in some waves."""
    columns = []
    for channel in range(6):
        size = (0.3, 1.0, 0.8, 0.12, 0.05, 0.02)[channel]
        rows = sum(h * np.sin(w * times + p * (1 + channel)) for w, h, p in WAVES)
        columns.append(size * rows - (9.81 if channel == 2 else 0.0))
    return np.stack(columns, axis=1)


STILL = SupportState(
    stamp=0, position=NOTHING, orientation=LEVEL, axes=axes_of(LEVEL), velocity=NOTHING, angular=NOTHING
)


def known_at(time: float, off: Any = 0.0) -> SupportState:
    """What a tracker without error knows then; its frame does not turn, as the angular velocities stay small here."""
    before, now, after = signals(np.array([time - 1e-4, time, time + 1e-4])) + off
    turning = tuple(((after[3:] - before[3:]) / 2e-4).tolist())
    felt, angular = tuple(now[:3].tolist()), tuple(now[3:].tolist())
    return STILL._replace(stamp=round(time * 1e9), angular=angular, felt=felt, turning=turning)


def fitted(until: float = 30.0, rate: float = 20.0, window: float = 20.0, begin: float = 0.0) -> Harmonic:
    harmonic = Harmonic(window)
    for time in np.arange(begin, until, 1.0 / rate):
        harmonic.add(known_at(float(time)))
    return harmonic


@pytest.mark.parametrize(("time", "error"), [(0.25, 0.005), (1.0, 0.05), (2.0, 0.25), (5.0, 0.6)])
def test_waves_of_four_frequencies_are_told_ahead(time: float, error: float) -> None:
    harmonic = fitted()
    course = harmonic._fit
    assert course is not None
    now = course.time_of(30 * 10**9)
    wanted = signals(np.array([30.0 + time]))[0]
    force, angular, _, _ = course.at(now + time)
    deviations = signals(np.arange(0.0, 60.0, 0.1)).std(0)
    # Parts of the deviation. Straight lines between messages 50 ms apart are off by up to 3e-4 of a wave: the only
    # noise here, which a recursion over 3.2 s multiplies when it is led on for longer than that.
    assert np.abs((np.array([*force, *angular]) - wanted) / deviations).max() < error


@pytest.mark.parametrize("offset", [0.0, 0.1])
@pytest.mark.parametrize("time", [29.97, 30.0, 30.17])
def test_it_begins_with_the_estimate_of_now_whatever_the_fit_says(time: float, offset: float) -> None:
    harmonic = fitted()
    known = known_at(time, offset)
    felt = harmonic.ahead(known)(0.0)
    # The offsets are differences from the course, which they are then added to: roundings of 10 m/s^2.
    assert felt.gravity == pytest.approx(known.felt, abs=1e-13)
    assert felt.angular == pytest.approx(known.angular, abs=1e-14)
    assert felt.turning == pytest.approx(known.turning, abs=1e-14)


@pytest.mark.parametrize("offset", [0.0, 0.1])
def test_what_is_ahead_is_smooth_and_its_parts_belong_together(offset: float) -> None:
    harmonic = fitted()
    on = harmonic.ahead(known_at(30.0, offset))
    step = 1e-5
    for time in np.linspace(-0.3, 6.0, 64).tolist():
        before, now, after = on(time - step), on(time), on(time + step)
        turning = (np.array(after.angular) - np.array(before.angular)) / (2.0 * step)
        # A central difference over a corner of the curvature, of up to 10 rad/s^3 where an offset begins to fade.
        assert turning == pytest.approx(now.turning, abs=10.0 * step)
        # In the frame that does not turn what is felt has no jump.
        assert np.array(after.gravity) == pytest.approx(np.array(before.gravity), abs=50.0 * step)


def test_gravity_ahead_is_seen_along_the_axes_of_then() -> None:
    harmonic = Harmonic(4.0)
    rate = 0.2
    still = STILL._replace(angular=(rate, 0.0, 0.0), felt=(0.0, 0.0, -9.81))
    for k in range(100):
        orientation = turned(LEVEL, (rate * k * 0.1, 0.0, 0.0))
        known = still._replace(stamp=k * STEP, orientation=orientation, axes=axes_of(orientation))
        harmonic.add(known)
    assert harmonic.fitted
    for time in (0.0, 0.3, 2.0):
        orientation = turned(LEVEL, (rate * (9.9 + time), 0.0, 0.0))
        wanted = Felt(to_body(axes_of(orientation), (0.0, 0.0, -9.81)), (rate, 0.0, 0.0), NOTHING)
        assert np.allclose(harmonic.ahead(known)(time), wanted, atol=1e-12)  # roundings of 10 m/s^2


SHAPES: dict[str, Any] = {
    "noise": lambda times, rng: rng.standard_normal((len(times), 6)),
    "ramp": lambda times, rng: np.outer(times, np.ones(6)),
    "growing": lambda times, rng: np.outer(np.exp(0.4 * times) * np.sin(times), np.ones(6)),
    "square": lambda times, rng: np.outer(np.sign(np.sin(times)), np.ones(6)),
}


@given(st.sampled_from(list(SHAPES)), st.integers(20, 200), st.floats(-1e12, 1e12), st.integers(0, 2**32))
@settings(max_examples=100, deadline=None)
def test_whatever_the_course_was_its_prediction_stays_within_bounds(
    shape: str, count: int, size: float, seed: int
) -> None:
    rows = size * SHAPES[shape](np.arange(count) / 10.0, np.random.default_rng(seed))
    course = predicted(rows)
    assert np.isfinite(course).all()
    mean = rows.mean(0)
    limit = deck_harmonic.LIMIT * np.abs(rows - mean).max(0)
    assert (np.abs(course - mean) <= limit * (1.0 + 1e-9) + 1e-12 * np.abs(mean)).all()
