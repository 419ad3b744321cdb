"""What the page takes from a report of error against run time: its rows as points, and the best of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from statistics import median
from typing import Any, Final, NamedTuple

ROUNDING: Final = 2.0**-53
"""The rounding of a double: no relative error is told from it."""

Entry = Mapping[str, Any]
"""One object of the report's JSON."""


class Point(NamedTuple):
    """A method with a setting in a picture: `us` microseconds per prediction, `error` relative, None without an answer.

    `row` is the report's row of it; where the point stands for several scenes, that of the largest error.
    """

    family: str
    method: str
    setting: str
    us: float
    error: float | None
    row: Entry

    @property
    def key(self) -> tuple[str, str]:
        return self.method, self.setting


def error_of(row: Entry) -> float | None:
    """What 90 % of a row's errors stay below, the larger of the time's and the twist's; None if it is not finite."""
    known = [name for name in ("time_error", "twist_error") if row[name] is not None]
    most = [row[f"{name}_90"] for name in known]
    return None if not most or None in most else max(most)


def points_of(report: Entry, question: str, scene: str) -> list[Point]:
    """The rows of a scene as points, in the report's order."""
    return [point_of(row) for row in report["rows"] if (row["question"], row["scene"]) == (question, scene)]


def point_of(row: Entry) -> Point:
    return Point(row["family"], row["method"], row["setting"], row["us"], error_of(row), row)


def points_by_method(report: Entry, question: str) -> list[list[Point]]:
    """The points of each method with a setting over the computed scenes that it applies to."""
    together: dict[tuple[str, str], list[Point]] = {}
    for scene in computed_scenes(report, question):
        for point in points_of(report, question, scene["name"]):
            together.setdefault(point.key, []).append(point)
    return list(together.values())


def points_of_all(report: Entry, question: str) -> list[Point]:
    """The methods that answer in every computed scene: the time of the median scene, the error of the worst."""
    count = len(computed_scenes(report, question))
    return [
        over_scenes(points)
        for points in points_by_method(report, question)
        if len(points) == count and all(point.error is not None for point in points)
    ]


def over_scenes(points: Sequence[Point]) -> Point:
    """The point of the largest error, with the median time, the largest rate of wrong modes, and all without answer."""
    worst = max(points, key=lambda point: point.error or 0.0)
    rates = [point.row["wrong_modes"] for point in points if point.row["wrong_modes"] is not None]
    sums = {key: sum(point.row[key] for point in points) for key in ("count", "failed")}
    row = {**worst.row, **sums, "wrong_modes": max(rates, default=None)}
    return worst._replace(us=median(point.us for point in points), row=row)


def computed_scenes(report: Entry, question: str) -> list[Entry]:
    """The scenes of a question whose truth is computed."""
    return [scene for scene in report["scenes"] if scene["question"] == question and not scene.get("measured")]


def measured_scenes(report: Entry, question: str) -> list[Entry]:
    """The scenes of a question whose truth is measured."""
    return [scene for scene in report["scenes"] if scene["question"] == question and scene.get("measured")]


def answered(points: Iterable[Point]) -> list[Point]:
    """The points that have an error, which can be drawn."""
    return [point for point in points if point.error is not None]


def seen(error: float | None) -> float:
    """An error as it is drawn and compared: nothing is below rounding."""
    return max(error or 0.0, ROUNDING)


def front_of(points: Iterable[Point]) -> list[Point]:
    """The points that no other beats in both time and error, from the quickest to the most accurate."""
    front: list[Point] = []
    for point in sorted(answered(points), key=lambda point: (point.us, seen(point.error))):
        if not front or seen(point.error) < seen(front[-1].error):
            front.append(point)
    return front


def families_of(points: Iterable[Point]) -> list[tuple[str, list[Point]]]:
    """The points of each family: the families in the order of the points, their points by the number of the setting."""
    order: dict[str, list[Point]] = {}
    for point in points:
        order.setdefault(point.family, []).append(point)
    return [(family, sorted(mine, key=lambda point: number_of(point.setting))) for family, mine in order.items()]


def number_of(setting: str) -> float:
    """The number in a setting such as `n = 16`; 0 where it has none."""
    found = re.search(r"\d[\d.]*(e[+-]?\d+)?", setting)
    return float(found[0]) if found else 0.0


def used_by_node(report: Entry, question: str) -> Entry | None:
    """The method that the node uses for a question, with the reason, where the report says so."""
    used: Entry | None = report.get("node", {}).get(question)
    return used


def choices_of(report: Entry, question: str) -> list[tuple[str, list[Entry]]]:
    """The choices of a question for each scene in the report's order, by falling accuracy."""
    mine = [choice for choice in report["choices"] if choice["question"] == question]
    return [(scene, list(same)) for scene, same in groupby(mine, key=lambda choice: str(choice["scene"]))]
