"""What has changed since an earlier run of the same bag: touchdowns that are new, gone, elsewhere, better or worse.

An earlier run is what `replay` printed as JSON. Touchdowns of two runs are the same one if body, foot and contacts
are, and their times are within `NEAREST` of each other; the nearest first. What is left is the same with other contacts
if body, foot and time agree.
"""

from __future__ import annotations

import json
import os
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Iterator, Sequence
from enum import Enum
from functools import partial
from math import hypot
from operator import sub
from pathlib import Path
from typing import Any, Final, NamedTuple

from ..bags.find import name_of, names_of
from ..errors import InputError
from ..scenarios.matching import NEAREST
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, percent
from .table import first_stamp
from .touchdowns import TouchdownRow, row_of_json

TIME: Final = 1e-3
"""s by which times differ that have changed."""
ERROR: Final = 0.01
"""Part of 1 by which errors and velocities differ that have changed."""


class Earlier:
    """An earlier run of one bag or of several, as `replay` printed it with --json."""

    def __init__(self, path: str | os.PathLike[str], bags: int = 1) -> None:
        """Read it, to compare so many bags with it; InputError where it cannot be read, or is the run of one bag."""
        self.path = Path(path)
        try:
            answer = json.loads(self.path.read_bytes())
            # By the path of each bag, or by "" that of the only one.
            runs = answer if isinstance(answer, list) else [answer | {"bag": ""}]
            self._runs = {run["bag"]: [*map(row_of_json, run["touchdowns"])] for run in runs if "error" not in run}
        except (AttributeError, KeyError, OSError, TypeError, ValueError) as error:
            raise InputError(
                f"the baseline {path} cannot be read as the JSON of a replay; give what `impact-predictor replay` "
                "printed with --json"
            ) from error
        if bags > 1 and "" in self._runs:
            raise InputError(
                f"the baseline {path} is the run of one bag, but {bags:,} bags are given; give what a run of several "
                "printed with --json"
            )

    def touchdowns_of(self, bag: str | os.PathLike[str], name: str | os.PathLike[str] = "") -> Sequence[TouchdownRow]:
        """The touchdowns of a bag: of the run of the same path, or of the same `name` (`names_of`) among the runs;
        InputError where it has none of this bag.
        """
        if "" in self._runs:
            return self._runs[""]
        named = dict(zip(map(str, names_of([*self._runs])), self._runs.values(), strict=True))
        found = self._runs.get(os.fspath(bag), named.get(os.fspath(name or name_of(bag))))
        if found is None:
            raise InputError(f"the baseline {self.path} has no run of {bag}; replay that bag with --json again")
        return found


class ChangeKind(Enum):
    """What has changed, in words."""

    APPEARED = "appeared"
    VANISHED = "vanished"
    CONTACTS = "other contacts"
    MODE = "other mode"
    MOVED = "moved"
    SCORED = "scored or not"
    BETTER = "better"
    WORSE = "worse"
    # No error says whether that is better.
    VELOCITIES = "other vx, vy, omega"


class TouchdownChange(NamedTuple):
    """A change of a touchdown: what `was`, and what `now` is; None where there is none.

    Modes and contacts are texts, times of what moved in ns, errors relative or, of landings, in s, velocities a planar
    twist. `row` is the touchdown now, or that which vanished.
    """

    row: TouchdownRow
    kind: ChangeKind
    was: Any = None
    now: Any = None


class RunComparison(NamedTuple):
    """Two runs: the changes in the order of their times, and how many touchdowns there `were` and `are`.

    `alike` are in both runs without a change; times are shown from the stamp `start` in ns on.
    """

    changes: tuple[TouchdownChange, ...]
    were: int
    are: int
    alike: int
    start: int = 0


def compare_runs(was: Sequence[TouchdownRow], now: Sequence[TouchdownRow]) -> RunComparison:
    """What has changed from one run of a bag to another."""
    was, now = (sorted(rows, key=lambda row: row.stamp) for rows in (was, now))
    pairs = _paired(was, now)
    found = [[*_changes(was[i], now[k])] for i, k in pairs.items()]
    changes = [change for one in found for change in one]
    gone, new = {*range(len(was))} - pairs.keys(), {*range(len(now))} - {*pairs.values()}
    changes += [TouchdownChange(was[i], ChangeKind.VANISHED, was=was[i].mode.name) for i in gone]
    changes += [TouchdownChange(now[k], ChangeKind.APPEARED, now=now[k].mode.name) for k in new]
    return RunComparison(
        changes=tuple(sorted(changes, key=lambda one: (one.row.stamp, one.row.body, one.row.foot))),
        were=len(was),
        are=len(now),
        alike=sum(not one for one in found),
        start=first_stamp(one.stamp for one in now or was),
    )


def _paired(was: Sequence[TouchdownRow], now: Sequence[TouchdownRow]) -> dict[int, int]:
    """The places of touchdowns that are the same in both runs, of runs in the order of their stamps."""
    stamps = [one.stamp for one in now]
    near = [
        (_points(one) != _points(now[k]), abs(now[k].stamp - one.stamp), i, k)
        for i, one in enumerate(was)
        for k in range(bisect_left(stamps, one.stamp - NEAREST), bisect_right(stamps, one.stamp + NEAREST))
        if (now[k].body, now[k].foot) == (one.body, one.foot)
    ]
    pairs, met = dict[int, int](), set[int]()
    # Where a bag was played in a loop, one stamp comes again and again, in the same order in both runs.
    for *_, i, k in sorted(near):
        if i not in pairs and k not in met:
            pairs[i] = k
            met.add(k)
    return pairs


def _changes(was: TouchdownRow, now: TouchdownRow) -> Iterator[TouchdownChange]:
    changed = partial(TouchdownChange, now)
    if _points(was) != _points(now):
        yield changed(ChangeKind.CONTACTS, _points(was), _points(now))
    if was.mode != now.mode:
        yield changed(ChangeKind.MODE, was.mode.name, now.mode.name)
    if abs(now.stamp - was.stamp) > TIME * NANOSECONDS:
        yield changed(ChangeKind.MOVED, was.stamp, now.stamp)
    if was.scored != now.scored:
        yield changed(ChangeKind.SCORED, *("scored" if one.scored else "not scored" for one in (was, now)))
    # Of a landing the error is that of its time.
    old, new = (one.time_error if one.foot else one.error for one in (was, now))
    if old is not None and new is not None and abs(abs(new) - abs(old)) > (TIME if now.foot else ERROR):
        yield changed(ChangeKind.WORSE if abs(new) > abs(old) else ChangeKind.BETTER, old, new)
    elif was.mode == now.mode and _turned(was, now):
        yield changed(ChangeKind.VELOCITIES, tuple(was.predicted_twist), tuple(now.predicted_twist))


def _turned(was: TouchdownRow, now: TouchdownRow) -> bool:
    """Whether the velocities after a touchdown differ by more than a part of those before, as relative errors do."""
    arm, before = was.half_distance, was.before_twist
    vx, vy, omega = map(sub, now.predicted_twist, was.predicted_twist)
    return hypot(vx, vy, omega * arm) > ERROR * hypot(before.vx, before.vy, before.omega * arm)


def _points(one: TouchdownRow) -> str:
    return " then ".join(" ".join(map(str, points)) or "none" for points in (one.old, one.new))


def concluded(compared: RunComparison, baseline: str | os.PathLike[str]) -> str:
    """What a comparison says in one sentence."""
    if not compared.changes:
        return f"Nothing has changed against {os.fspath(baseline)}: {counted(compared.are, 'touchdown')}."
    counts = Counter(change.kind.value for change in compared.changes)
    said = ", ".join(f"{count:,} {label}" for label, count in counts.most_common())
    were = counted(compared.were, "touchdown")
    return f"Against {os.fspath(baseline)} {compared.alike:,} of {were} are as they were: {said}."


def sentences(compared: RunComparison) -> list[str]:
    """The changes, one line each, in SI units but for the errors of landings, which are in ms."""
    return [
        f"{(row.stamp - compared.start) / NANOSECONDS:.3f} s {f'{row.body} {row.foot}'.rstrip()}: {kind.value}, "
        f"was {_text(kind, row, was, compared.start)}, now {_text(kind, row, now, compared.start)}"
        for row, kind, was, now in compared.changes
    ]


def _text(kind: ChangeKind, row: TouchdownRow, value: Any, start: int) -> str:
    if value is None:
        return NONE
    if kind is ChangeKind.MOVED:
        return f"{(value - start) / NANOSECONDS:.4f}"
    if kind is ChangeKind.VELOCITIES:
        return "{:.3f} {:.3f} {:.2f}".format(*value)
    if kind in (ChangeKind.BETTER, ChangeKind.WORSE):
        return f"{value * 1e3:+.1f} ms" if row.foot else f"{percent(value)} %"
    return str(value)
