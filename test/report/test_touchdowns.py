"""Rows of touchdowns: the same from a score, from its message and from its JSON."""

from __future__ import annotations

import json
from typing import Any

import pytest
from touchdowns import LANDED, LANDING, SAMPLE, SCORE, TOUCHDOWN, UNMEASURED, UNSCORED

from impact_predictor.prediction.types import Landing, Prediction, Score, Status
from impact_predictor.report.touchdowns import (
    error_ahead,
    row_as_json,
    row_of,
    row_of_json,
    row_of_message,
)
from impact_predictor.ros.messages import decode_diagnostic_array, encode_score

UNANNOUNCED = LANDED._replace(landing=Landing("left", 2_000_000_000, None, None, ()))


def json_of(score: Score) -> dict[str, Any]:
    entry: dict[str, Any] = json.loads(json.dumps(row_as_json(row_of("cube", score)), allow_nan=False))
    return entry


@pytest.mark.parametrize("score", [SCORE, UNSCORED, UNMEASURED])
def test_a_row_of_the_message_is_the_row_of_the_score(score: Score) -> None:
    data = encode_score(Prediction(Status.ACCEPTED, SAMPLE, None, score))
    assert data is not None
    (diagnostic,) = decode_diagnostic_array(data)
    assert row_of_message("cube", diagnostic.values, 1e-4) == row_of("cube", score, 1e-4)


@pytest.mark.parametrize("score", [LANDED, UNANNOUNCED])
def test_a_row_of_the_message_of_a_landing_has_all_but_its_impact(score: Score) -> None:
    data = encode_score(Prediction(Status.ACCEPTED, SAMPLE, None, score))
    assert data is not None
    (diagnostic,) = decode_diagnostic_array(data)
    impact: dict[str, Any] = {
        "landing_mode": None,
        "impulse": None,
        "others_impulse": None,
        "velocity_change": None,
        "time_errors": (),
        "simple_time_error": None,
    }
    assert row_of_message("robot", diagnostic.values) == row_of("robot", score)._replace(**impact)


@pytest.mark.parametrize("score", [SCORE, UNSCORED, UNMEASURED, LANDED, UNANNOUNCED])
def test_a_row_comes_back_from_its_json(score: Score) -> None:
    assert row_of_json(json_of(score)) == row_of("cube", score)._replace(time_errors=(), simple_time_error=None)


def test_the_json_of_a_touchdown_has_the_promised_keys() -> None:
    assert json_of(SCORE) == {
        "body": "cube",
        "stamp": 1_004_000_000,
        "announced_lead_time": 0.055,
        "lead_time": 0.004,
        "mode": "PIVOT_SLIDE",
        "predicted_twist": [0.75, 0.25, -3.0],
        "measured_twist": [0.5, 0.125, -2.0],
        "before_twist": [1.0, -0.5, -4.0],
        "half_distance": 0.05,
        "relative_error": 0.25,
        "out_of_plane": 0.125,
        "scored": True,
        "flags": ["REVERSED_SLIP"],
        "old": [0, 1],
        "new": [2, 3],
        "kind": "edge>face",
        "before_twist_6d": [0.0] * 6,
        "predicted_twist_6d": None,
        "measured_twist_6d": None,
        "relative_error_6d": None,
        "not_scored_6d": ["MOVING_CONTACTS"],
        "simple_errors_6d": None,
        "lift_old": None,
        "lift_new": None,
        "contacts": [],
        "mode_probabilities": None,
        "time_error": None,
    }
    unmeasured = json_of(UNMEASURED)
    assert (unmeasured["measured_twist"], unmeasured["relative_error"], unmeasured["scored"]) == (None, None, False)


def test_the_json_of_a_landing_has_its_foot_its_impact_and_how_late_it_was() -> None:
    entry = json_of(LANDED)
    assert (entry["announced_lead_time"], entry["scored"], entry["flags"]) == (0.2, False, ["DRIVEN", "REVERSED_SLIP"])
    assert {key: entry[key] for key in entry.keys() - json_of(SCORE).keys()} == {
        "foot": "left",
        "point": None,
        "late": -0.015,
        "confirmed": True,
        "landing_speed": 0.25,
        "landing_mode": TOUCHDOWN.mode.name,
        "impulse": [0.5, -0.125],
        "others_impulse": [0.0, 0.0],
        "bound": None,
        "velocity_change": [-0.25, 0.75, 1.0],
        "time_errors": [0.002, 0.002],
        "simple_time_error": -0.012,
    }
    assert entry["time_error"] == -0.001
    unknown = json_of(UNANNOUNCED)
    names = ("late", "confirmed", "time_error", "landing_speed", "landing_mode", "impulse", "velocity_change")
    assert {unknown[name] for name in names} == {None}
    alone = LANDED._replace(landing=LANDING._replace(impact=TOUCHDOWN._replace(old=()), point="toe"))
    assert (json_of(alone)["others_impulse"], json_of(alone)["point"]) == (None, "toe")


def test_the_flags_of_a_row_say_first_why_it_is_not_scored() -> None:
    assert row_of("cube", UNSCORED).flags == ("OUT_OF_PLANE", "ONE_CORNER_FIRST", "REVERSED_SLIP")


def test_the_error_of_time_is_that_of_the_last_prediction_made_so_long_ahead() -> None:
    errors = [error_ahead(LANDING.history, ahead) for ahead in (0.3, 0.2, 0.05, 0.02, 0.0)]
    assert errors == [None, 0.004, 0.002, 0.002, -0.001]
    assert row_of("robot", LANDED).time_errors == (0.002, 0.002)
    assert row_of("robot", LANDED).simple_time_error == -0.012
    assert (row_of("robot", LANDED).ahead, row_of("robot", UNANNOUNCED).ahead) == (0.2, None)


def test_a_part_of_a_foot_that_stood_already_lands_second() -> None:
    second = LANDED._replace(touchdown=TOUCHDOWN._replace(old=(0,), new=(1,)), landing=LANDING._replace(point="toe"))
    first = second._replace(touchdown=TOUCHDOWN._replace(old=(2,), new=(0,)))
    assert [row_of("robot", score).is_second for score in (second, first, LANDED)] == [True, False, False]
