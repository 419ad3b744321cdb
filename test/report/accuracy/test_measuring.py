"""Times and answers of methods."""

from __future__ import annotations

import gc
from collections.abc import Callable
from time import process_time

import pytest

from impact_predictor.report.accuracy.measuring import Effort, measure
from impact_predictor.report.accuracy.methods import Method, method, over

EFFORT = Effort(0.05, 0.02, 3)


def busy(seconds: float) -> None:
    until = process_time() + seconds
    while process_time() < until:
        pass


def named(name: str, solve: Callable[[int], object]) -> Method:
    return method(name, name, "", solve)


def test_every_method_answers_every_problem() -> None:
    found = measure(
        [named("same", lambda n: n), *over("add", "add", "n = {}", (1, 2), lambda n, m: n + m)], [1, 2, 3], EFFORT
    )
    assert [each.answers for each in found] == [[1, 2, 3], [2, 3, 4], [3, 4, 5]]
    assert [each.method.setting for each in found] == ["", "n = 1", "n = 2"]


def test_the_time_is_that_of_one_prediction() -> None:
    (found,) = measure([named("busy", lambda n: busy(n * 1e-3))], [1, 2, 4], Effort(1.0, 0.2, 3))
    # The clock of another process may disturb a little; a factor of 1.5 tells the problems apart.
    assert found.us == pytest.approx([1e3, 2e3, 4e3], rel=0.5)


def test_a_slow_method_gets_the_first_problems_only() -> None:
    slow, quick = measure([named("slow", lambda n: busy(0.03)), named("quick", lambda n: n)], list(range(8)), EFFORT)
    assert 1 <= len(slow.answers) <= 3
    assert len(slow.us) == len(slow.answers)
    assert len(quick.answers) == 8


def test_a_method_that_breaks_has_no_answer_and_stops_nothing() -> None:
    def breaks(number: int) -> float:
        return 1.0 / number

    broken, whole = measure([named("broken", breaks), named("whole", lambda n: n)], [0, 1], EFFORT)
    assert broken.answers == [None, 1.0]
    assert whole.answers == [0, 1]


def test_a_method_that_cannot_be_prepared_has_no_answer() -> None:
    def prepare(problem: object) -> Callable[[], object]:
        raise OSError

    methods = [Method("one", "one", "", prepare), Method("many", "many", "", prepare, answers_of=list)]
    assert [each.answers for each in measure(methods, [1, 2], EFFORT)] == [[None, None], [None, None]]


def test_a_method_that_does_not_apply_is_left_out() -> None:
    picky = method("picky", "picky", "", lambda n: n, lambda n: n > 1)
    assert measure([picky], [1, 2], EFFORT) == []
    assert len(measure([picky], [2, 3], EFFORT)) == 1


def test_many_at_once_cost_a_part_of_the_whole_each() -> None:
    def prepare(problems: list[int]) -> Callable[[], list[int]]:
        def run() -> list[int]:
            busy(1e-2)
            return [2 * problem for problem in problems]

        return run

    (found,) = measure([Method("many", "many", "", prepare, answers_of=list)], list(range(10)), EFFORT)
    assert found.answers == [2 * n for n in range(10)]
    assert sorted(found.us)[len(found.us) // 2] == pytest.approx(1e3, rel=0.5)


def test_the_collector_of_garbage_works_again_afterwards() -> None:
    seen = []
    measure([named("looks", lambda n: seen.append(gc.isenabled()))], [1], EFFORT)
    assert not any(seen)
    assert gc.isenabled()
