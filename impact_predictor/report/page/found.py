"""The JSON answers of replays, any number of them, and what a page takes from them, each and all together."""

from __future__ import annotations

import json
import marshal
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from pathlib import Path
from statistics import median
from typing import Any, Final, NamedTuple
from zlib import compress, decompress

from ...bags.find import told_apart
from ...prediction.types import Leftover
from ...stamps import NANOSECONDS
from ..summary import Distribution, SpanErrors, from_json, quantile, spread_of, together

BagAnswer = Mapping[str, Any]
"""What `as_json` says of the replay of one bag; of one that could not be read its `bag` and `error`."""

NOTHING: Final = "nothing"
"""What is predicted of a true touchdown that is missed, and true of a false alarm."""


class Kept(Sequence[BagAnswer]):
    """Answers in the order in which they were added, packed: those of thousands of bags take a few megabytes."""

    def __init__(self) -> None:
        self._answers: list[BagAnswer] = []

    def append(self, answer: BagAnswer) -> None:
        """Add the answer of a bag."""
        # The page passes over all answers several times, and nothing is read as fast; it takes plain values alone.
        values = json.loads(json.dumps(answer))
        self._answers.append(_Packed({key: compress(marshal.dumps(value), 1) for key, value in values.items()}))

    def __len__(self) -> int:
        return len(self._answers)

    def __getitem__(self, place: Any) -> Any:
        return self._answers[place]


class _Packed(Mapping[str, Any]):
    """An answer of which each pass unpacks what it looks at: a page of many bags takes a sixth of the time."""

    def __init__(self, values: dict[str, bytes]) -> None:
        self._values = values

    def __getitem__(self, key: str) -> Any:
        return marshal.loads(decompress(self._values[key]))

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)


class TruthCount(NamedTuple):
    """Touchdowns against the truth: how many a record can show, how many of them were found, false alarms."""

    there: int
    found: int
    false: int


class RefusedMessages(NamedTuple):
    """How many messages of an input, of all, were refused for one reason, the name of a `Status`."""

    input: str
    status: str
    number: int
    all: int


def used(answers: Iterable[BagAnswer]) -> Iterator[BagAnswer]:
    """The answers of bags that could be read."""
    return (answer for answer in answers if "error" not in answer)


def names_of(answers: Iterable[BagAnswer]) -> list[str]:
    """A name for each bag: the last part of its path, or as much of it as no other bag has."""
    return [str(name) for name in told_apart([Path(answer["bag"]) for answer in answers])]


def touchdowns_of(answers: Iterable[BagAnswer]) -> Iterator[BagAnswer]:
    """The touchdowns of all bags that could be read."""
    return (touchdown for answer in used(answers) for touchdown in answer["touchdowns"])


def landings_of(answers: Iterable[BagAnswer]) -> Iterator[BagAnswer]:
    """The touchdowns that are landings of feet."""
    return (touchdown for touchdown in touchdowns_of(answers) if "foot" in touchdown)


def scored_of(answers: Iterable[BagAnswer]) -> Iterator[BagAnswer]:
    """The touchdowns whose velocities are compared with what was measured."""
    return (one for one in touchdowns_of(answers) if one["scored"] and one["relative_error"] is not None)


def true_touchdowns_of(answers: Iterable[BagAnswer]) -> Iterator[BagAnswer]:
    """The true touchdowns and the false alarms of the bags that carry the truth."""
    return (one for answer in used(answers) for one in answer.get("true_touchdowns", ()))


def begin_of(answer: BagAnswer) -> int:
    """The stamp (ns) from which the times of a record are counted: that of its first sample."""
    begin = answer.get("begin")
    return int(min((one["stamp"] for one in answer["touchdowns"]), default=0) if begin is None else begin)


def uncompared(answers: Iterable[BagAnswer]) -> Counter[str]:
    """How many touchdowns are not compared for each reason, the name of a `Leftover`; feet, which are driven, aside."""
    others = (one for one in touchdowns_of(answers) if not one["scored"] and "foot" not in one)
    return Counter(flag for one in others for flag in one["flags"] if flag in Leftover.__members__)


def velocity_errors(answers: Iterable[BagAnswer]) -> Distribution:
    """Relative errors of the velocities: against the truth where a bag tells it, else against what was measured."""
    errors: list[float] = []
    for answer in answers:
        true = [one["velocity_error"] for one in true_touchdowns_of([answer]) if one["velocity_error"] is not None]
        errors += true or [one["relative_error"] for one in scored_of([answer])]
    return spread_of(errors)


def measured_and_true(answers: Iterable[BagAnswer]) -> tuple[float, float] | None:
    """What 90 % of the relative errors stay below, against measured and against true velocities, where both are known.

    None where no bag tells both.
    """
    measured: list[float] = []
    true: list[float] = []
    for answer in (answer for answer in used(answers) if "truth" in answer):
        measured += [one["relative_error"] for one in scored_of([answer])]
        true += [one["velocity_error"] for one in true_touchdowns_of([answer]) if one["velocity_error"] is not None]
    return (quantile(measured, 0.9), quantile(true, 0.9)) if measured and true else None


def announced(answers: Iterable[BagAnswer]) -> list[float]:
    """How long before in s each touchdown that counts was announced first, if it was.

    Where a bag tells the truth these are the true ones that it can show, else those that are compared, and of feet all.
    """
    times: list[float] = []
    for answer in used(answers):
        if "truth" in answer:
            true = [one for one in true_touchdowns_of([answer]) if one["shown"] and one["stamp"] is not None]
            found = [one for one in true if one["first_seen"] is not None]
            times += [(one["stamp"] - one["first_seen"]) / NANOSECONDS for one in found]
        else:
            mine = [one for one in answer["touchdowns"] if one["scored"] or one.get("time_error") is not None]
            times += [one["announced_lead_time"] for one in mine]
    return times


def found_of(answers: Iterable[BagAnswer]) -> TruthCount | None:
    """How many true touchdowns were found; None where no bag carries the truth."""
    truths = [answer["truth"] for answer in used(answers) if "truth" in answer]
    if not truths:
        return None
    there = sum(truth["touchdowns"] for truth in truths)
    return TruthCount(there, there - sum(truth["missed"] for truth in truths), sum(truth["false"] for truth in truths))


def confusion(answers: Iterable[BagAnswer]) -> Counter[tuple[str, str]]:
    """How often which true mode (first) was predicted as which (second), of all touchdowns that their record can show.

    `NOTHING` was predicted where one was missed, and true where an alarm was false; empty where no truth knows modes.
    """
    counts: Counter[tuple[str, str]] = Counter()
    for one in true_touchdowns_of(answers):
        if one["stamp"] is None or (one["shown"] and one["mode"] is not None):
            counts[one["mode"] or NOTHING, one["predicted_mode"] or NOTHING] += 1
    return counts if any(true != NOTHING for true, _ in counts) else Counter()


def errors_ahead(answers: Iterable[BagAnswer], key: str) -> list[SpanErrors]:
    """The errors by lead time under a key of the answers, all together; empty where there are none."""
    spans: dict[tuple[float, float], list[Distribution]] = {}
    for entry in (entry for answer in used(answers) for entry in answer.get(key, ())):
        spans.setdefault((entry["from"], entry["to"]), []).append(from_json(entry))
    found = [SpanErrors(*span, together(spreads)) for span, spreads in sorted(spans.items())]
    return found if any(one.errors.number for one in found) else []


def costs(answers: Iterable[BagAnswer]) -> Distribution:
    """What the answers to samples took, in microseconds."""
    return together(from_json(answer.get("cost_us")) for answer in used(answers))


def refused(answers: Iterable[BagAnswer]) -> list[RefusedMessages]:
    """What became of all messages that were not accepted, the commonest of each input first."""
    inputs: dict[str, Counter[str]] = {}
    for answer in used(answers):
        known = answer.get("inputs") or {"odom": answer["statuses"], "contact_geometry": answer["geometry_statuses"]}
        for name, counts in known.items():
            inputs.setdefault(name, Counter()).update(counts)
    return [
        RefusedMessages(name, status, count, sum(counts.values()))
        for name, counts in inputs.items()
        for status, count in counts.most_common()
        if status != "ACCEPTED"
    ]


def badness(answer: BagAnswer) -> tuple[float, ...]:
    """How bad a bag is: one that is unusable most, then what was missed or false counts, then the errors."""
    if "error" in answer or answer.get("unpredictable"):
        return (inf,)
    there = found_of([answer])
    wrong = 0.0 if there is None else (there.there - there.found + there.false) / max(1, there.there)
    return (wrong, velocity_errors([answer]).p50 or 0.0, time_error(answer) or 0.0)


def worst_of(answers: Sequence[BagAnswer], places: Sequence[int], most: int) -> Sequence[int]:
    """Places of answers: all in their order, or of more than `most` the worst, those first."""
    if len(places) <= most:
        return places
    return sorted(places, key=lambda place: badness(answers[place]), reverse=True)[:most]


def time_error(answer: BagAnswer) -> float | None:
    """Median error in s of the times that were told 20 ms ahead; of feet without a truth, of those told last."""
    if "truth" in answer:
        error: float | None = answer["truth"]["median_time_error"]
        return error
    errors = [abs(one["time_error"]) for one in landings_of([answer]) if one["time_error"] is not None]
    return median(errors) if errors else None
