"""Answers, times and errors of methods, which of them is chosen, and a whole report of few problems."""

from __future__ import annotations

import json
from math import inf
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from read_page import PageReader
from recordings import first_messages, write_bag

from impact_predictor.report import accuracy
from impact_predictor.report.accuracy import (
    CUBE,
    IMPACT,
    SPATIAL,
    TOUCHDOWN,
    AccuracyScene,
    conclusions,
    error_of,
    impacts,
    row_of,
    rows_of,
    seconds_of,
    spatial,
    touchdowns,
)
from impact_predictor.report.accuracy.page import accuracy_page
from impact_predictor.resources import find

SCENES = [AccuracyScene("one", TOUCHDOWN, "", "", ""), AccuracyScene("two", TOUCHDOWN, "", "", "")]


def test_a_method_answers_every_problem_and_what_it_does_not_answer_is_infinitely_wrong() -> None:
    question = SimpleNamespace(
        SCENES=dict.fromkeys(SCENES, Random.random),
        METHODS={("exact", ""): lambda n: n, ("none", ""): lambda n: None},
        reference_of=lambda problem: problem,
        errors_of=lambda problem, answer, right: {"time_error": abs(answer - right), "twist_error": 0.0},
    )
    exact, none = list(rows_of(question, 50))[:2]
    assert (exact["method"], exact["count"], exact["failed"], error_of(exact)) == ("exact", 50, 0, 0.0)
    assert (none["count"], none["failed"], error_of(none)) == (50, 50, inf)


def test_a_slow_call_is_timed_as_slow() -> None:
    assert seconds_of(lambda: sum(range(100_000))) > 10.0 * seconds_of(lambda: sum(range(1000)))


def row(scene: int, name: str, us: float, error: float) -> dict[str, Any]:
    return row_of(SCENES[scene], (name, ""), [us], [{"time_error": error, "twist_error": 0.0}])


ROWS = [
    row(0, "rough", 1.0, 1e-3),
    row(1, "rough", 1.0, 0.5),
    row(0, "sharp", 20.0, 1e-12),
    row(1, "sharp", 30.0, 1e-11),
    row(0, "special", 5.0, 1e-12),
    row(1, "special", 5.0, 5e-3),
]


def test_a_row_has_quantiles_of_the_errors_and_null_for_what_is_endless() -> None:
    numbers = [float(k) for k in range(11)]
    errors = [{"time_error": one, "wrong_modes": one > 7.0} for one in (*numbers[:-1], inf)]
    mine = row_of(SCENES[0], ("m", "s"), numbers, errors)
    assert (mine["us"], mine["us_90"]) == (5.0, 9.0)
    assert (mine["time_error"], mine["time_error_90"], mine["time_error_worst"]) == (5.0, 9.0, None)
    assert (mine["count"], mine["failed"], mine["wrong_modes"]) == (11, 1, pytest.approx(3 / 11))
    assert error_of(mine) == inf  # no error of the twist


def test_the_cheapest_that_is_good_enough_on_all_scenes_is_chosen_and_the_nodes_is_told_with_its_numbers() -> None:
    used, choices = conclusions(ROWS, TOUCHDOWN, ("sharp", ""))
    chosen = {one["accuracy"]: one for one in choices}
    assert (chosen[1e-2]["method"], chosen[1e-4]["method"]) == ("special", "sharp")
    assert (chosen[1e-9]["us"], chosen[1e-9]["error"]) == (25.0, 1e-11)
    assert (used["method"], used["setting"]) == ("sharp", "")
    assert "within 1e-11; one takes 25 us" in used["why"]
    _, choices = conclusions([row(0, "lost", 1.0, inf)], TOUCHDOWN, ("lost", ""))
    assert all(one["method"] is None for one in choices)


@pytest.mark.slow
def test_a_small_report_has_a_row_for_each_method_on_each_scene_and_makes_a_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    some = write_bag(tmp_path / "some.mcap", first_messages(4000))
    monkeypatch.setattr(accuracy, "find", lambda name: some if name == "examples/cube_tosses" else find(name))
    done = list[int]()
    report = json.loads(json.dumps(accuracy.report(0.02, "a command", done.append), allow_nan=False))
    assert done == list(range(1, len(report["rows"]) + 1))
    assert len(done) == accuracy.number_of_rows()
    rows = {(row["question"], row["scene"], row["method"], row["setting"]) for row in report["rows"]}
    assert len(rows) == len(report["rows"])
    questions: Any = (touchdowns, TOUCHDOWN), (impacts, IMPACT), (spatial, SPATIAL)
    for question, name in questions:
        for scene in question.SCENES:
            assert {(name, scene.name, *method) for method in question.METHODS} <= rows
    tosses = {row["method"]: row["twist_error"] for row in report["rows"] if row["scene"] == CUBE.name}
    assert 0.03 < tosses["path law"] < tosses["no slip"]
    assert set(report["node"]) == {TOUCHDOWN, IMPACT, SPATIAL}
    assert len(PageReader(accuracy_page(report, script="")).figures) == 4
