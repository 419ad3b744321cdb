"""The gait diagram of machines that walk: when which foot stands, and how well its landings were predicted."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from math import hypot
from typing import Final, NamedTuple

import numpy as np

from ..bags.body import Gait
from ..scenarios.comparison import LEAD_TIMES
from ..stamps import NANOSECONDS
from ..wording import counted
from .modes import PALETTE
from .plot import GREY, Axes, common_legend, headline, picture
from .summary import spread_of
from .touchdowns import TouchdownRow

AHEAD: Final = LEAD_TIMES[-1]
"""Seconds before a landing at which the prediction is made that is shown."""


class FootLandings(NamedTuple):
    """A foot in a picture, times in s since the record began: its stances as (begin, length), and its landings.

    Of landings, (time, value): `errors` (ms) of the times predicted `AHEAD`, against the true ones or, where the record
    has none, the inferred ones; `speeds` (m/s) before them and `impulses` (N s). The record has `length` s, and one
    sample each `period` ms.
    """

    machine: str
    name: str
    colour: str
    landings: int
    stances: list[tuple[float, float]]
    true_stances: list[tuple[float, float]]
    errors: list[tuple[float, float]]
    speeds: list[tuple[float, float]]
    impulses: list[tuple[float, float]]
    length: float
    period: float
    bounds: frozenset[str] = frozenset()
    """What the impulses are."""


def feet_of(machine: str, gait: Gait, rows: Iterable[TouchdownRow]) -> list[FootLandings]:
    """The feet of a machine of a name, from their stances and from all that touched down."""
    feet, length = [], (gait.end - gait.begin) / NANOSECONDS
    # What follows of a foot that stands already is no landing of its own.
    all_landings = [((row.stamp - gait.begin) / NANOSECONDS, row) for row in rows if not row.is_second]
    for number, name in enumerate(gait.feet):
        landings = [(time, row) for time, row in all_landings if row.foot == name]
        stances, true = (
            [((one.begin - gait.begin) / NANOSECONDS, (one.end - one.begin) / NANOSECONDS) for one in foot]
            for foot in ([one for one in ones if one.foot == number] for ones in (gait.stances, gait.true_stances))
        )
        begun, errors = [begin for begin, _ in true if begin > 0.0], []
        for time, row in landings:
            if (error := row.time_errors[-1]) is not None:
                landed = min(begun, key=lambda begin: abs(begin - time - error), default=time)
                errors.append((landed, 1e3 * (time + error - landed)))
        feet.append(
            FootLandings(
                machine=machine,
                name=name,
                colour=PALETTE[number % len(PALETTE)],
                landings=len(landings),
                stances=stances,
                true_stances=true,
                errors=errors,
                speeds=[(time, row.landing_speed) for time, row in landings if row.landing_speed is not None],
                impulses=[(time, hypot(*row.impulse)) for time, row in landings if row.impulse],
                length=length,
                period=1e3 * length / max(1, gait.samples - 1),
                bounds=frozenset(row.bound for _, row in landings if row.bound),
            )
        )
    return feet


def write_gait(path: str | os.PathLike[str], feet: Sequence[FootLandings], title: str) -> None:
    """Draw when the feet of machines stand, and their landings as they were predicted `AHEAD`, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    with picture(path, 13.5, 4.9 + 0.42 * len(feet)) as figure:
        heights = (0.42 * len(feet) + 0.4, 1.2, 0.9, 0.9)
        gait, errors, speeds, impulses = figure.subplots(4, 1, height_ratios=heights, sharex=True)
        headline(figure, f"{title}: {conclusion(feet)}")
        _draw_stances(gait, feet)
        what = "true" if any(foot.true_stances for foot in feet) else "inferred"
        errors.set_title(f"Predicted less {what} time of each landing, as predicted {1e3 * AHEAD:.0f} ms before")
        errors.axhline(0.0, color=GREY, linewidth=1.0)
        if what == "true":
            period = max(foot.period for foot in feet)
            said = f"no error: the record tells a landing up to one sample ({period:.3g} ms) late"
            errors.axhspan(-period, 0.0, color="#eeeeee", zorder=0, label=said)
        speeds.set_title("Speed of the foot in its last sample in the air")
        bounds = ", ".join(sorted(frozenset().union(*(foot.bounds for foot in feet))))
        said = f" ({bounds})" if bounds else ""
        impulses.set_title(f"Impulse that it gets where it lands with that speed{said}")
        for axes, values, unit in ((errors, "errors", "ms"), (speeds, "speeds", "m/s"), (impulses, "impulses", "N s")):
            axes.set_ylabel(unit)
            for foot in feet:
                points = np.reshape(getattr(foot, values), (-1, 2)).T
                axes.vlines(points[0], 0.0, points[1], color=foot.colour, linewidth=1.0, alpha=0.7)
                axes.plot(*points, "o", color=foot.colour, markersize=4)
        impulses.set(xlabel="time (s)", xlim=(0.0, max((foot.length for foot in feet), default=0.0) or 1.0))
        common_legend(figure)


def _draw_stances(axes: Axes, feet: Sequence[FootLandings]) -> None:
    axes.set_title("When each foot stands")
    for row, foot in enumerate(feet):
        if foot.true_stances:
            axes.broken_barh(
                foot.true_stances, (row - 0.39, 0.78), color="#d0d0d0", label="stands, as the record tells"
            )
        label = "stands, as inferred from its motion"
        axes.broken_barh(foot.stances, (row - 0.21, 0.42), color=foot.colour, label=label)
        times = [time + 1e-3 * error for time, error in foot.errors]
        label = f"landing, predicted {1e3 * AHEAD:.0f} ms ahead"
        axes.plot(times, [row - 0.33] * len(times), "v", color="black", markersize=6, label=label)
    axes.set_ylim(len(feet) - 0.5, -0.65)
    several = len({foot.machine for foot in feet}) > 1
    names = [f"{foot.machine} {foot.name}" if several else foot.name for foot in feet]
    axes.set_yticks(range(len(feet)), names)
    axes.grid(visible=False, axis="y")


def conclusion(feet: Sequence[FootLandings]) -> str:
    """How well landings were predicted, in words."""
    landings, ahead = counted(sum(foot.landings for foot in feet), "landing"), f"predicted {1e3 * AHEAD:.0f} ms ahead"
    spread = spread_of([abs(error) for foot in feet for _, error in foot.errors])
    if not spread.number:
        return f"{landings}, none {ahead}"
    return (
        f"{landings}, {spread.number} {ahead}, half of them within {spread.p50:.1f} ms, 90 % within {spread.p90:.1f} ms"
    )
