"""The errors of touchdowns over a grid of coefficients, summed in blocks that are independent of each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise, product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..stamps import NANOSECONDS
from .touchdowns import Coefficients, ScoredTouchdown

Blocks = NDArray[np.int64]
"""The block of each touchdown: (n,), counting from 0."""

APART: Final = 1.0
"""s: touchdowns further apart than this are of different tosses, or of different times."""

ENOUGH: Final = 10
"""Blocks below which a record is cut at ever shorter pauses, down to single touchdowns."""

MOST: Final = 400
"""Blocks beyond which neighbours are put together, so that long records take no more memory."""


def blocks_of(records: Sequence[Sequence[ScoredTouchdown]]) -> Blocks:
    """The blocks of the touchdowns of some records, one record after the other.

    A block is a stretch of one body's time in one record, between pauses of a second without touchdowns; where that
    gives too few of them, between the longest pauses that there are.
    """
    pauses = [
        np.inf if one.body != other.body else (other.stamp - one.stamp) / NANOSECONDS
        for touchdowns in records
        for one, other in pairwise((*touchdowns, *touchdowns[:1]))
    ]
    # The pause after the last touchdown of a record has no end.
    ends = np.cumsum([len(touchdowns) for touchdowns in records if touchdowns]) - 1
    breaks = np.array(pauses)
    breaks[ends] = np.inf
    longest = np.sort(breaks)[::-1][:ENOUGH]
    blocks = np.concatenate(([0], np.cumsum(breaks[:-1] >= min(APART, longest[-1]))))
    number = blocks[-1] + 1
    return blocks if number <= MOST else blocks * MOST // number


PARTS: Final = 6
"""Into so many equal parts the gaps between nodes are cut."""


class Grid(NamedTuple):
    """Values of friction and restitution, rising, and one factor on the inertia."""

    friction: NDArray[np.float64]
    restitution: NDArray[np.float64]
    inertia: float

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.friction), len(self.restitution)

    def at(self, place: int) -> Coefficients:
        """The coefficients at a place of the flattened grid."""
        i, j = divmod(place, len(self.restitution))
        return Coefficients(float(self.friction[i]), float(self.restitution[j]), self.inertia)


class ErrorTable:
    """The errors of touchdowns over a grid, summed in blocks.

    `grid` is the finer one that they are interpolated to: between the nodes, at which the impacts are solved, the twist
    after is taken to be linear. `misses_at` gives what `Solver.misses` does. `sums` is (blocks, places of the flattened
    grid), `counts` the number of touchdowns in each block.
    """

    def __init__(self, blocks: Blocks, nodes: Grid, misses_at: Callable[[Coefficients], NDArray[np.float64]]) -> None:
        self.nodes = nodes
        self.grid = Grid(_between(nodes.friction, 0), _between(nodes.restitution, 0), nodes.inertia)
        solved = [
            misses_at(Coefficients(float(friction), float(restitution), nodes.inertia))
            for friction, restitution in product(nodes.friction, nodes.restitution)
        ]
        at_nodes = np.moveaxis(np.array(solved).reshape(*nodes.shape, len(blocks), 2), (2, 3), (0, 1))
        self.counts = np.bincount(blocks).astype(np.float64)
        self.sums = np.zeros((len(self.counts), self.grid.shape[0] * self.grid.shape[1]))
        for block, one in zip(blocks, at_nodes, strict=True):
            self.sums[block] += np.hypot(*_between(_between(one, 1), 2)).ravel()

    def losses(self, weights: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """The mean error at every place, for each row of weights of the blocks: (rows, places)."""
        rows = np.ones((1, len(self.counts))) if weights is None else weights
        found: NDArray[np.float64] = rows @ self.sums / (rows @ self.counts)[:, None]
        return found


def _between(values: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Values along an axis with each gap in equal parts, linear between."""
    below, above = np.delete(values, -1, axis), np.delete(values, 0, axis)
    parts = [below + (above - below) * (k / PARTS) for k in range(PARTS)]
    shape = list(values.shape)
    shape[axis] = PARTS * (shape[axis] - 1)
    joined: NDArray[np.float64] = np.stack(parts, axis + 1).reshape(shape)
    return np.concatenate((joined, np.take(values, [-1], axis)), axis)
