"""Settled touchdowns in the form in which they are shown, the distributions of their errors, and what they say."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from math import floor, log10
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ..mechanics.types import Mode, Twist
from ..prediction.types import Leftover, Score
from ..wording import counted, percent, words

if TYPE_CHECKING:
    from ..bags.run import Settled
    from .landings import LandingTally

LEAD_TIME_EDGES: Final = (0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06)
"""Borders in s between which the error is shown against the lead time."""

PER_DECADE: Final = 100
"""Bins for each factor of ten: in each of them numbers differ by 2.3 % at most."""

LEAST: Final = 1e-12
"""Smaller numbers, and 0, count as this one."""

WHY: Final = {
    "ONE_POINT": "nothing stood on the support before",
    "OUT_OF_PLANE": "the body also turned off the plane of the impact, or its contacts lay beside it",
    "ONE_CORNER_FIRST": "one corner of the edge that struck came before the other",
    "TOO_SHORT": "the record ended, or paused, too soon after",
    "TOO_SLOW": "the approach was too slow to be told from rest",
    "DRIVEN": "the feet are driven: what follows is not the impact alone",
}
"""Why a touchdown is not compared with what was measured, by the names of `Leftover`."""


class TouchdownRow(NamedTuple):
    """One settled touchdown as it is shown.

    `body` is the body's frame; `stamp` in ns, the predicted touchdown; `announced` how long before it, in s, the first
    prediction with its contacts was made; `lead_time` in s, `before` and `predicted` of the last prediction; twists of
    the mass centre in the impact plane; `half_distance` of the two contacts in m; `out_of_plane` the part of the
    angular velocity off the plane's axis (0..1); `flags` say what a reader should know and, where it is not `scored`,
    why; `contacts` the points that stood and that struck, None where a run does not have them; `foot` the one that has
    landed, and `time_error` in s of when that was predicted last; `cost` of the last prediction in s, None where it is
    not known.
    """

    body: str
    stamp: int
    announced: float
    lead_time: float
    mode: Mode
    before: Twist
    predicted: Twist
    measured: Twist | None
    half_distance: float
    relative_error: float | None
    out_of_plane: float
    scored: bool
    flags: tuple[str, ...]
    contacts: tuple[tuple[int, ...], tuple[int, ...]] | None = None
    foot: str = ""
    time_error: float | None = None
    cost: float | None = None

    @property
    def error(self) -> float | None:
        """The relative error of what is scored."""
        return self.relative_error if self.scored else None


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


def row_of(body: str, score: Score, cost: float | None = None) -> TouchdownRow:
    """The row of a score; `cost` in s."""
    touchdown, landing = score.touchdown, score.landing
    history = score.history if landing is None else landing.history
    return TouchdownRow(
        body=body,
        stamp=score.stamp,
        announced=history[0][0] if history else touchdown.lead_time,
        lead_time=touchdown.lead_time,
        mode=touchdown.mode,
        before=touchdown.before,
        predicted=touchdown.after,
        measured=score.measured,
        half_distance=touchdown.half_distance,
        relative_error=score.relative_error,
        out_of_plane=touchdown.off_axis,
        scored=score.scored,
        flags=tuple(
            flag.name or "" for flags in (score.leftover, touchdown.flags) for flag in type(flags) if flag & flags
        ),
        contacts=(tuple(touchdown.old), tuple(touchdown.new)),
        foot="" if landing is None else landing.foot,
        time_error=landing.history[-1][1] if landing is not None and landing.history else None,
        cost=cost,
    )


def errors_of(rows: Iterable[TouchdownRow]) -> Distribution:
    """The relative errors of the scored rows."""
    return spread_of([row.relative_error for row in rows if row.scored and row.relative_error is not None])


def error_by_lead_time(scores: Iterable[Score]) -> tuple[SpanErrors, ...]:
    """How wrong every prediction of the scored touchdowns was, by how long before the touchdown it was made."""
    return errors_ahead(prediction for score in scores if score.scored for prediction in score.history)


def errors_ahead(predictions: Iterable[tuple[float, float]]) -> tuple[SpanErrors, ...]:
    """How wrong predictions were, from the (lead time in s, error) of each."""
    made = list(predictions)
    return tuple(
        SpanErrors(begin, end, spread_of([abs(error) for lead_time, error in made if begin <= lead_time < end]))
        for begin, end in pairwise(LEAD_TIME_EDGES)
    )


def reasons(rows: Iterable[TouchdownRow]) -> dict[str, int]:
    """How many rows are not scored for each reason, the commonest first; a row may have several."""
    counts = Counter(flag for row in rows if not row.scored for flag in row.flags if flag in Leftover.__members__)
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
    bins = Counter(floor(PER_DECADE * log10(max(number, LEAST))) for number in numbers)
    p50, p90, p99 = (quantile(numbers, part) for part in (0.5, 0.9, 0.99))
    return Distribution(len(numbers), p50, p90, p99, max(numbers), bins)


def together(spreads: Iterable[Distribution]) -> Distribution:
    """The spread of all the numbers of several spreads; with more than one its percentiles are right to 1 %."""
    known = [spread for spread in spreads if spread.number]
    if len(known) < 2:
        return known[0] if known else Distribution()
    bins: Counter[int] = Counter()
    for spread in known:
        bins.update(spread.bins)
    p50, p90, p99 = (_below(bins, part) for part in (0.5, 0.9, 0.99))
    return Distribution(sum(bins.values()), p50, p90, p99, max(spread.most or 0.0 for spread in known), bins)


def _below(bins: Mapping[int, int], part: float) -> float:
    """What a part of the numbers in bins stays below, as if they lay evenly in each bin."""
    wanted, before, last = part * sum(bins.values()), 0, 0
    for last in sorted(bins):  # the last bin counts where rounding misses every one
        if before + bins[last] >= wanted:
            break
        before += bins[last]
    return float(10.0 ** ((last + (wanted - before) / bins[last]) / PER_DECADE))


def to_json(spread: Distribution) -> dict[str, Any]:
    """As JSON: `count`, `p50`, `p90`, `p99`, `max`, and `bins` as pairs of a bin and its count, those with any."""
    parts = {"p50": spread.p50, "p90": spread.p90, "p99": spread.p99, "max": spread.most}
    return {"count": spread.number, **parts, "bins": [list(one) for one in sorted(spread.bins.items())]}


def from_json(entry: Mapping[str, Any] | None) -> Distribution:
    """What `to_json` wrote; empty where there is nothing."""
    if not entry:
        return Distribution()
    p50, p90, p99, most = (entry[name] for name in ("p50", "p90", "p99", "max"))
    return Distribution(entry["count"], p50, p90, p99, most, dict(entry["bins"]))


class TouchdownTally:
    """Rows of touchdowns: how wrong the scored ones are, and why others are not scored."""

    def __init__(self, rows: Iterable[TouchdownRow] = ()) -> None:
        """Count some rows."""
        self._rows = 0
        self._errors = array("d")
        self._reasons: Counter[str] = Counter()
        for row in rows:
            self.add(row)

    def __bool__(self) -> bool:
        """Whether there is any row."""
        return bool(self._rows)

    def add(self, row: TouchdownRow) -> None:
        """Count a row."""
        self._rows += 1
        self._reasons.update(reasons([row]))
        if row.scored and row.relative_error is not None:
            self._errors.append(row.relative_error)

    def sentences(self) -> list[str]:
        """How wrong the scored touchdowns were, and why the others are not scored, one sentence each."""
        if not self._rows:
            return ["No touchdown was predicted."]
        errors = spread_of(self._errors)
        said = [f"{errors.number:,} of {counted(self._rows, 'touchdown')} scored"]
        if errors.number:
            said[0] += f": relative error {percent(errors.p50)} % in the median, 90 % below {percent(errors.p90)} %"
        said[0] += "."
        if self._reasons:
            several = ", for one or several reasons each" if len(self._reasons) > 1 else ""
            said.append(
                "A touchdown is scored where the samples after it show the velocities that the impact left; they "
                f"do not for {self._rows - errors.number:,}{several}:"
            )
            said += [f"  {count:,} {words(reason)}: {WHY[reason]}" for reason, count in self._reasons.most_common()]
        return said


class ReplayTally:
    """Touchdowns that have happened, those of feet told apart from all others."""

    def __init__(self) -> None:
        """Begin with none."""
        self._others = TouchdownTally()
        self._landings: LandingTally | None = None

    def add(self, settled: Iterable[Settled]) -> None:
        """Count the touchdowns of a bag."""
        for one in settled:
            if one.score.landing is None:
                self._others.add(row_of(*one))
            else:
                from .landings import LandingTally, landing_row  # only where feet have landed

                self._landings = self._landings or LandingTally()
                self._landings.add(landing_row(one.body, one.score))

    def sentences(self) -> list[str]:
        """What they say, one sentence each."""
        said = [] if self._landings is None else self._landings.sentences()
        return said + (self._others.sentences() if self._others or not said else [])
