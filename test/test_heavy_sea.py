"""An hour of heavy sea, simulated, recorded and replayed: what was predicted against what happened."""

from __future__ import annotations

from pathlib import Path

import pytest

from impact_predictor.bags.replay import Result, replay
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import Scene, scenes_of
from impact_predictor.scenarios.deck.record import Sensors
from impact_predictor.scenarios.deck.sea import SeaState, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in
from impact_predictor.scenarios.deck.voyage import sail

pytestmark = pytest.mark.slow

RATE = 20.0
"""Samples a second, of each unit and of the deck."""


def scenes() -> dict[str, Scene]:
    return scenes_of(read_values(Path(__file__).parent / "heavy_sea.yaml"))


def predicted(folder: Path, seconds: float, scenes: dict[str, Scene], contacts: str = "rigid") -> Result:
    """Sail, and replay the record."""
    bag = folder / "cargo.mcap"
    deck = deck_in(waves_of(SeaState(1.6, 4.0), seed=1), Vessel())
    sail(scenes, deck, seconds, contacts, bag, Sensors(RATE, RATE))
    return replay(bag, scenes)


def test_an_hour_of_hundreds_of_impacts_is_predicted_and_every_unit_warned_of_in_time(tmp_path: Path) -> None:
    hour = predicted(tmp_path, 3600.0, scenes())
    truth = hour.truth
    assert truth is not None
    assert truth.touchdowns >= 300
    assert sum(one.truth is not None and one.truth.touchdowns >= 20 for one in hour.truths.values()) >= 3
    # At 20 samples a second the last sample before an impact may come before the body turns back.
    assert truth.missed <= 0.06 * truth.touchdowns
    assert truth.false <= 0.02 * truth.touchdowns

    assert truth.clear >= 300
    assert truth.clear_mode_accuracy is not None
    assert truth.clear_mode_accuracy >= 0.97
    assert truth.median_velocity_error is not None
    assert truth.median_velocity_error <= 0.02
    assert truth.median_time_error is not None
    assert truth.median_time_error <= 1e-3

    for one in hour.truths.values():
        assert one.warned is not None
        assert one.warned.before_first_impact is True


def test_contacts_that_know_no_impact_law_come_to_the_same(tmp_path: Path) -> None:
    # Springs and dampers give way by a part of a millimetre, which the tolerance has to allow.
    boxes = {name: scene._replace(tolerance=1e-3) for name, scene in scenes().items() if scene.points}
    truth = predicted(tmp_path, 60.0, boxes, "compliant").truth
    assert truth is not None
    assert truth.touchdowns - truth.missed >= 5
    assert truth.clear_mode_accuracy is not None
    assert truth.clear_mode_accuracy >= 0.97
    assert truth.median_velocity_error is not None
    assert truth.median_velocity_error <= 0.02
