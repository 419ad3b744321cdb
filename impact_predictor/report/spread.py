"""How numbers above 0 are spread: in a form that is small, and that adds up over many bags."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from math import floor, log10
from typing import Any, Final, NamedTuple

from .summary import quantile

PER_DECADE: Final = 100
"""Bins for each factor of ten: in each of them numbers differ by 2.3 % at most."""

LEAST: Final = 1e-12
"""Smaller numbers, and 0, count as this one."""


class Spread(NamedTuple):
    """How many numbers there are, what parts of them stay below, the greatest one, and how many lie in each bin.

    A bin k holds the numbers from 10**(k / PER_DECADE) to 10**((k + 1) / PER_DECADE). None where there are no numbers.
    """

    number: int
    p50: float | None
    p90: float | None
    p99: float | None
    most: float | None
    bins: Mapping[int, int]


EMPTY: Final = Spread(0, None, None, None, None, {})


def spread_of(numbers: Sequence[float]) -> Spread:
    """The spread of some numbers, its percentiles exact."""
    if not numbers:
        return EMPTY
    bins = Counter(floor(PER_DECADE * log10(max(number, LEAST))) for number in numbers)
    p50, p90, p99 = (quantile(numbers, part) for part in (0.5, 0.9, 0.99))
    return Spread(len(numbers), p50, p90, p99, max(numbers), bins)


def together(spreads: Iterable[Spread]) -> Spread:
    """The spread of all the numbers of several spreads; with more than one its percentiles are right to 1 %."""
    known = [spread for spread in spreads if spread.number]
    if len(known) < 2:
        return known[0] if known else EMPTY
    bins: Counter[int] = Counter()
    for spread in known:
        bins.update(spread.bins)
    p50, p90, p99 = (_below(bins, part) for part in (0.5, 0.9, 0.99))
    return Spread(sum(bins.values()), p50, p90, p99, max(spread.most or 0.0 for spread in known), bins)


def _below(bins: Mapping[int, int], part: float) -> float:
    """What a part of the numbers in bins stays below, as if they lay evenly in each bin."""
    wanted, before, last = part * sum(bins.values()), 0, 0
    for last in sorted(bins):  # the last bin counts where rounding misses every one
        if before + bins[last] >= wanted:
            break
        before += bins[last]
    return float(10.0 ** ((last + (wanted - before) / bins[last]) / PER_DECADE))


def to_json(spread: Spread) -> dict[str, Any]:
    """As JSON: `count`, `p50`, `p90`, `p99`, `max`, and `bins` as pairs of a bin and its count, those with any."""
    parts = {"p50": spread.p50, "p90": spread.p90, "p99": spread.p99, "max": spread.most}
    return {"count": spread.number, **parts, "bins": [list(one) for one in sorted(spread.bins.items())]}


def from_json(entry: Mapping[str, Any] | None) -> Spread:
    """What `to_json` wrote; empty where there is nothing."""
    if not entry:
        return EMPTY
    p50, p90, p99, most = (entry[name] for name in ("p50", "p90", "p99", "max"))
    return Spread(entry["count"], p50, p90, p99, most, dict(entry["bins"]))
