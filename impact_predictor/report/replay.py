"""What a replay prints."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Final

from rich.console import Console

from ..prediction.inputs import CONTACT_GEOMETRY, STATES
from ..prediction.types import Status
from ..wording import counted
from .bodies import EARLY, bodies_of, bodies_table, truths_table
from .summary import error_by_lead_time, row_of, words
from .table import lead_time_table, percent, show, small_percent, touchdown_table
from .tally import Together

if TYPE_CHECKING:
    from rich.table import Table

    from ..bags.replay import Result, Settled
    from ..scenarios.comparison import Truth
    from ..scenarios.warned import Warned
    from .landings import Landed

MOST_ROWS: Final = 20
"""Touchdowns that are listed unless all are asked for."""


def print_replay(console: Console, result: Result, every: bool = False) -> None:
    """Print the touchdowns (the first scored ones, or `every` one), the errors and what became of the samples."""
    landings = _landings_of(result.settled)
    others = [settled for settled in result.settled if settled.score.landing is None]
    rows = sorted([row_of(*settled) for settled in others], key=lambda row: row.stamp)
    listed = rows if every else [row for row in rows if row.scored][:MOST_ROWS]
    errors = error_by_lead_time(settled.score for settled in others)
    _say(console, result.bag)
    if bodies_of(result):
        _show(console, bodies_table(result))
        _show(console, truths_table(result))
    if landings:
        from .landings import feet_table, landings_table

        shown = landings if every else landings[:MOST_ROWS]
        _show(console, landings_table(shown, console.width), _hint(len(landings) - len(shown), "more landing"))
        _show(console, feet_table(landings))
    if listed:
        hint = _hint(len(rows) - len(listed), "more touchdown")
        _show(console, touchdown_table(listed, console.width), hint)
    if any(one.errors.number for one in errors):
        _show(console, lead_time_table(errors))
    compared = [] if result.truth is None else truth_sentences(result.truth)
    compared += _warned([one.warned for one in result.truths.values() if one.warned is not None])
    for sentence in [*concluded(result.settled), *compared, *_costs(result)]:
        _say(console, sentence)


def concluded(settled: Iterable[Settled]) -> list[str]:
    """What touchdowns that have happened say all together, one sentence each: landings of feet, and all others."""
    together = Together()
    together.add(settled)
    return together.sentences()


def _landings_of(settled: Iterable[Settled]) -> list[Landed]:
    """The landings among touchdowns; what tells of them is loaded where there are any."""
    found = [one for one in settled if one.score.landing is not None]
    if not found:
        return []
    from .landings import landings_of

    return landings_of(found)


def truth_sentences(truth: Truth) -> list[str]:
    """How the predictions compare with the true impacts of the bag, one sentence each."""
    from ..scenarios.comparison import BORDER
    from ..scenarios.matching import NEAREST

    found = truth.touchdowns - truth.missed
    there = counted(truth.touchdowns, "touchdown")
    told = f"{found:,} of {there} found" if truth.touchdowns else "no touchdown that this rate of samples can show"
    said = [f"Against the truth in the bag: {told}, {counted(truth.false, 'false alarm')}"]
    if truth.missed:
        others = "the other was" if truth.missed == 1 else f"the other {truth.missed:,} were"
        said.append(
            "A touchdown is found where a prediction before it told its time to "
            f"{NEAREST / 1e6:.0f} ms; {others} announced too late, too far off, or not at all"
        )
    if truth.mode_accuracy is not None:
        said.append(
            f"Of those found, {percent(truth.mode_accuracy)} % have the right mode; "
            f"the velocities after them are within {small_percent(truth.median_velocity_error)} % of the "
            "true ones in the median"
        )
    if truth.clear_mode_accuracy is not None and truth.clear < found:
        are = "is" if truth.clear == 1 else "are"
        said.append(
            f"{truth.clear:,} of them {are} farther than {small_percent(BORDER)} % of friction or geometry from "
            f"another mode; of these {percent(truth.clear_mode_accuracy)} % have the right one"
        )
    if truth.median_time_error is not None:
        said.append(f"The time told 20 ms ahead is {_short(truth.median_time_error)} wrong in the median")
        further = truth.time_error_by_lead_time.get("0.05")
        said[-1] += "" if further is None else f", that told 50 ms ahead {_short(further)}"
    if truth.least_lead_time is not None:
        said.append(f"The first prediction of each came {_short(truth.least_lead_time)} ahead of it or earlier")
    if truth.unresolved:
        said.append(
            f"{counted(truth.unresolved, 'more impact')} cannot be seen at this rate of samples: too soon after the "
            "one before, or too slow to be told from rest"
        )
        if truth.unresolved_wrong:
            were = "was" if truth.unresolved_wrong == 1 else "were"
            said[-1] += f"; {truth.unresolved_wrong:,} of them {were} predicted all the same, with another mode"
    return [f"{sentence}." for sentence in said]


def _short(time: float) -> str:
    """A short time in s, in words."""
    return f"{time * 1e6:.3g} us" if time < 1e-3 else f"{time * 1e3:.3g} ms"


def _hint(number: int, noun: str) -> str:
    """How the rows can be read that are not listed."""
    return f"{counted(number, noun)}: list them with --all, or read them with --json." if number else ""


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
    expected = {Status.ACCEPTED, EARLY}
    if Status.ACCEPTED in result.statuses and (first := result.statuses.get(Status.NO_GEOMETRY, 0)):
        said.append(f"{counted(first, 'sample')} came before the first contact points.")
        expected.add(Status.NO_GEOMETRY)
    told = {"samples": result.statuses, "messages of contact_geometry": result.geometry_statuses}
    for name, counts in result.inputs.items():
        if name.startswith("support/") or name.rpartition("/")[2] not in (*STATES, CONTACT_GEOMETRY):
            told[f"messages of {name}"] = counts
    for name, counts in told.items():
        faults = {status: count for status, count in counts.items() if status not in expected}
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
