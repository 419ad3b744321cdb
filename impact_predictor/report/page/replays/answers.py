"""What the page of a replay takes from the JSON answers of the bags, one by one and all together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from math import inf
from pathlib import Path
from statistics import median
from typing import Final, NamedTuple

from ....bags.find import told_apart
from ....prediction.types import Leftover
from ....stamps import NANOSECONDS
from ...spread import Spread, from_json, together
from ...summary import Errors, quantile, summarize
from .kept import Answer as Answer
from .kept import Each
from .words import within

NOTHING: Final = "nothing"
"""What is predicted of a true touchdown that is missed, and true of a false alarm."""


class Arrived(NamedTuple):
    """Touchdowns against the truth: how many a record can show, how many of them were found, false alarms."""

    there: int
    found: int
    false: int


class Ahead(NamedTuple):
    """The errors of the predictions that were made from `begin` to `end` s before their touchdowns."""

    begin: float
    end: float
    errors: Spread


class Refused(NamedTuple):
    """How many messages of an input, of all, were refused for one reason, the name of a `Status`."""

    input: str
    status: str
    number: int
    all: int


def used(answers: Sequence[Answer]) -> Sequence[Answer]:
    """The answers of bags that could be read."""
    return Each(lambda: (answer for answer in answers if "error" not in answer))


def names_of(answers: Sequence[Answer]) -> list[str]:
    """A name for each bag: the last part of its path, or as much of it as no other bag has."""
    return [str(name) for name in told_apart([Path(answer["bag"]) for answer in answers])]


def touchdowns_of(answers: Sequence[Answer]) -> Sequence[Answer]:
    """The touchdowns of all bags."""
    return Each(lambda: (touchdown for answer in answers for touchdown in answer["touchdowns"]))


def landings_of(answers: Sequence[Answer]) -> Sequence[Answer]:
    """The touchdowns that are landings of feet."""
    return Each(lambda: (touchdown for touchdown in touchdowns_of(answers) if "foot" in touchdown))


def scored_of(answers: Sequence[Answer]) -> Sequence[Answer]:
    """The touchdowns whose velocities are compared with what was measured."""
    return Each(lambda: (one for one in touchdowns_of(answers) if one["scored"] and one["relative_error"] is not None))


def uncompared(answers: Sequence[Answer]) -> Counter[str]:
    """How many touchdowns are not compared for each reason, the name of a `Leftover`; feet, which are driven, aside."""
    others = (one for one in touchdowns_of(answers) if not one["scored"] and "foot" not in one)
    return Counter(flag for one in others for flag in one["flags"] if flag in Leftover.__members__)


def true_touchdowns_of(answers: Sequence[Answer]) -> Sequence[Answer]:
    """The true touchdowns and the false alarms of the bags that carry the truth."""
    return Each(lambda: (one for answer in answers for one in answer.get("true_touchdowns", ())))


def velocity_errors(answers: Iterable[Answer]) -> Errors:
    """Relative errors of the velocities: against the truth where a bag tells it, else against what was measured."""
    errors: list[float] = []
    for answer in answers:
        true = [one["velocity_error"] for one in true_touchdowns_of([answer]) if one["velocity_error"] is not None]
        errors += true or [one["relative_error"] for one in scored_of([answer])]
    return summarize(errors)


def besides_truth(answers: Sequence[Answer]) -> list[str]:
    """Why errors against what the samples show are not those against the truth; empty where no bag tells both."""
    known = Each(lambda: (answer for answer in answers if "truth" in answer))
    true = [one["velocity_error"] for one in true_touchdowns_of(known) if one["velocity_error"] is not None]
    measured = [one["relative_error"] for one in scored_of(known)]
    if not true or not measured:
        return []
    said = (
        f"The true velocities are known too: 90 % of the predictions are within {within(quantile(true, 0.9))} of them, "
        f"but within {within(quantile(measured, 0.9))} of the measured ones. These are of the samples 2 to 4 after a "
        "touchdown; by then gravity, further impacts and a moving support have changed what the impact left. "
        "A record without the truth has nothing better."
    )
    return [said]


def announced(answers: Iterable[Answer]) -> list[float]:
    """How long before in s each touchdown that counts was announced first, if it was.

    Where a bag tells the truth these are the true ones that it can show, else those that are compared, and of feet all.
    """
    times: list[float] = []
    for answer in answers:
        if "truth" in answer:
            true = [one for one in true_touchdowns_of([answer]) if one["shown"] and one["stamp"] is not None]
            found = [one for one in true if one["first_seen"] is not None]
            times += [(one["stamp"] - one["first_seen"]) / NANOSECONDS for one in found]
        else:
            mine = [one for one in answer["touchdowns"] if one["scored"] or one.get("time_error") is not None]
            times += [one["announced_lead_time"] for one in mine]
    return times


def arrived(answers: Iterable[Answer]) -> Arrived | None:
    """How many true touchdowns were found; None where no bag carries the truth."""
    truths = [answer["truth"] for answer in answers if "truth" in answer]
    if not truths:
        return None
    there = sum(truth["touchdowns"] for truth in truths)
    return Arrived(there, there - sum(truth["missed"] for truth in truths), sum(truth["false"] for truth in truths))


def confusion(answers: Sequence[Answer]) -> Counter[tuple[str, str]]:
    """How often which true mode (first) was predicted as which (second), of all touchdowns that their record can show.

    `NOTHING` was predicted where one was missed, and true where an alarm was false; empty where no truth knows modes.
    """
    counts: Counter[tuple[str, str]] = Counter()
    for one in true_touchdowns_of(answers):
        if one["stamp"] is None or (one["shown"] and one["mode"] is not None):
            counts[one["mode"] or NOTHING, one["predicted_mode"] or NOTHING] += 1
    return counts if any(true != NOTHING for true, _ in counts) else Counter()


def ahead(answers: Iterable[Answer], key: str) -> list[Ahead]:
    """The errors by lead time under a key of the answers, all together; empty where there are none."""
    spans: dict[tuple[float, float], list[Spread]] = {}
    for entry in (entry for answer in answers for entry in answer.get(key, ())):
        spans.setdefault((entry["from"], entry["to"]), []).append(from_json(entry))
    found = [Ahead(*span, together(spreads)) for span, spreads in sorted(spans.items())]
    return found if any(one.errors.number for one in found) else []


def costs(answers: Iterable[Answer]) -> Spread:
    """What the answers to samples took, in microseconds."""
    return together(from_json(answer.get("cost_us")) for answer in answers)


def refused(answers: Iterable[Answer]) -> list[Refused]:
    """What became of all messages that were not accepted, the commonest of each input first."""
    inputs: dict[str, Counter[str]] = {}
    for answer in answers:
        known = answer.get("inputs") or {"odom": answer["statuses"], "contact_geometry": answer["geometry_statuses"]}
        for name, counts in known.items():
            inputs.setdefault(name, Counter()).update(counts)
    return [
        Refused(name, status, count, sum(counts.values()))
        for name, counts in inputs.items()
        for status, count in counts.most_common()
        if status != "ACCEPTED"
    ]


def badness(answer: Answer) -> tuple[float, ...]:
    """How bad a bag is: one that is unusable most, then what was missed or false counts, then the errors."""
    if "error" in answer or answer.get("unpredictable"):
        return (inf,)
    there = arrived([answer])
    wrong = 0.0 if there is None else (there.there - there.found + there.false) / max(1, there.there)
    errors = velocity_errors([answer])
    return (wrong, errors.median or 0.0, time_error(answer) or 0.0)


def time_error(answer: Answer) -> float | None:
    """Median error in s of the times that were told 20 ms ahead; of feet without a truth, of those told last."""
    if "truth" in answer:
        error: float | None = answer["truth"]["median_time_error"]
        return error
    errors = [abs(one["time_error"]) for one in landings_of([answer]) if one["time_error"] is not None]
    return median(errors) if errors else None
