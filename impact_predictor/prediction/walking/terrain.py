"""The terrain as a map tells it: heights of a grid of cells, and the height under a place between them."""

from __future__ import annotations

from math import floor, isnan, nan
from typing import Final

import numpy as np

from ..checks import LARGEST
from ..types import Status, Terrain, Vector3

STEEP: Final = 0.5  # slope beyond which the ground has an edge between two cells
EDGE: Final = 0.25  # part of what the heights about a place differ by that the one between them may be off
FURTHEST: Final = 1000  # cells from the middle of a map within which it tells heights


class TerrainMap:
    """The heights that were told last, each the mean of its cell.

    The grid begins at the first point: those of a map with cells of the same size then lie in the middle of theirs.
    """

    def __init__(self, cell: float, tolerance: float) -> None:
        """Gather heights in cells of a size in m; the contact tolerance in m."""
        self._cell, self._ramp = cell, max(tolerance, STEEP * cell)
        self._x = self._y = 0.0
        self._long = self._wide = 0
        self._heights = np.zeros(0)

    def set(self, terrain: Terrain) -> Status:
        """Take the heights that replace the last ones; those that are not finite tell nothing of their places."""
        points = np.asarray(terrain.points, float).reshape(-1, 3)
        points = points[np.all(np.abs(points) < LARGEST, axis=1)]
        if not len(points):
            return Status.NOT_FINITE
        places = np.floor((points[:, :2] - points[0, :2]) / self._cell + 0.5)
        # A height far from all others is no ground.
        near = np.all(np.abs(places - np.median(places, axis=0)) < FURTHEST, axis=1)
        places, heights = places[near], points[near, 2]
        corner = places.min(axis=0)
        self._long, self._wide = (places.max(axis=0) - corner + 1.0).astype(int).tolist()
        self._x, self._y = (points[0, :2] + self._cell * corner).tolist()
        cells = ((places[:, 0] - corner[0]) * self._wide + places[:, 1] - corner[1]).astype(np.int64)
        count = self._long * self._wide
        counts = np.bincount(cells, minlength=count)
        self._heights = np.full(count, np.nan)
        np.divide(np.bincount(cells, heights, minlength=count), counts, out=self._heights, where=counts > 0)
        return Status.ACCEPTED

    def at(self, place: Vector3) -> tuple[float, float] | None:
        """The height (m) under a place, and how much an edge may put it off; None where none is told.

        It is interpolated between the cells about the place (bilinear), as far as these are known. An edge is no ramp:
        where they are too steep for one it is that of the place's own cell.
        """
        x, y = (place[0] - self._x) / self._cell, (place[1] - self._y) / self._cell
        own = self._height(floor(x + 0.5), floor(y + 0.5))
        if isnan(own):
            return None
        i, j = floor(x), floor(y)
        x, y = x - i, y - j
        low = high = own
        whole = height = 0.0
        for number, part in ((i, 1.0 - x), (i + 1, x)):
            for other, weight in ((j, part * (1.0 - y)), (j + 1, part * y)):
                one = self._height(number, other)
                if not isnan(one):
                    whole, height = whole + weight, height + weight * one
                    low, high = min(low, one), max(high, one)
        return height / whole if high - low <= self._ramp else own, EDGE * (high - low)

    def _height(self, i: int, j: int) -> float:
        """The height of a cell; NaN where none is told."""
        if not (0 <= i < self._long and 0 <= j < self._wide):
            return nan
        height: float = self._heights.item(i * self._wide + j)
        return height
