"""The charts of a page as a picture: what is drawn of landings, kinds, lifts and a watch, in both formats."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import unescape
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import matplotlib
import pytest
from replay_answers import TOSSES, TRUE, WALK, answer, landing, touchdown

from impact_predictor.mechanics.types import Mode
from impact_predictor.prediction.skill import SIMPLE
from impact_predictor.prediction.types import KINDS
from impact_predictor.report.page.facts import BagAnswer, ReplayFacts
from impact_predictor.report.page.landings import landings
from impact_predictor.report.page.replay import write_replay_picture
from impact_predictor.report.page.skill import kinds_chart, skill_charts
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


def texts(path: Path, answers: Sequence[BagAnswer]) -> list[str]:
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        write_replay_picture(path, answers)
    return [unescape(text) for text in re.findall(r"<text[^>]*>([^<]*)</text>", path.read_text())]


@pytest.mark.parametrize("suffix", [".png", ".svg", ".PNG"])
def test_it_is_written_in_the_format_of_its_name_the_same_every_time(tmp_path: Path, suffix: str) -> None:
    paths = [tmp_path / f"{name}{suffix}" for name in ("one", "two")]
    for path in paths:
        write_replay_picture(path, [TOSSES, WHOLE])
    data = paths[0].read_bytes()
    assert data == paths[1].read_bytes()
    assert len(data) > 20_000
    assert ElementTree.fromstring(data).tag.endswith("svg") if suffix == ".svg" else data.startswith(b"\x89PNG")


def test_whole_twists_are_shown_by_kind_beside_simple_answers_and_lifts_beside_what_was_told(tmp_path: Path) -> None:
    told = texts(tmp_path / "whole.svg", [WHOLE])
    title = "Error of the whole twist, by kind"
    assert {title, *KINDS, *SIMPLE.values(), "old contact", "new contact", "Upwards"} <= set(told)
    assert told.count("30") >= 1  # of all kinds, and of contacts of which 60 % were told


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


def test_a_machine_that_walks_has_its_stances_and_landings_below_what_its_page_says(
    tmp_path: Path,
) -> None:
    told = texts(tmp_path / "gait.svg", [LANDED, TRUE])
    assert {"walk.bag", "The landings of walk.bag", "left predicted", "stands", "truth", "speed, m/s"} <= set(told)
    assert any(text.startswith("walk.bag, simulated.mcap: touchdowns 5, found") for text in told)


@pytest.mark.parametrize("touchdowns", [[], [touchdown(1, scored=False, flags=["TOO_SLOW"])], [touchdown(1)]])
def test_few_touchdowns_or_none_make_a_picture_without_a_warning(
    tmp_path: Path, touchdowns: list[dict[str, Any]], recwarn: pytest.WarningsRecorder
) -> None:
    write_replay_picture(tmp_path / "few.png", [answer("few.mcap", touchdowns=touchdowns)])
    write_replay_picture(tmp_path / "feet.png", [WALK | {"touchdowns": []}])
    assert (tmp_path / "few.png").stat().st_size > 5_000
    assert not recwarn.list
