"""Which friction, restitution and inertia predict recorded touchdowns best, how sure that is, and what it is worth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from ..errors import InputError
from .search import COARSE, Estimate, Search
from .solver import Solver
from .table import Blocks, Grid, blocks_of
from .touchdowns import Coefficients, ScoredTouchdown

NEEDED: Final = 10
"""Scored touchdowns below which an interval would say nothing."""

BENT: Final = 0.01
"""Twists after a touchdown that leave a straight line by more, relative to the speed before, have another impact in
them; or by more than three times what is usual, where they are noisy."""

FACTORS: Final = (1 / 3, 0.5, 0.7, 0.84, 1.0, 1.2, 1.45, 2.0, 3.0)
"""Of the given inertia, between a body with its mass at the middle and one with it all outside."""

KNOWN: Final = 1.2
"""An inertia is known when the ends of its interval differ by less than this factor: a drawing tells it as well."""

ALIKE: Final = 1e-3
"""Mean errors that differ by less are alike for an inertia, which friction and restitution stand in for: a thousandth
of the speed is less than any record or rigid theory holds."""

_HALVINGS: Final = 3


class Calibration(NamedTuple):
    """Coefficients fitted to touchdowns.

    `blocks` is the block of each touchdown; `given_errors` and `held_out` are the relative errors with the given
    coefficients, and with those that were fitted to the blocks of the other folds, (n,) each. `map` has the
    mean errors over a grid; `inertias` (factor, least mean error over friction and restitution), none where no inertia
    was looked for. `left_out` touchdowns are scored, but something else happens while they are measured.
    """

    touchdowns: tuple[ScoredTouchdown, ...]
    blocks: Blocks
    friction: Estimate
    restitution: Estimate
    inertia: Estimate
    given_errors: NDArray[np.float64]
    held_out: NDArray[np.float64]
    map: tuple[Grid, NDArray[np.float64]]
    inertias: tuple[tuple[float, float], ...]
    left_out: int


def calibrate(
    records: Sequence[Sequence[ScoredTouchdown]], seed: int = 0, tell: Callable[[int], None] = lambda done: None
) -> Calibration:
    """Fit coefficients to the touchdowns of some records by the least mean of their relative errors.

    The mean of lengths is the loss of the spatial median: a touchdown that rigid theory does not explain pulls no more
    than any other. Intervals are those of the bootstrap over blocks (percentiles), the same for the same `seed`. A
    coefficient that the touchdowns do not tell stays as it was, and so does the inertia of bodies that have several.
    `tell` takes now and then how many impacts are solved.

    Raises:
        InputError: there are too few touchdowns, or their bodies have several frictions or restitutions.
    """
    number = sum(map(len, records))
    records = straight(records)
    touchdowns = tuple(one for record in records for one in record)
    if (fit := len(touchdowns)) < NEEDED:
        there = "1 touchdown" if fit == 1 else f"{fit or 'no'} touchdowns"
        more = f" ({number} are scored, some too slow for the rate of the samples)" if number > fit else ""
        raise InputError(f"{there} can be fitted to{more}, but {NEEDED} are needed; give more bags")
    scenes = [one.scene for one in touchdowns]
    if len({(scene.friction, scene.restitution) for scene in scenes}) > 1:
        bodies = " and ".join(sorted({one.body for one in touchdowns}))
        raise InputError(f"{bodies} have frictions or restitutions of their own; calibrate with a scene for each")
    given = Coefficients(scenes[0].friction, scenes[0].restitution)
    blocks = blocks_of(records)
    search = Search(touchdowns, blocks, given, seed, tell)

    rough = search.table()
    start = rough.grid.at(search.best(rough))
    inertia = Estimate(1.0, 1.0, None, None, known=False)
    inertias: tuple[tuple[float, float], ...] = ()
    if len({scene.inertia for scene in scenes}) == 1:
        profile = Profile(search, start)
        inertia, inertias = profile.estimate(), profile.points
        start = profile.at(inertia.value)
    # Friction also acts before the touchdown, since the last sample.
    search = search.approached(start)
    coarse = search.table(inertia=inertia.value)
    table = search.zoomed(coarse)
    friction, restitution = search.estimate(table, 0), search.estimate(table, 1)
    if not friction.known:
        table = search.zoomed(search.table(np.array([friction.value]), inertia=inertia.value))
        restitution = search.estimate(table, 1)
    if not restitution.known:
        table = search.table(table.nodes.friction, np.array([restitution.value]), inertia.value)
    return Calibration(
        touchdowns=touchdowns,
        blocks=blocks,
        friction=friction,
        restitution=restitution,
        inertia=inertia,
        given_errors=np.hypot(*Solver(touchdowns).misses(given).T),
        held_out=np.hypot(*search.held_out(table).T),
        map=(coarse.grid, coarse.losses().reshape(coarse.grid.shape)),
        inertias=inertias,
        left_out=number - len(touchdowns),
    )


def straight(records: Sequence[Sequence[ScoredTouchdown]]) -> list[list[ScoredTouchdown]]:
    """The touchdowns after which nothing else happens while they are measured: their twists change in a straight line.

    Noise bends all of them, another impact one of them.
    """
    bends = [one.bend for record in records for one in record if one.bend < inf]
    limit = max(BENT, 3.0 * float(np.median(bends))) if bends else BENT
    return [[one for one in record if one.bend <= limit] for record in records]


class _Fit(NamedTuple):
    """The least mean error at one factor: the coefficients there, and the errors summed in blocks."""

    coefficients: Coefficients
    errors: NDArray[np.float64]

    @property
    def factor(self) -> float:
        return self.coefficients.inertia


class Profile:
    """The best friction and restitution at several factors on the inertia; the search begins at `start`."""

    def __init__(self, search: Search, start: Coefficients) -> None:
        self._search = search
        self._fits = [self._fit(start, 1.0)]
        for factor in sorted(FACTORS, key=lambda factor: max(factor, 1.0 / factor)):
            if factor != 1.0:
                self._add(factor)

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """Each factor with its least mean error."""
        count = self._search.number
        return tuple((fit.factor, float(fit.errors.sum()) / count) for fit in self._fits)

    def at(self, factor: float) -> Coefficients:
        """The best coefficients with one of the factors."""
        return next(fit.coefficients for fit in self._fits if fit.factor == factor)

    def estimate(self) -> Estimate:
        """What the touchdowns tell of the inertia; one within its interval stays as given."""
        for _ in range(_HALVINGS):
            edges = self._edges()
            if len(edges) == 2:
                place = [fit.factor for fit in self._fits].index(self._best.factor)
                edges += pairwise(self._fits[place - 1 : place + 2])
            for factor in sorted({(one.factor * other.factor) ** 0.5 for one, other in edges}):
                self._add(factor)
        ends = self._edges()
        below = next((one.factor for one, other in ends if self._alike(other)), None)
        above = next((other.factor for one, other in ends if self._alike(one)), None)
        known = below is not None and above is not None and above <= KNOWN * below
        value = 1.0
        if known and not (below or 0.0) <= 1.0 <= (above or 0.0):
            value = self._best.factor
        return Estimate(1.0, value, below, above, known)

    @property
    def _best(self) -> _Fit:
        return min(self._fits, key=lambda fit: float(fit.errors.sum()))

    def _edges(self) -> list[tuple[_Fit, _Fit]]:
        """The neighbours of which one predicts as well as the best and the other worse: the outermost of each side."""
        alike = [self._alike(fit) for fit in self._fits]
        pairs = list(zip(pairwise(self._fits), pairwise(alike), strict=True))
        rising = [] if alike[0] else [pair for pair, same in pairs if same == (False, True)]
        falling = [] if alike[-1] else [pair for pair, same in pairs if same == (True, False)]
        return rising[:1] + falling[-1:]

    def _alike(self, fit: _Fit) -> bool:
        return not self._search.surely_more(fit.errors - self._best.errors, ALIKE)

    def _add(self, factor: float) -> None:
        nearest = min(self._fits, key=lambda fit: max(fit.factor / factor, factor / fit.factor))
        self._fits = sorted([*self._fits, self._fit(nearest.coefficients, factor)], key=lambda fit: fit.factor)

    def _fit(self, start: Coefficients, factor: float) -> _Fit:
        def loss(point: NDArray[np.float64]) -> float:
            return float(self._search.block_errors(Coefficients(float(point[0]), float(point[1]), factor)).sum())

        friction, restitution, _ = start
        step = 0.05 if restitution < 0.5 else -0.05
        simplex = (friction, restitution), (1.1 * friction + 0.02, restitution), (friction, restitution + step)
        found = minimize(
            loss,
            (friction, restitution),
            method="Nelder-Mead",
            bounds=[(axis[0], axis[-1]) for axis in COARSE],
            options={
                "initial_simplex": simplex,
                "xatol": 5e-3,
                "fatol": 0.1 * ALIKE * self._search.number,
                "maxfev": 60,
            },
        )
        best = Coefficients(float(found.x[0]), float(found.x[1]), factor)
        return _Fit(best, self._search.block_errors(best))
