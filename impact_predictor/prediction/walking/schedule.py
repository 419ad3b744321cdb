"""What others say of the feet: a planner, when they are to land, and force sensors, whether they stand.

Neither decides a stance: landings are compared with a plan, and a force confirms them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from ...stamps import NANOSECONDS
from ..checks import LARGEST, PAUSE, order_of
from ..scene import Walking
from ..types import Schedule, Status, Wrench
from ..vectors import dot

LONGEST = 10_000_000_000
"""ns for which what was planned is remembered."""

FURTHEST = 1_000_000_000
"""ns from a planned landing beyond which a landing is another one, which nobody planned."""


class LandingSchedule:
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
            # Planners tell the same stance again and again: only its changes are kept.
            told = [*kept, *following]
            planned = told[:1] + [one for before, one in pairwise(told) if one[1] is not before[1]]
            self._stances[foot] = planned
            self._landings[foot] = [time for (_, before), (time, now) in pairwise(planned) if now and not before]
        return Status.ACCEPTED

    def late(self, foot: str, stamp: int) -> float | None:
        """How much later than planned, in s, a foot lands at a stamp in ns; None where none is planned near it."""
        planned = min(self._landings[foot], key=lambda planned: abs(planned - stamp), default=None)
        if planned is None or abs(stamp - planned) > FURTHEST:
            return None
        return (stamp - planned) / NANOSECONDS


class FootForces:
    """The last force on each foot of a machine."""

    def __init__(self, walking: Walking) -> None:
        self._feet = walking.feet
        self._least = walking.force**2
        self._timeout = round(walking.timeout * NANOSECONDS)
        self._pressed: dict[str, tuple[int, bool]] = {}

    def set(self, wrench: Wrench) -> Status:
        """Take the force on a foot; what became of the message."""
        foot, square = wrench.frame_id, dot(wrench.force, wrench.force)
        if foot not in self._feet:
            return Status.WRONG_FRAME
        if not square < LARGEST:
            return Status.NOT_FINITE
        last = self._pressed[foot][0] if foot in self._pressed else None
        status = order_of(wrench.stamp, last)
        if status is Status.ACCEPTED:
            self._pressed[foot] = wrench.stamp, square >= self._least
        elif last is not None and last - wrench.stamp > PAUSE:
            del self._pressed[foot]
        return status

    def agree(self, foot: str, stands: bool, stamp: int) -> bool | None:
        """Whether the sensor of a foot shows the same stance near a stamp in ns; None where it shows nothing then."""
        pressed = self._pressed.get(foot)
        if pressed is None or abs(stamp - pressed[0]) > self._timeout:
            return None
        return pressed[1] is stands
