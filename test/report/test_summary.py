"""Rows of touchdowns, what they say together, and the JSON of a replay."""

from __future__ import annotations

import json

import numpy as np
import pytest
from touchdowns import SAMPLE, TOUCHDOWN

from impact_predictor.bags.replay import Result, Settled
from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.prediction.types import Landing, Leftover, Prediction, Score, Status
from impact_predictor.report.earlier import row_of_message
from impact_predictor.report.replay_json import as_json
from impact_predictor.report.summary import (
    PER_DECADE,
    Distribution,
    error_by_lead_time,
    errors_of,
    from_json,
    reasons,
    row_of,
    spread_of,
    to_json,
    together,
)
from impact_predictor.ros.messages import decode_diagnostic_array, encode_score
from impact_predictor.scenarios.comparison import BodyTruth, Truth, Warned
from impact_predictor.scenarios.matching import Announcement, Match

SCORED = Score(
    1_004_000_000,
    TOUCHDOWN,
    Twist(0.5, 0.125, -2.0),
    0.25,
    True,
    Leftover.NONE,
    ((0.055, 0.5), (0.01, 0.3), (0.004, 0.25)),
)
UNSCORED = SCORED._replace(scored=False, leftover=Leftover.OUT_OF_PLANE | Leftover.ONE_CORNER_FIRST)
UNMEASURED = SCORED._replace(measured=None, relative_error=None, scored=False, leftover=Leftover.TOO_SHORT, history=())


@pytest.mark.parametrize("score", [SCORED, UNSCORED, UNMEASURED])
def test_a_row_of_the_message_is_the_row_of_the_score(score: Score) -> None:
    data = encode_score(Prediction(Status.ACCEPTED, SAMPLE, None, score))
    assert data is not None
    (diagnostic,) = decode_diagnostic_array(data)
    assert row_of_message("cube", diagnostic.values, 1e-4) == row_of("cube", score, 1e-4)


def test_a_row_of_the_message_of_a_landing_is_the_row_of_its_score() -> None:
    data = encode_score(Prediction(Status.ACCEPTED, SAMPLE, None, LANDED))
    assert data is not None
    (diagnostic,) = decode_diagnostic_array(data)
    assert row_of_message("robot", diagnostic.values) == row_of("robot", LANDED)


def test_the_flags_of_a_row_say_first_why_it_is_not_scored() -> None:
    assert row_of("cube", UNSCORED).flags == ("OUT_OF_PLANE", "ONE_CORNER_FIRST", "REVERSED_SLIP")


def test_only_scored_rows_count() -> None:
    scores = [SCORED, SCORED._replace(relative_error=0.75), UNSCORED, UNMEASURED]
    assert errors_of(row_of("cube", score) for score in scores)[:3] == (2, 0.5, pytest.approx(0.7))
    assert errors_of([]) == Distribution()


def test_every_reason_of_an_unscored_row_is_counted() -> None:
    rows = [row_of("cube", score) for score in (SCORED, UNSCORED, UNSCORED, UNMEASURED)]
    assert reasons(rows) == {"OUT_OF_PLANE": 2, "ONE_CORNER_FIRST": 2, "TOO_SHORT": 1}


def test_every_prediction_of_a_scored_touchdown_counts_at_its_lead_time() -> None:
    late = SCORED._replace(history=((0.07, 9.0), (-0.001, 9.0), (0.0, 0.1)))
    errors = error_by_lead_time([SCORED, UNSCORED, UNMEASURED, late])
    assert [(one.begin, one.errors.number) for one in errors] == [
        (0.0, 2),
        (0.01, 1),
        (0.02, 0),
        (0.03, 0),
        (0.04, 0),
        (0.05, 1),
    ]
    assert errors[0].errors.p50 == pytest.approx(0.175)
    assert errors[2].errors.p50 is None


def test_the_json_of_a_replay_has_the_promised_keys_and_no_nan() -> None:
    result = Result(
        bag="a.mcap",
        samples=4,
        seconds=0.001,
        settled=tuple(Settled("cube", score, 1e-4) for score in (SCORED, UNMEASURED)),
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
    assert answer["touchdowns"][0] == {
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
    }
    unmeasured = answer["touchdowns"][1]
    assert (unmeasured["measured_twist"], unmeasured["relative_error"], unmeasured["scored"]) == (None, None, False)
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


LANDED = Score(
    2_000_000_000,
    TOUCHDOWN._replace(leftover=Leftover.DRIVEN),
    None,
    None,
    False,
    Leftover.DRIVEN,
    (),
    Landing("left", 2_000_000_000, -0.015, True, ((0.2, 0.004), (0.06, 0.002), (0.004, -0.001)), 0.25, TOUCHDOWN),
)


def test_the_json_of_a_landing_has_its_foot_its_impact_and_how_late_it_was() -> None:
    result = Result("a.mcap", 4, 0.001, (Settled("robot", LANDED, None),), {}, {}, (), "", "")
    (row,) = json.loads(json.dumps(as_json(result), allow_nan=False))["touchdowns"]
    assert (row["announced_lead_time"], row["scored"], row["flags"]) == (0.2, False, ["DRIVEN", "REVERSED_SLIP"])
    assert {name: row[name] for name in list(row)[15:]} == {
        "foot": "left",
        "point": None,
        "late": -0.015,
        "confirmed": True,
        "time_error": -0.001,
        "landing_speed": 0.25,
        "landing_mode": TOUCHDOWN.mode.name,
        "impulse": [0.5, -0.125],
        "others_impulse": [0.0, 0.0],
        "velocity_change": [-0.25, 0.75, 1.0],
    }
    unknown = LANDED._replace(landing=Landing("left", 2_000_000_000, None, None, ()))
    (row,) = as_json(result._replace(settled=(Settled("robot", unknown, None),)))["touchdowns"]
    names = ("late", "confirmed", "time_error", "landing_speed", "landing_mode", "impulse", "velocity_change")
    assert {row[name] for name in names} == {None}


def test_the_json_of_several_bodies_has_their_inputs_and_how_each_compares_with_the_truth() -> None:
    truth = Truth(4, 1, 2, 3, 0.75, 0.01, None, 2, 1.0, 1)
    result = Result(
        "a.mcap",
        4,
        0.001,
        (Settled("crate", SCORED, 1e-4),),
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
    result = Result("a.mcap", 2, 0.001, (Settled("cube", SCORED, None),), {}, {}, ("took odom",), "", "")
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


def test_the_spread_of_some_numbers_has_their_own_percentiles_and_counts_each_in_its_bin() -> None:
    spread = spread_of([1.0, 1.01, 100.0, 0.0])
    assert (spread.number, spread.p50, spread.most) == (4, 1.005, 100.0)
    # 1.01 is less than 10**(1 / 100); 0 lies with the least number.
    assert spread.bins == {0: 2, 2 * PER_DECADE: 1, -12 * PER_DECADE: 1}


def test_a_spread_comes_back_from_its_json() -> None:
    spread = spread_of([3.0, 0.02, 5e-5])
    assert from_json(json.loads(json.dumps(to_json(spread)))) == spread
    assert from_json(None) == Distribution() == spread_of([])
    assert to_json(Distribution()) == {"count": 0, "p50": None, "p90": None, "p99": None, "max": None, "bins": []}


def test_one_spread_among_empty_ones_stays_exact() -> None:
    spread = spread_of([1.0, 2.0, 4.0])
    assert together([Distribution(), spread, Distribution()]) is spread
    assert together([]) == Distribution()


def test_spreads_together_are_those_of_all_numbers() -> None:
    numbers = np.random.default_rng(5).lognormal(size=3000)
    parts = [spread_of([float(number) for number in part]) for part in np.split(numbers, [10, 700])]
    spread = together(parts)
    assert (spread.number, spread.most) == (3000, max(numbers))
    for part, value in ((0.5, spread.p50), (0.9, spread.p90), (0.99, spread.p99)):
        # Half the width of a bin, 1.2 %.
        assert value == pytest.approx(float(np.quantile(numbers, part)), rel=0.012)
