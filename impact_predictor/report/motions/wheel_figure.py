"""A rolling wheel in one picture: where it was, how fast it turned, and which spokes it stood on."""

from __future__ import annotations

import os
from math import copysign, cos, degrees, inf, sin
from typing import Final

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ...mechanics.motion import PlanarState
from ...mechanics.types import Mode
from ...scenarios.wheel import RollEnd, Rolling, Stand, Wheel
from ...scenarios.wheel_closed_forms import downhill, least_friction, steady
from ..figure import MODE_MARKERS, STYLE, check_figure, save_figure
from .figure import COLOURS

STANCES: Final = {
    "stands on a spoke": "#6ea6d8",
    "on a spoke that slips": "#f2b84b",
    "slides on two": "#8cc98c",
    "rests on two": "#d4d4d4",
}
"""How a wheel stands, and a colour for it that black letters are read on."""

SPOKE, LEG, FIRST, GROUND, STRUCK = "#c3ced9", "#33475b", "#d55e00", "#b5ada0", "#d62728"

_POINTS: Final = 2000
_SEEN: Final = 5.6
"""Metres of slope, in lengths of a spoke, that are seen of a motion that goes on for longer."""


def write_wheel_figure(path: str | os.PathLike[str], rolling: Rolling) -> None:
    """Draw a rolling motion into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_figure(path)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 8.2), layout="constrained")
        FigureCanvasAgg(figure)
        upper, middle, lower = figure.subplots(3, 1, height_ratios=(3.1, 2.6, 0.9))
        middle.sharex(lower)
        _draw_wheels(upper, rolling)
        _draw_rate(middle, rolling)
        _draw_stances(lower, rolling)
        save_figure(figure, path)


def title_of(wheel: Wheel) -> str:
    """The wheel in words."""
    hub = wheel.hub
    grip = "that does not slip" if hub.friction >= 50.0 else f"with friction {hub.friction:g}"
    return f"A rimless wheel of {wheel.spokes} spokes {grip} on a slope of {degrees(hub.slope):.3g}°"


def stance_of(stand: Stand) -> str:
    """A name of `STANCES`; none in flight."""
    if len(stand.tips) == 2:
        return "rests on two" if all(state == "S" for _, state in stand.tips) else "slides on two"
    if not stand.tips:
        return ""
    return "stands on a spoke" if stand.tips[0][1] == "S" else "on a spoke that slips"


def stances(rolling: Rolling, end: float) -> list[Stand]:
    """How the wheel stands until `end` (s), stretches on the same spokes in one; a wheel that rests stays so."""
    found: list[Stand] = []
    for stand in rolling.stands:
        if found and found[-1].tips == stand.tips:
            stand = found.pop()._replace(end=stand.end)
        found.append(stand)
    if rolling.end in (RollEnd.RESTS, RollEnd.BALANCED) and end > rolling.time:
        found.append(Stand(rolling.time, end, rolling.stood(rolling.time)))
    return found


def rate_of(rolling: Rolling, points: int = _POINTS) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (s) and rates of turning ahead (rad/s), with a gap at each impact."""
    strikes = [one.strike.time for one in rolling.impacts]
    times: list[NDArray[np.float64]] = []
    for start, end in zip([0.0, *strikes], [*strikes, rolling.time], strict=True):
        if end > start:
            count = max(2, round(points * (end - start) / rolling.time))
            times += [np.linspace(start, np.nextafter(end, start), count), np.array([np.nan])]
    time = np.concatenate(times) if times else np.array([0.0])
    omega = -rolling.world(np.nan_to_num(time)).omega
    return time, np.where(np.isnan(time), np.nan, omega)


def steady_rates(wheel: Wheel) -> tuple[float, ...]:
    """Rates ahead (rad/s) before and after each impact of steady rolling without slip; none where there is no such."""
    down = downhill(wheel)
    rolls = steady(down)
    if rolls is None or least_friction(down) == inf:
        return ()
    return tuple(copysign(rate, wheel.hub.slope) for rate in (rolls.before, rolls.after))


def spokes_of(wheel: Wheel, state: PlanarState) -> NDArray[np.float64]:
    """Tips (spokes, 2) of a wheel in the frame in which its state is given."""
    c, s = cos(state.angle), sin(state.angle)
    return np.asarray(np.array([state.x, state.y]) + np.array(wheel.tips) @ np.array([[c, s], [-s, c]]))


def draw_ground(axes: Axes, wheel: Wheel, left: float, right: float) -> None:
    """The slope between two places along it, in m."""
    c, s, depth = cos(wheel.hub.slope), sin(wheel.hub.slope), 0.06 * wheel.hub.leg
    corners = [(left, 0.0), (right, 0.0), (right, -depth), (left, -depth)]
    axes.fill(*zip(*[(c * x + s * y, c * y - s * x) for x, y in corners], strict=True), color=GROUND, linewidth=0.0)


def _draw_wheels(axes: Axes, rolling: Rolling) -> None:
    """The wheel at its impacts, as far as it can be seen."""
    wheel, leg = rolling.wheel, rolling.wheel.hub.leg
    strikes = [one.strike.time for one in rolling.impacts]
    way = {time: rolling.world(time).x for time in (0.0, *strikes, rolling.time)}
    seen = [time for time in way if abs(way[time] - way[0.0]) <= _SEEN * leg]
    last = max(seen)
    times = np.linspace(0.0, last, 400)
    path = rolling.world(times)
    axes.plot(path.x, path.y, color=COLOURS[0], linewidth=1.6, zorder=3)
    # Impacts on the way back and at the end lie over each other.
    drawn: list[float] = []
    for time in seen:
        if any(abs(way[time] - other) < 0.2 * wheel.step for other in drawn):
            continue
        drawn.append(way[time])
        state = rolling.world(time)
        tips, stood = spokes_of(wheel, state), {tip for tip, _ in rolling.stood(time)}
        for k, tip in enumerate(tips):
            colour = FIRST if k == 0 else LEG if k in stood else SPOKE
            axes.plot(*zip((state.x, state.y), tip, strict=True), color=colour, linewidth=1.8 if k in stood else 1.1)
        axes.plot(state.x, state.y, "o", color=COLOURS[0], markersize=5, zorder=4)
        struck = next((one for one in rolling.impacts if one.strike.time == time), None)
        if struck is not None:
            axes.plot(*tips[struck.new], "o", color=STRUCK, markersize=5, zorder=5)
    draw_ground(axes, wheel, min(drawn) - 1.1 * leg, max(drawn) + 1.1 * leg)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_axis_off()
    more = "" if last == rolling.time else f", its first {last:.2g} s"
    axes.set_title(title_of(wheel) + more, fontweight="bold")
    handles = [
        Line2D([], [], color=COLOURS[0], marker="o", markersize=5, label="hub"),
        Line2D([], [], color=LEG, linewidth=1.8, label="spoke that stands"),
        Line2D([], [], color=FIRST, linewidth=1.8, label="spoke 0"),
        Line2D([], [], color=STRUCK, linestyle="", marker="o", markersize=5, label="spoke that strikes"),
    ]
    axes.legend(handles=handles, loc="upper right", ncols=4, bbox_to_anchor=(1.0, 1.04))


def _draw_rate(axes: Axes, rolling: Rolling) -> None:
    time, omega = rate_of(rolling)
    axes.plot(time, omega, color=COLOURS[0], linewidth=1.6)
    modes: dict[Mode, str] = {}
    for _, _, strike in rolling.impacts:
        rates = -strike.before.omega, -strike.after.omega
        marker = modes.setdefault(strike.outcome.mode, MODE_MARKERS.get(strike.outcome.mode, "x"))
        axes.plot([strike.time] * 2, rates, color=COLOURS[0], linewidth=0.8, linestyle=":")
        axes.plot(strike.time, rates[1], marker, color=STRUCK, markersize=6, zorder=4)
    steadily = steady_rates(rolling.wheel)
    handles = [Line2D([], [], color=COLOURS[0], linewidth=1.6, label="simulated")]
    for mode, marker in modes.items():
        name = f"after an impact: {mode.name}"
        handles.append(Line2D([], [], color=STRUCK, linestyle="", marker=marker, label=name))
    if steadily:
        for value in steadily:
            axes.axhline(value, color="#555555", linewidth=0.9, linestyle=(0, (5, 3)), zorder=1)
        name = "steady rolling without slip, before and after an impact"
        handles.append(Line2D([], [], color="#555555", linewidth=0.9, linestyle=(0, (5, 3)), label=name))
    axes.axhline(0.0, color="#666666", linewidth=0.8, zorder=1)
    axes.set_ylabel("rate ahead (rad/s)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.28 * (high - low))
    axes.legend(handles=handles, loc="upper right", ncols=2)
    axes.tick_params(labelbottom=False)


def _draw_stances(axes: Axes, rolling: Rolling) -> None:
    end = 1.03 * rolling.time or 1.0
    names: dict[str, None] = {}
    for stand in stances(rolling, end):
        name = stance_of(stand)
        if not name:
            continue
        names[name] = None
        axes.barh(
            0.0, stand.end - stand.start, 0.7, stand.start, color=STANCES[name], edgecolor="#ffffff", linewidth=0.6
        )
        label = "+".join(str(tip) for tip, _ in stand.tips)
        if stand.end - stand.start > 0.018 * len(label) * end:
            axes.text(0.5 * (stand.start + stand.end), 0.0, label, ha="center", va="center", fontsize=9)
    axes.set(yticks=[], ylim=(-0.5, 0.5), xlim=(0.0, end), xlabel="time (s)")
    axes.set_ylabel("stands on\nspoke", rotation=0, ha="right", va="center")
    axes.spines["left"].set_visible(False)
    axes.grid(False)
    handles = [Patch(facecolor=STANCES[name], label=name) for name in names]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.62), ncols=4)
