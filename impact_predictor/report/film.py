"""Moving pictures as GIF: bodies and supports as outlines over time, and curves against time below them."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from math import cos, pi, sin
from typing import Any, Final, NamedTuple, cast

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from PIL import Image

from ..mechanics.motion import PlanarState
from .files import whole
from .plot import GREY, STYLE, Axes, Figure, Patch, check_film

BODY, LINE, SUPPORT, STRUCK = "#dbe4ee", "#33475b", "#b5ada0", "#d62728"
CLOSED, SLIPS, OPEN = "#1a1a1a", "#e69f00", "#ffffff"
SPEEDS: Final = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""What a film may be slowed down or sped up by: numbers that one can think in."""
STEP: Final = 0.06
"""Seconds for which a frame is seen; GIF counts in hundredths of a second."""

_LONGEST: Final = 10.0
"""Seconds that a film lasts at most, unless its motion is longer than the highest speed can show."""
_STILL: Final = 1.5
"""Seconds for which the end is seen before it begins again."""
_FLASH: Final = 0.8
"""Seconds of the film for which an impact is seen."""
_COLOURS: Final = 64
_WIDTH, _DPI = 7.0, 90


class Outline(NamedTuple):
    """Points (n, 2) in m at a moment: a polygon with a `face`, an open line without, or single marks of `size`."""

    points: NDArray[np.float64]
    face: str = "none"
    edge: str = "none"
    size: float = 1.3
    mark: str = ""


class Flash(NamedTuple):
    """An impact at a `time` in s, in words, and its `place` (x, y) in m."""

    time: float
    words: str
    place: NDArray[np.float64]


def fixed_camera(points: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Points (n, 2) as they are seen by a camera that does not move."""
    return points


class View(NamedTuple):
    """What is seen of a body, as functions of the time in s.

    `window` is (left, right, bottom, top) in m, `outlines` come from the back to the front, and `caption` is what the
    body does, in words on a colour. `camera` turns points to where they are seen.
    """

    title: str
    window: Callable[[float], tuple[float, float, float, float]]
    outlines: Callable[[float], Sequence[Outline]]
    caption: Callable[[float], tuple[str, str]] = lambda time: ("", "none")
    flashes: Sequence[Flash] = ()
    camera: Callable[[NDArray[np.float64], float], NDArray[np.float64]] = fixed_camera


class Curve(NamedTuple):
    """A curve against time in s, with gaps where it is NaN."""

    time: NDArray[np.float64]
    value: NDArray[np.float64]
    colour: str


class Film(NamedTuple):
    """A moving picture: rows of views with their heights in inches, and below them curves, which grow.

    `speed` is seconds of the motion for each one of the film, `times` (s) those of its frames; `levels` are dashed
    lines, `ticks` (s) impacts; `legend` has colours and their meanings.
    """

    title: str
    rows: Sequence[Sequence[View]]
    heights: Sequence[float]
    curves: Sequence[Curve]
    curves_title: str
    speed: float
    times: Sequence[float]
    levels: Sequence[float] = ()
    ticks: Sequence[float] = ()
    legend: Sequence[tuple[str, str]] = ()


def speed_for(longest: float) -> float:
    """How fast the film of a motion of so many s runs: the slowest of `SPEEDS` that shows it within its time."""
    return next((speed for speed in SPEEDS if longest <= speed * _LONGEST), SPEEDS[-1])


def frames_of(longest: float) -> list[float]:
    """The moments in s at which the frames of a whole motion are drawn."""
    step = speed_for(longest) * STEP
    return [k * step for k in range(2 + int(longest / step))]


def write_film(path: str | os.PathLike[str], film: Film, tell: Callable[[int], None] | None = None) -> None:
    """Draw a film as a GIF; `tell` takes how many frames are done.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_film(path)
    with matplotlib.rc_context(STYLE):
        screen, frames = _Screen(film), list[Image.Image]()
        for done, time in enumerate(film.times, 1):
            frames.append(screen.frame(time))
            if tell is not None:
                tell(done)
    palette = _palette_of(frames[:: max(1, len(frames) // 12)])
    first, *others = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    durations = [round(1000 * STEP)] * len(others) + [round(1000 * _STILL)]
    with whole(path) as partial:
        first.save(partial, "GIF", save_all=True, append_images=others, duration=durations, loop=0, optimize=True)


def _palette_of(frames: Sequence[Image.Image]) -> Image.Image:
    """The commonest colours of some frames as one palette for all, so that of each only what changes is stored."""
    count: Counter[Any] = Counter()
    for frame in frames:
        count.update({colour: number for number, colour in frame.getcolors(frame.width * frame.height) or ()})
    count[tuple(round(255.0 * part) for part in to_rgb(STRUCK))] = sum(count.values())  # whatever few pixels it has
    # Pillow does not tell colours apart whose parts differ by less than eight.
    apart: dict[tuple[int, ...], tuple[int, ...]] = {}
    for colour, _ in count.most_common():
        apart.setdefault(tuple(part >> 3 for part in colour), colour)
    palette = Image.new("P", (1, 1))
    palette.putpalette([part for colour in list(apart.values())[:_COLOURS] for part in colour])
    return palette


class _Screen:
    """The figure of a film, of which only what moves is drawn anew.

    That takes 26 ms for a frame, where matplotlib's PillowWriter takes 56 ms and more.
    """

    def __init__(self, film: Film) -> None:
        self._film, self._drawn = film, list[Any]()
        head, room, foot = (0.55 if film.legend or film.title else 0.3), 0.55, 0.3
        total = head + sum(height + room for height in film.heights) + 1.35 + foot
        self.figure = Figure(figsize=(_WIDTH, total), dpi=_DPI)
        self._canvas = cast(Any, FigureCanvasAgg(self.figure))  # its methods have no types
        self._views: list[tuple[View, Axes]] = []
        top = total - head
        for row, height in zip(film.rows, film.heights, strict=True):
            top -= height + 0.6 * room
            for k, view in enumerate(row):
                place = (k / len(row), top / total, 1.0 / len(row), height / total)
                axes = self.figure.add_axes(place, aspect="equal", anchor="C")
                axes.set_axis_off()
                axes.set_title(view.title, fontsize=10, loc="center", pad=14.0, fontweight="bold")
                self._views.append((view, axes))
            top -= 0.4 * room
        self._curves = self._draw_curves(self.figure.add_axes((0.07, foot / total, 0.91, 1.0 / total)))
        for line, (text, weight) in enumerate(((film.title, "bold"), (pace_of(film.speed), "normal"))):
            down = 0.1 + (0.22 * line if film.title else 0.0)
            self.figure.text(0.02, 1.0 - down / total, text, va="top", fontweight=weight)
        signs = [Patch(facecolor=colour, edgecolor=LINE, label=words) for colour, words in film.legend]
        if signs:
            self.figure.legend(
                handles=signs, loc="upper left", bbox_to_anchor=(0.0, 1.0 - 0.3 / total), ncols=3, fontsize=8.5
            )
        self._clock: dict[str, Any] = {"x": 0.98, "y": 1.0 - 0.1 / total, "ha": "right", "va": "top"}
        for view, axes in self._views:
            left, right, bottom, top = view.window(film.times[0])
            axes.set(xlim=(left, right), ylim=(bottom, top))
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(self.figure.bbox)

    def frame(self, time: float) -> Image.Image:
        """The picture at a time in s."""
        self._canvas.restore_region(self._still)
        digits = 4 if self._film.speed < 0.02 else 3 if self._film.speed < 0.2 else 2
        self._drawn = [self.figure.text(s=f"t = {time:.{digits}f} s", family="monospace", **self._clock)]
        for view, axes in self._views:
            left, right, bottom, top = view.window(time)
            axes.set(xlim=(left, right), ylim=(bottom, top))
            for outline in view.outlines(time):
                self._draw_outline(axes, outline._replace(points=view.camera(outline.points, time)))
            self._draw_words(axes, view, time)
        for curve, line, dot in self._curves:
            passed = ~(curve.time > time + 1e-9)
            line.set_data(curve.time[passed], curve.value[passed])
            known = passed & ~np.isnan(curve.value)
            dot.set_data(curve.time[known][-1:], curve.value[known][-1:])
            self._drawn += [line, dot]
        for artist in self._drawn:
            self.figure.draw_artist(artist)
            if not artist.get_animated():
                artist.remove()
        return Image.fromarray(np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy())

    def _draw_outline(self, axes: Axes, outline: Outline) -> None:
        points, face, edge, size, mark = outline
        x, y = points.T
        if mark:
            self._drawn += axes.plot(x, y, marker=mark, color=face, markeredgecolor=edge, markersize=size, linestyle="")
        elif face == "none":
            self._drawn += axes.plot(x, y, color=edge, linewidth=size, solid_capstyle="round")
        else:
            self._drawn += axes.fill(x, y, facecolor=face, edgecolor=edge, linewidth=size, zorder=2.0)

    def _draw_words(self, axes: Axes, view: View, time: float) -> None:
        words: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "fontsize": 9}
        caption, colour = view.caption(time)
        box = {"facecolor": colour, "edgecolor": "none", "pad": 2.5}
        self._drawn.append(axes.text(0.5, -0.02, caption, va="top", bbox=box, **words))
        passed = [flash for flash in view.flashes if flash.time <= time]
        age = (time - passed[-1].time) / (self._film.speed * _FLASH) if passed else 1.0
        if age < 1.0:
            last = passed[-1]
            ring: dict[str, Any] = {
                "markerfacecolor": "none",
                "markeredgecolor": STRUCK,
                "markeredgewidth": 3.0 * (1.0 - age),
            }
            x, y = view.camera(last.place[None], time).T
            self._drawn += axes.plot(x, y, "o", markersize=8.0 + 20.0 * age, zorder=6, **ring)
            self._drawn.append(axes.text(0.5, 1.0, last.words, va="bottom", color=STRUCK, fontweight="bold", **words))

    def _draw_curves(self, axes: Axes) -> list[tuple[Curve, Any, Any]]:
        film, drawn = self._film, []
        for curve in film.curves:
            axes.plot(curve.time, curve.value, color=curve.colour, linewidth=1.0, alpha=0.3)
            (line,) = axes.plot([], [], color=curve.colour, linewidth=1.8)
            (dot,) = axes.plot([], [], "o", color=curve.colour, markersize=6)
            line.set_animated(True)
            dot.set_animated(True)
            drawn.append((curve, line, dot))
        axes.axhline(0.0, color=GREY, linewidth=0.8)
        for level in film.levels:
            axes.axhline(level, color="#555555", linewidth=0.8, linestyle=(0, (5, 3)))
        axes.plot(
            film.ticks, [0.0] * len(film.ticks), "|", color=STRUCK, markersize=9, transform=axes.get_xaxis_transform()
        )
        axes.set(xlim=(film.times[0], film.times[-1]))
        axes.set_title(film.curves_title, fontsize=9, pad=3)
        axes.tick_params(labelsize=8)
        return drawn


def gapped(spans: Iterable[tuple[float, float]], points: int, end: float) -> NDArray[np.float64]:
    """Times in s within spans (begin, end), in `points` for the time until `end`, with a NaN after each."""
    times = [np.zeros(0)]
    for begin, last in spans:
        if last > begin:
            count = max(2, round(points * (last - begin) / end))
            # Right before the impact that ends it.
            times += [np.linspace(begin, np.nextafter(last, begin), count), np.array([np.nan])]
    return np.concatenate(times)


def pace_of(speed: float) -> str:
    """The speed of a film in words."""
    if speed == 1.0:
        return "real time"
    return f"slowed down {1.0 / speed:g} times" if speed < 1.0 else f"sped up {speed:g} times"


def circle(radius: float) -> NDArray[np.float64]:
    """The outline of a disc."""
    turns = np.linspace(0.0, 2.0 * pi, 73)
    return radius * np.column_stack((np.cos(turns), np.sin(turns)))


def box(left: float, right: float, bottom: float, top: float) -> NDArray[np.float64]:
    """The outline of a rectangle."""
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def turned(points: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Points (n, 2) turned by an angle in rad."""
    c, s = cos(angle), sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def placed(points: NDArray[np.float64], state: PlanarState) -> NDArray[np.float64]:
    """Points (n, 2) of a body in the frame in which its state is given."""
    return np.asarray(turned(points, state.angle) + np.array([state.x, state.y]))
