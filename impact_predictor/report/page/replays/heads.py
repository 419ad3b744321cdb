"""What a replay has found, in plain words: the title of its page, and its headlines."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Final, NamedTuple

from ....scenarios.matching import NEAREST
from ....wording import counted
from ...summary import WHY, quantile
from ..words import digits, time_words
from .answers import (
    NOTHING,
    Ahead,
    Answer,
    ahead,
    announced,
    arrived,
    confusion,
    costs,
    landings_of,
    names_of,
    scored_of,
    touchdowns_of,
    uncompared,
    used,
    velocity_errors,
)
from .words import seconds_words, within

AHEAD: Final = 0.02
"""Seconds before a touchdown, from which on the errors of the times are told."""


class Headline(NamedTuple):
    """A question, its answer in a few words, and more on it."""

    term: str
    name: str
    why: str


def title_of(answers: Sequence[Answer]) -> str:
    """How many touchdowns, how early and how right, in one line."""
    found = used(answers)
    times = announced(found)
    if not times:
        number = len(touchdowns_of(found))
        return f"{counted(number, 'touchdown')} predicted, none compared" if number else "No touchdown was predicted"
    errors, time = velocity_errors(found), time_told(found)
    there, landings = arrived(found), landings_of(found)
    if there is not None and tells_truth(found) == len(found):
        noun = "landing" if landings and not errors.number else "touchdown"
        many = f"{there.found:,} of {counted(there.there, noun)}"
    elif landings and not errors.number:
        many = announced_of(landings)
    else:
        many = counted(len(times), "touchdown")
    said = f"{many} first predicted {seconds_words(median(times))} ahead"
    if errors.number:
        return f"{said}, half of the last predictions within {within(errors.median)}"
    return said if time is None else f"{said}, half of their times within {seconds_words(time.errors.p50)}"


def tells_truth(found: Sequence[Answer]) -> int:
    """How many bags carry the truth."""
    return sum("truth" in answer for answer in found)


def announced_of(landings: Sequence[Answer]) -> str:
    """How many landings of feet there were, and how many of them were announced where that is not all."""
    number = sum(one["time_error"] is not None for one in landings)
    all_landings = counted(len(landings), "landing")
    return all_landings if number == len(landings) else f"{number:,} of {all_landings}"


def time_told(found: Sequence[Answer]) -> Ahead | None:
    """The errors in s of the times told 20 ms ahead or somewhat more; None where nothing tells the true ones."""
    return next((one for one in ahead(found, "time_errors_ahead") if one.begin >= AHEAD and one.errors.number), None)


def _span(time: Ahead) -> str:
    return f"{time.begin * 1e3:.0f} to {time.end * 1e3:.0f} ms ahead"


def headlines_of(answers: Sequence[Answer]) -> list[Headline]:
    """How many touchdowns, how right, how early, and at what cost."""
    found = used(answers)
    if not touchdowns_of(found):
        return []
    return [one for one in (_many(found), _right(found), _early(found), _cost(found)) if one is not None]


def lead_of(answers: Sequence[Answer]) -> str:
    """Which bags these are."""
    names, found = names_of(answers), used(answers)
    samples = counted(sum(answer["samples"] for answer in found), "sample")
    if len(answers) == 1:
        seconds = "" if duration(answers[0]) is None else f" over {digits(duration(answers[0]) or 0.0)} s"
        return f"The record {names[0]}, {samples}{seconds}, went through the predictor as if it came live."
    failed = len(answers) - len(found)
    unread = f"; {failed:,} of them could not be read" if failed else ""
    return f"{len(answers):,} records, {samples}, went through the predictor as if they came live{unread}."


def duration(answer: Answer) -> float | None:
    """Seconds from the first to the last sample."""
    if answer.get("begin") is None or answer.get("end") is None:
        return None
    return float(answer["end"] - answer["begin"]) * 1e-9


def _many(found: Sequence[Answer]) -> Headline:
    there, landings = arrived(found), landings_of(found)
    if there is None:
        if landings:
            return Headline("How many", f"{announced_of(landings)} announced", "Their motion shows when feet landed.")
        return _compared(found)
    missed = there.there - there.found
    alarms = counted(there.false, "false alarm") if there.false else "no false alarm"
    why = f"{f'{missed:,}' if missed else 'None'} missed, {alarms}."
    if missed:
        why += f" A touchdown is found where a prediction before it told its time to {NEAREST / 1e6:.0f} ms."
    unseen = sum(answer["truth"]["unresolved"] for answer in found if "truth" in answer)
    if unseen:
        why += f" {counted(unseen, 'more impact')} cannot be seen in the samples: too slow, or too soon after another."
    if tells_truth(found) < len(found):
        why += f" The truth is known of {tells_truth(found):,} of {len(found):,} bags."
    return Headline("How many", f"{there.found:,} of {there.there:,} found", why)


def _compared(found: Sequence[Answer]) -> Headline:
    number, reasons = len(scored_of(found)), uncompared(found)
    others = len(touchdowns_of(found)) - number
    because = "because" if len(reasons) == 1 else "most often because"
    said = [f", {because} {WHY[reason]}" for reason, _ in reasons.most_common(1)]
    why = f"{others:,} more could not be{''.join(said)}." if others else "That is all that were predicted."
    return Headline("How many", f"{number:,} compared with measured velocities", why)


def _right(found: Sequence[Answer]) -> Headline | None:
    errors, time, modes = velocity_errors(found), time_told(found), confusion(found)
    if errors.number:
        truths = tells_truth(found)
        of = "the measured ones" if not truths else "the true ones"
        of += ", or the measured ones where a bag does not tell them" if 0 < truths < len(found) else ""
        why = f"So close are half of the velocities after the impact to {of}; 90 % are within {within(errors.p90)}."
        if modes:
            right = sum(count for (true, mode), count in modes.items() if true == mode)
            all_found = sum(count for pair, count in modes.items() if NOTHING not in pair)
            why += f" The mode is right in {right:,} of {all_found:,}."
        if time is not None:
            why += f" The time told {_span(time)} is {seconds_words(time.errors.p50)} wrong in the median."
        return Headline("How right", f"velocities within {within(errors.median)}", why)
    if time is None:
        return None
    within_90 = seconds_words(time.errors.p90)
    why = f"So close are half of the times that were told {_span(time)}; 90 % are within {within_90}."
    return Headline("How right", f"times within {seconds_words(time.errors.p50)}", why)


def _early(found: Sequence[Answer]) -> Headline | None:
    times = announced(found)
    if not times:
        return None
    why = f"The first prediction of each, in the median. 90 % came at least {seconds_words(quantile(times, 0.1))} ahead"
    latest = "only as it happened" if min(times) < 1e-6 else f"{seconds_words(min(times))} ahead"
    return Headline("How early", f"{seconds_words(median(times))} ahead", f"{why}, the latest one {latest}.")


def _cost(found: Sequence[Answer]) -> Headline | None:
    cost = costs(found)
    if cost.p50 is None:
        return None
    why = f"In the median, without reading and writing; 99 % take less than {time_words(cost.p99)}."
    return Headline("At what cost", f"{time_words(cost.p50)} a sample", why)
