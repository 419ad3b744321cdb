"""Values of the report of error against run time, and their form in files.

A row is one method with one setting on one scene. `family` groups the rows that are one line in a picture (a method
over its settings). A prediction that a method did not give counts as infinitely wrong in the errors; what is infinite
is null in a file, beside the count in `failed`.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from math import inf, isfinite
from pathlib import Path
from typing import Any, NamedTuple

ACCURACIES = (1e-2, 1e-4, 1e-6, 1e-9)
"""Relative errors that a user may want, for which the report chooses a method."""

ALL_SCENES = "all"
"""Stands in the place of a scene where a choice holds for every computed scene of a question."""

TOUCHDOWN, IMPACT = "touchdown", "impact"
"""The questions: time of the touchdown and twist there; twist and mode after the impact."""


class Scene(NamedTuple):
    """A set of problems that all methods of a question meet.

    `reference` says what is held to be right; `measured` whether that is a measurement, which no choice is made on.
    """

    name: str
    question: str
    title: str
    description: str
    reference: str
    measured: bool = False


class Errors(NamedTuple):
    """Relative errors: the median, that which 90 % stay below, and the largest; inf where there is no answer."""

    median: float
    most: float
    worst: float


class Row(NamedTuple):
    """One method with one setting on one scene.

    `us` microseconds of CPU time per prediction in the median and `us_90` at 90 %; `time_error` of the touchdown's time
    relative to the time until then, `twist_error` of the twist relative to its size (None where it does not apply);
    `wrong_modes` 0..1 or None; `count` predictions, of which `failed` gave no answer.
    """

    question: str
    scene: str
    family: str
    method: str
    setting: str
    us: float
    us_90: float
    time_error: Errors | None
    twist_error: Errors | None
    wrong_modes: float | None
    count: int  # type: ignore[assignment]  # the name in the files, in the place of tuple.count
    failed: int

    @property
    def error(self) -> float:
        """What 90 % of the predictions stay below, of the time and of the twist."""
        return max((errors.most for errors in (self.time_error, self.twist_error) if errors), default=inf)


class Choice(NamedTuple):
    """The cheapest method on a scene of which 90 % of the predictions are within `accuracy`; None where none is."""

    question: str
    scene: str
    accuracy: float
    row: Row | None


class Family(NamedTuple):
    """What the methods of a family do, in a sentence, and what their setting is."""

    name: str
    says: str


class Default(NamedTuple):
    """What the node uses for a question, and why, in a sentence."""

    method: str
    setting: str
    why: str


class Report(NamedTuple):
    """All that the files of the report say.

    `made` is where, when and with what; `node` what the node uses for each question; `notes` tell what was left out.
    """

    made: dict[str, str]
    node: dict[str, Default]
    notes: Sequence[str]
    families: Sequence[Family]
    scenes: Sequence[Scene]
    rows: Sequence[Row]
    choices: Sequence[Choice]


def quantiles(errors: Sequence[float]) -> Errors:
    """Median, 90 % and the largest of errors that are not empty; those of predictions that failed are inf."""
    ordered = sorted(error if error == error else inf for error in errors)
    last = len(ordered) - 1
    return Errors(ordered[last // 2], ordered[-(-9 * last // 10)], ordered[-1])


def to_json(report: Report) -> dict[str, Any]:
    """The report as JSON has it; what is not finite is None."""
    return {
        "made": report.made,
        "node": {question: default._asdict() for question, default in report.node.items()},
        "notes": list(report.notes),
        "families": [family._asdict() for family in report.families],
        "scenes": [scene._asdict() for scene in report.scenes],
        "rows": [fields_of(row) for row in report.rows],
        "choices": [choice_fields_of(choice) for choice in report.choices],
    }


def fields_of(row: Row) -> dict[str, Any]:
    """A row as one object without any inside."""
    fields: dict[str, Any] = {}
    for name, value in row._asdict().items():
        if name in ("time_error", "twist_error"):
            median, most, worst = value or (inf, inf, inf)
            fields |= {name: finite(median), f"{name}_90": finite(most), f"{name}_worst": finite(worst)}
        else:
            fields[name] = finite(value) if isinstance(value, float) else value
    return fields


def choice_fields_of(choice: Choice) -> dict[str, Any]:
    """A choice as one object; family, method, setting, us and error are None where no method was good enough."""
    question, scene, accuracy, row = choice
    return {
        "question": question,
        "scene": scene,
        "accuracy": accuracy,
        "family": row and row.family,
        "method": row and row.method,
        "setting": row and row.setting,
        "us": row and finite(row.us),
        "error": row and finite(row.error),
    }


def finite(number: float) -> float | None:
    return number if isfinite(number) else None


def write_csv(file: Path, rows: Iterable[Row]) -> None:
    """Write the rows, one line each, with a line of names above; None is an empty cell."""
    with file.open("w", newline="") as out:
        table = [fields_of(row) for row in rows]
        writer = csv.DictWriter(out, list(table[0]) if table else list(Row._fields), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
