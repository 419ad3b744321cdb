"""One picture of a calibration: where the error is least, what the inertia is worth, predicted against measured."""

from __future__ import annotations

import os
from typing import Final

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator, PercentFormatter

from ..calibration.fit import Calibration
from ..calibration.search import Estimate
from .calibration import interval
from .figure import STYLE, check_figure, save_figure

_BLUE, _VERMILION, _GREY = "#0072B2", "#D55E00", "#666666"
_LEVELS: Final = 14


def write_figure(path: str | os.PathLike[str], calibration: Calibration, name: str) -> None:
    """Draw a calibration to the bags of a name into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_figure(path)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(14.0, 5.0), layout="constrained")
        FigureCanvasAgg(figure)
        left, middle, right = figure.subplots(1, 3, width_ratios=(1.25, 0.85, 1.0))
        given, held_out = (100.0 * float(np.median(one)) for one in (calibration.given_errors, calibration.held_out))
        figure.suptitle(
            f"{name}: {len(calibration.touchdowns)} touchdowns. Error in the median: {given:.1f} % with the given "
            f"values, {held_out:.1f} % with values fitted to other touchdowns",
            x=0.01,
            ha="left",
            fontweight="bold",
            fontsize=11,
        )
        _draw_map(figure, left, calibration)
        _draw_inertia(middle, calibration)
        _draw_velocities(right, calibration)
        save_figure(figure, path)


def _draw_map(figure: Figure, axes: Axes, calibration: Calibration) -> None:
    grid, losses = calibration.map
    friction, restitution = calibration.friction, calibration.restitution
    axes.set_title("Mean error over friction and restitution")
    axes.set(xlabel="friction", ylabel="restitution", xlim=(0.0, _wide(friction)), ylim=(0.0, _wide(restitution)))
    shown = losses[np.ix_(grid.friction <= 1.5 * _wide(friction), grid.restitution <= 1.5 * _wide(restitution))]
    shown = shown if min(shown.shape) > 1 else losses
    levels = np.linspace(float(shown.min()), float(np.quantile(shown, 0.9)) + 1e-9, _LEVELS)
    drawn = axes.contourf(
        grid.friction, grid.restitution, losses.T, levels=levels, cmap="cividis_r", extend="max", zorder=0
    )
    bar = figure.colorbar(drawn, ax=axes, format=PercentFormatter(1.0, decimals=1), pad=0.02)
    bar.set_label("mean relative error (darker is worse)")
    ends = [[one.value - (one.low or 0.0), _high(one) - one.value] for one in (friction, restitution)]
    axes.errorbar(
        friction.value,
        restitution.value,
        xerr=np.clip(ends[0], 0.0, None)[:, None],
        yerr=np.clip(ends[1], 0.0, None)[:, None],
        color=_VERMILION,
        marker="o",
        capsize=4,
        linewidth=2,
        label=f"fitted, with 95 % interval:\nfriction {interval(friction)}\nrestitution {interval(restitution)}",
        zorder=3,
    )
    axes.plot(
        friction.given,
        restitution.given,
        "s",
        color="white",
        markeredgecolor="black",
        markersize=9,
        label=f"given: {friction.given:.3g} and {restitution.given:.3g}",
        clip_on=False,
        zorder=4,
    )
    axes.legend(loc="upper right", frameon=True, framealpha=0.9)
    axes.grid(visible=False)


def _draw_inertia(axes: Axes, calibration: Calibration) -> None:
    one = calibration.inertia
    axes.set_title("Inertia: " + ("told" if one.known else "not told by these touchdowns"))
    axes.set(xlabel="times the given inertia", ylabel="least mean error with it", xscale="log")
    if not calibration.inertias:
        axes.text(0.5, 0.5, "several bodies of different inertia", transform=axes.transAxes, ha="center", color=_GREY)
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


def _draw_velocities(axes: Axes, calibration: Calibration) -> None:
    axes.set_title("Velocities after the touchdown: vx, and ω s")
    axes.set(xlabel="measured (m/s); s: half the contacts' distance", ylabel="predicted (m/s)")
    speed = np.array([one.speed for one in calibration.touchdowns])[:, None]
    measured = np.array([(one.measured.vx, one.measured.omega * one.half_distance) for one in calibration.touchdowns])
    for missed, color, marker, label in (
        (calibration.given_misses, _GREY, "x", "with the given values"),
        (calibration.held_out_misses, _VERMILION, "o", "fitted to other touchdowns"),
    ):
        predicted = (measured + missed * speed).ravel()
        axes.scatter(measured.ravel(), predicted, s=16.0, color=color, marker=marker, alpha=0.6, label=label)
    axes.axline((0.0, 0.0), slope=1.0, color="black", linewidth=1.0, zorder=1, label="exact")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left")


def _wide(one: Estimate) -> float:
    """The end of an axis that shows a coefficient."""
    return min(max(1.5 * one.given, 2.0 * one.value, 1.2 * (one.high or 0.0), 0.1), max(1.0, 1.2 * one.given))


def _high(one: Estimate) -> float:
    return one.high if one.high is not None else max(2.0 * one.value, 1.0)
