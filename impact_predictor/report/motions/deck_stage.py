"""The parts of a moving picture of a deck: the vessel seen from astern, and one unit from near by."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any, Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from ...mechanics.motion import PlanarState
from ...mechanics.support import MovingSupport
from ...prediction.scene import Watching
from ...stamps import NANOSECONDS
from .course import Course, margin_used, outline_of
from .stage import CLOSED, LINE, OPEN, STRUCK, SUPPORT, placed

LEVELS: Final = ("#8fc9a3", "#f2a91a", "#e0584f")
"""Colours of a unit whose margin is used little, enough to warn, and up, so that it may move."""
SEA, SKY, HULL = "#9cc4dd", "#f3f8fb", "#5d6b78"
_HALF_BEAM: Final = 6.0
"""Half the breadth in m of a deck whose extent nobody tells."""
_FLASH: Final = 0.8
"""Seconds for which an impact is seen."""
_ROOM: Final = 1.15
"""How much wider than all that is ever seen of a unit its picture is."""


class Vessel:
    """The vessel in still water, seen from astern, with its units; it rolls, heaves and sways."""

    def __init__(self, axes: Axes, deck: MovingSupport, courses: Sequence[Course], times: NDArray[np.float64]) -> None:
        self._deck, self._courses = deck, courses
        half = half_beam(courses)
        motion = deck.motion(times)
        self._middle = float(np.mean(motion.x)), float(np.mean(motion.y))
        depth, water = 0.42 * half, -0.16 * half
        # From the deck's edge down to the bilge and over the keel, to the other edge.
        side = [(half, 0.0), (0.98 * half, -0.5 * depth), (0.86 * half, -0.9 * depth), (0.6 * half, -depth)]
        self._hull = np.array(side + [(-y, z) for y, z in reversed(side)])
        axes.set_aspect("equal")
        axes.set_axis_off()
        high = 2.0 * max(float(outline_of(course.unit)[:, 1].max()) for course in courses)
        # From astern port is on the left.
        heave = float(np.abs(motion.y - self._middle[1]).max())
        low, top = -0.45 * half - heave, max(0.5 * half, high + 0.1 * half) + heave
        aside = 1.6 * (top - low)  # about the picture's own shape
        axes.set(xlim=(aside, -aside), ylim=(low, top))
        axes.axhspan(-2.0 * half, water, color=SEA, linewidth=0.0, zorder=0)
        axes.text(aside, water, "  port", va="bottom", ha="left", fontsize=8, color=LINE)
        axes.text(-aside, water, "starboard  ", va="bottom", ha="right", fontsize=8, color=LINE)
        self._shape = polygon(axes, facecolor=HULL, edgecolor=LINE, linewidth=1.0)
        self._sea = axes.axhspan(-2.0 * half, water, color=SEA, alpha=0.55, linewidth=0.0, zorder=3)
        self._units = [polygon(axes, edgecolor=LINE, linewidth=0.8, zorder=2) for _ in courses]
        self.moving: list[Artist] = [*self._units, self._shape, self._sea]

    def show(self, time: float, colours: Sequence[str]) -> None:
        """Draw it as it is at a time in s, the units in their colours."""
        motion = self._deck.motion(time)
        turned = Affine2D().rotate(motion.angle)
        turned.translate(motion.x - self._middle[0], motion.y - self._middle[1])
        self._shape.set_xy(turned.transform(self._hull))
        for patch, course, colour in zip(self._units, self._courses, colours, strict=True):
            patch.set_xy(turned.transform(placed(outline_of(course.unit), course.at(time))))
            patch.set_facecolor(colour)


def polygon(axes: Axes, **looks: Any) -> Polygon:
    """A shape that is to be moved to where it is."""
    shape = Polygon(np.zeros((1, 2)), closed=True, **looks)
    axes.add_patch(shape)
    return shape


def half_beam(courses: Sequence[Course]) -> float:
    """Half the breadth of the deck in m."""
    scene = courses[0].unit.scene
    extent = scene.deck.extent if scene.deck is not None else ()
    return max(abs(extent[2]), abs(extent[3])) if extent else _HALF_BEAM


class UnitStage:
    """One unit on its piece of the deck, which rolls; what it does, and how much of its margin is used, in words."""

    def __init__(self, axes: Axes, deck: MovingSupport, course: Course, times: NDArray[np.float64]) -> None:
        self._deck, self._course = deck, course
        self._used = margin_used(deck, course.unit, course.times)
        unit, body = course.unit, course.unit.body
        assert body.old is not None
        self._contacts = np.array([(body.old.x, body.old.y), (body.new.x, body.new.y)])
        self._outline = outline_of(unit)
        self._is_disc = unit.scene.radius > 0.0
        start = PlanarState(*(part + shift for part, shift in zip(unit.start, (*unit.foot, 0, 0, 0, 0), strict=True)))
        standing = placed(self._outline, start)
        self._pivot = 0.5 * (standing[:, 0].min() + standing[:, 0].max()), placed(self._contacts, start)[:, 1].min()
        self._edges = placed(self._contacts, start)
        seen = [self._seen(self._outline, course.at(float(time)), float(time)) for time in times[::5]]
        low = np.min([points.min(axis=0) for points in seen], axis=0)
        high = np.max([points.max(axis=0) for points in seen], axis=0)
        size = max(float((high - low).max()), 1e-3)
        middle = 0.5 * (low + high)
        half = 0.5 * _ROOM * size
        room = axes.get_window_extent()
        aside = half * max(1.0, room.width / room.height)
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.set(xlim=(middle[0] + aside, middle[0] - aside), ylim=(middle[1] - half, middle[1] + half))
        thick = 0.05 * size
        far = 3.0 * size
        self._plank = np.array([(-far, 0.0), (far, 0.0), (far, -thick), (-far, -thick)]) + self._pivot
        self._draw(axes)

    def colour(self, time: float) -> str:
        """Red while it moves, else by how much of its margin is used."""
        used = float(np.interp(time, self._course.times, self._used))
        doing, _ = self._doing(time, self._course.at(time), used)
        return LEVELS[2 if doing or used >= 1.0 else 1 if used >= Watching().warn else 0]

    def show(self, time: float) -> None:
        """Draw the unit as it is at a time in s."""
        course = self._course
        state = course.at(time)
        self._deck_piece.set_xy(self._seen(self._plank, None, time))
        self._shape.set_xy(self._seen(self._outline, state, time))
        self._shape.set_facecolor(self.colour(time))
        places = self._edges if self._is_disc else placed(self._contacts, state)
        for mark, place in zip(self._marks, places, strict=True):
            mark.set_data(*self._seen(place[None, :], None, time).T)
            closed = self._is_disc or place[1] - self._pivot[1] < 1e-3
            mark.set_markerfacecolor(CLOSED if closed else OPEN)
        self._say(time, state, places)

    def _say(self, time: float, state: PlanarState, places: NDArray[np.float64]) -> None:
        course = self._course
        used = float(np.interp(time, course.times, self._used))
        self._words.set_text(self._doing(time, state, used)[1])
        happened = [impact for impact in course.impacts if 0.0 <= time - impact.stamp / NANOSECONDS < _FLASH]
        for artist in (self._burst, self._mode):
            artist.set_visible(bool(happened))
        if happened:
            last = happened[-1]
            age = (time - last.stamp / NANOSECONDS) / _FLASH
            struck = places[course.unit.contacts.index(last.new) if last.new in course.unit.contacts else 1]
            self._burst.set_data(*self._seen(struck[None, :], None, time).T)
            self._burst.set(markersize=8.0 + 20.0 * age, markeredgewidth=3.0 * (1.0 - age))
            more = f" ({len(happened)} impacts)" if len(happened) > 1 else ""
            self._mode.set_text(last.mode.name.replace("_", " ") + more)

    def _doing(self, time: float, state: PlanarState, used: float) -> tuple[bool, str]:
        """Whether it moves on the deck, and what it does in words."""
        course = self._course
        tilt = degrees(state.angle - course.unit.start.angle)
        if course.toppled and time >= course.ended:
            return True, "has toppled"
        if abs(tilt) > 0.03:
            return True, f"rocks, tilted by {abs(tilt):.2g}°"
        if abs(state.vx) > 0.02:
            return True, f"slides at {abs(state.vx):.2g} m/s"
        return False, f"stands, {100.0 * min(used, 9.99):.0f} % of its margin used"

    def _seen(self, points: NDArray[np.float64], state: PlanarState | None, time: float) -> NDArray[np.float64]:
        """Points of the deck, or of a body in a state, for a camera that goes with the deck but stays upright."""
        on_deck = points if state is None else placed(points, state)
        turned = Affine2D().rotate_around(*self._pivot, float(self._deck.motion(time).angle))
        return np.asarray(turned.transform(on_deck))

    def _draw(self, axes: Axes) -> None:
        self._deck_piece = polygon(axes, facecolor=SUPPORT, edgecolor="none")
        self._shape = polygon(axes, edgecolor=LINE, linewidth=1.3)
        self._marks = [axes.plot([], [], "o", markersize=6, markeredgecolor=CLOSED, zorder=5)[0] for _ in range(2)]
        (self._burst,) = axes.plot([], [], "o", markerfacecolor="none", markeredgecolor=STRUCK, zorder=6)
        words: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "fontsize": 9}
        axes.text(0.5, 1.11, self._course.unit.name, va="bottom", fontweight="bold", **words)
        self._words = axes.text(0.5, 1.01, "", va="bottom", **words)
        self._mode = axes.text(0.5, -0.01, "", va="top", color=STRUCK, fontweight="bold", **words)
        self.moving: list[Artist] = [self._deck_piece, self._shape, *self._marks, self._burst, self._words, self._mode]
