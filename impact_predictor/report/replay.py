"""What a replay prints: touchdowns, landings, errors, the comparison with the truth, and what became of the samples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final

from rich.console import Console
from rich.table import Table

from ..mechanics.types import Twist
from ..prediction.scene import CONTACT_GEOMETRY, STATES
from ..prediction.types import Status
from ..wording import NONE, counted, duration, fixed, percent, words
from .summary import ReplayTally, SpanErrors, TouchdownRow, error_by_lead_time, errors_of, row_of
from .table import Column, first_stamp, say, show, table_of

if TYPE_CHECKING:
    from ..bags.replay import Result, Settled, StatusCounts
    from ..scenarios.comparison import BodyTruth, Truth, Warned

MOST_ROWS: Final = 20
"""Touchdowns that are listed unless all are asked for."""
EARLY: Final = Status.NO_SUPPORT
"""What becomes of samples while the support is not known yet: that they come early is no fault of theirs."""


def print_replay(console: Console, result: Result, every: bool = False) -> None:
    """Print the touchdowns (the first scored ones, or `every` one), the errors and what became of the samples."""
    others = [settled for settled in result.settled if settled.score.landing is None]
    rows = sorted([row_of(*settled) for settled in others], key=lambda row: row.stamp)
    listed = rows if every else [row for row in rows if row.scored][:MOST_ROWS]
    errors = error_by_lead_time(settled.score for settled in others)
    say(console, result.bag)
    if bodies := bodies_of(result):
        _show(console, bodies_table(result, bodies))
        if any(one.truth or one.warned for one in result.truths.values()):
            _show(console, truths_table(result.truths, bodies))
    if len(others) < len(result.settled):
        from .landings import feet_table, landings_of, landings_table  # only where feet have landed

        landings = landings_of(result.settled)
        shown = landings if every else landings[:MOST_ROWS]
        _show(console, landings_table(shown, console.width), _hint(len(landings) - len(shown), "more landing"))
        _show(console, feet_table(landings))
    if listed:
        _show(console, touchdown_table(listed, console.width), _hint(len(rows) - len(listed), "more touchdown"))
    if any(one.errors.number for one in errors):
        _show(console, lead_time_table(errors))
    say(console, *concluded(result.settled))
    if result.truth is not None:
        say(console, *truth_sentences(result.truth))
    say(console, *_warned([one.warned for one in result.truths.values() if one.warned is not None]), *_costs(result))


def concluded(settled: Iterable[Settled]) -> list[str]:
    """What touchdowns that have happened say all together, one sentence each: landings of feet, and all others."""
    tally = ReplayTally()
    tally.add(settled)
    return tally.sentences()


def _hint(number: int, noun: str) -> str:
    """How the rows can be read that are not listed."""
    return f"{counted(number, noun)}: list them with --all, or read them with --json." if number else ""


def _show(console: Console, table: Table, remark: str = "") -> None:
    """Print a table, a remark on it and an empty line."""
    show(console, table)
    say(console, f"{remark}\n" if remark else "")


def touchdown_table(rows: Sequence[TouchdownRow], width: int) -> Table:
    """The touchdowns with the velocities right after them, for a terminal that is `width` characters wide."""
    start = first_stamp(row.stamp for row in rows)
    time = "since\nfirst\ns" if start else "time\ns"
    columns = [Column(time, lambda row: fixed((row.stamp - start) / 1e9, 3))]
    if len({row.body for row in rows}) > 1:
        columns = [Column(("body", time), lambda row: (row.body, fixed((row.stamp - start) / 1e9, 3)), f"body\n{time}")]
    columns += [
        Column(
            ("ahead\nfirst\nms", "last\nms"),
            lambda row: (fixed(1e3 * row.announced, 1), fixed(1e3 * row.lead_time, 1)),
            "ahead\nfirst\nlast ms",
        ),
        Column(("predicted\nmode",), lambda row: (row.mode.name,), "predicted\nmode, below\nmeasured", left=True),
        Column(
            ("predicted\nvx\nm/s", "vy\nm/s", "omega\nrad/s", "measured\nvx\nm/s", "vy\nm/s", "omega\nrad/s"),
            lambda row: (*_velocities(row.predicted), *_velocities(row.measured)),
            ("vx\nm/s", "vy\nm/s", "omega\nrad/s"),
        ),
        Column("error\n%", lambda row: percent(row.relative_error)),
    ]
    if any(row.cost is not None for row in rows):
        columns.append(Column("cost\nus", lambda row: fixed(None if row.cost is None else 1e6 * row.cost, 0)))
    if any(map(_notes, rows)):
        columns.append(Column("notes", _notes, left=True, fold=11))
    return table_of(columns, rows, width, lambda row: "" if row.scored else "dim")


def _velocities(twist: Twist | None) -> tuple[str, str, str]:
    return (NONE, NONE, NONE) if twist is None else (fixed(twist.vx, 3), fixed(twist.vy, 3), fixed(twist.omega, 2))


def _notes(row: TouchdownRow) -> str:
    said = ", ".join(words(flag) for flag in row.flags)
    return said if row.scored else f"not scored: {said}"


def lead_time_table(errors: Sequence[SpanErrors]) -> Table:
    """The error against the time before the touchdown at which a prediction was made."""
    columns = [
        Column("before touchdown\nms", lambda one: f"{one.begin * 1e3:.0f} to {one.end * 1e3:.0f}"),
        Column("predictions\n", lambda one: str(one.errors.number)),
        Column("median error\n%", lambda one: percent(one.errors.p50)),
        Column("90 % below\n%", lambda one: percent(one.errors.p90)),
    ]
    return table_of(columns, errors)


def bodies_of(result: Result) -> list[str]:
    """The names of the bodies of a replay, in the order of its inputs; nothing where the only one has no name."""
    named = [name.rpartition("/")[0] for name in result.inputs]
    found = [body for body in dict.fromkeys([*named, *result.truths]) if body != "support"]
    return [] if "" in found else found


def bodies_table(result: Result, bodies: Sequence[str]) -> Table:
    """One row for each body: what came of its samples and touchdowns."""
    counts = {body: _counts(result, body) for body in bodies}
    rows = {body: [row_of(*settled) for settled in result.settled if settled.body == body] for body in bodies}
    errors = {body: errors_of(rows[body]) for body in bodies}
    columns = [
        Column("body", lambda body: body, left=True),
        Column("samples", lambda body: f"{sum(counts[body].values()):,}"),
        Column("refused", lambda body: f"{_refused(counts[body]):,}"),
        Column("touchdowns\nscored", lambda body: _of(errors[body].number, len(rows[body]))),
        Column("median\nerror %", lambda body: percent(errors[body].p50)),
    ]
    if not any(map(_refused, counts.values())):
        del columns[2]
    return table_of(columns, bodies)


def truths_table(truths: Mapping[str, BodyTruth], bodies: Sequence[str]) -> Table:
    """One row for each body: how what was predicted, and warned of, compares with the truth in the bag."""
    columns = [Column("body", lambda body: body, left=True)]
    if any(one.truth for one in truths.values()):
        headers = ("touchdowns\nfound", "false\nalarms", "right\nmode %", "speed\nerror %")
        columns.append(Column(headers, lambda body: _truth_cells(truths[body].truth if body in truths else None)))
    if any(one.warned for one in truths.values()):
        warnings = ("events\nwarned of", "first one\ns ahead")
        columns.append(Column(warnings, lambda body: _warned_cells(truths[body].warned if body in truths else None)))
    return table_of(columns, bodies)


def _of(part: int, whole: int) -> str:
    """How many of some, with spaces at which no terminal breaks a line."""
    return f"{part:,}\u00a0of\u00a0{whole:,}" if whole else NONE


def _counts(result: Result, body: str) -> StatusCounts:
    """What became of the states of a body."""
    return next((result.inputs[name] for kind in STATES if (name := f"{body}/{kind}") in result.inputs), {})


def _refused(counts: StatusCounts) -> int:
    return sum(counts.values()) - counts.get(Status.ACCEPTED, 0) - counts.get(EARLY, 0)


def _truth_cells(truth: Truth | None) -> tuple[str, ...]:
    if truth is None:
        return (NONE,) * 4
    found = _of(truth.touchdowns - truth.missed, truth.touchdowns)
    return found, f"{truth.false:,}", percent(truth.mode_accuracy), percent(truth.median_velocity_error)


def _warned_cells(warned: Warned | None) -> tuple[str, ...]:
    """How many events a warning stood before, and since how many seconds at the first one."""
    if warned is None or warned.first_event is None:
        return (NONE,) * 2
    ahead = "not" if warned.warned_ahead is None else f"{warned.warned_ahead:.1f}"
    return _of(warned.events_warned, warned.events), ahead


def truth_sentences(truth: Truth) -> list[str]:
    """How the predictions compare with the true impacts of the bag, one sentence each."""
    from ..scenarios.comparison import BORDER
    from ..scenarios.matching import NEAREST

    found = truth.touchdowns - truth.missed
    of = f"{found:,} of {counted(truth.touchdowns, 'touchdown')} found"
    if not truth.touchdowns:
        of = "no touchdown that this rate of samples can show"
    said = [f"Against the truth in the bag: {of}, {counted(truth.false, 'false alarm')}"]
    if truth.missed:
        others = "the other was" if truth.missed == 1 else f"the other {truth.missed:,} were"
        said.append(
            f"A touchdown is found where a prediction before it has its time to {NEAREST / 1e6:.0f} ms; {others} "
            "predicted too late, too far off, or not at all"
        )
    if truth.mode_accuracy is not None:
        said.append(
            f"Of those found, {percent(truth.mode_accuracy)} % have the right mode; "
            f"the velocities after them are within {percent(truth.median_velocity_error)} % of the "
            "true ones in the median"
        )
    if truth.clear_mode_accuracy is not None and truth.clear < found:
        are = "is" if truth.clear == 1 else "are"
        said.append(
            f"{truth.clear:,} of them {are} farther than {100.0 * BORDER:g} % of friction or geometry from "
            f"another mode; of these {percent(truth.clear_mode_accuracy)} % have the right one"
        )
    if truth.median_time_error is not None:
        said.append(f"The time predicted 20 ms ahead is {duration(truth.median_time_error)} wrong in the median")
        further = truth.time_error_by_lead_time.get("0.05")
        said[-1] += "" if further is None else f", that predicted 50 ms ahead {duration(further)}"
    if truth.least_lead_time is not None:
        said.append(f"The first prediction of each came {duration(truth.least_lead_time)} ahead of it or earlier")
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
        from ..scenarios.comparison import APART

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
    inputs = {"samples": result.statuses, "messages of contact_geometry": result.geometry_statuses}
    for name, counts in result.inputs.items():
        if name.startswith("support/") or name.rpartition("/")[2] not in (*STATES, CONTACT_GEOMETRY):
            inputs[f"messages of {name}"] = counts
    for name, counts in inputs.items():
        faults = [f"{count:,} {words(one.name)}" for one, count in counts.items() if one not in expected]
        if faults:
            said.append(f"Refused {name}: {', '.join(faults)}.")
    return said
