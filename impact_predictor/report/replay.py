"""What a replay prints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from rich.console import Console

from ..prediction.types import Status
from .bodies import EARLY, bodies_of, bodies_table, truths_table
from .summary import counted, error_by_lead_time, row_of, words
from .table import conclusions, lead_time_table, percent, show, small_percent, touchdown_table

if TYPE_CHECKING:
    from rich.table import Table

    from ..bags.replay import Result
    from ..scenarios.comparison import Truth
    from ..scenarios.warned import Warned

MOST_ROWS: Final = 20
"""Touchdowns that are listed unless all are asked for."""


def print_replay(console: Console, result: Result, every: bool = False) -> None:
    """Print the touchdowns (the first scored ones, or `every` one), the errors and what became of the samples."""
    rows = sorted([row_of(*settled) for settled in result.settled], key=lambda row: row.stamp)
    listed = rows if every else [row for row in rows if row.scored][:MOST_ROWS]
    errors = error_by_lead_time(settled.score for settled in result.settled)
    _say(console, result.bag)
    if bodies_of(result):
        _show(console, bodies_table(result))
        _show(console, truths_table(result))
    if listed:
        more = counted(len(rows) - len(listed), "more touchdown") if len(listed) < len(rows) else ""
        hint = f"{more}: list them with --all, or read them with --json." if more else ""
        _show(console, touchdown_table(listed, console.width), hint)
    if any(one.errors.number for one in errors):
        _show(console, lead_time_table(errors))
    compared = [] if result.truth is None else truth_sentences(result.truth)
    compared += _warned([one.warned for one in result.truths.values() if one.warned is not None])
    for sentence in [*conclusions(rows), *compared, *_costs(result)]:
        _say(console, sentence)


def truth_sentences(truth: Truth) -> list[str]:
    """How the predictions compare with the true impacts of the bag, one sentence each."""
    from ..scenarios.comparison import BORDER

    found = truth.touchdowns - truth.missed
    there = counted(truth.touchdowns, "touchdown")
    told = f"{found:,} of {there} found" if truth.touchdowns else "no touchdown that this rate of samples can show"
    said = [f"Against the truth in the bag: {told}, {counted(truth.false, 'false alarm')}"]
    if truth.mode_accuracy is not None:
        said.append(
            f"Of those found, {percent(truth.mode_accuracy)} % have the right mode; "
            f"the velocities after them are {small_percent(truth.median_velocity_error)} % wrong in the median"
        )
    if truth.clear_mode_accuracy is not None and truth.clear < found:
        are = "is" if truth.clear == 1 else "are"
        said.append(
            f"{truth.clear:,} of them {are} farther than {small_percent(BORDER)} % of friction or geometry from "
            f"another mode; of these {percent(truth.clear_mode_accuracy)} % have the right one"
        )
    if truth.median_time_error is not None:
        said.append(f"The time told 20 ms ahead is {truth.median_time_error * 1e6:.3g} us wrong in the median")
    if truth.unresolved:
        said.append(
            f"{counted(truth.unresolved, 'more impact')} cannot be seen at this rate of samples: too soon after the "
            "one before, or too slow to be told from rest"
        )
        if truth.unresolved_wrong:
            were = "was" if truth.unresolved_wrong == 1 else "were"
            said[-1] += f"; {truth.unresolved_wrong:,} of them {were} predicted all the same, with another mode"
    return [f"{sentence}." for sentence in said]


def _warned(warned: Sequence[Warned]) -> list[str]:
    said = []
    answers = [one.before_first_impact for one in warned if one.before_first_impact is not None]
    if answers:
        bodies = "1 body" if len(answers) == 1 else f"{len(answers)} bodies"
        said.append(
            f"{bodies} slid or struck; a warning stood before the first time in {sum(answers)} of {len(answers)}."
        )
    events = sum(one.events for one in warned)
    if events:
        from ..scenarios.warned import APART

        stood = sum(one.events_warned for one in warned)
        said.append(
            f"{counted(events, 'event')} in all (slides, lifts and impacts less than {APART / 1e9:.0f} s apart are "
            f"one); a warning stood before {stood:,} of {events:,}."
        )
    return said


def _costs(result: Result) -> list[str]:
    said = []
    if result.samples:
        cost, rate = result.seconds / result.samples * 1e6, result.samples / result.seconds
        samples = counted(result.samples, "sample")
        said = [f"{samples} at {cost:.0f} us each, {rate:,.0f} per second, with reading and writing."]
    if early := result.statuses.get(EARLY, 0):
        said.append(f"{counted(early, 'sample')} came before the deck's motion was known.")
    support = {f"messages of {name}": counts for name, counts in result.inputs.items() if name.startswith("support/")}
    states = {"samples": result.statuses, "messages of contact_geometry": result.geometry_statuses}
    for name, counts in {**states, **support}.items():
        faults = {status: count for status, count in counts.items() if status not in (Status.ACCEPTED, EARLY)}
        if faults:
            refused = ", ".join(f"{count:,} {words(status.name)}" for status, count in faults.items())
            said.append(f"Refused {name}: {refused}.")
    return said


def _show(console: Console, table: Table | None, remark: str = "") -> None:
    """Print a table that there is, a remark on it and an empty line."""
    if table is not None:
        show(console, table)
        _say(console, f"{remark}\n" if remark else "")


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
