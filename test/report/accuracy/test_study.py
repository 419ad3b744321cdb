"""The whole report, of very few problems: every method runs, and its JSON makes a page."""

from __future__ import annotations

import json

import pytest
from read_page import PageReader

from impact_predictor.report.accuracy import impacts, study, touchdowns
from impact_predictor.report.accuracy.measure import IMPACT, TOUCHDOWN
from impact_predictor.report.accuracy.page import accuracy_page


@pytest.mark.slow
def test_a_small_report_has_a_row_for_each_method_on_each_scene_and_makes_a_page() -> None:
    size, done = study.Size(falls=1, strikes=2, seconds=0.0, variants=1), list[int]()
    report = json.loads(json.dumps(study.report(size, "a command", done.append), allow_nan=False))
    assert done == list(range(1, study.steps(size) + 1))
    rows = {(row["question"], row["scene"], row["method"], row["setting"]) for row in report["rows"]}
    assert len(rows) == len(report["rows"])
    for scene in touchdowns.SCENES:
        assert {(TOUCHDOWN, scene, *method[1:3]) for method in touchdowns.METHODS} <= rows
    for scene in set(impacts.SCENES) - {"across"}:
        assert {(IMPACT, scene, *method[1:3]) for method in impacts.methods()} <= rows
    (tosses,) = (row for row in report["rows"] if row["scene"] == study.TOSSES.name)
    assert tosses["method"] == "path law, slip across"
    assert 0.03 < tosses["twist_error"] < 0.1
    assert {row["family"] for row in report["rows"]} == {family["name"] for family in report["families"]}
    assert set(report["node"]) == {TOUCHDOWN, IMPACT}
    assert len(PageReader(accuracy_page(report, script="")).figures) == 2
