"""What a body does next: which states its contacts are in, and the stretch of motion that begins."""

from __future__ import annotations

import math

from ..motion import PlanarState
from ..pair import MINUS, OPEN, PLUS, STICK
from ..support import FeltSupport, FixedSupport
from ..types import TwoPointBody, Vector
from .arcs import Arc, Happening, rate_of
from .bodies import shape_of
from .contacts import JAM, state_of_one, states_of_both
from .flight import Flight, Landing
from .follow import Event, first_instant, follow
from .run import End, Stretch
from .shape import turned
from .step import Instant
from .turn import turn_about

_LOOK_AHEAD = 1e-6
"""Part of a swing after which the states that follow a rest are asked for: at its very end two states agree."""


class Course:
    """A body on its support now, and what it does next."""

    def __init__(
        self,
        body: TwoPointBody,
        support: FeltSupport,
        time: float,
        until: float,
        limit: float,
        most: int,
        tolerance: float,
    ) -> None:
        self.body, self.support = body, support
        self.shape = shape = shape_of(body)
        self.fixed = isinstance(support, FixedSupport)
        self.time, self.until, self.limit, self.most, self.tolerance = time, until, limit, most, tolerance
        weight = abs(support.gravity) or 1.0
        self.swing, self.speed = math.sqrt(shape.length / weight), math.sqrt(shape.length * weight)
        self.wait_from = 0.0
        self.jams: list[float] = []
        self.end: End | None = None
        self.next: Stretch | None = None

    def _go_on(self) -> None:
        """Follow the next stretch to its event, and find out what comes after it."""
        one = self.next
        assert one is not None
        if isinstance(one, Flight):
            landing = one.follow(self.until - self.time, self.most)
            self.most -= len(one.instants)
            self._pass(landing.time)
            if landing.happening is Happening.TOUCHES:
                self._land(landing)
            else:
                self.end = _ENDS[landing.happening]
            return
        event = self._event_of(one)
        if event is None:
            self.end = End.RESTS
            return
        self._pass(event.at.time)
        if event.happening in _ENDS:
            self.end = _ENDS[event.happening]
        else:
            self._change(one, *event)

    def _event_of(self, arc: Arc) -> Event | None:
        if arc.a == STICK and arc.b == STICK:
            return self._rest(arc)
        if self.fixed and STICK in (arc.a, arc.b):
            return turn_about(arc, self.until - self.time, self.limit)
        event = follow(arc, self.until - self.time, self.limit, self.most)
        self.most -= len(arc.instants)
        return event

    def _pass(self, span: float) -> None:
        self.time += span

    def _change(self, arc: Arc, happening: Happening, contact: int, at: Instant) -> None:
        """An event of closed contacts."""
        _, u, w, z, s, _, _ = at
        both = arc.a != OPEN and arc.b != OPEN
        if happening is Happening.TOUCHES:
            self._strike_other(1 - contact, w, z, s)
        elif happening is Happening.YIELDS or (happening is Happening.STOPS and both):
            self._hold(z, 0.0)
        elif happening is Happening.STOPS:
            self._stand(arc.contact, u, w, z, 0.0)
        elif happening is Happening.LIFTS and both:
            self._arc(1 - contact, arc.a, u, w, z, s)
        elif happening is Happening.LIFTS:
            self._fly(self.shape.state(arc.contact, u, w, z, s), self._gaps(arc.contact, u))
        elif happening is Happening.JAMS:
            self._jam(arc.contact, u, w, z, s)
        else:
            self._slip(contact, PLUS if happening is Happening.SLIPS else MINUS, u, w, z)

    def _land(self, landing: Landing) -> None:
        """A contact strikes out of flight, perhaps both at once."""
        shape, new, state = self.shape, landing.contact, landing.state
        u, gap = shape.seen_from(new, state)[0], landing.gaps[1 - new]
        if abs(u) >= self.limit:
            self.end = End.OVERTURNED
            return
        if landing.together:
            both = [1 - new, new] if shape.gap_rate(1 - new, state) <= 0.0 else [new]
            self._strike(both, state, 0.0)
            return
        for _ in range(2):  # the gap tells a small angle to its last digit
            here, slope = shape.gap_of_other(new, u)
            if abs(slope) > 0.1 * shape.length:
                u -= (here - gap) / slope
        self._strike([new], state, u)

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

    def _rest(self, arc: Arc) -> Event | None:
        """What ends a rest on both contacts; None where nothing does."""
        raise NotImplementedError

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


_ENDS = {
    Happening.TIME_IS_UP: End.TIME_UP,
    Happening.OVERTURNS: End.OVERTURNED,
    Happening.BALANCES: End.BALANCED,
    Happening.TAKES_TOO_LONG: End.TOO_MANY_EVENTS,
}
