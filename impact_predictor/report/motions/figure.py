"""Fig. 2 of the paper for any bodies that rock: angular velocity and angle against time, and on which contacts."""

from __future__ import annotations

import os
from collections.abc import Sequence
from math import degrees
from typing import Final, NamedTuple

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ...mechanics.rocking import End, Run
from ...scenarios.rocking import Rocking
from ..figure import STYLE, check_figure, save_figure

COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
"""One for each body, in turn; of Okabe and Ito, which people of any colour vision tell apart."""

CONTACTS: Final = {
    "turns about A": "#6ea6d8",
    "turns about A, which slips": "#c9dff2",
    "turns about B": "#ef9a5d",
    "turns about B, which slips": "#fbdcc0",
    "slides on both": "#8cc98c",
    "rests": "#d4d4d4",
    "flies": "#ffffff",
}
"""How a body stands, and a colour for it that black letters are read on."""

_POINTS: Final = 1500
"""Points of a curve that is as long as the picture."""
_BAR: Final = 0.64


class Curve(NamedTuple):
    """A motion drawn: times in s, angular velocities in rad/s (a gap at each impact) and angles in degrees."""

    time: NDArray[np.float64]
    omega: NDArray[np.float64]
    angle: NDArray[np.float64]


def write_motion_figure(path: str | os.PathLike[str], rockings: Sequence[Rocking]) -> None:
    """Draw motions side by side into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_figure(path)
    with matplotlib.rc_context(STYLE):
        bars = 0.24 + 0.24 * len(rockings)
        figure = Figure(figsize=(9.0, 5.4 + bars), layout="constrained")
        FigureCanvasAgg(figure)
        upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=(2.7, 2.7, bars))
        end = end_of(rockings)
        for rocking, colour in zip(rockings, colours(len(rockings)), strict=True):
            _draw_curves(upper, middle, rocking, colour, end)
        upper.set_title(title_of(rockings), fontweight="bold")
        upper.set_ylabel("ω (rad/s)")
        middle.set_ylabel("φ (degrees)")
        for axes in (upper, middle):
            axes.axhline(0.0, color="#666666", linewidth=0.8, zorder=1)
        upper.legend(loc="lower right" if _falls_forwards(rockings) else "upper right")
        _draw_bars(lower, rockings, end)
        lower.set(xlim=(0.0, end), xlabel="time (s)")
        save_figure(figure, path)


def title_of(rockings: Sequence[Rocking]) -> str:
    """What moves, in words."""
    rocker, run = rockings[0]
    bodies = f"{rocker.name}s" if len(rockings) > 1 else f"a {rocker.name}, {rocker.label},"
    return f"Angular velocity and angle of {bodies} released at {degrees(run.state(0.0).angle):.3g}°"


def end_of(rockings: Sequence[Rocking]) -> float:
    """Where the time axis ends: a little after the last motion."""
    return 1.06 * max(rocking.run.time for rocking in rockings) or 1.0


def curve_of(run: Run, points: int = _POINTS, end: float | None = None) -> Curve:
    """The motion up to `end` in s (its own unless given), in `points` for that time; it stays where it has ended."""
    end = run.time if end is None else end
    times: list[NDArray[np.float64]] = []
    for phase in run.phases:
        if phase.end > phase.start:
            count = max(2, round(points * (phase.end - phase.start) / end))
            # Right before the impact that ends it.
            last = np.nextafter(phase.end, phase.start)
            times += [np.linspace(phase.start, last, count), np.array([np.nan])]
    if end > run.time:
        times.append(np.array([run.time, end]))
    time = np.concatenate(times) if times else np.array([0.0, end])
    states = run.state(np.nan_to_num(time))
    gap = np.where(np.isnan(time), np.nan, 0.0)
    return Curve(time, states.omega + gap, np.degrees(states.angle) + gap)


def stances(run: Run, end: float) -> list[tuple[float, float, str]]:
    """Begin and end (s) of how a run stands on its contacts, one after the other, until `end`."""
    found: list[tuple[float, float, str]] = []
    for phase in run.phases:
        name = stance_of(phase.states)
        if found and found[-1][2] == name:
            found[-1] = found[-1][0], phase.end, name
        else:
            found.append((phase.start, phase.end, name))
    if run.end is End.RESTS:
        found.append((run.time, end, "rests"))
    return found


def stance_of(states: str) -> str:
    """A name of `CONTACTS` for contact states such as "SO"."""
    old, new = tuple(states)
    if old == new == "O":
        return "flies"
    if new == "O":
        return "turns about A" if old == "S" else "turns about A, which slips"
    if old == "O":
        return "turns about B" if new == "S" else "turns about B, which slips"
    return "rests" if old == new == "S" else "slides on both"


def colours(count: int) -> list[str]:
    return [COLOURS[k % len(COLOURS)] for k in range(count)]


def _falls_forwards(rockings: Sequence[Rocking]) -> bool:
    return bool(rockings[0].run.state(0.0).angle > 0.0)


def _draw_curves(upper: Axes, middle: Axes, rocking: Rocking, colour: str, end: float) -> None:
    curve = curve_of(rocking.run, end=end)
    upper.plot(curve.time, curve.omega, color=colour, linewidth=1.8, label=rocking.rocker.label)
    middle.plot(curve.time, curve.angle, color=colour, linewidth=1.8)
    for strike in rocking.run.impacts:
        rates = strike.before.omega, strike.after.omega
        upper.plot([strike.time] * 2, rates, color=colour, linewidth=0.9, linestyle=(0, (2, 2)))
    for passed in rocking.run.accumulations:
        upper.plot(passed.time, 0.0, "o", color=colour, markersize=5, zorder=4, clip_on=False)


def _draw_bars(axes: Axes, rockings: Sequence[Rocking], end: float) -> None:
    seen: dict[str, None] = {}
    for row, (rocking, colour) in enumerate(zip(rockings, colours(len(rockings)), strict=True)):
        for begin, until, name in stances(rocking.run, end):
            if until - begin > end / (4.0 * _POINTS):
                seen[name] = None
                edge = "#888888" if name == "flies" else "none"
                axes.barh(row, until - begin, _BAR, begin, color=CONTACTS[name], edgecolor=edge, linewidth=0.6)
        axes.plot([-0.012 * end] * 2, [row - 0.5 * _BAR, row + 0.5 * _BAR], color=colour, linewidth=4.0, clip_on=False)
    axes.set(yticks=[], ylim=(len(rockings) - 0.5, -0.5))
    axes.spines["left"].set_visible(False)
    axes.grid(False)
    handles: list[Artist] = [
        Patch(facecolor=CONTACTS[name], edgecolor="#888888", linewidth=0.4, label=name) for name in seen
    ]
    if any(rocking.run.accumulations for rocking in rockings):
        handles.append(Line2D([], [], color="#333333", linestyle="", marker="o", label="impacts accumulate"))
    says = "A: the contact behind the mass centre, B: ahead of it"
    axes.figure.legend(handles=handles, loc="outside lower center", ncols=4, title=says, title_fontsize=9)
