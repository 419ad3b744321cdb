"""Bodies that rock, as pictures: Fig. 2 of the paper for any of them, and a film of them side by side."""

from __future__ import annotations

import os
from collections.abc import Sequence
from math import degrees, hypot
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanics.motion import End, PlanarState, Trajectory
from ..scenarios.rocking import Rocking
from .film import (
    BODY,
    CLOSED,
    LINE,
    OPEN,
    SLIPS,
    SUPPORT,
    Curve,
    Film,
    Flash,
    Outline,
    View,
    box,
    circle,
    frames_of,
    gapped,
    placed,
    speed_for,
    turned,
)
from .modes import PALETTE
from .plot import GREY, Axes, Line2D, Patch, draw_phases, picture

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
_LOOKS: Final = 400
"""Moments of a motion at which its extent is looked at."""
_POST: Final = 0.05
"""Half the width of a post's top; a body that reaches below its contacts by more stands on posts. In their distance."""
_HIGHEST: Final = 3.4
"""Inches of the film that a body may be high."""


class MotionCurves(NamedTuple):
    """A motion drawn: times in s, angular velocities in rad/s (a gap at each impact) and angles in degrees."""

    time: NDArray[np.float64]
    omega: NDArray[np.float64]
    angle: NDArray[np.float64]


def curves_of(run: Trajectory, end: float, points: int = _POINTS) -> MotionCurves:
    """The motion up to `end` in s, in `points` for that time; it stays where it has ended."""
    time = gapped(((phase.start, phase.end) for phase in run.phases), points, end)
    time = np.concatenate([time, np.linspace(min(run.time, end), end, 100)])
    states = run.state(np.nan_to_num(time))
    gap = np.where(np.isnan(time), np.nan, 0.0)
    return MotionCurves(time, states.omega + gap, np.degrees(states.angle) + gap)


def stances(run: Trajectory, end: float) -> list[tuple[float, float, str]]:
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


def end_of(rockings: Sequence[Rocking]) -> float:
    """Where the time axis ends: a little after the last motion."""
    return 1.06 * max(rocking.run.time for rocking in rockings) or 1.0


def write_rocking_figure(path: str | os.PathLike[str], rockings: Sequence[Rocking]) -> None:
    """Draw angular velocities, angles and contacts of motions into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    bars, end = 0.24 + 0.24 * len(rockings), end_of(rockings)
    with picture(path, 9.0, 5.4 + bars) as figure:
        upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=(2.7, 2.7, bars))
        for k, rocking in enumerate(rockings):
            colour = PALETTE[k % len(PALETTE)]
            curves = curves_of(rocking.run, end)
            upper.plot(curves.time, curves.omega, color=colour, linewidth=1.8, label=rocking.rocker.label)
            middle.plot(curves.time, curves.angle, color=colour, linewidth=1.8)
            for strike in rocking.run.impacts:
                rates = strike.before.omega, strike.after.omega
                upper.plot([strike.time] * 2, rates, color=colour, linewidth=0.9, linestyle=(0, (2, 2)))
            for passed in rocking.run.accumulations:
                upper.plot(passed.time, 0.0, "o", color=colour, markersize=5, zorder=4, clip_on=False)
        rocker, run = rockings[0]
        bodies = f"{rocker.name}s" if len(rockings) > 1 else f"a {rocker.name}, {rocker.label},"
        released = run.state(0.0).angle
        upper.set_title(
            f"Angular velocity and angle of {bodies} released at {degrees(released):.3g}°", fontweight="bold"
        )
        upper.set_ylabel("ω (rad/s)")
        middle.set_ylabel("φ (degrees)")
        for axes in (upper, middle):
            axes.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)
        upper.legend(loc="lower right" if released > 0.0 else "upper right")
        handles = _draw_bars(lower, rockings, end)
        lower.set(xlim=(0.0, end), xlabel="time (s)")
        says = "A: the contact behind the mass centre, B: ahead of it"
        figure.legend(handles=handles, loc="outside lower center", ncols=4, title=says, title_fontsize=9)


def _draw_bars(axes: Axes, rockings: Sequence[Rocking], end: float) -> list[Any]:
    """How each body stands against time; the entries of the legend for it."""
    seen: dict[str, None] = {}
    for row, rocking in enumerate(rockings):
        phases = [one for one in stances(rocking.run, end) if one[1] - one[0] > end / (4.0 * _POINTS)]
        seen |= dict.fromkeys(name for _, _, name in phases)
        draw_phases(axes, row, phases, CONTACTS, _BAR)
        ends = [row - 0.5 * _BAR, row + 0.5 * _BAR]
        axes.plot([-0.012 * end] * 2, ends, color=PALETTE[row % len(PALETTE)], linewidth=4.0, clip_on=False)
    axes.set(yticks=[], ylim=(len(rockings) - 0.5, -0.5))
    axes.spines["left"].set_visible(False)
    axes.grid(False)
    handles: list[Any] = [
        Patch(facecolor=CONTACTS[name], edgecolor="#888888", linewidth=0.4, label=name) for name in seen
    ]
    if any(rocking.run.accumulations for rocking in rockings):
        handles.append(Line2D([], [], color="#333333", linestyle="", marker="o", label="impacts accumulate"))
    return handles


def rocking_film(rockings: Sequence[Rocking]) -> Film:
    """The film of motions side by side, all to one scale, with their angular velocities."""
    longest, end = max(rocking.run.time for rocking in rockings), end_of(rockings)
    scenes = [RockingScene(rocking) for rocking in rockings]
    width, height = 1.06 * np.max([scene.high - scene.low for scene in scenes], axis=0)
    curves = []
    for k, rocking in enumerate(rockings):
        drawn = curves_of(rocking.run, end)
        curves.append(Curve(drawn.time, drawn.omega, PALETTE[k % len(PALETTE)]))
    return Film(
        title="",
        rows=[[scene.view(width, height) for scene in scenes]],
        heights=[min(_HIGHEST, 7.0 / len(scenes) * height / width)],
        curves=curves,
        curves_title="ω (rad/s) against time (s)",
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
            flashes.append(Flash(strike.time, said, self._places(strike.before)[strike.new]))
        return View(self._label, lambda time: window, self.outlines, self._caption, flashes, self._camera)

    def _camera(self, points: NDArray[np.float64], time: float) -> NDArray[np.float64]:
        return turned(points, self._slope)

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
            shown += [
                Outline(place[None], colour, CLOSED, 7.0, "o"),
                Outline(below[None], LINE, "none", 7, f"${name}$"),
            ]
        return shown

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
