"""Bodies that rock and wheels that roll, as pictures (Fig. 2 of the paper for any of them) and as films."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from functools import partial
from math import copysign, degrees, hypot, inf, tan
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..mechanics.motion import End, PlanarState, RockingImpact
from ..scenarios.rocking import Rocking
from ..scenarios.wheel import Rolling, Wheel
from ..scenarios.wheel_closed_forms import downhill, least_friction, steady
from .modes import EDGE, MODES, PALETTE
from .plot import (
    BODY,
    CLOSED,
    GREY,
    LINE,
    OPEN,
    SLIPS,
    STRUCK,
    SUPPORT,
    Axes,
    Film,
    box,
    circle,
    common_legend,
    frames_of,
    picture,
    placed,
    speed_for,
    turned,
)

CONTACT_COLOURS: Final = {"S": CLOSED, "+": SLIPS, "-": SLIPS, "O": OPEN}

_HUB, _FIRST = PALETTE[0], PALETTE[2]
_SPOKE: Final = "#b5c1cd"
_POINTS: Final = 2000
"""Points of a curve that is as long as the picture."""
_LOOKS: Final = 400
"""Moments of a motion at which its extent is looked at."""
_HIGHEST: Final = 3.4
"""Inches of the film that a body may be high."""
_SEEN: Final = 5.6
"""Metres of slope, in lengths of a spoke, that the picture of a wheel shows."""


def stance_of(contacts: Iterable[tuple[str, str]], impacts: Sequence[RockingImpact], time: float) -> str:
    """How a body stands at a time (s) on contacts, each a name and a state, and what its last impact was, in words."""
    closed = [(name, how) for name, how in contacts if how != "O"]
    said = "flies"
    if closed:
        verb = "stands" if closed[0][1] == "S" else "slips"
        said = f"{verb} on {' and '.join(name for name, _ in closed)}"
    past = [one for one in impacts if one.time <= time]
    return said + (f"\nimpact {len(past)}: {past[-1].outcome.mode.name}" if past else "\n")


def draw_rate(
    axes: Axes,
    times: NDArray[np.float64],
    rates: NDArray[np.float64],
    impacts: Sequence[RockingImpact],
    sign: float,
    colour: str,
    label: str,
) -> None:
    """Draw a rate of turning, `sign` times omega in rad/s, with a gap and dots at each impact; `rates` changes."""
    struck = [one.time for one in impacts]
    before, after = [sign * one.before.omega for one in impacts], [sign * one.after.omega for one in impacts]
    rates[np.searchsorted(times, struck)] = np.nan
    axes.plot(times, rates, color=colour, label=label)
    axes.vlines(struck, before, after, color=colour, linestyle=":", linewidth=0.9)
    axes.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)


def draw_contacts(axes: Axes, closed: Iterable[tuple[int, float, float, str]]) -> None:
    """Draw bars while contacts are closed: the row of each, begin and end (s), and its state."""
    bars = list(closed)
    for colour, label in ((CLOSED, "contact sticks"), (SLIPS, "contact slips")):
        mine = [(row, begin, end - begin) for row, begin, end, how in bars if CONTACT_COLOURS[how] == colour]
        if mine:
            rows, begins, lengths = zip(*mine, strict=True)
            axes.barh(rows, lengths, 0.6, begins, color=colour, label=label)
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
    times = times_of(rockings)
    rows = range(2 * len(rockings))
    with picture(path, 9.0, 6.0 + 0.4 * len(rockings)) as figure:
        heights = (2.7, 2.7, 0.3 + 0.4 * len(rockings))
        rates, angles, contacts = figure.subplots(3, 1, sharex=True, height_ratios=heights)
        draw_rates(rockings, rates)
        released = f"released at {degrees(run.state(0.0).angle):.3g}°"
        rates.set_title(f"Angular velocity and angle of {bodies} {released}", fontweight="bold")
        rates.set(xlabel="", xlim=(0.0, times[-1]))
        for (_, one), colour in zip(rockings, PALETTE * len(rockings), strict=False):
            angles.plot(times, np.degrees(one.state(times).angle), color=colour)
        angles.set_ylabel("φ (degrees)")
        phases = [(k, phase) for k, (_, one) in enumerate(rockings) for phase in one.phases]
        closed = [(2 * k + i, one.start, one.end, one.states[i]) for k, one in phases for i in range(2)]
        closed += [
            (row, rockings[row // 2].run.time, float(times[-1]), "S")
            for row in rows
            if rockings[row // 2].run.end is End.RESTS
        ]
        draw_contacts(contacts, closed)
        contacts.set_yticks(rows, ["A", "B"] * len(rockings))
        for row, label in zip(rows, contacts.get_yticklabels(), strict=True):
            label.set(color=PALETTE[row // 2 % len(PALETTE)], fontweight="bold")
        common_legend(figure, "contact A: behind the mass centre, B: ahead of it")


def times_of(rockings: Sequence[Rocking]) -> NDArray[np.float64]:
    """Times (s) of curves, until a little after the last motion."""
    return np.linspace(0.0, 1.06 * max(rocking.run.time for rocking in rockings) or 1.0, _POINTS)


def draw_rates(rockings: Sequence[Rocking], axes: Axes) -> None:
    """Draw angular velocities of motions, and when impacts accumulate."""
    times = times_of(rockings)
    for (rocker, run), colour in zip(rockings, PALETTE * len(rockings), strict=False):
        draw_rate(axes, times, np.array(run.state(times).omega), run.impacts, 1.0, colour, rocker.label)
        for one in run.accumulations:
            axes.plot(one.time, 0.0, "o", color=EDGE, markersize=5, label="impacts accumulate")
    axes.set(xlabel="time (s)", ylabel="ω (rad/s)", xlim=(0.0, times[-1]))


def rocking_film(rockings: Sequence[Rocking]) -> Film:
    """The film of motions side by side, all to one scale, with their angular velocities."""
    longest = max(rocking.run.time for rocking in rockings)
    scenes = [RockingScene(rocking) for rocking in rockings]
    width, height = np.max([scene.size for scene in scenes], axis=0)
    for scene in scenes:
        scene.size = np.array([width, height])
    return Film(
        scenes=scenes,
        height=min(_HIGHEST, 7.0 / len(scenes) * height / width),
        draw_curves=partial(draw_rates, rockings),
        speed=speed_for(longest),
        times=frames_of(longest),
    )


class RockingScene:
    """A body that rocks on its contacts A and B, and what they stand on; `size` (m) of what is seen."""

    def __init__(self, rocking: Rocking) -> None:
        """Look at the whole motion, to know how much room it needs."""
        self.title, self._run, body = rocking.rocker.label, rocking.run, rocking.rocker.body
        assert body.old is not None
        self._contacts = np.array([(body.old.x, body.old.y), (body.new.x, body.new.y)])
        self._distance = float(hypot(*(self._contacts[1] - self._contacts[0])))
        self._is_disc = not rocking.rocker.outline
        self._outline = circle(hypot(body.old.x, body.old.y)) if self._is_disc else np.array(rocking.rocker.outline)
        states = [self._run.state(float(time)) for time in np.linspace(0.0, self._run.time, _LOOKS)]
        outlines = np.concatenate([placed(self._outline, state) for state in states])
        supports = self._edges() if self._is_disc else self._floor(states, outlines)
        self._slope = float(self._run.support.motion(0.0).angle)
        self._supports = [turned(support, self._slope) for support in supports]
        seen = np.concatenate([turned(outlines, self._slope), *self._supports])
        self.size = 1.06 * np.ptp(seen, axis=0)
        self._middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))

    def draw(self, axes: Axes, time: float) -> str:
        """Draw the body at a time in s; how it stands."""
        state, contacts = self._run.world(time), list(zip("AB", self._run.states(time), strict=True))
        for support in self._supports:
            axes.fill(*support.T, color=SUPPORT)
        outline = placed(self._outline, state)
        axes.fill(*outline.T, facecolor=BODY, edgecolor=LINE, linewidth=1.3)
        axes.plot(state.x, state.y, "P", color=LINE, markersize=6, markeredgewidth=0.0)
        if self._is_disc:  # a spoke shows how it turns
            axes.plot(*np.array([(state.x, state.y), outline[0]]).T, color=LINE, linewidth=1.0)
        places = (
            turned(self._contacts - self._contacts[0], self._slope) if self._is_disc else placed(self._contacts, state)
        )
        for (name, how), place in zip(contacts, places, strict=True):
            axes.plot(*place, "o", color=CONTACT_COLOURS[how], markeredgecolor=CLOSED, markersize=7)
            axes.annotate(name, place, (0.0, -15.0), textcoords="offset points", ha="center", fontsize=9)
        low, high = self._middle - 0.5 * self.size, self._middle + 0.5 * self.size
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        return stance_of(contacts, self._run.impacts, time)

    def _edges(self) -> list[NDArray[np.float64]]:
        """The blocks whose edges carry a disc."""
        depth, width = 0.35 * self._distance, 0.6 * self._distance
        (ax, ay), (bx, by) = self._contacts - self._contacts[0]
        return [box(ax - width, ax, ay - depth, ay), box(bx, bx + width, by - depth, by)]

    def _floor(self, states: Sequence[PlanarState], outlines: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """The floor, or posts wherever the contacts stand if the body reaches below them."""
        (left, lowest), (right, _) = outlines.min(axis=0), outlines.max(axis=0)
        ground = lowest - 0.1 * self._distance if lowest < -0.05 * self._distance else 0.0
        floor = [box(left - 0.1 * self._distance, right + 0.1 * self._distance, ground - 0.08 * self._distance, ground)]
        if ground == 0.0:
            return floor
        places = np.array([placed(self._contacts, state) for state in states])
        for one in (places[:, 0], places[:, 1]):
            stood = one[one[:, 1] < 1e-6 * self._distance, 0]
            if len(stood):
                begin, end, foot = stood.min(), stood.max(), 0.1 * self._distance
                floor.append(np.array([(begin, 0.0), (end, 0.0), (end + foot, ground), (begin - foot, ground)]))
        return floor


def title_of(wheel: Wheel) -> str:
    """The wheel in words."""
    hub = wheel.hub
    grip = "that does not slip" if hub.friction >= 50.0 else f"with friction {hub.friction:g}"
    return f"A rimless wheel of {wheel.spokes} spokes {grip} on a slope of {degrees(hub.slope):.3g}°"


def steady_rates(wheel: Wheel) -> tuple[float, ...]:
    """Rates ahead (rad/s) before and after each impact of steady rolling without slip; none where there is no such."""
    down = downhill(wheel)
    rolls = steady(down)
    if rolls is None or least_friction(down) == inf:
        return ()
    return tuple(copysign(rate, wheel.hub.slope) for rate in (rolls.before, rolls.after))


def draw_wheel_rate(rolling: Rolling, axes: Axes) -> None:
    """Draw the rate at which a wheel turns ahead, and that of steady rolling."""
    end = 1.03 * rolling.time or 1.0
    times, impacts = np.linspace(0.0, end, _POINTS), [one.strike for one in rolling.impacts]
    rates = np.where(times > rolling.time, np.nan, -rolling.world(times).omega)
    draw_rate(axes, times, rates, impacts, -1.0, _HUB, "")
    for mode in sorted({strike.outcome.mode for strike in impacts}):
        found = [(one.time, -one.after.omega) for one in impacts if one.outcome.mode is mode]
        look, label = MODES[mode], f"after an impact: {mode.name}"
        axes.plot(*np.array(found).T, look.marker, color=look.colour, markeredgecolor=EDGE, label=label)
    for rate in steady_rates(rolling.wheel):
        label = "steady rolling without slip"
        axes.axhline(rate, color=GREY, linestyle="--", linewidth=0.9, label=label)
    axes.set(xlabel="time (s)", ylabel="rate ahead (rad/s)", xlim=(0.0, end))


def write_wheel_figure(path: str | os.PathLike[str], rolling: Rolling) -> None:
    """Draw a rolling motion into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    scene, leg = WheelScene(rolling), rolling.wheel.hub.leg
    strobed = [0.0, *[one.strike.time for one in rolling.impacts], rolling.time]
    begin = rolling.world(0.0).x
    shown = [time for time in strobed if abs(rolling.world(time).x - begin) <= _SEEN * leg]
    closed = [(tip, stand.start, stand.end, how) for stand in rolling.stands for tip, how in stand.tips]
    with picture(path, 9.0, 8.2) as figure:
        upper, rates, stands = figure.subplots(3, 1, height_ratios=(3.1, 2.4, 1.5))
        upper.set_aspect("equal")
        upper.set_axis_off()
        more = "" if max(shown) == rolling.time else f", its first {max(shown):.2g} s"
        upper.set_title(title_of(rolling.wheel) + more, fontweight="bold")
        centres = [scene.draw_wheel(upper, time) for time in shown]
        scene.draw_way(upper, max(shown))
        x, y = [one.x for one in centres], [one.y for one in centres]
        upper.set(xlim=(min(x) - 1.1 * leg, max(x) + 1.1 * leg), ylim=(min(y) - 1.1 * leg, max(y) + 1.1 * leg))
        draw_wheel_rate(rolling, rates)
        rates.set(xlabel="")
        draw_contacts(stands, closed)
        stands.set(ylabel="spoke", xlim=rates.get_xlim())
        stands.yaxis.get_major_locator().set_params(integer=True)
        common_legend(figure)


def wheel_film(rolling: Rolling) -> Film:
    """The film of a wheel, seen by a camera that goes along with it, and its rate."""
    return Film(
        scenes=[WheelScene(rolling)],
        height=3.3,
        draw_curves=partial(draw_wheel_rate, rolling),
        speed=speed_for(rolling.time),
        times=frames_of(rolling.time),
    )


class WheelScene:
    """A wheel on its slope, with the way of its hub and the places that its spokes have struck."""

    def __init__(self, rolling: Rolling) -> None:
        """Take a motion."""
        self.title, self._rolling, self._wheel = title_of(rolling.wheel), rolling, rolling.wheel
        self._times = np.linspace(0.0, rolling.time, _POINTS)
        self._hub = np.array(rolling.world(self._times)[:2])
        self._impacts = [one.strike for one in rolling.impacts]
        tips = [placed(np.array(self._wheel.tips), rolling.world(one.strike.time))[one.new] for one in rolling.impacts]
        self._struck = np.array(tips).reshape(-1, 2)

    def draw(self, axes: Axes, time: float) -> str:
        """Draw the wheel at a time in s with the hub in the middle; how it stands."""
        leg = self._wheel.hub.leg
        state = self.draw_wheel(axes, time)
        self.draw_way(axes, time)
        axes.set(xlim=(state.x - 2.6 * leg, state.x + 2.6 * leg), ylim=(state.y - 1.35 * leg, state.y + 1.15 * leg))
        contacts = [(f"spoke {tip}", how) for tip, how in self._rolling.stood(time)]
        return stance_of(contacts, self._impacts, time)

    def draw_way(self, axes: Axes, time: float) -> None:
        """Draw the slope, and the way of the hub and the strikes of the spokes until a time in s."""
        axes.axline((0.0, 0.0), slope=-tan(self._wheel.hub.slope), color=SUPPORT, linewidth=5.0, zorder=1.0)
        axes.plot(*self._hub[:, self._times <= time], color=_HUB, label="way of the hub")
        past = [one.time <= time for one in self._impacts]
        axes.plot(*self._struck[past].T, "o", color=STRUCK, markersize=5, label="strike of a spoke")

    def draw_wheel(self, axes: Axes, time: float) -> PlanarState:
        """Draw the spokes at a time in s, and the hub; its state."""
        state, stood = self._rolling.world(time), dict(self._rolling.stood(time))
        for k, tip in enumerate(placed(np.array(self._wheel.tips), state)):
            colour = CONTACT_COLOURS[stood[k]] if k in stood else _FIRST if k == 0 else _SPOKE
            label = "" if colour != _FIRST else "spoke 0"
            axes.plot(
                [state.x, tip[0]], [state.y, tip[1]], color=colour, linewidth=3.0 if k in stood else 1.5, label=label
            )
        axes.plot(state.x, state.y, "o", color=_HUB, markersize=6)
        return state
