"""The pictures of replays and of calibrations: predicted against measured velocities, errors, and what was fitted."""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import chain, cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.ticker import MaxNLocator, PercentFormatter

from ..files import named
from ..wording import listed, percent
from .gait import FootLandings, feet_of, write_gait
from .modes import PALETTE
from .plot import GREY, PICTURE, Axes, Figure, headline, picture
from .summary import LEAD_TIME_EDGES, SpanErrors, Tally, errors_ahead
from .touchdowns import TouchdownRow, rows_of

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..calibration.fit import Calibration

_BLUE, _VERMILION = PALETTE[:2]
MOST: Final = 3
"""Bags whose names stand in the title, and machines in one picture."""


class ReplayPicture:
    """Takes the replays of bags one by one: of machines that walk it shows their gait, else predicted velocities.

    Only what it shows is kept of each.
    """

    def __init__(self, path: str) -> None:
        """Draw into `path`, a .png or .svg file.

        Raises:
            InputError: it is no such file, or its folder does not exist.
        """
        self.path = named(path, *PICTURE)
        self._names: list[str] = []
        self._machines: list[list[FootLandings]] = []
        self._tally = Tally()
        self._scored: list[TouchdownRow] = []
        self._ahead: list[tuple[float, float]] = []  # lead time and error

    def add(self, result: Result) -> None:
        """Take a replay."""
        bag, rows = Path(result.bag).name, rows_of(result.settled)
        self._names.append(bag)
        self._tally.add(rows)
        for body, gait in list(result.gaits.items())[: MOST - len(self._machines)]:
            mine = [row for row in rows if row.body == (body or row.body)]
            self._machines.append(feet_of(f"{bag} {body}".rstrip(), gait, mine))
        self._scored += [row for row in rows if row.scored]
        scores = [settled.score for settled in result.settled if settled.score.scored]
        self._ahead += [made for one in scores for made in one.history if made[0] < LEAD_TIME_EDGES[-1]]

    def write(self) -> None:
        """Draw it.

        Raises:
            InputError: the file cannot be written.
        """
        names = listed(self._names, MOST)
        if self._machines:
            write_gait(self.path, list(chain.from_iterable(self._machines)), names)
            return
        write_touchdowns(
            self.path, self._scored, errors_ahead(self._ahead), f"{names}: {self._tally.sentences()[0].rstrip('.')}"
        )


def write_touchdowns(
    path: str | os.PathLike[str], rows: Sequence[TouchdownRow], errors: Sequence[SpanErrors], title: str
) -> None:
    """Draw the scored rows, and the errors against lead time, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    scored = [row for row in rows if row.scored and row.measured_twist is not None and row.relative_error is not None]
    with picture(path, 13.5, 4.9) as figure:
        headline(figure, title)
        if not scored:
            figure.text(0.5, 0.5, "no touchdown was scored", ha="center", color=GREY)
            return
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.1, 1.0, 1.0))
        s = np.array([row.half_distance for row in scored])
        measured, predicted = (
            np.array([getattr(row, name) for row in scored]) for name in ("measured_twist", "predicted_twist")
        )
        look: Any = {"alpha": 0.6, "markersize": 5, "markeredgewidth": 0}
        left.plot(measured[:, 0], predicted[:, 0], "o", color=_BLUE, label="vx, along the support", **look)
        left.plot(s * measured[:, 2], s * predicted[:, 2], "o", color=_VERMILION, label="ω s, from turning", **look)
        left.axline((0.0, 0.0), slope=1.0, color="black", linewidth=1.0, zorder=1, label="exact")
        left.set_title("Velocities right after the touchdown")
        left.set(xlabel="measured (m/s); s: half the contacts' distance", ylabel="predicted (m/s)")
        left.set_aspect("equal", adjustable="datalim")
        left.legend(loc="upper left")
        _draw_errors(middle, scored)
        _draw_lead_times(right, errors)


def _draw_errors(axes: Axes, rows: Sequence[TouchdownRow]) -> None:
    errors = np.array([100.0 * (row.relative_error or 0.0) for row in rows])
    half, most = np.quantile(errors, (0.5, 0.9))
    # Errors far outside would press the others into one bar: they are counted in the last one.
    end = max(min(1.4 * errors.max(), 3.0 * most), 1.0)
    axes.hist(np.minimum(errors, end), bins=min(40, max(10, len(errors) // 5)), color=_BLUE, alpha=0.7)
    for value, style, label in ((half, "-", "median"), (most, "--", "90 % below")):
        said = f"{label} {percent(0.01 * value)} %"
        axes.axvline(value, color=_VERMILION, linestyle=style, linewidth=1.5, label=said)
    axes.set_title("Relative error of the last prediction")
    outside = f"; {np.sum(errors > end)} beyond, in the last bar" if np.any(errors > end) else ""
    axes.set(xlabel=f"relative error (%){outside}", ylabel="touchdowns", xlim=(0.0, end))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(loc="upper right", frameon=True)


def _draw_lead_times(axes: Axes, errors: Sequence[SpanErrors]) -> None:
    known = [one for one in errors if one.errors.number]
    middles = [500.0 * (one.begin + one.end) for one in known]
    for part, style, label in (("p90", "s--", "90 % below"), ("p50", "o-", "median")):
        values = [100.0 * getattr(one.errors, part) for one in known]
        axes.plot(middles, values, style, color=_VERMILION, label=label)
    axes.set_title("Relative error against lead time")
    axes.set_xticks(middles, [f"{500.0 * (one.begin + one.end):.0f}\n({one.errors.number})" for one in known])
    axes.set(xlabel="lead time (ms), and number of predictions", ylabel="relative error (%)")
    axes.set(xlim=(1e3 * errors[-1].end, 1e3 * errors[0].begin))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="lower left", ncols=2)


def write_calibration(path: str | os.PathLike[str], calibration: Calibration, name: str) -> None:
    """Draw a calibration to the bags of a name into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    with picture(path, 10.5, 5.0) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 0.85))
        given, held_out = (float(np.median(one)) for one in (calibration.given, calibration.held_out))
        headline(
            figure,
            f"{name}: {len(calibration.touchdowns)} touchdowns. Error in the median: {percent(given)} % with the given "
            f"values, {percent(held_out)} % with values\nfitted to other touchdowns",
        )
        _draw_map(figure, left, calibration)
        _draw_parts(right, calibration)


def _draw_map(figure: Figure, axes: Axes, calibration: Calibration) -> None:
    from ..calibration.search import interval  # which needs scipy, as no other picture here does

    frictions, restitutions, losses = calibration.map
    friction, restitution = (calibration.estimates[name] for name in ("friction", "restitution"))
    wide, high = float(frictions[-1]), float(restitutions[-1])
    levels = np.linspace(float(losses.min()), float(np.quantile(losses, 0.5)) + 1e-9, 14)
    looks: Any = {"levels": levels, "cmap": "cividis_r", "extend": "max", "zorder": 0}
    drawn = axes.contourf(frictions, restitutions, losses.T, **looks)
    bar = figure.colorbar(drawn, ax=axes, format=PercentFormatter(1.0, decimals=1), pad=0.02)
    bar.set_label("mean relative error (darker is worse)")
    across, upwards = (
        [[max(one.value - (one.low or 0.0), 0.0)], [max((end if one.high is None else one.high) - one.value, 0.0)]]
        for one, end in ((friction, wide), (restitution, high))
    )
    label = f"fitted, with 95 % interval:\nfriction {interval(friction)}\nrestitution {interval(restitution)}"
    axes.errorbar(friction.value, restitution.value, upwards, across, "o", color=_VERMILION, capsize=4, label=label)
    label = f"given: {friction.given:.3g} and {restitution.given:.3g}"
    axes.plot(friction.given, restitution.given, "ws", markeredgecolor="black", clip_on=False, zorder=4, label=label)
    axes.set_title("Mean error over friction and restitution")
    axes.set(xlabel="friction", ylabel="restitution", xlim=(0.0, wide), ylim=(0.0, high))
    axes.legend(loc="upper right", frameon=True, framealpha=0.9)
    axes.grid(visible=False)


def _draw_parts(axes: Axes, calibration: Calibration) -> None:
    """What part of the touchdowns has a smaller error, with the given and the fitted values and by simple answers."""
    parts = np.arange(1, len(calibration.given) + 1) / len(calibration.given)
    axes.plot(np.sort(calibration.held_out), parts, color=_VERMILION, linewidth=2.0, label="fitted, held out")
    axes.plot(np.sort(calibration.given), parts, color="black", label="given values")
    for (said, errors), color in zip(calibration.simple.items(), cycle((_BLUE, *PALETTE[2:])), strict=False):
        axes.plot(np.sort(errors), parts, color=color, linestyle="--", label=said)
    axes.set_title("Part of the touchdowns with less error")
    axes.set(xlabel="relative error", xlim=(0.0, 2.0 * float(np.quantile(calibration.given, 0.9))), ylim=(0.0, 1.0))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    axes.legend(loc="lower right", frameon=True)
