"""Landings of the feet of machines that walk: how well they were predicted, and what their impacts do to the body."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from math import hypot
from statistics import median
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rich.table import Table

from ..mechanics.types import Mode, Twist
from ..prediction.types import Landing, Score, Touchdown
from ..scenarios.comparison import LEAD_TIMES
from ..wording import NONE, counted, fixed
from .table import Column, first_stamp, table_of

if TYPE_CHECKING:
    from ..bags.run import Settled


NOISY: Final = "a foot came down too suddenly, or the noise of base and feet hides how it comes down"


class LandingRow(NamedTuple):
    """A foot that has landed, as it is shown; SI units.

    `foot` with the part of it that has landed, where not all of it did at once; `second` where another part stood
    already. `stamp` in ns, when it came to stand, as its motion shows; `announced` how long before in s the first
    prediction was made, None where there was none; the errors of the times that were predicted `LEAD_TIMES` before,
    None where nothing was yet; `mode` of the last prediction; `speed` of the foot in its last sample in the air, and
    what it makes with that speed: the `impulse` at the foot, that at the `others`, which stand or land together with
    it, and the change of the mass centre's `velocity` in the impact plane by both; `late` in s after the plan,
    `confirmed` by a force sensor, None without one.
    """

    body: str
    foot: str
    stamp: int
    second: bool
    announced: float | None
    time_errors: tuple[float | None, ...]
    mode: Mode
    speed: float | None
    impulse: float | None
    others: float | None
    velocity: float | None
    late: float | None
    confirmed: bool | None


def landings_of(settled: Iterable[Settled]) -> list[LandingRow]:
    """The landings among touchdowns that have happened, in the order of their stamps."""
    found = [landing_row(body, score) for body, score, _ in settled if score.landing is not None]
    return sorted(found, key=lambda one: one.stamp)


def landing_row(body: str, score: Score) -> LandingRow:
    """The row of a score of a foot that has landed."""
    touchdown, landing = score.touchdown, score.landing
    assert landing is not None
    impact = landing.impact
    return LandingRow(
        body=body,
        foot=f"{landing.foot} {landing.point or ''}".rstrip(),
        stamp=landing.stamp,
        second=landing.point is not None and any(one // 2 == touchdown.new[0] // 2 for one in touchdown.old),
        announced=landing.history[0][0] if landing.history else None,
        time_errors=tuple(error_ahead(landing, lead_time) for lead_time in LEAD_TIMES),
        mode=touchdown.mode,
        speed=landing.speed,
        impulse=None if impact is None else hypot(*impact.impulses[1]),
        others=None if impact is None or not impact.old else hypot(*impact.impulses[0]),
        velocity=None if impact is None else hypot(*change_by(impact)[:2]),
        late=landing.late,
        confirmed=landing.confirmed,
    )


def change_by(touchdown: Touchdown) -> Twist:
    """The change of the twist of the mass centre by an impact, in its plane."""
    after, before = touchdown.after, touchdown.before
    return Twist(after.vx - before.vx, after.vy - before.vy, after.omega - before.omega)


def error_ahead(landing: Landing, lead_time: float) -> float | None:
    """Error in s of the time predicted a lead time (s) before a landing, or last before that; None if none was."""
    made = [error for ahead, error in landing.history if ahead >= lead_time]
    return made[-1] if made else None


def landings_table(landings: Sequence[LandingRow], width: int) -> Table:
    """One row for each landing, for a terminal that is `width` characters wide."""
    start, names = first_stamp(one.stamp for one in landings), _names(landings)
    columns = [
        Column("since\nfirst\ns" if start else "time\ns", lambda one: fixed((one.stamp - start) / 1e9, 3)),
        Column("foot", lambda one: names[one.body, one.foot], left=True),
        Column("first\nms\nahead", lambda one: _ms(one.announced, 0)),
        Column(
            tuple(f"error\nms, at\n{1e3 * one:.0f} ms" for one in LEAD_TIMES),
            lambda one: tuple(_ms(error, 1, "+") for error in one.time_errors),
            "\n".join(["error", *[f"{1e3 * one:.0f} ms" for one in LEAD_TIMES]]),
        ),
        Column("predicted\nmode", lambda one: one.mode.name, left=True),
        Column("foot's\nspeed\nm/s", lambda one: fixed(one.speed, 3)),
        Column(
            ("foot's\nimpulse\nN s", "others'\nimpulse\nN s"),
            lambda one: (fixed(one.impulse, 2), fixed(one.others, 2)),
            "N s at\nfoot\nothers",
        ),
        Column("body's\nchange\nm/s", lambda one: fixed(one.velocity, 3)),
    ]
    if _any_known(landings, "late"):
        columns.append(Column("late\nms", lambda one: _ms(one.late, 1, "+")))
    if _any_known(landings, "confirmed"):
        columns.append(Column("force\nagrees", lambda one: {True: "yes", False: "no", None: NONE}[one.confirmed]))
    return table_of(columns, landings, width)


def feet_table(landings: Sequence[LandingRow]) -> Table:
    """One row for each foot, and one for all: the least time ahead of a first prediction, medians of times, and the
    greatest of what an impact does.
    """
    names = _names(landings)
    rows = [
        (name, [one for one in landings if (one.body, one.foot) == (body, foot)])
        for (body, foot), name in names.items()
    ]
    columns = [
        Column("foot", lambda row: row[0], left=True),
        Column("landings", lambda row: f"{len(row[1]):,}"),
        Column("first\nms\nahead", lambda row: _ms(_of(row[1], "announced", min), 0)),
        *[Column(f"error\nms, at\n{1e3 * one:.0f} ms", _median_error(k)) for k, one in enumerate(LEAD_TIMES)],
        Column("most\nspeed\nm/s", lambda row: fixed(_of(row[1], "speed", max), 3)),
        Column("most\nimpulse\nN s", lambda row: fixed(_of(row[1], "impulse", max), 2)),
        Column("most\nchange\nm/s", lambda row: fixed(_of(row[1], "velocity", max), 3)),
    ]
    if _any_known(landings, "late"):
        columns.append(Column("late\nms", lambda row: _ms(_of(row[1], "late", median), 1, "+")))
    if _any_known(landings, "confirmed"):
        columns.append(Column("force\nagrees", _agreeing))
    every = [("all", list(landings))] if len(names) > 1 else []
    return table_of(columns, [*rows, *every], style=lambda row: "bold" if row[0] == "all" else "")


def _ms(seconds: float | None, decimals: int, sign: str = "") -> str:
    return fixed(None if seconds is None else 1e3 * seconds, decimals, sign)


def _names(landings: Sequence[LandingRow]) -> dict[tuple[str, str], str]:
    """What the feet are called, in the order in which they landed first: with their bodies where there are several."""
    feet = dict.fromkeys((one.body, one.foot) for one in landings)
    several = len({body for body, _ in feet}) > 1
    return {(body, foot): f"{body}/{foot}" if several else foot for body, foot in feet}


def _any_known(landings: Sequence[LandingRow], field: str) -> bool:
    return any(getattr(one, field) is not None for one in landings)


def _of(landings: Sequence[LandingRow], field: str, take: Callable[[list[float]], float]) -> float | None:
    """One number for a field of some landings, of those that know it."""
    known = [value for one in landings if (value := getattr(one, field)) is not None]
    return take(known) if known else None


def _median_error(k: int) -> Callable[[Any], str]:
    def cell(row: tuple[str, list[LandingRow]]) -> str:
        errors = [abs(error) for one in row[1] if (error := one.time_errors[k]) is not None]
        return _ms(median(errors) if errors else None, 1)

    return cell


def _agreeing(row: tuple[str, list[LandingRow]]) -> str:
    felt = [one.confirmed for one in row[1] if one.confirmed is not None]
    return f"{sum(felt):,}/{len(felt):,}" if felt else NONE


class LandingTally:
    """Landings of feet: how long before they were predicted, their modes, speeds and impulses."""

    def __init__(self) -> None:
        """Begin with none."""
        self._firsts = self._seconds = self._missing = 0
        self._feet: set[tuple[str, str]] = set()
        self._least: float | None = None
        self._modes: Counter[Mode] = Counter()
        self._speeds, self._late = array("d"), array("d")
        self._impulse = self._change = 0.0

    def add(self, landing: LandingRow) -> None:
        """Count a landing."""
        self._modes[landing.mode] += 1
        if landing.second:
            self._seconds += 1
        else:
            self._firsts += 1
            self._feet.add((landing.body, landing.foot.split()[0]))
            if landing.announced is None:
                self._missing += 1
            else:
                self._least = landing.announced if self._least is None else min(self._least, landing.announced)
        if landing.speed is not None:
            self._speeds.append(landing.speed)
            self._impulse = max(self._impulse, landing.impulse or 0.0)
            self._change = max(self._change, landing.velocity or 0.0)
        if landing.late is not None:
            self._late.append(landing.late)

    def sentences(self) -> list[str]:
        """What they say, one sentence each."""
        if not self._modes:
            return []
        modes = ", ".join(f"{self._modes[mode]:,} {mode.name}" for mode in sorted(self._modes))
        braked = ": every foot brakes to rest as it reaches the ground" if set(self._modes) == {Mode.NO_IMPACT} else ""
        said = [*self._announced(), f"Predicted modes: {modes}{braked}"]
        if self._speeds:
            said.append(
                f"Speeds are those of the last sample in the air, {median(self._speeds):.3f} m/s in the median, "
                f"at most {max(self._speeds):.3f} m/s; impulses are those of an impact with that speed, as if the foot "
                f"braked no more: at most {self._impulse:.2f} N s. By that and by what the others get, which stand "
                f"or land together with it, the body's velocity changes by at most {self._change:.3f} m/s"
            )
        if self._late:
            said.append(
                f"Against the plan {counted(len(self._late), 'landing')} came {median(self._late) * 1e3:+.1f} ms late "
                f"in the median, from {min(self._late) * 1e3:+.1f} to {max(self._late) * 1e3:+.1f} ms"
            )
        return [f"{sentence}." for sentence in said]

    def _announced(self) -> list[str]:
        """How long before they were predicted, without the point."""
        feet = "1 foot" if len(self._feet) == 1 else f"{len(self._feet)} feet"
        there = f"{counted(self._firsts, 'landing')} of {feet}"
        more = f"{counted(self._seconds, 'second contact')} of feet that stood already"
        besides = f", besides {more}" if self._seconds else ""
        if self._least is None:
            return [f"{there}, none of them predicted{besides}: {NOISY}"]
        who = "each" if not self._missing else f"{self._firsts - self._missing:,} of them"
        when = f"{who} predicted {self._least * 1e3:.0f} ms ahead or earlier{besides}"
        said = [f"{there}, {when}; errors are of that time, by when the foot's motion ends"]
        if self._missing:
            landings = "1 landing was" if self._missing == 1 else f"{self._missing:,} landings were"
            said.append(f"{landings} not predicted: {NOISY}")
        return said
