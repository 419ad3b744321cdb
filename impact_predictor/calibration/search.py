"""What data tell of a number: a value, an interval, and whether they tell it at all."""

from __future__ import annotations

from typing import Final, NamedTuple

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
