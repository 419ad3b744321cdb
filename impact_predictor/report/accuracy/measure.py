"""Errors and CPU times of methods on the problems of a scene, and the cheapest of them for a wanted accuracy.

A row is an object of the report's JSON: one method with one setting on one scene. A prediction that a method did not
give counts as infinitely wrong; what is infinite is null.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite
from random import Random
from statistics import mean, median
from time import process_time
from typing import Any, Final, NamedTuple

AccuracyRow = dict[str, Any]

ACCURACIES: Final = (1e-2, 1e-4, 1e-6, 1e-9)
"""Relative errors that a user may want, for which the report chooses a method."""

ALL_SCENES: Final = "all"
"""Stands in the place of a scene where a choice holds for every computed scene of a question."""

TOUCHDOWN: Final = "touchdown"
IMPACT: Final = "impact"
STABILITY: Final = "stability"

ERRORS: Final = {
    TOUCHDOWN: ("time_error_90", "twist_error_90"),
    IMPACT: ("twist_error_90",),
    STABILITY: ("violation_worst",),
}
"""What of a row counts as its error, by the question."""

SPAN: Final = 2e-4
"""s of calls that are timed together, far above the resolution of the clock."""

ROUNDS: Final = 3
"""How often the calls of a problem are timed; the quickest counts."""


class AccuracyScene(NamedTuple):
    """A set of problems that all methods of a question meet.

    `reference` says what is held to be right; `measured` whether that is a measurement, which no choice is made on.
    """

    name: str
    question: str
    title: str
    description: str
    reference: str
    measured: bool = False


class Method(NamedTuple):
    """A method with one setting; it answers a problem, or None where it has no answer.

    Where it `prepares`, `solve` gives the function that is timed: what a user would do once, such as building a model,
    is left out of the time.
    """

    family: str
    name: str
    setting: str
    solve: Callable[[Any], Any]
    applies: Callable[[Any], bool] = lambda problem: True
    prepares: bool = False


class MethodRun(NamedTuple):
    """A method on the first problems of a scene: its answers, and us per prediction for each."""

    method: Method
    answers: list[Any]
    us: list[float]


def problems(scenes: Mapping[str, tuple[Any, ...]], name: str, count: int) -> list[Any]:
    """`count` problems of a scene, always the same; the last of what a scene has draws them."""
    source = Random(f"4 {name}")
    return [scenes[name][-1](source) for _ in range(count)]


def run(method: Method, problems: Sequence[Any], seconds: float) -> MethodRun:
    """Answers and times; a slow method gets as many of the problems as there is time for, and at least one."""
    answers, us, began = list[Any](), list[float](), process_time()
    with warnings.catch_warnings():
        # Methods that lose their way say so.
        warnings.simplefilter("ignore")
        for problem in problems:
            call = _call(method, problem)
            answers.append(call())
            us.append(1e6 * seconds_of(call))
            if process_time() - began > seconds:
                break
    return MethodRun(method, answers, us)


def _call(method: Method, problem: Any) -> Callable[[], Any]:
    """What is timed; whatever a method raises, it has no answer, which must not break the report."""
    try:
        solve = method.solve(problem) if method.prepares else lambda: method.solve(problem)
    except Exception:
        return lambda: None

    def call() -> Any:
        try:
            return solve()
        except Exception:
            return None

    return call


def seconds_of(call: Callable[[], Any]) -> float:
    """CPU time of a call."""
    times, repeats = list[float](), 1
    while len(times) < ROUNDS:
        began = process_time()
        for _ in range(repeats):
            call()
        taken = process_time() - began
        if taken < SPAN:
            repeats *= 4
        else:
            times.append(taken / repeats)
            if taken > 100.0 * SPAN:
                break
    return min(times)


def row_of(
    scene: AccuracyScene,
    names: Sequence[str],
    us: Sequence[float],
    times: Sequence[float] | None = None,
    twists: Sequence[float] | None = None,
    violations: Sequence[float] | None = None,
    wrong_modes: float | None = None,
) -> AccuracyRow:
    """A row from the family, name and setting of a method, its costs and its errors; those that failed are inf."""
    errors = {"time_error": times, "twist_error": twists, "violation": violations}
    row: AccuracyRow = dict(zip(("family", "method", "setting"), names, strict=True))
    row |= {"question": scene.question, "scene": scene.name, "us": median(us), "us_90": sorted(us)[len(us) * 9 // 10]}
    for name, values in errors.items():
        ordered = sorted(values) if values else [inf]
        last = len(ordered) - 1
        parts = {"": ordered[last // 2], "_90": ordered[-(-9 * last // 10)], "_worst": ordered[-1]}
        row |= {f"{name}{end}": error if isfinite(error) else None for end, error in parts.items()}
    known = next(values for values in (twists, times, violations) if values is not None)
    return row | {"wrong_modes": wrong_modes, "count": len(known), "failed": sum(one == inf for one in known)}


def error_of(row: Mapping[str, Any]) -> float:
    """What 90 % of a row's errors stay below, the larger of the time's and the twist's; inf where there is none.

    Of the stability it is the worst violation.
    """
    return max(inf if row[name] is None else row[name] for name in ERRORS[row["question"]])


def on_all(rows: Iterable[AccuracyRow], scenes: Sequence[str]) -> Iterator[AccuracyRow]:
    """The methods that answer on every scene, each with its mean cost and its largest errors."""
    groups: dict[tuple[str, str], list[AccuracyRow]] = {}
    for row in rows:
        if row["scene"] in scenes:
            groups.setdefault((row["method"], row["setting"]), []).append(row)
    for group in groups.values():
        if len(group) == len(scenes):
            yield max(group, key=error_of) | {"us": mean(row["us"] for row in group)}


def computed(scenes: Iterable[AccuracyScene], question: str) -> list[str]:
    """The names of the scenes of a question whose truth is computed."""
    return [scene.name for scene in scenes if scene.question == question and not scene.measured]


def choices_of(rows: Sequence[AccuracyRow], scenes: Sequence[AccuracyScene]) -> list[dict[str, Any]]:
    """The cheapest method for each wanted accuracy: on each computed scene, and on all of a question together."""
    found = []
    for question in (TOUCHDOWN, IMPACT):
        mine = [row for row in rows if row["question"] == question]
        names = computed(scenes, question)
        groups = {name: [row for row in mine if row["scene"] == name] for name in names}
        for scene, group in (groups | {ALL_SCENES: list(on_all(mine, names))}).items():
            for accuracy in ACCURACIES:
                good = (row for row in group if error_of(row) <= accuracy)
                best = min(good, key=lambda row: float(row["us"]), default=None)
                choice: dict[str, Any] = {"question": question, "scene": scene, "accuracy": accuracy}
                choice |= {key: best and best[key] for key in ("family", "method", "setting", "us")}
                choice["error"] = best and error_of(best)
                found.append(choice)
    return found


def default_of(used: tuple[str, str], rows: Sequence[AccuracyRow], names: Sequence[str]) -> dict[str, str]:
    """What the node uses and why, in a sentence, from the rows of a question and the names of its computed scenes.

    Empty where that was not measured on all of them.
    """
    everywhere = list(on_all(rows, names))
    mine = next((row for row in everywhere if (row["method"], row["setting"]) == used), None)
    if mine is None:
        return {}
    why = f"Of every scene 90 % are within {error_of(mine):.1g}, for {mine['us']:.0f} us in the mean of the scenes"
    others = [row for row in everywhere if row["us"] < mine["us"] and row["method"] != mine["method"]]
    best = min(others, key=error_of, default=None)
    if best is None:
        why += "; no other method that answers on all scenes is cheaper."
    else:
        name = ", ".join(filter(None, (best["method"], best["setting"])))
        error = f"is {error_of(best):.2g} off" if error_of(best) < inf else "has no answer on some"
        why += f"; the most accurate of the other methods that are cheaper and apply to all, {name}, {error}."
    return {"method": used[0], "setting": used[1], "why": why}
