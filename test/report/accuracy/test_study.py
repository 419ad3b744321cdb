"""The whole report, of very few problems: every method runs, and its JSON makes a page."""

from __future__ import annotations

import json

import pytest
from read_page import PageReader

from impact_predictor.report.accuracy import impacts, study, touchdowns
from impact_predictor.report.accuracy.measure import IMPACT, STABILITY, TOUCHDOWN, error_of
from impact_predictor.report.accuracy.page import accuracy_page


@pytest.mark.slow
def test_a_small_report_has_a_row_for_each_method_on_each_scene_and_makes_a_page() -> None:
    size, done = study.Size(falls=1, strikes=2, random=20, seconds=0.0, variants=1), list[int]()
    report = json.loads(json.dumps(study.report(size, "a command", done.append), allow_nan=False))
    assert done == list(range(1, study.steps(size) + 1))
    rows = {(row["question"], row["scene"], row["method"], row["setting"]) for row in report["rows"]}
    assert len(rows) == len(report["rows"])
    for question, name in ((touchdowns, TOUCHDOWN), (impacts, IMPACT)):
        for scene in question.SCENES:
            assert {(name, scene.name, *method) for method in question.METHODS} <= rows
    assert {(STABILITY, scene.name, "total law", "over arrays") for scene in study.RANDOM} <= rows
    (tosses,) = (row for row in report["rows"] if row["scene"] == study.CUBE.name)
    assert tosses["method"] == "path law, slip across"
    assert 0.03 < tosses["twist_error"] < 0.1
    assert set(report["node"]) == {TOUCHDOWN, IMPACT}
    assert len(PageReader(accuracy_page(report, script="")).figures) == 4


def test_random_impacts_of_all_kinds_keep_to_mechanics_and_what_is_not_answered_is_counted() -> None:
    rows = list(study.stability_rows(200))
    assert {row["scene"] for row in rows} == {scene.name for scene in study.RANDOM}
    assert all(row["violation_90"] < 1e-14 and row["count"] == 200 for row in rows)
    assert {row["scene"] for row in rows if row["failed"]} <= {"extreme", "extreme-apart"}
    assert error_of(rows[0]) == rows[0]["violation_worst"] < 1e-12
