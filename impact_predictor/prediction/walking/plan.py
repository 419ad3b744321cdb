"""When the feet are planned to land, and how late they are."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from ..types import Schedule, Status
from .cubic import NANOSECONDS

LONGEST = 10_000_000_000
"""ns for which what was planned is remembered."""


class Plan:
    """The planned landings of some feet; a schedule replaces what was planned from its first time on."""

    def __init__(self, feet: Sequence[str]) -> None:
        self._stances: dict[str, list[tuple[int, bool]]] = {foot: [] for foot in feet}
        self._landings: dict[str, list[int]] = {foot: [] for foot in feet}

    def set(self, schedule: Schedule) -> Status:
        """Take a schedule; what became of it."""
        times = schedule.times
        if not set(schedule.feet) <= set(self._stances):
            return Status.FEET_CHANGED
        if any(b <= a for a, b in pairwise(times)) or len(schedule.stands) != len(times):
            return Status.MALFORMED
        if any(len(stands) != len(schedule.feet) for stands in schedule.stands):
            return Status.MALFORMED
        if not times:
            return Status.ACCEPTED
        for number, foot in enumerate(schedule.feet):
            kept = [one for one in self._stances[foot] if times[0] - LONGEST < one[0] < times[0]]
            following = [(time, stands[number]) for time, stands in zip(times, schedule.stands, strict=True)]
            planned = self._stances[foot] = kept + following
            self._landings[foot] = [time for (_, before), (time, now) in pairwise(planned) if now and not before]
        return Status.ACCEPTED

    def late(self, foot: str, stamp: int) -> float | None:
        """How much later than planned, in s, a foot lands at a stamp in ns; None where no landing is planned."""
        landings = self._landings[foot]
        if not landings:
            return None
        return (stamp - min(landings, key=lambda planned: abs(planned - stamp))) / NANOSECONDS
