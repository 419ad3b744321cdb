"""What a replay found of each of several bodies, as a table for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rich.table import Table

from ..prediction.types import Status
from .summary import errors_of, row_of
from .table import NONE, percent, plain_table, small_percent

if TYPE_CHECKING:
    from ..bags.replay import BodyTruth, Result, Statuses
    from ..scenarios.warned import Warned

_STATES: Final = ("odom", "imu")


def bodies_of(result: Result) -> list[str]:
    """The names of the bodies of a replay, in the order of its inputs; nothing where the only one has no name."""
    named = [name.rpartition("/")[0] for name in result.inputs]
    found = [body for body in dict.fromkeys([*named, *result.truths]) if body != "support"]
    return [] if "" in found else found


def bodies_table(result: Result) -> Table:
    """One row for each body: what came of its samples and touchdowns, and how that compares with the truth."""
    bodies = bodies_of(result)
    counts = {body: _counts(result, body) for body in bodies}
    refused = any(set(one) - {Status.ACCEPTED} for one in counts.values())
    knows_truth = any(one.truth for one in result.truths.values())
    warns = any(one.warned for one in result.truths.values())
    headers = ["\n\nsamples", *(["\n\nrefused"] if refused else []), "touch-\ndowns\nscored", "median\nerror\n%"]
    if knows_truth:
        headers += ["true\ntouchdowns\nfound", "\nfalse\nalarms", "right\nmode\n%", "wrong\nspeed\n%"]
    if warns:
        headers += ["warned\nahead\ns"]
    table = plain_table()
    table.add_column("\n\nbody", no_wrap=True)
    for header in headers:
        # Where the table is too wide, rich narrows columns below their words; no number shall be cut off.
        table.add_column(header, justify="right", no_wrap=True, min_width=max(map(len, header.split("\n"))))
    for body in bodies:
        rows = [row_of(*settled) for settled in result.settled if settled.body == body]
        errors = errors_of(rows)
        taken = sum(counts[body].values())
        cells = [body, f"{taken:,}", *([f"{taken - counts[body].get(Status.ACCEPTED, 0):,}"] if refused else [])]
        cells += [_of(errors.number, len(rows)), percent(errors.median)]
        compared = result.truths.get(body)
        if knows_truth:
            cells += _truth_cells(compared)
        if warns:
            cells.append(_warned(None if compared is None else compared.warned))
        table.add_row(*cells)
    return table


def _of(part: int, whole: int) -> str:
    """How many of some, with spaces at which no terminal breaks a line."""
    return f"{part:,}\u00a0of\u00a0{whole:,}" if whole else NONE


def _counts(result: Result, body: str) -> Statuses:
    """What became of the states of a body."""
    return next((result.inputs[name] for kind in _STATES if (name := f"{body}/{kind}") in result.inputs), {})


def _truth_cells(compared: BodyTruth | None) -> list[str]:
    truth = None if compared is None else compared.truth
    if truth is None:
        return [NONE] * 4
    return [
        _of(truth.touchdowns - truth.missed, truth.touchdowns),
        f"{truth.false:,}",
        percent(truth.mode_accuracy),
        small_percent(truth.median_velocity_error),
    ]


def _warned(warned: Warned | None) -> str:
    """How many seconds before anything happened to a body it was warned of; below 0 where that was too late."""
    happened = None if warned is None else warned.first_event
    if warned is None or happened is None:
        return NONE
    return "never" if warned.first_warning is None else f"{(happened - warned.first_warning) / 1e9:.1f}"
