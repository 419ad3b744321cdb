"""Answers, times and errors of methods, and which of them is chosen."""

from __future__ import annotations

from math import inf
from time import process_time
from typing import Any

import pytest

from impact_predictor.report.accuracy.measure import (
    ALL_SCENES,
    IMPACT,
    TOUCHDOWN,
    AccuracyScene,
    Method,
    choices_of,
    computed,
    default_of,
    error_of,
    row_of,
    run,
)


def busy(seconds: float) -> None:
    until = process_time() + seconds
    while process_time() < until:
        pass


def test_a_method_answers_every_problem_or_as_many_as_there_is_time_for() -> None:
    assert run(Method("f", "m", "", lambda n: n + 1), [1, 2, 3], 1.0).answers == [2, 3, 4]
    slow = run(Method("f", "m", "", lambda n: busy(0.03)), list(range(100)), 0.05)
    assert 1 <= len(slow.answers) <= 3
    assert slow.us[0] == pytest.approx(3e4, rel=0.5)


def test_a_method_that_breaks_has_no_answer() -> None:
    assert run(Method("f", "m", "", lambda n: 1 / n), [0, 1], 1.0).answers == [None, 1.0]
    assert run(Method("f", "m", "", lambda n: 1 / n, prepares=True), [0], 1.0).answers == [None]


def test_what_a_method_prepares_is_not_timed() -> None:
    def prepare(n: int) -> Any:
        busy(0.02)
        return lambda: n

    prepared = run(Method("f", "m", "", prepare, prepares=True), [5], 1.0)
    assert prepared.answers == [5]
    assert prepared.us[0] < 1e3


SCENES = [
    AccuracyScene("one", TOUCHDOWN, "", "", ""),
    AccuracyScene("two", TOUCHDOWN, "", "", ""),
    AccuracyScene("real", TOUCHDOWN, "", "", "", True),
]


def row(scene: int, name: str, us: float, error: float, setting: str = "") -> dict[str, Any]:
    return row_of(SCENES[scene], (name, name, setting), [us], [error], [0.0])


ROWS = [
    row(0, "rough", 1.0, 1e-3),
    row(1, "rough", 1.0, 0.5),
    row(0, "sharp", 20.0, 1e-12),
    row(1, "sharp", 30.0, 1e-11),
    row(0, "special", 5.0, 1e-12),
    row(2, "rough", 1.0, 1e-9),
]


def test_a_row_has_quantiles_of_the_errors_and_null_for_what_is_endless() -> None:
    numbers = [float(k) for k in range(11)]
    mine = row_of(SCENES[0], ("f", "m", "s"), numbers, [*numbers[:-1], inf], None, wrong_modes=0.25)
    assert (mine["us"], mine["us_90"]) == (5.0, 9.0)
    assert (mine["time_error"], mine["time_error_90"], mine["time_error_worst"]) == (5.0, 9.0, None)
    assert (mine["count"], mine["failed"], mine["wrong_modes"]) == (11, 1, 0.25)
    assert error_of(mine) == inf  # no error of the twist


def test_the_cheapest_that_is_good_enough_is_chosen_for_each_scene_and_for_all() -> None:
    chosen = {(one["scene"], one["accuracy"]): one for one in choices_of(ROWS, SCENES) if one["question"] == TOUCHDOWN}
    assert chosen["one", 1e-2]["method"] == "rough"
    assert chosen["one", 1e-4]["method"] == chosen["one", 1e-9]["method"] == "special"
    assert chosen["two", 1e-2]["method"] == "sharp"
    assert not any(scene == "real" for scene, _ in chosen)
    everywhere = chosen[ALL_SCENES, 1e-9]
    assert (everywhere["method"], everywhere["us"], everywhere["error"]) == ("sharp", 25.0, 1e-11)
    lost = choices_of([row(0, "lost", 1.0, inf)], SCENES[:1])
    assert all(one["method"] is None for one in lost)


def test_the_default_of_the_node_is_told_with_its_numbers() -> None:
    names = computed(SCENES, TOUCHDOWN)
    rows = [*ROWS, row(0, "own", 10.0, 1e-15, "t = 1"), row(1, "own", 10.0, 1e-14, "t = 1")]
    default = default_of(("own", "t = 1"), rows, names)
    assert (default["method"], default["setting"]) == ("own", "t = 1")
    assert "1e-14, for 10 us" in default["why"]
    assert "rough, is 0.5 off" in default["why"]
    assert default_of(("other", ""), rows, names) == {}
    assert computed(SCENES, IMPACT) == []
