"""The gait diagram of machines that walk: when which foot stands, and how well its landings were predicted."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Final, NamedTuple

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..bags.gait import AHEAD, Gait, GaitLanding
from .figure import STYLE, check_figure, save_figure
from .summary import quantile

if TYPE_CHECKING:
    from ..bags.replay import Result

SHOWN: Final = 12.0
"""Seconds of a record whose stances are shown: in more of them no stance could be told from the next."""

LEAST: Final = 1e-3
"""Speeds (m/s) and impulses (N s) below it are none."""

MANY: Final = 60
"""Landings of a foot above which they are drawn as dots alone."""

MOST: Final = 3
"""Machines in one picture."""

# The colours of Okabe and Ito, which people of any colour vision tell apart, one for each foot of a machine.
_COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_GREY: Final = "#999999"
_NS: Final = 1e-9


class Machine(NamedTuple):
    """A machine in a picture, by the name of its record, or of it in its record."""

    name: str
    gait: Gait


def machines_of(results: Sequence[Result]) -> list[Machine]:
    """The machines of some replays."""
    return [
        Machine(f"{Path(result.bag).name} {body}".rstrip(), gait)
        for result in results
        for body, gait in result.gaits.items()
    ]


class _Row(NamedTuple):
    """A foot of a picture: from what stamp on its times count, the seconds between its samples, and its colour."""

    name: str
    start: int
    period: float
    colour: str
    landings: list[GaitLanding]
    true: list[int]


def write_gait(path: str | os.PathLike[str], machines: Sequence[Machine]) -> None:
    """Draw when the feet of machines stand, and their landings as they were predicted `AHEAD`, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_figure(path)
    shown = machines[:MOST]
    rows = [row for one in shown for row in _rows(one, len(shown) > 1)]
    last = max(((one.gait.end - one.gait.begin) * _NS for one in shown), default=0.0)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(13.5, 4.8 + 0.42 * len(rows)), layout="constrained")
        FigureCanvasAgg(figure)
        heights = (0.42 * len(rows) + 0.4, 1.2, 0.9, 0.9)
        gait, errors, speeds, impulses = figure.subplots(4, 1, height_ratios=heights)
        names = ", ".join(one.name for one in shown) + (", ..." if len(machines) > MOST else "")
        figure.suptitle(f"{names}: {_conclusion(rows)}", x=0.01, ha="left", fontweight="bold")
        _draw_stances(gait, shown, rows, last)
        _draw_errors(errors, rows)
        _draw_landings(speeds, rows, "Speed of the foot in its last sample in the air", "m/s", "speed")
        _draw_landings(impulses, rows, "Impulse that it gets where it lands with that speed", "N s", "impulse")
        for axes in (errors, speeds, impulses):
            axes.set_xlim(0.0, last or 1.0)
        impulses.set_xlabel("time (s)")
        save_figure(figure, path)


def _rows(machine: Machine, several: bool) -> list[_Row]:
    gait = machine.gait
    true = gait.true_stances
    return [
        _Row(
            f"{machine.name} {name}" if several else name,
            gait.begin,
            (gait.end - gait.begin) * _NS / max(1, gait.samples - 1),
            _COLOURS[foot % len(_COLOURS)],
            [one for one in gait.landings if one.foot == foot],
            sorted(one.begin for one in true if one.foot == foot and one.begin > gait.begin),
        )
        for foot, name in enumerate(gait.feet)
    ]


def _draw_stances(axes: Axes, machines: Sequence[Machine], rows: Sequence[_Row], last: float) -> None:
    end = min(last, SHOWN) or 1.0
    part = f", the first {end:.0f} s of {last:.0f} s" if last > SHOWN else ""
    axes.set_title(f"When each foot stands{part}")
    first, knows_truth = 0, False
    for machine in machines:
        gait = machine.gait
        for stances, height, of_truth in ((gait.true_stances, 0.78, True), (gait.stances, 0.42, False)):
            for foot, begin, until in stances:
                begins = (begin - gait.begin) * _NS
                if begins < end:
                    width = min((until - gait.begin) * _NS, end) - begins
                    colour = "#d0d0d0" if of_truth else rows[first + foot].colour
                    axes.barh(first + foot, width, height, begins, color=colour, zorder=2 if of_truth else 3)
            knows_truth |= of_truth and bool(stances)
        first += len(gait.feet)
    for number, row in enumerate(rows):
        times = [(one.announced - row.start) * _NS for one in row.landings if one.announced is not None]
        shown = [time for time in times if time <= end]
        places = [number - 0.33] * len(shown)
        marks = axes.plot(shown, places, "v", color="black", markersize=6, zorder=4, clip_on=False)
        # The layout takes the extent of unclipped marks for infinite where there are none.
        marks[0].set_in_layout(bool(shown))
    axes.set(xlim=(0.0, end), ylim=(len(rows) - 0.5, -0.65))
    axes.set_yticks(range(len(rows)), [row.name for row in rows])
    axes.grid(visible=False, axis="y")
    handles = [
        Line2D([], [], linestyle="", marker="v", color="black", label=f"landing, predicted {1e3 * AHEAD:.0f} ms ahead"),
        Patch(color=rows[0].colour if rows else _GREY, label="stands, as inferred from its motion"),
    ]
    if knows_truth:
        handles.append(Patch(color="#d0d0d0", label="stands, as the record tells"))
    axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 0.99), ncols=3, borderaxespad=0.0)


def _draw_errors(axes: Axes, rows: Sequence[_Row]) -> None:
    what = "true" if any(row.true for row in rows) else "inferred"
    axes.set_title(f"Predicted less {what} time of each landing, as predicted {1e3 * AHEAD:.0f} ms before")
    axes.set_ylabel("ms")
    axes.axhline(0.0, color=_GREY, linewidth=1.0)
    if any(row.true for row in rows):
        period = 1e3 * max(row.period for row in rows)
        axes.axhspan(-period, 0.0, color="#eeeeee", zorder=0)
        said = f"grey: no error, for the record tells a landing up to one sample ({period:.3g} ms) late"
        axes.set_title(said, loc="right", fontsize=9, color=_GREY)
    for row in rows:
        made = _errors(row)
        _draw_points(axes, row, [time for time, _ in made], [1e3 * error for _, error in made])
    axes.margins(y=0.15)
    if not any(map(_errors, rows)):
        axes.set_ylim(-1.0, 1.0)


def _draw_landings(axes: Axes, rows: Sequence[_Row], title: str, unit: str, field: str) -> None:
    axes.set_title(title)
    axes.set_ylabel(unit)
    for row in rows:
        known = [one for one in row.landings if getattr(one, field) is not None]
        times = [(one.stamp - row.start) * _NS for one in known]
        _draw_points(axes, row, times, [getattr(one, field) for one in known])
    values = [getattr(one, field) or 0.0 for row in rows for one in row.landings]
    if max(values, default=0.0) < LEAST:
        axes.set_ylim(0.0, 1.0)
        said = f"none above {LEAST:g} {unit}" if values else "no foot has landed"
        axes.text(0.5, 0.5, said, transform=axes.transAxes, ha="center", va="center", color=_GREY)
    else:
        axes.set_ylim(0.0, 1.1 * max(values))


def _draw_points(axes: Axes, row: _Row, times: Sequence[float], values: Sequence[float]) -> None:
    if len(times) <= MANY:
        axes.vlines(times, 0.0, values, color=row.colour, linewidth=1.2, alpha=0.7)
    axes.plot(times, values, "o", color=row.colour, markersize=5 if len(times) <= MANY else 2)


def _errors(row: _Row) -> list[tuple[float, float]]:
    """Time and error in s of every announced landing, against the true one, or the inferred one where none is known."""
    made = []
    for one in row.landings:
        if one.announced is not None:
            told = one.announced
            stamp = min(row.true, key=lambda true: abs(true - told), default=one.stamp)
            made.append(((stamp - row.start) * _NS, (told - stamp) * _NS))
    return made


def _conclusion(rows: Sequence[_Row]) -> str:
    landings = sum(len(row.landings) for row in rows)
    errors = [1e3 * abs(error) for row in rows for _, error in _errors(row)]
    if not errors:
        return f"{landings} landings, none predicted {1e3 * AHEAD:.0f} ms ahead"
    return (
        f"{landings} landings, {len(errors)} predicted {1e3 * AHEAD:.0f} ms ahead, "
        f"half of them within {median(errors):.1f} ms, 90 % within {quantile(errors, 0.9):.1f} ms"
    )
