"""When a planner wants feet to land: `LandingSchedule`. It decides no landing; landings are compared with it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from ...stamps import NANOSECONDS
from ..types import Schedule, Status

PLANNED: Final = 10_000_000_000  # ns for which what was planned is remembered
FURTHEST: Final = 1_000_000_000  # ns from a planned landing beyond which a landing is another one, which nobody planned
UNPLANNED: Final = 5  # landings in a row after which the plan itself is in doubt


class LandingSchedule:
    """The planned landings of some feet; a schedule replaces what was planned from its first time on."""

    def __init__(self, feet: Sequence[str]) -> None:
        self._stances: dict[str, list[tuple[int, bool]]] = {foot: [] for foot in feet}
        self._landings: dict[str, list[int]] = {foot: [] for foot in feet}
        # How many landings in a row nobody planned, and how many ns after the nearest planned one the last of them was.
        self._unplanned = self._apart = 0

    @property
    def doubt(self) -> str:
        """What looks wrong in the plan as a whole, and what to do; "" where nothing does."""
        if self._unplanned < UNPLANNED:
            return ""
        way = "before" if self._apart > 0 else "after"
        return (
            f"the last {self._unplanned} landings are more than {FURTHEST / NANOSECONDS:g} s from what schedule plans, "
            f"which is {abs(self._apart) / NANOSECONDS:.3g} s {way} them: let the planner stamp by the clock of odom"
        )

    def set(self, schedule: Schedule) -> Status:
        times = schedule.times
        if not set(schedule.feet) <= set(self._stances):
            return Status.FEET_CHANGED
        fits = len(schedule.stands) == len(times) and all(len(one) == len(schedule.feet) for one in schedule.stands)
        if not fits or any(b <= a for a, b in pairwise(times)):
            return Status.MALFORMED
        if not times:
            return Status.ACCEPTED
        for number, foot in enumerate(schedule.feet):
            kept = [one for one in self._stances[foot] if times[0] - PLANNED < one[0] < times[0]]
            following = [(time, stands[number]) for time, stands in zip(times, schedule.stands, strict=True)]
            # Planners tell the same stance again and again: only its changes are kept.
            told = [*kept, *following]
            planned = told[:1] + [one for before, one in pairwise(told) if one[1] != before[1]]
            self._stances[foot] = planned
            self._landings[foot] = [time for (_, before), (time, now) in pairwise(planned) if now and not before]
        return Status.ACCEPTED

    def late(self, foot: str, stamp: int) -> float | None:
        """How much later than planned, in s, a foot lands at a stamp in ns; None where none is planned near it."""
        late = self._after_planned(foot, stamp)
        return None if late is None or abs(late) > FURTHEST else late / NANOSECONDS

    def landed(self, foot: str, stamp: int) -> float | None:
        """As `late`, of a landing that has happened."""
        late, apart = self.late(foot, stamp), self._after_planned(foot, stamp)
        if apart is not None:
            self._unplanned, self._apart = 0 if late is not None else self._unplanned + 1, apart
        return late

    def _after_planned(self, foot: str, stamp: int) -> int | None:
        """How many ns after the nearest planned landing of a foot a stamp is."""
        landings = self._landings[foot]
        return min([stamp - planned for planned in landings], key=abs) if landings else None
