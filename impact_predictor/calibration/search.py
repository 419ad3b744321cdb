"""What data tell of a number: a value, an interval by the bootstrap, and whether they tell it at all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]

FOLDS: Final = 10
"""Parts of the blocks, each of which is predicted with what was fitted to the others."""

RESAMPLES: Final = 1000
LEVEL: Final = 0.95


class Estimate(NamedTuple):
    """What data tell of a number.

    `low` and `high` are the ends of its 95 % interval; `high` is None where greater values predict as well, as a
    friction does at which nothing slips, and so is `low`. Where it is not `known`, `value` is the given one, or that
    end of the interval which is next to it.
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


def resamples(owner: NDArray[np.int64], seed: int) -> Iterator[NDArray[np.int64]]:
    """How often each impact or flight counts when their motions are drawn anew."""
    owners = int(owner.max()) + 1
    for drawn in np.random.default_rng(seed).integers(0, owners, (RESAMPLES, owners)):
        yield np.bincount(drawn, minlength=owners)[owner]


def estimates(given: Reals, values: Reals, draws: Reals, widths: Reals) -> list[Estimate]:
    """Numbers with the intervals of their draws (resamples, n); known are those whose interval is not too wide."""
    low, high = np.quantile(draws, (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL), axis=0)
    columns = (each.tolist() for each in (given, values, low, high, high - low <= widths))
    return [Estimate(*one) for one in zip(*columns, strict=True)]
