"""Cargo on a rolling deck as pictures: what the deck does to each unit, and a film of the seconds with most motion."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import partial
from math import degrees
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..mechanics.motion import End, PlanarState
from ..prediction.scene import Watching
from ..prediction.watch.onset import Onset, motions
from ..prediction.watch.standing import Standing
from ..ros.markers.body import box_of
from ..scenarios.deck.cargo import CargoUnit
from ..scenarios.deck.motion import DeckMotion
from ..scenarios.deck.voyage import Followed
from ..stamps import NANOSECONDS
from ..wording import counted, words
from . import plot
from .modes import EDGE, MODES, PALETTE
from .motion_pictures import OPEN, STICKS, BodyScene

LONGEST: Final = 12.0
"""Seconds of a motion that a film shows, in real time: those about the fastest."""
MARGINS: Final = ("#dfe6e1", "#f2a91a", "#d62728")
"""Colours of a margin that is used little, enough to warn, and up."""
ROLL, SLID = PALETTE[0], PALETTE[2]

_TILTS, _SLIDES, _SLID = 0.1, 0.02, 0.005
"""A unit moves that is tilted by so many degrees, or slides at so many m/s; a slide of so many m is shown."""


def picture_times(duration: float) -> NDArray[np.float64]:
    """The moments in s at which units are followed for a picture: one each 0.05 s, and 200,000 at most."""
    return np.linspace(0.0, duration, min(200_000, max(2, round(duration / 0.05) + 1)))


class UnitMotion:
    """What pictures show of a unit that has been followed, at its `times` in s; NaN where it is not followed any more.

    `tilt` is the angle from how it stood (rad), `slid` the way along the deck of the lower one of its contacts from
    where it stood (m; 0 for a cylinder on edges), and `struck` are the times of its impacts (s).
    """

    def __init__(self, followed: Followed) -> None:
        self.unit, self.times, self.impacts, self.ended = followed.unit, followed.times, followed.impacts, followed.time
        self.struck = [one.stamp / NANOSECONDS for one in self.impacts]
        self.toppled = followed.end is End.OVERTURNED
        self.states, start, body = followed.states, self.unit.start, self.unit.body
        x, _, angle, speed, _, omega = self.states
        self.tilt = angle - start.angle
        self.speed = np.nan_to_num(np.abs(speed) + np.abs(omega))
        c, s = np.cos(angle), np.sin(angle)
        assert body.old is not None
        ways = [(c - 1.0) * one.x - s * one.y for one in (body.old, body.new)]
        old_is_lower = s * body.old.x + c * body.old.y < s * body.new.x + c * body.new.y
        on_edges = self.unit.scene.radius > 0.0
        self.slid = 0.0 * angle if on_edges else np.where(old_is_lower, *ways) + x - start.x

    def at(self, time: float) -> PlanarState:
        """The state at a time in s; the last one that is known where it is not followed any more."""
        known = max(1, int(np.searchsorted(self.times, self.ended, side="right")))
        return PlanarState(*(float(np.interp(time, self.times[:known], part[:known])) for part in self.states))


def margin_used(deck: DeckMotion, unit: CargoUnit, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """The larger part that is used of the margins of a unit against sliding and tipping, where it began: 1 at the
    onset.
    """
    stance = Standing(unit.scene).stance
    if stance is None:
        return np.zeros_like(times)
    state = deck.at(times)
    margins = Onset([stance]).margins(motions(state.gravity, state.poses.angular, state.turning))
    return np.asarray(np.maximum(margins.slide, margins.tip)[0])


def busiest(units: Sequence[UnitMotion], most: int) -> list[UnitMotion]:
    """The units that turned or slid most, in the order in which they were given."""
    chosen = sorted(units, key=lambda one: (one.toppled, len(one.impacts), _greatest(one.slid)), reverse=True)[:most]
    return [one for one in units if one in chosen]


def _greatest(values: NDArray[np.float64]) -> float:
    return float(np.nanmax(np.abs(values)))


def write_deck_figure(path: str | os.PathLike[str], deck: DeckMotion, units: Sequence[UnitMotion]) -> None:
    """Draw the deck above, and below the units that moved most, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    shown, times = busiest(units, 6), units[0].times
    with plot.picture(path, 10.0, 2.6 + 1.25 * len(shown)) as figure:
        upper, *panels = figure.subplots(1 + len(shown), 1, sharex=True)
        upper.plot(times, np.degrees(deck.axes(times)[0, 3]), color=ROLL)
        upper.set_ylabel("deck roll (°)")
        more = f": the {len(shown)} that moved most" if shown != units else ""
        upper.set_title(f"{counted(len(units), 'unit')} on a rolling deck{more}", fontweight="bold")
        for axes, unit in zip(panels, shown, strict=True):
            _draw_unit(axes, deck, unit)
        panels[-1].set(xlabel="time (s)", xlim=(0.0, times[-1]))
        figure.align_ylabels([upper, *panels])
        plot.common_legend(figure)


def _draw_unit(axes: plot.Axes, deck: DeckMotion, unit: UnitMotion) -> None:
    """Draw the tilt of a unit, how far it slid, its impacts, and along the bottom how much of its margin is used."""
    times, tilt = unit.times, np.degrees(unit.tilt)
    ended = f", topples at {unit.ended:.0f} s" if unit.toppled else ""
    most = f"tilts up to {_greatest(tilt):.1f}°, slides up to {_greatest(unit.slid):.3f} m"
    axes.set_title(f"{unit.unit.name}: {counted(len(unit.impacts), 'impact')}, {most}{ended}", fontsize=10, pad=3)
    axes.plot(times, tilt, color="black", linewidth=1.2)
    # A unit that topples would leave no room for how it rocked before.
    high = 1.75 * max(min(_greatest(tilt), 15.0), 1.0)
    axes.set(ylabel="tilt (°)", ylim=(-high, high))
    for mode in sorted({impact.mode for impact in unit.impacts}):
        at = [time for time, impact in zip(unit.struck, unit.impacts, strict=True) if impact.mode is mode]
        label = f"impact: {words(mode.name)}"
        axes.plot(at, [0.0] * len(at), "o", color=MODES[mode].colour, markeredgecolor=EDGE, label=label)
    used, warn = margin_used(deck, unit.unit, times), Watching().warn
    moves = (np.abs(tilt) > _TILTS) | (np.abs(unit.states[3]) > _SLIDES) | (unit.toppled & (times >= unit.ended))
    used[moves] = np.maximum(used[moves], 1.0)
    for least, colour, label in (
        (warn, MARGINS[1], f"{warn:.0%} of the margin used"),
        (1.0, MARGINS[2], "margin used up, or it moves"),
    ):
        over, bottom = times[used >= least], axes.get_xaxis_transform()
        axes.plot(over, [0.06] * len(over), "|", color=colour, markersize=9, transform=bottom, label=label)
    if _greatest(unit.slid) > _SLID:
        right = axes.twinx()
        right.plot(times, unit.slid, color=SLID)
        right.set_ylabel("slid (m)", color=SLID)
        right.grid(visible=False)


def deck_frames(units: Sequence[UnitMotion]) -> list[float]:
    """The times in s of the frames: the part of the motion about the moment in which the units move fastest."""
    times = units[0].times
    fastest = times[np.argmax(np.sum([one.speed for one in units], axis=0))]
    begin = max(0.0, min(float(fastest) - 0.5 * LONGEST, float(times[-1]) - LONGEST))
    return np.arange(begin, min(begin + LONGEST, float(times[-1])) + 1e-9, plot.STEP).tolist()


def deck_film(deck: DeckMotion, units: Sequence[UnitMotion]) -> plot.Film:
    """The film of a deck in real time: the busiest units, its roll and the impacts below."""
    times, near = deck_frames(units), busiest(units, 3)
    return plot.Film(
        scenes=[UnitScene(deck, one, times) for one in near],
        height=2.2,
        draw_curves=partial(_draw_roll, deck, near, np.array(times)),
        times=times,
    )


def _draw_roll(deck: DeckMotion, units: Sequence[UnitMotion], times: NDArray[np.float64], axes: plot.Axes) -> None:
    axes.plot(times, np.degrees(deck.axes(times)[0, 3]), color=ROLL)
    struck = [time for unit in units for time in unit.struck]
    axes.plot(struck, [0.0] * len(struck), "|", color=plot.STRUCK)
    axes.set(xlim=(times[0], times[-1]), xlabel="time (s); red: impacts", ylabel="roll (°)")


class UnitScene(BodyScene):
    """One unit on its piece of the deck, seen from astern by a camera that stays upright: port is on the left."""

    def __init__(self, deck: DeckMotion, motion: UnitMotion, times: Sequence[float]) -> None:
        """Look at the motion at some times (s), to know how much room it needs."""
        self._motion, unit, scene = motion, motion.unit, motion.unit.scene
        self._used, outline = margin_used(deck, unit, motion.times), np.zeros((0, 2))
        if not scene.radius > 0.0:
            (low, high), (x, y, z) = box_of(scene.points, scene.center_of_mass), scene.center_of_mass
            corners = np.array([(one - x, other - y) for one in (low[0], high[0]) for other in (low[1], high[1])])
            across = corners @ (np.sin(scene.yaw), np.cos(scene.yaw))
            outline = plot.box(across.min(), across.max(), low[2] - z, high[2] - z)
        super().__init__(unit.name, unit.body, outline, deck.across(0.0, (0.0, 0.0)), unit.start, motion.at, times[::5])

    def draw(self, axes: plot.Axes, time: float) -> str:
        """Draw the unit at a time in s, red while it moves, else by its margin; what it does, in words."""
        state, used = self._motion.at(time), float(np.interp(time, self._motion.times, self._used))
        tilt, speed = degrees(abs(state.angle - self._motion.unit.start.angle)), abs(state.vx)
        if self._motion.toppled and time >= self._motion.ended:
            says = "has toppled"
        elif tilt > _TILTS:
            says = f"rocks, tilted by {tilt:.2g}°"
        else:
            says = f"slides at {speed:.2g} m/s" if speed > _SLIDES else f"stands, margin used: {min(used, 9.99):.0%}"
        moves = not says.startswith("stands")
        face = MARGINS[2 if moves or used >= 1.0 else 1 if used >= Watching().warn else 0]
        heights = plot.placed(self._contacts, state)[:, 1] - self._edges[:, 1]
        self.draw_body(axes, time, face, [STICKS if height < 1e-3 else OPEN for height in heights])
        axes.invert_xaxis()
        return says
