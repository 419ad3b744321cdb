"""The picture of a calibration: the error over friction and restitution, and what part of the touchdowns has less."""

from __future__ import annotations

import os
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import PercentFormatter

from ..calibration.search import interval
from ..wording import percent
from .modes import PALETTE
from .plot import Axes, Figure, headline, picture

if TYPE_CHECKING:
    from ..calibration.fit import Calibration

_BLUE, _VERMILION = PALETTE[:2]


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
