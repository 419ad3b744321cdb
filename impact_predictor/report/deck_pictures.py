"""Cargo on a rolling deck as pictures: what the deck does to each unit, and a film of the seconds with most motion."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from math import degrees, hypot, radians
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ..mechanics.motion import End, PlanarState
from ..mechanics.motion.support import MovingSupport
from ..prediction.scene import Watching
from ..prediction.watch.onset import Onset, motions
from ..prediction.watch.standing import Standing
from ..ros.markers.body import box_of
from ..scenarios.deck.cargo import CargoUnit, Span
from ..scenarios.truth import TrueImpact, TrueOnset
from ..stamps import NANOSECONDS
from ..wording import counted, words
from .modes import EDGE, MODES, PALETTE
from .plot import (
    CLOSED,
    LINE,
    OPEN,
    STEP,
    STRUCK,
    SUPPORT,
    Axes,
    Film,
    box,
    circle,
    common_legend,
    picture,
    placed,
    turned,
)

LONGEST: Final = 12.0
"""Seconds of a motion that a film shows, in real time: those in which most units move."""
MARGINS: Final = ("#dfe6e1", "#f2a91a", "#d62728")
"""Colours of a margin that is used little, enough to warn, and up."""
ROLL, HEAVE, SLID = PALETTE[0], "#8a6d3b", PALETTE[2]

_MOST: Final = 200_000
"""Moments of a picture of a long motion; a rocking unit takes a second or so to and fro."""
_MOMENT: Final = 0.05
"""Seconds between the moments of a picture of a shorter one."""
_TILTS, _SLIDES = radians(0.1), 0.02
"""A unit moves that is tilted by so many rad, or slides at so many m/s."""
_SLID: Final = 0.005
"""A slide of so many m is told."""


def moments(duration: float) -> NDArray[np.float64]:
    """Times in s at which a picture of a motion needs the state of each unit."""
    return np.linspace(0.0, duration, min(_MOST, max(2, round(duration / _MOMENT) + 1)))


class UnitMotion:
    """The motion of one unit at `times` (s), in the deck's plane from the deck's origin; NaN where it is not followed.

    `impacts` and `onsets` of it; `end` says how it ended, and `ended` when (s).
    """

    def __init__(self, unit: CargoUnit, times: NDArray[np.float64]) -> None:
        """Begin with nothing known."""
        self.unit, self.times = unit, times
        self.impacts: list[TrueImpact] = []
        self.onsets: list[TrueOnset] = []
        self.end, self.ended = End.TIME_UP, 0.0
        self._states: NDArray[np.float64] = np.full((6, len(times)), np.nan)

    def take(self, span: Span) -> None:
        """Take a span of the motion."""
        within = (self.times >= span.start) & (self.times <= span.time)
        if within.any():
            self._states[:, within] = np.array(span.state(self.times[within]))
            self._states[:2, within] += np.array(self.unit.foot)[:, None]
        self.impacts += span.impacts
        self.onsets += span.onsets
        self.end, self.ended = span.end, span.time

    def at(self, time: float) -> PlanarState:
        """The state at a time in s; the last one that is known where it is not followed any more."""
        known = max(1, int(np.searchsorted(self.times, self.ended, side="right")))
        return PlanarState(*(float(np.interp(time, self.times[:known], part[:known])) for part in self._states))

    @property
    def toppled(self) -> bool:
        """Whether it has overturned."""
        return self.end is End.OVERTURNED

    @property
    def tilt(self) -> NDArray[np.float64]:
        """Angles in rad from how it stood."""
        return np.asarray(self._states[2] - self.unit.start.angle)

    @property
    def slid(self) -> NDArray[np.float64]:
        """Ways in m along the deck of the lower one of its contacts from where it stood; 0 for a cylinder on edges."""
        body, (x, _, angle, *_) = self.unit.body, self._states
        assert body.old is not None
        if self.unit.scene.radius > 0.0:
            return np.asarray(0.0 * angle)
        c, s = np.cos(angle), np.sin(angle)
        (low_old, old), (low_new, new) = (
            (s * one.x + c * one.y, (c - 1.0) * one.x - s * one.y) for one in (body.old, body.new)
        )
        return np.asarray(np.where(low_old < low_new, old, new) + x - self.unit.foot[0] - self.unit.start.x)

    @property
    def moves(self) -> NDArray[np.bool_]:
        """Whether it moves on the deck so that a film shows it."""
        with np.errstate(invalid="ignore"):
            return np.asarray((np.abs(self.tilt) > _TILTS) | (np.abs(self._states[3]) > _SLIDES))


class DeckMotion:
    """The motions of all units of a deck over `duration` (s), for its pictures, once its spans have passed `taking`."""

    def __init__(self, duration: float) -> None:
        """Begin with no unit."""
        self.times = moments(duration)
        self.units: list[UnitMotion] = []

    def taking(self, unit: CargoUnit, spans: Iterable[Span]) -> Iterator[Span]:
        """The spans of a unit, taken up as they pass."""
        motion = UnitMotion(unit, self.times)
        self.units.append(motion)
        for span in spans:
            motion.take(span)
            yield span


def outline_of(unit: CargoUnit) -> NDArray[np.float64]:
    """The outline (n, 2) in m of a unit seen along the deck, from its mass centre, while it stands."""
    scene, body = unit.scene, unit.body
    assert body.old is not None
    if scene.radius > 0.0:
        return circle(hypot(body.old.x, body.old.y))
    (low, high), center = box_of(scene.points, scene.center_of_mass), scene.center_of_mass
    c, s = np.cos(scene.yaw), np.sin(scene.yaw)
    across = [s * (x - center[0]) + c * (y - center[1]) for x in (low[0], high[0]) for y in (low[1], high[1])]
    return box(min(across), max(across), low[2] - center[2], high[2] - center[2])


def margin_used(deck: MovingSupport, unit: CargoUnit, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """The larger part that is used of the margins of a unit against sliding and tipping, where it began: 1 at the
    onset. `deck` is the support's motion, of its own frame.
    """
    stance = Standing(unit.scene).stance
    none = np.zeros_like(times)
    if stance is None:
        return none
    felt = deck.felt_at(times)
    gravity = np.stack([none, felt[:, 0], felt[:, 1]], axis=1)
    angular, turning = (np.stack([felt[:, k], none, none], axis=1) for k in (2, 3))
    margins = Onset([stance]).margins(motions(gravity, angular, turning))
    return np.asarray(np.maximum(margins.slide, margins.tip)[0])


def busiest(units: Sequence[UnitMotion], most: int) -> list[UnitMotion]:
    """The units that turned or slid most, in the order in which they were given."""
    chosen = sorted(units, key=lambda one: (one.toppled, len(one.impacts), _greatest(one.slid)), reverse=True)[:most]
    return [one for one in units if one in chosen]


def _seconds(impacts: Iterable[TrueImpact]) -> list[float]:
    return [one.stamp / NANOSECONDS for one in impacts]


def _greatest(values: NDArray[np.float64]) -> float:
    return float(np.nanmax(np.abs(values)))


def write_deck_figure(path: str | os.PathLike[str], deck: MovingSupport, units: Sequence[UnitMotion]) -> None:
    """Draw the deck above, and below the units that moved most, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    shown, times = busiest(units, 6), units[0].times
    said = f"{counted(len(units), 'unit')} on a rolling deck"
    with picture(path, 10.0, 2.6 + 1.25 * len(shown)) as figure:
        upper, *panels = figure.subplots(1 + len(shown), 1, sharex=True)
        motion = deck.motion(times)
        upper.plot(times, np.degrees(motion.angle), color=ROLL)
        upper.set_ylabel("deck roll (°)", color=ROLL)
        upper.set_title(said + (f": the {len(shown)} that moved most" if shown != units else ""), fontweight="bold")
        heave = upper.twinx()
        heave.plot(times, motion.y - np.mean(motion.y), "--", color=HEAVE, linewidth=1.0)
        heave.set_ylabel("heave (m)", color=HEAVE)
        heave.grid(visible=False)
        for axes, unit in zip(panels, shown, strict=True):
            _draw_unit(axes, deck, unit)
        panels[-1].set(xlabel="time (s)", xlim=(0.0, times[-1]))
        figure.align_ylabels([upper, *panels])
        common_legend(figure)


def _draw_unit(axes: Axes, deck: MovingSupport, unit: UnitMotion) -> None:
    """Draw the tilt of a unit, how far it slid, its impacts, and along the bottom how much of its margin is used."""
    times, tilt = unit.times, np.degrees(unit.tilt)
    axes.set_title(f"{unit.unit.name}: {_fate(unit)}", fontsize=10, pad=3)
    axes.plot(times, tilt, color="black", linewidth=1.2)
    # A unit that has toppled would leave no room for how it rocked before.
    rocked = _greatest(tilt[times < unit.ended - 2.0]) if unit.toppled and unit.ended > 2.0 else _greatest(tilt)
    high = 1.75 * max(rocked, 1.0)
    axes.set(ylabel="tilt (°)", ylim=(-high, high))
    for mode in sorted({impact.mode for impact in unit.impacts}):
        at = _seconds(impact for impact in unit.impacts if impact.mode is mode)
        look, label = MODES[mode], f"impact: {words(mode.name)}"
        axes.plot(at, [0.0] * len(at), look.marker, color=look.colour, markeredgecolor=EDGE, label=label)
    if unit.toppled:
        axes.plot(unit.ended, 0.0, "X", color=MARGINS[2], markeredgecolor=EDGE, label="topples")
    used, warn = margin_used(deck, unit.unit, times), Watching().warn
    bottom = axes.get_xaxis_transform()
    for least, colour, label in (
        (warn, MARGINS[1], f"{warn:.0%} of the margin used"),
        (1.0, MARGINS[2], "margin used up: slides or tips"),
    ):
        over = times[used >= least]
        axes.plot(over, [0.06] * len(over), "|", color=colour, markersize=9, transform=bottom, label=label)
    if _greatest(unit.slid) > _SLID:
        other = axes.twinx()
        other.plot(times, unit.slid, color=SLID)
        other.set_ylabel("slid (m)", color=SLID)
        other.grid(visible=False)


def _fate(unit: UnitMotion) -> str:
    """What became of a unit, in words."""
    said = [counted(len(unit.impacts), "impact")] if unit.impacts else []
    if not unit.toppled and _greatest(unit.tilt) > _TILTS:
        said.append(f"tilts {degrees(_greatest(unit.tilt)):.2g}°")
    if _greatest(unit.slid) > _SLID:
        said.append(f"slides {_greatest(unit.slid):.2g} m")
    if unit.end is not End.TIME_UP:
        said.append(f"{'topples' if unit.toppled else 'is lost'} at {unit.ended:.0f} s")
    return ", ".join(said) or "stays where it is"


def deck_frames(units: Sequence[UnitMotion]) -> list[float]:
    """The times in s of the frames: the part of the motion in which most units move."""
    times = units[0].times
    step = float(times[1] - times[0])
    busy = np.sum([one.moves for one in units], axis=0, dtype=float)
    sums = np.convolve(busy, np.ones(min(len(times), round(LONGEST / step))), mode="valid")
    # In the middle of those that show as much.
    best = np.flatnonzero(sums >= sums.max() - 1e-9)
    begin = float(times[best[len(best) // 2]]) if sums.max() > 0.0 else 0.0
    end = min(begin + LONGEST, float(times[-1]))
    return [begin + STEP * k for k in range(max(2, 1 + int((end - begin) / STEP)))]


def deck_film(deck: MovingSupport, units: Sequence[UnitMotion]) -> Film:
    """The film of a deck in real time: the busiest units, its roll and the impacts below."""
    times, near = deck_frames(units), busiest(units, 3)
    return Film(
        scenes=[UnitScene(deck, one, times) for one in near],
        height=2.2,
        draw_curves=partial(_draw_roll, deck, near, np.array(times)),
        speed=1.0,
        times=times,
    )


def _draw_roll(deck: MovingSupport, units: Sequence[UnitMotion], times: NDArray[np.float64], axes: Axes) -> None:
    axes.plot(times, np.degrees(deck.motion(times).angle), color=ROLL)
    for unit in units:
        at = _seconds(unit.impacts)
        axes.plot(at, [0.0] * len(at), "|", color=STRUCK)
    axes.set(xlim=(times[0], times[-1]), xlabel="time (s); red: impacts", ylabel="roll (°)")


class UnitScene:
    """One unit on its piece of the deck, seen from astern by a camera that stays upright: port is on the left."""

    def __init__(self, deck: MovingSupport, motion: UnitMotion, times: Sequence[float]) -> None:
        """Look at the motion at some times (s), to know how much room it needs."""
        unit, body = motion.unit, motion.unit.body
        assert body.old is not None
        self.title, self._deck, self._motion, self._outline = unit.name, deck, motion, outline_of(unit)
        self._used = margin_used(deck, unit, motion.times)
        self._contacts = np.array([(body.old.x, body.old.y), (body.new.x, body.new.y)])
        start = unit.start._replace(x=unit.start.x + unit.foot[0], y=unit.start.y + unit.foot[1])
        self._edges = placed(self._contacts, start)
        self._pivot = np.array([np.mean(self._edges[:, 0]), self._edges[:, 1].min()])
        seen = np.concatenate([self._seen(placed(self._outline, motion.at(time)), time) for time in times[::5]])
        self._middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))
        self._size = max(float(np.ptp(seen, axis=0).max()), 1e-3)

    def draw(self, axes: Axes, time: float) -> str:
        """Draw the unit at a time in s, red while it moves, else by its margin; what it does."""
        state, far = self._motion.at(time), 3.0 * self._size
        used = float(np.interp(time, self._motion.times, self._used))
        tilt = degrees(abs(state.angle - self._motion.unit.start.angle))
        if self._motion.toppled and time >= self._motion.ended:
            does, moves = "has toppled", True
        elif tilt > degrees(_TILTS):
            does, moves = f"rocks, tilted by {tilt:.2g}°", True
        elif abs(state.vx) > _SLIDES:
            does, moves = f"slides at {abs(state.vx):.2g} m/s", True
        else:
            does, moves = f"stands, margin used: {min(used, 9.99):.0%}", False
        colour = MARGINS[2 if moves or used >= 1.0 else 1 if used >= Watching().warn else 0]
        deck = box(-far, far, -0.05 * self._size, 0.0) + self._pivot
        axes.fill(*self._seen(deck, time).T, color=SUPPORT)
        axes.fill(*self._seen(placed(self._outline, state), time).T, facecolor=colour, edgecolor=LINE)
        is_disc = self._motion.unit.scene.radius > 0.0
        for place in self._edges if is_disc else placed(self._contacts, state):
            closed = is_disc or place[1] - self._pivot[1] < 1e-3
            shown = self._seen(place[None], time)[0]
            axes.plot(*shown, "o", color=CLOSED if closed else OPEN, markeredgecolor=CLOSED, markersize=6)
        (x, y), half = self._middle, 0.575 * self._size
        axes.set(xlim=(x + 1.3 * half, x - 1.3 * half), ylim=(y - half, y + half))
        return does

    def _seen(self, points: NDArray[np.float64], time: float) -> NDArray[np.float64]:
        return np.asarray(turned(points - self._pivot, float(self._deck.motion(time).angle)) + self._pivot)
