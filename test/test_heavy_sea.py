"""Heavy sea, simulated, recorded and replayed: what was predicted against what happened."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from impact_predictor.bags.replay import Result, replay
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import Scene, scenes_of
from impact_predictor.scenarios.deck.sea import SeaState, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in
from impact_predictor.scenarios.deck.voyage import sail
from impact_predictor.scenarios.record import Sensors

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]


class Sea(NamedTuple):
    """A significant wave height in m, the seed of a sea of it, seconds in it, and samples a second of unit and deck."""

    height: float
    seed: int
    seconds: float
    rate: float


def predicted(folder: Path, scenes: dict[str, Scene], sea: Sea, contacts: str = "rigid") -> Result:
    """Sail, and replay the record."""
    bag = folder / "cargo.mcap"
    deck = deck_in(waves_of(SeaState(sea.height, 4.0), sea.seed), Vessel())
    sail(scenes, deck, sea.seconds, contacts, bag, Sensors(sea.rate, sea.rate))
    return replay(bag, scenes)


def test_the_impacts_of_ten_minutes_are_predicted_and_every_unit_is_warned_of_in_time(tmp_path: Path) -> None:
    run = predicted(tmp_path, scenes_of(read_values(ROOT / "test/heavy_sea.yaml")), Sea(1.5, 3, 600.0, 20.0))
    truth = run.truth
    assert truth is not None
    assert truth.touchdowns >= 100
    assert sum(one.truth is not None and one.truth.touchdowns >= 10 for one in run.truths.values()) >= 3
    # At 20 samples a second the last sample before an impact may come before the body turns back.
    assert truth.missed <= 0.06 * truth.touchdowns
    assert truth.false <= 0.02 * truth.touchdowns

    assert truth.clear >= 100
    assert truth.clear_mode_accuracy is not None
    assert truth.clear_mode_accuracy >= 0.97
    assert truth.median_velocity_error is not None
    assert truth.median_velocity_error <= 0.02
    assert truth.median_time_error is not None
    assert truth.median_time_error <= 1e-3

    for one in run.truths.values():
        assert one.warned is not None
        assert one.warned.before_first_impact is True


def test_contacts_that_know_no_impact_law_come_to_the_same(tmp_path: Path) -> None:
    # Springs and dampers give way by a part of a millimetre, which the tolerance has to allow.
    crate = {
        name: scene._replace(tolerance=1e-3)
        for name, scene in scenes_of(read_values(ROOT / "config/deck_crate.yaml")).items()
    }
    truth = predicted(tmp_path, crate, Sea(1.3, 88, 180.0, 50.0), "compliant").truth
    assert truth is not None
    assert truth.touchdowns - truth.missed >= 15
    assert truth.clear_mode_accuracy is not None
    assert truth.clear_mode_accuracy >= 0.97
    assert truth.median_velocity_error is not None
    assert truth.median_velocity_error <= 0.02
    assert truth.false == 0
