"""From event to event: what a body on two contacts does next, and what comes of its impacts."""

from __future__ import annotations

from ..answer import STAYS
from ..impact import solve_impact
from ..motion import PlanarState
from ..pair import OPEN
from ..support import Support
from ..types import Flag, Twist, TwoPointBody, Validity
from .arcs import Arc
from .course import Course
from .follow import Event
from .run import STATES, Accumulation, End, Run, Stretch, Strike
from .step import Instant
from .tail import Limit, Tail
from .wait import wait

_SPEED_ROUNDING = 1e-15
"""Part of a body's speeds that is rounding in the normal velocity at a contact."""
_BOUNCE = 1e-12
"""A body thrown up more slowly than this part of its natural speed has stopped bouncing."""
_QUIET = 1e-9
"""So has one whose contacts both move more slowly than this part of it, as bouncing within bouncing does."""
_STUCK = 1000
"""Events without any time between them; more come only from rounding."""
_NOTHING = 1e-100
"""Smaller numbers of a state are none: their products would be no numbers."""
_ACCUMULATION = 1e-12, 1e-11
"""Error allowed to a sum of accumulating impacts on a fixed and on a moving support, in the body's own scales."""
_TOUCHES = 1e-9
"""A contact of the start that is nearer to the support than this part of the body's size stands on it."""
_FLAT = 1e-14
"""A gap below this part of the body's size is rounding."""
_SPEED = 1e-12
"""A velocity of the start below this part of those it is the difference of is none."""
_BOTH = (0, 1)


class Rocking(Course):
    """One run, while it is followed."""

    support: Support

    def __init__(
        self,
        body: TwoPointBody,
        support: Support,
        law: str,
        time: float,
        until: float,
        limit: float,
        max_events: int,
        tolerance: float,
    ) -> None:
        super().__init__(body, support, time, until, limit, max_events, tolerance)
        self.law, self.max_events = law, max_events
        self.tail = Tail(self.swing, self.speed, self.shape.length, _ACCUMULATION[0 if self.fixed else 1])
        self.since = 0.0
        self.validity = Validity(gravity=abs(support.gravity))
        self.stretches: list[Stretch] = []
        self.impacts: list[Strike] = []
        self.accumulations: list[Accumulation] = []
        contact = self.shape.contact
        self.pairs = tuple(
            TwoPointBody(body.mass, body.inertia, contact(old, 0.0), contact(1 - old, 0.0)) for old in _BOTH
        )
        """The body as an impact law sees it when it stands on one contact and the other strikes."""

    def run(self, start: PlanarState) -> Run:
        """Follow the motion to its end."""
        start = PlanarState(*[part if abs(part) >= _NOTHING else 0.0 for part in start])
        angle = self.shape.own_angle(start.angle)
        shift = start.angle - angle
        try:
            self._begin(start._replace(angle=angle))
            self._follow_all()
        except ArithmeticError:  # numbers so large or so small that their products are none
            self.end = End.NO_SOLUTION
        assert self.end is not None
        impacts = [
            one._replace(before=_ahead(one.before, shift), after=_ahead(one.after, shift)) for one in self.impacts
        ]
        return Run(
            self.body,
            self.support,
            self.law,
            self.stretches,
            shift,
            self.end,
            self.time,
            start,
            impacts,
            self.accumulations,
            self.jams,
        )

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

    def _follow_all(self) -> None:
        """One stretch after the other, to the end."""
        still, last, events = 0, self.time, 0
        while self.end is None:
            if events >= self.max_events:
                self.end = End.TOO_MANY_EVENTS
                return
            self._go_on()
            still = still + 1 if self.time <= last else 0
            if still > _STUCK:
                self.end = End.NO_SOLUTION
            events, last = events + 1, self.time

    def _go_on(self) -> None:
        assert self.next is not None
        self.stretches.append(self.next)
        super()._go_on()

    def _pass(self, span: float) -> None:
        """Time passes; the short spans between accumulating impacts are kept apart from it, with all their digits."""
        self.since += span
        super()._pass(span)

    def _rest(self, arc: Arc) -> Event | None:
        return None if self.fixed else wait(arc, self.wait_from, self.until - self.time, self.most)

    def _follow(self, a: int, b: int, u: float, w: float, z: float, s: float) -> None:
        if a != OPEN and b != OPEN:
            self.tail.forget()
        super()._follow(a, b, u, w, z, s)

    def _strike(self, touching: list[int], state: PlanarState, u: float) -> None:
        """The last of the contacts that touch strikes, and perhaps the other one with it."""
        new = touching[-1]
        z = self.shape.seen_from(new, state)[2]
        if len(touching) == 2:
            self._impact(self.pairs[1 - new], 1 - new, new, state, 0.0, z)
        else:
            alone = TwoPointBody(self.body.mass, self.body.inertia, None, self.shape.contact(new, u))
            self._impact(alone, None, new, state, u, z)

    def _strike_other(self, old: int, w: float, z: float, s: float) -> None:
        """The body stands on one contact, with both closed, and the other one strikes."""
        self._impact(self.pairs[old], old, 1 - old, self.shape.state(old, 0.0, w, z, s), 0.0, z)

    def _impact(self, body: TwoPointBody, old: int | None, new: int, before: PlanarState, u: float, z: float) -> None:
        outcome = solve_impact(body, Twist(before.vx, before.vy, before.omega), self.law, self.validity)
        if outcome.flags & (Flag.NO_SOLUTION | Flag.INVALID_INPUT):
            self.end = End.NO_SOLUTION
            return
        vx, vy, omega = outcome.twist
        after = before._replace(vx=vx, vy=vy, omega=omega)
        self.impacts.append(Strike(self.time, old, new, before, after, outcome))
        since, self.since = self.since, 0.0
        # Normal velocities against the approach alone: beside a fast slip the mode counts slow hops as none.
        shape = self.shape
        touching = (new,) if old is None else (old, new)
        approach = max(-shape.gap_rate(i, before) for i in touching)
        size = abs(before.vx) + abs(before.vy) + abs(before.omega) * shape.length
        least = STAYS * approach + (_SPEED_ROUNDING * size if shape.rolls else 0.0)
        rates = {i: shape.gap_rate(i, after) for i in touching}
        leaving = [i for i in touching if rates[i] > least]
        closed = [i for i in touching if i not in leaving]
        _, w, _, s = shape.seen_from(new, after)
        if self._is_quiet(after, new, u):
            self._quieten(_BOTH, _QUIET, u, w, z, s)
            return
        if not closed and max(rates.values()) <= _BOUNCE * self.speed:
            self._quieten(touching, _BOUNCE, u, w, z, s)
            return
        if leaving:
            i = closed[0] if closed else new
            _, w, _, s = shape.seen_from(i, after)
            key = -1 if old is None else old, new, sum(1 << i for i in leaving)
            limit = self.tail.add(key, since, (u, w, z, s))
            if limit is not None and self._stays_open(limit, since, after, new, u):
                self._accumulate(limit, new)
                return
        if not closed:
            self._fly(after, self._gaps(new, u))
            return
        _, w, _, s = shape.seen_from(closed[-1], after)
        s = 0.0 if abs(s) <= STAYS * (size + approach) else s
        if len(closed) == 2:
            self._hold(z, s)
        else:
            self._stand(closed[0], u, w, z, s)

    def _stays_open(self, limit: Limit, since: float, after: PlanarState, new: int, u: float) -> bool:
        """Whether nothing but the impacts that are summed can happen before their end.

        While one contact alone hops the other one may come down among the hops; then they are followed on.
        """
        if len(limit.contacts) == 2:
            return True
        gap, slope = self.shape.gap_of_other(new, u)
        rate = min(0.0, self.shape.gap_rate(1 - new, after), slope * limit.values[1])
        span, felt = limit.after + since, self.support.felt(self.time)
        weight = abs(felt[0]) + abs(felt[1]) + self.shape.length * (after.omega**2 + abs(felt[3]))
        return gap + (rate - 4.0 * weight * span) * span > 0.0

    def _is_quiet(self, after: PlanarState, new: int, u: float) -> bool:
        """Whether both contacts bounce less than can matter: their hops may have no pattern that could be summed."""
        shape = self.shape
        if not any(shape.restitution) or abs(shape.gap_of_other(new, u)[0]) > _QUIET * _QUIET * shape.length:
            return False
        return max(abs(shape.gap_rate(i, after)) for i in _BOTH) <= _QUIET * self.speed

    def _quieten(self, contacts: tuple[int, ...], part: float, u: float, w: float, z: float, s: float) -> None:
        """Contacts that hardly bounce any more are closed from now on."""
        s = 0.0 if abs(s) <= part * self.speed else s
        impacts, self.since = self.tail.impacts + 1, 0.0
        if len(contacts) == 2:
            self._hold(z, s)
        else:
            self._stand(contacts[0], u, w, z, s)
        one = self.next
        assert one is not None
        error = 2.0 * part * self.swing / max(0.01, 1.0 - max(self.shape.restitution))
        self.accumulations.append(
            Accumulation(self.time, error, tuple(sorted(contacts)), STATES[one.a] + STATES[one.b], impacts)
        )
        self.tail.forget()

    def _accumulate(self, limit: Limit, new: int) -> None:
        """Pass from an impact to the end of all that follow it."""
        u, w, z, s = limit.values
        last = self.impacts[-1]
        now, start = self.time, Instant(0.0, *self.shape.seen_from(new, last.after), 0.0, 0.0)
        self.time = min(self.time + limit.after, self.until)
        if len(limit.contacts) == 2:
            u = w = 0.0
            start = start._replace(u=0.0, w=0.0)
            self._hold(z, s)
        else:
            self._stand(new, u, w, z, s)
        one = self.next
        assert one is not None
        rest = Arc(self.shape, self.support, one.a, one.b, now, start, self.tolerance, True)
        rest.close(Instant(self.time - now, u, w, z, s, 0.0, 0.0))
        self.stretches.append(rest)
        states = STATES[one.a] + STATES[one.b]
        self.accumulations.append(Accumulation(self.time, limit.error, limit.contacts, states, limit.impacts))
        self.since = 0.0
        self.tail.forget()


def _ahead(state: PlanarState, angle: float) -> PlanarState:
    return state._replace(angle=state.angle + angle)
