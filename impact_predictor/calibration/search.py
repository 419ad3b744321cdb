"""Friction and restitution that fit touchdowns best, and how sure they are, read from tables of errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .solver import Solver
from .table import Blocks, ErrorTable, Grid
from .touchdowns import Coefficients, ScoredTouchdown

FOLDS: Final = 10
"""Parts of the blocks, each of which is predicted with what was fitted to the others."""

RESAMPLES: Final = 1000
LEVEL: Final = 0.95

TIED: Final = 1e-6
"""Mean errors that differ by less are the same: the impacts do not depend on what differs between them."""

COARSE: Final = (
    np.array([0.0, 0.05, 0.1, 0.16, 0.24, 0.32, 0.44, 0.64, 1.0, 2.0, 100.0]),
    np.array([0.0, 0.1, 0.25, 0.5, 1.0]),
)
"""Where the search begins: friction and restitution. The gaps grow where less depends on them."""

_NODES: Final = (11, 6)
_LEVELS: Final = 6
_SHRINKS: Final = 0.7
_RESOLUTION: Final = 1e-3
_BATCH: Final = 200


class Estimate(NamedTuple):
    """What touchdowns tell of a coefficient.

    `low` and `high` are the ends of its 95 % interval; `high` is None where greater values predict as well, as a
    friction does at which nothing slips, and so is `low` of an inertia. Where it is not `known`, `value` is the given
    one, or that end of the interval which is next to it. Of the inertia all are factors on the given one.
    """

    given: float
    value: float
    low: float | None
    high: float | None
    known: bool


def interval(one: Estimate) -> str:
    """An interval in words."""
    if one.high is None:
        return f"at least {one.low:.3g}" if one.low else "any"
    if one.low is None:
        return f"at most {one.high:.3g}"
    digits = 3 if f"{one.low:.3g}" != f"{one.high:.3g}" else 6
    return f"{one.low:.{digits}g} to {one.high:.{digits}g}"


class Search:
    """Tables of the errors of some touchdowns, and what fits and resampled fits read from them."""

    def __init__(
        self,
        touchdowns: Sequence[ScoredTouchdown],
        blocks: Blocks,
        given: Coefficients,
        seed: int,
        tell: Callable[[int], None],
    ) -> None:
        self._touchdowns, self._blocks, self._given = touchdowns, blocks, given
        self._seed, self._tell = seed, tell
        self._solver = Solver(touchdowns)
        self._solved: dict[Coefficients, NDArray[np.float64]] = {}
        self.number = len(touchdowns)
        number = int(blocks.max()) + 1
        drawn = np.random.default_rng(seed).integers(0, number, (RESAMPLES, number))
        self._weights = np.apply_along_axis(np.bincount, 1, drawn, minlength=number).astype(np.float64)

    def approached(self, coefficients: Coefficients) -> Search:
        """A search with the motions before the touchdowns, too, as the coefficients make them."""
        touchdowns = [one.approached(coefficients) for one in self._touchdowns]
        before = len(self._solved) * self.number
        return Search(touchdowns, self._blocks, self._given, self._seed, lambda done: self._tell(before + done))

    def table(
        self,
        friction: NDArray[np.float64] = COARSE[0],
        restitution: NDArray[np.float64] = COARSE[1],
        inertia: float = 1.0,
    ) -> ErrorTable:
        """The table with nodes at some values of the coefficients."""
        return ErrorTable(self._blocks, Grid(friction, restitution, inertia), self.misses)

    def misses(self, coefficients: Coefficients) -> NDArray[np.float64]:
        """What `Solver.misses` gives, solved once."""
        found = self._solved.get(coefficients)
        if found is None:
            found = self._solved[coefficients] = self._solver.misses(coefficients)
            self._tell(len(self._solved) * len(self._touchdowns))
        return found

    def block_errors(self, coefficients: Coefficients) -> NDArray[np.float64]:
        """The errors, summed in blocks."""
        missed = self.misses(coefficients)
        return np.bincount(self._blocks, np.hypot(missed[:, 0], missed[:, 1])).astype(np.float64)

    def surely_more(self, more: NDArray[np.float64], by: float = TIED) -> bool:
        """Whether errors, summed in blocks, are more in the mean than others, whichever blocks are drawn.

        `more` has the differences (blocks,); mean errors that differ by less than `by` are the same.
        """
        means = self._weights @ more / self.number
        return bool(np.quantile(means, 0.5 * (1.0 - LEVEL)) > by)

    def zoomed(self, table: ErrorTable) -> ErrorTable:
        """A table that is as narrow as the resampled fits allow."""
        for _ in range(_LEVELS):
            spread = self._bootstrap(table)
            axes: list[NDArray[np.float64]] = []
            shrinks = False
            for i, nodes in enumerate((table.nodes.friction, table.nodes.restitution)):
                low, high = spread[i].min(), spread[2 + i].max()
                low, high = max(nodes[0], low - _gap(nodes, low)), min(nodes[-1], high + _gap(nodes, high))
                # Of small ones evenly spaced, of large ones in the angle of friction.
                angles = np.linspace(atan(low), atan(high), min(len(nodes), _NODES[i]))
                axes.append(np.tan(angles).clip(low, high))
                shrinks |= high - low < _SHRINKS * (nodes[-1] - nodes[0]) and high - low > _RESOLUTION * _NODES[i]
            if not shrinks:
                break
            table = self.table(axes[0], axes[1], table.nodes.inertia)
        return table

    def estimate(self, table: ErrorTable, axis: int) -> Estimate:
        """What a table tells of the friction (axis 0) or the restitution (axis 1)."""
        given, nodes, grid, ends = self._given[axis], table.nodes[axis], table.grid[axis], COARSE[axis]
        assert isinstance(nodes, np.ndarray)
        assert isinstance(grid, np.ndarray)
        best = self.best(table)
        value = table.grid.at(best)[axis]
        if len(nodes) == 1:
            return Estimate(given, value, None, None, known=False)
        spread, outside = self._bootstrap(table), 0.5 * (1.0 - LEVEL)
        lowest, highest = float(np.quantile(spread[axis], outside)), float(np.quantile(spread[2 + axis], 1.0 - outside))
        # No finer than the table, nor than it was zoomed in to.
        low = max(float(ends[0]), lowest - max(_RESOLUTION, float(grid[1] - grid[0])))
        high = min(float(ends[-1]), highest + max(_RESOLUTION, float(grid[-1] - grid[-2])))
        if nodes[-1] >= ends[-1]:
            losses = table.losses().reshape(table.grid.shape)
            places = np.take(np.arange(losses.size).reshape(losses.shape), -1, axis)
            end = int(places[np.argmin(np.take(losses, -1, axis))])
            if not self.surely_more(table.sums[:, end] - table.sums[:, best]):
                # Where the impacts cease to depend on it is known to a gap between the nodes.
                low = max(float(ends[0]), lowest - _gap(nodes, lowest))
                return Estimate(given, max(given, low), low, None, known=False)
        return Estimate(given, value, low, high, known=True)

    def held_out(self, table: ErrorTable) -> NDArray[np.float64]:
        """What `misses` gives of each touchdown with what is best for the blocks of the other folds: (n, 2)."""
        number = len(table.counts)
        folds = np.random.default_rng(self._seed).permutation(number) % min(FOLDS, number)
        found = np.empty((self.number, 2))
        for fold in range(int(folds.max()) + 1):
            best = table.grid.at(self.best(table, (folds != fold).astype(float)))
            left_out = folds[self._blocks] == fold
            others = [one.approached(best) for one, out in zip(self._touchdowns, left_out, strict=True) if out]
            found[left_out] = Solver(others).misses(best)
        return found

    def best(self, table: ErrorTable, weights: NDArray[np.float64] | None = None) -> int:
        """The place of the least mean error, of those that are tied the nearest to the given coefficients."""
        losses = table.losses(None if weights is None else weights[None])[0]
        tied = np.flatnonzero(losses <= losses.min() + TIED).tolist()
        return int(min(tied, key=lambda k: sum(abs(a - b) for a, b in zip(table.grid.at(k), self._given, strict=True))))

    def _bootstrap(self, table: ErrorTable) -> NDArray[np.float64]:
        """The fits to resampled blocks: the least of the best values of each coefficient, then the greatest of each."""
        # What is tied cannot be known better than the table knows the errors.
        best = self.best(table)
        exact = self.block_errors(table.grid.at(best)).sum() / self.number
        tied = TIED + abs(exact - table.losses()[0, best])
        parts = [_extremes(table, weights, tied) for weights in np.split(self._weights, RESAMPLES // _BATCH)]
        return np.concatenate(parts, axis=1)


def _extremes(table: ErrorTable, weights: NDArray[np.float64], tied: float) -> NDArray[np.float64]:
    """The least value of each coefficient that is best for each row of weights, then the greatest: (4, rows)."""
    losses = table.losses(weights)
    best = (losses <= losses.min(1, keepdims=True) + tied).reshape(-1, *table.grid.shape)
    least, greatest = [], []
    for axis, other in ((table.grid.friction, 2), (table.grid.restitution, 1)):
        found = best.any(other)
        least.append(axis[found.argmax(1)])
        greatest.append(axis[len(axis) - 1 - found[:, ::-1].argmax(1)])
    return np.array([*least, *greatest])


def _gap(nodes: NDArray[np.float64], value: float) -> float:
    """The gap between the nodes about a value."""
    if len(nodes) == 1:
        return 0.0
    place = int(np.clip(np.searchsorted(nodes, value), 1, len(nodes) - 1))
    return float(nodes[place] - nodes[place - 1])
