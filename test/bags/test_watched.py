"""What is kept of a watch over a deck, from decks and margins by hand."""

from __future__ import annotations

from math import cos, radians, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from impact_predictor.bags.watched import DECK, FORECAST, STEP, WatchRecorder, deck_row
from impact_predictor.prediction.deck.forecast import LEADS, DeckOutlook
from impact_predictor.prediction.types import Felt, Moment
from impact_predictor.prediction.watch.watch import Level, Report

ZERO = (0.0, 0.0, 0.0)


def moment(stamp: int, roll: float = 0.0, pitch: float = 0.0) -> Moment:
    """A deck at rest, turned by a roll or a pitch in degrees."""
    half = 0.5 * radians(roll or pitch)
    quaternion = (sin(half), 0.0, 0.0, cos(half)) if roll else (0.0, sin(half), 0.0, cos(half))
    felt = (0.0, -9.81 * sin(2.0 * half), -9.81 * cos(2.0 * half))
    return Moment(
        stamp, "world", "deck", ZERO, quaternion, ZERO, Felt(felt, ZERO, ZERO), lambda _: Felt(felt, ZERO, ZERO)
    )


def outlook(_: float) -> DeckOutlook:
    """Three courses that differ by 0.1 m/s^2."""
    times = np.arange(0.0, 16.1, 0.25)
    gravity = np.zeros((3, len(times), 3))
    gravity[:, :, 1] = times + np.array([[-0.1], [0.0], [0.1]])
    angles = 0.01 * gravity[:, :, :2]
    return DeckOutlook(times, gravity, angular=gravity, turning=gravity, is_learnt=True, angles=angles)


def report(stamp: int, level: Level, chance: str = "0.25") -> Report:
    return Report("crate", stamp, level, "", {"onset_probability": chance, "tips_per_hour": "3.5"})


def kept() -> tuple[WatchRecorder, Any, Any]:
    watch: Any = SimpleNamespace(margins=(np.array([0.2]), np.array([0.3])))
    deck: Any = SimpleNamespace(last=None, outlook=outlook, values=lambda: {"forecast": "TRUSTED"})
    return WatchRecorder(watch, deck, ["crate"]), watch, deck


@pytest.mark.parametrize(("roll", "pitch"), [(5.0, 0.0), (-5.0, 0.0), (0.0, 3.0), (0.0, -3.0)])
def test_the_angles_are_those_of_the_deck_port_up_and_bow_down(roll: float, pitch: float) -> None:
    found = dict(zip(DECK, deck_row(moment(0, roll, pitch)), strict=True))
    assert np.degrees([found["roll"], found["pitch"]]) == pytest.approx([roll, pitch])


def test_a_row_has_the_most_that_was_used_of_the_margins_since_the_one_before() -> None:
    recorder, watch, deck = kept()
    for stamp, slide, tip in (
        (STEP, 0.2, 0.3),
        (STEP + 50, 0.1, 0.9),
        (STEP + 100, 0.5, 0.4),
        (2 * STEP, 0.3, 0.2),
        (3 * STEP, 0.0, 0.1),
    ):
        watch.margins = np.array([slide]), np.array([tip])
        deck.last = moment(stamp)
        recorder.look()
    log = recorder.log()
    assert log.stamps.tolist() == [STEP, 2 * STEP, 3 * STEP]
    assert log.units[:, 0, 1].tolist() == [0.2, 0.5, 0.0]
    assert log.units[:, 0, 2].tolist() == [0.3, 0.9, 0.1]


def test_a_forecast_has_its_middle_and_the_ends_of_its_band_at_each_lead() -> None:
    recorder, _, deck = kept()
    deck.last = moment(STEP)
    recorder.look()
    log = recorder.log()
    assert log.made.tolist() == [0]
    across = FORECAST.index("across")
    assert log.forecasts[0, :, across, 1].tolist() == list(LEADS)
    assert log.forecasts[0, :, FORECAST.index("pitch"), 1].tolist() == pytest.approx([0.01 * lead for lead in LEADS])
    band = log.forecasts[0, :, across, 2] - log.forecasts[0, :, across, 0]
    assert band.tolist() == pytest.approx([0.18] * len(LEADS))


def test_a_pause_of_the_deck_is_a_row_without_numbers() -> None:
    recorder, _, deck = kept()
    for stamp in (STEP, 60 * STEP):
        deck.last = moment(stamp)
        recorder.look()
    log = recorder.log()
    assert np.isnan(log.deck).all(axis=1).tolist() == [False, True, False]
    assert (np.diff(log.stamps) > 0).all()


def test_levels_last_until_the_next_one_and_an_unknown_probability_is_none() -> None:
    recorder, _, deck = kept()
    deck.last = moment(STEP)
    recorder.look()
    for one in (report(STEP, Level.OK), report(2 * STEP, Level.OK), report(3 * STEP, Level.WARN, "unknown")):
        recorder.take([one])
    deck.last = moment(4 * STEP)
    recorder.look()
    log = recorder.log({"crate": {5: "slides"}})
    assert [(one.level, one.begin, one.end) for one in log.spells] == [(0, STEP, 3 * STEP), (1, 3 * STEP, 4 * STEP)]
    assert log.units[-1, 0, 0] == Level.WARN
    assert np.isnan(log.units[-1, 0, 3])
    assert log.last["crate"]["tips_per_hour"] == "3.5"
    assert (log.events, log.knows_events) == ({"crate": {5: "slides"}}, True)


def test_where_the_bag_tells_no_events_they_are_where_a_margin_is_used_up() -> None:
    recorder, watch, deck = kept()
    for stamp, slide in ((STEP, 0.3), (2 * STEP, 1.2), (3 * STEP, 0.4), (4 * STEP, 1.1), (40 * STEP, 1.0)):
        watch.margins = np.array([slide]), np.array([0.1])
        deck.last = moment(stamp)
        recorder.look()
    log = recorder.log()
    assert (log.events, log.knows_events) == (
        {"crate": dict.fromkeys((2 * STEP, 40 * STEP), "slides, by its margin")},
        False,
    )
