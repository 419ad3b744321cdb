"""The paper's falling rods: what is predicted of them, what was seen, and which predictions are flagged."""

from __future__ import annotations

import math

import falling_rods
import pytest
from falling_rods import LENGTH, THICKNESSES, border, falling, trial

from impact_predictor import Flag, Mode, rod

FRICTION = 0.4
ANGLES = (15.0, 30.0)
"""degrees, the least and the greatest from which the rods were released at rest."""

DOUBTS = Flag.THIN_BODY | Flag.SLOW_IMPACT


def trials(angle):
    return [one for row in falling_rods.trials(FRICTION, angle) for one in row]


@pytest.mark.parametrize("angle", ANGLES)
def test_whatever_was_seen_to_be_otherwise_than_predicted_is_flagged(angle):
    assert all(trial.agrees or trial.doubted for trial in trials(angle))


@pytest.mark.parametrize("angle", ANGLES)
def test_thick_rods_on_supports_not_too_close_are_predicted_as_seen_and_not_flagged(angle):
    chosen = [trial for trial in trials(angle) if trial.thickness > 0.002 and trial.a >= 0.05]
    assert len(chosen) > 30
    assert all(trial.agrees and not trial.outcome.flags & DOUBTS for trial in chosen)
    assert {trial.outcome.mode for trial in chosen} == {Mode.STOP, Mode.PIVOT}


def test_the_rod_of_2_mm_is_thin_and_that_of_5_mm_is_not():
    flagged = {h: bool(trial(h, 0.1, 0.1, FRICTION, 30.0).outcome.flags & Flag.THIN_BODY) for h in THICKNESSES}
    assert flagged == {0.020: False, 0.010: False, 0.005: False, 0.002: True}


@pytest.mark.parametrize("angle", ANGLES)
def test_the_rod_that_turned_back_about_a_support_close_to_its_middle_struck_slowly(angle):
    for b in (0.1, 0.2):
        found = trial(0.01, 0.01, b, FRICTION, angle)
        assert found.observed is Mode.BACK_PIVOT
        assert found.outcome.flags & Flag.SLOW_IMPACT


@pytest.mark.parametrize("thickness", [0.0, *THICKNESSES])
def test_a_rod_stops_where_12_ab_is_l_squared_and_3_h_squared(thickness):
    # A thin one from a = l / sqrt 12 = 115.47 mm on.
    expected = math.sqrt((LENGTH**2 + 3.0 * thickness**2) / 12.0)
    assert border(thickness, FRICTION) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("angle", ANGLES)
def test_a_thin_rod_strikes_with_the_angular_velocity_of_2_1(angle):
    body = rod(length=0.4, thickness=0.0, a=0.075, b=0.05, mass=1.0, friction=0.0)
    expected = math.sqrt(24.0 * 9.81 * 0.075 / (0.4**2 + 12.0 * 0.075**2) * math.sin(math.radians(angle)))
    assert falling(body, math.radians(angle)).omega == pytest.approx(-expected, rel=1e-12)


def test_its_table_tells_which_of_the_rods_are_as_seen(capsys):
    falling_rods.main([])
    assert "As seen: 45 of 68; of the 23 others 23 are flagged." in capsys.readouterr().out
    assert sum(trial.agrees for trial in trials(15.0)) == 45
    thin = [trial for trial in trials(15.0) if trial.thickness == 0.002]
    assert all(trial.observed is Mode.FLIGHT and trial.outcome.flags & Flag.THIN_BODY for trial in thin)


def test_an_angle_from_which_no_rod_falls_back_is_refused_in_a_sentence():
    with pytest.raises(SystemExit, match=r"^error: a body raised by 60 degrees does not fall back; give a smaller"):
        falling_rods.main(["--angle", "60"])
