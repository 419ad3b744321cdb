"""Error against run time: methods on the same problems, recorded tosses of a cube, and which method to choose.

A row is an object of the report's JSON: one method with one setting on one scene. A prediction that a method did not
give counts as infinitely wrong; what is infinite is null. `impact-predictor bench invariants` tells how the laws keep
to mechanics where no solution is known to so many digits.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from datetime import datetime, timezone
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from itertools import chain
from math import inf
from random import Random
from statistics import mean, median
from time import process_time
from timeit import Timer
from typing import Any, Final, NamedTuple

from ... import __version__
from ...bags.replay import replay
from ...native import form
from ...prediction.scene import read_scenes
from ...resources import find

AccuracyRow = dict[str, Any]
Methods = Mapping[tuple[str, str], Callable[[Any], Any]]
"""Methods by name and setting, "" where it has none; each answers a problem, or None where it has no answer."""

ACCURACIES: Final = (1e-2, 1e-4, 1e-6, 1e-9)
"""Relative errors that a user may want, for which the report chooses a method."""

TOUCHDOWN: Final = "touchdown"
IMPACT: Final = "impact"
SPATIAL: Final = "spatial impact"
TOSSES: Final = "tosses"
ERRORS: Final = {
    TOUCHDOWN: ("time_error", "twist_error"),
    IMPACT: ("twist_error",),
    SPATIAL: ("twist_error",),
    TOSSES: ("twist_error",),
}
"""The questions, and what of a row is an error."""

SPAN: Final = 2e-4
"""s of calls that are timed together, far above the resolution of the clock."""

TIMING: Final = (
    "CPU time of one prediction, of three runs the quickest. The program ran {form}. The law in three dimensions is "
    "compiled where numba is installed."
)


class AccuracyScene(NamedTuple):
    """A set of problems that all methods of a question meet; `reference` says what is held to be right."""

    name: str
    question: str
    title: str
    description: str
    reference: str


CUBE: Final = AccuracyScene(
    name="cube tosses",
    question=TOSSES,
    title="Cube tosses",
    description="A cube of 0.1 m, tossed onto a hard floor: the whole twist after every clear touchdown.",
    reference="measurement: between the second and the third frame after the touchdown, captured at 148 Hz",
)

VARIANTS: Final[dict[str, dict[str, Any]]] = {
    "path law": {},
    # The largest friction that is allowed holds any contact.
    "no slip": {"friction": 100.0, "restitution": 0.0},
    "total law": {"law": "total"},
    "path law, plastic": {"restitution": 0.0},
}
"""What differs of the predictor in each replay of the tosses."""

QUICK: Final = 0.15
"""Part of the problems that a quick report has."""


PROBLEMS: Final = {TOUCHDOWN: 32, IMPACT: 200, SPATIAL: 60}
"""How many problems each question asks of a scene."""


def questions() -> dict[str, Any]:
    """The modules that ask the questions of `PROBLEMS`."""
    from . import impacts, spatial, touchdowns

    return {TOUCHDOWN: touchdowns, IMPACT: impacts, SPATIAL: spatial}


def number_of_rows() -> int:
    """How many rows a report has, quick or not."""
    return sum(len(asked.SCENES) * len(asked.METHODS) for asked in questions().values()) + len(VARIANTS)


def report(part: float, command: str, tell: Callable[[int], None] = lambda done: None) -> dict[str, Any]:
    """Measure everything, on a part of the problems, for a command; the report as its JSON has it.

    `tell` is told how many rows are done.
    """
    asked = questions()
    work = chain(*[rows_of(asked[name], round(count * part)) for name, count in PROBLEMS.items()], toss_rows())
    rows: list[AccuracyRow] = []
    for row in work:
        rows.append(row)
        tell(len(rows))
    made = {"version": __version__, "python": platform.python_version()}
    made |= {name: version(name) if find_spec(name) else "not installed" for name in ("numpy", "scipy", "numba")}
    made["machine"] = f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores"
    made["date"] = datetime.now(timezone.utc).date().isoformat()
    found = {name: conclusions(rows, name, question.USED) for name, question in asked.items()}
    drawn = [scene for question in asked.values() for scene in question.SCENES]
    return {
        "made": made | {"command": command, "timing": TIMING.format(form=form())},
        "node": {question: used for question, (used, _) in found.items()},
        "scenes": [scene._asdict() for scene in (*drawn, CUBE)],
        "rows": rows,
        "choices": [choice for _, choices in found.values() for choice in choices],
    }


def problems(draw: Callable[[Random], Any], name: str, count: int) -> list[Any]:
    """`count` problems of a scene, always the same."""
    source = Random(f"4 {name}")
    return [draw(source) for _ in range(count)]


def rows_of(question: Any, count: int) -> Iterator[AccuracyRow]:
    """The methods of a question on `count` problems of each scene.

    `touchdowns`, `impacts` and `spatial` are the questions: their `SCENES` draw problems, their `METHODS` answer them,
    `reference_of` answers one rightly, and `errors_of` gives the errors of an answer by their names in `ERRORS`, and
    whether the mode is wrong.
    """
    for scene, draw in question.SCENES.items():
        drawn = problems(draw, scene.name, count)
        references = list(map(question.reference_of, drawn))
        none = dict.fromkeys(ERRORS[scene.question], inf)
        for method, solve in question.METHODS.items():
            errors = []
            for problem, right in zip(drawn, references, strict=True):
                answer = solve(problem)
                errors.append(none if answer is None else question.errors_of(problem, answer, right))
            us = [1e6 * seconds_of(partial(solve, problem)) for problem in drawn]
            yield row_of(scene, method, us, errors)


def toss_rows() -> Iterator[AccuracyRow]:
    """The recorded tosses through variants of the predictor, against what was measured after each landing."""
    (scene,) = read_scenes(find("config/cube_tosses.yaml")).values()
    for name, changes in VARIANTS.items():
        found = replay(find("examples/cube_tosses"), scene._replace(samples=0, margins=False, **changes))
        scored = [one.score.spatial for one in found.settled if not one.score.leftover_6d]
        errors = [{"twist_error": inf if one is None else one.error} for one in scored]
        costs = [1e6 * settled.cost for settled in found.settled if settled.cost is not None]
        yield row_of(CUBE, (name, ""), costs or [1e6 * median(found.costs)], errors)


def seconds_of(call: Callable[[], Any]) -> float:
    """CPU time of a call, of three runs the quickest."""
    timer = Timer(call, timer=process_time)
    repeats = 1 + int(SPAN / max(timer.timeit(1), 1e-6))
    return min(timer.repeat(3, repeats)) / repeats


def row_of(
    scene: AccuracyScene, method: tuple[str, str], us: Sequence[float], errors: Sequence[Mapping[str, float]]
) -> AccuracyRow:
    """A row from the name and setting of a method, its costs, and its errors by their names.

    What was not answered has no errors, or infinite ones.
    """
    name, setting = method
    row: AccuracyRow = {"family": "predictor" if scene is CUBE else name, "method": name, "setting": setting}
    row |= {"question": scene.question, "scene": scene.name, "us": median(us), "us_90": sorted(us)[len(us) * 9 // 10]}
    for key in ("time_error", "twist_error"):
        values = sorted(one[key] for one in errors if key in one) or [inf]
        last = len(values) - 1
        for end, value in (("", values[last // 2]), ("_90", values[-(-9 * last // 10)]), ("_worst", values[-1])):
            row[f"{key}{end}"] = value if value < inf else None
    wrong = [one["wrong_modes"] for one in errors if "wrong_modes" in one]
    failed = sum(not one or inf in one.values() for one in errors)
    return row | {"wrong_modes": mean(wrong) if wrong else None, "count": len(errors), "failed": failed}


def name_of(row: Mapping[str, Any]) -> str:
    """A method with its setting; "" where there is none."""
    return ", ".join(filter(None, (row["method"], row["setting"])))


def error_of(row: Mapping[str, Any]) -> float:
    """What 90 % of a row's errors stay below; inf where there is no such number."""
    errors = [row[f"{name}_90"] for name in ERRORS[row["question"]]]
    return max(inf if error is None else error for error in errors)


def conclusions(
    rows: Iterable[AccuracyRow], question: str, used: tuple[str, str]
) -> tuple[dict[str, str], list[dict[str, Any]]]:
    """What follows of all scenes of a question together: the used method with its numbers in a sentence, and choices.

    A choice is the cheapest method that has a wanted accuracy on every scene, with nulls where there is none.
    """
    groups: dict[tuple[str, str], list[AccuracyRow]] = {}
    for row in rows:
        if row["question"] == question:
            groups.setdefault((row["method"], row["setting"]), []).append(row)
    overall = {
        method: group[0] | {"us": mean(row["us"] for row in group), "error": max(map(error_of, group))}
        for method, group in groups.items()
    }
    choices = []
    for accuracy in ACCURACIES:
        good = [row for row in overall.values() if row["error"] <= accuracy]
        best = min(good, key=lambda row: float(row["us"]), default=AccuracyRow())
        known = {key: best.get(key) for key in ("error", "family", "method", "setting", "us")}
        choices.append({"question": question, "scene": "all", "accuracy": accuracy} | known)
    error, us, (name, setting) = overall[used]["error"], overall[used]["us"], used
    why = f"90 % of the predictions of every scene are within {error:.1g}; one takes {us:.0f} us."
    return {"method": name, "setting": setting, "why": why}, choices
