"""The one place where matplotlib is imported: the style of all pictures, and films of motions beside their curves."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from math import cos, sin
from typing import Any, Final, NamedTuple, Protocol

import matplotlib
import numpy as np
from matplotlib.axes import Axes as Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Figure
from matplotlib.lines import Line2D as Line2D
from matplotlib.patches import Patch as Patch
from numpy.typing import NDArray
from PIL import Image

from ..files import named, whole
from ..mechanics.motion import PlanarState

GREY: Final = "#666666"
LINE, SPOKE, SUPPORT, STRUCK = "#33475b", "#b5c1cd", "#b5ada0", "#d62728"
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
PICTURE: Final = "picture that can be drawn", (".png", ".svg")
FILM: Final = "moving picture that can be drawn", (".gif",)
"""What files are to be, and the ends of their names, for `files.named`."""
STEP: Final = 0.08
"""Seconds for which a frame is seen; GIF counts in hundredths of a second."""

_LENGTH: Final = 10.0
"""Seconds that a film of a whole motion lasts, about."""


class FilmScene(Protocol):
    """A motion that a film shows."""

    title: str

    def draw(self, axes: Axes, time: float) -> str:
        """Draw what is seen at a `time` in s into empty axes, with their limits; what happens, in words."""


class Film(NamedTuple):
    """A moving picture: scenes side by side, `height` inches high, and curves below them with a line at the time.

    `times` (s) are those of its frames.
    """

    scenes: Sequence[FilmScene]
    height: float
    draw_curves: Callable[[Axes], None]
    times: Sequence[float]


@contextmanager
def picture(path: str | os.PathLike[str], width: float, height: float) -> Iterator[Figure]:
    """A figure of so many inches, which is written as PNG or SVG when it is drawn: the same bytes every time.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = named(path, *PICTURE)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure
        metadata = {"Date": None} if path.suffix.lower() == ".svg" else {}
        with whole(path) as partial:
            figure.savefig(partial, format=path.suffix[1:].lower(), dpi=120, metadata=metadata)


def headline(figure: Figure, text: str) -> Any:
    """Write what a figure of several axes says above them; the text."""
    return figure.suptitle(text, x=0.01, ha="left", fontweight="bold", fontsize=11)


def common_legend(figure: Figure, title: str = "") -> None:
    """Write one legend of all axes of a figure below them; each label stands in it once."""
    found = [axes.get_legend_handles_labels() for axes in figure.axes]
    entries = {label: handle for handles, labels in found for handle, label in zip(handles, labels, strict=True)}
    place: Any = {"loc": "outside lower center", "ncols": 4, "title": title, "title_fontsize": 9}
    figure.legend(list(entries.values()), list(entries), **place)


def frames_of(longest: float) -> list[float]:
    """The moments in s at which the frames of a whole motion are drawn; it is slowed down or sped up to fit a film."""
    step = STEP * float(f"{max(longest, 1e-6) / _LENGTH:.1g}")  # a factor of one digit is easy to think in
    return [k * step for k in range(2 + int(longest / step))]


def write_film(path: str | os.PathLike[str], film: Film, tell: Callable[[int], object] = lambda frames: None) -> None:
    """Draw a film as a GIF; `tell` takes how many frames are done.

    Raises:
        InputError: the file cannot be written, or is of another format.
    """
    path = named(path, *FILM)
    slower = STEP / (film.times[1] - film.times[0])
    pace = f"slowed down {slower:.3g} times" if slower > 1.0 else f"sped up {1.0 / slower:.3g} times"
    pace = "real time" if abs(slower - 1.0) < 1e-6 else pace
    with matplotlib.rc_context(STYLE), whole(path) as partial:
        figure = Figure(figsize=(7.0, film.height + 2.5), dpi=90, layout="constrained")
        canvas: Any = FigureCanvasAgg(figure)
        frames: list[Image.Image] = []
        grid = figure.add_gridspec(2, len(film.scenes), height_ratios=(film.height + 0.6, 1.2))
        stages = [figure.add_subplot(grid[0, k], aspect="equal") for k in range(len(film.scenes))]
        curves = figure.add_subplot(grid[1, :])
        film.draw_curves(curves)
        clock, now = headline(figure, "t"), curves.axvline(film.times[0], color=STRUCK, linewidth=1.5)
        for done, time in enumerate(film.times, 1):
            for axes, scene in zip(stages, film.scenes, strict=True):
                for artist in (*axes.lines, *axes.patches, *axes.texts):
                    artist.remove()
                axes.set_axis_off()
                axes.set_title(f"{scene.title}\n{scene.draw(axes, time) or ' '}", fontsize=10, loc="center")
            now.set_xdata([time, time])
            clock.set_text(f"{pace}: {time:.4g} s")
            canvas.draw()
            figure.set_layout_engine("none")  # what is seen does not jump
            frames.append(Image.fromarray(np.array(canvas.buffer_rgba())).convert("RGB"))
            tell(done)
        # All have the same colours, so that only what changes is stored: a quarter of what PillowWriter stores.
        some = frames[:: max(1, len(frames) // 24)]
        colours = Image.fromarray(np.concatenate([np.asarray(one) for one in some])).quantize(128)
        first, *others = [one.quantize(palette=colours, dither=Image.Dither.NONE) for one in frames]
        # The last one is seen for 1.5 s before the film begins again.
        durations = [round(1000 * STEP)] * len(others) + [1500]
        first.save(partial, "GIF", save_all=True, append_images=others, duration=durations, loop=0, optimize=True)


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
