"""`impact-predictor report`: its files, its table, and one sentence for each mistake."""

from __future__ import annotations

import csv
import json
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from command_line import invoke

from impact_predictor.report import accuracy

REPORT = Path(__file__).parent / "report" / "page_report.json"


def made_up(part: float, command: str, tell: object) -> dict[str, Any]:
    """A report that was measured before."""
    return json.loads(REPORT.read_text()) | {"made": {"command": command, "part": str(part)}}


@pytest.fixture(autouse=True)
def folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(accuracy, "report", made_up)
    return folder


run = partial(invoke, "report")


def test_page_json_and_csv_are_written_and_nothing_else(folder: Path) -> None:
    result = run("-o", "out/today")
    assert result.exit_code == 0, result.stderr
    assert {file.name for file in (folder / "out/today").iterdir()} == {"report.csv", "report.html", "report.json"}
    fields = json.loads((folder / "out/today/report.json").read_text())
    assert fields["made"]["command"] == "impact-predictor report -o out/today"
    with (folder / "out/today/report.csv").open(newline="") as file:
        assert [line["method"] for line in csv.DictReader(file)] == [row["method"] for row in fields["rows"]]
    assert "<html" in (folder / "out/today/report.html").read_text()


def test_the_terminal_shows_what_to_choose_and_what_the_node_uses() -> None:
    result = run("-o", "out")
    assert result.stdout.count("next_touchdown") == 5  # for four accuracies, and for the node
    assert all(used["why"] in result.stdout for used in json.loads(REPORT.read_text())["node"].values())
    assert result.stdout.splitlines()[-1] == "Page: out/report.html"


def test_of_how_many_methods_and_scenes_it_measures_is_said_at_the_start() -> None:
    note = f"note: measuring error and run time of {accuracy.number_of_rows()} pairs of a method and a scene\n"
    assert run("--json", "--quick").stderr == note


def test_with_json_nothing_else_is_printed_and_no_file_written(folder: Path) -> None:
    result = run("--json", "--quick")
    fields = json.loads(result.stdout)
    assert fields["made"]["part"] == str(accuracy.QUICK)
    assert fields["made"]["command"] == "impact-predictor report --quick --json"
    assert list(folder.iterdir()) == []


def test_what_cannot_be_written_is_told_in_one_sentence_and_leaves_no_part_behind(folder: Path) -> None:
    (folder / "taken").write_text("")
    (folder / "out/report.html").mkdir(parents=True)
    for name, flaw in (("taken", "the folder taken cannot be made: "), ("out", "out/report.html cannot be written")):
        result = run("-o", name)
        assert result.exit_code == 2
        assert result.stderr.splitlines()[-1].startswith(f"error: {flaw}")
    assert not list(folder.rglob("*.partial"))


def test_without_plotly_the_report_says_what_to_install_before_it_measures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "plotly", None)
    result = run("-o", "out")
    assert result.exit_code == 2
    assert "needs plotly" in result.stderr
    assert "`pip install 'impact_predictor[page]'`" in result.stderr
    assert run("--json").exit_code == 0
