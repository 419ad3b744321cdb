"""Values of the report and their form in files."""

from __future__ import annotations

import csv
import json
from math import inf, nan
from pathlib import Path

import pytest

from impact_predictor.report.accuracy.rows import (
    IMPACT,
    Choice,
    Default,
    Errors,
    Family,
    Report,
    Row,
    Scene,
    fields_of,
    quantiles,
    to_json,
    write_csv,
)

SCENE = Scene("plate", IMPACT, "Plate", "A plate.", "exact")
ROW = Row(IMPACT, "plate", "path law", "path law", "", 9.0, 12.0, None, Errors(1e-16, 2e-16, inf), 0.1, 10, 1)


def test_ninety_percent_stay_below_the_second_number() -> None:
    assert quantiles([float(i) for i in range(1, 12)]) == Errors(6.0, 10.0, 11.0)
    assert quantiles([3.0]) == Errors(3.0, 3.0, 3.0)


def test_what_is_no_number_counts_as_infinitely_wrong() -> None:
    assert quantiles([nan, 1.0, 2.0]) == Errors(2.0, inf, inf)


def test_infinite_errors_and_those_that_do_not_apply_are_null_in_json() -> None:
    fields = fields_of(ROW)
    assert fields["twist_error_90"] == 2e-16
    assert fields["twist_error_worst"] is None
    assert fields["time_error"] is None


def test_a_report_is_valid_json_with_all_its_parts() -> None:
    report = Report(
        {"version": "0"},
        {IMPACT: Default("path law", "", "It is exact.")},
        ["A note."],
        [Family("path law", "The law.")],
        [SCENE],
        [ROW],
        [Choice(IMPACT, "plate", 1e-6, ROW), Choice(IMPACT, "plate", 1e-20, None)],
    )
    fields = json.loads(json.dumps(to_json(report), allow_nan=False))
    assert fields["rows"][0]["method"] == "path law"
    assert fields["node"][IMPACT]["why"] == "It is exact."
    assert [choice["us"] for choice in fields["choices"]] == [9.0, None]
    assert fields["scenes"][0]["measured"] is False


def test_the_csv_has_a_line_for_each_row(tmp_path: Path) -> None:
    write_csv(tmp_path / "rows.csv", [ROW, ROW._replace(us=1.0)])
    with (tmp_path / "rows.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert [line["us"] for line in lines] == ["9.0", "1.0"]
    assert lines[0]["twist_error_worst"] == ""


def test_the_error_of_a_row_is_the_larger_of_time_and_twist() -> None:
    assert ROW.error == 2e-16
    assert ROW._replace(time_error=Errors(0.0, 1e-3, 1.0)).error == pytest.approx(1e-3)
