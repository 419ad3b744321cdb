"""Bodies that rock and wheels that roll, as pictures (Fig. 2 of the paper for any of them) and as films."""

from __future__ import annotations

import os
from collections.abc import Sequence
from math import copysign, cos, degrees, hypot, inf, sin
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanics.motion import End, PlanarState, RockingImpact, Trajectory
from ..scenarios.rocking import Rocking
from ..scenarios.wheel import RollEnd, Rolling, Stand, Wheel
from ..scenarios.wheel_closed_forms import downhill, least_friction, steady
from .modes import MODES, PALETTE
from .plot import (
    BODY,
    CLOSED,
    LINE,
    OPEN,
    SLIPS,
    STRUCK,
    SUPPORT,
    Band,
    Curve,
    Film,
    Flash,
    Line2D,
    Outline,
    Panel,
    View,
    box,
    circle,
    draw_outline,
    draw_panels,
    frames_of,
    gapped,
    patches,
    picture,
    placed,
    speed_for,
    turned,
)

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
STANCES: Final = {
    "stands on a spoke": "#6ea6d8",
    "on a spoke that slips": "#f2b84b",
    "slides on two": "#8cc98c",
    "rests on two": "#d4d4d4",
}
"""The same of a wheel."""

HUB, FIRST = PALETTE[:2]
_SPOKE: Final = "#b5c1cd"
_POINTS: Final = 2000
"""Points of a curve that is as long as the picture."""
_LOOKS: Final = 400
"""Moments of a motion at which its extent is looked at."""
_POST: Final = 0.05
"""Half the width of a post's top; a body that reaches below its contacts by more stands on posts. In their distance."""
_HIGHEST: Final = 3.4
"""Inches of the film that a body may be high."""
_SEEN: Final = 5.6
"""Metres of slope, in lengths of a spoke, that are seen of a motion that goes on for longer."""
_WIDE: Final = 5.2
"""Width of what the film shows of the slope, in lengths of a spoke."""


class MotionCurves(NamedTuple):
    """A motion drawn: times in s, angular velocities in rad/s (a gap at each impact) and angles in degrees."""

    time: NDArray[np.float64]
    omega: NDArray[np.float64]
    angle: NDArray[np.float64]


def curves_of(run: Trajectory, end: float) -> MotionCurves:
    """The motion up to `end` in s; it stays where it has ended."""
    time = gapped(((phase.start, phase.end) for phase in run.phases), _POINTS, end)
    time = np.concatenate([time, np.linspace(min(run.time, end), end, 100)])
    states = run.state(np.nan_to_num(time))
    gap = np.where(np.isnan(time), np.nan, 0.0)
    return MotionCurves(time, states.omega + gap, np.degrees(states.angle) + gap)


def jumps_of(strikes: Sequence[RockingImpact], colour: str, sign: float = 1.0) -> Curve:
    """Dotted lines from the angular velocities before impacts to those after them, times a sign."""
    time = [part for one in strikes for part in (one.time, one.time, np.nan)]
    rate = [part for one in strikes for part in (sign * one.before.omega, sign * one.after.omega, np.nan)]
    return Curve(np.array(time), np.array(rate), colour, style=":", width=0.9)


def stances(run: Trajectory, end: float) -> list[tuple[float, float, str]]:
    """Begin and end (s) of how a run stands on its contacts, one after the other, until `end`."""
    found: list[tuple[float, float, str]] = []
    for phase in run.phases:
        name = stance_of(phase.states)
        begin = found.pop()[0] if found and found[-1][2] == name else phase.start
        found.append((begin, phase.end, name))
    if run.end is End.RESTS:
        found.append((run.time, end, "rests"))
    return found


def stance_of(states: str) -> str:
    """A name of `CONTACTS` for contact states such as "SO"."""
    if "O" not in states:
        return "rests" if states == "SS" else "slides on both"
    if states == "OO":
        return "flies"
    name, how = ("A", states[0]) if states[1] == "O" else ("B", states[1])
    return f"turns about {name}" + ("" if how == "S" else ", which slips")


def end_of(rockings: Sequence[Rocking]) -> float:
    """Where the time axis ends: a little after the last motion."""
    return 1.06 * max(rocking.run.time for rocking in rockings) or 1.0


def rocking_panels(rockings: Sequence[Rocking]) -> list[Panel]:
    """Angular velocities, angles and contacts of motions against time."""
    end, rates, angles = end_of(rockings), list[Curve](), list[Curve]()
    bands = []
    for k, (rocker, run) in enumerate(rockings):
        colour, drawn = PALETTE[k % len(PALETTE)], curves_of(run, end)
        rates += [Curve(drawn.time, drawn.omega, colour, rocker.label), jumps_of(run.impacts, colour)]
        accumulated = np.array([one.time for one in run.accumulations])
        rates.append(Curve(accumulated, 0.0 * accumulated, colour, style="o"))
        angles.append(Curve(drawn.time, drawn.angle, colour))
        low, high = ((len(rockings) - k - part) / len(rockings) for part in (0.85, 0.15))
        bands.append(Band(-0.016 * end, -0.008 * end, colour, low, high))
        bands += [Band(*one[:2], CONTACTS[one[2]], low, high) for one in stances(run, end)]
    falls = rockings[0].run.state(0.0).angle > 0.0
    return [
        Panel("ω (rad/s)", rates, height=2.7, legend="lower right" if falls else "upper right"),
        Panel("φ (degrees)", angles, height=2.7),
        Panel("", bands=bands, height=0.24 + 0.24 * len(rockings)),
    ]


def write_rocking_figure(path: str | os.PathLike[str], rockings: Sequence[Rocking]) -> None:
    """Draw angular velocities, angles and contacts of motions into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    panels, end = rocking_panels(rockings), end_of(rockings)
    rocker, run = rockings[0]
    bodies = f"{rocker.name}s" if len(rockings) > 1 else f"a {rocker.name}, {rocker.label},"
    with picture(path, 9.0, panels[-1].height + 5.4) as figure:
        axes = figure.subplots(3, 1, height_ratios=[panel.height for panel in panels])
        draw_panels(axes, panels, end)
        released = f"released at {degrees(run.state(0.0).angle):.3g}°"
        axes[0].set_title(f"Angular velocity and angle of {bodies} {released}", fontweight="bold")
        axes[2].spines["left"].set_visible(False)
        seen = [name for one in rockings for begin, last, name in stances(one.run, end) if last - begin > 2e-4 * end]
        handles = patches(seen, CONTACTS)
        if any(rocking.run.accumulations for rocking in rockings):
            handles.append(Line2D([], [], color="#333333", linestyle="", marker="o", label="impacts accumulate"))
        says = "A: the contact behind the mass centre, B: ahead of it"
        figure.legend(handles=handles, loc="outside lower center", ncols=4, title=says, title_fontsize=9)


def rocking_film(rockings: Sequence[Rocking]) -> Film:
    """The film of motions side by side, all to one scale, with their angular velocities."""
    longest = max(rocking.run.time for rocking in rockings)
    scenes = [RockingScene(rocking) for rocking in rockings]
    width, height = 1.06 * np.max([scene.high - scene.low for scene in scenes], axis=0)
    return Film(
        title="",
        views=[scene.view(width, height) for scene in scenes],
        height=min(_HIGHEST, 7.0 / len(scenes) * height / width),
        panel=rocking_panels(rockings)[0]._replace(label="", title="ω (rad/s) against time (s)", legend=""),
        speed=speed_for(longest),
        times=frames_of(longest),
    )


class RockingScene:
    """A body that rocks: its outline, its contacts, what it stands on, and its impacts, turned by the slope.

    `low` and `high` are the corners of all that is ever seen, in m.
    """

    def __init__(self, rocking: Rocking) -> None:
        """Look at the whole motion, to know how much room it needs."""
        self._run, self._label = rocking.run, rocking.rocker.label
        body = rocking.rocker.body
        assert body.old is not None
        self._contacts = np.array([(body.old.x, body.old.y), (body.new.x, body.new.y)])
        self._distance = float(hypot(*(self._contacts[1] - self._contacts[0])))
        self._is_disc = not rocking.rocker.outline
        self._outline = circle(hypot(body.old.x, body.old.y)) if self._is_disc else np.array(rocking.rocker.outline)
        self._slope = float(self._run.support.motion(0.0).angle)
        moments = np.linspace(0.0, self._run.time, _LOOKS)
        states = [PlanarState(*state) for state in np.array(self._run.state(moments)).T.tolist()]
        self._supports = self._blocks() if self._is_disc else self._posts(moments, states)
        seen = np.concatenate([*(placed(self._outline, state) for state in states), *self._supports])
        seen = turned(seen, self._slope)
        self.low, self.high = seen.min(axis=0), seen.max(axis=0)

    def view(self, width: float, height: float) -> View:
        """The view of it in a window of this size in m."""
        x, y = 0.5 * (self.low + self.high)
        window = (x - 0.5 * width, x + 0.5 * width, y - 0.5 * height, y + 0.5 * height)
        flashes = []
        for number, strike in enumerate(self._run.impacts, 1):
            last = number == len(self._run.impacts)
            accumulate = last and any(one.time >= strike.time for one in self._run.accumulations)
            said = "impacts accumulate" if accumulate else f"impact {number}: {strike.outcome.mode.name}"
            place = turned(self._places(strike.before), self._slope)[strike.new]
            flashes.append(Flash(strike.time, said, place))
        return View(self._label, lambda time: window, self.outlines, self._caption, flashes)

    def outlines(self, time: float) -> list[Outline]:
        """What is seen at a time in s."""
        state = self._run.state(time)
        shown = [Outline(support, SUPPORT, size=0.0) for support in self._supports]
        shown.append(Outline(placed(self._outline, state), BODY, LINE))
        centre = np.array([(state.x, state.y)])
        if self._is_disc:  # a spoke shows how it turns
            shown.append(Outline(np.concatenate([centre, placed(self._outline[:1], state)]), edge=LINE, size=1.0))
        shown.append(Outline(centre, LINE, "none", 6.0, "P"))
        for name, place, how in zip("AB", self._places(state), self._run.states(time), strict=True):
            colour = OPEN if how == "O" else CLOSED if how == "S" else SLIPS
            below = place - (0.0, 0.13 * self._distance)
            shown.append(Outline(place[None], colour, CLOSED, 7.0, "o"))
            shown.append(Outline(below[None], LINE, "none", 7.0, f"${name}$"))
        return [one._replace(points=turned(one.points, self._slope)) for one in shown]

    def _caption(self, time: float) -> tuple[str, str]:
        stance = stance_of(self._run.states(time))
        return stance, CONTACTS[stance]

    def _places(self, state: PlanarState) -> NDArray[np.float64]:
        """Where both contacts are: points of the body, or edges of the support."""
        return self._contacts - self._contacts[0] if self._is_disc else placed(self._contacts, state)

    def _blocks(self) -> list[NDArray[np.float64]]:
        """The blocks whose edges carry a disc."""
        depth, width = 0.35 * self._distance, 0.6 * self._distance
        (ax, ay), (bx, by) = self._contacts - self._contacts[0]
        return [box(ax - width, ax, ay - depth, ay), box(bx, bx + width, by - depth, by)]

    def _posts(self, moments: NDArray[np.float64], states: Sequence[PlanarState]) -> list[NDArray[np.float64]]:
        """The floor, or what carries both contacts wherever they stand, if the body reaches below them."""
        seen = np.concatenate([placed(self._outline, state) for state in states])
        lowest, thick = float(seen[:, 1].min()), 0.08 * self._distance
        left, right = seen[:, 0].min() - 0.1 * self._distance, seen[:, 0].max() + 0.1 * self._distance
        if lowest > -_POST * self._distance:
            return [box(left, right, -thick, 0.0)]
        ground, half = lowest - 0.1 * self._distance, _POST * self._distance
        supports = [box(left, right, ground - thick, ground)]
        stood = [self._run.states(float(moment)) for moment in moments]
        for k in range(2):
            places = [
                placed(self._contacts, state)[k, 0] for state, how in zip(states, stood, strict=True) if how[k] != "O"
            ]
            if places:
                begin, end = min(places), max(places)
                top = [(begin - 0.4 * half, 0.0), (end + 0.4 * half, 0.0)]
                supports.append(np.array([*top, (end + 2.0 * half, ground), (begin - 2.0 * half, ground)]))
        return supports


def title_of(wheel: Wheel) -> str:
    """The wheel in words."""
    hub = wheel.hub
    grip = "that does not slip" if hub.friction >= 50.0 else f"with friction {hub.friction:g}"
    return f"A rimless wheel of {wheel.spokes} spokes {grip} on a slope of {degrees(hub.slope):.3g}°"


def wheel_stance_of(stand: Stand) -> str:
    """A name of `STANCES`; none in flight."""
    if len(stand.tips) == 2:
        return "rests on two" if all(state == "S" for _, state in stand.tips) else "slides on two"
    if not stand.tips:
        return ""
    return "stands on a spoke" if stand.tips[0][1] == "S" else "on a spoke that slips"


def wheel_stances(rolling: Rolling, end: float) -> list[Stand]:
    """How the wheel stands until `end` (s), stretches on the same spokes in one; a wheel that rests stays so."""
    found: list[Stand] = []
    for stand in rolling.stands:
        if found and found[-1].tips == stand.tips:
            stand = found.pop()._replace(end=stand.end)
        found.append(stand)
    if rolling.end in (RollEnd.RESTS, RollEnd.BALANCED) and end > rolling.time:
        found.append(Stand(rolling.time, end, rolling.stood(rolling.time)))
    return found


def rate_of(rolling: Rolling) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (s) and rates of turning ahead (rad/s), with a gap at each impact."""
    strikes = [one.strike.time for one in rolling.impacts]
    time = gapped(zip([0.0, *strikes], [*strikes, rolling.time], strict=True), _POINTS, rolling.time)
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


def wheel_panels(rolling: Rolling) -> list[Panel]:
    """The rate of a wheel and the spokes that it stands on, against time."""
    end = 1.03 * rolling.time or 1.0
    strikes = [one.strike for one in rolling.impacts]
    curves = [Curve(*rate_of(rolling), HUB, "simulated"), jumps_of(strikes, HUB, -1.0)]
    for mode in sorted({strike.outcome.mode for strike in strikes}):
        time, rate = np.array([(one.time, -one.after.omega) for one in strikes if one.outcome.mode is mode]).T
        curves.append(Curve(time, rate, MODES[mode].colour, f"after an impact: {mode.name}", MODES[mode].marker))
    for number, level in enumerate(steady_rates(rolling.wheel)):
        label = "" if number else "steady rolling without slip, before and after an impact"
        curves.append(Curve(np.array([0.0, end]), np.full(2, level), "#555555", label, "--", 0.9))
    bands = [
        Band(one.start, one.end, STANCES[name], word="+".join(str(tip) for tip, _ in one.tips))
        for one in wheel_stances(rolling, end)
        if (name := wheel_stance_of(one))
    ]
    return [
        Panel("rate ahead (rad/s)", curves, height=2.6, legend="upper right"),
        Panel("stands on\nspoke", bands=bands, height=0.9),
    ]


def write_wheel_figure(path: str | os.PathLike[str], rolling: Rolling) -> None:
    """Draw a rolling motion into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    scene, wheel, panels = WheelScene(rolling), rolling.wheel, wheel_panels(rolling)
    struck = {one.strike.time: one.new for one in rolling.impacts}
    seen = [time for time in (0.0, *struck, rolling.time) if abs(scene.way(time)) <= _SEEN * wheel.hub.leg]
    shown: list[float] = []
    for time in seen:
        # Impacts on the way back and at the end lie over each other.
        if all(abs(scene.way(time) - scene.way(other)) >= 0.2 * wheel.step for other in shown):
            shown.append(time)
    with picture(path, 9.0, 8.2) as figure:
        upper, *lower = figure.subplots(3, 1, height_ratios=(3.1, *[panel.height for panel in panels]))
        upper.set(aspect="equal")
        upper.set_axis_off()
        more = "" if max(seen) == rolling.time else f", its first {max(seen):.2g} s"
        upper.set_title(title_of(wheel) + more, fontweight="bold")
        x = [rolling.world(time).x for time in shown]
        outlines = [scene.ground(min(x) - 1.1 * wheel.hub.leg, max(x) + 1.1 * wheel.hub.leg), scene.path(max(seen))]
        for time in shown:
            outlines += scene.spokes(time, 1.1, 1.8)
        tips = [placed(np.array(wheel.tips), rolling.world(time))[struck[time]] for time in shown if time in struck]
        outlines.append(Outline(np.array(tips).reshape(-1, 2), STRUCK, STRUCK, 5.0, "o"))
        for outline in outlines:
            draw_outline(upper, outline)
        signs: tuple[tuple[str, dict[str, Any]], ...] = (
            ("hub", {"color": HUB, "marker": "o"}),
            ("spoke that stands", {"color": LINE}),
            ("spoke 0", {"color": FIRST}),
            ("spoke that strikes", {"color": STRUCK, "marker": "o", "linestyle": ""}),
        )
        handles = [Line2D([], [], label=name, **sign) for name, sign in signs]
        upper.legend(handles=handles, loc="upper right", ncols=4, bbox_to_anchor=(1.0, 1.04))
        draw_panels(lower, panels, 1.03 * rolling.time or 1.0)
        low, high = lower[0].get_ylim()
        lower[0].set_ylim(low, high + 0.28 * (high - low))  # room for the legend
        names = filter(None, map(wheel_stance_of, rolling.stands))
        figure.legend(handles=patches(names, STANCES), loc="outside lower center", ncols=4)


def wheel_film(rolling: Rolling) -> Film:
    """The film of a wheel, seen by a camera that goes along with it, and its rate."""
    scene = WheelScene(rolling)
    dashed = "; dashed: steady rolling without slip" if steady_rates(rolling.wheel) else ""
    title = f"rate ahead (rad/s) against time (s){dashed}"
    return Film(
        title=title_of(rolling.wheel),
        views=[View("", scene.window, scene.outlines, scene.caption, scene.flashes())],
        height=3.3,
        panel=wheel_panels(rolling)[0]._replace(label="", legend="", title=title),
        speed=speed_for(rolling.time),
        times=frames_of(rolling.time),
    )


class WheelScene:
    """A wheel on its slope, which goes by with marks on it."""

    def __init__(self, rolling: Rolling) -> None:
        """Take a motion."""
        self._rolling, self._leg = rolling, rolling.wheel.hub.leg
        self._slope = rolling.wheel.hub.slope
        self._times = np.linspace(0.0, rolling.time, _POINTS)
        self._hub = np.array(rolling.world(self._times)[:2]).T
        self._stances = wheel_stances(rolling, rolling.time)

    def way(self, time: float) -> float:
        """How far the hub has come at a time in s, in m to the right."""
        return float(self._rolling.world(time).x - self._hub[0, 0])

    def window(self, time: float) -> tuple[float, float, float, float]:
        """What the camera sees: the hub is in the middle."""
        state, half = self._rolling.world(min(time, self._rolling.time)), 0.5 * _WIDE * self._leg
        return state.x - half, state.x + half, state.y - 1.35 * self._leg, state.y + 1.15 * self._leg

    def outlines(self, time: float) -> list[Outline]:
        """What is seen at a time in s."""
        time = min(time, self._rolling.time)
        state, reach = self._rolling.world(time), _WIDE * self._leg
        along = state.x * cos(self._slope) - state.y * sin(self._slope)
        # A mark each half a spoke shows how the slope goes by.
        marks = 0.5 * self._leg * np.arange(int(2.0 * (along - reach) / self._leg), 2.0 * (along + reach) / self._leg)
        depths = np.tile([0.0, -0.06 * self._leg, np.nan], len(marks))
        lines = turned(np.column_stack([np.repeat(marks, 3), depths]), -self._slope)
        ground = self.ground(along - reach, along + reach)
        return [ground, Outline(lines, edge="#7d766b", size=1.2), self.path(time), *self.spokes(time, 2.0, 4.0)]

    def ground(self, left: float, right: float) -> Outline:
        """The slope between two places along it, in m."""
        return Outline(turned(box(left, right, -0.06 * self._leg, 0.0), -self._slope), SUPPORT, size=0.0)

    def path(self, time: float) -> Outline:
        """The way of the hub until a time in s."""
        return Outline(self._hub[self._times <= time], edge=HUB)

    def spokes(self, time: float, thin: float, thick: float) -> list[Outline]:
        """The spokes at a time in s, those that stand as thick lines, and the hub."""
        wheel, state, stood = self._rolling.wheel, self._rolling.world(time), self._rolling.stood(time)
        centre, standing = np.array([(state.x, state.y)]), {tip for tip, _ in stood}
        loaded = STANCES["on a spoke that slips"] if any(how != "S" for _, how in stood) else LINE
        shown = []
        for k, tip in enumerate(placed(np.array(wheel.tips), state)):
            colour = loaded if k in standing else FIRST if k == 0 else _SPOKE
            spoke = np.concatenate([centre, tip[None]])
            shown.append(Outline(spoke, edge=colour, size=thick if k in standing else thin))
        return [*shown, Outline(centre, HUB, HUB, 5.0 + thin, "o")]

    def caption(self, time: float) -> tuple[str, str]:
        """How it stands."""
        name = next((wheel_stance_of(one) for one in reversed(self._stances) if one.start <= time), "")
        return name, STANCES.get(name, "none")

    def flashes(self) -> list[Flash]:
        """Its impacts, seen where their spokes are."""
        found = []
        for number, (_, new, strike) in enumerate(self._rolling.impacts, 1):
            place = placed(np.array(self._rolling.wheel.tips), self._rolling.world(strike.time))[new]
            found.append(Flash(strike.time, f"impact {number}: {strike.outcome.mode.name}", place))
        return found
