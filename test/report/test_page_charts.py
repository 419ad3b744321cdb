"""The charts of a page: what is drawn of landings, of the errors by kind, and of lifts."""

from __future__ import annotations

import pytest
from replay_answers import WALK, answer, landing, touchdown

from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.skill import SIMPLE
from impact_predictor.prediction.types import KINDS
from impact_predictor.report.page.facts import ReplayFacts
from impact_predictor.report.page.landings import landings
from impact_predictor.report.page.skill import ENOUGH, kinds_chart, skill_charts
from impact_predictor.report.skill import kind_scores

MS = 1_000_000
WHOLE = answer(
    "whole.mcap",
    touchdowns=[
        touchdown(
            10.0 * k,
            mode=Mode(1 + k % 6).name,
            kind=KINDS[k % 6],
            before_twist_6d=[1.0, 0.0, -1.0, 0.0, 4.0, 0.0],
            predicted_twist_6d=[0.8, 0.0, 0.1, 0.0, 0.1 * k, 0.0],
            measured_twist_6d=[0.8, 0.0, 0.2, 0.0, 0.1 * k + 0.2, 0.0],
            relative_error_6d=0.01 * k,
            not_scored_6d=[],
            simple_errors_6d=[0.9, 0.8, 0.3, 0.5, 0.2],
            lift_old=[True, k % 3 > 0, 0.6],
            lift_new=[k % 2 > 0, k % 3 > 0, None],
        )
        for k in range(30)
    ],
)
LANDED = WALK | {
    "touchdowns": [
        landing(320, "right", 0.002, time_errors=[0.002, 0.004]),
        landing(690, "left", -0.004, time_errors=[-0.004, None], bound="upper bound"),
        landing(900, "right", None, landing_speed=None, impulse=None),
    ]
}


def test_whole_twists_are_shown_by_kind_beside_simple_answers() -> None:
    by_kind, _ = skill_charts(ReplayFacts([WHOLE]))
    kinds = [name.partition("<br>")[0].replace("&gt;", ">") for name in by_kind.layout["yaxis"]["ticktext"]]
    assert kinds == [*KINDS, "all"]
    assert [trace["name"] for trace in by_kind.traces] == [*SIMPLE.values(), "prediction: median to 90 %"]


def test_an_error_reaches_from_the_median_to_what_nine_tenths_are_below() -> None:
    (kind,) = [one for one in kind_scores(ReplayFacts([WHOLE]).scored, {}) if one.kind == "all"]
    *simple, prediction = kinds_chart([kind]).traces
    assert [trace["name"] for trace in simple] == list(SIMPLE.values())
    assert [trace["x"][0] for trace in simple] == pytest.approx([90.0, 80.0, 30.0, 50.0, 20.0])
    (middle,), (beyond,) = prediction["x"], prediction["error_x"]["array"]
    assert (middle, middle + beyond) == pytest.approx((14.5, 26.1))


def test_contacts_of_which_yes_or_no_is_told_have_two_points() -> None:
    *_, lifts = skill_charts(ReplayFacts([WHOLE]))
    _, old, new = lifts.traces
    assert (old["x"], old["y"], old["text"]) == (pytest.approx((60.0,)), pytest.approx((200.0 / 3.0,)), ["30"])
    assert (new["x"], new["text"]) == ((0.0, 100.0), ["15", "15"])


def test_whether_few_contacts_lift_is_not_drawn() -> None:
    few = answer(touchdowns=WHOLE["touchdowns"][: ENOUGH - 1])
    assert [chart.title for chart in skill_charts(ReplayFacts([few]))] == ["Error of the whole twist, by kind"]


def test_landings_err_against_the_true_times_where_the_record_tells_them() -> None:
    (chart,) = landings("walk.bag", LANDED)
    found = {(trace["name"], trace["yaxis"]): trace for trace in chart.traces}
    assert found["right", "y"]["y"] == pytest.approx((24.0,))  # told for 324 ms, and it stands from 300 on
    assert ("left", "y") not in found
    assert found["left", "y2"]["y"] == (0.1,)
    assert found["left", "y3"]["error_y"]["arrayminus"] == [5.0]
    assert [trace["showlegend"] for trace in chart.traces if trace["name"] == "right"] == [True, False, False]
    assert "the true time" in chart.caption
    assert chart.caption.endswith("(upper bound).")


def test_without_a_truth_they_err_against_the_inferred_times() -> None:
    gait = WALK["gaits"][""] | {"true_stances": []}
    (chart,) = landings("walk.bag", LANDED | {"gaits": {"": gait}})
    assert next(one for one in chart.traces if one["yaxis"] == "y")["y"] == pytest.approx((4.0,))
    assert "the inferred time" in chart.caption
