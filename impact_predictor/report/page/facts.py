"""What a page takes from the JSON answers of replays, any number of them, each and all together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import inf
from operator import add
from pathlib import Path
from typing import Any, Final

from ...bags.find import told_apart
from ...prediction.recorded import Announced
from ...wording import counted
from ..skill import ALL
from ..summary import WHY, Distribution, SpanErrors, from_json, quantile, spread_of, together
from ..touchdowns import TouchdownRow, row_of_json
from ..watch import warned_of
from . import Headline, part_words, time_words

BagAnswer = Mapping[str, Any]
"""What `as_json` says of the replay of one bag; of one that could not be read its `bag` and `error`."""

NOTHING: Final = "nothing"
"""What is predicted of a true touchdown that is missed, and true of a false alarm."""

FOUND: Final = "true ones found"
"""How many of the touchdowns were predicted that happened, by the truth in a bag or the motion of feet."""

LEAST_LEAD_TIME: Final = 0.02
"""Seconds before a touchdown, from which on the errors of the times are given."""


class ReplayFacts:
    """What the answers of one bag or of several say together.

    `names` are the last parts of the paths, or as much of them as no other bag has. `rows` are the touchdowns, `scored`
    those whose velocities are compared with measured ones; `uncompared` counts the reasons (names of `Leftover`) why
    others are not, feet, which are driven, aside. `true` are true touchdowns and false alarms, `truth` counts true
    touchdowns, missed ones, false alarms and those that cannot be seen; both are empty where no bag tells the truth.
    `costs` are in microseconds, and `units` are those under watch.
    """

    def __init__(self, answers: Sequence[BagAnswer]) -> None:
        self.answers = answers
        self.names = [str(name) for name in told_apart([Path(answer["bag"]) for answer in answers])]
        self.rows, self.true, self.recorded = list[TouchdownRow](), list[BagAnswer](), dict[str, Announced]()
        self.truth, errors = Counter[str](), list[float]()
        for answer in answers:
            rows, true = [*map(row_of_json, answer.get("touchdowns", ()))], answer.get("true_touchdowns", ())
            # Against the truth where a bag tells it, else against what was measured.
            known = [one["velocity_error"] for one in true if one["velocity_error"] is not None]
            errors += known or [row.best_error for row in rows if row.best_error is not None]
            self.rows += rows
            for kind, counts in answer.get("kinds", {}).items():
                if kind != ALL:
                    shown = counts["touchdowns"], counts["announced"]
                    self.recorded[kind] = Announced(*map(add, self.recorded.get(kind, (0, 0)), shown))
            self.true += true
            told = answer.get("truth", {})
            self.truth.update({key: told[key] for key in ("touchdowns", "missed", "false", "unresolved") if told})
        watches = [answer["watch"]["units"].values() for answer in answers if answer.get("watch")]
        self.units = [unit for units in watches for unit in units]
        self.scored = [row for row in self.rows if row.is_scored]
        self.velocity_errors = spread_of(errors)
        self.costs = together(from_json(answer.get("cost_us")) for answer in answers)
        self.uncompared = Counter(flag for row in self.rows if not row.foot for flag in row.why_not_scored)

    def confusion(self) -> Counter[tuple[str, str]]:
        """How often which true mode was predicted as which, of all touchdowns that their record can show.

        `NOTHING` was predicted where one was missed, and true where an alarm was false; empty where no truth knows
        modes.
        """
        seen = [one for one in self.true if one["stamp"] is None or (one["shown"] and one["mode"] is not None)]
        counts = Counter((one["mode"] or NOTHING, one["predicted_mode"] or NOTHING) for one in seen)
        return counts if any(true != NOTHING for true, _ in counts) else Counter()

    def errors_ahead(self, key: str) -> list[SpanErrors]:
        """The errors by lead time under a key of the answers, all together; the spans that have any."""
        spans: dict[tuple[float, float], list[Distribution]] = {}
        for entry in (entry for answer in self.answers for entry in answer.get(key, ())):
            spans.setdefault((entry["from"], entry["to"]), []).append(from_json(entry))
        found = [SpanErrors(*span, together(spreads)) for span, spreads in sorted(spans.items())]
        return [one for one in found if one.errors.number]

    def badness(self) -> tuple[float, float]:
        """How bad bags are: those that are unusable most, then what was missed, false or not warned of, then the
        errors.
        """
        if any("error" in answer or answer.get("unpredictable") for answer in self.answers):
            return inf, inf
        unwarned = [event["warned_ahead"] is None for unit in self.units for event in unit["events"]]
        wrong = self.truth["missed"] + self.truth["false"] + sum(unwarned)
        return wrong / max(1, self.truth["touchdowns"] + len(unwarned)), self.velocity_errors.p50 or 0.0

    def headlines(self) -> list[Headline]:
        """How many, how right (medians), how early and at what cost; "–" where nothing tells it."""
        scored, truth, errors, cost = self.scored, self.truth, self.velocity_errors, self.costs
        whole = sum(row.error_6d is not None for row in scored)
        compared = f"{len(scored):,} compared with measured velocities" if scored or self.uncompared else ""
        compared += f", {whole:,} as whole twists and the others in the impact plane alone" if whole else ""
        compared += "".join(
            f"; most of the others not, as {WHY[reason]}" for reason, _ in self.uncompared.most_common(1)
        )
        found, missed, feet = "–", "", [row for row in self.rows if row.foot]
        if truth:
            found = f"{truth['touchdowns'] - truth['missed']:,} of {truth['touchdowns']:,}"
            missed = f"{truth['missed']:,} missed, {counted(truth['false'], 'false alarm')}"
            if truth["unresolved"]:
                missed += f"; {truth['unresolved']:,} more, too slow or too close to be seen, do not count"
        elif feet:
            found = f"{sum(row.time_error is not None for row in feet):,} of {len(feet):,}"
            missed = "of the landings that the feet's motion shows"
        of = f"of {counted(errors.number, 'touchdown')} against the {'true' if truth else 'measured'} velocities"
        right = f"median {of}; 90 % below {part_words(errors.p90)}. "
        if both := {pair: count for pair, count in self.confusion().items() if NOTHING not in pair}:
            same = sum(count for (true, predicted), count in both.items() if true == predicted)
            right += f"The mode is right in {same:,} of {sum(both.values()):,}."
        late, span = Distribution(), ""
        for one in self.errors_ahead("time_errors_ahead"):
            if one.begin >= LEAST_LEAD_TIME:
                late, span = one.errors, f"{1e3 * one.begin:.0f} to {1e3 * one.end:.0f} ms ahead"
                break
        times = [
            row.announced_lead_time for row in self.rows if row.is_scored or (row.foot and row.time_error is not None)
        ]
        first, early, latest = (time_words(quantile(times, part) if times else None) for part in (0.5, 0.1, 0.0))
        half, most = (time_words(one and 1e-6 * one) for one in (cost.p50, cost.p99))
        warned = [Headline("events warned of", *warned_of(self.units))] if self.units else []
        return [
            Headline("touchdowns predicted", f"{len(self.rows):,}" if self.rows or not self.units else "–", compared),
            Headline(FOUND, found, missed),
            Headline("velocity error", part_words(errors.p50), right),
            Headline("time error", time_words(late.p50), f"median {span}; 90 % below {time_words(late.p90)}"),
            Headline("first ahead", first, f"median; 90 % at least {early}, the latest {latest}"),
            *warned,
            Headline("cost of a sample", half, f"median; 99 % below {most}"),
        ]
