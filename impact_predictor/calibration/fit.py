"""Which friction, restitution and inertia predict recorded touchdowns best, how sure that is, and what it is worth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Final, NamedTuple

import numpy as np

from ..errors import InputError
from .blocks import Blocks, blocks_of
from .inertia import Profile
from .search import Estimate, Search
from .solver import Solver
from .table import Array, Grid
from .touchdowns import Coefficients, ScoredTouchdown

NEEDED: Final = 10
"""Scored touchdowns below which an interval would say nothing."""


BENT: Final = 0.01
"""Twists after a touchdown that leave a straight line by more, relative to the speed before, have another impact in
them; or by more than three times what is usual, where they are noisy."""


class Calibration(NamedTuple):
    """Coefficients fitted to touchdowns.

    `blocks` is the block of each touchdown; `given_misses` and `held_out_misses` are what `Solver.misses` gives with
    the given coefficients, and with those that were fitted to the blocks of the other folds, (n, 2) each. `map` has the
    mean errors over a grid; `inertias` (factor, least mean error over friction and restitution), none where no inertia
    was looked for. `left_out` touchdowns are scored, but something else happens while they are measured.
    """

    touchdowns: tuple[ScoredTouchdown, ...]
    blocks: Blocks
    friction: Estimate
    restitution: Estimate
    inertia: Estimate
    given_misses: Array
    held_out_misses: Array
    map: tuple[Grid, Array]
    inertias: tuple[tuple[float, float], ...]
    left_out: int

    @property
    def given_errors(self) -> Array:
        """The relative errors with the given coefficients, (n,)."""
        return np.hypot(self.given_misses[:, 0], self.given_misses[:, 1])

    @property
    def held_out(self) -> Array:
        """The relative errors with coefficients that were fitted to others, (n,)."""
        return np.hypot(self.held_out_misses[:, 0], self.held_out_misses[:, 1])

    @property
    def given(self) -> Coefficients:
        return Coefficients(self.friction.given, self.restitution.given, self.inertia.given)

    @property
    def fitted(self) -> Coefficients:
        return Coefficients(self.friction.value, self.restitution.value, self.inertia.value)


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
    if len(touchdowns) < NEEDED:
        raise InputError(_too_few(len(touchdowns), number))
    scenes = [one.scene for one in touchdowns]
    if len({(scene.friction, scene.restitution) for scene in scenes}) > 1:
        bodies = " and ".join(sorted({one.body for one in touchdowns}))
        raise InputError(f"{bodies} have frictions or restitutions of their own; calibrate with a scene for each")
    given = Coefficients(scenes[0].friction, scenes[0].restitution)
    blocks = blocks_of(records)
    search = Search(touchdowns, blocks, given, seed, tell)

    rough = search.table()
    start = rough.grid.at(search.best(rough))
    inertia = Estimate(1.0, 1.0, None, None, told=False)
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
    if not friction.told:
        table = search.zoomed(search.table(np.array([friction.value]), inertia=inertia.value))
        restitution = search.estimate(table, 1)
    if not restitution.told:
        table = search.table(table.nodes.friction, np.array([restitution.value]), inertia.value)
    return Calibration(
        touchdowns,
        blocks,
        friction,
        restitution,
        inertia,
        Solver(touchdowns).misses(given),
        search.held_out(table),
        (coarse.grid, coarse.losses().reshape(coarse.grid.shape)),
        inertias,
        number - len(touchdowns),
    )


def straight(records: Sequence[Sequence[ScoredTouchdown]]) -> list[list[ScoredTouchdown]]:
    """The touchdowns after which nothing else happens while they are measured: their twists change in a straight line.

    Noise bends all of them, another impact one of them.
    """
    bends = [one.bend for record in records for one in record if one.bend < inf]
    limit = max(BENT, 3.0 * float(np.median(bends))) if bends else BENT
    return [[one for one in record if one.bend <= limit] for record in records]


def _too_few(number: int, scored: int) -> str:
    there = "1 touchdown" if number == 1 else f"{number or 'no'} touchdowns"
    more = f" ({scored} are scored, some too slow for the rate of the samples)" if scored > number else ""
    return f"{there} can be fitted to{more}, but {NEEDED} are needed; give more bags"
