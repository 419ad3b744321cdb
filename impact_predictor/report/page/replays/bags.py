"""A row for each of several bags, and how their errors are spread."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from statistics import median
from typing import Final

import matplotlib
import numpy as np
from markupsafe import Markup
from matplotlib.ticker import FuncFormatter, MaxNLocator

from ....wording import counted
from ..chart import Shape
from ..sections import Cell, Figure, Section, Table
from ..svg import STYLE, Mark, family_colour, svg_of
from ..words import time_words
from .answers import (
    Answer,
    announced,
    arrived,
    badness,
    costs,
    names_of,
    time_error,
    touchdowns_of,
    used,
    velocity_errors,
)
from .words import percent, seconds_words

LISTED: Final = 30
"""Bags that are listed; of more the worst."""
SHAPES: Final = (
    Shape("wide", 680.0, 260.0, (58.0, 70.0, 48.0, 30.0)),
    Shape("narrow", 345.0, 260.0, (54.0, 14.0, 46.0, 30.0)),
)


def bags(answers: Sequence[Answer], anchors: Mapping[int, str]) -> Section | None:
    """The section of the bags; None where there is only one. `anchors` lead to timelines, by the places of the bags."""
    if len(answers) < 2:
        return None
    places, words = listed(answers), []
    if len(answers) > LISTED:
        worst = "first those that could not be used, then by what was missed or announced in vain, then by the error"
        words = [f"The worst {LISTED} of {len(answers):,} bags: {worst}."]
    names = names_of(answers)
    columns = columns_of(answers)
    rows = [
        [head_of(answers[k], names[k], anchors.get(k, "")), *(cell(answers[k]) for cell in columns.values())]
        for k in places
    ]
    table = Table("", ["bag", *columns], rows, cards=True)
    figures = [] if (figure := spread_figure(answers)) is None else [figure]
    return Section("bags", "The bags", words, tables=[table], figures=figures)


def listed(answers: Sequence[Answer]) -> Iterable[int]:
    """The places of the bags that are listed: all in their order, or of many the worst."""
    places = range(len(answers))
    if len(answers) <= LISTED:
        return places
    return sorted(places, key=lambda place: badness(answers[place]), reverse=True)[:LISTED]


def head_of(answer: Answer, name: str, anchor: str) -> Cell:
    """The name of a bag, and what is the matter with it."""
    remark = "could not be read" if "error" in answer else "nothing predicted" if answer.get("unpredictable") else ""
    return Cell(name, remark or ("damaged" if "damaged" in answer else ""), to=anchor)


def columns_of(answers: Sequence[Answer]) -> dict[str, Callable[[Answer], Cell]]:
    """The columns that say something of any of the bags."""
    columns: dict[str, Callable[[Answer], Cell]] = {
        "touchdowns": lambda answer: Cell(f"{len(touchdowns_of([answer])):,}"),
    }
    known = used(answers)
    if any("truth" in answer for answer in known):
        columns["found"] = found_cell
    if velocity_errors(known).number:
        columns["error"] = error_cell
    if any(time_error(answer) is not None for answer in known):
        columns["time error"] = lambda answer: Cell(seconds_words(time_error(answer)))
    columns["ahead"] = lambda answer: Cell(seconds_words(median(times) if (times := announced([answer])) else None))
    columns["a sample"] = lambda answer: Cell(time_words(costs([answer]).p50))
    return {name: usable(cell) for name, cell in columns.items()}


def usable(cell: Callable[[Answer], Cell]) -> Callable[[Answer], Cell]:
    """The cell of a column, empty for a bag that could not be read."""
    return lambda answer: Cell("", "", "empty") if "error" in answer else cell(answer)


def found_cell(answer: Answer) -> Cell:
    """How many true touchdowns were found, and false alarms."""
    there = arrived([answer])
    if there is None:
        return Cell("–")
    return Cell(f"{there.found:,} of {there.there:,}", counted(there.false, "false alarm") if there.false else "")


def error_cell(answer: Answer) -> Cell:
    """Median and 90 % of the relative errors."""
    errors = velocity_errors([answer])
    below = f"90 % below {percent(errors.p90)}, {errors.number:,} compared" if errors.number else ""
    return Cell(percent(errors.median), below)


def spread_figure(answers: Sequence[Answer]) -> Figure | None:
    """The median errors of many bags, from the best to the worst; None where they are few."""
    known = used(answers)
    errors = sorted(errors.median for answer in known if (errors := velocity_errors([answer])).median is not None)
    times = sorted(error for answer in known if (error := time_error(answer)) is not None)
    values, title, axis, factor = errors, "Median error of each bag", "relative error, %", 100.0
    if not errors:
        values, title, axis, factor = times, "Time error of each bag", "error of the time, ms", 1e3
    if len(values) <= LISTED:
        return None
    caption = f"The {len(values):,} bags from the best to the worst."
    label = f"{title}, sorted: half of the bags are below {factor * values[len(values) // 2]:.3g} ({axis})."
    return Figure(title, caption, [draw(values, axis, factor, shape, label) for shape in SHAPES])


def draw(values: Sequence[float], axis: str, factor: float, shape: Shape, label: str) -> Markup:
    """Sorted values over their share of the bags, as SVG; marks at each tenth."""
    with matplotlib.rc_context(STYLE):
        figure, axes = shape.picture("of the bags have a smaller error", axis)
        shares = np.linspace(0.0, 100.0, 201)
        places = np.quantile(np.array(values) * factor, shares / 100.0)
        axes.set(xlim=(0.0, 100.0), ylim=(0.0, 1.1 * min(places[-1], 3.0 * places[190]) or 1.0))
        axes.plot(shares, places, color=family_colour(0), linewidth=1.8, zorder=3)
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0f} %"))
        axes.grid(axis="y")
        marks = {}
        for share, place in zip(shares[20:200:20], places[20:200:20], strict=True):
            gid = f"share-{share:.0f}"
            axes.plot(share, place, "o", color=family_colour(0), markersize=8.0, gid=gid, zorder=4)
            marks[gid] = Mark(f"{share:.0f} % of the bags are below {place:.3g} ({axis})", {})
        return svg_of(figure, f"bags-{shape.name}", label, marks, shape.name)
