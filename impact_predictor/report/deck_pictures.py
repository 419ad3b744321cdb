"""Cargo on a rolling deck as pictures: what the deck does to each unit, and a film of the seconds with most motion."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from math import degrees, hypot, pi
from typing import Any, Final

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
    Band,
    Curve,
    Film,
    Flash,
    Line2D,
    Outline,
    Panel,
    View,
    around_zero,
    box,
    circle,
    draw_panels,
    patches,
    picture,
    placed,
    turned,
)

LONGEST: Final = 12.0
"""Seconds of a motion that a film shows, in real time: those in which most units move."""
MARGINS: Final = ("#dfe6e1", "#f2a91a", "#d62728")
"""Colours of a margin that is used little, enough to warn, and up."""
ROLL, HEAVE, TILT, SLID = PALETTE[0], "#8a6d3b", "#1a1a1a", PALETTE[2]

_MOST: Final = 200_000
"""Moments of a picture of a long motion; a rocking unit takes a second or so to and fro."""
_MOMENT: Final = 0.05
"""Seconds between the moments of a picture of a shorter one."""
_NEAR: Final = 3
"""Units that the film shows from near by."""
_TILTS, _SLIDES = 0.003, 0.02
"""A unit of the film moves that is turned by so many rad, or slides at so many m/s."""
_TILTED, _SLID = pi / 1800.0, 0.005
"""A tilt of so many rad, and a slide of so many m, are told."""
_STRIP: Final = 0.09
"""Part of a lane's height on which its margin is drawn."""


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

    def taking(self, spans: Iterable[Span]) -> Iterator[Span]:
        """The spans of the motion, each taken up as it passes."""
        for span in spans:
            within = (self.times >= span.start) & (self.times <= span.time)
            if within.any():
                self._states[:, within] = np.array(span.state(self.times[within]))
                self._states[:2, within] += np.array(self.unit.foot)[:, None]
            self.impacts += span.impacts
            self.onsets += span.onsets
            self.end, self.ended = span.end, span.time
            yield span

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
        old, new = body.old, body.new
        old_is_lower = s * old.x + c * old.y < s * new.x + c * new.y
        turns = np.where(old_is_lower, (c - 1.0) * old.x - s * old.y, (c - 1.0) * new.x - s * new.y)
        return np.asarray(turns + x - self.unit.foot[0] - self.unit.start.x)

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
        return motion.taking(spans)


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


def _greatest(values: NDArray[np.float64]) -> float:
    return float(np.nanmax(np.abs(values)))


def title_of(units: Sequence[UnitMotion], shown: int) -> str:
    """What happened, in words."""
    impacts = sum(len(one.impacts) for one in units)
    toppled = sum(one.toppled for one in units)
    them = f"{len(units)} units" if len(units) > 1 else "One unit"
    said = f"{them} on a rolling deck: {counted(impacts, 'impact')}" + (f", {toppled} toppled" if toppled else "")
    return said + (f"; the {shown} that moved most" if shown < len(units) else "")


def write_deck_figure(path: str | os.PathLike[str], deck: MovingSupport, units: Sequence[UnitMotion]) -> None:
    """Draw the deck above, and below the units that moved most, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    shown = busiest(units, 6)
    panels = [_deck_panel(deck, units[0].times), *(_unit_panel(deck, unit) for unit in shown)]
    with picture(path, 10.0, 2.6 + 1.25 * len(shown)) as figure:
        axes = figure.subplots(len(panels), 1, height_ratios=[panel.height for panel in panels])
        draw_panels(axes, panels, float(units[0].times[-1]))
        axes[0].set_title(title_of(units, len(shown)), fontweight="bold")
        figure.align_ylabels(axes)
        figure.legend(handles=_signs(shown), loc="outside lower center", ncols=5, columnspacing=1.4, handletextpad=0.5)


def _deck_panel(deck: MovingSupport, times: NDArray[np.float64]) -> Panel:
    motion = deck.motion(times)
    roll, heave = np.degrees(motion.angle), motion.y - np.mean(motion.y)
    return Panel(
        label="deck roll (°)",
        curves=[Curve(times, roll, ROLL)],
        height=1.25,
        limits=around_zero(roll),
        right=("heave (m)", Curve(times, heave, HEAVE, style="--")),
    )


def _unit_panel(deck: MovingSupport, unit: UnitMotion) -> Panel:
    """The tilt of a unit, how far it slid, its impacts, and along the bottom how much of its margin is used."""
    times, tilt = unit.times, np.degrees(unit.tilt)
    curves = [Curve(times, tilt, TILT, width=1.2)]
    for mode in sorted({impact.mode for impact in unit.impacts}):
        at = np.array([impact.stamp / NANOSECONDS for impact in unit.impacts if impact.mode is mode])
        curves.append(Curve(at, 0.0 * at, MODES[mode].colour, style=MODES[mode].marker))
    if unit.toppled:
        curves.append(Curve(np.array([unit.ended]), np.zeros(1), MARGINS[2], style="X"))
    # A unit that has toppled would leave no room for how it rocked before.
    rocked = tilt if not unit.toppled else np.where(times < unit.ended - 2.0, tilt, np.nan)
    slid = ("slid (m)", Curve(times, unit.slid, SLID)) if _greatest(unit.slid) > _SLID else None
    return Panel(
        label="tilt (°)",
        curves=curves,
        bands=_margin_bands(times, margin_used(deck, unit.unit, times)),
        title=_fate(unit),
        limits=around_zero(np.append(rocked, 10.0 * degrees(_TILTED)), 1.75),
        right=slid,
    )


def _fate(unit: UnitMotion) -> str:
    """What became of a unit, in words."""
    said = [counted(len(unit.impacts), "impact")] if unit.impacts else []
    if not unit.toppled and _greatest(unit.tilt) > _TILTED:
        said.append(f"tilts {degrees(_greatest(unit.tilt)):.2g}°")
    if _greatest(unit.slid) > _SLID:
        said.append(f"slides {_greatest(unit.slid):.2g} m")
    if unit.toppled:
        said.append(f"topples at {unit.ended:.0f} s")
    elif unit.end is not End.TIME_UP:
        said.append(f"is lost at {unit.ended:.0f} s")
    return f"{unit.unit.name}: {', '.join(said) or 'stays where it is'}"


def _margin_bands(times: NDArray[np.float64], used: NDArray[np.float64]) -> list[Band]:
    """How much of the margin against sliding and tipping is used, as bands along the bottom."""
    # Never thinner than can be seen.
    half = max(0.5 * (times[1] - times[0]), 8e-4 * (times[-1] - times[0]))
    bands = [Band(times[0], times[-1], MARGINS[0], 0.0, _STRIP)]
    for least, colour in ((Watching().warn, MARGINS[1]), (1.0, MARGINS[2])):
        over = np.flatnonzero(np.diff(np.concatenate([[False], used >= least, [False]]).astype(int)))
        for first, last in over.reshape(-1, 2):
            bands.append(Band(times[first] - half, times[last - 1] + half, colour, 0.0, _STRIP))
    return bands


def _signs(units: Sequence[UnitMotion]) -> list[Any]:
    """The legend."""
    modes = sorted({impact.mode for one in units for impact in one.impacts})
    signs = [(f"impact: {words(mode.name)}", MODES[mode].colour, MODES[mode].marker) for mode in modes]
    if any(one.toppled for one in units):
        signs.append(("topples", MARGINS[2], "X"))
    warn = Watching().warn
    names = (f"margin: up to {warn:g} used", f"{warn:g} to 1", "used up: slides or tips")
    handles = [
        Line2D([], [], color=colour, marker=marker, linestyle="", markeredgecolor=EDGE, label=name)
        for name, colour, marker in signs
    ]
    return handles + patches(names, dict(zip(names, MARGINS, strict=True)))


def deck_frames(units: Sequence[UnitMotion]) -> list[float]:
    """The times in s of the frames: the part of the motion in which most units move, a little before them included."""
    times = units[0].times
    step = float(times[1] - times[0])
    busy = np.sum([one.moves for one in units], axis=0, dtype=float)
    length = min(len(times), round(LONGEST / step))
    sums = np.convolve(busy, np.ones(length), mode="valid")
    best = np.flatnonzero(sums >= sums.max() - 1e-9)
    # In the middle of those that show as much.
    begin = float(times[best[len(best) // 2]]) if sums.max() > 0.0 else 0.0
    end = min(begin + LONGEST, float(times[-1]))
    return [begin + STEP * k for k in range(max(2, 1 + int((end - begin) / STEP)))]


def deck_film(deck: MovingSupport, units: Sequence[UnitMotion]) -> Film:
    """The film of a deck in real time: the busiest units, its roll and the impacts below."""
    times = deck_frames(units)
    near = [UnitScene(deck, one, times) for one in busiest(units, _NEAR)]
    impacts = [impact.stamp / NANOSECONDS for one in near for impact in one.motion.impacts]
    ticks = np.array([time for time in impacts if times[0] <= time <= times[-1]])
    seen = np.array(times)
    roll = Curve(seen, np.degrees(deck.motion(seen).angle), ROLL)
    return Film(
        title="",
        views=[one.view() for one in near],
        height=2.0,
        panel=Panel(
            label="",
            curves=[roll, Curve(ticks, 0.0 * ticks, STRUCK, style="|")],
            title="roll (°) against time (s), and the impacts; seen from astern, port on the left",
        ),
        speed=1.0,
        times=times,
    )


class UnitScene:
    """One unit on its piece of the deck; what it does, and how much of its margin is used, in words."""

    def __init__(self, deck: MovingSupport, motion: UnitMotion, times: Sequence[float]) -> None:
        """Look at the motion at some times (s), to know how much room it needs."""
        self._deck, self.motion, self._outline = deck, motion, outline_of(motion.unit)
        self._used = margin_used(deck, motion.unit, motion.times)
        unit, body = motion.unit, motion.unit.body
        assert body.old is not None
        self._contacts = np.array([(body.old.x, body.old.y), (body.new.x, body.new.y)])
        self._is_disc = unit.scene.radius > 0.0
        start = unit.start._replace(x=unit.start.x + unit.foot[0], y=unit.start.y + unit.foot[1])
        self._edges = placed(self._contacts, start)
        standing = placed(self._outline, start)[:, 0]
        self._pivot = np.array([0.5 * (standing.min() + standing.max()), self._edges[:, 1].min()])
        seen = np.concatenate([self._seen(placed(self._outline, motion.at(time)), time) for time in times[::5]])
        low, high = seen.min(axis=0), seen.max(axis=0)
        self._middle, self._size = 0.5 * (low + high), max(float((high - low).max()), 1e-3)

    def view(self) -> View:
        """The view by a camera that goes with the deck but stays upright; port is on the left."""
        (x, y), half = self._middle, 0.575 * self._size
        window = (x + 1.3 * half, x - 1.3 * half, y - half, y + half)
        flashes = []
        for impact in self.motion.impacts:
            time, contacts = impact.stamp / NANOSECONDS, self.motion.unit.contacts
            place = self._places(self.motion.at(time))[contacts.index(impact.new) if impact.new in contacts else 1]
            flashes.append(Flash(time, impact.mode.name, self._seen(place[None], time)[0]))
        name = self.motion.unit.name
        return View(name, lambda time: window, self._outlines, self._caption, flashes)

    def colour(self, time: float) -> str:
        """Red while it moves, else by how much of its margin is used."""
        moves, used, _ = self._doing(time)
        return MARGINS[2 if moves or used >= 1.0 else 1 if used >= Watching().warn else 0]

    def _outlines(self, time: float) -> list[Outline]:
        state, far = self.motion.at(time), 3.0 * self._size
        shown = [Outline(box(-far, far, -0.05 * self._size, 0.0) + self._pivot, SUPPORT, size=0.0)]
        shown.append(Outline(placed(self._outline, state), self.colour(time), LINE))
        for place in self._places(state):
            closed = self._is_disc or place[1] - self._pivot[1] < 1e-3
            shown.append(Outline(place[None], CLOSED if closed else OPEN, CLOSED, 6.0, "o"))
        return [one._replace(points=self._seen(one.points, time)) for one in shown]

    def _places(self, state: PlanarState) -> NDArray[np.float64]:
        return self._edges if self._is_disc else placed(self._contacts, state)

    def _caption(self, time: float) -> tuple[str, str]:
        return self._doing(time)[2], "none"

    def _doing(self, time: float) -> tuple[bool, float, str]:
        """Whether it moves on the deck, how much of its margin is used, and what it does in words."""
        motion, state = self.motion, self.motion.at(time)
        used = float(np.interp(time, motion.times, self._used))
        tilt = degrees(state.angle - motion.unit.start.angle)
        if motion.toppled and time >= motion.ended:
            return True, used, "has toppled"
        if abs(tilt) > 0.03:
            return True, used, f"rocks, tilted by {abs(tilt):.2g}°"
        if abs(state.vx) > _SLIDES:
            return True, used, f"slides at {abs(state.vx):.2g} m/s"
        return False, used, f"stands, {100.0 * min(used, 9.99):.0f} % of its margin used"

    def _seen(self, points: NDArray[np.float64], time: float) -> NDArray[np.float64]:
        return np.asarray(turned(points - self._pivot, float(self._deck.motion(time).angle)) + self._pivot)
