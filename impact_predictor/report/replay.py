"""What a replay prints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rich.console import Console

from ..prediction.types import Status
from .summary import error_by_lead_time, row_of, words
from .table import conclusions, lead_time_table, show, touchdown_table

if TYPE_CHECKING:
    from ..bags.replay import Result

MOST_ROWS: Final = 20
"""Touchdowns that are listed unless all are asked for."""


def print_replay(console: Console, result: Result, every: bool = False) -> None:
    """Print the touchdowns (the first scored ones, or `every` one), the errors and what became of the samples."""
    rows = [row_of(*settled) for settled in result.settled]
    listed = rows if every else [row for row in rows if row.scored][:MOST_ROWS]
    _say(console, result.bag)
    if listed:
        show(console, touchdown_table(listed, console.width))
        if len(listed) < len(rows):
            _say(console, f"{len(rows) - len(listed)} more touchdowns: list them with --all, or read them with --json.")
    errors = error_by_lead_time(settled.score for settled in result.settled)
    if any(one.errors.number for one in errors):
        _say(console, "")
        show(console, lead_time_table(errors))
    _say(console, "")
    for sentence in [*conclusions(rows), *_costs(result)]:
        _say(console, sentence)


def _costs(result: Result) -> list[str]:
    if not result.samples:
        return []
    cost, rate = result.seconds / result.samples * 1e6, result.samples / result.seconds
    said = [f"{result.samples:,} samples at {cost:.0f} us each, {rate:,.0f} per second, with reading and writing."]
    for name, counts in (("samples", result.statuses), ("messages of contact_geometry", result.geometry_statuses)):
        refused = [f"{count} {words(status.name)}" for status, count in counts.items() if status is not Status.ACCEPTED]
        if refused:
            said.append(f"Refused {name}: {', '.join(refused)}.")
    return said


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
