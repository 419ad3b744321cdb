"""Landings of the feet of machines that walk: how well they were foretold, and what their impacts do to the body."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot
from statistics import median
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rich.console import JustifyMethod
from rich.table import Table

from ..mechanics.types import Mode, Twist
from ..prediction.types import Landing, Score, Touchdown
from ..scenarios.comparison import LEAD_TIMES
from .table import NONE, first_stamp, least_width, plain_table

if TYPE_CHECKING:
    from ..bags.stream import Settled

IMPULSES: Final = ("foot's\nimpulse\nN s", "others'\nimpulse\nN s")
ERRORS: Final = ("error\nms, told\n20 ms", "error\nms, told\n50 ms")


class Landed(NamedTuple):
    """A foot that has landed, as it is shown; SI units.

    `foot` with the part of it that has landed, where not all of it did at once; `second` where another part stood
    already. `stamp` in ns, when it came to stand, as its motion shows; `announced` how long before in s the first
    prediction was made, None where there was none; the errors of the times that were told `LEAD_TIMES` before, None
    where nothing was told yet; `mode` of the last prediction; `speed` of the foot in its last sample in the air, and
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


def landings_of(settled: Iterable[Settled]) -> list[Landed]:
    """The landings among touchdowns that have happened, in the order of their stamps."""
    found = [_landed(body, score, score.landing) for body, score, _ in settled if score.landing is not None]
    return sorted(found, key=lambda one: one.stamp)


def _landed(body: str, score: Score, landing: Landing) -> Landed:
    touchdown = score.touchdown
    return Landed(
        body,
        f"{landing.foot} {landing.point or ''}".rstrip(),
        landing.stamp,
        landing.point is not None and any(one // 2 == touchdown.new[0] // 2 for one in touchdown.old),
        landing.history[0][0] if landing.history else None,
        tuple(error_ahead(landing, lead_time) for lead_time in LEAD_TIMES),
        touchdown.mode,
        landing.speed,
        None if landing.impact is None else hypot(*landing.impact.impulses[1]),
        None if landing.impact is None or not landing.impact.old else hypot(*landing.impact.impulses[0]),
        None if landing.impact is None else hypot(*change_by(landing.impact)[:2]),
        landing.late,
        landing.confirmed,
    )


def change_by(touchdown: Touchdown) -> Twist:
    """The change of the twist of the mass centre by an impact, in its plane."""
    after, before = touchdown.after, touchdown.before
    return Twist(after.vx - before.vx, after.vy - before.vy, after.omega - before.omega)


def error_ahead(landing: Landing, lead_time: float) -> float | None:
    """Error in s of the time that was told a lead time (s) before a landing, or last before that; None if none was."""
    told = [error for ahead, error in landing.history if ahead >= lead_time]
    return told[-1] if told else None


def landing_as_json(landing: Landing) -> dict[str, Any]:
    """What the JSON of a touchdown says of the landing of a foot; SI units."""
    impact = landing.impact
    return {
        "foot": landing.foot,
        "point": landing.point,
        "late": landing.late,
        "confirmed": landing.confirmed,
        "time_error": landing.history[-1][1] if landing.history else None,
        "landing_speed": landing.speed,
        "landing_mode": None if impact is None else impact.mode.name,
        "impulse": None if impact is None else impact.impulses[1],
        "others_impulse": None if impact is None or not impact.old else impact.impulses[0],
        "velocity_change": None if impact is None else change_by(impact),
    }


def landings_table(landings: Sequence[Landed], width: int) -> Table:
    """One row for each landing; both errors of time, and the impulses at the foot and at the others, are beside each
    other, or in two lines where that is too wide.

    `width` is that of the terminal in characters.
    """
    beside = _landings_table(landings, stacked=False)
    return beside if least_width(beside) <= width else _landings_table(landings, stacked=True)


def _landings_table(landings: Sequence[Landed], stacked: bool) -> Table:
    start = first_stamp(landings)
    names = _names(landings)
    errors = ("error\n20 ms\n50 ms",) if stacked else ERRORS
    time = "since\nfirst\ns" if start else "\ntime\ns"
    headers = [time, "\n\nfoot", "told\nms\nahead", *errors, "\npredicted\nmode"]
    impulses = ("N s at\nfoot\nothers",) if stacked else IMPULSES
    table = _table([*headers, "foot's\nspeed\nm/s", *impulses, "body's\nchange\nm/s", *_headers_of_some(landings)])
    for one in landings:
        told = [_number(error, 1e3, 1, "+") for error in one.time_errors]
        struck = [_number(one.impulse, 1.0, 2), _number(one.others, 1.0, 2)]
        table.add_row(
            f"{(one.stamp - start) / 1e9:.3f}",
            names[one.body, one.foot],
            _number(one.announced, 1e3, 0),
            *(["\n".join(told)] if stacked else told),
            one.mode.name,
            _number(one.speed, 1.0, 3),
            *(["\n".join(struck)] if stacked else struck),
            _number(one.velocity, 1.0, 3),
            *([_number(one.late, 1e3, 1, "+")] if _are_planned(landings) else []),
            *(["-" if one.confirmed is None else "yes" if one.confirmed else "no"] if _are_felt(landings) else []),
        )
    return table


def feet_table(landings: Sequence[Landed]) -> Table:
    """One row for each foot, and one for all: the least time ahead of a first prediction, medians of times, and the
    greatest of what an impact does.
    """
    names = _names(landings)
    headers = ["\n\nfoot", "\n\nlandings", "told\nms\nahead", *ERRORS]
    impact = [f"most\n{header}" for header in ("speed\nm/s", "impulse\nN s", "change\nm/s")]
    table = _table([*headers, *impact, *_headers_of_some(landings)])
    for (body, foot), name in names.items():
        table.add_row(name, *_cells([one for one in landings if (one.body, one.foot) == (body, foot)], landings))
    if len(names) > 1:
        table.add_section()
        table.add_row("all", *_cells(landings, landings), style="bold")
    return table


def _table(headers: Sequence[str]) -> Table:
    table = plain_table()
    for header in headers:
        side: JustifyMethod = "left" if header.endswith(("foot", "mode")) else "right"
        # Where a table is too wide, rich narrows columns below their words; no number shall be cut off.
        table.add_column(header, justify=side, no_wrap=True, min_width=max(map(len, header.split("\n"))))
    return table


def _names(landings: Sequence[Landed]) -> dict[tuple[str, str], str]:
    """What the feet are called, in the order in which they landed first: with their bodies where there are several."""
    feet = dict.fromkeys((one.body, one.foot) for one in landings)
    several = len({body for body, _ in feet}) > 1
    return {(body, foot): f"{body}/{foot}" if several else foot for body, foot in feet}


def _headers_of_some(landings: Sequence[Landed]) -> list[str]:
    """What not every scene knows of its landings."""
    planned = ["\nlate\nms"] if _are_planned(landings) else []
    return [*planned, "\nforce\nagrees"] if _are_felt(landings) else planned


def _are_planned(landings: Sequence[Landed]) -> bool:
    return any(one.late is not None for one in landings)


def _are_felt(landings: Sequence[Landed]) -> bool:
    return any(one.confirmed is not None for one in landings)


def _cells(own: Sequence[Landed], landings: Sequence[Landed]) -> list[str]:
    """The cells of some landings in the table of all."""
    errors = [[abs(error) for one in own if (error := one.time_errors[k]) is not None] for k in range(len(LEAD_TIMES))]
    cells = [f"{len(own):,}", _number(_least(own), 1e3, 0)]
    cells += [_number(_median(some), 1e3, 1) for some in errors]
    cells.append(_number(_most(one.speed for one in own), 1.0, 3))
    cells += [_number(_most(one.impulse for one in own), 1.0, 2), _number(_most(one.velocity for one in own), 1.0, 3)]
    if _are_planned(landings):
        cells.append(_number(_median([one.late for one in own if one.late is not None]), 1e3, 1, "+"))
    if _are_felt(landings):
        felt = [one.confirmed for one in own if one.confirmed is not None]
        cells.append(f"{sum(felt):,}/{len(felt):,}" if felt else NONE)
    return cells


def _least(landings: Iterable[Landed]) -> float | None:
    """The shortest time ahead of a first prediction, in s."""
    return min((one.announced for one in landings if one.announced is not None), default=None)


def _most(numbers: Iterable[float | None]) -> float | None:
    return max((number for number in numbers if number is not None), default=None)


def _median(numbers: Sequence[float]) -> float | None:
    return median(numbers) if numbers else None


def _number(value: float | None, scale: float, digits: int, sign: str = "") -> str:
    if value is None:
        return NONE
    text = f"{value * scale:{sign}.{digits}f}"
    return text if float(text) else f"{0.0:.{digits}f}"
