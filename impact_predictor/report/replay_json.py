"""A replay as JSON: SI units, stamps in ns, relative errors as fractions of 1; docs/replay.md has the keys."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from ..prediction.types import Landing, Status
from ..stamps import NANOSECONDS
from .summary import error_by_lead_time, errors_ahead, errors_of, row_of, spread_of, to_json

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..bags.run import Settled
    from ..scenarios.matching import Match


def as_json(result: Result) -> dict[str, Any]:
    """Everything that a replay found; what a bag does not have, its JSON has not."""
    scores = [settled.score for settled in result.settled]
    errors = errors_of(row_of(*settled) for settled in result.settled)
    begin, end = result.extent or (None, None)
    known = {
        "inputs": {name: _counts(counts) for name, counts in result.inputs.items()},
        "damaged": result.damaged,
        "time_errors_ahead": _spans(times_ahead(result)) if times_ahead(result) else None,
        "true_touchdowns": [_match(match) for match in result.matches],
        "gaits": {
            body: {
                "feet": list(gait.feet),
                "stances": [list(one) for one in gait.stances],
                "true_stances": [list(one) for one in gait.true_stances],
            }
            for body, gait in result.gaits.items()
        },
        "notes": list(result.notes),
        "unpredictable": result.unpredictable,
    }
    if not set(result.inputs) - {"odom", "contact_geometry"}:
        del known["inputs"]
    return {
        "bag": result.bag,
        "samples": result.samples,
        "us_per_sample": result.seconds / result.samples * 1e6 if result.samples else None,
        "touchdowns": [_touchdown(settled) for settled in result.settled],
        "scored": errors.number,
        "median_relative_error": errors.p50,
        "p90_relative_error": errors.p90,
        "error_by_lead_time": [
            {"from": a, "to": b, "count": one.number, "median": one.p50, "p90": one.p90}
            for a, b, one in error_by_lead_time(scores)
        ],
        "statuses": _counts(result.statuses),
        "geometry_statuses": _counts(result.geometry_statuses),
        **({} if result.truth is None else {"truth": _truth(result)}),
        "begin": begin,
        "end": end,
        "cost_us": to_json(spread_of([1e6 * cost for cost in result.costs])),
        "relative_errors_ahead": _spans([one for score in scores if score.scored for one in score.history]),
        **{key: value for key, value in known.items() if value},
    }


def _touchdown(settled: Settled) -> dict[str, Any]:
    row, score = row_of(*settled), settled.score
    fields = {
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
        "old": score.touchdown.old,
        "new": score.touchdown.new,
    }
    return fields if score.landing is None else fields | landing_as_json(score.landing)


def landing_as_json(landing: Landing) -> dict[str, Any]:
    """What the JSON of a touchdown says of the landing of a foot."""
    from .landings import change_by  # only where feet have landed

    impact = landing.impact
    return {
        "foot": landing.foot,
        "point": landing.point,
        "late": landing.late,
        "confirmed": landing.confirmed,
        "time_error": landing.history[-1][1] if landing.history else None,
        "landing_speed": landing.speed,
        "landing_mode": None if impact is None else impact.mode.name,
        "impulse": None if impact is None else impact.impulses[1],
        "others_impulse": None if impact is None or not impact.old else impact.impulses[0],
        "velocity_change": None if impact is None else change_by(impact),
    }


def _truth(result: Result) -> dict[str, Any]:
    """The comparison with the truth, of all bodies and of each."""
    assert result.truth is not None
    answer: dict[str, Any] = result.truth._asdict()
    warned = [one.warned for one in result.truths.values() if one.warned is not None]
    if warned:
        happened = [one.before_first_impact for one in warned if one.before_first_impact is not None]
        answer |= {
            "bodies_with_slide_or_impact": len(happened),
            "warned_before_first_impact": sum(happened),
            "events": sum(one.events for one in warned),
            "events_warned": sum(one.events_warned for one in warned),
        }
    bodies: dict[str, dict[str, Any]] = {}
    for body, one in result.truths.items():
        bodies[body] = {} if one.truth is None else one.truth._asdict()
        if one.warned is not None:
            bodies[body] |= {**one.warned._asdict(), "warned_before_first_impact": one.warned.before_first_impact}
    return answer | ({"bodies": bodies} if bodies else {})


def _counts(counts: Mapping[Status, int]) -> dict[str, int]:
    return {status.name: count for status, count in counts.items()}


def _spans(made: Iterable[tuple[float, float]]) -> list[dict[str, Any]]:
    """The spreads of errors between borders of lead time, from the (lead time in s, error) of predictions."""
    return [{"from": begin, "to": end} | to_json(errors) for begin, end, errors in errors_ahead(made)]


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
