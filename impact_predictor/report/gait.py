"""The gait diagram of machines that walk: when which foot stands, and how well its landings were predicted."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from math import hypot
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Final, NamedTuple

from ..bags.body import Gait
from ..scenarios.comparison import LEAD_TIMES
from ..stamps import NANOSECONDS
from ..wording import counted
from .modes import PALETTE
from .plot import GREY, Axes, Line2D, Patch, headline, picture
from .summary import quantile
from .touchdowns import TouchdownRow, rows_of

if TYPE_CHECKING:
    from ..bags.replay import Result

AHEAD: Final = LEAD_TIMES[-1]
"""Seconds before a landing at which the prediction is made that is shown."""

MOST: Final = 3
"""Machines in one picture."""

_SHOWN: Final = 12.0
"""Seconds of a record whose stances are shown: in more of them no stance could be told from the next."""
_LEAST: Final = 1e-3
"""Speeds (m/s) and impulses (N s) below it are none."""
_MANY: Final = 60
"""Landings of a foot above which they are drawn as dots alone."""
_TRUE: Final = "#d0d0d0"
"""Colour of the stances that a record has."""


class Machine(NamedTuple):
    """A machine in a picture, by the name of its record, or of it in its record, and the landings of its feet."""

    name: str
    gait: Gait
    landings: Sequence[TouchdownRow]


def machines_of(results: Sequence[Result]) -> list[Machine]:
    """The machines of some replays."""
    return [
        Machine(
            name=f"{Path(result.bag).name} {body}".rstrip(),
            gait=gait,
            # What follows of a foot that stands already is no landing of its own.
            landings=[
                one
                for one in rows_of(result.settled)
                if one.foot and one.body == (body or one.body) and not one.is_second
            ],
        )
        for result in results
        for body, gait in result.gaits.items()
    ]


class FootLandings(NamedTuple):
    """The landings of a foot in a picture: its colour, and their stamps in ns with what is known of each.

    `errors` (s) are those of the times that were predicted `AHEAD`, against the `true` stamps or the inferred ones.
    """

    name: str
    colour: str
    start: int
    period: float
    landings: list[TouchdownRow]
    true: list[int]

    def seconds(self, stamp: int) -> float:
        """A stamp as seconds since the beginning of the record."""
        return (stamp - self.start) / NANOSECONDS

    @property
    def errors(self) -> list[tuple[float, float]]:
        """Time and error in s of every landing that was predicted."""
        made = []
        for one in self.landings:
            if (predicted := _predicted(one)) is not None:
                stamp = min(self.true, key=lambda true: abs(true - predicted), default=one.stamp)
                made.append((self.seconds(stamp), (predicted - stamp) / NANOSECONDS))
        return made


def _predicted(landing: TouchdownRow) -> int | None:
    """The stamp in ns that was predicted `AHEAD` of a landing; None where none was so early."""
    error = landing.time_errors[-1]
    return None if error is None else landing.stamp + round(error * NANOSECONDS)


def write_gait(path: str | os.PathLike[str], machines: Sequence[Machine]) -> None:
    """Draw when the feet of machines stand, and their landings as they were predicted `AHEAD`, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    shown = machines[:MOST]
    feet = [foot for one in shown for foot in _feet(one, len(shown) > 1)]
    last = max(((one.gait.end - one.gait.begin) / NANOSECONDS for one in shown), default=0.0)
    with picture(path, 13.5, 4.8 + 0.42 * len(feet)) as figure:
        heights = (0.42 * len(feet) + 0.4, 1.2, 0.9, 0.9)
        gait, errors, speeds, impulses = figure.subplots(4, 1, height_ratios=heights)
        names = ", ".join(one.name for one in shown) + (", ..." if len(machines) > MOST else "")
        headline(figure, f"{names}: {_conclusion(feet)}")
        _draw_stances(gait, shown, feet, last)
        _draw_errors(errors, feet)
        _draw_landings(
            speeds, feet, "Speed of the foot in its last sample in the air", "m/s", lambda one: one.landing_speed
        )
        _draw_landings(
            impulses,
            feet,
            "Impulse that it gets where it lands with that speed",
            "N s",
            lambda one: one.impulse and hypot(*one.impulse),
        )
        for axes in (errors, speeds, impulses):
            axes.set_xlim(0.0, last or 1.0)
        impulses.set_xlabel("time (s)")


def _feet(machine: Machine, several: bool) -> list[FootLandings]:
    gait = machine.gait
    true = gait.true_stances
    return [
        FootLandings(
            name=f"{machine.name} {name}" if several else name,
            colour=PALETTE[foot % len(PALETTE)],
            start=gait.begin,
            period=(gait.end - gait.begin) / NANOSECONDS / max(1, gait.samples - 1),
            landings=[one for one in machine.landings if one.foot == name],
            true=sorted(one.begin for one in true if one.foot == foot and one.begin > gait.begin),
        )
        for foot, name in enumerate(gait.feet)
    ]


def _draw_stances(axes: Axes, machines: Sequence[Machine], feet: Sequence[FootLandings], last: float) -> None:
    end = min(last, _SHOWN) or 1.0
    part = f", the first {end:.0f} s of {last:.0f} s" if last > _SHOWN else ""
    axes.set_title(f"When each foot stands{part}")
    first = 0
    for machine in machines:
        gait = machine.gait
        for stances, height, of_truth in ((gait.true_stances, 0.78, True), (gait.stances, 0.42, False)):
            for stance in stances:
                row = first + stance.foot
                begins, ends = feet[row].seconds(stance.begin), min(feet[row].seconds(stance.end), end)
                if begins < end:
                    colour = _TRUE if of_truth else feet[row].colour
                    axes.barh(row, ends - begins, height, begins, color=colour, zorder=2 if of_truth else 3)
        first += len(gait.feet)
    for number, foot in enumerate(feet):
        times = [foot.seconds(stamp) for one in foot.landings if (stamp := _predicted(one)) is not None]
        shown = [time for time in times if time <= end]
        marks = axes.plot(shown, [number - 0.33] * len(shown), "v", color="black", markersize=6, zorder=4)
        # The layout takes the extent of unclipped marks for infinite where there are none.
        marks[0].set(clip_on=False, in_layout=bool(shown))
    axes.set(xlim=(0.0, end), ylim=(len(feet) - 0.5, -0.65))
    axes.set_yticks(range(len(feet)), [foot.name for foot in feet])
    axes.grid(visible=False, axis="y")
    handles = [
        Line2D([], [], linestyle="", marker="v", color="black", label=f"landing, predicted {1e3 * AHEAD:.0f} ms ahead"),
        Patch(color=feet[0].colour if feet else GREY, label="stands, as inferred from its motion"),
    ]
    if any(one.gait.true_stances for one in machines):
        handles.append(Patch(color=_TRUE, label="stands, as the record tells"))
    axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 0.99), ncols=3, borderaxespad=0.0)


def _draw_errors(axes: Axes, feet: Sequence[FootLandings]) -> None:
    knows_truth = any(foot.true for foot in feet)
    what = "true" if knows_truth else "inferred"
    axes.set_title(f"Predicted less {what} time of each landing, as predicted {1e3 * AHEAD:.0f} ms before")
    axes.set_ylabel("ms")
    axes.axhline(0.0, color=GREY, linewidth=1.0)
    if knows_truth:
        period = 1e3 * max(foot.period for foot in feet)
        axes.axhspan(-period, 0.0, color="#eeeeee", zorder=0)
        said = f"grey: no error, for the record tells a landing up to one sample ({period:.3g} ms) late"
        axes.set_title(said, loc="right", fontsize=9, color=GREY)
    for foot in feet:
        _draw_points(axes, foot, [(time, 1e3 * error) for time, error in foot.errors])
    axes.margins(y=0.15)
    if not any(foot.errors for foot in feet):
        axes.set_ylim(-1.0, 1.0)


def _draw_landings(
    axes: Axes, feet: Sequence[FootLandings], title: str, unit: str, get: Callable[[TouchdownRow], float | None]
) -> None:
    axes.set_title(title)
    axes.set_ylabel(unit)
    highest = 0.0
    for foot in feet:
        values = [(foot.seconds(one.stamp), get(one)) for one in foot.landings]
        known = [(time, value) for time, value in values if value is not None]
        _draw_points(axes, foot, known)
        highest = max([highest, *(value for _, value in known)])
    if highest < _LEAST:
        said = f"none above {_LEAST:g} {unit}" if any(foot.landings for foot in feet) else "no foot has landed"
        axes.text(0.5, 0.5, said, transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set_ylim(0.0, 1.1 * highest if highest >= _LEAST else 1.0)


def _draw_points(axes: Axes, foot: FootLandings, points: Sequence[tuple[float, float]]) -> None:
    times, values = [time for time, _ in points], [value for _, value in points]
    if len(points) <= _MANY:
        axes.vlines(times, 0.0, values, color=foot.colour, linewidth=1.2, alpha=0.7)
    axes.plot(times, values, "o", color=foot.colour, markersize=5 if len(points) <= _MANY else 2)


def _conclusion(feet: Sequence[FootLandings]) -> str:
    landings = counted(sum(len(foot.landings) for foot in feet), "landing")
    errors = [1e3 * abs(error) for foot in feet for _, error in foot.errors]
    if not errors:
        return f"{landings}, none predicted {1e3 * AHEAD:.0f} ms ahead"
    return (
        f"{landings}, {len(errors)} predicted {1e3 * AHEAD:.0f} ms ahead, "
        f"half of them within {median(errors):.1f} ms, 90 % within {quantile(errors, 0.9):.1f} ms"
    )
