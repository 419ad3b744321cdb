"""The next touchdown against 40 digits, which share no formula with it but the equation of a stance that slips."""

from __future__ import annotations

import json
from math import inf
from pathlib import Path

import pytest
from touchdown_digits import errors_of, reference_of

from impact_predictor.mechanics.motion import next_touchdown
from impact_predictor.mechanics.types import Twist
from impact_predictor.report.accuracy import AccuracyScene, problems, touchdowns
from impact_predictor.report.accuracy.touchdowns import PredictedTouchdown, falling

GOLDEN = Path(__file__).parent / "golden" / "motion.json"


@pytest.mark.parametrize("fall", json.loads(GOLDEN.read_text())["falls"][:6])
def test_forty_digits_meet_the_golden_falls(fall: dict[str, str]) -> None:
    a, h, rho_squared, angle, omega = (float(fall[key]) for key in ("a", "h", "rho2", "phi0", "omega0"))
    found = reference_of(falling((a, h, rho_squared), angle, omega, friction=inf))
    # The golden numbers belong to the decimal inputs, which the floats are only near to.
    assert float(found.time) == pytest.approx(float(fall["touchdown_time"]), rel=1e-14)
    assert float(found.twist[2]) == pytest.approx(float(fall["touchdown_omega"]), rel=1e-14)


@pytest.mark.parametrize("scene", touchdowns.SCENES, ids=lambda scene: scene.name)
def test_the_next_touchdown_and_the_reference_of_the_report_meet_forty_digits(scene: AccuracyScene) -> None:
    for fall in problems(touchdowns.SCENES[scene], scene.name, 3):
        end = next_touchdown(*fall, tolerance=1e-10)
        found = PredictedTouchdown(end.time, Twist(end.state.vx, end.state.vy, end.state.omega))
        assert max(errors_of(fall, found)) < 1e-12 if scene.name == "balance" else 1e-13
        assert max(errors_of(fall, touchdowns.reference_of(fall))) < 1e-10
