"""What recorded impacts would have done with other coefficients: solved on a grid, interpolated between its nodes."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .blocks import Blocks
from .touchdowns import Coefficients

Array = NDArray[np.float64]

PARTS: Final = 6
"""Into so many equal parts the gaps between nodes are cut."""


class Grid(NamedTuple):
    """Values of friction and restitution, rising, and one factor on the inertia."""

    friction: Array
    restitution: Array
    inertia: float

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.friction), len(self.restitution)

    def at(self, place: int) -> Coefficients:
        """The coefficients at a place of the flattened grid."""
        i, j = divmod(place, len(self.restitution))
        return Coefficients(float(self.friction[i]), float(self.restitution[j]), self.inertia)

    def finer(self) -> Grid:
        return Grid(_between(self.friction, 0), _between(self.restitution, 0), self.inertia)


class Table:
    """The errors of touchdowns over a grid, summed in blocks.

    `grid` is the finer one that they are interpolated to: between the nodes, at which the impacts are solved, the twist
    after is taken to be linear. `misses_at` gives what `Solver.misses` does. `sums` is (blocks, places of the flattened
    grid), `counts` the number of touchdowns in each block.
    """

    def __init__(self, blocks: Blocks, nodes: Grid, misses_at: Callable[[Coefficients], Array]) -> None:
        self.nodes = nodes
        self.grid = nodes.finer()
        solved = [
            misses_at(Coefficients(float(friction), float(restitution), nodes.inertia))
            for friction, restitution in product(nodes.friction, nodes.restitution)
        ]
        at_nodes = np.moveaxis(np.array(solved).reshape(*nodes.shape, len(blocks), 2), (2, 3), (0, 1))
        self.counts = np.bincount(blocks).astype(np.float64)
        self.sums = np.zeros((len(self.counts), self.grid.shape[0] * self.grid.shape[1]))
        for block, one in zip(blocks, at_nodes, strict=True):
            self.sums[block] += np.hypot(*_between(_between(one, 1), 2)).ravel()

    def losses(self, weights: Array | None = None) -> Array:
        """The mean error at every place, for each row of weights of the blocks: (rows, places)."""
        rows = np.ones((1, len(self.counts))) if weights is None else weights
        found: Array = rows @ self.sums / (rows @ self.counts)[:, None]
        return found


def _between(values: Array, axis: int) -> Array:
    """Values along an axis with each gap in equal parts, linear between."""
    below, above = np.delete(values, -1, axis), np.delete(values, 0, axis)
    parts = [below + (above - below) * (k / PARTS) for k in range(PARTS)]
    shape = list(values.shape)
    shape[axis] = PARTS * (shape[axis] - 1)
    joined: Array = np.stack(parts, axis + 1).reshape(shape)
    return np.concatenate((joined, np.take(values, [-1], axis)), axis)
