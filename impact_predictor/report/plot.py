"""The style of all pictures, and how they become files."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

import matplotlib
from matplotlib.axes import Axes as Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Figure
from matplotlib.lines import Line2D as Line2D
from matplotlib.patches import Patch as Patch

from ..files import named, whole

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
"""What files are to be, and the ends of their names, for `files.named`."""


@contextmanager
def picture(path: str | os.PathLike[str], width: float, height: float) -> Iterator[Figure]:
    """A figure of so many inches, which is written as PNG or SVG when it is drawn: the same bytes every time;
    InputError where the file cannot be written, or is of another format.
    """
    path = named(path, *PICTURE)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure
        metadata = {"Date": None} if path.suffix.lower() == ".svg" else {}
        with whole(path) as partial:
            figure.savefig(partial, format=path.suffix[1:].lower(), dpi=120, metadata=metadata)
