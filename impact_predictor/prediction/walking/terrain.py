"""The terrain as a map tells it: heights of a grid of cells, and the height under a place between them."""

from __future__ import annotations

from math import floor

import numpy as np

from ..checks import LARGEST
from ..types import Status, Terrain, Vector3

STEEP = 0.5  # slope beyond which the ground has an edge between two cells
EDGE = 0.25  # part of what the heights about a place differ by that the one between them may be off
CELLS = 1 << 20  # that a terrain may be long and wide


class TerrainMap:
    """The heights that were told last, each the mean of its cell.

    The grid begins at the first point: those of a map with cells of the same size then lie in the middle of theirs.
    """

    def __init__(self, cell: float, tolerance: float) -> None:
        """Gather heights in cells of a size in m; the contact tolerance in m."""
        self._cell, self._ramp = cell, max(tolerance, STEEP * cell)
        self._x = self._y = 0.0
        self._heights: dict[int, float] = {}

    def set(self, terrain: Terrain) -> Status:
        """Take the heights that replace the last ones; those that are not finite tell nothing of their places."""
        points = np.asarray(terrain.points, float).reshape(-1, 3)
        points = points[np.all(np.abs(points) < LARGEST, axis=1)]
        if not len(points):
            return Status.NOT_FINITE
        first = points[0, :2]
        places = np.floor((points[:, :2] - first) / self._cell + 0.5)
        if not np.all(np.abs(places) < CELLS // 2):
            return Status.NOT_FINITE
        cells, numbers = np.unique(places[:, 0] * CELLS + places[:, 1], return_inverse=True)
        means = np.bincount(numbers, points[:, 2]) / np.bincount(numbers)
        self._x, self._y = first.tolist()
        self._heights = dict(zip(cells.astype(np.int64).tolist(), means.tolist(), strict=True))
        return Status.ACCEPTED

    def at(self, place: Vector3) -> tuple[float, float] | None:
        """The height (m) under a place, and how much an edge may put it off; None where none is told.

        It is interpolated between the cells about the place (bilinear), as far as these are known. An edge is no ramp:
        where they are too steep for one it is that of the place's own cell.
        """
        if not self._heights:
            return None
        x, y = (place[0] - self._x) / self._cell, (place[1] - self._y) / self._cell
        own = self._heights.get(floor(x + 0.5) * CELLS + floor(y + 0.5))
        if own is None:
            return None
        i, j = floor(x), floor(y)
        x, y = x - i, y - j
        low = high = own
        whole = height = 0.0
        for number, part in ((i, 1.0 - x), (i + 1, x)):
            for other, weight in ((j, part * (1.0 - y)), (j + 1, part * y)):
                one = self._heights.get(number * CELLS + other)
                if one is not None:
                    whole, height = whole + weight, height + weight * one
                    low, high = min(low, one), max(high, one)
        return height / whole if high - low <= self._ramp else own, EDGE * (high - low)
