"""Names beside the lines of a picture, where they cover least."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product
from math import hypot
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from numpy.typing import NDArray

Array = NDArray[np.float64]

DISTANCES: Final = (11.0, 16.0, 26.0, 40.0, 58.0)
"""How far from its mark a name may stand, in pixels."""
NEAR: Final = 20.0
"""From this distance on a thin line leads from the mark to its name."""
ROUNDS: Final = 3
MARK, STEP, MARGIN = 6.0, 4.0, 4.0
"""Half the width of a mark, the distance of the points that stand for a line, and how far names may leave the axes."""
_COVERED_NAME, _COVERED_MARK, _COVERED_LINE, _OWN_LINE = 200.0, 25.0, 2.0, 1.0
"""What it costs to cover a name, a mark, and a step of a line."""


class Line(NamedTuple):
    """A line to name: its marks (points, 2) in data coordinates; `bold` for the name that matters most."""

    name: str
    colour: str
    marks: Array
    bold: bool = False


class Places(NamedTuple):
    """Where a name may stand: boxes (places, 4) as x0, y0, x1, y1, the marks they stand at, all in pixels; prices."""

    boxes: Array
    marks: Array
    prices: Array


def write_names(
    axes: Axes, lines: Sequence[Line], fontsize: float, taken: Sequence[Array] = (), others: Sequence[Array] = ()
) -> None:
    """Write the name of each line beside one of its marks; the axes have their final limits and place.

    `taken` are boxes in pixels where no name should stand, `others` lines without a name, in data coordinates.
    """
    pixels = [axes.transData.transform(marks) for marks in [*(line.marks for line in lines), *others]]
    x0, y0, x1, y1 = axes.get_window_extent().extents
    inside = np.array([x0, y0, x1 + MARGIN, y1 + MARGIN])
    choices = []
    for number, line in enumerate(lines):
        places = places_of(pixels[number], extent_of(axes, line.name, fontsize, line.bold), inside)
        choices.append(places._replace(prices=places.prices + covered(places.boxes, number, pixels, taken)))
    chosen: dict[int, int] = {}
    for _ in range(ROUNDS):
        for number, places in enumerate(choices):
            costs = places.prices.copy()
            for other, place in chosen.items():
                if other != number:
                    costs += _COVERED_NAME * overlap(places.boxes, choices[other].boxes[place])
            if len(costs):
                chosen[number] = int(np.argmin(costs))
    for number, place in chosen.items():
        write_name(axes, lines[number], choices[number].boxes[place], choices[number].marks[place], fontsize)


def extent_of(axes: Axes, text: str, fontsize: float, bold: bool = False) -> tuple[float, float]:
    """Width and height of a line of text in pixels; the canvas of the figure is Agg."""
    figure: Any = axes.get_figure(root=True)
    font = FontProperties(size=fontsize, weight="bold" if bold else "normal")
    width, height, _ = figure.canvas.get_renderer().get_text_width_height_descent(text, font, False)
    return width, 1.15 * height


def places_of(marks: Array, extent: tuple[float, float], inside: Array) -> Places:
    """Where a name of this extent may stand around the marks of its line, within a box."""
    width, height = extent
    places = []
    for mark, distance, (right, up) in product(marks, DISTANCES, product((-1, 0, 1), repeat=2)):
        x = mark[0] + right * distance - 0.5 * width * (1 - right)
        y = mark[1] + up * distance - 0.5 * height * (1 - up)
        if (right or up) and inside[0] <= x <= inside[2] - width and inside[1] <= y <= inside[3] - height:
            places.append((x, y, x + width, y + height, *mark, 0.5 * distance + (4.0 if right and up else 0.0)))
    table = np.array(places).reshape(-1, 7)
    return Places(table[:, :4], table[:, 4:6], table[:, 6])


def covered(boxes: Array, own: int, lines: Sequence[Array], taken: Sequence[Array]) -> Array:
    """What it costs each box to cover the marks and lines under it."""
    prices = sum((_COVERED_NAME * overlap(boxes, box) for box in taken), np.zeros(len(boxes)))
    wide = boxes + np.array([-MARK, -MARK, MARK, MARK])
    for number, marks in enumerate(lines):
        prices += _COVERED_MARK * count_inside(wide, marks)
        prices += (_OWN_LINE if number == own else _COVERED_LINE) * count_inside(boxes, along(marks))
    return prices


def count_inside(boxes: Array, points: Array) -> Array:
    """How many points each box holds."""
    x, y = points.T
    x0, y0, x1, y1 = boxes.T[..., None]
    inside: Array = np.sum((x > x0) & (x < x1) & (y > y0) & (y < y1), axis=1, dtype=float)
    return inside


def along(marks: Array) -> Array:
    """Points every few pixels along a line."""
    pieces = [marks[:1]]
    for begin, end in pairwise(marks):
        steps = max(1, int(hypot(*(end - begin)) / STEP))
        pieces.append(begin + (end - begin) * (np.arange(1, steps + 1) / steps)[:, None])
    return np.concatenate(pieces)


def overlap(boxes: Array, other: Array) -> Array:
    """The common area of each box with another as a part of it, and a little where they only touch."""
    low, high = np.maximum(boxes[:, :2], other[:2]) - 2.0, np.minimum(boxes[:, 2:], other[2:]) + 2.0
    width, height = np.maximum(high - low, 0.0).T
    own = np.prod(boxes[:, 2:] - boxes[:, :2], axis=1)
    return np.asarray(np.where(width * height > 0.0, 0.2 + width * height / own, 0.0))


def write_name(axes: Axes, line: Line, box: Array, mark: Array, fontsize: float) -> None:
    """Write a name into its box, with a thin line from its mark where that is not near."""
    low, high = box[:2], box[2:]
    nearest = np.clip(mark, low, high)
    to_axes = axes.transAxes.inverted()
    if hypot(*(nearest - mark)) > NEAR:
        begin, end = to_axes.transform([mark, nearest])
        axes.plot(*zip(begin, end, strict=True), color=line.colour, linewidth=0.7, alpha=0.7, transform=axes.transAxes)
    x, y = to_axes.transform(0.5 * (low + high))
    axes.text(
        x,
        y,
        line.name,
        transform=axes.transAxes,
        color=line.colour,
        fontsize=fontsize,
        fontweight="bold" if line.bold else "normal",
        ha="center",
        va="center_baseline",
        zorder=5,
    )
