"""What a replay prints: bodies, touchdowns, landings, errors, the comparison with the truth, and what it cost."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from functools import partial
from math import hypot
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.console import Console
from rich.table import Table

from ..prediction.scene import STATES
from ..prediction.types import Status
from ..scenarios.comparison import LEAD_TIMES, Truth, Warned
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, duration, fixed, percent, words
from .summary import SpanErrors, Tally, errors_ahead, errors_of
from .table import MOST_ROWS, Column, first_stamp, more, say, show, table_of
from .touchdowns import TouchdownRow, rows_of

if TYPE_CHECKING:
    from ..bags.replay import Result

TOO_EARLY: Final = {
    Status.NO_SUPPORT: "before the deck's motion was known",
    Status.NO_GEOMETRY: "before the first contact points",
}
"""Samples that came before something is known, which is no fault of theirs."""
_NO_TRUTH: Final = Truth(
    touchdowns=0,
    missed=0,
    false=0,
    unresolved=0,
    mode_accuracy=None,
    median_velocity_error=None,
    median_time_error=None,
)


def print_replay(console: Console, result: Result, every: bool = False) -> None:
    """Print the touchdowns (the first scored ones, or `every` one), the errors and what became of the samples."""
    rows = rows_of(result.settled)
    landings, others = [row for row in rows if row.foot], [row for row in rows if not row.foot]
    errors = errors_ahead(one for _, score, _ in result.settled if score.scored for one in score.history)
    say(console, result.bag)
    if bodies := bodies_of(result, rows):
        _show(console, bodies_table(bodies, has_truth=result.truth is not None))
    if landings:
        listed = landings if every else landings[:MOST_ROWS]
        _show(console, landings_table(listed), *more(len(landings) - len(listed), "landing"))
    if listed := others if every else [row for row in others if row.scored][:MOST_ROWS]:
        _show(console, touchdown_table(listed), *more(len(others) - len(listed), "touchdown"))
    if any(one.errors.number for one in errors):
        _show(console, lead_time_table(errors))
    say(console, *Tally(rows).sentences())
    if result.truth is not None:
        say(console, *truth_sentences(result.truth))
    say(console, *_warnings([one.warned for one in result.truths.values() if one.warned is not None]), *_costs(result))


def _show(console: Console, table: Table, *remarks: str) -> None:
    """Print a table, remarks on it and an empty line."""
    show(console, table)
    say(console, *remarks, "")


def touchdown_table(rows: Sequence[TouchdownRow]) -> Table:
    """The touchdowns with the velocities right after them: what was predicted, and below it what was measured."""
    columns = [
        _when(rows),
        Column("ahead\nfirst\nlast ms", lambda row: f"{_ms(row.ahead)}\n{_ms(row.lead_time)}"),
        Column("predicted\nmode, below\nmeasured", lambda row: row.mode.name, left=True),
        Column("vx\nm/s", partial(_velocity, "vx", 3)),
        Column("vy\nm/s", partial(_velocity, "vy", 3)),
        Column("omega\nrad/s", partial(_velocity, "omega", 2)),
        Column("error\n%", lambda row: percent(row.relative_error)),
    ]
    if any(row.cost is not None for row in rows):
        columns.append(Column("cost\nus", lambda row: fixed(None if row.cost is None else 1e6 * row.cost, 0)))
    if any(map(_notes, rows)):
        columns.append(Column("notes", _notes, left=True, fold=11))
    return table_of(columns, rows, lambda row: "" if row.scored else "dim")


def _when(rows: Sequence[TouchdownRow]) -> Column:
    """The column of times, with bodies where there are several."""
    start = first_stamp(row.stamp for row in rows)
    several = len({row.body for row in rows}) > 1
    header = ("body\n" if several else "") + ("since\nfirst\ns" if start else "time\ns")
    return Column(
        header, lambda row: (f"{row.body}\n" if several else "") + fixed((row.stamp - start) / NANOSECONDS, 3)
    )


def _ms(seconds: float | None, decimals: int = 1, sign: str = "") -> str:
    return fixed(None if seconds is None else 1e3 * seconds, decimals, sign)


def _velocity(part: str, decimals: int, row: TouchdownRow) -> str:
    twists = (row.predicted_twist, row.measured_twist)
    return "\n".join(NONE if twist is None else fixed(getattr(twist, part), decimals) for twist in twists)


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


def landings_table(landings: Sequence[TouchdownRow]) -> Table:
    """One row for each landing; below the impulse of the foot that of the others, if they get any."""
    columns = [
        _when(landings),
        Column("foot", lambda row: f"{row.foot} {row.point or ''}".rstrip(), left=True),
        Column("first\nms\nahead", lambda row: _ms(row.ahead, 0)),
        Column(f"error\nms, at\n{1e3 * LEAD_TIMES[0]:.0f} ms", lambda row: _ms(row.time_errors[0], 1, "+")),
        Column("predicted\nmode", lambda row: row.mode.name, left=True),
        Column("foot's\nspeed\nm/s", lambda row: fixed(row.landing_speed, 3)),
        Column("N s at\nfoot,\nothers", _impulses),
        Column("body's\nchange\nm/s", lambda row: fixed(_size(row.velocity_change), 3)),
    ]
    if any(row.late is not None for row in landings):
        columns.append(Column("late\nms", lambda row: _ms(row.late, 1, "+")))
    if any(row.confirmed is not None for row in landings):
        columns.append(Column("force\nagrees", lambda row: {True: "yes", False: "no", None: NONE}[row.confirmed]))
    return table_of(columns, landings)


def _impulses(row: TouchdownRow) -> str:
    others = [row.others_impulse] if any(row.others_impulse or ()) else []
    return "\n".join(fixed(_size(impulse), 2) for impulse in (row.impulse, *others))


def _size(vector: Sequence[float] | None) -> float | None:
    """The magnitude of an impulse, or of the velocity of a twist."""
    return None if vector is None else hypot(*vector[:2])


class BodySummary(NamedTuple):
    """A body of a replay: its samples and touchdowns, and how the truth compares, empty where the bag has none."""

    name: str
    samples: int
    rows: Sequence[TouchdownRow]
    truth: Truth
    warned: Warned


def bodies_of(result: Result, rows: Sequence[TouchdownRow]) -> list[BodySummary]:
    """The bodies of a replay, in the order of its inputs; nothing where the only one has no name."""
    inputs, found = result.inputs, []
    names = dict.fromkeys([*(name.rpartition("/")[0] for name in inputs), *result.truths])
    for body in () if "" in names else [name for name in names if name != "support"]:
        truth, warned = result.truths.get(body, (None, None))
        found.append(
            BodySummary(
                name=body,
                samples=sum(sum(inputs.get(f"{body}/{kind}", {}).values()) for kind in STATES),
                rows=[row for row in rows if row.body == body],
                truth=truth or _NO_TRUTH,
                warned=warned or Warned(None, None, None, None),
            )
        )
    return found


def bodies_table(bodies: Sequence[BodySummary], *, has_truth: bool) -> Table:
    """One row for each body: its samples, and how its predictions compare with the truth, or else with the samples."""
    columns = [
        Column("body", lambda body: body.name, left=True),
        Column("samples", lambda body: f"{body.samples:,}"),
    ]
    if has_truth:
        columns += [
            Column("touchdowns\nfound", lambda body: _of(body.truth.touchdowns, body.truth.missed), fold=10),
            Column("false\nalarms", lambda body: f"{body.truth.false:,}"),
            Column("right\nmode %", lambda body: percent(body.truth.mode_accuracy)),
            Column("speed\nerror %", lambda body: percent(body.truth.median_velocity_error)),
        ]
    else:
        columns += [
            Column(
                "touchdowns\nscored",
                lambda body: _of(len(body.rows), sum(not row.scored for row in body.rows)),
                fold=10,
            ),
            Column("median\nerror %", lambda body: percent(errors_of(body.rows).p50)),
        ]
    if any(body.warned.events for body in bodies):
        columns += [
            Column(
                "events\nwarned of",
                lambda body: _of(body.warned.events, body.warned.events - body.warned.events_warned),
                fold=9,
            ),
            Column("first\ns ahead", lambda body: fixed(body.warned.warned_ahead, 1)),
        ]
    return table_of(columns, bodies)


def _of(whole: int, missing: int) -> str:
    return f"{whole - missing:,} of {whole:,}" if whole else NONE


def truth_sentences(truth: Truth) -> list[str]:
    """How the predictions compare with the true impacts of the bag, one sentence each."""
    found = truth.touchdowns - truth.missed
    touchdowns, alarms = counted(truth.touchdowns, "touchdown"), counted(truth.false, "false alarm")
    said = [f"Against the truth in the bag: {found:,} of {touchdowns} found, {alarms}"]
    if truth.mode_accuracy is not None:
        said.append(
            f"Of those found, {percent(truth.mode_accuracy)} % have the right mode; the velocities after them are "
            f"within {percent(truth.median_velocity_error)} % of the true ones in the median"
        )
    if truth.median_time_error is not None:
        ahead = f"{1e3 * LEAD_TIMES[0]:.0f} ms ahead"
        said.append(f"The time predicted {ahead} is {duration(truth.median_time_error)} wrong in the median")
    if truth.unresolved:
        said.append(
            f"{counted(truth.unresolved, 'more impact')} cannot be seen at this rate of samples: too soon after the "
            "one before, or too slow"
        )
    return [f"{sentence}." for sentence in said]


def _warnings(warned: Sequence[Warned]) -> list[str]:
    events, stood = sum(one.events for one in warned), sum(one.events_warned for one in warned)
    answers = [one.before_first_impact for one in warned if one.before_first_impact is not None]
    of = f"{sum(answers):,} of {len(answers):,} bodies"
    first = f", and before the first slide or impact of {of}" if answers else ""
    return [f"A warning stood before {stood:,} of {counted(events, 'event')}{first}."] if events else []


def _costs(result: Result) -> list[str]:
    """What a sample costs, and what was refused."""
    said = []
    if result.samples:
        cost, rate = result.seconds / result.samples * 1e6, result.samples / result.seconds
        samples = counted(result.samples, "sample")
        said = [f"{samples} at {cost:.0f} us each, {rate:,.0f} per second, with reading and writing."]
    refused: dict[str, Counter[Status]] = defaultdict(Counter)
    for name, counts in result.inputs.items():
        refused[name if name.startswith("support/") else name.rpartition("/")[2]].update(counts)
    for name, all_counts in refused.items():
        del all_counts[Status.ACCEPTED]
        faults = [f"{count:,} {TOO_EARLY.get(one, words(one.name))}" for one, count in all_counts.items()]
        said += [f"Refused messages of {name}: {', '.join(faults)}."] if faults else []
    return said
