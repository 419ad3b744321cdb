"""Bodies that rock and wheels that roll, as pictures (Fig. 2 of the paper for any of them) and as films."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from functools import partial
from math import copysign, degrees, pi, tan
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..mechanics.motion import RockingImpact, standing
from ..scenarios.as_json import rolling_as_json
from ..scenarios.rocking import Rocking
from ..scenarios.wheel import Rolling
from . import plot
from .modes import EDGE, MODES, PALETTE

CONTACT_COLOURS: Final = {"S": "#1a1a1a", "+": "#e69f00", "-": "#e69f00", "O": "#ffffff"}
"""By the state of a contact: it sticks, slips forwards or back, or is open."""
BODY: Final = "#dbe4ee"

_HUB, _FIRST = PALETTE[0], PALETTE[2]
_POINTS: Final = 2000
"""Points of a curve that is as long as the picture."""


def last_impact(impacts: Sequence[RockingImpact], time: float) -> str:
    """The last of some impacts until a time in s, in words."""
    past = [one for one in impacts if one.time <= time]
    return f"impact {len(past)}: {past[-1].outcome.mode.name}" if past else ""


def draw_contacts(axes: plot.Axes, closed: Iterable[tuple[int, float, float, str]]) -> None:
    """Draw bars while contacts are closed: the row of each, begin and end (s), and its state."""
    for row, begin, end, how in closed:
        label = "contact sticks" if how == "S" else "contact slips"
        axes.barh(row, end - begin, 0.6, begin, color=CONTACT_COLOURS[how], label=label)
    axes.grid(visible=False, axis="y")
    axes.invert_yaxis()
    axes.set_xlabel("time (s)")


def write_rocking_figure(path: str | os.PathLike[str], rockings: Sequence[Rocking]) -> None:
    """Draw angular velocities, angles and contacts of motions into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    rocker, run = rockings[0]
    bodies = f"{rocker.name}s" if len(rockings) > 1 else f"a {rocker.name}, {rocker.label},"
    with plot.picture(path, 9.0, 6.0 + 0.4 * len(rockings)) as figure:
        heights = (2.7, 2.7, 0.3 + 0.4 * len(rockings))
        rates, angles, contacts = figure.subplots(3, 1, sharex=True, height_ratios=heights)
        draw_rates(rockings, rates)
        released = f"released at {degrees(run.state(0.0).angle):.3g}°"
        rates.set_title(f"Angular velocity and angle of {bodies} {released}", fontweight="bold")
        rates.set_xlabel("")
        closed, times = [], times_of(rockings)
        for k, (_, one) in enumerate(rockings):
            angles.plot(times, np.degrees(one.state(times).angle), color=PALETTE[k % len(PALETTE)])
            # After its end a motion stays as it is.
            ends = [*[phase.start for phase in one.phases[1:]], float(times[-1])]
            for phase, end in zip(one.phases, ends, strict=True):
                closed += [(2 * k + i, phase.start, end, how) for i, how in enumerate(phase.states) if how != "O"]
        angles.set_ylabel("φ (degrees)")
        draw_contacts(contacts, closed)
        contacts.set_yticks(range(2 * len(rockings)), ["A", "B"] * len(rockings))
        for row, label in enumerate(contacts.get_yticklabels()):
            label.set(color=PALETTE[row // 2 % len(PALETTE)], fontweight="bold")
        plot.common_legend(figure, "contact A: behind the mass centre, B: ahead of it")


def times_of(rockings: Sequence[Rocking]) -> NDArray[np.float64]:
    """Times (s) of curves, until a little after the last motion."""
    return np.linspace(0.0, 1.06 * max(rocking.run.time for rocking in rockings) or 1.0, _POINTS)


def draw_rates(rockings: Sequence[Rocking], axes: plot.Axes) -> None:
    """Draw angular velocities of motions, and when impacts accumulate."""
    times = times_of(rockings)
    for k, (rocker, run) in enumerate(rockings):
        axes.plot(times, run.state(times).omega, color=PALETTE[k % len(PALETTE)], label=rocker.label)
    accumulated = [one.time for rocking in rockings for one in rocking.run.accumulations]
    if accumulated:
        axes.plot(accumulated, [0.0] * len(accumulated), "o", color=EDGE, markersize=5, label="impacts accumulate")
    axes.set(xlabel="time (s)", ylabel="ω (rad/s)", xlim=(0.0, times[-1]))


def rocking_film(rockings: Sequence[Rocking]) -> plot.Film:
    """The film of motions side by side, all to one scale, with their angular velocities."""
    scenes = [RockingScene(rocking) for rocking in rockings]
    width, height = size = np.max([scene.size for scene in scenes], axis=0)
    for scene in scenes:
        scene.size = size
    return plot.Film(
        scenes=scenes,
        height=min(3.4, 7.0 / len(scenes) * height / width),
        draw_curves=partial(draw_rates, rockings),
        times=plot.frames_of(max(rocking.run.time for rocking in rockings)),
    )


class RockingScene:
    """One of the paper's bodies on its contacts A and B; `size` (width, height) in m is seen."""

    def __init__(self, rocking: Rocking) -> None:
        """Take a motion, and look at all of it to know how much room it needs."""
        rocker, self._run = rocking
        assert rocker.body.old is not None
        self.title, self._is_disc = rocker.label, not rocker.outline
        self._contacts = np.array([(one.x, one.y) for one in (rocker.body.old, rocker.body.new)])
        turns = np.linspace(0.0, 2.0 * pi, 73)
        circle = np.linalg.norm(self._contacts[0]) * np.column_stack((np.cos(turns), np.sin(turns)))
        self._outline = circle if self._is_disc else np.array(rocker.outline)
        self._edges = plot.placed(self._contacts, standing(rocker.body, 0.0))
        states = [self._run.state(time) for time in np.linspace(0.0, self._run.time, 400).tolist()]
        bodies = [plot.placed(self._outline, state) for state in states]
        seen = self._seen(np.concatenate(bodies))
        self.size = np.ptp(seen, axis=0) + 0.15 * np.ptp(seen)
        self._middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))
        (left, floor), (right, top) = self._edges
        wide, depth = right - left, 0.1 * self.size[1]
        if self._is_disc:
            self._supports = [
                plot.box(left - 0.6 * wide, left, floor - 4.0 * depth, floor),
                plot.box(right, right + 0.6 * wide, top - 4.0 * depth, top),
            ]
            return
        # A body that reaches below its contacts stands on a table no wider than they ever are.
        places = np.array([plot.placed(self._contacts, state) for state in states])
        stood = places[..., 0][places[..., 1] < floor + 1e-3 * wide]
        beyond = 0.0 if min(one[:, 1].min() for one in bodies) < floor - 0.05 * wide else float(self.size.sum())
        self._supports = [plot.box(stood.min() - beyond, stood.max() + beyond, floor - depth, floor)]

    def draw(self, axes: plot.Axes, time: float) -> str:
        """Draw the body at a time in s; its last impact, in words."""
        state = self._run.state(time)
        for support in self._supports:
            axes.fill(*self._seen(support).T, color=plot.SUPPORT)
        outline = self._seen(plot.placed(self._outline, state))
        axes.fill(*outline.T, facecolor=BODY, edgecolor=plot.LINE, linewidth=1.3)
        centre = self._seen(np.array([(state.x, state.y)]))[0]
        axes.plot(*centre, "P", color=plot.LINE, markersize=6, markeredgewidth=0.0)
        if self._is_disc:  # a spoke shows how it turns
            axes.plot(*np.array([centre, outline[0]]).T, color=plot.LINE, linewidth=1.0)
        places = self._seen(self._edges if self._is_disc else plot.placed(self._contacts, state))
        for name, place, how in zip("AB", places, self._run.states(time), strict=True):
            axes.plot(*place, "o", color=CONTACT_COLOURS[how], markeredgecolor=EDGE, markersize=7)
            axes.annotate(name, place, (0.0, -15.0), textcoords="offset points", ha="center")
        (left, bottom), (right, top) = self._middle - 0.5 * self.size, self._middle + 0.5 * self.size
        axes.set(xlim=(left, right), ylim=(bottom, top))
        return last_impact(self._run.impacts, time)

    def _seen(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the support's frame, about the old contact's place on it, as they lie on the slope."""
        return plot.turned(points - self._edges[0], float(self._run.support.motion(0.0).angle))


def draw_wheel_rate(rolling: Rolling, axes: plot.Axes) -> None:
    """Draw the rate at which a wheel turns ahead, and that of steady rolling."""
    times = np.linspace(0.0, rolling.time, _POINTS)
    axes.plot(times, -rolling.world(times).omega, color=_HUB)
    impacts = [one.strike for one in rolling.impacts]
    for mode in sorted({strike.outcome.mode for strike in impacts}):
        found = [(one.time, -one.after.omega) for one in impacts if one.outcome.mode is mode]
        label = f"after an impact: {mode.name}"
        axes.plot(*np.array(found).T, "o", color=MODES[mode].colour, markeredgecolor=EDGE, label=label)
    known = rolling_as_json(rolling)["steady"]
    for rate in (known["omega_before"], known["omega_after"]) if known else ():
        ahead = copysign(rate, rolling.wheel.hub.slope)
        axes.axhline(ahead, color=plot.GREY, linestyle="--", linewidth=0.9, label="steady rolling without slip")
    axes.set(xlabel="time (s)", ylabel="rate ahead (rad/s)", xlim=(0.0, 1.03 * rolling.time or 1.0))


def write_wheel_figure(path: str | os.PathLike[str], rolling: Rolling) -> None:
    """Draw a rolling motion into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    scene = WheelScene(rolling)
    with plot.picture(path, 9.0, 8.2) as figure:
        upper, rates, stands = figure.subplots(3, 1, height_ratios=(3.1, 2.4, 1.5))
        upper.set_aspect("equal")
        upper.set_axis_off()
        upper.set_title(f"{scene.title}, after {rolling.time:.3g} s", fontweight="bold")
        scene.draw(upper, rolling.time)
        draw_wheel_rate(rolling, rates)
        rates.set_xlabel("")
        draw_contacts(stands, [(tip, one.start, one.end, how) for one in rolling.stands for tip, how in one.tips])
        stands.set(ylabel="spoke", xlim=rates.get_xlim())
        stands.yaxis.get_major_locator().set_params(integer=True)
        plot.common_legend(figure)


def wheel_film(rolling: Rolling) -> plot.Film:
    """The film of a wheel, seen by a camera that goes along with it, and its rate."""
    return plot.Film(
        scenes=[WheelScene(rolling)],
        height=3.3,
        draw_curves=partial(draw_wheel_rate, rolling),
        times=plot.frames_of(rolling.time),
    )


class WheelScene:
    """A wheel on its slope, with the way of its hub and the places that its spokes have struck."""

    def __init__(self, rolling: Rolling) -> None:
        """Take a motion."""
        wheel, hub = rolling.wheel, rolling.wheel.hub
        where = f"on a slope of {degrees(hub.slope):.3g}° with friction {hub.friction:g}"
        self.title = f"A rimless wheel of {wheel.spokes} spokes {where}"
        self._rolling, self._tips = rolling, np.array(rolling.wheel.tips)
        self._times = np.linspace(0.0, rolling.time, _POINTS)
        self._hub = np.array(rolling.world(self._times)[:2])

    def draw(self, axes: plot.Axes, time: float) -> str:
        """Draw the wheel at a time in s with the way of the hub and what it struck; its last impact."""
        state, stood, hub = self._rolling.world(time), dict(self._rolling.stood(time)), self._rolling.wheel.hub
        for k, (x, y) in enumerate(plot.placed(self._tips, state)):
            colour = CONTACT_COLOURS[stood[k]] if k in stood else _FIRST if k == 0 else plot.SPOKE
            width, label = 3.0 if k in stood else 1.5, "spoke 0" if colour == _FIRST else ""
            axes.plot([state.x, x], [state.y, y], color=colour, linewidth=width, label=label)
        axes.plot(state.x, state.y, "o", color=_HUB, markersize=6)
        axes.axline((0.0, 0.0), slope=-tan(hub.slope), color=plot.SUPPORT, linewidth=5.0, zorder=1.0)
        axes.plot(*self._hub[:, self._times <= time], color=_HUB, label="way of the hub")
        past = [one for one in self._rolling.impacts if one.strike.time <= time]
        struck = [plot.placed(self._tips, self._rolling.world(one.strike.time))[one.new] for one in past]
        axes.plot(*np.reshape(struck, (-1, 2)).T, "o", color=plot.STRUCK, markersize=5, label="strike of a spoke")
        (x, y, *_), leg = state, hub.leg
        axes.set(xlim=(x - 2.6 * leg, x + 2.6 * leg), ylim=(y - 1.35 * leg, y + 1.15 * leg))
        return last_impact([one.strike for one in past], time)
