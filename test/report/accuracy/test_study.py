"""A tiny report from the beginning to the end."""

from __future__ import annotations

import json
from typing import Any

import pytest

from impact_predictor.report.accuracy import study
from impact_predictor.report.accuracy.measuring import Effort
from impact_predictor.report.accuracy.rows import ALL_SCENES, IMPACT, TOUCHDOWN, Report, to_json

TINY = study.Size(2, 4, Effort(0.0, 0.0, 1), 1500, 1)


@pytest.fixture(scope="module")
def told() -> list[int]:
    return []


@pytest.fixture(scope="module")
def report(told: list[int]) -> Report:
    return study.report(TINY, "impact-predictor report", told.append)


@pytest.fixture(scope="module")
def fields(report: Report) -> dict[str, Any]:
    return json.loads(json.dumps(to_json(report), allow_nan=False))  # type: ignore[no-any-return]


def test_every_scene_has_rows_and_every_row_a_scene_and_a_family(report: Report) -> None:
    assert {(row.question, row.scene) for row in report.rows} == {(s.question, s.name) for s in report.scenes}
    assert {row.family for row in report.rows} == {family.name for family in report.families}


def test_no_method_fails_where_it_applies(report: Report) -> None:
    # At constant twist a body that rises does not come down.
    patient = [row for row in report.rows if row.family not in ("constant twist", "constant acceleration")]
    assert [(row.scene, row.method, row.setting) for row in patient if row.failed] == []


def test_costs_are_there_for_every_row(report: Report) -> None:
    assert all(0.0 < row.us < 60e6 and row.count > 0 for row in report.rows)


def test_the_program_is_exact_on_every_computed_scene(report: Report) -> None:
    computed = {(scene.question, scene.name) for scene in report.scenes if not scene.measured}
    for row in report.rows:
        if (row.question, row.scene) in computed and row.family == "exact":
            assert row.error < (1e-5 if row.scene == "sliding" and row.setting == "tolerance = 1e-06" else 1e-9), row
        if (row.question, row.scene) in computed and row.family == "path law" and row.scene not in ("across", "stiff"):
            assert row.error < 1e-12, row


def test_there_are_choices_for_each_question_and_defaults_of_the_node(fields: dict[str, Any]) -> None:
    assert set(fields["node"]) == {TOUCHDOWN, IMPACT}
    everywhere = [choice for choice in fields["choices"] if choice["scene"] == ALL_SCENES]
    assert [choice["question"] for choice in everywhere] == [TOUCHDOWN] * 4 + [IMPACT] * 4


def test_the_bar_is_told_of_every_step(report: Report, told: list[int]) -> None:
    assert told == list(range(1, study.steps(TINY) + 1))


def test_without_mujoco_a_note_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study.mujoco_peer, "is_installed", lambda: False)
    assert not any(method.family == "MuJoCo" for method in study.impact_methods_here())
