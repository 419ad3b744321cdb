"""What has changed since an earlier run of the same bag: touchdowns that are new, gone, elsewhere, better or worse.

An earlier run is what `replay` wrote into a bag or printed as JSON. Touchdowns of two runs are the same one if body,
foot and contacts are, and their times are within `NEAREST` of each other; the nearest first. What is left is the same
with other contacts if body, foot and time agree.
"""

from __future__ import annotations

import json
import os
from bisect import bisect_left, bisect_right
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import Enum
from functools import partial
from itertools import takewhile
from math import hypot
from operator import sub
from pathlib import Path, PurePath
from typing import Any, Final, NamedTuple

from ..bags.body import NODE
from ..bags.find import METADATA, name_of
from ..bags.read import read_messages, topics
from ..errors import InputError
from ..ros.messages import MalformedMessage
from ..ros.messages.reading import SCORES, decode_scores
from ..scenarios.matching import NEAREST
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, percent
from .table import first_stamp
from .touchdowns import TouchdownRow, row_of_json, row_of_message

TIME: Final = 1e-3
"""s by which times differ that have changed."""
ERROR: Final = 0.01
"""Part of 1 by which errors and velocities differ that have changed."""

_HINT: Final = "give what `impact-predictor replay` wrote with -o, or printed with --json"


class Earlier:
    """An earlier run of one bag or of several.

    That is the bag that it wrote, a recording of the node's topics or its JSON; of several bags the folder of what was
    written, or the JSON with one object for each.
    """

    def __init__(self, path: str | os.PathLike[str], bags: int = 1) -> None:
        """Look at it, to compare so many bags with it; JSON is read at once, bags when they are asked for.

        Raises:
            InputError: it does not exist, cannot be read, or is the run of one bag only.
        """
        self.path = Path(path)
        # By the path of each bag, or by "" that of the only one: its touchdowns, or the file that has them.
        self._runs: Mapping[str, Path | Sequence[TouchdownRow]] = {"": self.path}
        if not self.path.exists():
            raise InputError(f"the baseline {path} does not exist; {_HINT}")
        if self.path.suffix == ".json":
            self._runs = _runs_of_json(self.path)
        elif self.path.is_dir() and not (self.path / METADATA).exists():
            files = self.path.rglob("*.mcap")
            self._runs = {os.fspath(file.relative_to(path).with_suffix("")): file for file in files}
        if bags > 1 and "" in self._runs:
            raise InputError(
                f"the baseline {self.path} is the run of one bag, but {bags:,} bags are given; give what a run of "
                "several wrote: its folder (-o), or its --json"
            )

    def touchdowns_of(self, bag: str | os.PathLike[str], name: str | os.PathLike[str] = "") -> Sequence[TouchdownRow]:
        """The touchdowns of a bag; its `name` (`names_of`) tells it from the others that are replayed with it.

        Raises:
            InputError: it is no run, or none of this bag.
        """
        chosen = "" if "" in self._runs else chosen_run(bag, name or name_of(bag), self._runs)
        if chosen is None:
            raise InputError(f"the baseline {self.path} has no run of {bag}; replay that bag with -o or --json again")
        run = self._runs[chosen]
        return _read_bag(run) if isinstance(run, Path) else run


def chosen_run(bag: str | os.PathLike[str], name: str | os.PathLike[str], runs: Iterable[str]) -> str | None:
    """Which of the runs of several bags, by their paths, is that of a bag with a `name` that tells it from others.

    That is the run with the same path; else the one whose path agrees with the bag's farthest from its end on, and at
    least as far as the name does. None where there is none, or several.
    """
    own, name, agreeing = Path(bag).resolve(), PurePath(name), defaultdict[int, list[str]](list)
    for run in runs:
        if run == os.fspath(bag):
            return run
        path = PurePath(run)
        backwards = zip((name_of(own), *own.parts[-2::-1]), (name_of(path), *path.parts[-2::-1]), strict=False)
        agreed = len([*takewhile(lambda parts: parts[0] == parts[1], backwards)])
        # A name keeps its suffix only where another bag has none but another suffix.
        if agreed >= len(name.parts) and name.name in (name_of(own), path.name):
            agreeing[agreed].append(run)
    best = agreeing[max(agreeing)] if agreeing else []
    return best[0] if len(best) == 1 else None


def _runs_of_json(path: Path) -> dict[str, Sequence[TouchdownRow]]:
    try:
        answer = json.loads(path.read_bytes())
        runs = answer if isinstance(answer, list) else [answer | {"bag": ""}]
        return {run["bag"]: [*map(row_of_json, run["touchdowns"])] for run in runs if "error" not in run}
    except (AttributeError, KeyError, OSError, TypeError, ValueError) as error:
        raise InputError(f"the baseline {path} cannot be read as the JSON of a replay; {_HINT}") from error


def _read_bag(path: Path) -> list[TouchdownRow]:
    recorded = topics(path)
    predictions = [topic for topic in recorded if f"{NODE}/" in topic and topic.endswith("/prediction")]
    if not predictions:
        raise InputError(f"the baseline {path} has no predictions: no topic {NODE}/prediction; {_HINT}")
    scores = [topic.removesuffix("prediction") + "score" for topic in predictions]
    wanted = {topic: recorded[topic] for topic in scores if recorded.get(topic) in SCORES}
    found: list[TouchdownRow] = []
    # A run without any touchdown has no scores.
    for topic, _, data in read_messages(path, wanted) if wanted else ():
        body = topic.rpartition(f"{NODE}/")[2].removesuffix("score").strip("/")
        try:
            found += [row_of_message(body or name, values) for name, values in decode_scores(wanted[topic], data)]
        except (MalformedMessage, KeyError, TypeError, ValueError) as error:
            raise InputError(f"the baseline {path} has a message on {topic} that is no score; {_HINT}") from error
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
    """What has changed of one touchdown."""
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
