"""The distributions of the errors of touchdowns, and what touchdowns say all together."""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from itertools import accumulate, pairwise
from math import floor, hypot, log10
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ..prediction.skill import SIMPLE
from ..wording import counted, percent, words

if TYPE_CHECKING:
    from ..bags.body import Settled
    from .touchdowns import TouchdownRow

LEAD_TIME_EDGES: Final = (0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06)
"""Borders in s between which the error is shown against the lead time."""
PER_DECADE: Final = 100
"""Bins for each factor of ten: in each of them numbers differ by 2.3 % at most."""
_LEAST: Final = 1e-12
"""Smaller numbers, and 0, count as this one."""
_PERCENTILES: Final = {"p50": 0.5, "p90": 0.9, "p99": 0.99}
WHY: Final = {
    "ONE_POINT": "nothing stood on the support before",
    "OUT_OF_PLANE": "the body also turned off the plane of the impact, or its contacts lay beside it",
    "ONE_CORNER_FIRST": "one corner of the edge that struck came before the other",
    "TOO_SHORT": "the record ended, or paused, too soon after",
    "TOO_SLOW": "the approach was too slow to be told from rest",
    "DRIVEN": "the feet are driven: what follows is not the impact alone",
    "OTHER_POINTS": "other points came to the support than was predicted",
    "UNSEEN": "the record shows no point that came to the support then",
    "UNANNOUNCED": "it was announced only when it had happened",
    "NOT_ISOLATED": "another touchdown was too near",
    "MOVING_CONTACTS": "the contacts move over the body",
}
"""Why a touchdown is not compared with what was measured, by the names of `Leftover`."""


class Distribution(NamedTuple):
    """How many numbers there are, what parts of them stay below, the greatest one, and how many lie in each bin.

    A bin k holds the numbers from 10**(k / PER_DECADE) to 10**((k + 1) / PER_DECADE). None where there are no numbers.
    """

    number: int = 0
    p50: float | None = None
    p90: float | None = None
    p99: float | None = None
    most: float | None = None
    bins: Mapping[int, int] = MappingProxyType({})


class SpanErrors(NamedTuple):
    """The errors of the predictions that were made from `begin` to `end` s before their touchdowns."""

    begin: float
    end: float
    errors: Distribution


def errors_of(rows: Iterable[TouchdownRow]) -> Distribution:
    """The relative errors of the scored rows."""
    return spread_of([row.error for row in rows if row.error is not None])


def errors_ahead(predictions: Iterable[tuple[float, float]]) -> tuple[SpanErrors, ...]:
    """How wrong predictions were, from the (lead time in s, error) of each, by how long before they were made."""
    made = list(predictions)
    return tuple(
        SpanErrors(begin, end, spread_of([abs(error) for lead_time, error in made if begin <= lead_time < end]))
        for begin, end in pairwise(LEAD_TIME_EDGES)
    )


def velocity_errors_ahead(settled: Iterable[Settled]) -> tuple[SpanErrors, ...]:
    """How wrong the predicted velocities of scored touchdowns were, by how long before them they were predicted."""
    return errors_ahead(one for _, score, _ in settled if score.scored for one in score.history)


def reasons(rows: Iterable[TouchdownRow]) -> dict[str, int]:
    """How many rows are not scored for each reason, the commonest first; a row may have several."""
    counts = Counter(flag for row in rows if not row.scored for flag in row.flags if flag in WHY)
    return dict(counts.most_common())


def quantile(values: Sequence[float], part: float) -> float:
    """What a part of the values stays below, interpolated linearly between them; at least one value."""
    import numpy as np  # commands whose help this file serves load none

    return float(np.quantile(values, part))


def without_bag(said: str, bag: str) -> str:
    """A sentence that names its bag, as it can be said of several."""
    return said.replace(f"in {bag}, ", "").replace(bag, "it")


def spread_of(numbers: Sequence[float]) -> Distribution:
    """The spread of some numbers, its percentiles exact."""
    if not numbers:
        return Distribution()
    bins = Counter(floor(PER_DECADE * log10(max(number, _LEAST))) for number in numbers)
    percentiles = {name: quantile(numbers, part) for name, part in _PERCENTILES.items()}
    return Distribution(number=len(numbers), most=max(numbers), bins=bins, **percentiles)


def together(spreads: Iterable[Distribution]) -> Distribution:
    """The spread of all the numbers of several spreads; with more than one its percentiles are those of the bins."""
    known = [spread for spread in spreads if spread.number]
    if len(known) < 2:
        return known[0] if known else Distribution()
    bins: Counter[int] = Counter()
    for spread in known:
        bins.update(spread.bins)
    places = sorted(bins)
    below = [*accumulate(bins[place] for place in places)]
    middles = {name: places[bisect_left(below, part * below[-1])] + 0.5 for name, part in _PERCENTILES.items()}
    percentiles = {name: 10.0 ** (middle / PER_DECADE) for name, middle in middles.items()}
    return Distribution(number=below[-1], most=max(spread.most or 0.0 for spread in known), bins=bins, **percentiles)


def to_json(spread: Distribution) -> dict[str, Any]:
    """As JSON: `count`, `p50`, `p90`, `p99`, `max`, and `bins` as pairs of a bin and its count, those with any."""
    parts = {name: getattr(spread, name) for name in _PERCENTILES}
    bins = [list(one) for one in sorted(spread.bins.items())]
    return {"count": spread.number, **parts, "max": spread.most, "bins": bins}


def from_json(entry: Mapping[str, Any] | None) -> Distribution:
    """What `to_json` wrote; empty where there is nothing."""
    if not entry:
        return Distribution()
    percentiles = {name: entry[name] for name in _PERCENTILES}
    return Distribution(number=entry["count"], most=entry["max"], bins=dict(entry["bins"]), **percentiles)


def _errors(spread: Distribution) -> str:
    if not spread.number:
        return ""
    return f": relative error {percent(spread.p50)} % in the median, 90 % below {percent(spread.p90)} %"


class Tally:
    """Touchdowns of one bag or of many: how wrong the scored ones are, why others are not, and landings of feet."""

    def __init__(self, rows: Iterable[TouchdownRow] = ()) -> None:
        self._touchdowns = self._on_points = 0
        self._reasons: Counter[str] = Counter()
        self._feet: set[tuple[str, str]] = set()
        self._landings = 0
        self._bounds: set[str] = set()
        self._known: dict[str, array[float]] = defaultdict(lambda: array("d"))
        """The numbers that rows have, by what they tell; of landings all but `relative`."""
        self.add(rows)

    def add(self, rows: Iterable[TouchdownRow]) -> None:
        for row in rows:
            if row.foot:
                self._landings += 1
                self._feet.add((row.body, row.foot))
                self._bounds |= {row.bound} if row.bound else set()
                numbers = {
                    "predicted": row.time_error,
                    # What follows of a foot that stands already comes at once after its first part.
                    "ahead": None if row.is_second else row.ahead,
                    "error": row.time_errors[0] if row.time_errors else None,
                    "simple": row.simple_time_error,
                    "speed": row.landing_speed,
                    "impulse": row.impulse and hypot(*row.impulse),
                    "change": row.velocity_change and hypot(*row.velocity_change[:2]),
                }
            else:
                self._touchdowns += 1
                self._on_points += row.is_on_points
                self._reasons.update(row.why_not_scored)
                numbers = {"planar": row.error, "whole": row.error_6d}
                if row.error_6d is not None:
                    numbers |= zip(SIMPLE.values(), row.simple_errors_6d or (), strict=False)
            for name, number in numbers.items():
                if number is not None:
                    self._known[name].append(number)

    def sentences(self) -> list[str]:
        """What they say, one sentence each."""
        said = self._of_landings() if self._landings else []
        return said + (self._of_touchdowns() if self._touchdowns or not said else [])

    def _of_touchdowns(self) -> list[str]:
        if not self._touchdowns:
            return ["No touchdown was predicted."]
        of, planar = f" of {counted(self._touchdowns, 'touchdown')}", spread_of(self._known["planar"])
        said = [f"{planar.number:,}{of} scored{_errors(planar)}."]
        if self._on_points:
            whole = spread_of(self._known["whole"])
            said = [f"{whole.number:,}{of} scored by the whole twist{_errors(whole)}."]
            errors = [(name, self._known[name]) for name in SIMPLE.values() if self._known[name]]
            medians = [f"{name} {percent(quantile(values, 0.5))} %" for name, values in errors]
            said += [f"Simple answers to these, in the median: {', '.join(medians)}."] if medians else []
            said += [f"{planar.number:,}{of} scored in the impact plane{_errors(planar)}."] if planar.number else []
        why = [f"  {count:,} {words(reason)}: {WHY[reason]}" for reason, count in self._reasons.most_common()]
        heading = "The samples after the others do not show what the impact left, for one or several reasons each:"
        return [*said, *([heading] if why else []), *why]

    def _of_landings(self) -> list[str]:
        from ..scenarios.comparison import LEAD_TIMES  # only where feet have landed

        number, feet, known = self._landings, len(self._feet), self._known
        predicted = len(known["predicted"])
        said = f"{counted(number, 'landing')} of {feet} {'foot' if feet == 1 else 'feet'}, {predicted:,} predicted"
        said += f", {1e3 * min(known['ahead']):.0f} ms ahead or earlier." if known["ahead"] else "."
        if predicted < number:
            said += " The others came too suddenly, or the noise of base and feet hides how they come down."
        told = [said]
        if errors := [abs(error) for error in known["error"]]:
            wrong = f"{1e3 * quantile(errors, 0.5):.1f} ms wrong in the median"
            simple = [abs(error) for error in known["simple"]]
            beside = f", a foot's gap over its speed {1e3 * quantile(simple, 0.5):.1f} ms" if simple else ""
            against = "Against the motion of the feet as recorded, which ends when they stand"
            told.append(f"{against}, the time predicted {1e3 * LEAD_TIMES[0]:.0f} ms ahead is {wrong}{beside}.")
        if known["impulse"]:
            speeds = f"{quantile(known['speed'], 0.5):.3f} m/s in the median, at most {max(known['speed']):.3f} m/s"
            most = f"{max(known['impulse']):.2f} N s to a foot and {max(known['change']):.3f} m/s to the body"
            bound = f" ({', '.join(sorted(self._bounds))})" if self._bounds else ""
            told.append(f"Feet come down with {speeds}; that gives at most {most}{bound}.")
        return told
