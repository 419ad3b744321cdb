"""Which coefficients predict recorded touchdowns best, how sure that is, and what it is worth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise, product
from math import inf
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..stamps import NANOSECONDS
from .impulses import AGAIN, Weights, least_lengths
from .motions import Reals
from .search import FOLDS, LEVEL, Estimate, resamples
from .solver import Coefficients, Solver, lengths
from .touchdowns import ScoredTouchdown

NEEDED: Final = 10
"""Scored touchdowns below which an interval would say nothing."""


class CoefficientRange(NamedTuple):
    """Of a coefficient: its least and greatest value, a step that changes it little, and the width of an interval
    beyond which it is not known: a book tells it as well.
    """

    least: float
    most: float
    step: float
    wide: float


class Profile(NamedTuple):
    """Of a coefficient that others may stand in for: the values with each of which these are fitted anew, and the
    factor between the ends of an interval beyond which it is not known.
    """

    values: tuple[float, ...]
    wide: float


PROFILES: Final = {
    "merge": Profile(tuple(1e-3 * 2.0 ** (k / 3.0) for k in range(-6, 10)), 5.0),
    "inertia": Profile(tuple(1.08**k for k in range(-12, 13)), 1.25),
}

RANGES: Final = {
    "friction": CoefficientRange(0.0, 100.0, 5e-3, 0.2),
    "restitution": CoefficientRange(0.0, 1.0, 5e-3, 0.3),
}

COARSE: Final = (0.0, 0.05, 0.1, 0.16, 0.24, 0.32, 0.44, 0.64, 1.0, 2.0, 100.0), (0.0, 0.1, 0.25, 0.5, 1.0)
"""Where the search begins: friction and restitution. The gaps grow where less depends on them."""

Blocks = NDArray[np.int64]
"""The block of each touchdown: (n,), counting from 0."""

APART: Final = 1.0
"""s: touchdowns further apart than this are of different motions, or of different times."""

ENOUGH: Final = 10
"""Blocks below which a record is cut at ever shorter pauses, down to single touchdowns."""

ALIKE: Final = 1e-3
"""Mean errors that differ by less are alike: a thousandth of the speed is less than records or rigid theory hold."""

_STEPS: Final = 12
_FEW: Final = 2
_SOME: Final = 200
_HALVINGS: Final = 12


class Calibration(NamedTuple):
    """Coefficients fitted to touchdowns.

    `blocks` is the block of each touchdown, `estimates` what is told of each coefficient by its name, and `fitted` all
    of them together. Errors are relative, |(dv, s dw)| / |(v, s w) before|, (n,) each: with the `given` coefficients;
    `held_out` with those that were fitted to the blocks of the other folds; and of the `simple` answers by their names.
    """

    touchdowns: tuple[ScoredTouchdown, ...]
    blocks: Blocks
    estimates: dict[str, Estimate]
    fitted: Coefficients
    given: Reals
    held_out: Reals
    simple: dict[str, Reals]


def calibrate(
    records: Sequence[Sequence[ScoredTouchdown]],
    inertia: bool = False,
    seed: int = 0,
    tell: Callable[[int], None] = lambda done: None,
) -> Calibration:
    """Fit coefficients to the touchdowns of some records by the least mean of their relative errors.

    Fitted are friction, restitution and merge time, and a factor on the `inertia` where that is asked for. The mean of
    lengths is the loss of the spatial median: a touchdown that rigid theory does not explain pulls no more than others.
    Intervals are those of the bootstrap over blocks (percentiles), the same for the same `seed`; each is wider by what
    changes the mean error by a thousandth of the speed. A coefficient that the touchdowns do not tell stays as it was.
    `tell` takes now and then how many impacts are solved, from 0. InputError where there are too few touchdowns, or
    their bodies have several frictions, restitutions or merge times.
    """
    touchdowns = tuple(one for record in records for one in record)
    if (number := len(touchdowns)) < NEEDED:
        there = "1 touchdown" if number == 1 else f"{number or 'no'} touchdowns"
        raise InputError(f"{there} can be fitted to, but {NEEDED} are needed; give more bags")
    known = {(one.scene.friction, one.scene.restitution, one.scene.merge) for one in touchdowns}
    if len(known) > 1:
        bodies = " and ".join(sorted({one.body for one in touchdowns}))
        raise InputError(
            f"{bodies} have frictions, restitutions or merge times of their own; calibrate with a scene for each"
        )
    tell(0)
    given = Coefficients(*known.pop())
    fit = CoefficientSearch(touchdowns, blocks_of(records), given, seed, tell)
    given_errors = lengths(fit.solver.misses(given))
    fit.search(fit.rough(given))
    profiles = {name: fit.profile(name) for name in PROFILES if inertia or name != "inertia"}
    estimates = fit.estimates()
    unknown = {name: one.value for name, one in estimates.items() if not one.known}
    if unknown:
        # Those that are told are fitted once more, with the others as they stay.
        fit.free &= ~np.isin(fit.names, list(unknown))
        fit.search(fit.best._replace(**unknown))
        estimates |= {name: one for name, one in fit.estimates().items() if name not in unknown}
    return Calibration(
        touchdowns=touchdowns,
        blocks=fit.blocks,
        estimates=estimates | profiles,
        fitted=fit.best,
        given=given_errors,
        held_out=fit.held_out(),
        simple=fit.solver.simple_errors(),
    )


class CoefficientSearch:
    """The search for the coefficients of `RANGES`: `best` are the best so far, and those change that are `free`."""

    def __init__(
        self,
        touchdowns: Sequence[ScoredTouchdown],
        blocks: Blocks,
        given: Coefficients,
        seed: int,
        tell: Callable[[int], None],
    ) -> None:
        self.solver, self.blocks, self.names, self.best = Solver(touchdowns), blocks, list(RANGES), given
        self.free: NDArray[np.bool_] = np.ones(len(self.names), bool)
        self._given, self._seed, self._tell, self._done = given, seed, tell, 0
        self._drawn = np.array([*resamples(blocks, seed)], float)
        """How often each touchdown counts in each resample (resamples, n)."""
        self._missed = self._slopes = np.zeros(0)

    def rough(self, given: Coefficients) -> Coefficients:
        """The best friction and restitution of a coarse grid, by some of the touchdowns."""
        grid = [given._replace(friction=one, restitution=other) for one, other in product(*COARSE)]
        some = Solver(self.solver.touchdowns[:: 1 + len(self.blocks) // _SOME])
        return min((given, *grid), key=lambda one: float(lengths(some.misses(one)).mean()))

    def search(self, start: Coefficients, steps: int = _STEPS) -> None:
        """Find the best coefficients from a start; with few steps, by slopes that are not exact."""
        self.best = start
        exact, every = steps > _FEW, np.ones(len(self.blocks))
        begun = self._missed, self._slopes = self.linear(self._numbers(start), exact)
        if self.free.any():
            found = least_lengths(lambda x: self.linear(x, exact), every, self.free, self._numbers(start), steps)
            self.best = self._coefficients(found)
            self._missed, self._slopes = self.linear(self._numbers(self.best), exact)
        if lengths(begun[0]).mean() < lengths(self._missed).mean():
            # It has gone over a ridge.
            self.best, (self._missed, self._slopes) = start, begun

    def profile(self, name: str) -> Estimate:
        """What the touchdowns tell of a coefficient of `PROFILES`; the others become the best with its value.

        Its interval has the values that do not surely predict worse than the best one. A value in it stays as given;
        else it is the best one, of merge times the shortest: longer ones make one impact of two.
        """
        given, start, (values, wide) = getattr(self._given, name), self.best, PROFILES[name]
        if given == 0.0:
            return Estimate(given, given, None, None, known=False)
        fits: list[tuple[float, Coefficients, Reals]] = []
        for value in sorted({given, *values}):
            self.search(start._replace(**{name: value}), _FEW)
            fits.append((value, self.best, lengths(self._missed)))
        place = int(np.argmin([errors.mean() for *_, errors in fits]))
        alike = [not self._surely_more(errors - fits[place][2]) for *_, errors in fits]
        first = place - next((k for k, one in enumerate(alike[place::-1]) if not one), place + 1) + 1
        last = place + next((k for k, one in enumerate(alike[place:]) if not one), len(fits) - place) - 1
        # Between the values it may be anywhere.
        low = (fits[first - 1][0] * fits[first][0]) ** 0.5 if first else None
        high = (fits[last][0] * fits[last + 1][0]) ** 0.5 if last < len(fits) - 1 else None
        known = low is not None and high is not None and high <= wide * low
        value = given
        if known and not (low or 0.0) <= given <= (high or inf):
            value = fits[first if name == "merge" else place][0]
        self.search(next(best for one, best, _ in fits if one == value))
        return Estimate(given, value, low, high, known)

    def linear(self, numbers: Reals, exact: bool = True) -> tuple[Reals, Reals]:
        """By what predictions miss the measured twists (n, 6), and their slopes (n, 6, names), exact or those of the
        impacts alone; beyond the ends of the ranges both go on in straight lines.
        """
        at = self._coefficients(numbers)
        missed, slopes = self.solver.misses(at), np.zeros((len(self.blocks), 6, len(self.names)))
        self._said()
        for k, name in enumerate(self.names):
            value, (_, most, step, _) = getattr(at, name), RANGES[name]
            if self.free[k]:
                step = step if value + step <= most else -step
                beside = at._replace(**{name: value + step})
                slopes[:, :, k] = ((self.solver.misses if exact else self.solver.near)(beside) - missed) / step
                self._said()
        return missed + slopes @ (numbers - self._numbers(at)), slopes

    def estimates(self) -> dict[str, Estimate]:
        """What the touchdowns tell of each coefficient, near the best ones."""
        best = self._numbers(self.best)
        draws = np.array([self._refitted(weights, best) for weights in self._drawn])
        ends = np.quantile(draws, (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL), axis=0).T
        found = {}
        for k, (name, (low, high)) in enumerate(zip(self.names, ends.tolist(), strict=True)):
            least, most, _, wide = RANGES[name]
            others = self.free & (np.arange(len(self.names)) != k)
            rows = self._slopes.reshape(-1, len(self.names))
            own = rows[:, k] - rows[:, others] @ np.linalg.lstsq(rows[:, others], rows[:, k], rcond=1e-10)[0]
            alike = ALIKE / max(float(lengths(own.reshape(-1, 6)).mean()), 1e-9)
            low, high = max(least, low - alike), min(most, high + alike)
            given, value = getattr(self._given, name), getattr(self.best, name)
            known = high - low <= wide and not (name == "friction" and self._end(name, most) == most)
            if not known:
                # Far from the best value the slopes there tell nothing.
                low, high = self._end(name, least), self._end(name, most)
                known = high - low <= wide
            if not known:
                value = min(max(given, low), high)
            found[name] = Estimate(given, value, low, high if known or high < most else None, known)
        return found

    def held_out(self) -> Reals:
        """The error of each touchdown with what is best for the blocks of the other folds (n,)."""
        number = int(self.blocks.max()) + 1
        folds = np.random.default_rng(self._seed).permutation(number) % min(FOLDS, number)
        best, errors = self._numbers(self.best), np.empty(len(self.blocks))
        for fold in range(int(folds.max()) + 1):
            out = folds[self.blocks] == fold
            others = self._coefficients(self._refitted(1.0 - out, best))
            some = Solver([one for one, left in zip(self.solver.touchdowns, out, strict=True) if left])
            errors[out] = lengths(some.misses(others))
        return errors

    def _refitted(self, weights: Weights, best: Reals) -> Reals:
        """The best coefficients for other weights of the touchdowns, as far as the slopes tell."""
        if not self.free.any():
            return best
        return least_lengths(
            lambda x: (self._missed + self._slopes @ (x - best), self._slopes), weights, self.free, best, AGAIN
        )

    def _surely_more(self, more: Reals) -> bool:
        """Whether errors are more in the mean than others, by differences (n,), whichever blocks are drawn."""
        means = (self._drawn * more).sum(axis=1) / self._drawn.sum(axis=1)
        return float(np.quantile(means, 0.5 - 0.5 * LEVEL)) > ALIKE

    def _end(self, name: str, outside: float) -> float:
        """How far a coefficient can go from the best one towards an end before it surely predicts worse."""
        inside, errors = getattr(self.best, name), lengths(self._missed)
        middle = outside
        for _ in range(_HALVINGS):
            if self._surely_more(lengths(self.solver.misses(self.best._replace(**{name: middle}))) - errors):
                outside = middle
            else:
                inside = middle
            if inside == outside:
                break
            middle = 0.5 * (inside + outside)
        return float(inside)

    def _numbers(self, coefficients: Coefficients) -> Reals:
        return np.array([getattr(coefficients, name) for name in self.names])

    def _coefficients(self, numbers: Reals) -> Coefficients:
        pairs = zip(self.names, numbers.tolist(), strict=True)
        return self.best._replace(**{name: min(max(x, RANGES[name].least), RANGES[name].most) for name, x in pairs})

    def _said(self) -> None:
        self._done += len(self.blocks)
        self._tell(self._done)


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
    return np.concatenate(([0], np.cumsum(breaks[:-1] >= min(APART, longest[-1]))))
