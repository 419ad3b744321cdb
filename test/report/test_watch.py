"""The watch over a deck as JSON, as a page and as a table, from a log by hand."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from read_page import PageReader, traces
from replay_answers import answer

from impact_predictor.bags.watched import FORECAST, QUANTILES, STEP, LevelSpell, WatchLog
from impact_predictor.prediction.deck.forecast import LEADS
from impact_predictor.prediction.watch.levels import Level
from impact_predictor.report.page.replay import page_of_replay
from impact_predictor.report.page.watch import ACROSS
from impact_predictor.report.watch import (
    MOST,
    SERIES,
    forecast_skill,
    series_of,
    under_warning,
    warned_of,
    watch_as_json,
)
from impact_predictor.stamps import NANOSECONDS

S = NANOSECONDS
SPELLS = (
    LevelSpell("crate", Level.OK, 0, 4 * S),
    LevelSpell("crate", Level.WARN, 4 * S, 9 * S),
    LevelSpell("crate", Level.ERROR, 9 * S, 12 * S),
    LevelSpell("crate", Level.OK, 12 * S, 20 * S),
    LevelSpell("crate", Level.WARN, 20 * S, 25 * S),
    LevelSpell("crate", Level.OK, 25 * S, 100 * S),
)


def log(rows: int = 200, **given: Any) -> WatchLog:
    """A deck that swings once in 10 s, of which each forecast is 0.1 m/s^2 too great, and one unit on it."""
    stamps = np.arange(rows) * STEP
    swing = np.sin(2.0 * np.pi * stamps / (10 * S))
    due = stamps[:, None] / S + LEADS
    came = np.sin(0.2 * np.pi * due)
    told = np.stack([came - 0.5, came + 0.1, came + 0.7], axis=-1)
    usual = WatchLog(
        names=("crate",),
        stamps=stamps,
        deck=np.stack([0.1 * swing, 0.0 * swing, 0.0 * swing, swing, 9.81 + 0.0 * swing], axis=1),
        units=np.stack([0.0 * swing, np.abs(swing), 0.5 * np.abs(swing), 0.0 * swing], axis=1)[:, None],
        made=np.arange(rows),
        forecasts=np.stack([0.1 * told, 0.0 * told, 0.0 * told, told], axis=2),
        spells=SPELLS,
        last={"crate": {"tips_per_hour": "3.5", "time_to_tip": "inf", "edge": "port", "tip_peaks": "rayleigh"}},
        tracked={"forecast": "NO_SKILL", "window.linear": "0.300", "window.angular": "0.400"},
        events={"crate": {10 * S: "slides", 50 * S: "lifts"}},
        knows_events=True,
    )
    return usual._replace(**given)


def test_events_have_how_long_a_warning_stood_and_warnings_whether_they_were_vain() -> None:
    (unit,) = json.loads(json.dumps(watch_as_json(log()), allow_nan=False))["units"].values()
    assert unit["events"] == [
        {"stamp": 10 * S, "what": "slides", "warned_ahead": 6.0, "error_ahead": 1.0},
        {"stamp": 50 * S, "what": "lifts", "warned_ahead": None, "error_ahead": None},
    ]
    assert unit["warnings"] == [
        {"begin": 4 * S, "end": 12 * S, "vain": False},
        {"begin": 20 * S, "end": 25 * S, "vain": True},
    ]
    assert unit["most"] == {"slide": pytest.approx(1.0, abs=0.02), "tip": pytest.approx(0.5, abs=0.01)}
    assert unit["reported"] == {"tips_per_hour": 3.5, "edge": "port", "tip_peaks": "rayleigh"}
    # Known for 100 s, under warning for 13 s.
    chance = "units were under warning 13.0 % of the time: so many events a warning meets by chance"
    said = f"a warning had stood 6.0 s in the median, 6.0 s at least; 1 of 2 warnings vain; {chance}"
    assert warned_of([unit]) == ("1 of 2", said)
    assert under_warning([unit, unit]) == pytest.approx(0.13)
    assert under_warning([]) is None


def test_what_happens_before_anything_is_known_counts_for_nothing() -> None:
    late = (LevelSpell("crate", Level.STALE, 0, 30 * S), LevelSpell("crate", Level.OK, 30 * S, 100 * S))
    (unit,) = watch_as_json(log(spells=late))["units"].values()
    assert [one["stamp"] for one in unit["events"]] == [50 * S]
    warned = unit | {"warnings": [{"begin": 65 * S, "end": 100 * S, "vain": True}]}
    assert under_warning([warned]) == pytest.approx(0.5)


def test_the_skill_of_a_forecast_stands_beside_that_of_simple_answers() -> None:
    found = {(one["of"], one["lead"]): one for one in forecast_skill(log())}
    far = found["across", 5.0]
    assert far["forecast"] == pytest.approx(0.1)
    assert far["now"] == pytest.approx(2.0**0.5, rel=0.01)  # half a swing later it is the other way
    assert far["mean"] == pytest.approx(0.5**0.5, rel=0.05)
    assert far["within"] == 1.0
    assert found["roll", 5.0]["forecast"] == pytest.approx(0.01)
    assert found["across", 10.0]["now"] == pytest.approx(0.0, abs=1e-6)


def test_a_long_log_is_thinned_and_keeps_its_extremes() -> None:
    long = log(20 * MOST)
    long.units[777, 0, 2] = 1.5
    long.deck[888, 0] = -0.7
    found = watch_as_json(long)
    assert len(found["stamps"]) == len(found["deck"]["roll"]) == len(found["units"]["crate"]["tip"]) <= 2 * MOST
    assert (max(found["units"]["crate"]["tip"]), min(found["deck"]["roll"])) == (1.5, -0.7)
    # Two rows of twenty.
    assert set(np.diff(found["stamps"])) == {10 * STEP}
    assert len(found["forecasts"]["made"]) <= MOST


def test_a_watch_that_saw_nothing_has_an_answer_too() -> None:
    nothing = log(0, spells=(), events={}, last={})
    found = watch_as_json(nothing)
    assert (found["stamps"], found["skill"], found["units"]["crate"]["events"]) == ([], [], [])
    assert "The watch over" in page_of_replay([answer(watch=found)])


def test_the_page_has_deck_forecast_levels_margins_events_and_statistics() -> None:
    page = PageReader(page_of_replay([answer("voyage.mcap", watch=watch_as_json(log()))]))
    assert "events warned of 1 of 2" in " ".join(page.text.split())
    drawn = page.figures["The watch over voyage.mcap"]
    shown = traces(drawn)
    assert {"roll, port up", "felt across", "forecast 5 s before", "WARN", "ERROR", "event"} <= shown.keys()
    assert "felt along" not in shown  # there is none
    assert shown["WARN"]["base"] == [4.0, 20.0]
    assert shown["event"]["x"] == [10.0, 50.0]
    assert shown["forecast 5 s before"]["x"] == pytest.approx(5.0 + np.arange(200) * STEP / S)
    assert max(shown["roll, port up"]["y"]) == pytest.approx(np.degrees(0.1), abs=0.05)
    assert drawn["layout"]["xaxis"]["anchor"] == "y4"
    near, statistics, skill = page.tables["watch"]
    assert near[1][3:5] == ["2", "1"]
    assert (near[0][-1], near[1][-1]) == ("time under warning", "13.0 %")
    assert "The forecast at the end: no better than" in page.text
    assert "found over 0.3 s and 0.4 s." in page.text
    assert statistics == [["of", "crate"], ["tips per hour", "3.5"], ["tip peaks", "rayleigh"]]
    assert [skill[row][:2] for row in (5, 6)] == [["roll, 5 s ahead", "0.573"], ["across, 5 s ahead", "0.100"]]


def test_statistics_stand_in_as_many_tables_as_fit_beside_each_other() -> None:
    watch = watch_as_json(log())
    units = {f"crate {k}": watch["units"]["crate"] for k in range(ACROSS + 1)}
    _, first, second, _ = PageReader(page_of_replay([answer(watch=watch | {"units": units})])).tables["watch"]
    assert (len(first[0]), second[0]) == (ACROSS + 1, ["of", f"crate {ACROSS}"])
    assert second[1] == ["tips per hour", "3.5"]


def test_a_name_cannot_break_the_page() -> None:
    evil = "<script>x</script>"
    other = log(names=(evil,), spells=tuple(one._replace(unit=evil) for one in SPELLS), events={evil: {10 * S: evil}})
    assert evil not in page_of_replay([answer(watch=watch_as_json(other))])


def test_the_table_has_a_row_for_each_unit_at_each_stamp_as_parquet_and_as_csv(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    from impact_predictor.report.tables import table_file

    one = log(20)
    one.deck[3] = np.nan
    for name in ("t.parquet", "t.csv"):
        with table_file(tmp_path / name, SERIES) as table:
            table.add(series_of("voyage.mcap", one))
    rows = parquet.read_table(tmp_path / "t.parquet").to_pylist()
    with (tmp_path / "t.csv").open(newline="") as file:
        texts = list(csv.DictReader(file))
    assert len(rows) == len(texts) == 20
    assert (rows[4]["stamp"], rows[4]["unit"], rows[4]["level"]) == (4 * STEP, "crate", "OK")
    assert rows[3]["roll"] is None
    assert texts[3]["roll"] == ""
    assert float(texts[5]["across"]) == rows[5]["across"] == pytest.approx(one.deck[5, 3])
    name = f"{FORECAST[3]}_in_{LEADS[2]:g}s_{QUANTILES[1]:g}"
    assert rows[2][name] == pytest.approx(one.forecasts[2, 2, 3, 1])
    assert list(texts[0]) == list(SERIES)


def test_a_row_of_several_bags_tells_how_many_events_were_warned_of_where_there_was_a_watch() -> None:
    page = PageReader(page_of_replay([answer("a.mcap"), answer("b.mcap", watch=watch_as_json(log()))]))
    (head, *rows), *_ = page.tables["bags"]
    place = head.index("events warned of")
    assert {row[0]: row[place].split(" a ")[0] for row in rows} == {"a.mcap": "–", "b.mcap": "1 of 2"}
    assert "bags" in PageReader(page_of_replay([answer("a.mcap"), answer("b.mcap")])).tables
