"""Flight: the mass centre is thrown and the body turns at a constant rate in the world."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..types import Vector
from .equations import RockingBody
from .events import Condition, Event
from .integrate import Instant, values_at
from .phases import MotionPhase
from .support import FeltSupport, FixedSupport, MovingSupport, PlanarState

_STEP = 0.25
"""Longest step, in times that a gap needs to change."""
_PART_OF_PERIOD = 0.0625
"""And in shortest periods of the support."""
_SHORTEST = 1e-9
"""What is at the support and does not leave it within this part of the longest step touches it."""
_BEYOND = 1.1
"""A step goes as much farther than where a gap would close."""
_ROUNDING = 1e-14
"""A gap below this part of what the body moved is rounding."""
_SPEED_ROUNDING = 1e-15
"""Part of a body's speeds that is rounding in the rate of a gap."""
_GAUSS = tuple(
    (0.5 + 0.5 * node, 0.5 * weight)
    for node, weight in (
        (-0.9061798459386640, 0.2369268850561891),
        (-0.5384693101056831, 0.4786286704993665),
        (0.0, 0.5688888888888889),
        (0.5384693101056831, 0.4786286704993665),
        (0.9061798459386640, 0.2369268850561891),
    )
)
"""Gauss' quadrature of order 10 on 0..1: nodes and weights."""


class FlightEnd(NamedTuple):
    """What ends a flight: the contact that touches, the state there and the gaps of the contacts (m)."""

    contact: int
    state: PlanarState
    gaps: Vector
    together: bool
    """Whether the other contact reaches the support at the same time, up to rounding."""


class FlightPhase(MotionPhase):
    """Flight from `state` with known gaps of the contacts; coordinates are the displacements of the mass centre.

    These count from the start, so that the gap of a contact that has just left keeps its digits, too.
    """

    def __init__(
        self, body: RockingBody, support: FeltSupport, start: float, state: PlanarState, gaps: Vector, tolerance: float
    ) -> None:
        super().__init__(body, support, start, 1.0, tolerance)
        self.state, self.gaps = state, gaps
        self.weight = math.hypot(self.felt[0], self.felt[1])
        self.events = (Event.TOUCHES, 0), (Event.TOUCHES, 1)
        if body.rolls:
            self.events = *self.events, (Event.OVERTURNS, 0)
        self._mark = 0.0, 0.0
        """A time and the angle turned until then."""
        ax, ay = self.rate(0.0, 0.0, state.vx, 0.0, state.vy)
        self.instants.append(Instant(time=0.0, u=0.0, w=state.vx, z=0.0, s=state.vy, alpha=ax, beta=ay))

    def rate(self, time: float, u: float, w: float, z: float, s: float) -> Vector:
        felt = self.felt if self.fixed else self.support.felt(self.start + time)
        return self.body.felt_at(felt, self.state.x + u, self.state.y + z, w, s)

    def _turned(self, time: float) -> Vector:
        """The angle turned since the start until a time, and the rate then."""
        omega, (since, turned) = self.state.omega, self._mark
        span = time - since
        if self.fixed:
            return turned + omega * span, omega
        felt, rate = self.support.felt, self.felt[2]
        for node, weight in _GAUSS:
            turned += weight * span * (omega + rate - felt(self.start + since + node * span)[2])
        return turned, omega + rate - felt(self.start + time)[2]

    def _pass(self, then: Instant) -> None:
        self._mark = then.time, self._turned(then.time)[0]
        super()._pass(then)

    def _state(self, now: Instant, turned: float, omega: float) -> PlanarState:
        x, y, angle, _, _, _ = self.state
        return PlanarState(x=x + now.u, y=y + now.z, angle=angle + turned, vx=now.w, vy=now.s, omega=omega)

    def at(self, time: Any) -> PlanarState:
        first, t = self.state, time - self.start
        x, vx, y, vy = values_at(self.dense(), t)
        assert isinstance(self.support, (FixedSupport, MovingSupport))
        begin, now = self.support.motion(self.start), self.support.motion(time)
        spin = first.omega + begin.rate
        angle = first.angle + spin * t - (now.angle - begin.angle)
        return PlanarState(x=first.x + x, y=first.y + y, angle=angle, vx=vx, vy=vy, omega=spin - now.rate)

    def conditions(self, now: Instant) -> list[Condition]:
        body, (turned, omega) = self.body, self._turned(now.time)
        state = self._state(now, turned, omega)
        gaps = [
            (self.gaps[i] + body.gap_change(i, self.state, now.u, now.z, turned), body.gap_rate(i, state))
            for i in (0, 1)
        ]
        if body.rolls:  # the height above the edges
            ex, ey = body.edges[1]
            size = math.hypot(ex, ey)
            gaps.append(((ex * state.y - ey * state.x) / size, (ex * state.vy - ey * state.vx) / size))
        return gaps

    def _first_step(self, now: Instant, last: float) -> float:
        pace = abs(self.state.omega) + math.sqrt(self.weight / self.body.length)
        self.longest = min(_STEP / pace if pace > 0.0 else math.inf, _PART_OF_PERIOD * self.support.period, last)
        self.shortest = _SHORTEST * self.longest
        return min(self.longest, self._reach(now, self._starting(self.conditions(now))))

    def _starting(self, conditions: list[Condition]) -> list[Condition]:
        # A contact that is leaving just now does not begin with a fall, whatever rounding says.
        _, _, _, vx, vy, omega = self.state
        rounding = _SPEED_ROUNDING * (abs(vx) + abs(vy) + abs(omega) * self.body.length)
        return [(gap, rate if gap > 0.0 or rate > rounding else 0.0) for gap, rate in conditions]

    def _reach(self, now: Instant, conditions: list[Condition]) -> float:
        # Under the weight at the start.
        reach, weight = math.inf, self.weight
        for gap, rate in conditions:
            gap = max(0.0, gap)
            root = math.sqrt(rate * rate + 2.0 * weight * gap)
            if rate > 0.0 and weight > 0.0:
                reach = min(reach, (rate + root) / weight)
            elif rate <= 0.0 and gap > 0.0 and root > 0.0:
                reach = min(reach, 2.0 * gap / (root - rate))
        return _BEYOND * reach

    def landing(self, end: Instant, contact: int) -> FlightEnd:
        """The end of the flight at an instant at which a contact touches."""
        turned, omega = self._turned(end.time)
        gap, _ = self.conditions(end)[1 - contact]
        other = max(0.0, gap)
        moved = self.gaps[1 - contact] + abs(end.u) + abs(end.z) + self.body.length * abs(turned)
        gaps = (0.0, other) if contact == 0 else (other, 0.0)
        state = self._state(end, turned, omega)
        return FlightEnd(contact=contact, state=state, gaps=gaps, together=other <= _ROUNDING * moved)
