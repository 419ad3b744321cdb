"""Tables for the terminal: touchdowns, errors and what became of the samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Protocol

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ..mechanics.types import Twist
from .summary import LeadTimeErrors, TouchdownRow, words

NONE: Final = "-"
_WALL_CLOCK: Final = 10**17
"""Stamps above this many ns (the year 1973) are times of day, and are counted from the first touchdown."""
_UNLIMITED: Final = 10_000
_VELOCITIES: Final = ("vx\nm/s", "vy\nm/s", "omega\nrad/s")


def plain_table() -> Table:
    """An empty table in the style of all of them."""
    return Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0), header_style="bold")


def show(console: Console, table: Table) -> None:
    """Print a table; the terminal breaks lines that are too long for it, and no number is cut off."""
    least = least_width(table)
    if least > console.width:
        table.width = least
    console.print(table, crop=False)


def touchdown_table(rows: Sequence[TouchdownRow], width: int) -> Table:
    """The touchdowns with the velocities right after them, predicted beside measured, or above where that is too wide.

    `width` is that of the terminal in characters.
    """
    beside = _touchdown_table(rows, stacked=False)
    return beside if least_width(beside) <= width else _touchdown_table(rows, stacked=True)


def least_width(table: Table) -> int:
    """How many characters a table needs."""
    return Console(width=_UNLIMITED).measure(table).minimum


class Stamped(Protocol):
    """What has a stamp in ns."""

    @property
    def stamp(self) -> int: ...


def first_stamp(rows: Sequence[Stamped]) -> int:
    """The stamp in ns from which times are counted: that of the first of some rows if it is a time of day."""
    return rows[0].stamp if rows and rows[0].stamp > _WALL_CLOCK else 0


def _touchdown_table(rows: Sequence[TouchdownRow], stacked: bool) -> Table:
    start = first_stamp(rows)
    bodies = len({row.body for row in rows}) > 1
    costs = any(row.cost is not None for row in rows)
    notes = [_notes(row) for row in rows]
    table = plain_table()
    time = "since\nfirst\ns" if start else "\ntime\ns"
    if bodies and stacked:
        time = "body\nsince\nfirst s" if start else "\nbody\ntime s"
    elif bodies:
        table.add_column("body", no_wrap=True)
    table.add_column(time, justify="right", no_wrap=True)
    ahead = ("ahead\nfirst\nlast ms",) if stacked else ("ahead\nfirst\nms", "\nlast\nms")
    for header in ahead:
        table.add_column(header, justify="right", no_wrap=True)
    table.add_column("\npredicted\nmode", no_wrap=True)
    for group in ("",) if stacked else ("predicted", "measured"):
        for header in _VELOCITIES:
            table.add_column(f"{group if header is _VELOCITIES[0] else ''}\n{header}", justify="right", no_wrap=True)
    table.add_column("\nerror\n%", justify="right", no_wrap=True)
    if costs:
        table.add_column("\ncost\nus", justify="right", no_wrap=True)
    if any(notes):
        table.add_column("\n\nnotes", min_width=min(max(map(len, notes)), 11 if stacked else 24))
    for row, note in zip(rows, notes, strict=True):
        predicted, measured = _velocities(row.predicted), _velocities(row.measured)
        cells = [row.body] if bodies else []
        cells.append(f"{(row.stamp - start) / 1e9:.3f}")
        if stacked:
            cells = ["\n".join(cells)]
        seen = f"{row.announced * 1e3:.1f}", f"{row.lead_time * 1e3:.1f}"
        if stacked:
            cells.append("\n".join(seen))
            cells.append(f"{row.mode.name}\n- measured")
            cells += [f"{above}\n{below}" for above, below in zip(predicted, measured, strict=True)]
        else:
            cells += [*seen, row.mode.name, *predicted, *measured]
        cells.append(percent(row.relative_error))
        if costs:
            cells.append(NONE if row.cost is None else f"{row.cost * 1e6:.0f}")
        if any(notes):
            cells.append(note)
        table.add_row(*cells, style="" if row.scored else "dim")
    return table


def _velocities(twist: Twist | None) -> list[str]:
    return [NONE] * 3 if twist is None else [f"{twist.vx:.3f}", f"{twist.vy:.3f}", f"{twist.omega:.2f}"]


def _notes(row: TouchdownRow) -> str:
    said = ", ".join(words(flag) for flag in row.flags)
    return said if row.scored else f"not scored: {said}"


def percent(fraction: float | None) -> str:
    """A fraction of 1 as a number of percent."""
    return NONE if fraction is None else f"{fraction * 100:.1f}"


def small_percent(fraction: float | None) -> str:
    """A fraction of 1, which may be tiny, as a number of percent."""
    return NONE if fraction is None else f"{100.0 * fraction:.2g}"


def lead_time_table(errors: Sequence[LeadTimeErrors]) -> Table:
    """The error against the time before the touchdown at which a prediction was made."""
    table = plain_table()
    table.add_column("before touchdown\nms", justify="right", no_wrap=True)
    for header in ("predictions\n", "median error\n%", "90 % below\n%"):
        table.add_column(header, justify="right", no_wrap=True)
    for one in errors:
        span = f"{one.begin * 1e3:.0f} to {one.end * 1e3:.0f}"
        table.add_row(span, str(one.errors.number), percent(one.errors.median), percent(one.errors.p90))
    return table
