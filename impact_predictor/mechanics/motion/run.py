"""`rock`: a body on two contacts from impact to impact, through accumulations of impacts, to rest or its other end."""

from __future__ import annotations

import math

from ..impact import number_of, solve_impact
from ..impact.answer import STAYS
from ..impact.contacts import OPEN
from ..types import Flag, Twist, TwoPointBody, Validity
from .accumulation import FollowedImpact, ImpactSequence, Limit
from .engine import MotionEngine
from .equations import rocking_body
from .integrate import Instant
from .phases import ContactPhase, MotionPhase, PhaseEnd
from .states import rest
from .support import FixedSupport, PlanarState, Support
from .trajectory import STATES, Accumulation, End, RockingImpact, Trajectory

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


def standing(body: TwoPointBody, angle: float, omega: float = 0.0, slip: float = 0.0, x: float = 0.0) -> PlanarState:
    """The state of a body that stands on its contacts, turned by `angle` (rad, CCW) from the pose with both closed.

    A positive angle stands on contact 0 and lifts contact 1, a negative one the reverse. `omega` in rad/s, of the
    turning about the contact; `slip` of the contact along its tangent in m/s; `x` in m is where contact 0 of a body on
    two points is when both are closed. In the support's frame.

    Raises:
        InputError: the body is not one that rocks (see `rock`).
    """
    rocking = rocking_body(body)
    state = rocking.state(1 if angle < 0.0 else 0, angle, omega, 0.0 if rocking.rolls else x, slip)
    return state._replace(angle=state.angle - rocking.lean)


def rock(
    body: TwoPointBody,
    start: PlanarState,
    support: Support = FixedSupport(),  # noqa: B008 - it is immutable
    law: str = "path",
    duration: float = 10.0,
    start_time: float = 0.0,
    overturned: float = 0.5 * math.pi,
    max_events: int = 100_000,
    tolerance: float = 1e-11,
) -> Trajectory:
    """Follow a body on two contacts over a support, from event to event.

    `body`: one with both normals (0, 1), as `rod` and `plate` make it, stands on two points fixed in it over the line
    y = 0 of the support's frame; one with normals through its mass centre, as `cylinder` makes it, is a disc over two
    edges fixed in the support, edge 0 being the origin of its frame. Friction and restitution are those of the
    contacts. `start` is the state of the mass centre in the support's frame at `start_time` (s), see `standing`; a
    contact near the support is put on it. `law` is that of `solve_impact`. The motion is followed for `duration` s,
    until it is at rest for ever, or until it has turned by `overturned` rad from the pose with both contacts closed.
    It ends, too, after `max_events` events, or as many steps in all.
    `tolerance` is the error allowed to a step where a contact slips or the support moves, relative to what happens in
    the step; without both, turning is exact.

    What goes wrong with finite numbers is a named `End`, never an exception.

    Raises:
        InputError: the body is neither of the two shapes.
        ValueError: an unknown law.
    """
    number_of(law)
    if not _is_valid(body, start, duration, start_time, overturned, tolerance):
        return Trajectory(body=body, support=support, law=law, start=start, time=start_time, end=End.INVALID_INPUT)
    until = start_time + duration
    return RockingEngine(body, support, law, start_time, until, overturned, max_events, tolerance).run(start)


def _is_valid(body: TwoPointBody, start: PlanarState, *numbers: float) -> bool:
    contacts = [body.new] if body.old is None else [body.old, body.new]
    values = [*start, *numbers, body.mass, body.inertia]
    for x, y, friction, (nx, ny), restitution, _ in contacts:
        values += [x, y, friction, nx, ny, restitution]
        if friction < 0.0 or not 0.0 <= restitution <= 1.0:
            return False
    return all(map(math.isfinite, values)) and body.mass > 0.0 and body.inertia > 0.0 and numbers[0] >= 0.0


class RockingEngine(MotionEngine):
    """One motion, while it is followed from impact to impact."""

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
        super().__init__(rocking_body(body), support, time, until, limit, max_events, tolerance)
        self.two_point, self.law, self.max_events = body, law, max_events
        allowed = _ACCUMULATION[0 if self.fixed else 1]
        self.sequence = ImpactSequence(self.swing, self.speed, self.body.length, allowed)
        self.validity = Validity(gravity=abs(support.gravity))
        self.phases: list[MotionPhase] = []
        self.impacts: list[RockingImpact] = []
        self.accumulations: list[Accumulation] = []
        contact = self.body.contact
        self.pairs = tuple(
            TwoPointBody(body.mass, body.inertia, contact(old, 0.0), contact(1 - old, 0.0)) for old in _BOTH
        )
        """The body as an impact law sees it when it stands on one contact and the other strikes."""

    def run(self, start: PlanarState) -> Trajectory:
        """Follow the motion to its end."""
        start = PlanarState(*[part if abs(part) >= _NOTHING else 0.0 for part in start])
        angle = math.remainder(start.angle + self.body.lean, 2.0 * math.pi)
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
        return Trajectory(
            body=self.two_point,
            support=self.support,
            law=self.law,
            start=start,
            time=self.time,
            end=self.end,
            shift=shift,
            phases=self.phases,
            impacts=impacts,
            accumulations=self.accumulations,
            jams=self.jams,
        )

    def _begin(self, state: PlanarState) -> None:
        """Put contacts that are near the support on it, and find out what the body does."""
        rocking = self.body
        near = _TOUCHES * rocking.length
        gaps = [rocking.gap(i, state.x, state.y, state.angle) for i in _BOTH]
        closed = sorted((i for i in _BOTH if gaps[i] <= near), key=lambda i: gaps[i])
        if len(closed) == 2 and gaps[closed[1]] - gaps[closed[0]] > near:
            del closed[1]
        if not closed:
            self._fly(state, (gaps[0], gaps[0] if abs(gaps[1] - gaps[0]) <= _FLAT * rocking.length else gaps[1]))
            return
        flat = len(closed) == 2
        u = 0.0 if flat else rocking.seen_from(closed[0], state)[0]
        if abs(u) >= self.limit:
            self._fly(state, (gaps[0], gaps[1]))
            self.end = End.OVERTURNED
            return
        z = rocking.seen_from(closed[0], state)[2]
        place = rocking.state(closed[0], u, 0.0, z, 0.0)
        state = state._replace(x=place.x, y=place.y, angle=place.angle)
        small = _SPEED * (abs(state.vx) + abs(state.vy) + abs(state.omega) * rocking.length)
        speeds = {i: rocking.gap_rate(i, state) for i in closed}
        held = [i for i in closed if speeds[i] <= small]
        held.sort(key=lambda i: -speeds[i])
        if not held:
            self._fly(state, self._gaps(closed[0], u))
        elif speeds[held[-1]] < -small:
            self._strike(held, state, u)
        else:
            _, w, z, s = rocking.seen_from(held[0], state)
            s = 0.0 if abs(s) <= small else s
            if len(held) == 2:
                self._hold(z, s)
            else:
                self._stand(held[0], u, w, z, s)

    def _follow_all(self) -> None:
        """One phase after the other, to the end."""
        still, last, events = 0, self.time, 0
        while self.end is None:
            if events >= self.max_events:
                self.end = End.TOO_MANY_EVENTS
                return
            assert self.next is not None
            self.phases.append(self.next)
            self._go_on()
            still = still + 1 if self.time <= last else 0
            if still > _STUCK:
                self.end = End.NO_SOLUTION
            events, last = events + 1, self.time

    def _rest(self, phase: ContactPhase, last: float) -> PhaseEnd | None:
        return None if self.fixed else rest(phase, self.rests_from, last, self.most)

    def _begin_contact(self, states: tuple[int, int], u: float, w: float, z: float, s: float) -> None:
        if OPEN not in states:
            self.sequence.forget()
        super()._begin_contact(states, u, w, z, s)

    def _strike(self, touching: list[int], state: PlanarState, u: float) -> None:
        """The last of the contacts that touch strikes, and perhaps the other one with it."""
        new = touching[-1]
        z = self.body.seen_from(new, state)[2]
        if len(touching) == 2:
            self._impact(self.pairs[1 - new], 1 - new, new, state, 0.0, z)
        else:
            alone = TwoPointBody(self.two_point.mass, self.two_point.inertia, None, self.body.contact(new, u))
            self._impact(alone, None, new, state, u, z)

    def _strike_other(self, old: int, w: float, z: float, s: float) -> None:
        """The body stands on one contact, with both closed, and the other one strikes."""
        self._impact(self.pairs[old], old, 1 - old, self.body.state(old, 0.0, w, z, s), 0.0, z)

    def _impact(self, body: TwoPointBody, old: int | None, new: int, before: PlanarState, u: float, z: float) -> None:
        outcome = solve_impact(body, Twist(before.vx, before.vy, before.omega), self.law, self.validity)
        if outcome.flags & (Flag.NO_SOLUTION | Flag.INVALID_INPUT):
            self.end = End.NO_SOLUTION
            return
        vx, vy, omega = outcome.twist
        after = before._replace(vx=vx, vy=vy, omega=omega)
        impact = RockingImpact(time=self.time, old=old, new=new, before=before, after=after, outcome=outcome)
        self.impacts.append(impact)
        since, self.since = self.since, 0.0
        # Normal velocities against the approach alone: beside a fast slip the mode counts slow hops as none.
        rocking = self.body
        touching = (new,) if old is None else (old, new)
        approach = max(-rocking.gap_rate(i, before) for i in touching)
        size = abs(before.vx) + abs(before.vy) + abs(before.omega) * rocking.length
        least = STAYS * approach + (_SPEED_ROUNDING * size if rocking.rolls else 0.0)
        rates = {i: rocking.gap_rate(i, after) for i in touching}
        leaving = [i for i in touching if rates[i] > least]
        closed = [i for i in touching if i not in leaving]
        _, w, _, s = rocking.seen_from(new, after)
        if self._is_quiet(after, new, u):
            self._quieten(_BOTH, _QUIET, u, w, z, s)
            return
        if not closed and max(rates.values()) <= _BOUNCE * self.speed:
            self._quieten(touching, _BOUNCE, u, w, z, s)
            return
        if leaving:
            i = closed[0] if closed else new
            _, w, _, s = rocking.seen_from(i, after)
            kind = -1 if old is None else old, new, sum(1 << i for i in leaving)
            limit = self.sequence.add(FollowedImpact(kind, since, (u, w, z, s)))
            if limit is not None and self._stays_open(limit, since, after, new, u):
                self._accumulate(limit, new)
                return
        if not closed:
            self._fly(after, self._gaps(new, u))
            return
        _, w, _, s = rocking.seen_from(closed[-1], after)
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
        gap, slope = self.body.gap_of_other(new, u)
        rate = min(0.0, self.body.gap_rate(1 - new, after), slope * limit.place[1])
        span, felt = limit.after + since, self.support.felt(self.time)
        weight = abs(felt[0]) + abs(felt[1]) + self.body.length * (after.omega**2 + abs(felt[3]))
        return gap + (rate - 4.0 * weight * span) * span > 0.0

    def _is_quiet(self, after: PlanarState, new: int, u: float) -> bool:
        """Whether both contacts bounce less than can matter: their hops may have no pattern that could be summed."""
        rocking = self.body
        if not any(rocking.restitution) or abs(rocking.gap_of_other(new, u)[0]) > _QUIET * _QUIET * rocking.length:
            return False
        return max(abs(rocking.gap_rate(i, after)) for i in _BOTH) <= _QUIET * self.speed

    def _quieten(self, contacts: tuple[int, ...], part: float, u: float, w: float, z: float, s: float) -> None:
        """Contacts that hardly bounce any more are closed from now on."""
        s = 0.0 if abs(s) <= part * self.speed else s
        impacts, self.since = self.sequence.impacts + 1, 0.0
        if len(contacts) == 2:
            self._hold(z, s)
        else:
            self._stand(contacts[0], u, w, z, s)
        error = 2.0 * part * self.swing / max(0.01, 1.0 - max(self.body.restitution))
        self._add_accumulation(error, tuple(sorted(contacts)), impacts)

    def _accumulate(self, limit: Limit, new: int) -> None:
        """Pass from an impact to the end of all that follow it."""
        u, w, z, s = limit.place
        start, place = self.time, self.body.seen_from(new, self.impacts[-1].after)
        self.time = min(self.time + limit.after, self.until)
        if len(limit.contacts) == 2:
            u = w = 0.0
            place = 0.0, 0.0, place[2], place[3]
            self._hold(z, s)
        else:
            self._stand(new, u, w, z, s)
        phase = self.next
        assert phase is not None
        summed = ContactPhase(
            body=self.body,
            support=self.support,
            states=(phase.a, phase.b),
            start=start,
            place=place,
            limit=self.limit,
            tolerance=self.tolerance,
        )
        end = Instant(time=self.time - start, u=u, w=w, z=z, s=s, alpha=0.0, beta=0.0)
        summed.close(end)
        self.phases.append(summed)
        self.since = 0.0
        self._add_accumulation(limit.error, limit.contacts, limit.impacts)

    def _add_accumulation(self, error: float, contacts: tuple[int, ...], impacts: int) -> None:
        """Infinitely many impacts end now; the next phase is what follows them."""
        phase = self.next
        assert phase is not None
        states = STATES[phase.a] + STATES[phase.b]
        self.accumulations.append(
            Accumulation(time=self.time, error=error, contacts=contacts, states=states, impacts=impacts)
        )
        self.sequence.forget()


def _ahead(state: PlanarState, angle: float) -> PlanarState:
    return state._replace(angle=state.angle + angle)
