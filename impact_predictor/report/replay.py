"""What a replay prints: bodies, touchdowns, landings, errors, the comparison with the truth, and what it cost."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from functools import partial
from math import hypot
from typing import TYPE_CHECKING, Final

from rich.console import Console
from rich.table import Table

from ..mechanics.types import Flag
from ..prediction.scene import STATES
from ..prediction.types import Status
from ..scenarios.comparison import LEAD_TIMES, Truth, Warned
from ..stamps import NANOSECONDS
from ..wording import NONE, counted, duration, fixed, percent, words
from .skill import skill_tables
from .summary import SpanErrors, Tally, errors_of, velocity_errors_ahead
from .table import MOST_ROWS, Column, first_stamp, more, say, show, table_of
from .touchdowns import TouchdownRow, rows_of
from .watch import unit_as_json, warned_of

if TYPE_CHECKING:
    from ..bags.replay import Result

MOST_OF_A_KIND: Final = 4
"""Touchdowns of each kind that are listed unless all are asked for."""

CHOSEN: Final = "listed are the first of each kind that are scored"

TWO_LINES: Final = (
    "Of each touchdown the upper line is what was predicted last, the lower one what was measured: the speed of the "
    "mass centre, its part upwards, the rate of turning, and whether the contacts rise by what a record can show. The "
    "upper error is that of the whole twist, the lower one that in the impact plane."
)

MEASURED_LATER: Final = (
    "A whole twist is told as it is when it is measured, some samples after the touchdown, as no sample shows it right "
    "after that; one in the impact plane, and its error, right after it: even that of an exact simulation has in it "
    "what gravity changes meanwhile."
)
LANDING_SAID: Final = (
    "Of each landing: when it was first announced, the error of the time announced "
    f"{1e3 * LEAD_TIMES[0]:.0f} ms ahead, and what an impact would be with the speed that the foot had in its last "
    "sample in the air: its mode, the impulse of the foot, below it that of the other feet, and the change of the "
    "body's velocity. A foot that brakes until it lands gives less; NO_IMPACT is then announced."
)


def print_replay(console: Console, result: Result, every: bool = False) -> None:
    """Print the touchdowns (the first scored ones, or `every` one), the errors and what became of the samples."""
    rows = rows_of(result.settled)
    landings, others = [row for row in rows if row.foot], [row for row in rows if not row.foot]
    errors = velocity_errors_ahead(result.settled)
    say(console, result.bag)
    if (bodies := bodies_table(result, rows)) is not None:
        _show(console, bodies)
    if landings:
        say(console, LANDING_SAID)
        listed = landings if every else landings[:MOST_ROWS]
        _show(console, landings_table(listed), *more(len(landings) - len(listed), "landing"))
    if listed := others if every else of_each_kind(others):
        say(console, TWO_LINES)
        left = more(len(others) - len(listed), "touchdown", f"{CHOSEN}; list them with --all, or read them with --json")
        _show(console, touchdown_table(listed), *left, MEASURED_LATER)
    for sentence, columns, scores in skill_tables(others, result.recorded):
        say(console, sentence)
        _show(console, table_of(columns, scores))
    if any(one.errors.number for one in errors):
        _show(console, lead_time_table(errors))
    say(console, *sentences_of(result))
    say(console, *_costs(result))


def sentences_of(result: Result) -> list[str]:
    """What a replay found, all together: touchdowns and landings, the truth, and events that were warned of."""
    said = Tally(rows_of(result.settled)).sentences()
    if result.truth is not None:
        said += truth_sentences(result.truth)
    warned = [one.warned for one in result.truths.values() if one.warned is not None]
    if (log := result.watch) is not None:
        found, more_said = warned_of(unit_as_json(log, place) for place in range(len(log.names)))
        said.append(f"Events warned of: {found}; {more_said}.")
    elif events := sum(one.events for one in warned):
        stood = sum(one.events_warned for one in warned)
        said.append(f"A warning stood before {stood:,} of {counted(events, 'event')}.")
    return said


def _show(console: Console, table: Table, *remarks: str) -> None:
    """Print a table, remarks on it and an empty line."""
    show(console, table)
    say(console, *remarks, "")


def of_each_kind(rows: Iterable[TouchdownRow]) -> list[TouchdownRow]:
    """The first scored touchdowns of each kind."""
    kinds = Counter[str]()
    listed = []
    for row in rows:
        if row.is_scored and kinds[row.kind] < MOST_OF_A_KIND:
            kinds[row.kind] += 1
            listed.append(row)
    return listed


def touchdown_table(rows: Sequence[TouchdownRow]) -> Table:
    """The touchdowns with what was predicted of each, and below it what was measured."""
    columns = [
        _when(rows),
        Column("ahead\nfirst\nlast ms", lambda row: f"{_ms(row.ahead)}\n{_ms(row.lead_time)}"),
        Column("kind,\npredicted\nmode", lambda row: f"{row.kind}\n{row.mode.name}", left=True),
        Column("speed\nm/s", partial(_velocity, 0)),
        Column("up\nm/s", partial(_velocity, 1)),
        Column("turns\nrad/s", partial(_velocity, 2)),
        Column("old\nlifts", partial(_lift, "lift_old"), optional=True),
        Column("new\nlifts", partial(_lift, "lift_new"), optional=True),
        Column("error\n%, in\nplane", lambda row: f"{percent(row.error_6d)}\n{percent(row.error)}"),
        Column("cost\nus", lambda row: fixed(row.cost and 1e6 * row.cost, 0), optional=True),
        Column("notes", _notes, left=True, fold=11, optional=True),
    ]
    return table_of(columns, rows, lambda row: "" if row.is_scored else "dim")


def _when(rows: Sequence[TouchdownRow]) -> Column:
    """The column of times, with bodies where there are several."""
    start, several = first_stamp(row.stamp for row in rows), len({row.body for row in rows}) > 1
    header = "since\nfirst\ns" if start else "time\ns"
    if several:
        return Column(f"body\n{header}", lambda row: f"{row.body}\n{(row.stamp - start) / NANOSECONDS:.3f}")
    return Column(header, lambda row: f"{(row.stamp - start) / NANOSECONDS:.3f}")


def _ms(seconds: float | None, decimals: int = 1, sign: str = "") -> str:
    return fixed(None if seconds is None else 1e3 * seconds, decimals, sign)


def _velocity(which: int, row: TouchdownRow) -> str:
    """Speed of the mass centre, its part along the normal, or the angular speed: predicted and measured."""
    texts = []
    for whole, planar in ((row.predicted_twist_6d, row.predicted_twist), (row.measured_twist_6d, row.measured_twist)):
        speeds = (hypot(*whole[:3]), whole[2], hypot(*whole[3:])) if whole else None
        if speeds is None and planar is not None:
            speeds = hypot(planar.vx, planar.vy), planar.vy, abs(planar.omega)
        texts.append(fixed(speeds and speeds[which], 3 if which < 2 else 2))
    return "\n".join(texts)


def _lift(key: str, row: TouchdownRow) -> str:
    lift = getattr(row, key)
    return NONE if lift is None else "\n".join("yes" if lifts else "no" for lifts in lift[:2])


def _notes(row: TouchdownRow) -> str:
    flags = [flag for flag in row.flags if flag in Flag.__members__]
    if row.is_scored:
        return ", ".join(map(words, flags))
    return f"not scored: {', '.join(map(words, (*row.why_not_scored, *flags)))}"


def lead_time_table(errors: Sequence[SpanErrors]) -> Table:
    """The error against the time before the touchdown at which a prediction was made."""
    columns = [
        Column("before touchdown\nms", lambda one: f"{one.begin * 1e3:.0f} to {one.end * 1e3:.0f}"),
        Column("predictions\n", lambda one: str(one.errors.number)),
        Column("error in the plane:\nmedian %", lambda one: percent(one.errors.p50)),
        Column("90 % of them\nare below, %", lambda one: percent(one.errors.p90)),
    ]
    return table_of(columns, errors)


def landings_table(landings: Sequence[TouchdownRow]) -> Table:
    """One row for each landing; below the impulse of the foot that of the others, if they get any."""
    bounds = sorted({row.bound.replace(" ", "\n") for row in landings if row.bound})
    columns = [
        _when(landings),
        Column("foot", lambda row: f"{row.foot} {row.point or ''}".rstrip(), left=True),
        Column("first\nms\nahead", lambda row: _ms(row.ahead, 0)),
        Column(f"error\nms, at\n{1e3 * LEAD_TIMES[0]:.0f} ms", lambda row: _ms(row.time_errors[0], 1, "+")),
        Column("speed\nm/s", lambda row: fixed(row.landing_speed, 3)),
        Column("mode\nat that\nspeed", lambda row: row.landing_mode.name if row.landing_mode else NONE, left=True),
        Column("\n".join(["impulse\nN s", *bounds]), _impulses),
        Column("body's\nchange\nm/s", lambda row: fixed(row.velocity_change and hypot(*row.velocity_change[:2]), 3)),
        Column("late\nms", lambda row: _ms(row.late, 1, "+"), optional=True),
        Column("force\nagrees", lambda row: {True: "yes", False: "no"}.get(row.confirmed, NONE), optional=True),
    ]
    return table_of(columns, landings)


def _impulses(row: TouchdownRow) -> str:
    others = [row.others_impulse] if any(row.others_impulse or ()) else []
    return "\n".join(fixed(impulse and hypot(*impulse), 2) for impulse in (row.impulse, *others))


def bodies_table(result: Result, rows: Sequence[TouchdownRow]) -> Table | None:
    """One row for each body: its samples, and how its predictions compare with the truth, or else with the samples.

    None where the only one has no name.
    """
    samples: Counter[str] = Counter()
    for name, counts in result.inputs.items():
        body, _, kind = name.rpartition("/")
        samples[body] += sum(counts.values()) if kind in STATES else 0
    del samples["support"]
    bodies = [*dict.fromkeys([*samples, *result.truths])]
    if not bodies or "" in bodies:
        return None
    mine = {body: [row for row in rows if row.body == body] for body in bodies}
    truths = defaultdict(Truth, {body: one.truth for body, one in result.truths.items() if one.truth})
    warned = defaultdict(Warned, {body: one.warned for body, one in result.truths.items() if one.warned})
    columns = [Column("body", str, left=True), Column("samples", lambda body: f"{samples[body]:,}")]
    if result.truth is not None:
        columns += [
            Column("touchdowns\nfound", lambda body: _of(truths[body].found, truths[body].touchdowns), fold=10),
            Column("false\nalarms", lambda body: f"{truths[body].false:,}"),
            Column("right\nmode %", lambda body: percent(truths[body].mode_accuracy)),
            Column("speed\nerror %", lambda body: percent(truths[body].median_velocity_error)),
        ]
    else:
        columns += [
            Column(
                "touchdowns\nscored",
                lambda body: _of(sum(row.is_scored for row in mine[body]), len(mine[body])),
                fold=10,
            ),
            Column("median\nerror %", lambda body: percent(errors_of(mine[body]).p50)),
        ]
    columns += [
        Column("events\nwarned of", lambda body: _of(warned[body].events_warned, warned[body].events), optional=True),
        Column("first\ns ahead", lambda body: fixed(warned[body].warned_ahead, 1), optional=True),
    ]
    return table_of(columns, bodies)


def _of(part: int, whole: int) -> str:
    return f"{part:,} of {whole:,}" if whole else NONE


def truth_sentences(truth: Truth) -> list[str]:
    """How the predictions compare with the true impacts of the bag, one sentence each."""
    touchdowns, alarms = counted(truth.touchdowns, "touchdown"), counted(truth.false, "false alarm")
    said = [f"Against the truth in the bag: {truth.found:,} of {touchdowns} found, {alarms}."]
    if truth.mode_accuracy is not None:
        within = f"within {percent(truth.median_velocity_error)} % of the true ones in the median"
        right = f"{percent(truth.mode_accuracy)} % have the right mode"
        said.append(f"Of those found, {right}; the velocities after them are {within}.")
    if truth.median_time_error is not None:
        ahead = f"{1e3 * LEAD_TIMES[0]:.0f} ms ahead"
        wrong = f"{duration(truth.median_time_error)} wrong in the median"
        said.append(f"Against the truth in the bag, the time predicted {ahead} is {wrong}.")
    if truth.unresolved:
        hidden = counted(truth.unresolved, "more impact")
        why = "too soon after the one before, or too slow"
        said.append(f"{hidden} of the truth cannot be seen at this rate of samples and do not count: {why}.")
    return said


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
        faults = [f"{count:,} {words(one.name)}" for one, count in all_counts.items()]
        said += [f"Refused messages of {name}: {', '.join(faults)}."] if faults else []
    return said
