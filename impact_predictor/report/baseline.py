"""What has changed since an earlier run of the same bag: touchdowns that are new, gone, elsewhere, better or worse.

Touchdowns of two runs are the same one if body, foot and contacts are, and their times are within `NEAREST` of each
other; the nearest first. What is left is the same with other contacts if body, foot and time agree.
"""

from __future__ import annotations

import os
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Sequence
from enum import Enum
from math import hypot
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rich.console import Console

from ..scenarios.matching import NEAREST
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, percent
from .summary import TouchdownRow, row_of
from .table import Column, first_stamp, say, show, table_of

if TYPE_CHECKING:
    from ..bags.replay import Result

MOST_ROWS: Final = 20
"""Changes that are listed unless all are asked for."""


class ChangeLimits(NamedTuple):
    """What counts as a change: times that differ by more than `time` in s, relative errors by more than `error`."""

    time: float = 1e-3
    error: float = 0.01


class ChangeKind(Enum):
    """What has changed: its name in the JSON, and in the table."""

    APPEARED = "appeared", "appeared"
    VANISHED = "vanished", "vanished"
    CONTACTS = "contacts", "other contacts"
    MODE = "mode", "other mode"
    MOVED = "moved", "moved"
    SCORED = "scored", "scored or not"
    BETTER = "better", "better"
    WORSE = "worse", "worse"
    # No error says whether that is better.
    VELOCITIES = "velocities", "other vx, vy, omega"

    def __init__(self, key: str, label: str) -> None:
        """Take both names."""
        self.key, self.label = key, label


class TouchdownChange(NamedTuple):
    """A change of a touchdown at a `stamp` in ns: what `was`, and what `now` is; None where there is none.

    Modes and contacts are texts, times of what moved in ns, errors relative or, of landings, in s, velocities a planar
    twist.
    """

    stamp: int
    body: str
    foot: str
    kind: ChangeKind
    was: Any
    now: Any

    @property
    def who(self) -> str:
        """The body, and its foot where it is a landing."""
        return f"{self.body} {self.foot}".rstrip()


class RunComparison(NamedTuple):
    """Two runs: the changes in the order of their times, and how many touchdowns there `were` and `are`.

    `alike` are in both runs without a change; times are shown from the stamp `start` in ns on.
    """

    changes: tuple[TouchdownChange, ...]
    were: int
    are: int
    alike: int
    start: int = 0


def run_of(result: Result) -> tuple[TouchdownRow, ...]:
    """The touchdowns of a replay."""
    return tuple(row_of(*settled) for settled in result.settled)


def compare_runs(
    was: Sequence[TouchdownRow], now: Sequence[TouchdownRow], limits: ChangeLimits | None = None
) -> RunComparison:
    """What has changed from one run of a bag to another."""
    pairs = _paired(was, now)
    found = [_changes(was[i], now[k], limits or ChangeLimits()) for i, k in pairs]
    gone, new = ({*range(len(run))} - {pair[k] for pair in pairs} for k, run in enumerate((was, now)))
    changes = [change for one in found for change in one]
    changes += [_change(was[i], ChangeKind.VANISHED, was[i].mode.name, None) for i in gone]
    changes += [_change(now[k], ChangeKind.APPEARED, None, now[k].mode.name) for k in new]
    order = list(ChangeKind)
    changes.sort(key=lambda change: (change.stamp, change.body, change.foot, order.index(change.kind)))
    start = first_stamp(sorted(one.stamp for one in now or was))
    return RunComparison(tuple(changes), len(was), len(now), sum(not one for one in found), start)


def _paired(was: Sequence[TouchdownRow], now: Sequence[TouchdownRow]) -> list[tuple[int, int]]:
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
            near.append((_differ(one, now[k]), abs(stamp - one.stamp), abs(i - k), i, k))
    pairs, taken, met = [], set[int](), set[int]()
    for *_, i, k in sorted(near):
        if i not in taken and k not in met:
            taken.add(i)
            met.add(k)
            pairs.append((i, k))
    return pairs


def _differ(was: TouchdownRow, now: TouchdownRow) -> bool:
    """Whether both have contacts, and others."""
    return was.contacts is not None and now.contacts is not None and was.contacts != now.contacts


def _change(one: TouchdownRow, kind: ChangeKind, was: Any, now: Any) -> TouchdownChange:
    return TouchdownChange(stamp=one.stamp, body=one.body, foot=one.foot, kind=kind, was=was, now=now)


def _changes(was: TouchdownRow, now: TouchdownRow, limits: ChangeLimits) -> list[TouchdownChange]:
    """What has changed of one touchdown."""
    found = []
    if _differ(was, now):
        found.append(_change(now, ChangeKind.CONTACTS, _points(was), _points(now)))
    if was.mode != now.mode:
        found.append(_change(now, ChangeKind.MODE, was.mode.name, now.mode.name))
    if abs(now.stamp - was.stamp) > limits.time * NANOSECONDS:
        found.append(_change(now, ChangeKind.MOVED, was.stamp, now.stamp))
    if was.scored != now.scored:
        found.append(_change(now, ChangeKind.SCORED, *("scored" if one.scored else "not scored" for one in (was, now))))
    judged = False
    for before, after, limit in (
        (was.error, now.error, limits.error),
        (was.time_error, now.time_error, limits.time),
    ):
        if before is not None and after is not None and abs(abs(after) - abs(before)) > limit:
            worse = abs(after) > abs(before)
            found.append(_change(now, ChangeKind.WORSE if worse else ChangeKind.BETTER, before, after))
            judged = True
    if not judged and was.mode == now.mode and _turned(was, now, limits.error):
        found.append(_change(now, ChangeKind.VELOCITIES, tuple(was.predicted), tuple(now.predicted)))
    return found


def _turned(was: TouchdownRow, now: TouchdownRow, limit: float) -> bool:
    """Whether the velocities after a touchdown differ by more than a part of those before, as relative errors do."""
    arm = was.half_distance
    vx, vy, omega = (there - here for there, here in zip(now.predicted, was.predicted, strict=True))
    return hypot(vx, vy, omega * arm) > limit * hypot(was.before.vx, was.before.vy, was.before.omega * arm)


def _points(one: TouchdownRow) -> str:
    old, new = one.contacts or ((), ())
    return f"{' '.join(map(str, old)) or 'none'} then {' '.join(map(str, new)) or 'none'}"


def print_changes(
    console: Console, compared: RunComparison, baseline: str | os.PathLike[str], every: bool = False
) -> None:
    """Print what has changed against a baseline (the first changes, or `every` one), or that nothing has."""
    changes, start = compared.changes, compared.start
    if changes:
        columns = [
            Column("since first\ns" if start else "time\ns", lambda change: _seconds(change.stamp, start)),
            Column("body", lambda change: change.who, left=True),
            Column("change", lambda change: change.kind.label, left=True),
            Column("was", lambda change: _values(change, start)[0], fold=8),
            Column("now", lambda change: _values(change, start)[1], fold=8),
        ]
        if len({change.who for change in changes}) == 1:
            del columns[1]
        listed = changes if every else changes[:MOST_ROWS]
        console.print()
        show(console, table_of(columns, listed))
        if more := len(changes) - len(listed):
            say(console, f"{counted(more, 'more change')}: list them with --all, or read them with --json.")
    say(console, concluded(compared, baseline))


def concluded(compared: RunComparison, baseline: str | os.PathLike[str]) -> str:
    """What a comparison says in one sentence."""
    name = os.fspath(baseline)
    if not compared.changes:
        return f"Nothing has changed against {name}: {counted(compared.are, 'touchdown')}."
    counts = Counter(change.kind.label for change in compared.changes)
    said = ", ".join(f"{count:,} {label}" for label, count in counts.most_common())
    return f"Against {name} {compared.alike:,} of {counted(compared.were, 'touchdown')} are as they were: {said}."


def sentences(compared: RunComparison) -> list[str]:
    """The changes, one line each."""
    lines = []
    for change in compared.changes:
        was, now = _values(change, compared.start)
        when = _seconds(change.stamp, compared.start)
        lines.append(f"{when} s {change.who}: {change.kind.label}, was {was}, now {now}")
    return lines


def comparison_as_json(compared: RunComparison, baseline: str | os.PathLike[str]) -> dict[str, Any]:
    """A comparison as JSON, in the units of `TouchdownChange`."""
    return {
        "file": os.fspath(baseline),
        "touchdowns_before": compared.were,
        "touchdowns": compared.are,
        "unchanged": compared.alike,
        "changes": [
            {
                "stamp": change.stamp,
                "body": change.body,
                "foot": change.foot or None,
                "change": change.kind.key,
                "was": change.was,
                "now": change.now,
            }
            for change in compared.changes
        ],
    }


def _seconds(stamp: int, start: int) -> str:
    return f"{(stamp - start) / 1e9:.3f}"


def _values(change: TouchdownChange, start: int) -> tuple[str, str]:
    """What was and what is, as texts."""
    if change.kind is ChangeKind.MOVED:
        moved = (change.now - change.was) / 1e6
        return _seconds(change.was, start), f"{_seconds(change.now, start)} ({moved:+.1f} ms)"
    return _text(change.was, change.foot), _text(change.now, change.foot)


def _text(value: Any, foot: str) -> str:
    """A value of a change as text: a number is the error of a landing in s, or relative; twists are in SI units."""
    if value is None:
        return NONE
    if isinstance(value, tuple):
        vx, vy, omega = value
        return f"{vx:.3f} {vy:.3f} {omega:.2f}"
    if isinstance(value, float):
        return f"{value * 1e3:+.1f} ms" if foot else f"{percent(value)} %"
    return str(value)
