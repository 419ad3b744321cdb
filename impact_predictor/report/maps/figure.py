"""The picture of a map of modes."""

from __future__ import annotations

from math import atan2, cos, degrees, pi, sin
from pathlib import Path as FilePath
from textwrap import wrap
from typing import Any, Final

import contourpy
import matplotlib
import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ...mechanics.types import Mode
from ..figure import save_figure
from .borders import Border, borders_of
from .modes import ModeMap, middles, shares
from .sketch import draw_sketch
from .words import MEANINGS, PAPER_NUMBERS, TITLES, axis_label, conditions, formula_note, hatched

COLOURS: Final = {
    Mode.NO_IMPACT: "#ffffff",
    Mode.STOP: "#0b3c6f",
    Mode.BACK_PIVOT: "#7f4a8c",
    Mode.PIVOT: "#d55e00",
    Mode.SLIDE: "#56b4e9",
    Mode.FLIGHT: "#e3b5c9",
    Mode.PIVOT_SLIDE: "#f7e57a",
}
"""From dark to light in even steps, so that they differ for every colour vision and in grey."""

DARK: Final = {Mode.STOP, Mode.BACK_PIVOT, Mode.PIVOT}
"""Modes whose colours want white letters."""

HATCHES: Final = ("xx", "||", "///")

STYLE: Final[dict[Any, Any]] = {
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "hatch.linewidth": 0.8,
    "legend.frameon": False,
    "legend.fontsize": 9,
    # So that the same map makes the same bytes.
    "svg.hashsalt": "impact_predictor",
}
LEAST_ROOM: Final = 0.04
"""A region is named inside if this part of the map's height is free above and below the name."""
WIDTH_OF_A_LETTER: Final = 8.0
"""Pixels that a letter of a formula takes, about."""
LETTERS_OF_A_LINE: Final = 33
"""What a line of the legend has room for."""


def write_figure(path: FilePath, modes: ModeMap) -> None:
    """Draw a map into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written.
    """
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10.0, 6.0), layout="constrained")
        FigureCanvasAgg(figure)
        figure.suptitle(TITLES[modes.subject], x=0.01, ha="left", fontweight="bold", fontsize=12)
        grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 0.4), height_ratios=(0.36, 1.0))
        axes, sketch, side = (figure.add_subplot(place) for place in (grid[:, 0], grid[0, 1], grid[1, 1]))
        draw_sketch(sketch, modes.subject)
        draw_regions(axes, modes)
        hatches = draw_hatches(axes, modes)
        borders = borders_of(modes)
        side.set_axis_off()
        side.legend(handles=legend_of(modes, borders, hatches), loc="upper left", borderaxespad=0.0, labelspacing=0.8)
        figure.draw_without_rendering()  # a text along a curve needs the final shape of the axes
        for border in borders:
            draw_border(axes, border)
        save_figure(figure, path)


def draw_regions(axes: Axes, modes: ModeMap) -> None:
    """The regions, each with its name inside where there is room."""
    axes.imshow(
        modes.mode,
        cmap=ListedColormap([COLOURS[mode] for mode in Mode]),
        vmin=-0.5,
        vmax=len(Mode) - 0.5,
        extent=(modes.x.low, modes.x.high, modes.y.low, modes.y.high),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
    )
    axes.set_xlabel(axis_label(modes.x, modes), fontsize=12)
    axes.set_ylabel(axis_label(modes.y, modes), fontsize=12)
    axes.set_title(conditions(modes))
    for mode in shares(modes):
        place = roomiest(modes.mode == mode)
        if place is not None:
            axes.text(
                *place,
                mode.name,
                transform=axes.transAxes,
                ha="center",
                va="center",
                color="white" if mode in DARK else "black",
                fontweight="bold",
                fontsize=11,
                path_effects=[patheffects.withStroke(linewidth=4, foreground=COLOURS[mode])],
                zorder=4,
            )


def roomiest(region: NDArray[np.bool_]) -> tuple[float, float] | None:
    """Where a word fits best into a region, as parts of the width and height of the map; None if it fits nowhere."""
    rows, columns = region.shape
    step = max(1, rows // 200)
    coarse = np.pad(region[::step, ::step], 1)  # the edge of the map is an edge of the region too
    # A word is three times as wide as high.
    room = distance_transform_edt(coarse, sampling=(step / rows, 0.3 * step / columns))
    row, column = np.unravel_index(int(np.argmax(room)), room.shape)
    if room[row, column] < LEAST_ROOM:
        return None
    return float((column - 0.5) * step / columns), float((row - 0.5) * step / rows)


def draw_hatches(axes: Axes, modes: ModeMap) -> list[Patch]:
    """Hatch where the laws have no single answer; the entries of the legend for it."""
    dark = np.isin(modes.mode, list(DARK))
    handles = []
    for (region, meaning), hatch in zip(hatched(modes), HATCHES, strict=True):
        if not region.any():
            continue
        for part, colour in ((region & dark, "white"), (region & ~dark, "black")):
            for outline in outlines(part, modes):
                axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=colour, linewidth=0.0, hatch=hatch))
        label = "\n".join(wrap(meaning, LETTERS_OF_A_LINE))
        handles.append(Patch(facecolor="white", edgecolor="black", hatch=hatch, label=label))
    return handles


def outlines(region: NDArray[np.bool_], modes: ModeMap) -> list[Path]:
    """The outlines of the pieces of a region of the map."""
    # The cells at the edges of the map reach up to them.
    x, y = (
        np.concatenate([[axis.low], middles(axis, count), [axis.high]])
        for axis, count in zip((modes.x, modes.y), region.shape[::-1], strict=True)
    )
    inside = np.pad(region.astype(float), 1, mode="edge")
    pieces: Any = contourpy.contour_generator(x, y, inside, fill_type=contourpy.FillType.OuterCode).filled(0.5, 2.0)
    return [Path(points, codes) for points, codes in zip(*pieces, strict=True)]


def draw_border(axes: Axes, border: Border) -> None:
    """The curves of a border, with its formula beside the longest."""
    for curve in border.curves:
        axes.plot(*curve.T, color="white", linewidth=3.0, solid_capstyle="round")
        axes.plot(*curve.T, color="black", linewidth=1.4, solid_capstyle="round")
    pixels = axes.transData.transform(max(border.curves, key=len))
    place, angle = straightest(pixels, WIDTH_OF_A_LETTER * len(border.formula))
    axes.annotate(
        border.formula,
        tuple(axes.transAxes.inverted().transform(place)),
        (-5.0 * sin(angle), 5.0 * cos(angle)),
        xycoords="axes fraction",
        textcoords="offset points",
        rotation=degrees(angle),
        rotation_mode="anchor",
        ha="center",
        va="bottom",
        path_effects=[patheffects.withStroke(linewidth=3, foreground="white")],
    )


def straightest(points: NDArray[np.float64], width: float) -> tuple[tuple[float, float], float]:
    """Where a text of this width follows a curve best, and its angle there in rad; all in pixels."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])

    def at(place: float) -> NDArray[np.float64]:
        return np.array([np.interp(place, length, points[:, 0]), np.interp(place, length, points[:, 1])])

    half, end = 0.5 * min(width, length[-1]), length[-1]
    best, least = 0.5 * end, np.inf
    for place in np.linspace(half, end - half, 41):
        bend = float(np.hypot(*(at(place) - 0.5 * (at(place - half) + at(place + half)))))
        bend += 0.05 * abs(place - 0.5 * end)  # as near to the middle as may be
        if bend < least:
            best, least = float(place), bend
    dx, dy = at(best + half) - at(best - half)
    x, y = at(best)
    return (float(x), float(y)), 0.5 * pi - (0.5 * pi - atan2(dy, dx)) % pi


def legend_of(modes: ModeMap, borders: list[Border], hatches: list[Patch]) -> list[Any]:
    """The modes that occur in the order of their numbers, the hatches and the borders."""
    handles: list[Any] = []
    for mode, share in shares(modes).items():
        number = f", {PAPER_NUMBERS[mode]} in the paper" if mode in PAPER_NUMBERS else ""
        label = f"{mode.name} ({100.0 * share:.0f} %{number}):\n{MEANINGS[mode]}"
        handles.append(Patch(facecolor=COLOURS[mode], edgecolor="black", linewidth=0.5, label=label))
    handles += hatches
    if borders:
        handles.append(Line2D([], [], color="black", linewidth=1.4, label=formula_note(modes)))
    return handles
