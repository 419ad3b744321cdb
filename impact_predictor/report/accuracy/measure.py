"""Errors and CPU times of methods on the problems of a scene, and the cheapest of them for a wanted accuracy.

A row is an object of the report's JSON: one method with one setting on one scene. A prediction that a method did not
give counts as infinitely wrong; what is infinite is null.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from math import inf
from random import Random
from statistics import mean, median
from time import process_time
from timeit import Timer
from typing import Any, Final, NamedTuple

AccuracyRow = dict[str, Any]
Methods = Mapping[tuple[str, str], Callable[[Any], Any]]
"""Methods by name and setting, "" where it has none; each answers a problem, or None where it has no answer."""

ACCURACIES: Final = (1e-2, 1e-4, 1e-6, 1e-9)
"""Relative errors that a user may want, for which the report chooses a method."""

TOUCHDOWN: Final = "touchdown"
IMPACT: Final = "impact"
STABILITY: Final = "stability"
TOSSES: Final = "tosses"

ERRORS: Final = {
    TOUCHDOWN: ("time_error", "twist_error"),
    IMPACT: ("twist_error",),
    STABILITY: ("violation",),
    TOSSES: ("twist_error",),
}
"""The questions, and what of a row is an error."""

SPAN: Final = 2e-4
"""s of calls that are timed together, far above the resolution of the clock."""


class AccuracyScene(NamedTuple):
    """A set of problems that all methods of a question meet; `reference` says what is held to be right."""

    name: str
    question: str
    title: str
    description: str
    reference: str


def problems(draw: Callable[[Random], Any], name: str, count: int) -> list[Any]:
    """`count` problems of a scene, always the same."""
    source = Random(f"4 {name}")
    return [draw(source) for _ in range(count)]


def rows_of(question: Any, methods: Methods, count: int, seconds: float) -> Iterator[AccuracyRow]:
    """Methods on `count` problems of each scene of a question; a slow one gets as many as it answers in `seconds`.

    `touchdowns` and `impacts` are the questions: their `SCENES` draw problems, `reference_of` answers one rightly, and
    `errors_of` gives the errors of an answer by their names in `ERRORS`, and whether the mode is wrong.
    """
    for scene, draw in question.SCENES.items():
        drawn = problems(draw, scene.name, count)
        references = list(map(question.reference_of, drawn))
        none = dict.fromkeys(ERRORS[scene.question], inf)
        for (name, setting), solve in methods.items():
            found, us, began = list[Mapping[str, float]](), list[float](), process_time()
            for problem, right in zip(drawn, references, strict=True):
                answer = solve(problem)
                found.append(none if answer is None else question.errors_of(problem, answer, right))
                us.append(1e6 * seconds_of(partial(solve, problem)))
                if process_time() - began > seconds:
                    break
            yield row_of(scene, (name, name, setting), us, found)


def seconds_of(call: Callable[[], Any]) -> float:
    """CPU time of a call, of three runs the quickest."""
    timer = Timer(call, timer=process_time)
    repeats = 1 + int(SPAN / max(timer.timeit(1), 1e-6))
    return min(timer.repeat(3, repeats)) / repeats


def row_of(
    scene: AccuracyScene, names: Sequence[str], us: Sequence[float], errors: Sequence[Mapping[str, float]]
) -> AccuracyRow:
    """A row from the family, name and setting of a method, its costs, and its errors by their names.

    What was not answered has no errors, or infinite ones.
    """
    row: AccuracyRow = dict(zip(("family", "method", "setting"), names, strict=True))
    row |= {"question": scene.question, "scene": scene.name, "us": median(us), "us_90": sorted(us)[len(us) * 9 // 10]}
    for name in ("time_error", "twist_error", "violation"):
        values = sorted(one[name] for one in errors if name in one) or [inf]
        last = len(values) - 1
        for end, value in (("", values[last // 2]), ("_90", values[-(-9 * last // 10)]), ("_worst", values[-1])):
            row[f"{name}{end}"] = value if value < inf else None
    wrong = [one["wrong_modes"] for one in errors if "wrong_modes" in one]
    failed = sum(not one or inf in one.values() for one in errors)
    return row | {"wrong_modes": mean(wrong) if wrong else None, "count": len(errors), "failed": failed}


def error_of(row: Mapping[str, Any]) -> float:
    """What 90 % of a row's errors stay below, the larger of the time's and the twist's; inf where there is none.

    Of the stability it is the worst violation.
    """
    end = "worst" if row["question"] == STABILITY else "90"
    errors = [row[f"{name}_{end}"] for name in ERRORS[row["question"]]]
    return max(inf if error is None else error for error in errors)


def on_all(rows: Iterable[AccuracyRow], question: str) -> list[AccuracyRow]:
    """The methods on all scenes of a question together, each with its mean cost and its largest errors."""
    groups: dict[tuple[str, str], list[AccuracyRow]] = {}
    for row in rows:
        if row["question"] == question:
            groups.setdefault((row["method"], row["setting"]), []).append(row)
    return [max(group, key=error_of) | {"us": mean(row["us"] for row in group)} for group in groups.values()]


def choices_of(rows: Iterable[AccuracyRow], question: str) -> Iterator[dict[str, Any]]:
    """The cheapest method for each wanted accuracy on all scenes of a question together."""
    everywhere = on_all(rows, question)
    for accuracy in ACCURACIES:
        good = [row for row in everywhere if error_of(row) <= accuracy]
        best = min(good, key=lambda row: float(row["us"]), default=None)
        choice = {"question": question, "scene": "all", "accuracy": accuracy, "error": best and error_of(best)}
        yield choice | {key: best and best[key] for key in ("family", "method", "setting", "us")}


def used_of(method: tuple[str, str], rows: Iterable[AccuracyRow], question: str) -> dict[str, str]:
    """What the node uses, with its error and cost in a sentence; empty where it was not measured."""
    for row in on_all(rows, question):
        name, setting, us = row["method"], row["setting"], row["us"]
        if (name, setting) == method:
            why = f"90 % of the predictions of every scene are within {error_of(row):.1g}; one takes {us:.0f} us."
            return {"method": name, "setting": setting, "why": why}
    return {}
