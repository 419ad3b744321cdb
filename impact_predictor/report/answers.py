"""What a replay answers to programs: the JSON of a bag.

SI units, stamps in ns, relative errors as fractions of 1; docs/replay.md has the keys.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from ..prediction.types import Status
from ..stamps import NANOSECONDS
from .skill import skill_as_json
from .summary import SpanErrors, errors_ahead, errors_of, spread_of, to_json, velocity_errors_ahead
from .touchdowns import row_as_json, rows_of
from .watch import watch_as_json

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..scenarios.matching import Match, Truth

_SHORT: Final = {"from": "from", "to": "to", "count": "count", "median": "p50", "p90": "p90"}
"""What the JSON has of a spread under `error_by_lead_time`."""


def as_json(result: Result) -> dict[str, Any]:
    """Everything that a replay found; what a bag does not have, its JSON has not."""
    rows = rows_of(result.settled)
    errors, times = errors_of(rows), times_ahead(result)
    ahead = [_span(one) for one in velocity_errors_ahead(result.settled)]
    begin, end = result.extent or (None, None)
    known = {
        "inputs": {name: _counts(counts) for name, counts in result.inputs.items()},
        "damaged": result.damaged,
        "truth": {} if result.truth is None else _truth(result, result.truth),
        "time_errors_ahead": [_span(one) for one in errors_ahead(times)] if times else None,
        "true_touchdowns": [_match(match) for match in result.matches],
        "gaits": {
            body: {key: getattr(gait, key) for key in ("feet", "stances", "true_stances")}
            for body, gait in result.gaits.items()
        },
        "watch": {} if result.watch is None else watch_as_json(result.watch),
        "notes": list(result.notes),
        "unpredictable": result.unpredictable,
    }
    if not set(result.inputs) - {"odom", "contact_geometry"}:
        del known["inputs"]
    return {
        "bag": result.bag,
        "samples": result.samples,
        "us_per_sample": result.seconds / result.samples * 1e6 if result.samples else None,
        "touchdowns": [row_as_json(row) for row in rows],
        "scored": errors.number,
        "median_relative_error": errors.p50,
        "p90_relative_error": errors.p90,
        "error_by_lead_time": [{key: one[name] for key, name in _SHORT.items()} for one in ahead],
        "relative_errors_ahead": ahead,
        "statuses": _counts(result.statuses),
        "geometry_statuses": _counts(result.geometry_statuses),
        "begin": begin,
        "end": end,
        "cost_us": to_json(spread_of([1e6 * cost for cost in result.costs])),
        **skill_as_json(rows, result.recorded),
        **{key: value for key, value in known.items() if value},
    }


def _counts(counts: Mapping[Status, int]) -> dict[str, int]:
    return {status.name: count for status, count in counts.items()}


def _span(span: SpanErrors) -> dict[str, Any]:
    return {"from": span.begin, "to": span.end} | to_json(span.errors)


def times_ahead(result: Result) -> list[tuple[float, float]]:
    """Lead time and error in s of the time of each prediction, where the record has when touchdowns were.

    That is by the truth where the bag has it, else of feet by when their motion ends.
    """
    if result.matches:
        return [
            ((match.stamp - one.seen) / NANOSECONDS, (one.stamp - match.stamp) / NANOSECONDS)
            for match in result.matches
            if match.stamp is not None and match.shown
            for one in match.predictions
        ]
    landings = [settled.score.landing for settled in result.settled]
    return [one for landing in landings if landing is not None for one in landing.history]


def _truth(result: Result, truth: Truth) -> dict[str, Any]:
    """The comparison with the truth, of all bodies and of each."""
    bodies: dict[str, dict[str, Any]] = {}
    for body, one in result.truths.items():
        bodies[body] = {} if one.truth is None else one.truth._asdict()
        if one.warned is not None:
            bodies[body] |= one.warned._asdict() | {"warned_before_first_impact": one.warned.before_first_impact}
    answer, warned = truth._asdict(), [one.warned for one in result.truths.values() if one.warned is not None]
    if warned:
        answers = [one.before_first_impact for one in warned if one.before_first_impact is not None]
        answer |= {"bodies_with_slide_or_impact": len(answers), "warned_before_first_impact": sum(answers)}
        answer |= {key: sum(getattr(one, key) for one in warned) for key in ("events", "events_warned")}
    return answer | ({"bodies": bodies} if bodies else {})


def _match(match: Match) -> dict[str, Any]:
    """A true touchdown with its first and its last prediction, or a false alarm."""
    first, last = (match.predictions[0], match.predictions[-1]) if match.predictions else (None, None)
    return {
        "body": match.body,
        **({"foot": match.foot} if match.foot else {}),
        "stamp": match.stamp,
        "mode": None if match.mode is None else match.mode.name,
        "first_seen": None if first is None else first.seen,
        "predicted_stamp": None if last is None else last.stamp,
        "predicted_mode": None if last is None or last.touchdown is None else last.touchdown.mode.name,
        "velocity_error": match.velocity_error,
        "shown": match.shown,
    }
