"""The page of error against run time, made from the report's JSON alone: a table and a picture for each question."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from itertools import groupby
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ...wording import duration
from ..modes import PALETTE
from ..page.document import (
    Cell,
    Chart,
    Headline,
    PageTable,
    Section,
    marks,
    page,
    part_words,
    plot,
    script_inside,
    titled,
    write_html,
)
from .measure import ALL_SCENES, IMPACT, STABILITY, TOUCHDOWN, error_of

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as PlotlyFigure

QUESTIONS: Final = {
    TOUCHDOWN: ("The next touchdown", "when, and with which twist, the next contact strikes"),
    IMPACT: ("The impact", "with which twist, and in which mode, the body goes on"),
    STABILITY: ("Stiff and extreme impacts", "whether an answer keeps to mechanics where a rounding decides much"),
}
"""The questions of the report: a name, and what is asked."""

SYMBOLS: Final = ("circle", "square", "diamond", "triangle-up", "cross", "x", "star")
LEAST: Final = 1e-16
"""Smaller errors are drawn as this one: they are below the rounding of a double."""

LEAD: Final = (
    "A body that turns about one contact is about to strike the ground with another. When, and what follows? This page "
    "compares the methods that answer, by their error against a reference and by the time that one prediction takes, "
    "so that you can choose the cheapest that is accurate enough."
)
MEASURED: Final = (
    "Here the truth is a measurement, and the friction, restitution and shape of the body are known only roughly. The "
    "error is that of the whole prediction, and more digits do not make it smaller: what counts is which assumptions "
    "are right."
)
CHOSEN: Final = (
    "The table has the cheapest method of which 90 % of the predictions are within an error, on each scene and on all "
    "of them. In the picture each point is a method on one scene: further left is quicker, further down more accurate. "
    "What does not answer 90 % of the problems of a scene has no point there."
)
VIOLATED: Final = (
    "No solution is known to so many digits, so that nothing here is held against another one: a violation is by how "
    "much an outcome leaves its friction cones, balances momentum and energy, gains work, or still approaches a "
    "contact, as a part of the terms of that balance. A stiff problem multiplies rounding by its condition number. How "
    "far answers are from the exact ones is measured on the stiff bodies above, which have closed forms."
)
HOW: Final = (
    "Every method meets the same problems of a scene. An error is relative: of the time, to the time until the "
    "touchdown; of the twist, to its size. Half of the errors are below the median, 90 % below the number that the "
    "choices are made by. A prediction that a method did not give counts as infinitely wrong."
)


def write_accuracy_page(file: str | os.PathLike[str], report: Mapping[str, Any]) -> None:
    """Write one page that needs nothing else: no network, no other file.

    Args:
        file: to write, HTML.
        report: as `report.json` has it.

    Raises:
        InputError: the file cannot be written.
    """
    write_html(Path(file), accuracy_page(report, script_inside()))


def accuracy_page(report: Mapping[str, Any], script: str) -> str:
    """The page as HTML; `script` is that of plotly."""
    headlines = [
        Headline(f"The node uses, for {QUESTIONS[question][0].lower()}", _name(used), used["why"])
        for question, used in report["node"].items()
    ]
    sections = [question(report, name) for name in QUESTIONS]
    sections += [measured(report), made(report)]
    return page("How right, how fast", [LEAD], headlines, [one for one in sections if one is not None], script)


def question(report: Mapping[str, Any], name: str) -> Section | None:
    """Which method for a wanted accuracy, and a picture of all methods; None where nothing was measured."""
    title, asked = QUESTIONS[name]
    scenes = {one["name"]: one["title"] for one in report["scenes"] if one["question"] == name and not one["measured"]}
    rows = [row for row in report["rows"] if row["question"] == name and row["scene"] in scenes]
    if not rows:
        return None
    said, table, axis = CHOSEN, _choices, "relative error, 90 % are below"
    if name == STABILITY:
        said, table, axis = VIOLATED, _violations, "worst violation"
    caption = f"Errors below {LEAST:g} stand there. Click a name to hide its method, point at a mark for more."
    chart = Chart(f"Error against run time: {title.lower()}", _picture(rows, scenes, axis), caption)
    return Section(name, title, [f"The question is {asked}.", said], [table(report, name, scenes), chart])


def _choices(report: Mapping[str, Any], name: str, scenes: Mapping[str, str]) -> PageTable:
    mine = [one for one in report["choices"] if one["question"] == name]
    accuracies = sorted({one["accuracy"] for one in mine}, reverse=True)
    rows: list[list[Cell | str]] = []
    for scene, group in groupby(mine, key=lambda one: str(one["scene"])):
        best = {one["accuracy"]: one for one in group}
        title = "on all scenes" if scene == ALL_SCENES else scenes[scene]
        rows.append([title, *(_choice(best[accuracy]) for accuracy in accuracies)])
    head = ["scene", *(f"error below {accuracy:g}" for accuracy in accuracies)]
    return PageTable(head, rows, words=len(head))


def _violations(report: Mapping[str, Any], name: str, scenes: Mapping[str, str]) -> PageTable:
    rows = [
        [
            scenes[row["scene"]],
            row["method"],
            f"{row['violation_90']:.1e}",
            f"{row['violation_worst']:.1e}" if row["violation_worst"] is not None else "no number",
            f"{row['failed']:,} of {row['count']:,}",
            _us(row["us"]),
        ]
        for row in report["rows"]
        if row["question"] == name
    ]
    return PageTable(["scene", "method", "90 % below", "worst", "not answered", "run time"], rows, words=2)


def _choice(one: Mapping[str, Any]) -> Cell:
    if one["method"] is None:
        return Cell("none", css="none")
    return Cell(one["method"], ", ".join(filter(None, (one["setting"], _us(one["us"])))))


def _picture(rows: Sequence[Mapping[str, Any]], scenes: Mapping[str, str], axis: str) -> PlotlyFigure:
    traces = []
    for number, family in enumerate(dict.fromkeys(row["family"] for row in rows)):
        points = [
            (row["us"], max(error, LEAST), f"{_name(row)}\n{scenes[row['scene']]}\n{_us(row['us'])}, error {error:.2g}")
            for row in rows
            if row["family"] == family and (error := error_of(row)) < inf
        ]
        look = {"size": 10, "color": PALETTE[number % len(PALETTE)], "symbol": SYMBOLS[number]}
        traces += [marks(family, points, marker=look)] if points else []
    log = {"type": "log", "exponentformat": "power"}
    across = titled("time of one prediction, us", **log)
    return plot(traces, 480, xaxis=across, yaxis=titled(axis, dtick=2, **log))


def measured(report: Mapping[str, Any]) -> Section | None:
    """The recorded scenes; None where the report has none."""
    parts = []
    for scene in (one for one in report["scenes"] if one["measured"]):
        mine = [row for row in report["rows"] if (row["question"], row["scene"]) == (scene["question"], scene["name"])]
        mine.sort(key=lambda row: row["twist_error"] or inf)
        rows = [
            [_name(row), part_words(row["twist_error"]), part_words(row["twist_error_90"]), _us(row["us"])]
            for row in mine
        ]
        caption = f"{scene['description']} Reference: {scene['reference']}."
        parts += [PageTable(["method", "median error", "90 % below", "run time"], rows, caption)] if rows else []
    return Section("measured", "Recorded tosses, against measurement", [MEASURED], parts) if parts else None


def made(report: Mapping[str, Any]) -> Section:
    """What was measured, how, and on which machine."""
    scenes = [[one["title"], one["description"], one["reference"]] for one in report["scenes"]]
    facts = [[name, value] for name, value in report["made"].items() if name != "timing"]
    return Section(
        "made",
        "How it was measured",
        [HOW, report["made"]["timing"], "Times of another machine differ; their ratios less.", *report["notes"]],
        [
            PageTable(["method", "what it does"], [[one["name"], one["says"]] for one in report["families"]], words=2),
            PageTable(["scene", "problems", "held to be right"], scenes, words=3),
            PageTable(["made with", ""], facts, words=2),
        ],
    )


def _name(row: Mapping[str, Any]) -> str:
    return ", ".join(filter(None, (row["method"], row["setting"])))


def _us(us: float) -> str:
    return duration(1e-6 * us)
