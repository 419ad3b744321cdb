"""The gait diagram of machines that walk: when which foot stands, and how well its landings were predicted."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from math import hypot
from typing import Final, NamedTuple

import numpy as np

from ..bags.body import FootStance, Gait
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
    """A foot of a machine in a picture: its `number` in the `gait`, and its landings.

    Times in s since the record began; `errors` (ms) of the times predicted `AHEAD`, at the true landings or, where the
    record has none, the inferred ones.
    """

    machine: str
    gait: Gait
    number: int
    rows: list[tuple[float, TouchdownRow]]
    errors: list[tuple[float, float]]

    @property
    def name(self) -> str:
        """What the foot is called."""
        return self.gait.feet[self.number]

    @property
    def colour(self) -> str:
        """How it is drawn."""
        return PALETTE[self.number % len(PALETTE)]

    @property
    def length(self) -> float:
        """How long the record is."""
        return (self.gait.end - self.gait.begin) / NANOSECONDS

    def spans(self, stances: Iterable[FootStance]) -> list[tuple[float, float]]:
        """Its stances of those of all feet, as (begin, length)."""
        mine, begin = (one for one in stances if one.foot == self.number), self.gait.begin
        return [((one.begin - begin) / NANOSECONDS, (one.end - one.begin) / NANOSECONDS) for one in mine]


def feet_of(machine: str, gait: Gait, rows: Iterable[TouchdownRow]) -> list[FootLandings]:
    """The feet of a machine of a name, from their stances and from all that touched down."""
    # What follows of a foot that stands already is no landing of its own.
    landings = [((row.stamp - gait.begin) / NANOSECONDS, row) for row in rows if not row.is_second]
    feet = []
    for number, name in enumerate(gait.feet):
        foot = FootLandings(machine, gait, number, [one for one in landings if one[1].foot == name], [])
        begun = [begin for begin, _ in foot.spans(gait.true_stances) if begin > 0.0]
        for time, row in foot.rows:
            if (error := row.time_errors[-1]) is not None:
                landed = min(begun, key=lambda begin: abs(begin - time - error), default=time)
                foot.errors.append((landed, 1e3 * (time + error - landed)))
        feet.append(foot)
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
        what = "true" if any(foot.gait.true_stances for foot in feet) else "inferred"
        errors.set_title(f"Predicted less {what} time of each landing, as predicted {1e3 * AHEAD:.0f} ms before")
        errors.axhline(0.0, color=GREY, linewidth=1.0)
        if what == "true":
            period = max(1e3 * foot.length / max(1, foot.gait.samples - 1) for foot in feet)
            said = f"no error: the record tells a landing up to one sample ({period:.3g} ms) late"
            errors.axhspan(-period, 0.0, color="#eeeeee", zorder=0, label=said)
        speeds.set_title("Speed of the foot in its last sample in the air")
        bounds = ", ".join(sorted({row.bound for foot in feet for _, row in foot.rows if row.bound}))
        said = f" ({bounds})" if bounds else ""
        impulses.set_title(f"Impulse that it gets where it lands with that speed{said}")
        for foot in feet:
            fast = [(time, row.landing_speed) for time, row in foot.rows if row.landing_speed is not None]
            hard = [(time, hypot(*row.impulse)) for time, row in foot.rows if row.impulse]
            for axes, values, unit in ((errors, foot.errors, "ms"), (speeds, fast, "m/s"), (impulses, hard, "N s")):
                points = np.reshape(values, (-1, 2)).T
                axes.vlines(points[0], 0.0, points[1], color=foot.colour, linewidth=1.0, alpha=0.7)
                axes.plot(*points, "o", color=foot.colour, markersize=4)
                axes.set_ylabel(unit)
        impulses.set(xlabel="time (s)", xlim=(0.0, max((foot.length for foot in feet), default=0.0) or 1.0))
        common_legend(figure)


def _draw_stances(axes: Axes, feet: Sequence[FootLandings]) -> None:
    axes.set_title("When each foot stands")
    for row, foot in enumerate(feet):
        if true := foot.spans(foot.gait.true_stances):
            axes.broken_barh(true, (row - 0.39, 0.78), color="#d0d0d0", label="stands, as the record tells")
        label = "stands, as inferred from its motion"
        axes.broken_barh(foot.spans(foot.gait.stances), (row - 0.21, 0.42), color=foot.colour, label=label)
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
    landings, ahead = counted(sum(len(foot.rows) for foot in feet), "landing"), f"predicted {1e3 * AHEAD:.0f} ms ahead"
    spread = spread_of([abs(error) for foot in feet for _, error in foot.errors])
    if not spread.number:
        return f"{landings}, none {ahead}"
    return (
        f"{landings}, {spread.number} {ahead}, half of them within {spread.p50:.1f} ms, 90 % within {spread.p90:.1f} ms"
    )
