"""What the JSON of a replay says in detail, for its page: costs, errors ahead of touchdowns, the truth, and gaits."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ..stamps import NANOSECONDS
from .spread import spread_of, to_json
from .summary import LEAD_TIME_EDGES

if TYPE_CHECKING:
    from ..bags.gait import Gait
    from ..bags.replay import Result
    from ..scenarios.matching import Match


def details_of(result: Result) -> dict[str, Any]:
    """The keys of the JSON of a replay that its page alone needs, as docs/replay.md tells them."""
    begin, end = result.extent or (None, None)
    made = [one for settled in result.settled if settled.score.scored for one in settled.score.history]
    answer: dict[str, Any] = {
        "begin": begin,
        "end": end,
        "cost_us": to_json(spread_of([1e6 * cost for cost in result.costs])),
        "relative_errors_ahead": ahead(made),
    }
    if times := times_ahead(result):
        answer["time_errors_ahead"] = ahead(times)
    if result.matches:
        answer["true_touchdowns"] = [match_as_json(match) for match in result.matches]
    if result.gaits:
        answer["gaits"] = {body: gait_as_json(gait) for body, gait in result.gaits.items()}
    if result.notes:
        answer["notes"] = list(result.notes)
    if result.unpredictable:
        answer["unpredictable"] = result.unpredictable
    return answer


def ahead(made: Iterable[tuple[float, float]]) -> list[dict[str, Any]]:
    """The spreads of errors between the usual borders of lead time, from the (lead time in s, error) of predictions."""
    known = list(made)
    return [
        {"from": begin, "to": end} | to_json(spread_of([abs(error) for time, error in known if begin <= time < end]))
        for begin, end in pairwise(LEAD_TIME_EDGES)
    ]


def times_ahead(result: Result) -> list[tuple[float, float]]:
    """Lead time and error in s of the time that each prediction told, where the record tells when touchdowns were.

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


def match_as_json(match: Match) -> dict[str, Any]:
    """A true touchdown with its first and its last prediction, or a false alarm; stamps in ns."""
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


def gait_as_json(gait: Gait) -> dict[str, Any]:
    """When each foot stands, as inferred and as the record tells: [foot, begin, end], stamps in ns."""
    return {
        "feet": list(gait.feet),
        "stances": [list(one) for one in gait.stances],
        "true_stances": [list(one) for one in gait.true_stances],
    }
