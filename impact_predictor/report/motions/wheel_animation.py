"""A moving picture of a wheel that rolls down its slope, seen by a camera that goes along with it."""

from __future__ import annotations

import os
from collections.abc import Callable
from math import cos, sin
from typing import Any, Final

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from PIL import Image

from ...scenarios.wheel import Rolling
from ..figure import STYLE
from .animation import STEP, Picture, check_animation, digits_of, pace_of, save_film, speed_for
from .figure import COLOURS
from .stage import STRUCK
from .wheel_figure import FIRST, GROUND, LEG, STANCES, rate_of, spokes_of, stance_of, stances, steady_rates, title_of

_WIDTH, _HEIGHT, _DPI = 7.0, 5.4, 90
_WIDE: Final = 5.2
"""Width of what is seen of the slope, in lengths of a spoke."""
_FLASH: Final = 0.6
"""Seconds of the picture for which an impact is seen."""


def wheel_frames(rolling: Rolling) -> list[float]:
    """The moments in s at which frames are drawn."""
    step = speed_for(rolling.time) * STEP
    return [k * step for k in range(2 + int(rolling.time / step))]


def write_wheel_animation(
    path: str | os.PathLike[str], rolling: Rolling, tell: Callable[[int], None] | None = None
) -> None:
    """Draw a rolling motion as a GIF; `tell` takes how many frames are done.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = check_animation(path)
    with matplotlib.rc_context(STYLE):
        save_film(path, _Film(rolling).frame, wheel_frames(rolling), tell)


class _Film:
    """The picture at any moment: the wheel above, its rate below."""

    def __init__(self, rolling: Rolling) -> None:
        self._speed = speed_for(rolling.time)
        figure = Figure(figsize=(_WIDTH, _HEIGHT), dpi=_DPI)
        FigureCanvasAgg(figure)
        self._stage = _Stage(figure.add_axes((0.0, 0.3, 1.0, 0.62)), rolling, self._speed)
        self._rate = _Rate(figure.add_axes((0.07, 0.07, 0.91, 0.17)), rolling)
        figure.text(0.02, 0.98, title_of(rolling.wheel), va="top", fontsize=10, fontweight="bold")
        figure.text(0.02, 0.935, pace_of(self._speed), va="top", fontsize=9, color="#555555")
        self._clock = figure.text(0.98, 0.98, "", ha="right", va="top", family="monospace", fontsize=10)
        self._picture = Picture(figure, [*self._stage.moving, *self._rate.moving, self._clock])

    def frame(self, time: float) -> Image.Image:
        """The picture at a time in s."""
        self._stage.show(time)
        self._rate.show(time)
        self._clock.set_text(f"t = {time:.{digits_of(self._speed)}f} s")
        return self._picture.now()


class _Stage:
    """The wheel on its slope; `show` puts it where it is at a time."""

    def __init__(self, axes: Axes, rolling: Rolling, speed: float) -> None:
        self._rolling, self._speed = rolling, speed
        wheel = rolling.wheel
        self._leg, half = wheel.hub.leg, 0.5 * _WIDE * wheel.hub.leg
        # The hub stays in the middle, the slope goes by.
        axes.set(xlim=(-half, half), ylim=(-1.35 * self._leg, 1.15 * self._leg), aspect="equal")
        axes.set_axis_off()
        self._down = np.array([cos(wheel.hub.slope), -sin(wheel.hub.slope)])
        self._out = np.array([sin(wheel.hub.slope), cos(wheel.hub.slope)])
        self._ground = Polygon(np.zeros((4, 2)), closed=True, facecolor=GROUND, edgecolor="none")
        self._marks = LineCollection([], colors="#7d766b", linewidths=1.2)
        self._spokes = LineCollection([])
        for artist in (self._ground, self._marks, self._spokes):
            axes.add_artist(artist)
        (self._path,) = axes.plot([], [], color=COLOURS[0], linewidth=1.2, alpha=0.6)
        (self._hub,) = axes.plot([0.0], [0.0], "o", color=COLOURS[0], markersize=9)
        (self._burst,) = axes.plot([], [], "o", markerfacecolor="none", markeredgecolor=STRUCK)
        words: dict[str, Any] = {"transform": axes.transAxes, "fontsize": 10}
        self._mode = axes.text(0.98, 0.9, "", color=STRUCK, fontweight="bold", ha="right", **words)
        self._says = axes.text(0.98, 0.8, "", ha="right", **words)
        self._times = np.linspace(0.0, rolling.time, 2000)
        self._way = np.array(rolling.world(self._times)[:2])
        self._stances = stances(rolling, rolling.time)
        self.moving: list[Artist] = [self._ground, self._marks, self._path, self._spokes, self._hub, self._burst]
        self.moving += [self._mode, self._says]

    def show(self, time: float) -> None:
        """Draw the wheel as it is at `time` in s."""
        time = min(time, self._rolling.time)
        state = self._rolling.world(time)
        here = np.array([state.x, state.y])
        tips = spokes_of(self._rolling.wheel, state)
        stood = self._rolling.stood(time)
        standing = {tip for tip, _ in stood}
        self._spokes.set_segments([[(0.0, 0.0), tuple(tip - here)] for tip in tips])
        slips = any(how != "S" for _, how in stood)
        loaded = STANCES["on a spoke that slips"] if slips else LEG
        self._spokes.set_color([loaded if k in standing else FIRST if k == 0 else "#a9b7c6" for k in range(len(tips))])
        self._spokes.set_linewidth([4.0 if k in standing else 2.0 for k in range(len(tips))])
        self._show_ground(here)
        passed = self._times <= time
        self._path.set_data(*(self._way[:, passed] - here[:, None]))
        name = next((stance_of(one) for one in reversed(self._stances) if one.start <= time), "")
        self._says.set_text(name)
        self._says.set_bbox({"facecolor": STANCES.get(name, "#ffffff"), "edgecolor": "none", "pad": 3.0})
        happened = [one for one in self._rolling.impacts if one.strike.time <= time]
        age = (time - happened[-1].strike.time) / (self._speed * _FLASH) if happened else 1.0
        for artist in (self._burst, self._mode):
            artist.set_visible(age < 1.0)
        if age < 1.0:
            last = happened[-1]
            place = tips[last.new] - here
            self._burst.set_data([place[0]], [place[1]])
            self._burst.set(markersize=8.0 + 22.0 * age, markeredgewidth=3.0 * (1.0 - age))
            self._mode.set_text(f"impact {len(happened)}: {last.strike.outcome.mode.name}")

    def _show_ground(self, here: np.ndarray[Any, np.dtype[np.float64]]) -> None:
        along, leg = float(here @ self._down), self._leg
        foot = -float(here @ self._out) * self._out
        reach = _WIDE * leg
        corners = [(-reach, 0.0), (reach, 0.0), (reach, -0.06 * leg), (-reach, -0.06 * leg)]
        self._ground.set_xy(np.array([foot + x * self._down + y * self._out for x, y in corners]))
        # A mark each half a spoke shows how the slope goes by.
        spacing = 0.5 * leg
        first = np.ceil((along - reach) / spacing) * spacing
        places = np.arange(first, along + reach, spacing) - along
        ends = [(foot + x * self._down, foot + x * self._down - 0.06 * leg * self._out) for x in places]
        self._marks.set_segments([[tuple(top), tuple(bottom)] for top, bottom in ends])


class _Rate:
    """The rate against time; `show` moves its end to a moment."""

    def __init__(self, axes: Axes, rolling: Rolling) -> None:
        self._rolling = rolling
        self._times, self._rates = rate_of(rolling)
        axes.plot(self._times, self._rates, color=COLOURS[0], linewidth=1.0, alpha=0.3)
        (self._line,) = axes.plot([], [], color=COLOURS[0], linewidth=1.8)
        (self._dot,) = axes.plot([], [], "o", color=COLOURS[0], markersize=6)
        axes.axhline(0.0, color="#666666", linewidth=0.8)
        title = "rate ahead (rad/s) against time (s)"
        steadily = steady_rates(rolling.wheel)
        if steadily:
            for value in steadily:
                axes.axhline(value, color="#555555", linewidth=0.8, linestyle=(0, (5, 3)))
            title += "; dashed: steady rolling without slip, before and after an impact"
        axes.set(xlim=(0.0, rolling.time))
        axes.set_title(title, fontsize=9, pad=3)
        axes.tick_params(labelsize=8)
        self.moving: list[Artist] = [self._line, self._dot]

    def show(self, time: float) -> None:
        time = min(time, self._rolling.time)
        passed = ~(self._times > time)
        self._line.set_data(self._times[passed], self._rates[passed])
        self._dot.set_data([time], [-self._rolling.world(time).omega])
