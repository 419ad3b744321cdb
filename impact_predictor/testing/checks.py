"""What is checked of a replayed run, each of its touchdowns and the run as a whole, and against which tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from math import inf
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import InputError
from ..mechanics.types import Twist
from ..report.summary import errors_of, reasons
from ..report.table import first_stamp
from ..report.touchdowns import TouchdownRow, error_ahead, row_of, rows_of
from ..wording import counted, percent, words

if TYPE_CHECKING:
    from ..bags.replay import Result, Settled
    from ..prediction.types import Landing
    from ..report.baseline import Earlier
    from ..scenarios.comparison import Truth

AHEAD = 0.02
"""Seconds before a landing at which the prediction is made whose error of time counts."""

MOST_LISTED = 20
"""Changes against a baseline that are listed."""


class Range(NamedTuple):
    """A range of whole numbers, both ends included."""

    first: int
    last: float = inf

    def __str__(self) -> str:
        if self.last == self.first:
            return str(self.first)
        return f"{self.first}.." if self.last == inf else f"{self.first}..{self.last}"


class Tolerances(NamedTuple):
    """What is still right. Errors are fractions of 1 of the velocity before an impact, times are in s."""

    error: float
    median_error: float
    time_error: float
    mode_accuracy: float
    missed: int
    false: int
    touchdowns: Range


def read_tolerances(texts: Mapping[str, str]) -> Tolerances:
    """The tolerances that are given as texts by their names.

    Raises:
        InputError: a text is not a number that this tolerance can be.
    """
    found: dict[str, Any] = {name: _tolerance(name, texts[name]) for name in Tolerances._fields}
    return Tolerances(**found)


def _tolerance(name: str, text: str) -> float | Range:
    if name == "touchdowns":
        wanted = "12, 10..14, or 10.. for at least 10"
        first, dots, last = text.partition("..")
        if first.isdecimal() and (last.isdecimal() or not last):
            end = int(last) if last else inf if dots else int(first)
            if int(first) <= end:
                return Range(int(first), end)
    elif name in ("missed", "false"):
        wanted = "a whole number, as in 0"
        if text.isdecimal():
            return int(text)
    else:
        wanted = "a number that is not negative, as in 0.5"
        with suppress(ValueError):
            if float(text) >= 0.0:
                return float(text)
    raise InputError(f"impact_{name} is {text!r}; give {wanted}")


class Check(NamedTuple):
    """A check and how it ended: `flaw` says what is wrong, `skipped` why it cannot be judged; else it has passed.

    `figures` were measured, by their names.
    """

    name: str
    flaw: str = ""
    skipped: str = ""
    figures: Mapping[str, float] = {}


def checks_of(result: Result, tolerances: Tolerances) -> list[Check]:
    """All checks of a run but that against a baseline; first those of the run, then one for each touchdown."""
    return [*_run_checks(result, tolerances), *_touchdowns(result, tolerances)]


def _run_checks(result: Result, tolerances: Tolerances) -> Iterator[Check]:
    yield Check("samples", result.unpredictable or result.damaged, figures={"samples": result.samples})
    number, wanted = len(result.settled), tolerances.touchdowns
    flaw = (
        ""
        if wanted.first <= number <= wanted.last
        else f"{counted(number, 'touchdown')}, not {wanted} (impact_touchdowns)"
    )
    yield Check("number of touchdowns", flaw, figures={"touchdowns": number})
    rows = [row for row in rows_of(result.settled) if not row.foot]
    median = errors_of(rows).p50
    if median is not None:
        yield _at_most("median error", median, tolerances.median_error, "median_error")
    elif rows:
        why = ", ".join(f"{count:,} {words(reason)}" for reason, count in reasons(rows).items())
        yield Check("median error", skipped=f"no touchdown is scored: {why}")
    if result.truth is not None:
        yield from _truth_checks(result.truth, tolerances)


def _truth_checks(truth: Truth, tolerances: Tolerances) -> Iterator[Check]:
    missed = f"{truth.missed:,} of {counted(truth.touchdowns, 'true touchdown')} missed"
    yield _limited("missed touchdowns", "missed", truth.missed, tolerances.missed, missed)
    yield _limited("false alarms", "false", truth.false, tolerances.false, counted(truth.false, "false alarm"))
    if truth.clear_mode_accuracy is not None:
        accuracy, least = truth.clear_mode_accuracy, tolerances.mode_accuracy
        of = f"of {counted(truth.clear, 'clear mode')}"
        flaw = f"{percent(accuracy)} % {of} are right, less than {percent(least)} % (impact_mode_accuracy)"
        yield Check("modes", flaw if accuracy < least else "", figures={"mode_accuracy": accuracy})
    if truth.median_velocity_error is not None:
        name = "median error against the truth"
        yield _at_most(name, truth.median_velocity_error, tolerances.median_error, "median_error")
    if truth.median_time_error is not None:
        wrong, most = truth.median_time_error, tolerances.time_error
        said = f"the times told 20 ms ahead are {wrong * 1e3:.3g} ms wrong in the median"
        yield _limited("median error of time", "time_error", wrong, most, said, f"{most * 1e3:.3g} ms")


def _at_most(name: str, error: float, most: float, key: str, said: str = "", more: str = "") -> Check:
    """A check of a relative error, said to be that of its name, with `more` lines where it is too great."""
    check = _limited(name, key, error, most, f"the {said or name} is {percent(error)} %", f"{percent(most)} %")
    return check._replace(flaw=check.flaw and check.flaw + more, figures={"relative_error": error})


def _limited(name: str, key: str, value: float, most: float, said: str, limit: str = "") -> Check:
    """A check of a value that has a greatest one, by the setting of that one."""
    flaw = f"{said}, more than {limit or most} (impact_{key})" if value > most else ""
    return Check(name, flaw, figures={key: value})


def _touchdowns(result: Result, tolerances: Tolerances) -> Iterator[Check]:
    """A check for each touchdown, numbered in the order of time; times are those of the tables of `replay`."""
    settled = sorted(result.settled, key=lambda one: one.score.stamp)
    rows = [row_of(*one) for one in settled]
    start = first_stamp(row.stamp for row in rows)
    several = len({one.body for one in settled}) > 1
    for number, (one, row) in enumerate(zip(settled, rows, strict=True), 1):
        landing = one.score.landing
        who = " ".join([*([one.body] if several else []), *([] if landing is None else [landing.foot])])
        name = f"touchdown {number} at {(row.stamp - start) / 1e9:.2f} s" + (f" ({who})" if who else "")
        if landing is None:
            yield _impact_check(name, row, tolerances.error)
        else:
            yield _landing_check(name, one, landing, tolerances.time_error)


def _impact_check(name: str, row: TouchdownRow, tolerance: float) -> Check:
    error = row.relative_error
    if not row.scored or error is None:
        return Check(name, skipped=f"not scored: {', '.join(map(words, reasons([row])))}")
    return _at_most(name, error, tolerance, "error", "error", f"\n{_velocities(row)}")


def _velocities(row: TouchdownRow) -> str:
    """What was predicted and what was measured, line by line."""
    last, first = 1e3 * row.lead_time, 1e3 * row.announced_lead_time
    lines = [
        f"{row.mode.name} was predicted {last:.1f} ms ahead, first {first:.1f} ms ahead",
        f"{'':12}{'vx m/s':>10}{'vy m/s':>10}{'omega rad/s':>13}",
    ]
    twists = {
        "before": row.before_twist,
        "predicted": row.predicted_twist,
        "measured": row.measured_twist or Twist(0.0, 0.0, 0.0),
    }
    lines += [f"{name:12}{vx:10.4f}{vy:10.4f}{omega:13.3f}" for name, (vx, vy, omega) in twists.items()]
    if row.flags:
        lines.append(f"flags: {', '.join(map(words, row.flags))}")
    return "\n".join(lines)


def _landing_check(name: str, settled: Settled, landing: Landing, tolerance: float) -> Check:
    error, told = error_ahead(landing.history, AHEAD), f"{AHEAD * 1e3:.0f} ms ahead"
    if error is None:
        history = landing.history
        first = f"the first time was told {history[0][0] * 1e3:.1f} ms ahead" if history else "nor later"
        return Check(name, f"no time was told {told} of {landing.foot}'s landing, {first}")
    if abs(error) <= tolerance:
        return Check(name, figures={"time_error": error})
    at, side = landing.stamp, "late" if error > 0.0 else "early"
    said = f"the time told {told} was {abs(error) * 1e3:.1f} ms too {side}"
    lines = [
        f"{said}, more than {tolerance * 1e3:.3g} ms (impact_time_error)",
        f"{settled.score.touchdown.mode.name} predicted; by its motion {landing.foot} stood at {at / 1e9:.4f} s",
    ]
    for ahead, wrong in (landing.history[0], landing.history[-1]):
        lines.append(f"told {ahead * 1e3:5.1f} ms ahead: {at / 1e9 + wrong:.4f} s, {wrong * 1e3:+.1f} ms")
    return Check(name, "\n".join(lines), figures={"time_error": error})


def baseline_check(result: Result, earlier: Earlier, name: str | PathLike[str] = "") -> Check:
    """Whether a run is as an earlier one, which may be of several bags; `name` tells its bag from the others."""
    from ..report.baseline import compare_runs, concluded, sentences

    try:
        compared = compare_runs(earlier.touchdowns_of(result.bag, name), rows_of(result.settled))
    except InputError as error:
        return Check("baseline", str(error))
    if not compared.changes:
        return Check("baseline")
    lines = [concluded(compared, earlier.path), *sentences(compared)[:MOST_LISTED]]
    more = len(compared.changes) - MOST_LISTED
    lines += [f"and {more:,} more"] if more > 0 else []
    return Check("baseline", "\n".join(lines), figures={"changes": len(compared.changes)})
