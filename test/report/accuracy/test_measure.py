"""Answers, times and errors of methods, and which of them is chosen."""

from __future__ import annotations

from math import inf
from random import Random
from time import process_time
from types import SimpleNamespace
from typing import Any

import pytest

from impact_predictor.report.accuracy.measure import (
    TOUCHDOWN,
    AccuracyScene,
    choices_of,
    error_of,
    row_of,
    rows_of,
    used_of,
)

SCENES = [AccuracyScene("one", TOUCHDOWN, "", "", ""), AccuracyScene("two", TOUCHDOWN, "", "", "")]


def busy(seconds: float) -> float:
    until = process_time() + seconds
    while process_time() < until:
        pass
    return seconds


def test_a_method_answers_every_problem_or_as_many_as_there_is_time_for() -> None:
    methods = {("exact", ""): lambda n: n, ("none", ""): lambda n: None, ("slow", ""): lambda n: busy(0.03)}
    question = SimpleNamespace(
        SCENES=dict.fromkeys(SCENES, Random.random),
        reference_of=lambda problem: problem,
        errors_of=lambda problem, answer, right: {"time_error": abs(answer - right), "twist_error": 0.0},
    )
    exact, none, few = list(rows_of(question, methods, 50, 0.05))[:3]
    assert (exact["method"], exact["count"], exact["failed"], error_of(exact)) == ("exact", 50, 0, 0.0)
    assert (none["count"], none["failed"], error_of(none)) == (50, 50, inf)
    assert 1 <= few["count"] <= 3
    assert few["us"] == pytest.approx(3e4, rel=0.5)


def row(scene: int, name: str, us: float, error: float, setting: str = "") -> dict[str, Any]:
    return row_of(SCENES[scene], (name, name, setting), [us], [{"time_error": error, "twist_error": 0.0}])


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
    mine = row_of(SCENES[0], ("f", "m", "s"), numbers, errors)
    assert (mine["us"], mine["us_90"]) == (5.0, 9.0)
    assert (mine["time_error"], mine["time_error_90"], mine["time_error_worst"]) == (5.0, 9.0, None)
    assert (mine["count"], mine["failed"], mine["wrong_modes"]) == (11, 1, pytest.approx(3 / 11))
    assert error_of(mine) == inf  # no error of the twist


def test_the_cheapest_that_is_good_enough_on_all_computed_scenes_is_chosen() -> None:
    chosen = {one["accuracy"]: one for one in choices_of(ROWS, TOUCHDOWN)}
    assert (chosen[1e-2]["method"], chosen[1e-4]["method"]) == ("special", "sharp")
    assert (chosen[1e-9]["us"], chosen[1e-9]["error"]) == (25.0, 1e-11)
    assert all(one["method"] is None for one in choices_of([row(0, "lost", 1.0, inf)], TOUCHDOWN))


def test_what_the_node_uses_is_told_with_its_numbers() -> None:
    rows = [*ROWS, row(0, "own", 10.0, 1e-15, "t = 1"), row(1, "own", 12.0, 1e-14, "t = 1")]
    used = used_of(("own", "t = 1"), rows, TOUCHDOWN)
    assert (used["method"], used["setting"]) == ("own", "t = 1")
    assert "within 1e-14; one takes 11 us" in used["why"]
    assert used_of(("other", ""), rows, TOUCHDOWN) == {}
