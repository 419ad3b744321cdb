"""A deck's motion and what it does to the units on it: roll and heave, then tilt, slide, margin and impacts of each."""

from __future__ import annotations

import os
from collections.abc import Sequence
from math import degrees, pi
from typing import Any, Final

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ...mechanics.rocking import End
from ...mechanics.support import MovingSupport
from ...mechanics.types import Mode
from ...prediction.scene import Watching
from ...stamps import NANOSECONDS
from ..figure import MODE_MARKERS, STYLE, check_figure, save_figure
from ..maps.figure import COLOURS as MODE_COLOURS
from ..summary import words
from .course import Course, margin_used, moments

ROLL, HEAVE, TILT, SLID = "#0072B2", "#8a6d3b", "#1a1a1a", "#009E73"
MARGINS: Final = ("#dfe6e1", "#f2a91a", "#d62728")
"""Colours of a margin that is used little, enough to warn, and up."""

_SLIDES: Final = 0.005
"""A slide of so many m is drawn."""
_TILTS: Final = pi / 1800.0
"""A tilt of so many rad is told."""
_STRIP: Final = 0.09
"""Part of a lane's height on which its margin is drawn."""


def write_deck_figure(path: str | os.PathLike[str], deck: MovingSupport, courses: Sequence[Course]) -> None:
    """Draw the deck above, and below the units that moved most, into a PNG or SVG file.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_figure(path)
    shown = busiest(courses, 6)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10.0, 2.6 + 1.25 * len(shown)), layout="constrained")
        FigureCanvasAgg(figure)
        upper, *lanes = figure.subplots(1 + len(shown), 1, sharex=True, height_ratios=(1.25, *[1.0] * len(shown)))
        times = courses[0].times
        upper.set_title(title_of(courses, len(shown)), fontweight="bold")
        draw_deck(upper, deck, times)
        for axes, course in zip(lanes, shown, strict=True):
            _draw_unit(axes, deck, course)
        lanes[-1].set(xlim=(0.0, times[-1]), xlabel="time (s)")
        figure.align_ylabels()
        figure.legend(handles=_signs(shown), loc="outside lower center", ncols=5, columnspacing=1.4, handletextpad=0.5)
        save_figure(figure, path)


def busiest(courses: Sequence[Course], most: int) -> list[Course]:
    """The units that turned or slid most, in the order in which they were given."""
    chosen = sorted(courses, key=_busyness, reverse=True)[:most]
    return [course for course in courses if course in chosen]


def _busyness(course: Course) -> tuple[bool, int, float]:
    return course.toppled, len(course.impacts), greatest(course.slid)


def greatest(values: NDArray[np.float64]) -> float:
    """The largest size of numbers, some of which are NaN."""
    return float(np.nanmax(np.abs(values)))


def title_of(courses: Sequence[Course], shown: int) -> str:
    """What happened, in words."""
    impacts = sum(len(course.impacts) for course in courses)
    toppled = sum(course.toppled for course in courses)
    units = f"{len(courses)} units" if len(courses) > 1 else "One unit"
    told = f"{units} on a rolling deck: {impacts} impacts" + (f", {toppled} toppled" if toppled else "")
    return told + (f"; the {shown} that moved most" if shown < len(courses) else "")


def draw_deck(axes: Axes, deck: MovingSupport, times: NDArray[np.float64]) -> None:
    """Roll and heave of the deck against time."""
    motion = deck.motion(moments(float(times[-1])))
    seen = moments(float(times[-1]))
    axes.plot(seen, np.degrees(motion.angle), color=ROLL, linewidth=1.5)
    axes.set_ylabel("deck roll (°)", color=ROLL)
    axes.axhline(0.0, color="#666666", linewidth=0.8, zorder=1)
    heave = axes.twinx()
    heave.plot(seen, motion.y - np.mean(motion.y), color=HEAVE, linewidth=1.2, linestyle=(0, (4, 1.5)))
    heave.set_ylabel("heave (m)", color=HEAVE)
    heave.grid(False)
    axes.set_zorder(heave.get_zorder() + 1.0)
    axes.patch.set_visible(False)
    for one, values in ((axes, np.degrees(motion.angle)), (heave, motion.y - np.mean(motion.y))):
        high = 1.15 * max(float(np.abs(values).max()), 1e-3)
        one.set_ylim(-high, high)


def _draw_unit(axes: Axes, deck: MovingSupport, course: Course) -> None:
    times, tilt = course.times, np.degrees(course.tilt)
    # A unit that has toppled would leave no room for how it rocked before.
    rocked = tilt if not course.toppled else np.where(times < course.ended - 2.0, tilt, np.nan)
    high = 1.3 * max(10.0 * degrees(_TILTS), float(np.nanmax(np.abs(rocked), initial=0.0)))
    axes.plot(times, tilt, color=TILT, linewidth=1.2)
    axes.axhline(0.0, color="#666666", linewidth=0.8, zorder=1)
    axes.set(ylim=(-1.35 * high, high), ylabel="tilt (°)")
    axes.set_title(_fate(course), fontsize=10, pad=3)
    _draw_margin(axes, times, margin_used(deck, course.unit, times))
    if greatest(course.slid) > _SLIDES:
        slid = axes.twinx()
        slid.plot(times, course.slid, color=SLID, linewidth=1.6)
        reach = 1.3 * greatest(course.slid)
        slid.set_ylim(-1.35 * reach, reach)
        slid.set_ylabel("slid (m)", color=SLID)
        slid.grid(False)
    for mode in sorted({impact.mode for impact in course.impacts}):
        at = [impact.stamp / NANOSECONDS for impact in course.impacts if impact.mode is mode]
        axes.plot(at, np.zeros(len(at)), color=MODE_COLOURS[mode], **_sign(mode))
    if course.toppled:
        axes.plot([course.ended], [0.0], "X", color=MARGINS[2], markersize=11, markeredgecolor="white", zorder=5)


def _sign(mode: Mode) -> dict[str, Any]:
    sign = {"marker": MODE_MARKERS.get(mode, "x"), "markersize": 6.5, "markeredgecolor": "#1a1a1a"}
    return {**sign, "markeredgewidth": 0.6, "linestyle": "", "zorder": 4}


def _fate(course: Course) -> str:
    """What became of a unit, in words."""
    told = [f"{len(course.impacts)} impacts"] if course.impacts else []
    if not course.toppled and greatest(course.tilt) > _TILTS:
        told.append(f"tilts {degrees(greatest(course.tilt)):.2g}°")
    if greatest(course.slid) > _SLIDES:
        told.append(f"slides {greatest(course.slid):.2g} m")
    if course.toppled:
        told.append(f"topples at {course.ended:.0f} s")
    elif course.end is not End.TIME_UP:
        told.append(f"is lost at {course.ended:.0f} s")
    return f"{course.unit.name}: {', '.join(told) or 'stays where it is'}"


def _draw_margin(axes: Axes, times: NDArray[np.float64], used: NDArray[np.float64]) -> None:
    """A strip along the bottom: how much of the margin against sliding and tipping is used."""
    # Never thinner than can be seen.
    half = max(0.5 * (times[1] - times[0]), 8e-4 * (times[-1] - times[0]))
    axes.axvspan(times[0], times[-1], 0.0, _STRIP, color=MARGINS[0], linewidth=0.0)
    warn = Watching().warn
    for least, colour in ((warn, MARGINS[1]), (1.0, MARGINS[2])):
        over = np.flatnonzero(np.diff(np.concatenate([[False], used >= least, [False]]).astype(int)))
        for first, last in over.reshape(-1, 2):
            begin, end = times[first] - half, times[last - 1] + half
            axes.axvspan(begin, end, 0.0, _STRIP, color=colour, linewidth=0.0)


def _signs(courses: Sequence[Course]) -> list[Artist]:
    """The legend."""
    modes = sorted({impact.mode for course in courses for impact in course.impacts})
    handles: list[Artist] = [
        Line2D([], [], color=MODE_COLOURS[mode], label=f"impact: {words(mode.name)}", **_sign(mode)) for mode in modes
    ]
    if any(course.toppled for course in courses):
        sign: dict[str, Any] = {"marker": "X", "markersize": 10, "markeredgecolor": "white", "linestyle": ""}
        handles.append(Line2D([], [], color=MARGINS[2], label="topples", **sign))
    warn = Watching().warn
    names = (f"margin: up to {warn:g} used", f"{warn:g} to 1", "used up: slides or tips")
    return handles + [Patch(facecolor=colour, label=name) for colour, name in zip(MARGINS, names, strict=True)]
