"""Impacts that accumulate: infinitely many in finite time, of which the rest is summed.

Once the hops are small, what happens in a cycle of impacts is what happened in the one before times a factor, in time
and in every velocity, but for terms that vanish with the hops. So the limit of the times (and of slip and place) is had
by Aitken's extrapolation; the rest is summed when two cycles in a row extrapolate to the same limit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

_LONGEST_CYCLE = 4
"""Impacts in a cycle: one where both contacts are alike, two otherwise; more where both bounce."""
_KEPT = 3 * _LONGEST_CYCLE + 1
_FOLLOWED = 8
"""Impacts of a sequence that are followed one by one, however soon the rest could be summed."""
_SLOWEST = 0.9999
"""A factor nearer to 1 is not told from 1."""

Place = tuple[float, float, float, float]
"""u (rad), w (rad/s), z (m) and s (m/s): see `equations`."""


class FollowedImpact(NamedTuple):
    """An impact, `since` s after the one before, with the place after it.

    `kind` is old contact (-1: none), new contact and which ones leave.
    """

    kind: tuple[int, int, int]
    since: float
    place: Place


class Limit(NamedTuple):
    """Where impacts accumulate: time `after` the last one and a bound on its `error` (s), the place there, the contacts
    that are closed then, and how many impacts were seen.
    """

    after: float
    error: float
    place: Place
    contacts: tuple[int, ...]
    impacts: int


class ImpactSequence:
    """Watches the impacts of a body for an accumulation."""

    def __init__(self, time: float, speed: float, length: float, tolerance: float) -> None:
        """Scales of the body: `time` s, `speed` m/s, `length` m; `tolerance` relative to them."""
        self.time, self.speed, self.length, self.tolerance = time, speed, length, tolerance
        self.forget()

    def forget(self) -> None:
        """Begin a new sequence."""
        self.rows: list[FollowedImpact] = []
        self.impacts = 0

    def add(self, impact: FollowedImpact) -> Limit | None:
        """One more impact; the limit when the rest can be summed."""
        rows = self.rows = [*self.rows[1 - _KEPT :], impact]
        self.impacts += 1
        if self.impacts < _FOLLOWED:
            return None
        for period in range(1, _LONGEST_CYCLE + 1):
            again = range(1, 2 * period + 1)
            if len(rows) > 3 * period and all(rows[-k].kind == rows[-k - period].kind for k in again):
                return self._limit(period)
        return None

    def _limit(self, period: int) -> Limit | None:
        rows, allowed = self.rows, self.tolerance
        cycles = (rows[len(rows) - k * period :][:period] for k in (3, 2, 1))
        first, before, last = (math.fsum(row.since for row in cycle) for cycle in cycles)
        if not 0.0 < last < _SLOWEST * before or not before < _SLOWEST * first:
            return None
        part, part_before = last / (before - last), before / (first - before)
        after = last * part
        error = abs(after + last - before * part_before) * max(1.0, part)
        now, once, twice = (rows[-1 - k * period].place for k in range(3))
        u, w, z, s = [a + (a - b) * part for a, b in zip(now, once, strict=True)]
        earlier = [b + (b - c) * part_before for b, c in zip(once, twice, strict=True)]
        scales = 1.0, 1.0 / self.time, self.length, self.speed
        off = [abs(a - b) * max(1.0, part) / scale for a, b, scale in zip((u, w, z, s), earlier, scales, strict=True)]
        if max(error / self.time, *off) > allowed:
            return None
        if abs(s) <= allowed * self.speed:
            s = 0.0
        elif s * now[3] < 0.0 or abs(s) < 0.5 * abs(now[3]):
            return None  # the slip ends before the impacts do
        contacts = sorted({contact for row in rows[-period:] for contact in row.kind[:2] if contact >= 0})
        return Limit(after=after, error=error, place=(u, w, z, s), contacts=tuple(contacts), impacts=self.impacts)
