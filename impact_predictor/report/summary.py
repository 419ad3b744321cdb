"""Settled touchdowns in the form in which they are shown, and what they say all together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ..mechanics.types import Mode, Twist
from ..prediction.types import Leftover, Score, Status

if TYPE_CHECKING:
    from ..bags.replay import BodyTruth, Result
    from ..scenarios.comparison import Truth
    from ..scenarios.warned import Warned

LEAD_TIME_EDGES: Final = (0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06)
"""Borders in s between which the error is shown against the lead time."""

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
    why; `cost` of the last prediction in s, None where it is not known.
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
    cost: float | None = None


class Errors(NamedTuple):
    """Relative errors all together: their number, their median, and what 90 % stay below; None where there are none."""

    number: int
    median: float | None
    p90: float | None


class LeadTimeErrors(NamedTuple):
    """The relative errors of the predictions made from `begin` to `end` (s) before their touchdowns."""

    begin: float
    end: float
    errors: Errors


def row_of(body: str, score: Score, cost: float | None = None) -> TouchdownRow:
    """The row of a score; `cost` in s."""
    touchdown = score.touchdown
    history = score.history if score.landing is None else score.landing.history
    return TouchdownRow(
        body,
        score.stamp,
        history[0][0] if history else touchdown.lead_time,
        touchdown.lead_time,
        touchdown.mode,
        touchdown.before,
        touchdown.after,
        score.measured,
        touchdown.half_distance,
        score.relative_error,
        touchdown.off_axis,
        score.scored,
        tuple(flag.name or "" for flags in (score.leftover, touchdown.flags) for flag in type(flags) if flag & flags),
        cost,
    )


def row_of_message(body: str, values: Mapping[str, str], cost: float | None = None) -> TouchdownRow:
    """The row of the values of a message on `~/score`, as `decode_diagnostic_array` reads them; `cost` in s."""

    def twist(name: str) -> Twist:
        return Twist(*(float(values[f"{name}.{part}"]) for part in Twist._fields))

    return TouchdownRow(
        body,
        int(values["stamp"]),
        float(values["announced"]),
        float(values["lead_time"]),
        Mode[values["mode"]],
        twist("before"),
        twist("predicted"),
        twist("measured") if "measured.vx" in values else None,
        float(values["half_distance"]),
        float(values["relative_error"]) if "relative_error" in values else None,
        float(values["off_axis"]),
        values["scored"] == "true",
        tuple(flag for key in ("leftover", "flags") for flag in values[key].split("|") if flag != "NONE"),
        cost,
    )


def errors_of(rows: Iterable[TouchdownRow]) -> Errors:
    """How wrong the scored rows were."""
    return summarize([row.relative_error for row in rows if row.scored and row.relative_error is not None])


def error_by_lead_time(scores: Iterable[Score]) -> tuple[LeadTimeErrors, ...]:
    """How wrong every prediction of the scored touchdowns was, by how long before the touchdown it was made."""
    return errors_ahead(prediction for score in scores if score.scored for prediction in score.history)


def errors_ahead(predictions: Iterable[tuple[float, float]]) -> tuple[LeadTimeErrors, ...]:
    """How wrong predictions were, from the (lead time in s, relative error) of each."""
    made = list(predictions)
    return tuple(
        LeadTimeErrors(begin, end, summarize([error for lead_time, error in made if begin <= lead_time < end]))
        for begin, end in pairwise(LEAD_TIME_EDGES)
    )


def reasons(rows: Iterable[TouchdownRow]) -> dict[str, int]:
    """How many rows are not scored for each reason, the commonest first; a row may have several."""
    counts = Counter(flag for row in rows if not row.scored for flag in row.flags if flag in Leftover.__members__)
    return dict(counts.most_common())


def summarize(errors: Sequence[float]) -> Errors:
    """Median and 90 % of relative errors."""
    return Errors(len(errors), median(errors), quantile(errors, 0.9)) if errors else Errors(0, None, None)


def quantile(values: Sequence[float], part: float) -> float:
    """What a part of the values stays below, interpolated linearly between them; at least one value."""
    ordered = sorted(values)
    place = part * (len(ordered) - 1)
    below = int(place)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (place - below) * (ordered[above] - ordered[below])


def without_bag(said: str, bag: str) -> str:
    """A sentence that names its bag, as it can be said of several."""
    return said.replace(f"in {bag}, ", "").replace(bag, "it")


def as_json(result: Result) -> dict[str, Any]:
    """A replay as JSON: SI units, twists as [vx, vy, omega], stamps in ns, relative errors as fractions of 1."""
    rows = [row_of(*settled) for settled in result.settled]
    errors = errors_of(rows)
    answer = {
        "bag": result.bag,
        "samples": result.samples,
        "us_per_sample": result.seconds / result.samples * 1e6 if result.samples else None,
        "touchdowns": [
            _row_as_json(row)
            | {"old": settled.score.touchdown.old, "new": settled.score.touchdown.new}
            | _landing_as_json(settled.score)
            for row, settled in zip(rows, result.settled, strict=True)
        ],
        "scored": errors.number,
        "median_relative_error": errors.median,
        "p90_relative_error": errors.p90,
        "error_by_lead_time": [
            {
                "from": one.begin,
                "to": one.end,
                "count": one.errors.number,
                "median": one.errors.median,
                "p90": one.errors.p90,
            }
            for one in error_by_lead_time(settled.score for settled in result.settled)
        ],
        "statuses": _counts_as_json(result.statuses),
        "geometry_statuses": _counts_as_json(result.geometry_statuses),
    }
    if set(result.inputs) - {"odom", "contact_geometry"}:
        answer["inputs"] = {name: _counts_as_json(counts) for name, counts in result.inputs.items()}
    if result.truth is not None:
        answer["truth"] = _truth_as_json(result.truth, result.truths)
    if result.damaged:
        answer["damaged"] = result.damaged
    from .details import details_of

    answer |= details_of(result)
    return answer


def _landing_as_json(score: Score) -> dict[str, Any]:
    if score.landing is None:
        return {}
    from .landings import landing_as_json  # only where feet have landed

    return landing_as_json(score.landing)


def _truth_as_json(truth: Truth, bodies: Mapping[str, BodyTruth]) -> dict[str, Any]:
    """The comparison with the truth, of all bodies and of each; stamps in ns."""
    answer: dict[str, Any] = truth._asdict()
    warned = [one.warned for one in bodies.values() if one.warned is not None]
    if warned:
        happened = [one.before_first_impact for one in warned if one.before_first_impact is not None]
        answer |= {
            "bodies_with_slide_or_impact": len(happened),
            "warned_before_first_impact": sum(happened),
            "events": sum(one.events for one in warned),
            "events_warned": sum(one.events_warned for one in warned),
        }
    if bodies:
        answer["bodies"] = {body: _body_as_json(*one) for body, one in bodies.items()}
    return answer


def _body_as_json(truth: Truth | None, warned: Warned | None) -> dict[str, Any]:
    answer = {} if truth is None else truth._asdict()
    if warned is not None:
        answer |= {**warned._asdict(), "warned_before_first_impact": warned.before_first_impact}
    return answer


def _row_as_json(row: TouchdownRow) -> dict[str, Any]:
    return {
        "body": row.body,
        "stamp": row.stamp,
        "announced_lead_time": row.announced,
        "lead_time": row.lead_time,
        "mode": row.mode.name,
        "predicted_twist": row.predicted,
        "measured_twist": row.measured,
        "before_twist": row.before,
        "half_distance": row.half_distance,
        "relative_error": row.relative_error,
        "out_of_plane": row.out_of_plane,
        "scored": row.scored,
        "flags": row.flags,
    }


def _counts_as_json(counts: Mapping[Status, int]) -> dict[str, int]:
    return {status.name: count for status, count in counts.items()}
