"""What is otherwise than in an earlier run of the same bag: touchdowns that are new, gone, elsewhere, better or worse.

Touchdowns of two runs are the same one if body, foot and contacts are, and their times are within `NEAREST` of each
other; the nearest first. What is left is the same with other contacts if body, foot and time agree.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Mapping, Sequence
from enum import Enum
from math import hypot
from typing import TYPE_CHECKING, Any, NamedTuple

from ..mechanics.types import Twist
from ..scenarios.matching import NEAREST
from ..stamps import NANOSECONDS
from .table import first_stamp

if TYPE_CHECKING:
    from ..bags.replay import Result

Contacts = tuple[tuple[int, ...], tuple[int, ...]]
Value = float | int | str | tuple[float, ...] | None


class Happened(NamedTuple):
    """A touchdown of a run, as its score tells it; SI units, `stamp` in ns, twists in the impact plane.

    `foot` is "" where it is no landing; `contacts` are the points that stood and that struck, None where the run does
    not tell them; `error` relative, of what is scored; `time_error` of a landing.
    """

    body: str
    foot: str
    stamp: int
    contacts: Contacts | None
    mode: str
    before: Twist
    predicted: Twist
    half_distance: float
    scored: bool
    error: float | None
    time_error: float | None


class Limits(NamedTuple):
    """What counts as a change: times that differ by more than `time` in s, relative errors by more than `error`."""

    time: float = 1e-3
    error: float = 0.01


class Kind(Enum):
    """What has changed; the values are those of the JSON."""

    APPEARED = "appeared"
    VANISHED = "vanished"
    CONTACTS = "contacts"
    MODE = "mode"
    MOVED = "moved"
    SCORED = "scored"
    BETTER = "better"
    WORSE = "worse"
    VELOCITIES = "velocities"
    """Others are predicted, and no error says whether that is better."""


class Change(NamedTuple):
    """A change of a touchdown at a `stamp` in ns: what `was`, and what `now` is; None where there is none.

    Modes and contacts are texts, times of what moved in ns, errors relative or, of landings, in s, velocities a planar
    twist.
    """

    stamp: int
    body: str
    foot: str
    kind: Kind
    was: Value
    now: Value


class Comparison(NamedTuple):
    """Two runs: the changes in the order of their times, and how many touchdowns there `were` and `are`.

    `alike` are in both runs without a change; times are shown from the stamp `start` in ns on.
    """

    changes: tuple[Change, ...]
    were: int
    are: int
    alike: int
    start: int = 0


def run_of(result: Result) -> tuple[Happened, ...]:
    """The touchdowns of a replay."""
    from .summary import as_json

    return tuple(map(happened, as_json(result)["touchdowns"]))


def happened(fields: Mapping[str, Any]) -> Happened:
    """The touchdown of an object in the JSON of a replay."""
    return Happened(
        fields["body"],
        fields.get("foot", ""),
        int(fields["stamp"]),
        (tuple(fields["old"]), tuple(fields["new"])) if "old" in fields else None,
        fields["mode"],
        Twist(*fields["before_twist"]),
        Twist(*fields["predicted_twist"]),
        fields["half_distance"],
        fields["scored"],
        fields["relative_error"] if fields["scored"] else None,
        fields.get("time_error"),
    )


def compare_runs(was: Sequence[Happened], now: Sequence[Happened], limits: Limits | None = None) -> Comparison:
    """What has changed from one run of a bag to another."""
    limits = limits or Limits()
    changes: list[Change] = []
    alike = 0
    pairs = _paired(was, now)
    for i, k in pairs:
        found = _changes(was[i], now[k], limits)
        changes += found
        alike += not found
    gone = [was[i] for i in sorted(set(range(len(was))) - {i for i, _ in pairs})]
    new = [now[k] for k in sorted(set(range(len(now))) - {k for _, k in pairs})]
    changes += [Change(one.stamp, one.body, one.foot, Kind.VANISHED, one.mode, None) for one in gone]
    changes += [Change(one.stamp, one.body, one.foot, Kind.APPEARED, None, one.mode) for one in new]
    order = list(Kind)
    changes.sort(key=lambda change: (change.stamp, change.body, change.foot, order.index(change.kind)))
    start = first_stamp(sorted(one.stamp for one in now or was))
    return Comparison(tuple(changes), len(was), len(now), alike, start)


def _paired(was: Sequence[Happened], now: Sequence[Happened]) -> list[tuple[int, int]]:
    """The places of touchdowns that are the same in both runs."""
    places: dict[tuple[str, str], list[tuple[int, int]]] = defaultdict(list)
    for k, one in enumerate(now):
        places[one.body, one.foot].append((one.stamp, k))
    for found in places.values():
        found.sort()
    near: list[tuple[bool, int, int, int, int]] = []
    for i, one in enumerate(was):
        others = places[one.body, one.foot]
        for stamp, k in others[bisect_left(others, (one.stamp - NEAREST, -1)) :]:
            if stamp > one.stamp + NEAREST:
                break
            # Where a bag was played in a loop, one stamp comes again and again, in the same order in both runs.
            near.append((_differ(one.contacts, now[k].contacts), abs(stamp - one.stamp), abs(i - k), i, k))
    pairs, taken, met = [], set[int](), set[int]()
    for _, _, _, i, k in sorted(near):
        if i not in taken and k not in met:
            taken.add(i)
            met.add(k)
            pairs.append((i, k))
    return pairs


def _differ(one: Contacts | None, other: Contacts | None) -> bool:
    return one is not None and other is not None and one != other


def _changes(was: Happened, now: Happened, limits: Limits) -> list[Change]:
    """What has changed of one touchdown."""
    found: list[tuple[Kind, Value, Value]] = []
    if _differ(was.contacts, now.contacts):
        found.append((Kind.CONTACTS, _points(was.contacts), _points(now.contacts)))
    if was.mode != now.mode:
        found.append((Kind.MODE, was.mode, now.mode))
    if abs(now.stamp - was.stamp) > limits.time * NANOSECONDS:
        found.append((Kind.MOVED, was.stamp, now.stamp))
    if was.scored != now.scored:
        found.append((Kind.SCORED, _is_scored(was), _is_scored(now)))
    judged = _judged(was.error, now.error, limits.error) + _judged(was.time_error, now.time_error, limits.time)
    if not judged and was.mode == now.mode and _turned(was, now, limits.error):
        judged = [(Kind.VELOCITIES, tuple(was.predicted), tuple(now.predicted))]
    return [Change(now.stamp, now.body, now.foot, *one) for one in found + judged]


def _judged(was: float | None, now: float | None, limit: float) -> list[tuple[Kind, Value, Value]]:
    """Whether an error has become greater or smaller by more than a limit."""
    if was is None or now is None or abs(abs(now) - abs(was)) <= limit:
        return []
    return [(Kind.WORSE if abs(now) > abs(was) else Kind.BETTER, was, now)]


def _turned(was: Happened, now: Happened, limit: float) -> bool:
    """Whether the velocities after a touchdown differ by more than a part of those before, as relative errors do."""
    arm = was.half_distance
    vx, vy, omega = (there - here for there, here in zip(now.predicted, was.predicted, strict=True))
    return hypot(vx, vy, omega * arm) > limit * hypot(was.before.vx, was.before.vy, was.before.omega * arm)


def _is_scored(one: Happened) -> str:
    return "scored" if one.scored else "not scored"


def _points(contacts: Contacts | None) -> str:
    old, new = contacts or ((), ())
    return f"{' '.join(map(str, old)) or 'none'} then {' '.join(map(str, new)) or 'none'}"
