"""The questions that the page answers, each with what its pictures and tables share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

from .chart import Frame, limits_of
from .data import Entry, computed_scenes, points_of, used_by_node
from .looks import looks_of

QUESTIONS: Final = {
    "touchdown": ("the next touchdown", "when, and with which twist, the next contact strikes"),
    "impact": ("the impact", "with which twist, and in which mode, the body goes on"),
}
"""The questions of the report: a name, and what is asked."""


class Study(NamedTuple):
    """A question: its name and what is asked, the computed scenes and their titles, what all its pictures share.

    `accuracies` are those that choices are made for, the coarsest first; `used` is the method that the node uses.
    """

    question: str
    name: str
    asked: str
    scenes: Sequence[Entry]
    titles: Mapping[str, str]
    frame: Frame
    accuracies: Sequence[float]
    used: Entry | None


def studies_of(report: Entry) -> list[Study]:
    """The questions that the report has rows of."""
    found = []
    for question, (name, asked) in QUESTIONS.items():
        scenes = computed_scenes(report, question)
        points = [point for scene in scenes for point in points_of(report, question, scene["name"])]
        if points:
            used, accuracies = used_by_node(report, question), accuracies_of(report)
            marked = next((point.family for point in points if used and point.method == used["method"]), "")
            frame = Frame(limits_of(points), looks_of(point.family for point in points), accuracies, marked)
            titles = {scene["name"]: scene["title"] for scene in scenes}
            found.append(Study(question, name, asked, scenes, titles, frame, accuracies, used))
    return found


def accuracies_of(report: Entry) -> list[float]:
    """The accuracies that choices are made for, the coarsest first."""
    return sorted({choice["accuracy"] for choice in report["choices"]}, reverse=True)
