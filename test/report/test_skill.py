"""How right whole twists are, from rows by hand."""

from __future__ import annotations

import json
from typing import Any

import pytest
from touchdowns import SCORE

from impact_predictor.prediction.recorded import Announced
from impact_predictor.prediction.skill import SIMPLE
from impact_predictor.report.skill import (
    COMPONENTS,
    component_scores,
    kind_scores,
    lift_scores,
    skill_as_json,
    skill_tables,
    unscored,
)
from impact_predictor.report.table import texts_of
from impact_predictor.report.touchdowns import TouchdownRow, row_of

BEFORE = (0.0, 2.0, -1.0, 1.0, 0.0, 0.0)


def scored(error: float, kind: str = "edge>face", **given: Any) -> TouchdownRow:
    row = row_of("cube", SCORE)._replace(
        kind=kind,
        relative_error_6d=error,
        not_scored_6d=(),
        simple_errors_6d=(0.7, 0.8, 0.2, 0.5, 2.0 * error),
        time_error=-0.001,
        before_twist_6d=BEFORE,
    )
    return row._replace(**given)


ROWS = [
    scored(0.1, lift_old=(True, True, 0.75)),
    scored(0.3, lift_old=(False, True, 0.5), time_error=0.003),
    scored(0.2, "flight>corner", lift_old=(False, False, 0.25)),
    scored(0.9, not_scored_6d=("NOT_ISOLATED",), lift_old=(True, False, 1.0)),
    row_of("cube", SCORE)._replace(not_scored_6d=("UNSEEN", "TOO_SLOW")),
]
RECORDED = {"edge>face": Announced(4, 3), "flight>corner": Announced(2, 2), "edge>corner": Announced(1, 0)}


def test_each_kind_has_its_touchdowns_its_errors_and_those_of_simple_answers() -> None:
    kinds = {one.kind: one for one in kind_scores(ROWS, RECORDED)}
    assert list(kinds) == ["flight>corner", "edge>corner", "edge>face", "all"]
    assert [(one.touchdowns, one.announced, one.errors.number) for one in kinds.values()] == [
        (2, 2, 1),
        (1, 0, 0),
        (4, 3, 2),
        (7, 5, 3),
    ]
    face = kinds["edge>face"]
    assert [face.errors.p50, face.times.p50] == pytest.approx([0.2, 0.002])
    assert [one.p50 for one in face.simple] == pytest.approx([0.7, 0.8, 0.2, 0.5, 0.4])
    assert kinds["all"].errors.p90 == pytest.approx(0.28)
    assert kind_scores([], {}) == []


@pytest.mark.parametrize("known", [True, False])
def test_simple_answers_have_columns_where_they_are_known(known: bool) -> None:
    rows = ROWS if known else [row._replace(simple_errors_6d=None) for row in ROWS]
    (_, columns, kinds), *_ = skill_tables(rows, RECORDED)
    headers = [column.header.replace("\n", " ") for column in texts_of(columns, kinds)]
    assert [said in headers for said in SIMPLE.values()] == [known] * len(SIMPLE)


def test_a_lift_is_counted_as_told_and_as_measured_and_its_probability_is_judged() -> None:
    (old,) = lift_scores(ROWS)
    assert old.name == "old"
    assert dict(old.counts) == {(True, True): 1, (True, False): 1, (False, False): 1}
    assert old.balanced == pytest.approx(0.75)
    assert old.brier == pytest.approx((0.25**2 + 0.5**2 + 0.25**2) / 3.0)
    assert old.base == pytest.approx(2.0 / 9.0)  # two of three lift
    assert old.reliability == ((1, 0.25, 0.0), (1, 0.5, 1.0), (1, 0.75, 1.0))
    (sure,) = lift_scores([scored(0.1, lift_new=(True, True, None))])
    assert (sure.name, sure.balanced, sure.brier, sure.base) == ("new", None, None, None)


def test_components_are_along_the_velocity_before_across_it_and_up() -> None:
    told = [(1.0, 2.0, 3.0, 4.0, 5.0, 6.0), (2.0, 4.0, 5.0, 2.0, 3.0, 1.0), (3.0, 9.0, 4.0, 0.0, 1.0, 2.0)]
    # The velocity before is along y: that is along, and x is across it to the right.
    rows = [
        scored(0.1, predicted_twist_6d=one, measured_twist_6d=(one[0], 2.0 * one[1] + 1.0, *one[2:])) for one in told
    ]
    along, across, *others = component_scores(rows)
    assert [along.slope, along.bias] == pytest.approx([2.0, -6.0])
    squares, variance = sum((one[1] + 1.0) ** 2 for one in told), 4.0 * 26.0
    assert along.r2 == pytest.approx(1.0 - squares / variance)
    # Before it was 2 along and nothing across, the same of each: nobody tells how they differ.
    missed = [sum((2.0 * one[1] + 1.0 - left) ** 2 for one in told) for left in (2.0, 0.0, 1.7)]
    assert along.simple_r2 == pytest.approx([1.0 - one / variance for one in missed])
    for one in (across, *others):
        assert [one.bias, one.slope, one.r2] == pytest.approx([0.0, 1.0, 1.0])
    assert [one.name for one in (along, across, *others)] == list(COMPONENTS)
    assert component_scores(rows[:2]) == []


def test_the_reasons_of_what_is_not_scored_are_counted() -> None:
    assert unscored(ROWS) == {"NOT_ISOLATED": 1, "UNSEEN": 1, "TOO_SLOW": 1}


def test_the_json_has_skill_kinds_components_lifts_and_reasons() -> None:
    known = [row._replace(predicted_twist_6d=BEFORE, measured_twist_6d=BEFORE) for row in ROWS[:3]]
    answer = json.loads(json.dumps(skill_as_json([*known, *ROWS[3:]], RECORDED), allow_nan=False))
    assert list(answer) == ["skill", "kinds", "components", "lifts", "not_scored_6d"]
    assert list(answer["skill"]) == ["prediction", *SIMPLE]
    assert answer["skill"]["prediction"] == {"count": 3, "median": pytest.approx(0.2), "p90": pytest.approx(0.28)}
    assert answer["kinds"]["edge>corner"]["announced"] == 0
    assert answer["kinds"]["edge>face"]["planar"]["median"] == pytest.approx(0.4)
    assert answer["components"] == {}  # what does not vary has none
    assert answer["lifts"]["old"]["lifted"] == {"told": 1, "not_told": 1}
    assert answer["lifts"]["old"]["stayed"] == {"told": 0, "not_told": 1}
    assert skill_as_json([], {}) == {}
