"""The section on recorded tosses, where the error is against measurement."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import matplotlib
from markupsafe import Markup
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .chart import NARROW, WIDE, Shape
from .data import Entry, Point, measured_scenes, points_of
from .oldsections import Cell, Figure, Section, Table
from .study import Study
from .svg import INK, PAPER, STYLE, Mark, family_colour, svg_of
from .words import name_of, neat, percent, share, time_words, tooltip, unanswered

ROW: Final = 44.0
"""Height of a method in pixels: its name above its errors."""
TICKS: Final = tuple(factor * 10.0**exponent for exponent in range(-4, 3) for factor in (1.0, 3.0))
QUANTITIES: Final = {"touchdown": ("time_error", "time of the touchdown"), "impact": ("twist_error", "twist after it")}
"""What is measured for each question."""


def measured(report: Entry, studies: Sequence[Study]) -> Section | None:
    """The recorded scenes; None where the report has none."""
    figures = []
    for study in studies:
        key, quantity = QUANTITIES[study.question]
        for scene in measured_scenes(report, study.question):
            points = [point for point in points_of(report, study.question, scene["name"]) if point.row[key] is not None]
            if points:
                figures.append(measured_figure(study, scene, sorted(points, key=lambda p: float(p.row[key])), quantity))
    if not figures:
        return None
    words = (
        "Here the truth is a measurement, and the friction, restitution and shape of the body are known only roughly. "
        "The error is that of the whole prediction, and more digits do not make it smaller: what counts is which "
        "assumptions are right."
    )
    return Section("measured", "Against measurement", [words], figures=figures)


def measured_figure(study: Study, scene: Entry, points: Sequence[Point], quantity: str) -> Figure:
    key, _ = QUANTITIES[study.question]
    name = f"{study.question}-{scene['name']}".replace(" ", "-")
    label = "; ".join(f"{name_of(p.method, p.setting)}: median error {percent(p.row[key])}" for p in points)
    drawings = [
        draw_errors(points, key, shape, name, f"Errors of the {quantity}. {label}.") for shape in (WIDE, NARROW)
    ]
    notes = [
        "The dot is the median, the end of the line what 90 % of the predictions stay below.",
        unanswered(point.row for point in points),
    ]
    return Figure(
        f"{scene['title']}: {quantity}",
        f"{scene['description']} Reference: {scene['reference']}.",
        drawings,
        [note for note in notes if note],
        numbers_of(points, key),
    )


def draw_errors(points: Sequence[Point], key: str, shape: Shape, name: str, label: str) -> Markup:
    """A line for each method, from the median of its errors to 90 %."""
    rows = alike(points, key)
    height = ROW * len(rows) + 50.0
    with matplotlib.rc_context(STYLE):
        figure = Drawing(figsize=(shape.width / 72.0, height / 72.0))
        FigureCanvasAgg(figure)
        side, bottom = 10.0 / shape.width, 46.0 / height
        axes = figure.add_axes((side, bottom, 1.0 - 2.8 * side, 1.0 - bottom))
        axes.spines["left"].set_visible(False)
        axes.grid(axis="x")
        axes.tick_params(length=0)
        axes.set_yticks([])
        axes.set_xlabel("relative error")
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100.0 * value:g} %"))
        axes.xaxis.set_major_locator(FixedLocator(TICKS))
        axes.xaxis.set_minor_locator(NullLocator())
        ends = [float(point.row[name]) for point, _ in rows for name in (key, f"{key}_90") if point.row[name]]
        axes.set(xlim=(0.8 * min(ends), 1.2 * max(ends)), ylim=(len(rows) - 0.4, -0.75))
        marks = {}
        for row, (point, count) in enumerate(rows):
            median, end = point.row[key], point.row[f"{key}_90"]
            gid, colour = f"{name}-{row}", family_colour(0)
            axes.plot(
                [median, end or axes.get_xlim()[1]],
                [row, row],
                color=colour,
                linewidth=3.0,
                solid_capstyle="butt",
                alpha=0.6,
            )
            axes.plot(median, row, "o", color=colour, markeredgecolor=PAPER, markersize=10.0, gid=gid, clip_on=False)
            marks[gid] = Mark(tooltip(point), {})
            words = f"{point.method}, {count} settings" if count > 1 else name_of(point.method, point.setting)
            axes.text(
                0.0,
                row - 0.36,
                f"{words}: {percent(median)}",
                transform=axes.get_yaxis_transform(),
                color=INK,
                va="center",
            )
        return svg_of(figure, f"{name}-{shape.name}", label, marks, shape.name)


def alike(points: Sequence[Point], key: str) -> list[tuple[Point, int]]:
    """The points; of settings of a method whose median reads the same, the quickest, and how many they are."""
    rows: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        rows.setdefault((point.method, percent(point.row[key])), []).append(point)
    return [(min(same, key=lambda point: point.us), len(same)) for same in rows.values()]


def numbers_of(points: Sequence[Point], key: str) -> Table:
    modes = any(point.row["wrong_modes"] is not None for point in points)
    rows = []
    for point in points:
        row = point.row
        cells = [Cell(point.method, neat(point.setting)), Cell(percent(row[key])), Cell(percent(row[f"{key}_90"]))]
        cells += [Cell(share(row["wrong_modes"]))] if modes else []
        rows.append([*cells, Cell(time_words(point.us))])
    return Table("", ["method", "median", "90 % below", *(["wrong mode"] if modes else []), "run time"], rows)
