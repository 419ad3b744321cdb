"""What is printed of the changes against an earlier run."""

from __future__ import annotations

import os
from collections import Counter
from typing import Any, Final

from rich.console import Console
from rich.table import Table

from ..wording import NONE, counted, percent
from .baseline import Change, Comparison, Kind
from .table import plain_table, show

MOST_ROWS: Final = 20
"""Changes that are listed unless all are asked for."""

_LABELS: Final = {
    Kind.APPEARED: "appeared",
    Kind.VANISHED: "vanished",
    Kind.CONTACTS: "other contacts",
    Kind.MODE: "other mode",
    Kind.MOVED: "moved",
    Kind.SCORED: "scored or not",
    Kind.BETTER: "better",
    Kind.WORSE: "worse",
    Kind.VELOCITIES: "other vx, vy, omega",
}


def print_changes(
    console: Console, compared: Comparison, baseline: str | os.PathLike[str], every: bool = False
) -> None:
    """Print what has changed against a baseline (the first changes, or `every` one), or that nothing has."""
    if compared.changes:
        listed = compared.changes if every else compared.changes[:MOST_ROWS]
        console.print()
        show(console, _table(compared._replace(changes=tuple(listed))))
        more = len(compared.changes) - len(listed)
        if more:
            _say(console, f"{counted(more, 'more change')}: list them with --all, or read them with --json.")
    _say(console, concluded(compared, baseline))


def concluded(compared: Comparison, baseline: str | os.PathLike[str]) -> str:
    """What a comparison says in one sentence."""
    name = os.fspath(baseline)
    if not compared.changes:
        return f"Nothing has changed against {name}: {counted(compared.are, 'touchdown')}."
    counts = Counter(_LABELS[change.kind] for change in compared.changes)
    said = ", ".join(f"{count:,} {label}" for label, count in counts.most_common())
    return f"Against {name} {compared.alike:,} of {counted(compared.were, 'touchdown')} are as they were: {said}."


def sentences(compared: Comparison) -> list[str]:
    """The changes, one line each."""
    lines = []
    for change in compared.changes:
        was, now = _values(change, compared.start)
        when = _seconds(change.stamp, compared.start)
        lines.append(f"{when} s {_who(change)}: {_LABELS[change.kind]}, was {was}, now {now}")
    return lines


def as_json(compared: Comparison, baseline: str | os.PathLike[str]) -> dict[str, Any]:
    """A comparison as JSON, in the units of `Change`."""
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
                "change": change.kind.value,
                "was": change.was,
                "now": change.now,
            }
            for change in compared.changes
        ],
    }


def _table(compared: Comparison) -> Table:
    several = len({_who(change) for change in compared.changes}) > 1
    table = plain_table()
    table.add_column("since first\ns" if compared.start else "time\ns", justify="right", no_wrap=True)
    if several:
        table.add_column("\nbody", no_wrap=True)
    table.add_column("\nchange", no_wrap=True)
    for header in ("was", "now"):
        table.add_column(f"\n{header}", justify="right", overflow="fold")
    for change in compared.changes:
        cells = [_seconds(change.stamp, compared.start), *([_who(change)] if several else []), _LABELS[change.kind]]
        table.add_row(*cells, *_values(change, compared.start))
    return table


def _who(change: Change) -> str:
    return f"{change.body} {change.foot}".rstrip()


def _seconds(stamp: int, start: int) -> str:
    return f"{(stamp - start) / 1e9:.3f}"


def _values(change: Change, start: int) -> tuple[str, str]:
    """What was and what is, as texts."""
    if change.kind is Kind.MOVED:
        assert isinstance(change.was, int)
        assert isinstance(change.now, int)
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


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
