"""What a page takes from the JSON answers of replays, any number of them, each and all together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any, Final

from ...bags.find import told_apart
from ...prediction.types import Leftover
from ...wording import counted
from ..summary import WHY, Distribution, SpanErrors, from_json, quantile, spread_of, together
from .document import Headline, part_words, time_words

BagAnswer = Mapping[str, Any]
"""What `as_json` says of the replay of one bag; of one that could not be read its `bag` and `error`."""

NOTHING: Final = "nothing"
"""What is predicted of a true touchdown that is missed, and true of a false alarm."""

LEAST_LEAD_TIME: Final = 0.02
"""Seconds before a touchdown, from which on the errors of the times are given."""


def names_of(answers: Iterable[BagAnswer]) -> list[str]:
    """A name for each bag: the last part of its path, or as much of it as no other bag has."""
    return [str(name) for name in told_apart([Path(answer["bag"]) for answer in answers])]


def touchdowns_of(answers: Iterable[BagAnswer]) -> Iterator[BagAnswer]:
    """The touchdowns of all bags that could be read."""
    return (touchdown for answer in answers for touchdown in answer.get("touchdowns", ()))


def scored_of(answers: Iterable[BagAnswer]) -> list[BagAnswer]:
    """The touchdowns whose velocities are compared with what was measured."""
    return [one for one in touchdowns_of(answers) if one["scored"] and one["relative_error"] is not None]


def true_touchdowns_of(answers: Iterable[BagAnswer]) -> Iterator[BagAnswer]:
    """The true touchdowns and the false alarms of the bags that carry the truth."""
    return (one for answer in answers for one in answer.get("true_touchdowns", ()))


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


def truth_of(answers: Iterable[BagAnswer]) -> Counter[str]:
    """How many true touchdowns there are, were missed, false alarms or cannot be seen; empty where no bag tells it."""
    counts: Counter[str] = Counter()
    for truth in (answer["truth"] for answer in answers if "truth" in answer):
        counts.update({key: truth[key] for key in ("touchdowns", "missed", "false", "unresolved")})
    return counts


def confusion(answers: Iterable[BagAnswer]) -> Counter[tuple[str, str]]:
    """How often which true mode (first) was predicted as which (second), of all touchdowns that their record can show.

    `NOTHING` was predicted where one was missed, and true where an alarm was false; empty where no truth knows modes.
    """
    counts: Counter[tuple[str, str]] = Counter()
    for one in true_touchdowns_of(answers):
        if one["stamp"] is None or (one["shown"] and one["mode"] is not None):
            counts[one["mode"] or NOTHING, one["predicted_mode"] or NOTHING] += 1
    return counts if any(true != NOTHING for true, _ in counts) else Counter()


def right_modes(counts: Mapping[tuple[str, str], int]) -> str:
    """In how many of the true touchdowns that were found the mode is right; "" where none was found."""
    right = sum(count for (true, predicted), count in counts.items() if true == predicted)
    both = sum(count for pair, count in counts.items() if NOTHING not in pair)
    return f"The mode is right in {right:,} of {both:,}." if both else ""


def errors_ahead(answers: Iterable[BagAnswer], key: str) -> list[SpanErrors]:
    """The errors by lead time under a key of the answers, all together; the spans that have any."""
    spans: dict[tuple[float, float], list[Distribution]] = {}
    for entry in (entry for answer in answers for entry in answer.get(key, ())):
        spans.setdefault((entry["from"], entry["to"]), []).append(from_json(entry))
    found = [SpanErrors(*span, together(spreads)) for span, spreads in sorted(spans.items())]
    return [one for one in found if one.errors.number]


def costs(answers: Iterable[BagAnswer]) -> Distribution:
    """What the answers to samples took, in microseconds."""
    return together(from_json(answer.get("cost_us")) for answer in answers)


def badness(answer: BagAnswer) -> tuple[float, ...]:
    """How bad a bag is: one that is unusable most, then what was missed or false counts, then the errors."""
    if "error" in answer or answer.get("unpredictable"):
        return (inf,)
    truth = truth_of([answer])
    wrong = (truth["missed"] + truth["false"]) / max(1, truth["touchdowns"])
    return (wrong, velocity_errors([answer]).p50 or 0.0)


def facts_of(answers: Sequence[BagAnswer]) -> list[Headline]:
    """How many, how right (medians), how early and at what cost, of one bag or of all; "–" where nothing tells it."""
    number, scored, reasons = sum(1 for _ in touchdowns_of(answers)), scored_of(answers), uncompared(answers)
    compared = f"{len(scored):,} compared with measured velocities" if scored or reasons else ""
    compared += "".join(f"; most of the others not, as {WHY[reason]}" for reason, _ in reasons.most_common(1))
    found, missed = "–", ""
    if truth := truth_of(answers):
        found = f"{truth['touchdowns'] - truth['missed']:,} of {truth['touchdowns']:,}"
        missed = f"{truth['missed']:,} missed, {counted(truth['false'], 'false alarm')}"
        missed += f", {truth['unresolved']:,} more too slow or too close to be seen" if truth["unresolved"] else ""
    elif landings := [one["time_error"] is not None for one in touchdowns_of(answers) if "foot" in one]:
        found, missed = f"{sum(landings):,} of {len(landings):,}", "landings, as the feet's motion shows them"
    errors, cost, of = velocity_errors(answers), costs(answers), "true" if truth else "measured"
    ahead = [one for one in errors_ahead(answers, "time_errors_ahead") if one.begin >= LEAST_LEAD_TIME]
    span = f"{1e3 * ahead[0].begin:.0f} to {1e3 * ahead[0].end:.0f} ms ahead" if ahead else ""
    late = ahead[0].errors if ahead else Distribution()
    known = [one for one in touchdowns_of(answers) if one["scored"] or one.get("time_error") is not None]
    times = [one["announced_lead_time"] for one in known]
    first, early, latest = (quantile(times, part) if times else None for part in (0.5, 0.1, 0.0))
    half, most = (None if one is None else 1e-6 * one for one in (cost.p50, cost.p99))
    right = f"median against the {of} ones; 90 % below {part_words(errors.p90)}. {right_modes(confusion(answers))}"
    soon = f"median; 90 % at least {time_words(early)}, the latest {time_words(latest)}"
    return [
        Headline("touchdowns", f"{number:,}", compared),
        Headline("found", found, missed),
        Headline("velocity error", part_words(errors.p50), right),
        Headline("time error", time_words(late.p50), f"median {span}; 90 % below {time_words(late.p90)}"),
        Headline("first ahead", time_words(first), soon),
        Headline("cost of a sample", time_words(half), f"median; 99 % below {time_words(most)}"),
    ]
