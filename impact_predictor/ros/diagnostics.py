"""What a running predictor says about itself on /diagnostics: counts, rates, costs, and a level with its reason."""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from typing import Final

from ..native import form
from ..prediction.score import median
from ..prediction.types import Score, Status
from ..stamps import NANOSECONDS
from ..wording import counted
from .cdr import ERROR, OK, WARN, StatusBytes, diagnostic_status, pairs_of
from .feet_report import REMEMBERED, FeetReport
from .inputs import STALE_AFTER, InputReport, Refusal
from .latency import Latency

_NOT_SCORED: Final = "of driven feet: their times are compared, but no twists, for what follows is not the impact alone"


def shown(figures: Iterable[tuple[str, str, object]]) -> dict[str, str]:
    """Texts by their keys, of figures each with its format; those that nobody knows are left out."""
    return {key: format(value, form) for key, form, value in figures if value is not None}


class Diagnostics:
    """Counts what happens to the messages, judges it, and reports it as a diagnostic_msgs/DiagnosticArray.

    `now` is always in s of one steady clock. `second_over` is to be called once a second. `level` is that of the last
    judgement; `accepted`, `refused` and `second_over` say whether it has changed, so that a report is due at once.
    """

    def __init__(
        self,
        name: str,
        now: float,
        inputs: Sequence[str] = ("odom",),
        horizon: Callable[[str], float] = lambda _: math.inf,
    ) -> None:
        """Count from `now` on what comes on the inputs, and report under the name of the node.

        `horizon` tells how far (s) ahead of the samples on an input touchdowns are predicted.
        """
        self.level = WARN
        self.message = "no sample yet"
        self.lost: int | None = 0
        """Messages that the middleware says it has lost; None where it is not asked."""
        self.inputs = InputReport(inputs, now)
        """What comes on each input."""
        self.latency = Latency(horizon)
        """How old the samples are."""
        self.feet: dict[str, FeetReport] = {}
        """What is counted of the feet of bodies that walk."""
        self.doubts: Callable[[], tuple[str, ...]] = tuple
        """What speaks against the parameters of the scene."""
        self._name = name
        self._body = ""
        self._accepted = 0
        self._refused: Counter[Refusal] = Counter()
        self._flaws: dict[Refusal, str] = {}
        self._others = 0
        self.dropped = 0
        """Samples that were dropped because newer ones waited behind them."""
        self._last_stamps: dict[str, int] = {}
        self._touchdowns = self._landings = 0
        # How many were scored by the whole twist and in the plane, and the last relative errors.
        self._scored = Counter[str]()
        self._errors = {which: deque[float](maxlen=REMEMBERED) for which in ("_6d", "")}
        self._second = 0.0, 0.0
        self._costs: list[float] | None = None
        self._refused_now: Counter[Refusal] = Counter()
        self._begin_second(now)

    def _begin_second(self, now: float) -> None:
        self._began = now
        self._updates: list[float] = []
        self._totals: list[float] = []
        self._largest_gap = 0
        self._dropped_before = self.dropped
        self._refused_before = self._refused_now
        self._refused_now = Counter()
        self._told: set[tuple[str, Status]] = set()

    def accepted(self, now: float, name: str, stamp: int, latency: int, update: float, total: float) -> bool:
        """Count an accepted sample on an input; `stamp` and `latency` in ns, costs of `update` and in `total` in s."""
        self._accepted += 1
        self._updates.append(update)
        self._totals.append(total)
        gap = stamp - self._last_stamps.get(name, stamp)
        if gap > self._largest_gap:
            self._largest_gap = gap
        self._last_stamps[name] = stamp
        self.latency.take(name, stamp, latency)
        return self._heard(now, name)

    def taken(self, now: float, name: str) -> bool:
        """Count another accepted message: of the support, a tilt, or about feet."""
        self._others += 1
        return self._heard(now, name)

    def _heard(self, now: float, name: str) -> bool:
        """Note an accepted message; whether it changed the level, which it does when it was waited for."""
        silence = self.inputs.accepted(now, name)
        waited_for = self.level == ERROR or (self.level == WARN and silence > STALE_AFTER)
        return waited_for and self._judge(now)

    def refused(self, now: float, reason: Refusal, flaw: str = "") -> bool:
        """Count a refused message, with what more is known of its flaw."""
        self._refused[reason] += 1
        self._flaws[reason] = flaw
        self.inputs.refused(now, reason, flaw)
        self._refused_now[reason] += 1
        return self.level == OK and self._judge(now)

    def is_news(self, reason: Refusal) -> bool:
        """Whether a message is the first in this second to be refused for a reason, and so worth a line in the log."""
        kind = reason.input.rpartition("/")[2], reason.status
        news = kind not in self._told
        self._told.add(kind)
        return news

    @property
    def served(self) -> int:
        """How many messages were accepted or refused so far."""
        return self._accepted + self._others + self._refused.total()

    def settled(self, body: str, score: Score) -> None:
        """Count a touchdown of a body, which has happened."""
        self._body = body
        self._touchdowns += 1
        self._landings += score.landing is not None
        whole = score.spatial.error if score.spatial is not None and not score.leftover_6d else None
        for which, error in (("_6d", whole), ("", score.relative_error if score.scored else None)):
            if error is not None:
                self._scored[which] += 1
                self._errors[which].append(error)

    def second_over(self, now: float) -> bool:
        """Sum up the second that ends, and begin the next."""
        for feet in self.feet.values():
            feet.second_over()
        self.latency.second_over()
        changed = self._judge(now, at_its_end=True)
        updates = self._updates
        self._second = len(updates) / max(now - self._began, 1e-9), self._largest_gap / NANOSECONDS
        self._costs = [median(updates), max(updates), median(self._totals)] if updates else None
        self._begin_second(now)
        return changed

    def report(self, now: float) -> StatusBytes:
        """Everything, as one status of a diagnostic_msgs/DiagnosticArray."""
        return diagnostic_status(
            self.level, f"{self._name}: predictions", self.message, self._body, pairs_of(shown(self.figures(now)))
        )

    def figures(self, now: float) -> list[tuple[str, str, object]]:
        """Key, format and value of each figure, which docs/node.md explains; None where it is not known."""
        rate, largest_gap = self._second
        update, longest, total = [1e6 * cost for cost in self._costs] if self._costs else (None, None, None)
        driven = f"{counted(self._landings, 'landing')} {_NOT_SCORED}" if self._landings else None
        apart = [one.kind for one in self.inputs.misfits]
        figures: list[tuple[str, str, object]] = [
            ("runs", "", form()),
            ("samples.accepted", "d", self._accepted),
            ("samples.rate", ".1f", rate),
            ("samples.largest_gap", ".4f", largest_gap),
            ("samples.publishers", "d", sum(self.inputs.publishers.values())),
            ("samples.dropped", "d", self.dropped),
            ("samples.lost", "d", self.lost),
            *[(f"incompatible_{kind.lower()}", "d", apart.count(kind)) for kind in ("QoS", "type")],
            ("samples.seconds_since_last", ".3f", self.inputs.since_last(now)),
            ("samples.latency", ".6f", self.latency.seconds),
            *[(f"refused.{one.input}.{one.status.name}", "d", self._refused[one]) for one in sorted(self._refused)],
            ("cost_us.update.median", ".1f", update),
            ("cost_us.update.max", ".1f", longest),
            ("cost_us.total.median", ".1f", total),
            ("touchdowns", "d", self._touchdowns),
        ]
        for which, errors in self._errors.items():
            figures.append((f"touchdowns.scored{which}", "d", self._scored[which]))
            figures.append((f"touchdowns.median_relative_error{which}", ".4f", median(errors) if errors else None))
        figures.append(("touchdowns.not_scored", "", driven))
        for feet in self.feet.values():
            figures += feet.figures()
        return figures

    def _judge(self, now: float, *, at_its_end: bool = False) -> bool:
        """Find the level anew; whether it has changed. Only at the end of a second it is known what did not come."""
        before = self.level
        self.level, self.message = self._verdict(now, at_its_end)
        return self.level != before

    def _verdict(self, now: float, at_its_end: bool) -> tuple[int, str]:
        # A refusal counts until a whole second went without one, so that the level does not flicker.
        refused = self._refused_now if at_its_end else self._refused_before + self._refused_now
        if refused:
            count = refused.total()
            reason = max(refused, key=lambda one: (not one.is_consequence, refused[one]))
            said = reason.said(self._flaws[reason])
            only_refused = not self._updates and (at_its_end or self.level == ERROR)
            if only_refused and reason.status is not Status.NO_GEOMETRY:
                return ERROR, f"nothing but refused messages ({count}); {said}"
            return WARN, f"{count} messages refused in the last second; {said}"
        if dropped := self.dropped - self._dropped_before:
            cost = f"{median(self._totals) * 1e3:.2g} ms" if self._totals else "too long"
            why = f"they come faster than answers, of {cost} each"
            return WARN, f"{dropped} samples dropped in the last second: {why}"
        flaw, is_lost = self.inputs.flaw(now)
        if flaw:
            return ERROR if is_lost else WARN, flaw
        if self.latency.flaw:
            return WARN, self.latency.flaw
        flaws = [*[feet.flaw for feet in self.feet.values() if feet.flaw], *self.doubts()]
        note = f"; {self.latency.note}" if self.latency.note else ""
        return (WARN, flaws[0]) if flaws else (OK, f"predicting{note}")
