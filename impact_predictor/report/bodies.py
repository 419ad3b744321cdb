"""What a replay found of each of several bodies, as tables for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rich.table import Table

from ..prediction.inputs import STATES
from ..prediction.types import Status
from .summary import errors_of, row_of
from .table import NONE, percent, plain_table, small_percent

if TYPE_CHECKING:
    from ..bags.replay import Result, Statuses
    from ..scenarios.comparison import Truth
    from ..scenarios.warned import Warned

EARLY: Final = Status.NO_SUPPORT
"""What becomes of samples while the support is not known yet: that they come early is no fault of theirs."""


def bodies_of(result: Result) -> list[str]:
    """The names of the bodies of a replay, in the order of its inputs; nothing where the only one has no name."""
    named = [name.rpartition("/")[0] for name in result.inputs]
    found = [body for body in dict.fromkeys([*named, *result.truths]) if body != "support"]
    return [] if "" in found else found


def bodies_table(result: Result) -> Table:
    """One row for each body: what came of its samples and touchdowns."""
    bodies = bodies_of(result)
    counts = {body: _counts(result, body) for body in bodies}
    refused = {
        body: sum(one.values()) - one.get(Status.ACCEPTED, 0) - one.get(EARLY, 0) for body, one in counts.items()
    }
    headers = ["samples", *(["refused"] if any(refused.values()) else []), "touchdowns\nscored", "median\nerror %"]
    table = _table(headers)
    for body in bodies:
        rows = [row_of(*settled) for settled in result.settled if settled.body == body]
        errors = errors_of(rows)
        cells = [body, f"{sum(counts[body].values()):,}", *([f"{refused[body]:,}"] if any(refused.values()) else [])]
        table.add_row(*cells, _of(errors.number, len(rows)), percent(errors.median))
    return table


def truths_table(result: Result) -> Table | None:
    """One row for each body: how what was predicted, and warned of, compares with the truth in the bag."""
    knows_truth = any(one.truth for one in result.truths.values())
    warns = any(one.warned for one in result.truths.values())
    if not (knows_truth or warns):
        return None
    headers = []
    if knows_truth:
        headers += ["touchdowns\nfound", "false\nalarms", "right\nmode %", "speed\nerror %"]
    if warns:
        headers += ["events\nwarned of", "first one\ns ahead"]
    table = _table(headers)
    for body in bodies_of(result):
        truth, warned = result.truths.get(body, (None, None))
        table.add_row(body, *(_truth_cells(truth) if knows_truth else []), *(_warned_cells(warned) if warns else []))
    return table


def _table(headers: list[str]) -> Table:
    table = plain_table()
    table.add_column("\nbody", no_wrap=True)
    for header in headers:
        lines = header if "\n" in header else f"\n{header}"
        # Where a table is too wide, rich narrows columns below their words; no number shall be cut off.
        table.add_column(lines, justify="right", no_wrap=True, min_width=max(map(len, lines.split("\n"))))
    return table


def _of(part: int, whole: int) -> str:
    """How many of some, with spaces at which no terminal breaks a line."""
    return f"{part:,}\u00a0of\u00a0{whole:,}" if whole else NONE


def _counts(result: Result, body: str) -> Statuses:
    """What became of the states of a body."""
    return next((result.inputs[name] for kind in STATES if (name := f"{body}/{kind}") in result.inputs), {})


def _truth_cells(truth: Truth | None) -> list[str]:
    if truth is None:
        return [NONE] * 4
    return [
        _of(truth.touchdowns - truth.missed, truth.touchdowns),
        f"{truth.false:,}",
        percent(truth.mode_accuracy),
        small_percent(truth.median_velocity_error),
    ]


def _warned_cells(warned: Warned | None) -> list[str]:
    """How many events a warning stood before, and since how many seconds at the first one."""
    if warned is None or warned.first_event is None:
        return [NONE] * 2
    ahead = "not" if warned.warned_ahead is None else f"{warned.warned_ahead:.1f}"
    return [_of(warned.events_warned, warned.events), ahead]
