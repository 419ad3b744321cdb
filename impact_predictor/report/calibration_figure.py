"""One picture of a calibration: where the error is least, what the inertia is worth, predicted against measured."""

from __future__ import annotations

import os

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator, PercentFormatter

from ..calibration.fit import Calibration
from ..calibration.search import Estimate
from ..wording import percent
from .calibration import interval
from .modes import PALETTE
from .plot import GREY, Axes, Figure, headline, picture

_GIVEN, _FITTED = PALETTE[:2]


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
        _draw_velocities(right, calibration)


def _draw_map(figure: Figure, axes: Axes, calibration: Calibration) -> None:
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
    axes.errorbar(*point, upwards, across, color=_FITTED, marker="o", capsize=4, linewidth=2, label=label, zorder=3)
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
    axes.axvspan(one.low or factors[0], one.high or factors[-1], color=_GIVEN, alpha=0.12, label="predict as well")
    axes.plot(factors, losses, "o-", color=_GIVEN, markersize=4)
    axes.axvline(1.0, color="black", linewidth=1.0, linestyle="--", label="given")
    if one.value != 1.0:
        axes.axvline(one.value, color=_FITTED, linewidth=2.0, label="fitted")
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
    for missed, colour, marker, label in (
        (calibration.given_misses, GREY, "x", "with the given values"),
        (calibration.held_out_misses, _FITTED, "o", "fitted to other touchdowns"),
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
