"""A moving picture of a deck and the units on it: the vessel above, the busiest units near by, its roll below."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Final

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray
from PIL import Image

from ...mechanics.support import MovingSupport
from ...prediction.scene import Watching
from ...stamps import NANOSECONDS
from ..figure import STYLE
from .animation import STEP, Picture, check_animation, save_film
from .course import Course
from .deck_figure import ROLL, busiest
from .deck_stage import LEVELS, SKY, UnitStage, Vessel
from .stage import LINE, STRUCK

LONGEST: Final = 12.0
"""Seconds of a motion that are shown, in real time: those in which most units move."""

_UNITS: Final = 3
"""Units that are seen from near by."""
_WIDTH, _HEIGHT, _DPI = 7.0, 5.6, 90
_TILTS, _SLIDES = 0.003, 0.02
"""A unit moves that is turned by so many rad, or slides at so many m/s."""


def deck_frames(courses: Sequence[Course]) -> list[float]:
    """The times in s of the frames: the part of the motion in which most units move, a little before them included."""
    times = courses[0].times
    step = float(times[1] - times[0])
    busy = np.sum([_moves(course) for course in courses], axis=0, dtype=float)
    length = min(len(times), round(LONGEST / step))
    sums = np.convolve(busy, np.ones(length), mode="valid")
    best = np.flatnonzero(sums >= sums.max() - 1e-9)
    # In the middle of those that show as much.
    begin = float(times[best[len(best) // 2]]) if sums.max() > 0.0 else 0.0
    end = min(begin + LONGEST, float(times[-1]))
    return [begin + STEP * k for k in range(max(2, 1 + int((end - begin) / STEP)))]


def _moves(course: Course) -> NDArray[np.bool_]:
    with np.errstate(invalid="ignore"):
        moving: NDArray[np.bool_] = (np.abs(course.tilt) > _TILTS) | (np.abs(course.speed) > _SLIDES)
    return moving


def write_deck_animation(
    path: str | os.PathLike[str],
    deck: MovingSupport,
    courses: Sequence[Course],
    tell: Callable[[int], None] | None = None,
) -> None:
    """Draw a deck with units as a GIF, `deck_frames` in real time; `tell` takes how many of them are done.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_animation(path)
    times = deck_frames(courses)
    with matplotlib.rc_context(STYLE):
        save_film(path, _Film(deck, courses, np.array(times)).frame, times, tell)


class _Film:
    """The picture at any moment."""

    def __init__(self, deck: MovingSupport, courses: Sequence[Course], times: NDArray[np.float64]) -> None:
        near = busiest(courses, _UNITS)
        figure = Figure(figsize=(_WIDTH, _HEIGHT), dpi=_DPI)
        FigureCanvasAgg(figure)
        self._stages = [
            UnitStage(figure.add_axes(((k + 0.02) / len(near), 0.22, 0.96 / len(near), 0.33)), deck, course, times)
            for k, course in enumerate(near)
        ]
        whole = figure.add_axes((0.0, 0.655, 1.0, 0.3), facecolor=SKY)
        self._vessel = Vessel(whole, deck, near, times)
        self._roll = _Roll(figure.add_axes((0.07, 0.055, 0.91, 0.11)), deck, near, times)
        self._clock = figure.text(0.985, 0.985, "", ha="right", va="top", family="monospace", fontsize=10)
        warn = f"{100.0 * Watching().warn:.0f}"
        names = (f"margin up to {warn} % used", f"{warn} to 100 %", "used up, or it moves")
        signs = [
            Patch(facecolor=colour, edgecolor=LINE, label=name) for colour, name in zip(LEVELS, names, strict=True)
        ]
        figure.legend(handles=signs, loc="upper left", ncols=3, fontsize=8.5, handlelength=1.2, columnspacing=1.2)
        moving = [self._clock, *self._vessel.moving, *self._roll.moving]
        for stage in self._stages:
            moving += stage.moving
        self._picture = Picture(figure, moving)

    def frame(self, time: float) -> Image.Image:
        """The picture at a time in s."""
        self._vessel.show(time, [stage.colour(time) for stage in self._stages])
        for stage in self._stages:
            stage.show(time)
        self._roll.show(time)
        self._clock.set_text(f"t = {time:6.2f} s")
        return self._picture.now()


class _Roll:
    """The deck's roll against time with the impacts in it; `show` moves its end to a moment."""

    def __init__(self, axes: Axes, deck: MovingSupport, courses: Sequence[Course], times: NDArray[np.float64]) -> None:
        self._times, self._angles = times, np.degrees(deck.motion(times).angle)
        axes.plot(times, self._angles, color=ROLL, linewidth=1.0, alpha=0.3)
        (self._line,) = axes.plot([], [], color=ROLL, linewidth=1.8)
        (self._dot,) = axes.plot([], [], "o", color=ROLL, markersize=6)
        axes.axhline(0.0, color="#666666", linewidth=0.8)
        struck = sorted(impact.stamp / NANOSECONDS for course in courses for impact in course.impacts)
        self._struck = np.array([time for time in struck if times[0] <= time <= times[-1]])
        high = 1.25 * max(float(np.abs(self._angles).max()), 0.1)
        self._low = -high
        (self._ticks,) = axes.plot([], [], "|", color=STRUCK, markersize=9, markeredgewidth=1.2, clip_on=False)
        axes.set(xlim=(times[0], times[-1]), ylim=(-high, high))
        axes.set_title("roll (°) against time (s), and the impacts", fontsize=9, pad=3)
        axes.tick_params(labelsize=8)
        self.moving = [self._line, self._dot, self._ticks]

    def show(self, time: float) -> None:
        passed = self._times <= time + 1e-9
        self._line.set_data(self._times[passed], self._angles[passed])
        self._dot.set_data([time], [np.interp(time, self._times, self._angles)])
        struck = self._struck[self._struck <= time]
        self._ticks.set_data(struck, np.full(len(struck), self._low))
