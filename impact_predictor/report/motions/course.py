"""How cargo units moved on a deck, taken up span by span, as pictures need it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import hypot
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ...mechanics.motion import PlanarState
from ...mechanics.rocking import End
from ...mechanics.support import MovingSupport
from ...prediction.watch.onset import Onset, motions
from ...prediction.watch.standing import Standing
from ...ros.markers.shapes import box_of
from ...scenarios.deck.cargo import CargoUnit, Span
from ...scenarios.truth import TrueImpact, TrueOnset
from .stage import circle

_MOST: Final = 200_000
"""Moments of a picture of a long motion; a rocking unit takes a second or so to and fro."""
_STEP: Final = 0.05
"""Seconds between the moments of a picture of a shorter one."""


def moments(duration: float) -> NDArray[np.float64]:
    """Times in s at which a picture of a motion needs the state of each unit."""
    return np.linspace(0.0, duration, min(_MOST, max(2, round(duration / _STEP) + 1)))


class Course:
    """The motion of one unit at `times` (s), in the deck's plane from the deck's origin; NaN where it is not followed.

    `impacts` and `onsets` of it; `end` says how it ended, and `ended` when (s).
    """

    def __init__(self, unit: CargoUnit, times: NDArray[np.float64]) -> None:
        self.unit, self.times = unit, times
        self.impacts: list[TrueImpact] = []
        self.onsets: list[TrueOnset] = []
        self.end, self.ended = End.TIME_UP, 0.0
        self._states: NDArray[np.float64] = np.full((6, len(times)), np.nan)

    def taking(self, spans: Iterable[Span]) -> Iterator[Span]:
        """The spans of the motion, each taken up as it passes."""
        for span in spans:
            self._take(span)
            yield span

    def _take(self, span: Span) -> None:
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
        return self.end is End.OVERTURNED

    @property
    def tilt(self) -> NDArray[np.float64]:
        """Angles in rad from how it stood."""
        angles: NDArray[np.float64] = self._states[2] - self.unit.start.angle
        return angles

    @property
    def slid(self) -> NDArray[np.float64]:
        """Ways in m along the deck of the lower one of its contacts from where it stood; 0 for a cylinder on edges."""
        body, (x, _, angle, *_) = self.unit.body, self._states
        assert body.old is not None
        if self.unit.scene.radius > 0.0:
            rest: NDArray[np.float64] = 0.0 * angle
            return rest
        c, s = np.cos(angle), np.sin(angle)
        old, new = body.old, body.new
        old_is_lower = s * old.x + c * old.y < s * new.x + c * new.y
        turned = np.where(old_is_lower, (c - 1.0) * old.x - s * old.y, (c - 1.0) * new.x - s * new.y)
        way: NDArray[np.float64] = turned + x - self.unit.foot[0] - self.unit.start.x
        return way

    @property
    def speed(self) -> NDArray[np.float64]:
        """Of the mass centre along the deck in m/s."""
        along: NDArray[np.float64] = self._states[3]
        return along


class Courses:
    """The motions of all units of a deck over `duration` (s), for its pictures, once its spans have passed `taking`."""

    def __init__(self, duration: float) -> None:
        self.times = moments(duration)
        self.all: list[Course] = []

    def taking(self, unit: CargoUnit, spans: Iterable[Span]) -> Iterator[Span]:
        """The spans of a unit, taken up as they pass."""
        course = Course(unit, self.times)
        self.all.append(course)
        return course.taking(spans)


def outline_of(unit: CargoUnit) -> NDArray[np.float64]:
    """The outline (n, 2) in m of a unit seen along the deck, from its mass centre, while it stands."""
    scene, body = unit.scene, unit.body
    assert body.old is not None
    if scene.radius > 0.0:
        return circle(hypot(body.old.x, body.old.y))
    (low, high), center = box_of(scene.points, scene.center_of_mass), scene.center_of_mass
    c, s = np.cos(scene.yaw), np.sin(scene.yaw)
    across = [s * (x - center[0]) + c * (y - center[1]) for x in (low[0], high[0]) for y in (low[1], high[1])]
    left, right, bottom, top = min(across), max(across), low[2] - center[2], high[2] - center[2]
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def margin_used(deck: MovingSupport, unit: CargoUnit, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """The larger part that is used of the margins of a unit against sliding and tipping, where it began: 1 at the
    onset. `deck` is the support's motion, of its own frame.
    """
    stance = Standing(unit.scene).stance
    if stance is None:
        return np.zeros_like(times)
    felt = deck.felt_at(times)
    none = np.zeros_like(times)
    gravity = np.stack([none, felt[:, 0], felt[:, 1]], axis=1)
    angular, turning = (np.stack([felt[:, k], none, none], axis=1) for k in (2, 3))
    margins = Onset([stance]).margins(motions(gravity, angular, turning))
    used: NDArray[np.float64] = np.maximum(margins.slide, margins.tip)[0]
    return used
