"""`python benchmarks/bench_accuracy.py`: what it writes and prints of a report that was measured before."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import accuracy
import pytest
from bench_accuracy import main

from impact_predictor.errors import InputError

REPORT = json.loads(Path(__file__).with_name("page_report.json").read_text())


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(accuracy, "report", lambda part: REPORT | {"made": {"part": part}})
    return tmp_path


def test_page_json_and_csv_are_written_and_the_terminal_shows_what_to_choose_and_what_the_node_uses(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["--quick", "-o", "out/today"])
    assert {file.name for file in (folder / "out/today").iterdir()} == {"report.csv", "report.html", "report.json"}
    fields = json.loads((folder / "out/today/report.json").read_text())
    assert fields["made"]["part"] == accuracy.QUICK
    with (folder / "out/today/report.csv").open(newline="") as file:
        assert [line["method"] for line in csv.DictReader(file)] == [row["method"] for row in fields["rows"]]
    assert "<html" in (folder / "out/today/report.html").read_text()
    said = capsys.readouterr().out
    assert said.count("next_touchdown") == 5  # for four accuracies, and for the node
    assert all(used["why"] in said for used in REPORT["node"].values())
    assert said.splitlines()[-1] == "Page: out/today/report.html"


def test_a_folder_that_cannot_be_made_is_refused_before_anything_is_measured(folder: Path) -> None:
    (folder / "taken").write_text("")
    with pytest.raises(InputError, match="the folder taken cannot be made"):
        main(["-o", "taken"])
