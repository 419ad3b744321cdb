"""What /diagnostics says of the feet of walking machines: which stand, how they landed, which sensors disagree."""

from __future__ import annotations

from collections import Counter, deque
from typing import TYPE_CHECKING, Final

from ..prediction.score import median
from ..prediction.types import Foot, Landing, Prediction

if TYPE_CHECKING:
    from ..prediction.contacts import Contacts

DISAGREES: Final = 0.5
"""The part of a second's samples above which a force sensor disagrees; while a foot lands or lifts each one does."""

_REMEMBERED: Final = 1000


class FeetReport:
    """Counts what the answers tell of the feet of one body, which it calls by their names."""

    def __init__(self, body: str, contacts: Contacts | None = None) -> None:
        """Count for a body, "" being the name of a body alone, which may have a model of its joints."""
        self.flaw = ""
        """What is wrong with its force sensors in the last second, "" where nothing is."""
        self._prefix = f"{body}/feet" if body else "feet"
        self._contacts = contacts
        self._feet: tuple[Foot, ...] = ()
        self._landings: Counter[str] = Counter()
        self._unannounced = 0
        self._late: deque[float] = deque(maxlen=_REMEMBERED)
        self._time_errors: deque[float] = deque(maxlen=_REMEMBERED)
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
        if prediction.score is not None and prediction.score.landing is not None:
            self._landed(prediction.score.landing)

    def _landed(self, landing: Landing) -> None:
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
        self.flaw = f"{self._prefix}: the force sensor of {' and '.join(disagree)} does not agree" if disagree else ""
        self._begin_second()

    def values(self) -> dict[str, str]:
        """Keys and values of /diagnostics; times in s, and what nobody knows is left out."""
        values = {
            "standing": " ".join([foot.name for foot in self._feet if foot.stands]) or "none",
            "landings": str(self._landings.total()),
        }
        values |= {f"landings.{name}": str(count) for name, count in sorted(self._landings.items())}
        if self._contacts is not None and self._contacts.unknown_joints:
            values["joints_left_out"] = " ".join(self._contacts.unknown_joints)
        if self._unannounced:
            values["landings.unannounced"] = str(self._unannounced)
        if self._time_errors:
            values["landings.median_time_error"] = f"{median(self._time_errors):.4f}"
        if self._late:
            values["landings.early"] = str(sum([late < 0.0 for late in self._late]))
            values["landings.late"] = str(sum([late > 0.0 for late in self._late]))
            values["landings.median_late"] = f"{median(self._late):.4f}"
        return {f"{self._prefix}.{key}": value for key, value in values.items()}
