"""One picture of replays: predicted against measured velocities, the errors, and the errors against lead time."""

from __future__ import annotations

import os
from array import array
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from matplotlib.ticker import MaxNLocator

from ..wording import percent, words
from .gait import MOST, Machine, machines_of, write_gait
from .modes import MODES, PALETTE
from .plot import GREY, Axes, Line2D, check_picture, headline, picture
from .summary import LEAD_TIME_EDGES, LeadTimeErrors, TouchdownRow, errors_ahead, errors_of, row_of
from .tally import TouchdownTally

if TYPE_CHECKING:
    from ..bags.replay import Result

_ALONG, _TURNING = PALETTE[:2]
_VELOCITIES: Final = (
    ("vx, along the support", _ALONG),
    ("ω s, from turning\n(s: half the contacts' distance)", _TURNING),
)
_NAMED: Final = 3
"""Bags whose names stand in the title."""


class ReplayPicture:
    """Takes the replays of bags one by one: of machines that walk it shows their gait, else predicted velocities.

    Only what it shows is kept of each.
    """

    def __init__(self, path: str) -> None:
        """Draw into `path`, a .png or .svg file.

        Raises:
            InputError: it is no such file, or its folder does not exist.
        """
        self.path = check_picture(path)
        self._names: list[str] = []
        self._machines: list[Machine] = []
        self._tally = TouchdownTally()
        self._scored: list[TouchdownRow] = []
        # Lead time and error in turns.
        self._ahead = array("d")

    def add(self, result: Result) -> None:
        """Take a replay."""
        # One more than it shows tells that there are more.
        self._names += [Path(result.bag).name][: _NAMED + 1 - len(self._names)]
        self._machines += islice(machines_of([result]), MOST + 1 - len(self._machines))
        for settled in result.settled:
            row = row_of(*settled)
            self._tally.add(row)
            if row.scored:
                self._scored.append(row)
                for lead_time, error in settled.score.history:
                    if lead_time < LEAD_TIME_EDGES[-1]:
                        self._ahead.extend((lead_time, error))

    def write(self) -> None:
        """Draw it.

        Raises:
            InputError: the file cannot be written.
        """
        if self._machines:
            write_gait(self.path, self._machines)
            return
        names = ", ".join(self._names[:_NAMED]) + (", ..." if len(self._names) > _NAMED else "")
        errors = errors_ahead(zip(self._ahead[::2], self._ahead[1::2], strict=True))
        write_touchdowns(self.path, self._scored, errors, f"{names}: {self._tally.sentences()[0].rstrip('.')}")


def write_touchdowns(
    path: str | os.PathLike[str], rows: Sequence[TouchdownRow], errors: Sequence[LeadTimeErrors], title: str
) -> None:
    """Draw the scored rows, and the errors against lead time, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    scored = [row for row in rows if row.scored and row.measured is not None and row.relative_error is not None]
    with picture(path, 13.5, 4.9) as figure:
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.1, 1.0, 1.0))
        headline(figure, title)
        _draw_velocities(left, scored)
        _draw_errors(middle, scored)
        _draw_lead_times(right, errors)


def _draw_velocities(axes: Axes, rows: Sequence[TouchdownRow]) -> None:
    axes.set_title("Velocities right after the touchdown")
    axes.set(xlabel="measured (m/s)", ylabel="predicted (m/s)")
    if not rows:
        _draw_nothing(axes, "no touchdown was scored")
        return
    handles = [
        Line2D([], [], linestyle="", marker="s", markersize=8, color=colour, label=name) for name, colour in _VELOCITIES
    ]
    extent = 0.0
    # Those of a mode at once: a line of its own for each of many touchdowns takes minutes.
    for mode in sorted({row.mode for row in rows}):
        mine = [(row.measured, row.predicted, row.half_distance) for row in rows if row.mode is mode]
        marker = MODES[mode].marker
        known = [(measured, predicted, arm) for measured, predicted, arm in mine if measured is not None]
        for colour, pairs in (
            (_ALONG, [(measured.vx, predicted.vx) for measured, predicted, _ in known]),
            (_TURNING, [(measured.omega * arm, predicted.omega * arm) for measured, predicted, arm in known]),
        ):
            extent = max([extent, *(abs(velocity) for pair in pairs for velocity in pair)])
            axes.plot(*zip(*pairs, strict=True), marker, color=colour, markersize=6, alpha=0.6, markeredgewidth=0)
        label = f"{words(mode.name)} ({len(mine)})"
        handles.append(Line2D([], [], linestyle="", marker=marker, color=GREY, label=label))
    extent = 1.08 * extent or 1.0
    axes.axline((0.0, 0.0), slope=1.0, color=GREY, linewidth=1.0, zorder=1)
    axes.set(xlim=(-extent, extent), ylim=(-extent, extent), aspect="equal")
    axes.text(-0.96 * extent, -0.76 * extent, "exact", color=GREY, va="bottom", fontsize=9)
    axes.legend(handles=handles, loc="upper left", borderaxespad=0.2, handletextpad=0.2)


def _draw_errors(axes: Axes, rows: Sequence[TouchdownRow]) -> None:
    axes.set_title("Relative error of the last prediction")
    axes.set(xlabel="relative error (%)", ylabel="touchdowns")
    errors = [100.0 * row.relative_error for row in rows if row.relative_error is not None]
    summary = errors_of(rows)
    if summary.median is None or summary.p90 is None:
        _draw_nothing(axes, "no touchdown was scored")
        return
    # Errors far outside would press the others into one bar: they are counted in the last one.
    end = max(min(1.4 * max(errors), 300.0 * summary.p90), 1.0)
    shown = [min(error, end) for error in errors]
    bins = min(40, max(10, len(errors) // 5))
    counts: Any = axes.hist(shown, bins=bins, range=(0.0, end), color=_ALONG, alpha=0.7, edgecolor="white")[0]
    if outside := sum(error > end for error in errors):
        axes.annotate(f"{outside} beyond →", (end, counts[-1]), ha="right", va="bottom", fontsize=9, color=GREY)
    for value, style, label in ((summary.median, "-", "median"), (summary.p90, "--", "90 % below")):
        said = f"{label} {percent(value)} %"
        axes.axvline(100.0 * value, color=_TURNING, linestyle=style, linewidth=1.5, label=said)
    axes.set(xlim=(0.0, end), ylim=(0.0, 1.25 * max(counts)))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(loc="upper right", frameon=True, framealpha=0.9, edgecolor="none")


def _draw_lead_times(axes: Axes, errors: Sequence[LeadTimeErrors]) -> None:
    axes.set_title("Relative error against lead time")
    axes.set(xlabel="prediction made before the touchdown (ms)", ylabel="relative error (%)")
    known = [one for one in errors if one.errors.median is not None and one.errors.p90 is not None]
    if not known:
        _draw_nothing(axes, "no prediction was scored")
        return
    middles = [500.0 * (one.begin + one.end) for one in known]
    for part, style, marker, label in (("p90", "--", "s", "90 % below"), ("median", "-", "o", "median")):
        values = [100.0 * getattr(one.errors, part) for one in known]
        axes.plot(middles, values, style, marker=marker, color=_TURNING, label=label)
    top = 1.25 * max(100.0 * (one.errors.p90 or 0.0) for one in known) or 1.0
    axes.set(xlim=(1e3 * errors[-1].end, 1e3 * errors[0].begin), ylim=(0.0, top))
    for middle, one in zip(middles, known, strict=True):
        axes.text(middle, 0.0, f"{one.errors.number}\n", ha="center", va="bottom", fontsize=9, color=GREY)
    axes.text(0.01, 0.09, "number of predictions:", transform=axes.transAxes, fontsize=9, color=GREY)
    axes.legend(loc="upper right", ncols=2)


def _draw_nothing(axes: Axes, text: str) -> None:
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", color=GREY)
    axes.set(xticks=[], yticks=[])
