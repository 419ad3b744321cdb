"""What a body does next: which states its contacts are in, and the stretch of motion that begins."""

from __future__ import annotations

import math

from .motion import PlanarState
from .pair import OPEN, STICK
from .rocking_arcs import Arc, rate_of
from .rocking_bodies import shape_of
from .rocking_contacts import JAM, state_of_one, states_of_both
from .rocking_flight import Flight
from .rocking_follow import first_instant
from .rocking_run import End, Stretch
from .rocking_shape import turned
from .rocking_step import Instant
from .rocking_tail import Tail
from .support import FixedSupport, Support
from .types import TwoPointBody, Vector

_LOOK_AHEAD = 1e-6
"""Part of a swing after which the states that follow a rest are asked for: at its very end two states agree."""
_ACCUMULATION = 1e-12, 1e-11
"""Error allowed to a sum of accumulating impacts on a fixed and on a moving support, in the body's own scales."""

_TOUCHES = 1e-9
"""A contact of the start that is nearer to the support than this part of the body's size stands on it."""
_FLAT = 1e-14
"""A gap below this part of the body's size is rounding."""
_SPEED = 1e-12
"""A velocity of the start below this part of those it is the difference of is none."""
_BOTH = (0, 1)


class Course:
    """A body on its support now, and what it does next."""

    def __init__(
        self,
        body: TwoPointBody,
        support: Support,
        time: float,
        until: float,
        limit: float,
        tolerance: float,
    ) -> None:
        self.body, self.support = body, support
        self.shape = shape = shape_of(body)
        self.fixed = isinstance(support, FixedSupport)
        self.time, self.until, self.limit = time, until, limit
        self.tolerance = tolerance
        weight = abs(support.gravity) or 1.0
        self.swing, self.speed = math.sqrt(shape.length / weight), math.sqrt(shape.length * weight)
        self.tail = Tail(self.swing, self.speed, shape.length, _ACCUMULATION[0 if self.fixed else 1])
        self.since = self.wait_from = 0.0
        self.jams: list[float] = []
        self.end: End | None = None
        self.next: Stretch | None = None

    def _begin(self, state: PlanarState) -> None:
        """Put contacts that are near the support on it, and find out what the body does."""
        shape = self.shape
        near = _TOUCHES * shape.length
        gaps = [shape.gap(i, state.x, state.y, state.angle) for i in _BOTH]
        closed = sorted((i for i in _BOTH if gaps[i] <= near), key=lambda i: gaps[i])
        if len(closed) == 2 and gaps[closed[1]] - gaps[closed[0]] > near:
            del closed[1]
        if not closed:
            self._fly(state, (gaps[0], gaps[0] if abs(gaps[1] - gaps[0]) <= _FLAT * shape.length else gaps[1]))
            return
        flat = len(closed) == 2
        u = 0.0 if flat else shape.seen_from(closed[0], state)[0]
        if abs(u) >= self.limit:
            self._fly(state, (gaps[0], gaps[1]))
            self.end = End.OVERTURNED
            return
        z = shape.seen_from(closed[0], state)[2]
        place = shape.state(closed[0], u, 0.0, z, 0.0)
        state = state._replace(x=place.x, y=place.y, angle=place.angle)
        small = _SPEED * (abs(state.vx) + abs(state.vy) + abs(state.omega) * shape.length)
        speeds = {i: shape.gap_rate(i, state) for i in closed}
        held = [i for i in closed if speeds[i] <= small]
        held.sort(key=lambda i: -speeds[i])
        if not held:
            self._fly(state, self._gaps(closed[0], u))
        elif speeds[held[-1]] < -small:
            self._strike(held, state, u)
        else:
            _, w, z, s = shape.seen_from(held[0], state)
            s = 0.0 if abs(s) <= small else s
            if len(held) == 2:
                self._hold(z, s)
            else:
                self._stand(held[0], u, w, z, s)

    def _hold(self, z: float, s: float) -> None:
        """Both contacts are closed: rest, slide, or leave one."""
        ahead = 0.0 if self.fixed or s != 0.0 else _LOOK_AHEAD * min(self.swing, self.support.period)
        self.wait_from = ahead
        a, b = states_of_both(self.shape, self.support.felt(self.time + ahead), z, s)
        if JAM in (a, b):
            self.jams.append(self.time)
            if a == b:
                self._hold(z, 0.0)
            else:
                self._jam(0 if a == JAM else 1, 0.0, 0.0, z, s)
        elif a == OPEN and b == OPEN:
            self._fly(self.shape.state(0, 0.0, 0.0, z, s), (0.0, 0.0))
        elif a == OPEN or b == OPEN:
            self._arc(0 if b == OPEN else 1, a if b == OPEN else b, 0.0, 0.0, z, s)
        else:
            self.tail.forget()
            self._follow(a, b, 0.0, 0.0, z, s)

    def _stand(self, i: int, u: float, w: float, z: float, s: float) -> None:
        """Contact i alone is closed: stick, slip, or leave it."""
        side = 1.0 if i == 0 else -1.0
        u = u if side * u > 0.0 else 0.0
        if u == 0.0 and side * w <= 0.0:
            if w == 0.0:
                self._hold(z, s)
            else:
                self._strike_other(i, w, z, s)
            return
        state = state_of_one(self.shape, i, self.support.felt(self.time), u, w, z, s)
        if state == JAM:
            self._jam(i, u, w, z, s)
        elif state == OPEN:
            self._fly(self.shape.state(i, u, w, z, s), self._gaps(i, u))
        else:
            self._arc(i, state, u, w, z, s)

    def _slip(self, i: int, slides: int, u: float, w: float, z: float) -> None:
        """A contact that stuck reaches the edge of its cone of friction: it slips, or leaves if it cannot."""
        forces = self.shape.forces(i, slides, self.support.felt(self.time), u, w, z, 0.0)
        if math.isnan(forces.alpha):
            self._fly(self.shape.state(i, u, w, z, 0.0), self._gaps(i, u))
        else:
            self._arc(i, slides, u, w, z, 0.0)

    def _arc(self, i: int, state: int, u: float, w: float, z: float, s: float) -> None:
        a, b = (state, OPEN) if i == 0 else (OPEN, state)
        self._follow(a, b, u, w, z, s)

    def _follow(self, a: int, b: int, u: float, w: float, z: float, s: float) -> None:
        rests = a == STICK and b == STICK
        if rests:
            start = Instant(0.0, u, w, z, s, 0.0, 0.0)
        else:
            start = first_instant(rate_of(self.shape, self.support, a, b, self.time), u, w, z, s)
        self.next = Arc(self.shape, self.support, a, b, self.time, start, self.tolerance, not rests)

    def _gaps(self, i: int, u: float) -> Vector:
        """The gaps of both contacts while contact i is closed."""
        other = max(0.0, self.shape.gap_of_other(i, u)[0])
        return (0.0, other) if i == 0 else (other, 0.0)

    def _fly(self, state: PlanarState, gaps: Vector) -> None:
        self.next = Flight(self.shape, self.support, self.time, state, gaps, self.tolerance)

    def _strike(self, touching: list[int], state: PlanarState, u: float) -> None:
        """The last of the contacts that touch strikes, and perhaps the other one with it."""
        raise NotImplementedError

    def _strike_other(self, old: int, w: float, z: float, s: float) -> None:
        """The body stands on one contact, with both closed, and the other one strikes."""
        raise NotImplementedError

    def _jam(self, i: int, u: float, w: float, z: float, s: float) -> None:
        """Slip that no finite reaction can go with ends at once; the angular momentum about the contact stays."""
        self.jams.append(self.time)
        w -= turned(self.shape.arms[i], u)[1] * s / self.shape.inertia[i]
        self._stand(i, u, w, z, 0.0)
