"""The largest accelerations that units feel on a deck that rolls, against those of a pendulum motion by hand."""

from __future__ import annotations

from math import cos, pi, sin

import pytest

from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.felt import FeltMonitor
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import Sample
from impact_predictor.stamps import NANOSECONDS

ROLL, RATE, GRAVITY = 0.2, 2.0 * pi / 4.0, 9.81
"""Amplitude in rad and frequency in rad/s of the roll."""


def rolling(time: float) -> Sample:
    angle, rate = ROLL * sin(RATE * time), ROLL * RATE * cos(RATE * time)
    return Sample(
        stamp=NANOSECONDS + round(time * NANOSECONDS),
        frame_id="world",
        child_frame_id="deck",
        position=(0.0, 0.0, 0.0),
        orientation=(sin(0.5 * angle), 0.0, 0.0, cos(0.5 * angle)),
        linear=(0.0, 0.0, 0.0),
        angular=(rate, 0.0, 0.0),
        pose_covariance=(0.0,) * 36,
        twist_covariance=(0.0,) * 36,
    )


@pytest.mark.parametrize("height", [-8.0, 0.0, 8.0])
def test_a_unit_above_the_axis_of_roll_feels_more_across_the_deck_and_one_below_it_less(height: float) -> None:
    scene = {
        "body.mass": 100.0,
        "body.inertia": [10.0, 10.0, 10.0, 0.0, 0.0, 0.0],
        "body.contact_points": [x for a in (-0.5, 0.5) for b in (-0.5, 0.5) for x in (a, b, 0.0)],
        "contact.friction": 0.4,
        "support.motion": "odom",
        "support.window": 0.1,
        "source": "none",
        "place.position": [0.0, 0.0, height],
    }
    monitor = FeltMonitor(scenes_of(validate(scene)))
    for k in range(400):
        monitor.update_support(rolling(0.02 * k))
    (found,) = monitor.largest.values()
    across = GRAVITY * sin(ROLL) + height * ROLL * RATE * RATE
    assert found[0] == pytest.approx(0.0, abs=1e-9)
    assert found[1] == pytest.approx(abs(across), rel=0.02)
