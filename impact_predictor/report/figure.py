"""One picture of a replay: predicted against measured velocities, the errors, and the errors against lead time."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..mechanics.types import Mode, Twist
from ..wording import words
from .files import named, whole
from .summary import LeadTimeErrors, TouchdownRow, errors_of

SUFFIXES: Final = (".png", ".svg")

# The colours of Okabe and Ito, which people of any colour vision tell apart.
_BLUE, _VERMILION, _GREY = "#0072B2", "#D55E00", "#666666"
MODE_MARKERS: Final = {
    Mode.STOP: "s",
    Mode.SLIDE: ">",
    Mode.PIVOT_SLIDE: "P",
    Mode.PIVOT: "o",
    Mode.BACK_PIVOT: "<",
    Mode.FLIGHT: "^",
}
_VELOCITIES: Final[tuple[tuple[str, str, Callable[[Twist, float], float]], ...]] = (
    ("vx, along the support", _BLUE, lambda twist, arm: twist.vx),
    ("ω s, from turning\n(s: half the contacts' distance)", _VERMILION, lambda twist, arm: twist.omega * arm),
)
STYLE: Final[dict[Any, Any]] = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "legend.frameon": False,
    "legend.fontsize": 9,
    # So that the same results make the same bytes.
    "svg.hashsalt": "impact_predictor",
}


def check_figure(path: str | os.PathLike[str]) -> Path:
    """The path of a picture that `write_figure` can write.

    Raises:
        InputError: the suffix names no known format, or there is no such folder.
    """
    return named(path, "picture that can be drawn", SUFFIXES)


def write_figure(
    path: str | os.PathLike[str],
    rows: Sequence[TouchdownRow],
    lead_time_errors: Sequence[LeadTimeErrors],
    title: str,
) -> None:
    """Draw the scored rows, and the errors against lead time, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_figure(path)
    scored = [row for row in rows if row.scored and row.measured is not None and row.relative_error is not None]
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(13.5, 4.9), layout="constrained")
        FigureCanvasAgg(figure)
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.1, 1.0, 1.0))
        figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
        _draw_velocities(left, scored)
        _draw_errors(middle, scored)
        _draw_lead_times(right, lead_time_errors)
        save_figure(figure, path)


def save_figure(figure: Figure, path: Path) -> None:
    """Write a picture in the format of its name, the same bytes every time; an older one stays until it is whole.

    Raises:
        InputError: the file cannot be written.
    """
    metadata = {"Date": None} if path.suffix.lower() == ".svg" else {}
    with whole(path) as partial:
        figure.savefig(partial, format=path.suffix[1:].lower(), dpi=120, metadata=metadata)


def _draw_velocities(axes: Axes, rows: Sequence[TouchdownRow]) -> None:
    axes.set_title("Velocities right after the touchdown")
    axes.set_xlabel("measured (m/s)")
    axes.set_ylabel("predicted (m/s)")
    if not rows:
        _say_nothing(axes, "no touchdown was scored")
        return
    extent = 0.0
    # Those of a mode at once: a line of its own for each of many touchdowns takes minutes.
    for mode in sorted({row.mode for row in rows}):
        mine = [(row.measured, row.predicted, row.half_distance) for row in rows if row.mode is mode]
        for _, colour, of in _VELOCITIES:
            x = [of(measured, arm) for measured, _, arm in mine if measured is not None]
            y = [of(predicted, arm) for _, predicted, arm in mine]
            extent = max([extent, *map(abs, x), *map(abs, y)])
            axes.plot(x, y, MODE_MARKERS.get(mode, "x"), color=colour, markersize=6, alpha=0.6, markeredgewidth=0)
    extent = 1.08 * extent or 1.0
    axes.axline((0.0, 0.0), slope=1.0, color=_GREY, linewidth=1.0, zorder=1)
    axes.set(xlim=(-extent, extent), ylim=(-extent, extent), aspect="equal")
    axes.text(-0.96 * extent, -0.76 * extent, "exact", color=_GREY, va="bottom", fontsize=9)
    handles = [
        Line2D([], [], linestyle="", marker="s", markersize=8, color=colour, label=name)
        for name, colour, _ in _VELOCITIES
    ]
    for mode in sorted({row.mode for row in rows}):
        count = sum(row.mode is mode for row in rows)
        label = f"{words(mode.name)} ({count})"
        handles.append(Line2D([], [], linestyle="", marker=MODE_MARKERS.get(mode, "x"), color=_GREY, label=label))
    axes.legend(handles=handles, loc="upper left", borderaxespad=0.2, handletextpad=0.2)


def _draw_errors(axes: Axes, rows: Sequence[TouchdownRow]) -> None:
    axes.set_title("Relative error of the last prediction")
    axes.set_xlabel("relative error (%)")
    axes.set_ylabel("touchdowns")
    errors = [100.0 * row.relative_error for row in rows if row.relative_error is not None]
    summary = errors_of(rows)
    if summary.median is None or summary.p90 is None:
        _say_nothing(axes, "no touchdown was scored")
        return
    # Errors far outside would press the others into one bar: they are counted in the last one.
    end = max(min(1.4 * max(errors), 300.0 * summary.p90), 1.0)
    shown = [min(error, end) for error in errors]
    bins = min(40, max(10, len(errors) // 5))
    counts, _, _ = axes.hist(shown, bins=bins, range=(0.0, end), color=_BLUE, alpha=0.7, edgecolor="white")
    if outside := sum(error > end for error in errors):
        axes.annotate(f"{outside} beyond →", (end, counts[-1]), ha="right", va="bottom", fontsize=9, color=_GREY)
    for value, style, label in ((summary.median, "-", "median"), (summary.p90, "--", "90 % below")):
        place = 100.0 * value
        axes.axvline(place, color=_VERMILION, linestyle=style, linewidth=1.5, label=f"{label} {place:.1f} %")
    axes.set(xlim=(0.0, end), ylim=(0.0, 1.25 * max(counts)))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(loc="upper right", frameon=True, framealpha=0.9, edgecolor="none")


def _draw_lead_times(axes: Axes, errors: Sequence[LeadTimeErrors]) -> None:
    axes.set_title("Relative error against lead time")
    axes.set_xlabel("prediction made before the touchdown (ms)")
    axes.set_ylabel("relative error (%)")
    known = [one for one in errors if one.errors.median is not None and one.errors.p90 is not None]
    if not known:
        _say_nothing(axes, "no prediction was scored")
        return
    middles = [500.0 * (one.begin + one.end) for one in known]
    for part, style, marker, label in (("p90", "--", "s", "90 % below"), ("median", "-", "o", "median")):
        values = [100.0 * getattr(one.errors, part) for one in known]
        axes.plot(middles, values, style, marker=marker, color=_VERMILION, label=label)
    top = 1.25 * max(100.0 * (one.errors.p90 or 0.0) for one in known) or 1.0
    axes.set(xlim=(1e3 * errors[-1].end, 1e3 * errors[0].begin), ylim=(0.0, top))
    for middle, one in zip(middles, known, strict=True):
        axes.text(middle, 0.0, f"{one.errors.number}\n", ha="center", va="bottom", fontsize=9, color=_GREY)
    axes.text(0.01, 0.09, "number of predictions:", transform=axes.transAxes, fontsize=9, color=_GREY)
    axes.legend(loc="upper right", ncols=2)


def _say_nothing(axes: Axes, text: str) -> None:
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", color=_GREY)
    axes.set(xticks=[], yticks=[])
