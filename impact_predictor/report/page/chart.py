"""The picture of error against run time: a line for each family, the front that no method beats, wrong modes below."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import ceil, floor, log10
from typing import Final, NamedTuple

import matplotlib
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .data import ROUNDING, Point, answered, families_of, front_of, seen
from .labels import Array, Line, extent_of, write_names
from .looks import Looks
from .svg import BAND, FONT, FRONT, INK, MUTED, PAPER, STYLE, Mark, svg_of
from .words import power, share, time_words, tooltip

LEAST_ERROR: Final = 1e-17
"""The end of the axis of errors: below rounding, so that what is exact has a place."""

LEAST_WRONG: Final = 0.02
"""The axis of wrong modes reaches at least this rate."""


class Shape(NamedTuple):
    """The size of a picture in pixels, with its margins: left, right, bottom, top."""

    name: str
    width: float
    height: float
    margins: tuple[float, float, float, float] = (46.0, 20.0, 38.0, 26.0)

    def axes_of(self, figure: Figure) -> Axes:
        """Axes between the margins of a figure of this size."""
        left, right, bottom, top = self.margins
        box = (self.width - left - right) / self.width, (self.height - bottom - top) / self.height
        return figure.add_axes((left / self.width, bottom / self.height, *box))

    def picture(self, across: str, upward: str = "") -> tuple[Figure, Axes]:
        """A figure of this size, to be drawn in `STYLE`, and its axes: named below, and above for the upward one."""
        figure = Figure(figsize=(self.width / 72.0, self.height / 72.0))
        FigureCanvasAgg(figure)
        axes = self.axes_of(figure)
        axes.tick_params(length=0)
        axes.set_xlabel(across)
        figure.text(2.0 / self.width, 1.0, upward, va="top", color=INK)
        return figure, axes


WIDE, NARROW, LARGE = Shape("wide", 520.0, 400.0), Shape("narrow", 345.0, 400.0), Shape("wide", 660.0, 480.0)
STRIP, GAP = 40.0, 24.0
"""Height of the wrong modes below the errors, and of the gap between them, in pixels."""
LEAST_TICK: Final = 44.0
"""Width that the name of a time needs on its axis, in pixels."""


class Limits(NamedTuple):
    """Ends of the axes, common to the pictures of a question: microseconds, largest error, rate of wrong modes."""

    least_us: float
    most_us: float
    most_error: float
    most_wrong: float


class Frame(NamedTuple):
    """What the pictures of a question share.

    `looks` of each family; `accuracies` that a user may want, each a line that the page shows when it is wanted;
    `marked` the family whose name is bold.
    """

    limits: Limits
    looks: Mapping[str, Looks]
    accuracies: Sequence[float]
    marked: str


def limits_of(points: Iterable[Point]) -> Limits:
    """Axes that hold all points, from power of ten to power of ten."""
    drawn = answered(points)
    times = [log10(point.us) for point in drawn] or [0.0]
    most = max((seen(point.error) for point in drawn), default=1.0)
    wrong = max((point.row["wrong_modes"] or 0.0 for point in drawn), default=0.0)
    return Limits(
        10.0 ** floor(min(times) - 0.1),
        10.0 ** ceil(max(times) + 0.1),
        10.0 ** max(0.5, log10(most) + 0.5),
        max(wrong, LEAST_WRONG),
    )


def draw_chart(
    points: Sequence[Point],
    frame: Frame,
    shape: Shape,
    name: str,
    label: str,
    worst_scenes: Mapping[tuple[str, str], str] | None = None,
) -> Markup:
    """The picture as SVG.

    Args:
        points: of one scene, or of all together.
        frame: what it shares with the other pictures of its question.
        shape: size and margins.
        name: of the picture, another for each of a page.
        label: what it shows, for those who do not see it.
        worst_scenes: the title of the scene of a point's error, by its key, where the points are of several scenes.
    """
    with matplotlib.rc_context(STYLE):
        modes = any(point.row["wrong_modes"] is not None for point in points)
        figure = Figure(figsize=(shape.width / 72.0, shape.height / 72.0))
        FigureCanvasAgg(figure)
        axes, strip = axes_of(figure, shape, modes)
        set_scales(axes, strip or axes, frame.limits)
        figure.text(2.0 / shape.width, 1.0, "relative error, 90 % below", va="top", color=INK)
        marks = draw_accuracies(axes, frame.accuracies)
        name_box = draw_rounding(axes)
        drawn, told = answered(points), {point.key: mark_of(point, worst_scenes or {}) for point in points}
        front = draw_front(axes, drawn, frame.limits)
        marks |= draw_families(axes, drawn, frame.looks, told)
        lines = [
            Line(family, frame.looks[family].colour, coordinates(mine), family == frame.marked)
            for family, mine in families_of(drawn)
        ]
        write_names(axes, lines, FONT, [name_box], front)
        if strip:
            marks |= draw_wrong_modes(strip, points, frame, told)
        return svg_of(figure, f"{name}-{shape.name}", label, marks, shape.name)


def coordinates(points: Sequence[Point]) -> Array:
    """The places of points in the picture, (points, 2)."""
    return np.array([(point.us, seen(point.error)) for point in points])


def mark_of(point: Point, worst_scenes: Mapping[tuple[str, str], str]) -> Mark:
    """What a point tells."""
    attributes = {"error": f"{point.error:.6g}", "us": f"{point.us:.6g}"} if point.error is not None else {}
    return Mark(tooltip(point, worst_scenes.get(point.key, "")), attributes)


def axes_of(figure: Figure, shape: Shape, modes: bool) -> tuple[Axes, Axes | None]:
    """The axes of the errors, and below them those of the wrong modes where there are any."""
    left, right, bottom, top = shape.margins
    width = shape.width - left - right

    def at(y: float, height: float) -> Axes:
        return figure.add_axes((left / shape.width, y / shape.height, width / shape.width, height / shape.height))

    if not modes:
        return at(bottom, shape.height - bottom - top), None
    above = bottom + STRIP + GAP
    return at(above, shape.height - above - top), at(bottom, STRIP)


def set_scales(axes: Axes, lowest: Axes, limits: Limits) -> None:
    """Set the axes of the errors, and the times below the lowest axes, which may be others."""
    axes.set(xscale="log", yscale="log", ylim=(LEAST_ERROR, limits.most_error))
    axes.yaxis.set_major_locator(FixedLocator([10.0**exponent for exponent in range(-16, 1, 2)]))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: "1" if value == 1.0 else power(round(log10(value)))))
    axes.yaxis.set_minor_locator(NullLocator())
    lowest.set_xscale("log")
    for each in dict.fromkeys((axes, lowest)):
        each.set_xlim(limits.least_us, limits.most_us)
        set_times(each, limits)
        each.grid()
        each.tick_params(length=0)
    axes.tick_params(labelbottom=axes is lowest)
    lowest.set_xlabel("time per prediction")


def set_times(axes: Axes, limits: Limits) -> None:
    """Ticks of the times, at every power of ten, named in units that are read at once."""
    first, last = round(log10(limits.least_us)), round(log10(limits.most_us))
    axes.xaxis.set_major_locator(FixedLocator([10.0**exponent for exponent in range(first, last + 1)]))
    axes.xaxis.set_minor_locator(NullLocator())
    every = ceil(LEAST_TICK * (last - first) / axes.get_window_extent().width)

    def named(value: float, _: int | None) -> str:
        return "" if (round(log10(value)) - first) % every else time_words(value)

    axes.xaxis.set_major_formatter(FuncFormatter(named))


def draw_accuracies(axes: Axes, accuracies: Sequence[float]) -> dict[str, Mark]:
    marks = {}
    for accuracy in accuracies:
        gid = f"accuracy-{accuracy:g}"
        axes.axhline(accuracy, color=INK, linewidth=1.2, linestyle=(0, (4, 3)), gid=gid)
        marks[gid] = Mark("", {"accuracy": f"{accuracy:g}"})
    return marks


def draw_rounding(axes: Axes) -> Array:
    """The band of errors that are rounding, with its name; the box of the name in pixels."""
    axes.axhspan(LEAST_ERROR, 2.0 * ROUNDING, color=BAND, linewidth=0.0)
    words = "rounding of a double"
    width, height = extent_of(axes, words, FONT)
    edge = axes.get_window_extent()
    x, y = edge.x1 - 4.0, edge.y0 + 4.0
    place_x, place_y = axes.transAxes.inverted().transform((x, y))
    axes.text(place_x, place_y, words, transform=axes.transAxes, ha="right", color=MUTED)
    return np.array([x - width, y, x, y + height])


def draw_front(axes: Axes, points: Sequence[Point], limits: Limits) -> list[Array]:
    """The least error that any method reaches within a time, as a broad stair; its corners, if there is one."""
    front = front_of(points)
    if not front:
        return []
    times = [point.us for point in front]
    errors = [limits.most_error, *(seen(point.error) for point in front)]
    corners = np.stack([np.repeat(times, 2), np.repeat(errors, 2)[1:-1]], axis=1)
    corners = np.concatenate([corners, [[limits.most_us, errors[-1]]]])
    axes.plot(*corners.T, color=FRONT, linewidth=5.0, solid_joinstyle="round")
    return [corners]


def draw_families(
    axes: Axes, points: Sequence[Point], looks: Mapping[str, Looks], told: Mapping[tuple[str, str], Mark]
) -> dict[str, Mark]:
    """A line for each family, its points filled where no other point beats them; what each point tells."""
    best = {point.key for point in front_of(points)}
    marks: dict[str, Mark] = {}
    for family, mine in families_of(points):
        x, y = coordinates(mine).T
        axes.plot(x, y, color=looks[family].colour, linewidth=1.3, alpha=0.55, zorder=2)
        for point in mine:
            gid = f"point-{len(marks)}"
            filled = point.key in best
            draw_mark(axes, point.us, seen(point.error), looks[family], filled, 8.0 if filled else 6.5, gid)
            marks[gid] = told[point.key]
    return marks


def draw_wrong_modes(
    strip: Axes, points: Sequence[Point], frame: Frame, told: Mapping[tuple[str, str], Mark]
) -> dict[str, Mark]:
    """How often the mode is wrong, over the same times; filled where it ever is."""
    most = frame.limits.most_wrong
    strip.set_ylim(-0.12 * most, 1.12 * most)
    strip.yaxis.set_major_locator(FixedLocator([0.0, most]))
    strip.yaxis.set_major_formatter(FuncFormatter(lambda value, _: share(value)))
    strip.set_title("wrong modes", fontsize=FONT, loc="left", pad=6.0)
    marks: dict[str, Mark] = {}
    for point in points:
        if (wrong := point.row["wrong_modes"]) is not None:
            gid = f"mode-{len(marks)}"
            draw_mark(strip, point.us, wrong, frame.looks[point.family], wrong > 0.0, 6.5, gid)
            marks[gid] = told[point.key]
    return marks


def draw_mark(axes: Axes, x: float, y: float, looks: Looks, filled: bool, size: float, gid: str) -> None:
    """One marker, filled or hollow."""
    axes.plot(
        x,
        y,
        looks.marker,
        color=looks.colour,
        markerfacecolor=looks.colour if filled else PAPER,
        markeredgewidth=1.3,
        markersize=size,
        zorder=4 if filled else 3,
        clip_on=False,
        gid=gid,
    )
