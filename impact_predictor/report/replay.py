"""What a replay prints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from rich.console import Console

from ..prediction.types import Status
from .bodies import bodies_of, bodies_table
from .summary import error_by_lead_time, row_of, words
from .table import conclusions, lead_time_table, percent, show, small_percent, touchdown_table

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..scenarios.comparison import Truth
    from ..scenarios.warned import Warned

MOST_ROWS: Final = 20
"""Touchdowns that are listed unless all are asked for."""


def print_replay(console: Console, result: Result, every: bool = False) -> None:
    """Print the touchdowns (the first scored ones, or `every` one), the errors and what became of the samples."""
    rows = sorted([row_of(*settled) for settled in result.settled], key=lambda row: row.stamp)
    listed = rows if every else [row for row in rows if row.scored][:MOST_ROWS]
    _say(console, result.bag)
    if bodies_of(result):
        show(console, bodies_table(result))
        _say(console, "")
    if listed:
        show(console, touchdown_table(listed, console.width))
        if len(listed) < len(rows):
            _say(console, f"{len(rows) - len(listed)} more touchdowns: list them with --all, or read them with --json.")
    errors = error_by_lead_time(settled.score for settled in result.settled)
    if any(one.errors.number for one in errors):
        _say(console, "")
        show(console, lead_time_table(errors))
    _say(console, "")
    compared = [] if result.truth is None else truth_sentences(result.truth)
    compared += _warned([one.warned for one in result.truths.values() if one.warned is not None])
    for sentence in [*conclusions(rows), *compared, *_costs(result)]:
        _say(console, sentence)


def truth_sentences(truth: Truth) -> list[str]:
    """How the predictions compare with the true impacts of the bag, one sentence each."""
    from ..scenarios.comparison import BORDER

    found = truth.touchdowns - truth.missed
    said = [f"Against the truth in the bag: {found} of {truth.touchdowns} touchdowns found, {truth.false} false alarms"]
    if truth.mode_accuracy is not None:
        said.append(
            f"Of those found, {percent(truth.mode_accuracy)} % have the right mode; "
            f"the velocities after them are {small_percent(truth.median_velocity_error)} % wrong in the median"
        )
    if truth.clear_mode_accuracy is not None and truth.clear < found:
        said.append(
            f"{truth.clear} of them are farther than {small_percent(BORDER)} % of friction or geometry from another "
            f"mode; of these {percent(truth.clear_mode_accuracy)} % have the right one"
        )
    if truth.median_time_error is not None:
        said.append(f"The time told 20 ms ahead is {truth.median_time_error * 1e6:.3g} us wrong in the median")
    if truth.unresolved:
        said.append(
            f"{truth.unresolved} more impacts cannot be seen at this rate of samples: they follow too closely, "
            "or are too slow to be told from rest"
        )
        if truth.unresolved_wrong:
            said[-1] += f"; {truth.unresolved_wrong} of them were predicted all the same, with another mode"
    return [f"{sentence}." for sentence in said]


def _warned(warned: Sequence[Warned]) -> list[str]:
    answers = [one.before_first_impact for one in warned if one.before_first_impact is not None]
    if not answers:
        return []
    bodies = "1 body slid or struck" if len(answers) == 1 else f"{len(answers)} bodies slid or struck"
    return [f"{bodies}; a warning came before that in {sum(answers)} of {len(answers)} cases."]


def _costs(result: Result) -> list[str]:
    said = []
    if result.samples:
        cost, rate = result.seconds / result.samples * 1e6, result.samples / result.seconds
        said = [f"{result.samples:,} samples at {cost:.0f} us each, {rate:,.0f} per second, with reading and writing."]
    support = {f"messages of {name}": counts for name, counts in result.inputs.items() if name.startswith("support/")}
    states = {"samples": result.statuses, "messages of contact_geometry": result.geometry_statuses}
    for name, counts in {**states, **support}.items():
        refused = [f"{count} {words(status.name)}" for status, count in counts.items() if status is not Status.ACCEPTED]
        if refused:
            said.append(f"Refused {name}: {', '.join(refused)}.")
    return said


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
