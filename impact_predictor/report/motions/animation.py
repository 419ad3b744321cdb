"""A moving picture of bodies that rock side by side, slowed down so that one can follow it."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Final, cast

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

from ...errors import InputError
from ...scenarios.rocking import Rocking
from ..figure import STYLE
from ..whole import whole
from .figure import colours, curve_of, end_of
from .stage import STRUCK, Stage

SUFFIX: Final = ".gif"
SPEEDS: Final = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""What a picture may be slowed down or sped up by: times that one can think in."""

_LONGEST: Final = 10.0
"""Seconds that a picture lasts at most, unless its motion is longer than the highest speed can show."""
STEP: Final = 0.06
"""Seconds for which a frame is seen; GIF counts in hundredths of a second."""
_STILL: Final = 1.5
"""Seconds for which the end is seen before it begins again."""
_COLOURS: Final = 64
_LOOKS: Final = 12
"""Frames from which they are chosen."""
_DPI: Final = 90
_WIDTH: Final = 7.0
_HIGHEST: Final = 3.4
"""The most that a body may have of the height, which goes in inches to what stands above it, the bodies, the room
between them and their angular velocities, these, and the room below."""
_HEAD, _BETWEEN, _TRACE, _FOOT = 0.7, 0.75, 1.1, 0.3


def check_animation(path: str | os.PathLike[str]) -> Path:
    """The path of a moving picture that `write_animation` can write.

    Raises:
        InputError: the suffix is another one, or there is no such folder.
    """
    path = Path(path)
    if path.suffix.lower() != SUFFIX:
        raise InputError(f"{path} is no moving picture that can be drawn; give a name that ends in {SUFFIX}")
    if not path.parent.is_dir():
        raise InputError(f"the folder of {path} does not exist; make it, or give another name")
    return path


def speed_of(rockings: Sequence[Rocking]) -> float:
    """How fast the picture of motions runs."""
    return speed_for(max(rocking.run.time for rocking in rockings))


def speed_for(longest: float) -> float:
    """How fast the picture of a motion of so many s runs: the slowest of `SPEEDS` that shows it within its time."""
    return next((speed for speed in SPEEDS if longest <= speed * _LONGEST), SPEEDS[-1])


def times_of(rockings: Sequence[Rocking]) -> list[float]:
    """The moments in s at which frames are drawn."""
    step = speed_of(rockings) * STEP
    longest = max(rocking.run.time for rocking in rockings)
    return [k * step for k in range(2 + int(longest / step))]


def write_animation(
    path: str | os.PathLike[str], rockings: Sequence[Rocking], tell: Callable[[int], None] | None = None
) -> None:
    """Draw motions side by side as a GIF; `tell` takes how many frames are done.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_animation(path)
    with matplotlib.rc_context(STYLE):
        save_film(path, _Film(rockings).frame, times_of(rockings), tell)


def save_film(
    path: Path,
    frame: Callable[[float], Image.Image],
    times: Sequence[float],
    tell: Callable[[int], None] | None = None,
) -> None:
    """Write the frames of some moments as a GIF, in few colours; the last one is seen longer.

    Raises:
        InputError: the file cannot be written.
    """
    palette = _palette_of(frame(time) for time in times[:: max(1, len(times) // _LOOKS)])
    frames = []
    for done, time in enumerate(times, 1):
        frames.append(frame(time).quantize(palette=palette, dither=Image.Dither.NONE))
        if tell is not None:
            tell(done)
    first, *others = frames
    durations = [round(1000 * STEP)] * len(others) + [round(1000 * _STILL)]
    with whole(path) as partial:
        first.save(partial, "GIF", save_all=True, append_images=others, duration=durations, loop=0, optimize=True)


def _palette_of(frames: Iterable[Image.Image]) -> Image.Image:
    """The commonest colours of some frames as one palette for all, so that of each only what has changed is stored."""
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


class _Film:
    """The picture of motions at any moment: the bodies side by side, their angular velocities below."""

    def __init__(self, rockings: Sequence[Rocking]) -> None:
        speed = speed_of(rockings)
        figure = Figure(figsize=(_WIDTH, _WIDTH), dpi=_DPI)
        FigureCanvasAgg(figure)
        self._digits = digits_of(speed)
        count = len(rockings)
        axes = [figure.add_axes((0.0, 0.0, 1.0, 1.0)) for _ in rockings]
        self._stages = [Stage(one, rocking, speed) for one, rocking in zip(axes, rockings, strict=True)]
        # All to one scale, each in the middle of where it is seen.
        corners = [stage.extent() for stage in self._stages]
        size = 1.06 * np.max([high - low for low, high in corners], axis=0)
        height = min(_HIGHEST, _WIDTH / count * size[1] / size[0])
        total = _HEAD + height + _BETWEEN + _TRACE + _FOOT
        figure.set_size_inches(_WIDTH, total)
        for k, (one, (low, high)) in enumerate(zip(axes, corners, strict=True)):
            (left, bottom), (right, top) = 0.5 * (low + high - size), 0.5 * (low + high + size)
            one.set(xlim=(left, right), ylim=(bottom, top))
            one.set_position((k / count, (_FOOT + _TRACE + _BETWEEN) / total, 1.0 / count, height / total))
        traces = _Traces(figure.add_axes((0.06, _FOOT / total, 0.92, _TRACE / total)), rockings)
        corner: dict[str, Any] = {"y": 1.0 - 0.1 / total, "va": "top", "fontsize": 10}
        figure.text(0.02, s=pace_of(speed), color="#555555", **corner)
        self._clock = figure.text(0.98, s="", ha="right", family="monospace", **corner)
        self._parts: list[Stage | _Traces] = [*self._stages, traces]
        moving = [self._clock, *(artist for part in self._parts for artist in part.moving)]
        self._picture = Picture(figure, moving)

    def frame(self, time: float) -> Image.Image:
        """The picture at a time in s."""
        for part in self._parts:
            part.show(time)
        self._clock.set_text(f"t = {time:.{self._digits}f} s")
        return self._picture.now()


class Picture:
    """A figure of which little is drawn anew for each frame: what is `moving`, from the back to the front."""

    def __init__(self, figure: Figure, moving: Sequence[Artist]) -> None:
        self._canvas = cast(Any, figure.canvas)  # its methods have no types
        self._moving = moving
        for artist in moving:
            artist.set_animated(True)
        self._canvas.draw()
        self._background = self._canvas.copy_from_bbox(figure.bbox)

    def now(self) -> Image.Image:
        """The figure as it is now."""
        self._canvas.restore_region(self._background)
        for artist in self._moving:
            self._canvas.figure.draw_artist(artist)
        return Image.fromarray(np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy())


class _Traces:
    """Angular velocities against time; `show` moves their ends to a moment."""

    def __init__(self, axes: Axes, rockings: Sequence[Rocking]) -> None:
        self._rockings = rockings
        self._end = end_of(rockings)
        self._curves = [curve_of(rocking.run, end=self._end) for rocking in rockings]
        self._lines, self._dots = [], []
        for curve, colour in zip(self._curves, colours(len(rockings)), strict=True):
            axes.plot(curve.time, curve.omega, color=colour, linewidth=1.0, alpha=0.3)
            self._lines += axes.plot([], [], color=colour, linewidth=1.8)
            self._dots += axes.plot([], [], "o", color=colour, markersize=6)
        axes.axhline(0.0, color="#666666", linewidth=0.8)
        axes.set(xlim=(0.0, self._end))
        axes.set_title("ω (rad/s) against time (s)", fontsize=9, pad=3)
        axes.tick_params(labelsize=8)
        self.moving: list[Artist] = [*self._lines, *self._dots]

    def show(self, time: float) -> None:
        for curve, line, dot, rocking in zip(self._curves, self._lines, self._dots, self._rockings, strict=True):
            passed = ~(curve.time > time)
            line.set_data(curve.time[passed], curve.omega[passed])
            dot.set_data([min(time, self._end)], [rocking.run.state(time).omega])


def pace_of(speed: float) -> str:
    """The speed of a picture in words."""
    if speed == 1.0:
        return "real time"
    return f"slowed down {1.0 / speed:g} times" if speed < 1.0 else f"sped up {speed:g} times"


def digits_of(speed: float) -> int:
    """Decimals of the clock that one can read."""
    return 4 if speed < 0.02 else 3 if speed < 0.2 else 2
