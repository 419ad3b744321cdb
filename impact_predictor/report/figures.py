"""The pictures of replays and of calibrations: predicted against measured velocities, errors, and what was fitted."""

from __future__ import annotations

import os
from array import array
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator, PercentFormatter

from ..wording import percent, words
from .gait import MOST, Machine, machines_of, write_gait
from .modes import MODES, PALETTE
from .plot import GREY, Axes, Figure, Line2D, check_picture, headline, picture
from .summary import LEAD_TIME_EDGES, SpanErrors, Tally, errors_ahead, errors_of
from .touchdowns import TouchdownRow, row_of

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..calibration.fit import Calibration
    from ..calibration.search import Estimate

_BLUE, _VERMILION = PALETTE[:2]
_VELOCITIES: Final = (
    ("vx, along the support", _BLUE),
    ("ω s, from turning\n(s: half the contacts' distance)", _VERMILION),
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
        self._tally = Tally()
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
            self._tally.add([row])
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
    path: str | os.PathLike[str], rows: Sequence[TouchdownRow], errors: Sequence[SpanErrors], title: str
) -> None:
    """Draw the scored rows, and the errors against lead time, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    scored = [row for row in rows if row.scored and row.measured_twist is not None and row.relative_error is not None]
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
    handles = [Line2D([], [], linestyle="", marker="s", color=colour, label=name) for name, colour in _VELOCITIES]
    # Those of a mode at once: a line of its own for each of many touchdowns takes minutes.
    for mode in sorted({row.mode for row in rows}):
        mine = [row for row in rows if row.mode is mode]
        twists = [(one, row.predicted_twist, row.half_distance) for row in mine if (one := row.measured_twist)]
        pairs = np.array(
            [((one.vx, other.vx), (one.omega * arm, other.omega * arm)) for one, other, arm in twists], dtype=float
        )
        marker = MODES[mode].marker
        for k, (_, colour) in enumerate(_VELOCITIES):
            axes.plot(*pairs[:, k].T, marker, color=colour, alpha=0.6, markeredgewidth=0)
        label = f"{words(mode.name)} ({len(mine)})"
        handles.append(Line2D([], [], linestyle="", marker=marker, color=GREY, label=label))
    axes.axline((0.0, 0.0), slope=1.0, color=GREY, linewidth=1.0, zorder=1)
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(handles=handles, title="on the line: exact", loc="upper left", borderaxespad=0.2, handletextpad=0.2)


def _draw_errors(axes: Axes, rows: Sequence[TouchdownRow]) -> None:
    axes.set_title("Relative error of the last prediction")
    axes.set(xlabel="relative error (%)", ylabel="touchdowns")
    errors = [100.0 * row.relative_error for row in rows if row.relative_error is not None]
    summary = errors_of(rows)
    if summary.p50 is None or summary.p90 is None:
        _draw_nothing(axes, "no touchdown was scored")
        return
    # Errors far outside would press the others into one bar: they are counted in the last one.
    end = max(min(1.4 * max(errors), 300.0 * summary.p90), 1.0)
    axes.hist(np.minimum(errors, end), bins=min(40, max(10, len(errors) // 5)), color=_BLUE, alpha=0.7)
    if outside := sum(error > end for error in errors):
        axes.plot([], [], " ", label=f"{outside} beyond, in the last bar")
    for value, style, label in ((summary.p50, "-", "median"), (summary.p90, "--", "90 % below")):
        said = f"{label} {percent(value)} %"
        axes.axvline(100.0 * value, color=_VERMILION, linestyle=style, linewidth=1.5, label=said)
    axes.set_xlim(0.0, end)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(loc="upper right", frameon=True)


def _draw_lead_times(axes: Axes, errors: Sequence[SpanErrors]) -> None:
    axes.set_title("Relative error against lead time")
    axes.set(xlabel="prediction made before the touchdown (ms)", ylabel="relative error (%)")
    known = [one for one in errors if one.errors.p50 is not None and one.errors.p90 is not None]
    if not known:
        _draw_nothing(axes, "no prediction was scored")
        return
    middles = [500.0 * (one.begin + one.end) for one in known]
    for part, style, marker, label in (("p90", "--", "s", "90 % below"), ("p50", "-", "o", "median")):
        values = [100.0 * getattr(one.errors, part) for one in known]
        axes.plot(middles, values, style, marker=marker, color=_VERMILION, label=label)
    top = 1.25 * max(100.0 * (one.errors.p90 or 0.0) for one in known) or 1.0
    axes.set(xlim=(1e3 * errors[-1].end, 1e3 * errors[0].begin), ylim=(0.0, top))
    for middle, one in zip(middles, known, strict=True):
        axes.text(middle, 0.0, f"{one.errors.number}\n", ha="center", va="bottom", fontsize=9, color=GREY)
    axes.text(0.01, 0.09, "number of predictions:", transform=axes.transAxes, fontsize=9, color=GREY)
    axes.legend(loc="upper right", ncols=2)


def _draw_nothing(axes: Axes, text: str) -> None:
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", color=GREY)
    axes.set(xticks=[], yticks=[])


def write_calibration(path: str | os.PathLike[str], calibration: Calibration, name: str) -> None:
    """Draw a calibration to the bags of a name into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    with picture(path, 14.0, 5.0) as figure:
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.25, 0.85, 1.0))
        given, held_out = (float(np.median(one)) for one in (calibration.given_errors, calibration.held_out))
        headline(
            figure,
            f"{name}: {len(calibration.touchdowns)} touchdowns. Error in the median: {percent(given)} % with the given "
            f"values, {percent(held_out)} % with values fitted to other touchdowns",
        )
        _draw_map(figure, left, calibration)
        _draw_inertia(middle, calibration)
        _draw_fitted(right, calibration)


def _draw_map(figure: Figure, axes: Axes, calibration: Calibration) -> None:
    from .calibration import interval  # which needs scipy, as no other picture here does

    grid, losses = calibration.map
    friction, restitution = calibration.friction, calibration.restitution
    wide, high = _end(friction), _end(restitution)
    axes.set_title("Mean error over friction and restitution")
    axes.set(xlabel="friction", ylabel="restitution", xlim=(0.0, wide), ylim=(0.0, high))
    shown = losses[np.ix_(grid.friction <= 1.5 * wide, grid.restitution <= 1.5 * high)]
    shown = shown if min(shown.shape) > 1 else losses
    levels = np.linspace(float(shown.min()), float(np.quantile(shown, 0.9)) + 1e-9, 14)
    drawn = axes.contourf(
        grid.friction, grid.restitution, losses.T, levels=levels, cmap="cividis_r", extend="max", zorder=0
    )
    bar = figure.colorbar(drawn, ax=axes, format=PercentFormatter(1.0, decimals=1), pad=0.02)
    bar.set_label("mean relative error (darker is worse)")
    across, upwards = (
        np.clip([one.value - (one.low or 0.0), _high(one) - one.value], 0.0, None)[:, None]
        for one in (friction, restitution)
    )
    label = f"fitted, with 95 % interval:\nfriction {interval(friction)}\nrestitution {interval(restitution)}"
    point = friction.value, restitution.value
    axes.errorbar(*point, upwards, across, color=_VERMILION, marker="o", capsize=4, linewidth=2, label=label, zorder=3)
    label = f"given: {friction.given:.3g} and {restitution.given:.3g}"
    given = axes.plot(friction.given, restitution.given, "s", color="white", markersize=9, label=label)
    given[0].set(markeredgecolor="black", clip_on=False, zorder=4)
    axes.legend(loc="upper right", frameon=True, framealpha=0.9)
    axes.grid(visible=False)


def _draw_inertia(axes: Axes, calibration: Calibration) -> None:
    one = calibration.inertia
    axes.set_title("Inertia: " + ("told" if one.known else "not told by these touchdowns"))
    axes.set(xlabel="times the given inertia", ylabel="least mean error with it", xscale="log")
    if not calibration.inertias:
        axes.text(0.5, 0.5, "several bodies of different inertia", transform=axes.transAxes, ha="center", color=GREY)
        return
    factors, losses = np.array(calibration.inertias).T
    axes.axvspan(one.low or factors[0], one.high or factors[-1], color=_BLUE, alpha=0.12, label="predict as well")
    axes.plot(factors, losses, "o-", color=_BLUE, markersize=4)
    axes.axvline(1.0, color="black", linewidth=1.0, linestyle="--", label="given")
    if one.value != 1.0:
        axes.axvline(one.value, color=_VERMILION, linewidth=2.0, label="fitted")
    axes.xaxis.set_major_locator(FixedLocator([1 / 3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.2g}"))
    axes.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=1))
    axes.set_ylim(0.0, max(0.01, 1.15 * float(losses.max())))
    axes.legend(loc="lower right", frameon=True)


def _draw_fitted(axes: Axes, calibration: Calibration) -> None:
    axes.set_title("Velocities after the touchdown: vx, and ω s")
    axes.set(xlabel="measured (m/s); s: half the contacts' distance", ylabel="predicted (m/s)")
    speed = np.array([one.speed for one in calibration.touchdowns])[:, None]
    measured = np.array([(one.measured.vx, one.measured.omega * one.half_distance) for one in calibration.touchdowns])
    for missed, colour, marker, label in (
        (calibration.given_misses, GREY, "x", "with the given values"),
        (calibration.held_out_misses, _VERMILION, "o", "fitted to other touchdowns"),
    ):
        predicted = (measured + missed * speed).ravel()
        axes.scatter(measured.ravel(), predicted, s=16.0, color=colour, marker=marker, alpha=0.6, label=label)
    axes.axline((0.0, 0.0), slope=1.0, color="black", linewidth=1.0, zorder=1, label="exact")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left")


def _end(one: Estimate) -> float:
    """The end of an axis that shows a coefficient."""
    return min(max(1.5 * one.given, 2.0 * one.value, 1.2 * (one.high or 0.0), 0.1), max(1.0, 1.2 * one.given))


def _high(one: Estimate) -> float:
    return one.high if one.high is not None else max(2.0 * one.value, 1.0)
