"""The one place where matplotlib is imported: the style of all pictures, panels against time, and moving pictures."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import cos, pi, sin
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple

import matplotlib
import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes as Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Figure
from matplotlib.lines import Line2D as Line2D
from matplotlib.patches import Patch as Patch
from numpy.typing import NDArray
from PIL import Image

from ..mechanics.motion import PlanarState
from .files import named, whole
from .modes import EDGE, MODES

GREY: Final = "#666666"
BODY, LINE, SUPPORT, STRUCK = "#dbe4ee", "#33475b", "#b5ada0", "#d62728"
CLOSED, SLIPS, OPEN = "#1a1a1a", "#e69f00", "#ffffff"
STYLE: Final[dict[Any, Any]] = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "hatch.linewidth": 0.8,
    "legend.frameon": False,
    "legend.fontsize": 9,
    # So that the same results make the same bytes.
    "svg.hashsalt": "impact_predictor",
}
SPEEDS: Final = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""What a film may be slowed down or sped up by: numbers that one can think in."""
MARKERS: Final = frozenset({look.marker for look in MODES.values()} | {"X"})
"""Filled markers, which have an outline."""
STEP: Final = 0.06
"""Seconds for which a frame is seen; GIF counts in hundredths of a second."""

_LONGEST: Final = 10.0
"""Seconds that a film lasts at most, unless its motion is longer than the highest speed can show."""
_STILL: Final = 1.5
"""Seconds for which the end is seen before it begins again."""
_FLASH: Final = 0.8
"""Seconds of the film for which an impact is seen."""
_COLOURS: Final = 128
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


class View(NamedTuple):
    """What is seen of a body, as functions of the time in s.

    `window` is (left, right, bottom, top) in m, `outlines` come from the back to the front, and `caption` is what the
    body does, in words on a colour.
    """

    title: str
    window: Callable[[float], tuple[float, float, float, float]]
    outlines: Callable[[float], Sequence[Outline]]
    caption: Callable[[float], tuple[str, str]]
    flashes: Sequence[Flash]


class Curve(NamedTuple):
    """A curve against time in s, with gaps where it is NaN; single marks where `style` is a marker."""

    time: NDArray[np.float64]
    value: NDArray[np.float64]
    colour: str
    label: str = ""
    style: str = "-"
    width: float = 1.6


class Band(NamedTuple):
    """A bar with a `word` from `begin` to `end` in s, over the part of a panel's height from `low` to `high`."""

    begin: float
    end: float
    colour: str
    low: float = 0.1
    high: float = 0.9
    word: str = ""


class Panel(NamedTuple):
    """Curves about 0 and bands against time, with the name of their axis, in a part of a picture's `height`.

    `limits` are those of the axis, `right` is a curve with an axis of its own, and `legend` the place of the legend.
    """

    label: str
    curves: Sequence[Curve] = ()
    bands: Sequence[Band] = ()
    height: float = 1.0
    title: str = ""
    limits: tuple[float, float] | None = None
    right: tuple[str, Curve] | None = None
    legend: Literal["", "upper right", "lower right"] = ""


class Film(NamedTuple):
    """A moving picture: views side by side, `height` inches high, and a panel below them whose solid curves grow.

    `speed` is seconds of the motion for each one of the film, `times` (s) those of its frames.
    """

    title: str
    views: Sequence[View]
    height: float
    panel: Panel
    speed: float
    times: Sequence[float]


def check_picture(path: str | os.PathLike[str]) -> Path:
    """The path of a picture that can be drawn.

    Raises:
        InputError: the suffix names no known format, or there is no such folder.
    """
    return named(path, "picture that can be drawn", (".png", ".svg"))


def check_film(path: str | os.PathLike[str]) -> Path:
    """The path of a moving picture that can be drawn.

    Raises:
        InputError: the suffix is another one, or there is no such folder.
    """
    return named(path, "moving picture that can be drawn", (".gif",))


@contextmanager
def picture(path: str | os.PathLike[str], width: float, height: float) -> Iterator[Figure]:
    """A figure of so many inches, which is written as PNG or SVG when it is drawn: the same bytes every time.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_picture(path)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure
        metadata = {"Date": None} if path.suffix.lower() == ".svg" else {}
        with whole(path) as partial:
            figure.savefig(partial, format=path.suffix[1:].lower(), dpi=120, metadata=metadata)


def headline(figure: Figure, text: str) -> None:
    """Write what a figure of several axes says above them."""
    figure.suptitle(text, x=0.01, ha="left", fontweight="bold", fontsize=11)


def draw_panels(axes: Sequence[Axes], panels: Sequence[Panel], end: float) -> None:
    """Draw panels against the time until `end` in s, one below the other, in axes of one figure."""
    for one, panel in zip(axes, panels, strict=True):
        draw_panel(one, panel, 0.0, end)
        one.tick_params(labelbottom=one is axes[-1])
    axes[-1].set_xlabel("time (s)")


def draw_panel(axes: Axes, panel: Panel, begin: float, end: float) -> None:
    """Draw one panel against the time from `begin` to `end` in s."""
    if panel.right is not None:
        label, curve = panel.right
        other = axes.twinx()
        other.plot(curve.time, curve.value, curve.style, color=curve.colour, linewidth=curve.width)
        other.set_ylabel(label, color=curve.colour)
        other.set_ylim(*around_zero(curve.value, 1.35))
        other.grid(visible=False)
    for curve in panel.curves:
        edge = EDGE if curve.style in MARKERS else curve.colour
        looks: dict[str, Any] = {"markeredgecolor": edge, "markeredgewidth": 0.6, "markersize": 6.5}
        axes.plot(
            curve.time, curve.value, curve.style, color=curve.colour, label=curve.label, linewidth=curve.width, **looks
        )
    for band in panel.bands:
        looks = {"edgecolor": "white", "linewidth": 0.8 if band.word else 0.0, "clip_on": False}
        axes.axvspan(band.begin, band.end, band.low, band.high, facecolor=band.colour, **looks)
        if band.word and band.end - band.begin > 0.018 * len(band.word) * (end - begin):
            place = 0.5 * (band.begin + band.end), 0.5 * (band.low + band.high)
            axes.text(*place, band.word, transform=axes.get_xaxis_transform(), ha="center", va="center", fontsize=9)
    if panel.curves:
        axes.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)
    else:
        axes.set(yticks=[], ylim=(0.0, 1.0))
        axes.grid(visible=False)
    axes.set_title(panel.title, fontsize=10, pad=3)
    axes.set_ylabel(panel.label, color=panel.curves[0].colour if panel.right is not None else "black")
    axes.set_xlim(begin, end)
    if panel.limits is not None:
        axes.set_ylim(*panel.limits)
    if panel.legend:
        axes.legend(loc=panel.legend, ncols=2)


def around_zero(values: NDArray[np.float64], room: float = 1.2) -> tuple[float, float]:
    """Limits of an axis with 0 in the middle, and `room` times as far as the values."""
    high = room * max(float(np.nanmax(np.abs(values), initial=0.0)), 1e-3)
    return -high, high


def patches(names: Iterable[str], colours: Mapping[str, str]) -> list[Any]:
    """Entries of a legend for what is shown by a colour; each name once, in the given order."""
    return [
        Patch(facecolor=colours[name], edgecolor="#888888", linewidth=0.4, label=name) for name in dict.fromkeys(names)
    ]


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
    with matplotlib.rc_context(STYLE), whole(path) as partial:
        screen, writer = _Screen(film), _GifWriter()
        with writer.saving(screen.figure, partial, _DPI):
            for done, time in enumerate(film.times, 1):
                screen.draw(time)
                writer.grab_frame()
                if tell is not None:
                    tell(done)


class _GifWriter(PillowWriter):
    """Writes all frames with the colours of some, so that only what changes is stored, and shows the last for longer.

    `PillowWriter` itself gives each frame colours of its own, so that pixels that stand still are stored again.
    """

    def finish(self) -> None:
        frames = self._frames  # type: ignore[attr-defined]
        some = np.concatenate([np.asarray(frame) for frame in frames[:: max(1, len(frames) // 24)]])
        counted = Image.fromarray(some).quantize(_COLOURS)
        colours = np.array(counted.getpalette()).reshape(-1, 3)
        # Pillow does not tell colours apart whose parts differ by less than eight: the commonest of them stays.
        apart: dict[tuple[int, ...], NDArray[np.int64]] = {}
        used: Any = counted.getcolors()  # how many pixels have which colour
        for _, index in sorted(used, reverse=True):
            apart.setdefault(tuple(colours[index] // 8), colours[index])
        palette = Image.new("P", (1, 1))
        palette.putpalette(np.concatenate(list(apart.values())).tolist())
        first, *others = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
        durations = [round(1000 * STEP)] * len(others) + [round(1000 * _STILL)]
        first.save(self.outfile, "GIF", save_all=True, append_images=others, duration=durations, loop=0, optimize=True)


class _Screen:
    """The figure of a film."""

    def __init__(self, film: Film) -> None:
        head, room, foot = 0.65, 0.65, 0.3
        total = head + film.height + room + 1.0 + foot
        self._film, self._drawn = film, list[Any]()
        self.figure = Figure(figsize=(_WIDTH, total))
        FigureCanvasAgg(self.figure)
        grid = self.figure.add_gridspec(
            2, len(film.views), height_ratios=(film.height, 1.0), wspace=0.02, hspace=2.0 * room / (film.height + 1.0)
        )
        grid.update(left=0.07, right=0.98, top=1.0 - head / total, bottom=foot / total)
        self._views = [self.figure.add_subplot(grid[0, k], aspect="equal") for k in range(len(film.views))]
        for view, axes in zip(film.views, self._views, strict=True):
            axes.set_axis_off()
            axes.set_title(view.title, fontsize=10, loc="center", pad=14.0, fontweight="bold")
        panel = self.figure.add_subplot(grid[1, :])
        draw_panel(panel, film.panel, film.times[0], film.times[-1])
        panel.tick_params(labelsize=8)
        self._growing = []
        for curve, line in zip(film.panel.curves, panel.get_lines(), strict=False):
            if curve.style == "-":
                line.set_alpha(0.3)
                (grown,) = panel.plot([], [], color=curve.colour, linewidth=1.8)
                (dot,) = panel.plot([], [], "o", color=curve.colour)
                self._growing.append((curve, grown, dot))
        top = 1.0 - 0.1 / total
        said = "\n".join(filter(None, (film.title, pace_of(film.speed))))
        self.figure.text(0.02, top, said, va="top")
        self._clock = self.figure.text(0.98, top, "", ha="right", va="top", family="monospace")

    def draw(self, time: float) -> None:
        """Show the motion at a time in s."""
        for artist in self._drawn:
            artist.remove()
        self._drawn = []
        digits = 4 if self._film.speed < 0.02 else 3 if self._film.speed < 0.2 else 2
        self._clock.set_text(f"t = {time:.{digits}f} s")
        for view, axes in zip(self._film.views, self._views, strict=True):
            left, right, bottom, top = view.window(time)
            axes.set(xlim=(left, right), ylim=(bottom, top))
            for outline in view.outlines(time):
                self._drawn += draw_outline(axes, outline)
            self._draw_words(axes, view, time)
        for curve, line, dot in self._growing:
            passed = ~(curve.time > time + 1e-9)
            line.set_data(curve.time[passed], curve.value[passed])
            known = passed & ~np.isnan(curve.value)
            dot.set_data(curve.time[known][-1:], curve.value[known][-1:])

    def _draw_words(self, axes: Axes, view: View, time: float) -> None:
        words: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "fontsize": 9}
        caption, colour = view.caption(time)
        behind = {"facecolor": colour, "edgecolor": "none", "pad": 2.5}
        self._drawn.append(axes.text(0.5, -0.02, caption, va="top", bbox=behind, **words))
        last = next((flash for flash in reversed(view.flashes) if flash.time <= time), None)
        age = 1.0 if last is None else (time - last.time) / (self._film.speed * _FLASH)
        if last is not None and age < 1.0:
            ring: dict[str, Any] = {"markersize": 8.0 + 20.0 * age, "markeredgewidth": 3.0 * (1.0 - age)}
            self._drawn += axes.plot(*last.place, "o", markerfacecolor="none", markeredgecolor=STRUCK, **ring)
            self._drawn.append(axes.text(0.5, 1.0, last.words, va="bottom", color=STRUCK, fontweight="bold", **words))


def draw_outline(axes: Axes, outline: Outline) -> Sequence[Any]:
    """Draw one outline; what was drawn."""
    points, face, edge, size, mark = outline
    x, y = points.T
    if mark:
        return axes.plot(x, y, marker=mark, color=face, markeredgecolor=edge, markersize=size, linestyle="")
    if face == "none":
        return axes.plot(x, y, color=edge, linewidth=size, solid_capstyle="round")
    return axes.fill(x, y, facecolor=face, edgecolor=edge, linewidth=size, zorder=2.0)


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
