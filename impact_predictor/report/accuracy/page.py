"""The page of error against run time, made from the report's JSON alone: a table and a picture for each question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import inf
from typing import Any, Final

from ...wording import duration
from ..modes import PALETTE
from ..page import Chart, Headline, PageTable, Section, marks, page, page_table
from ..table import Column
from . import ERRORS, IMPACT, SPATIAL, TOSSES, TOUCHDOWN, error_of, name_of

CLOSES: Final = (
    "When, and with which twist, does the next contact strike? Gap and twist go on at constant twist or constant "
    "acceleration; DOP853 is scipy's integrator of order 8 with an event; next_touchdown, the node's, has closed forms "
    "where the stance sticks, and steps within a tolerance where it slips."
)
GOES_ON: Final = (
    "With which twist, and in which mode, does the body go on? The path law is the impulse path (Routh's hypothesis), "
    "the node's where a touchdown is planar; the total law is the paper's on the impulses of "
    "the whole impact; no slip is Housner's rocking model, in which the old contact leaves and the new one sticks."
)
IN_SPACE: Final = (
    "With which twist does a box go on that strikes with a corner, an edge or a face, beside corners that stand? The "
    "path law in three dimensions is the node's, and its error falls with its steps; the total law is complementarity "
    "of the impulses of the whole impact, with Newton's restitution."
)
MEASURED: Final = (
    "Which assumptions are right? Here the truth is a measurement, and the friction, restitution and shape of the body "
    "are known only roughly: more digits do not make the error smaller."
)
QUESTIONS: Final = {
    TOUCHDOWN: ("The next touchdown", CLOSES),
    IMPACT: ("The impact", GOES_ON),
    SPATIAL: ("The impact in three dimensions", IN_SPACE),
    TOSSES: ("Recorded tosses", MEASURED),
}
"""The questions of the report: a title, and what is asked."""

CHOICE_COLUMNS: Final = (
    Column("nine of ten errors\nare to be below", lambda one: f"{one['accuracy']:g}", left=True),
    Column("cheapest method\non all scenes", lambda one: name_of(one) or "none", left=True),
    Column("run time", lambda one: duration(one["us"] and 1e-6 * one["us"])),
)


def _error(end: str, row: Mapping[str, Any]) -> str:
    error = row[f"{ERRORS[row['question']][-1]}{end}"]
    return "no number" if error is None else f"{error:.2g}"


ERROR_COLUMNS: Final = (
    Column("method", name_of, left=True),
    *[Column(said, partial(_error, end)) for said, end in (("median", ""), ("90 % below", "_90"), ("worst", "_worst"))],
    Column("not answered", lambda row: f"{row['failed']:,} of {row['count']:,}"),
    Column("run time", lambda row: duration(1e-6 * row["us"])),
)

SYMBOLS: Final = ("circle", "square", "diamond", "triangle-up", "cross", "x", "star")
LEAST: Final = 1e-16
"""Smaller errors are drawn as this one: they are below the rounding of a double."""

LEAD: Final = (
    "A body that turns about one contact is about to strike the ground with another. When, and what follows? This page "
    "compares the methods that answer, by their error against a reference and by the time that one prediction takes. A "
    "point is a method on one scene: further left is quicker, further down more accurate."
)
HOW: Final = (
    "Every method meets the same problems of a scene. An error is relative: of the time, to the time until the "
    "touchdown; of the twist, to its size. What a method did not predict counts as infinitely wrong, and a method that "
    "does not answer 90 % of a scene has no point there. Times of another machine differ; their ratios less."
)


def accuracy_page(report: Mapping[str, Any], script: str) -> str:
    """The page of a report as `report.json` has it, as HTML; `script` is that of plotly."""
    titles = {scene["name"]: scene["title"] for scene in report["scenes"]}
    sections = []
    for name, (title, asked) in QUESTIONS.items():
        rows = [row for row in report["rows"] if row["question"] == name]
        choices = [choice for choice in report["choices"] if choice["question"] == name]
        if rows:
            columns = [Column("scene", lambda row: titles[row["scene"]], left=True), *ERROR_COLUMNS]
            table = page_table(CHOICE_COLUMNS, choices) if choices else page_table(columns, rows)
            sections.append(Section(name.replace(" ", "-"), title, [asked], [table, _picture(title, rows, titles)]))
    scenes = [[scene["title"], scene["description"], scene["reference"]] for scene in report["scenes"]]
    made = [
        PageTable(["scene", "problems", "held to be right"], scenes, words=3),
        PageTable(["made with", ""], list(report["made"].items()), words=2),
    ]
    sections.append(Section("made", "How it was measured", [HOW], made))
    headlines = [
        Headline(f"the node's method for the {question}", name_of(used), used["why"])
        for question, used in report["node"].items()
    ]
    return page("How right, how fast", LEAD, headlines, sections, script)


def _picture(title: str, rows: Sequence[Mapping[str, Any]], titles: Mapping[str, str]) -> Chart:
    """Error over run time: a mark for each method on each scene."""
    traces = []
    for number, name in enumerate(dict.fromkeys(row["method"] for row in rows)):
        points = []
        for row in rows:
            if row["method"] == name and (error := error_of(row)) < inf:
                said = f"{name_of(row)}\n{titles[row['scene']]}\n{duration(1e-6 * row['us'])}, error {error:.2g}"
                points.append((row["us"], max(error, LEAST), said))
        look = {"size": 10, "color": PALETTE[number % len(PALETTE)], "symbol": SYMBOLS[number]}
        traces += [marks(name, points, marker=look)] if points else []
    log = {"type": "log", "exponentformat": "power"}
    layout = {"height": 480, "showlegend": True, "xaxis": {"title": "time of one prediction, us", **log}}
    layout["yaxis"] = {"title": "relative error, 90 % are below", **log}
    caption = f"Errors below {LEAST:g} stand there. Click a name to hide its method, point at a mark for more."
    return Chart(f"Error against run time: {title.lower()}", traces, layout, caption)
