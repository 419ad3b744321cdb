"""A rolling wheel as pictures: where it was, how fast it turned and on which spokes it stood, and a film of it."""

from __future__ import annotations

import os
from math import copysign, cos, degrees, inf, sin
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..mechanics.types import Mode
from ..scenarios.wheel import RollEnd, Rolling, Stand, Wheel
from ..scenarios.wheel_closed_forms import downhill, least_friction, steady
from .film import (
    LINE,
    STRUCK,
    SUPPORT,
    Curve,
    Film,
    Flash,
    Outline,
    View,
    box,
    frames_of,
    gapped,
    placed,
    speed_for,
    turned,
)
from .modes import MODES, PALETTE
from .plot import GREY, Axes, Line2D, Patch, draw_phases, picture

STANCES: Final = {
    "stands on a spoke": "#6ea6d8",
    "on a spoke that slips": "#f2b84b",
    "slides on two": "#8cc98c",
    "rests on two": "#d4d4d4",
}
"""How a wheel stands, and a colour for it that black letters are read on."""

HUB, FIRST = PALETTE[:2]
_SPOKE: Final = "#b5c1cd"
_POINTS: Final = 2000
_SEEN: Final = 5.6
"""Metres of slope, in lengths of a spoke, that are seen of a motion that goes on for longer."""
_WIDE: Final = 5.2
"""Width of what the film shows of the slope, in lengths of a spoke."""
_STEADY: Final = "steady rolling without slip, before and after an impact"


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
    time = gapped(zip([0.0, *strikes], [*strikes, rolling.time], strict=True), points, rolling.time)
    time = time if len(time) else np.array([0.0])
    omega = -rolling.world(np.nan_to_num(time)).omega
    return time, np.where(np.isnan(time), np.nan, omega)


def steady_rates(wheel: Wheel) -> tuple[float, ...]:
    """Rates ahead (rad/s) before and after each impact of steady rolling without slip; none where there is no such."""
    down = downhill(wheel)
    rolls = steady(down)
    if rolls is None or least_friction(down) == inf:
        return ()
    return tuple(copysign(rate, wheel.hub.slope) for rate in (rolls.before, rolls.after))


def ground_of(wheel: Wheel, left: float, right: float) -> NDArray[np.float64]:
    """The outline of the slope between two places along it, in m."""
    return turned(box(left, right, -0.06 * wheel.hub.leg, 0.0), -wheel.hub.slope)


def write_wheel_figure(path: str | os.PathLike[str], rolling: Rolling) -> None:
    """Draw a rolling motion into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    with picture(path, 9.0, 8.2) as figure:
        upper, middle, lower = figure.subplots(3, 1, height_ratios=(3.1, 2.6, 0.9))
        middle.sharex(lower)
        _draw_wheels(upper, rolling)
        _draw_rate(middle, rolling)
        _draw_stances(lower, rolling)


def _draw_wheels(axes: Axes, rolling: Rolling) -> None:
    """The wheel at its impacts, as far as it can be seen."""
    wheel, leg = rolling.wheel, rolling.wheel.hub.leg
    struck = {one.strike.time: one.new for one in rolling.impacts}
    way = {time: rolling.world(time).x for time in (0.0, *struck, rolling.time)}
    seen = [time for time in way if abs(way[time] - way[0.0]) <= _SEEN * leg]
    path = rolling.world(np.linspace(0.0, max(seen), 400))
    axes.plot(path.x, path.y, color=HUB, linewidth=1.6, zorder=3)
    drawn: list[float] = []
    for time in seen:
        # Impacts on the way back and at the end lie over each other.
        if any(abs(way[time] - other) < 0.2 * wheel.step for other in drawn):
            continue
        drawn.append(way[time])
        state = rolling.world(time)
        tips, stood = placed(np.array(wheel.tips), state), {tip for tip, _ in rolling.stood(time)}
        for k, (x, y) in enumerate(tips):
            colour = FIRST if k == 0 else LINE if k in stood else _SPOKE
            axes.plot([state.x, x], [state.y, y], color=colour, linewidth=1.8 if k in stood else 1.1)
        axes.plot(state.x, state.y, "o", color=HUB, markersize=5, zorder=4)
        if time in struck:
            axes.plot(*tips[struck[time]], "o", color=STRUCK, markersize=5, zorder=5)
    axes.fill(*ground_of(wheel, min(drawn) - 1.1 * leg, max(drawn) + 1.1 * leg).T, color=SUPPORT, linewidth=0.0)
    axes.set_aspect("equal")
    axes.set_axis_off()
    more = "" if max(seen) == rolling.time else f", its first {max(seen):.2g} s"
    axes.set_title(title_of(wheel) + more, fontweight="bold")
    handles = [
        Line2D([], [], color=HUB, marker="o", markersize=5, label="hub"),
        Line2D([], [], color=LINE, linewidth=1.8, label="spoke that stands"),
        Line2D([], [], color=FIRST, linewidth=1.8, label="spoke 0"),
        Line2D([], [], color=STRUCK, linestyle="", marker="o", markersize=5, label="spoke that strikes"),
    ]
    axes.legend(handles=handles, loc="upper right", ncols=4, bbox_to_anchor=(1.0, 1.04))


def _draw_rate(axes: Axes, rolling: Rolling) -> None:
    axes.plot(*rate_of(rolling), color=HUB, linewidth=1.6, label="simulated")
    strikes: dict[Mode, list[tuple[float, float]]] = {}
    for _, _, strike in rolling.impacts:
        before, after = -strike.before.omega, -strike.after.omega
        axes.plot([strike.time] * 2, [before, after], color=HUB, linewidth=0.8, linestyle=":")
        strikes.setdefault(strike.outcome.mode, []).append((strike.time, after))
    for mode, places in strikes.items():
        axes.plot(
            *zip(*places, strict=True),
            MODES[mode].marker,
            color=STRUCK,
            markersize=6,
            zorder=4,
            label=f"after an impact: {mode.name}",
        )
    for number, level in enumerate(steady_rates(rolling.wheel)):
        label = None if number else _STEADY
        axes.axhline(level, color="#555555", linewidth=0.9, linestyle=(0, (5, 3)), zorder=1, label=label)
    axes.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)
    axes.set_ylabel("rate ahead (rad/s)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.28 * (high - low))
    axes.legend(loc="upper right", ncols=2)
    axes.tick_params(labelbottom=False)


def _draw_stances(axes: Axes, rolling: Rolling) -> None:
    end = 1.03 * rolling.time or 1.0
    shown = [stand for stand in stances(rolling, end) if stance_of(stand)]
    draw_phases(axes, 0.0, [(one.start, one.end, stance_of(one)) for one in shown], STANCES, 0.7)
    for one in shown:
        label = "+".join(str(tip) for tip, _ in one.tips)
        if one.end - one.start > 0.018 * len(label) * end:
            axes.text(0.5 * (one.start + one.end), 0.0, label, ha="center", va="center", fontsize=9)
    axes.set(yticks=[], ylim=(-0.5, 0.5), xlim=(0.0, end), xlabel="time (s)")
    axes.set_ylabel("stands on\nspoke", rotation=0, ha="right", va="center")
    axes.spines["left"].set_visible(False)
    axes.grid(False)
    handles = [Patch(facecolor=STANCES[name], label=name) for name in dict.fromkeys(map(stance_of, shown))]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.62), ncols=4)


def wheel_film(rolling: Rolling) -> Film:
    """The film of a wheel, seen by a camera that goes along with it, and its rate."""
    scene = WheelScene(rolling)
    levels = steady_rates(rolling.wheel)
    return Film(
        title=title_of(rolling.wheel),
        rows=[[View("", scene.window, scene.outlines, scene.caption, scene.flashes())]],
        heights=[3.3],
        curves=[Curve(*rate_of(rolling), HUB)],
        curves_title="rate ahead (rad/s) against time (s)" + (f"; dashed: {_STEADY}" if levels else ""),
        speed=speed_for(rolling.time),
        times=frames_of(rolling.time),
        levels=levels,
    )


class WheelScene:
    """A wheel on its slope, which goes by with marks on it."""

    def __init__(self, rolling: Rolling) -> None:
        """Take a motion."""
        self._rolling, self._leg = rolling, rolling.wheel.hub.leg
        self._times = np.linspace(0.0, rolling.time, _POINTS)
        self._way = np.array(rolling.world(self._times)[:2]).T
        self._stances = stances(rolling, rolling.time)

    def window(self, time: float) -> tuple[float, float, float, float]:
        """What the camera sees: the hub is in the middle."""
        state, half = self._rolling.world(min(time, self._rolling.time)), 0.5 * _WIDE * self._leg
        return state.x - half, state.x + half, state.y - 1.35 * self._leg, state.y + 1.15 * self._leg

    def outlines(self, time: float) -> list[Outline]:
        """What is seen at a time in s."""
        time = min(time, self._rolling.time)
        wheel, state, stood = self._rolling.wheel, self._rolling.world(time), self._rolling.stood(time)
        centre, standing = np.array([(state.x, state.y)]), {tip for tip, _ in stood}
        slope, reach = wheel.hub.slope, _WIDE * self._leg
        along = state.x * cos(slope) - state.y * sin(slope)
        shown = [Outline(ground_of(wheel, along - reach, along + reach), SUPPORT, size=0.0)]
        # A mark each half a spoke shows how the slope goes by.
        marks = 0.5 * self._leg * np.arange(int(2.0 * (along - reach) / self._leg), 2.0 * (along + reach) / self._leg)
        depths = np.tile([0.0, -0.06 * self._leg, np.nan], len(marks))
        shown.append(Outline(turned(np.column_stack([np.repeat(marks, 3), depths]), -slope), edge="#7d766b", size=1.2))
        shown.append(Outline(self._way[self._times <= time], edge=HUB, size=1.0))
        loaded = STANCES["on a spoke that slips"] if any(how != "S" for _, how in stood) else LINE
        for k, tip in enumerate(placed(np.array(wheel.tips), state)):
            colour = loaded if k in standing else FIRST if k == 0 else _SPOKE
            spoke = np.concatenate([centre, tip[None]])
            shown.append(Outline(spoke, edge=colour, size=4.0 if k in standing else 2.0))
        return [*shown, Outline(centre, HUB, HUB, 9.0, "o")]

    def caption(self, time: float) -> tuple[str, str]:
        """How it stands."""
        name = next((stance_of(one) for one in reversed(self._stances) if one.start <= time), "")
        return name, STANCES.get(name, "none")

    def flashes(self) -> list[Flash]:
        """Its impacts, seen where their spokes are."""
        found = []
        for number, (_, new, strike) in enumerate(self._rolling.impacts, 1):
            place = placed(np.array(self._rolling.wheel.tips), self._rolling.world(strike.time))[new]
            said = f"impact {number}: {strike.outcome.mode.name}"
            found.append(Flash(strike.time, said, place))
        return found
