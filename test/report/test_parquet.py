"""The Parquet table of many bags, as someone reads it who knows its page of docs only."""

from __future__ import annotations

import re
from ast import literal_eval
from csv import DictReader
from pathlib import Path
from typing import Any

import pytest
from touchdowns import LANDED, UNMEASURED

from impact_predictor.errors import InputError
from impact_predictor.report.tables import TOUCHDOWNS, table_file, touchdown_rows
from impact_predictor.report.touchdowns import row_as_json, row_of

parquet = pytest.importorskip("pyarrow.parquet", reason="needs the extra fleet (make test-extras)")

pytestmark = pytest.mark.extras

DOCS = Path(__file__).parents[2] / "docs/fleets.md"
TOUCHDOWN = row_as_json(row_of("cube", UNMEASURED)) | {"stamp": 1_700_000_000_123_456_789, "old": [1], "new": [0, 2]}
LANDING = row_as_json(row_of("robot", LANDED))
ANSWERS: list[dict[str, Any]] = [
    {"bag": "a.mcap", "samples": 10, "touchdowns": [TOUCHDOWN, LANDING]},
    {"bag": "b.mcap", "samples": 5, "touchdowns": []},
    {"bag": "c.mcap", "error": "c.mcap does not exist"},
    {"bag": "d.mcap", "samples": 3, "touchdowns": [TOUCHDOWN], "damaged": "d.mcap is damaged"},
]


def written(path: Path) -> Any:
    with table_file(path, TOUCHDOWNS) as table:
        for answer in ANSWERS:
            table.add(touchdown_rows(answer))
    return parquet.read_table(path)


def test_there_is_a_row_for_each_touchdown_and_one_for_a_bag_without_any(tmp_path: Path) -> None:
    table = written(tmp_path / "t.parquet")
    rows = table.to_pylist()
    assert [row["bag"] for row in rows] == ["a.mcap", "a.mcap", "b.mcap", "c.mcap", "d.mcap"]
    assert [row["bag_status"] for row in rows] == ["ok", "ok", "ok", "failed", "damaged"]
    assert [row["stamp"] is None for row in rows] == [False, False, True, True, False]
    assert rows[3]["bag_problem"] == "c.mcap does not exist"
    toss, landing = rows[:2]
    assert toss["stamp"] == TOUCHDOWN["stamp"]  # whole: as a float it would lose its last digits
    assert (toss["predicted_vx"], toss["predicted_vy"], toss["predicted_omega"]) == TOUCHDOWN["predicted_twist"]
    assert (toss["measured_vx"], toss["relative_error"], toss["foot"]) == (None, None, None)
    assert (toss["flags"], toss["old"], toss["new"]) == (["TOO_SHORT", "REVERSED_SLIP"], [1], [0, 2])
    assert (landing["impulse_normal"], landing["impulse_tangential"]) == (0.5, -0.125)
    assert (landing["others_impulse_normal"], landing["others_impulse_tangential"]) == (0.0, 0.0)
    assert (landing["velocity_change_omega"], landing["confirmed"], landing["late"]) == (1.0, True, -0.015)


def test_a_touchdown_without_points_that_stood_has_an_empty_cell_in_a_csv_file(tmp_path: Path) -> None:
    with table_file(tmp_path / "t.csv", TOUCHDOWNS) as table:
        table.add(touchdown_rows({"bag": "a.mcap", "touchdowns": [TOUCHDOWN | {"old": (), "new": (0, 2)}]}))
    (row,) = DictReader((tmp_path / "t.csv").read_text().splitlines())
    assert (row["old"], row["new"]) == ("", "0 2")


def test_the_documented_lines_read_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with table_file("results.parquet", TOUCHDOWNS) as table:
        for answer in ANSWERS:
            table.add(touchdown_rows(answer))
        for error in (0.1, 0.3):
            scored = TOUCHDOWN | {"scored": True, "relative_error": error}
            table.add(touchdown_rows({"bag": "e.mcap", "samples": 3, "touchdowns": [scored]}))
    (code,) = re.findall(r"```python\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL)
    exec(code, {})
    failed, errors = map(literal_eval, capsys.readouterr().out.splitlines())
    assert failed == [{"bag": "c.mcap", "bag_problem": "c.mcap does not exist"}]
    assert errors == [
        {"mode": "PIVOT_SLIDE", "relative_error_count": 2, "relative_error_mean": 0.2, "relative_error_max": 0.3}
    ]


def test_every_column_is_documented_with_its_unit(tmp_path: Path) -> None:
    told = {}
    for names, units in re.findall(r"^\| (`.*?) \| (.*?) ?\|", DOCS.read_text(encoding="utf-8"), re.MULTILINE):
        columns = re.findall(r"`(\w+)`", names)
        listed = units.split(", ") if "," in units else [units] * len(columns)
        told |= dict(zip(columns, listed, strict=True))
    columns = written(tmp_path / "t.parquet").schema
    assert told == {column.name: (column.metadata or {}).get(b"unit", b"").decode() for column in columns}


def test_the_bytes_depend_on_the_answers_alone_and_units_are_in_the_file(tmp_path: Path) -> None:
    schema = written(tmp_path / "a.parquet").schema
    written(tmp_path / "b.parquet")
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
    assert schema.field("before_omega").metadata == {b"unit": b"rad/s"}


def test_a_table_that_is_not_whole_leaves_the_older_one(tmp_path: Path) -> None:
    path = tmp_path / "t.parquet"
    written(path)
    before = path.read_bytes()
    with pytest.raises(KeyError), table_file(path, TOUCHDOWNS) as table:
        table.add(touchdown_rows(ANSWERS[0]))
        raise KeyError
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("name", "said"), [("t.txt", r"ends in \.parquet or \.csv"), ("none/t.parquet", "folder of .* does not")]
)
def test_a_wrong_name_is_told_at_once(tmp_path: Path, name: str, said: str) -> None:
    with pytest.raises(InputError, match=said), table_file(tmp_path / name, TOUCHDOWNS):
        pass
