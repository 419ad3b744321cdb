"""What a running predictor says on /diagnostics about the feet of a walking machine."""

from __future__ import annotations

from collections import Counter, deque
from typing import TYPE_CHECKING, Final

from ..prediction.score import median
from ..prediction.types import Foot, Prediction

if TYPE_CHECKING:
    from ..prediction.predictor import Contacts

REMEMBERED: Final = 1000
"""Touchdowns whose errors count for a median."""

DISAGREES: Final = 0.5
"""The part of a second's samples above which a force sensor disagrees; while a foot lands or lifts each one does."""


class FeetReport:
    """Counts what the answers tell of the feet of one body, which it calls by their names."""

    def __init__(self, body: str, contacts: Contacts | None = None) -> None:
        """Count for a body, "" being the name of a body alone, which may have a model of its joints."""
        self.flaw = ""
        """What is wrong with what is told of its feet, by the last second, "" where nothing is."""
        self._prefix = f"{body}/feet" if body else "feet"
        self._contacts = contacts
        self._feet: tuple[Foot, ...] = ()
        self._landings: Counter[str] = Counter()
        self._unannounced = 0
        self._late: deque[float] = deque(maxlen=REMEMBERED)
        self._time_errors: deque[float] = deque(maxlen=REMEMBERED)
        self._begin_second()

    def _begin_second(self) -> None:
        self._samples = 0
        self._disagreed: Counter[str] = Counter()

    def take(self, prediction: Prediction) -> None:
        """Count an answer."""
        self._feet = prediction.feet
        self._samples += 1
        for foot in prediction.feet:
            if foot.confirmed is False:
                self._disagreed[foot.name] += 1
        landing = None if prediction.score is None else prediction.score.landing
        if landing is None:
            return
        self._landings[landing.foot] += 1
        if landing.late is not None:
            self._late.append(landing.late)
        if landing.history:
            self._time_errors.append(abs(landing.history[-1][1]))
        else:
            self._unannounced += 1

    def second_over(self) -> None:
        """Sum up the second that ends, and begin the next."""
        disagree = [name for name, count in sorted(self._disagreed.items()) if count > DISAGREES * self._samples]
        doubts = [] if self._contacts is None else list(self._contacts.doubts())
        if disagree:
            doubts.insert(0, f"the force sensor of {' and '.join(disagree)} does not agree")
        self.flaw = f"{self._prefix}: {doubts[0]}" if doubts else ""
        self._begin_second()

    def figures(self) -> list[tuple[str, str, object]]:
        """Key, format and value of each figure for /diagnostics; times in s."""
        late, errors = self._late, self._time_errors
        joints, delay = ((), None) if self._contacts is None else (self._contacts.unknown_joints, self._contacts.delay)
        found: list[tuple[str, str, object]] = [
            ("standing", "", " ".join([foot.name for foot in self._feet if foot.stands]) or "none"),
            ("landings", "d", self._landings.total()),
            *[(f"landings.{name}", "d", count) for name, count in sorted(self._landings.items())],
            ("joints_left_out", "", " ".join(joints) if joints else None),
            ("delay", ".5f", None if delay is None else delay.time),
            ("delay.deviation", ".5f", None if delay is None else delay.deviation),
            ("delay.taken_out", ".5f", delay.taken if delay is not None and delay.taken else None),
            ("landings.unannounced", "d", self._unannounced or None),
            ("landings.median_time_error", ".4f", median(errors) if errors else None),
            ("landings.early", "d", sum([one < 0.0 for one in late]) if late else None),
            ("landings.late", "d", sum([one > 0.0 for one in late]) if late else None),
            ("landings.median_late", ".4f", median(late) if late else None),
        ]
        return [(f"{self._prefix}.{key}", form, value) for key, form, value in found]
