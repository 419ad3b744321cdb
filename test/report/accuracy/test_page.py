"""The page of error against run time: what it says and draws of page_report.json, a report of few scenes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from read_page import PageReader, traces

from impact_predictor.report.accuracy import ERRORS, error_of, name_of
from impact_predictor.report.accuracy.page import accuracy_page

REPORT: dict[str, Any] = json.loads((Path(__file__).parents[1] / "page_report.json").read_text())


def read(report: dict[str, Any]) -> PageReader:
    return PageReader(accuracy_page(report, script=""))


@pytest.mark.parametrize("question", ERRORS)
def test_the_picture_of_a_question_has_a_point_for_each_method_on_each_scene(question: str) -> None:
    report = REPORT | {"rows": [row for row in REPORT["rows"] if row["question"] == question]}
    (figure,) = read(report).figures.values()
    names = {scene["name"]: scene["title"] for scene in report["scenes"]}
    drawn = {
        (method, text.rpartition("<br>")[0]): (x, y)
        for method, trace in traces(figure).items()
        for text, x, y in zip(trace["hovertext"], trace["x"], trace["y"], strict=True)
    }
    expected = {}
    for row in report["rows"]:
        if row["scene"] in names and error_of(row) < float("inf"):
            expected[row["method"], f"{name_of(row)}<br>{names[row['scene']]}"] = (row["us"], max(error_of(row), 1e-16))
    assert drawn == expected
    assert figure["layout"]["yaxis"]["type"] == figure["layout"]["xaxis"]["type"] == "log"


def test_the_tables_have_the_choices_for_each_wanted_accuracy_and_the_errors_of_what_has_no_choice() -> None:
    page = read(REPORT)
    (choices,) = page.tables["touchdown"]
    assert [row[0] for row in choices] == ["nine of ten errors are to be below", "0.01", "0.0001", "1e-06", "1e-09"]
    assert {row[1] for row in choices[1:]} == {"next_touchdown, tolerance = 1e-06"}
    assert page.tables["impact"][0][-1][1] == "none"
    for used in REPORT["node"].values():
        assert f"{name_of(used)} {used['why']}" in page.text
    (tosses,) = page.tables["tosses"]
    of = {name_of(row): row for row in REPORT["rows"] if row["question"] == "tosses"}
    for cells in tosses[1:]:
        assert cells[2:5] == [f"{of[cells[1]][f'twist_error{end}']:.2g}" for end in ("", "_90", "_worst")]
    assert tosses[1][1] == "path law"


def test_a_report_with_little_in_it_makes_a_page_too() -> None:
    assert read(REPORT | {"rows": [], "choices": [], "node": {}}).figures == {}
