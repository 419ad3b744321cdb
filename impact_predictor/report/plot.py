"""The one place where matplotlib is imported: the style of all pictures, and how they are written."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from .files import named, whole

__all__ = ["GREY", "STYLE", "Axes", "Figure", "Line2D", "Patch", "check_film", "check_picture", "picture"]

GREY: Final = "#666666"
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


def draw_phases(
    axes: Axes, row: float, phases: Sequence[tuple[float, float, str]], colours: dict[str, str], height: float
) -> None:
    """Bars for phases (begin in s, end in s, name), in the colours of their names."""
    for begin, end, name in phases:
        axes.barh(row, end - begin, height, begin, color=colours[name], edgecolor="#888888", linewidth=0.4)
