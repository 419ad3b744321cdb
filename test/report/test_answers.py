"""The JSON of a replay: what was promised, and nothing that JSON does not know."""

from __future__ import annotations

import json

import pytest
from touchdowns import SCORE, TOUCHDOWN, UNMEASURED

from impact_predictor.bags.replay import Result, Settled
from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.types import Status
from impact_predictor.report.answers import as_json
from impact_predictor.scenarios.comparison import BodyTruth, Truth, Warned
from impact_predictor.scenarios.matching import Announcement, Match


def test_the_json_of_a_replay_has_the_promised_keys_and_no_nan() -> None:
    result = Result(
        bag="a.mcap",
        samples=4,
        seconds=0.001,
        settled=(Settled("cube", SCORE, 1e-4), Settled("cube", UNMEASURED, 1e-4)),
        statuses={Status.ACCEPTED: 3, Status.NOT_FINITE: 1},
        geometry_statuses={Status.ACCEPTED: 1},
        notes=(),
        unpredictable="",
        damaged="",
    )
    answer = json.loads(json.dumps(as_json(result), allow_nan=False))
    assert answer["bag"] == "a.mcap"
    assert answer["samples"] == 4
    assert answer["us_per_sample"] == pytest.approx(250.0)
    assert answer["median_relative_error"] == 0.25
    assert answer["statuses"] == {"ACCEPTED": 3, "NOT_FINITE": 1}
    assert answer["error_by_lead_time"][0] == {"from": 0.0, "to": 0.01, "count": 1, "median": 0.25, "p90": 0.25}
    assert "damaged" not in answer
    assert as_json(result._replace(damaged="the end"))["damaged"] == "the end"
    assert "truth" not in answer
    assert as_json(result._replace(truth=Truth(4, 1, 2, 3, 0.75, 0.01, None)))["truth"] == {
        "touchdowns": 4,
        "missed": 1,
        "false": 2,
        "unresolved": 3,
        "mode_accuracy": 0.75,
        "median_velocity_error": 0.01,
        "median_time_error": None,
        "clear": 0,
        "clear_mode_accuracy": None,
        "unresolved_wrong": 0,
        "time_error_by_lead_time": {},
        "least_lead_time": None,
    }


def test_the_touchdowns_of_the_json_are_in_the_order_of_their_stamps() -> None:
    late, early = SCORE._replace(stamp=2_000), SCORE._replace(stamp=1_000)  # what other points did is known later
    settled = (Settled("cube", late, 1e-4), Settled("cube", early, 1e-4))
    rows = as_json(Result("a.mcap", 4, 0.001, settled, {Status.ACCEPTED: 4}, {}, (), "", ""))["touchdowns"]
    assert [row["stamp"] for row in rows] == [1_000, 2_000]


def test_the_json_of_several_bodies_has_their_inputs_and_how_each_compares_with_the_truth() -> None:
    truth = Truth(4, 1, 2, 3, 0.75, 0.01, None, 2, 1.0, 1)
    result = Result(
        "a.mcap",
        4,
        0.001,
        (Settled("crate", SCORE, 1e-4),),
        {Status.ACCEPTED: 4},
        {},
        (),
        "",
        "",
        truth,
        {
            "crate": BodyTruth(truth, Warned(5, 10, None, 20, warned_ahead=1e-8, events=3, events_warned=2)),
            "blind": BodyTruth(None, Warned(5, None, 15, None, events=1)),
            "still": BodyTruth(None, Warned(5, 6, None, None)),
        },
        {"support/odom": {Status.ACCEPTED: 9, Status.SUPPORT_JUMPED: 1}, "crate/odom": {Status.ACCEPTED: 4}},
    )
    answer = json.loads(json.dumps(as_json(result), allow_nan=False))
    assert answer["inputs"] == {"support/odom": {"ACCEPTED": 9, "SUPPORT_JUMPED": 1}, "crate/odom": {"ACCEPTED": 4}}
    compared = answer["truth"]
    assert (compared["clear"], compared["clear_mode_accuracy"], compared["unresolved_wrong"]) == (2, 1.0, 1)
    assert (compared["bodies_with_slide_or_impact"], compared["warned_before_first_impact"]) == (2, 1)
    assert (compared["events"], compared["events_warned"]) == (4, 2)
    assert compared["bodies"]["crate"]["missed"] == 1
    assert compared["bodies"]["crate"]["warned_ahead"] == 1e-8
    assert compared["bodies"]["crate"]["first_warning"] == 10
    assert compared["bodies"]["blind"] == {
        "first_known": 5,
        "first_warning": None,
        "first_slide": 15,
        "first_impact": None,
        "first_lift": None,
        "warned_ahead": None,
        "events": 1,
        "events_warned": 0,
        "warned_before_first_impact": False,
    }
    assert compared["bodies"]["still"]["warned_before_first_impact"] is None


def test_the_json_of_a_replay_has_its_costs_its_errors_ahead_and_every_true_touchdown() -> None:
    told = [
        Announcement(1_900_000_000, 2_004_000_000, TOUCHDOWN),
        Announcement(1_985_000_000, 2_001_000_000, TOUCHDOWN),
    ]
    matches = (
        Match("cube", "", 2_000_000_000, Mode.STOP, told, True, 0.25),
        Match("cube", "left", 3_000_000_000, None, (), True),
        Match("cube", "", None, None, told[:1]),
    )
    result = Result("a.mcap", 2, 0.001, (Settled("cube", SCORE, None),), {}, {}, ("took odom",), "", "")
    result = result._replace(extent=(5, 9), costs=(1e-5, 3e-5), matches=matches)
    answer = json.loads(json.dumps(as_json(result), allow_nan=False))
    assert (answer["begin"], answer["end"], answer["notes"]) == (5, 9, ["took odom"])
    assert (answer["cost_us"]["count"], answer["cost_us"]["p50"]) == (2, pytest.approx(20.0))
    assert [one["count"] for one in answer["relative_errors_ahead"]] == [1, 1, 0, 0, 0, 1]
    # The first prediction was made 100 ms ahead, beyond what is told; the second 15 ms, and 1 ms wrong.
    assert [(one["count"], one["p50"]) for one in answer["time_errors_ahead"][:3]] == [(0, None), (1, 0.001), (0, None)]
    found, missed, false = answer["true_touchdowns"]
    assert found == {
        "body": "cube",
        "stamp": 2_000_000_000,
        "mode": "STOP",
        "first_seen": 1_900_000_000,
        "predicted_stamp": 2_001_000_000,
        "predicted_mode": TOUCHDOWN.mode.name,
        "velocity_error": 0.25,
        "shown": True,
    }
    assert (missed["foot"], missed["mode"], missed["predicted_stamp"]) == ("left", None, None)
    assert (false["stamp"], false["predicted_stamp"]) == (None, 2_004_000_000)


def test_the_json_of_an_empty_replay_has_nothing_to_divide() -> None:
    answer = as_json(Result("a.mcap", 0, 0.001, (), {}, {}, (), "there is no message", ""))
    assert (answer["us_per_sample"], answer["median_relative_error"], answer["touchdowns"]) == (None, None, [])
