"""`rock`: a body on two contacts from impact to impact, through accumulations of impacts, to rest or its other end."""

from __future__ import annotations

import math

from ..impact import number_of, solve_impact
from ..impact.answer import STAYS
from ..types import Flag, Twist, TwoPointBody, Validity
from .accumulation import FollowedImpact, ImpactSequence, Limit
from .engine import MotionEngine, Strike
from .equations import rocking_body
from .events import SLIP_ROUNDING, End
from .integrate import Instant
from .phases import MotionPhase, RockingProblem
from .support import FixedSupport, PlanarState, Support
from .touchdown import MotionKind
from .trajectory import Accumulation, RockingImpact, Trajectory, letters

_SPEED_ROUNDING = 1e-15
"""Part of a body's speeds that is rounding in the normal velocity at a contact."""
_BOUNCE = 1e-12
"""A body thrown up more slowly than this part of its natural speed has stopped bouncing."""
_QUIET = 1e-9
"""So has one whose contacts both move more slowly than this part of it, as bouncing within bouncing does."""
_NOTHING = 1e-100
"""Smaller numbers of a state are none: their products would be no numbers."""
_ACCUMULATION = 1e-12, 1e-11
"""Error allowed to a sum of accumulating impacts on a fixed and on a moving support, in the body's own scales."""
_TOUCHES = 1e-9
"""A contact of the start that is nearer to the support than this part of the body's size stands on it."""


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

    `body`: one with both normals (0, 1), as `rod` and `plate` make it, stands on two points fixed in it over the line y
    = 0 of the support's frame; one with normals through its mass centre, as `cylinder` makes it, is a disc over two
    edges fixed in the support, edge 0 being the origin of its frame. Friction and restitution are those of each
    contact, that of the old one too where it strikes. `start` is the state of the mass centre in the support's frame at
    `start_time` (s), see `standing`; a contact near the support is put on it. `law` is that of `solve_impact`. The
    motion is followed for `duration` s, until it is at rest for ever, or until it has turned by `overturned` rad from
    the pose with both contacts closed. It ends, too, after `max_events` events, or as many steps in all.
    `tolerance` is the error allowed to a step where a contact slips or the support moves, relative to what happens in
    the step; without both, turning is exact.

    What goes wrong with finite numbers is a named `End`, never an exception.

    Raises:
        InputError: the body is neither of the two shapes.
        ValueError: an unknown law.
    """
    number_of(law)
    flags = solve_impact(body, Twist(0.0, 0.0, 0.0), law).flags
    numbers = *start, duration, start_time, overturned, tolerance
    if flags & Flag.INVALID_INPUT or not all(map(math.isfinite, numbers)) or duration < 0.0:
        return Trajectory(body=body, support=support, law=law, start=start, time=start_time, end=End.INVALID_INPUT)
    problem = RockingProblem(rocking_body(body), support, overturned, tolerance)
    engine = MotionEngine(problem, start_time, start_time + duration, max_events, max_events, waits=True)
    return _RockingMotion(engine, body, support, law).follow(start)


class _RockingMotion:
    """One motion, while it is followed from impact to impact."""

    def __init__(self, engine: MotionEngine, body: TwoPointBody, support: Support, law: str) -> None:
        self.engine, self.body, self.two_point, self.support, self.law = engine, engine.body, body, support, law
        self.sequence = ImpactSequence(engine.swing, engine.speed, self.body.length, _ACCUMULATION[not engine.fixed])
        self.validity = Validity(gravity=abs(support.gravity))
        self.impacts: list[RockingImpact] = []
        self.accumulations: list[Accumulation] = []
        self.shift = 0.0
        """What is added to angles from the pose with both contacts closed."""
        self.counted = 0
        """Phases up to the last impact."""
        contacts = self.body.contact(0, 0.0), self.body.contact(1, 0.0)
        self.pairs = tuple(TwoPointBody(body.mass, body.inertia, contacts[old], contacts[1 - old]) for old in (0, 1))
        """The body as an impact law sees it when it stands on one contact and the other strikes."""

    def follow(self, start: PlanarState) -> Trajectory:
        """Follow the motion to its end."""
        engine = self.engine
        start = PlanarState(*[part if abs(part) >= _NOTHING else 0.0 for part in start])
        angle = math.remainder(start.angle + self.body.lean, 2.0 * math.pi)
        self.shift = start.angle - angle
        try:
            self._begin(start._replace(angle=angle))
            while strike := engine.next_strike():
                self._impact(strike)
        except ArithmeticError:  # numbers so large or so small that their products are none
            engine.end = End.NO_SOLUTION
        assert engine.end is not None
        motions = [phase for phase in engine.phases[:-1] if phase.end > phase.start] + engine.phases[-1:]
        return Trajectory(
            body=self.two_point,
            support=self.support,
            law=self.law,
            start=start,
            time=engine.time,
            end=engine.end,
            impacts=tuple(self.impacts),
            accumulations=tuple(self.accumulations),
            jams=tuple(engine.jams),
            motions=tuple(motions),
            shift=self.shift,
        )

    def _begin(self, state: PlanarState) -> None:
        """Put contacts that are near the support on it, and find out what the body does."""
        body, engine = self.body, self.engine
        near = _TOUCHES * body.length
        gaps = [body.gap(i, state.x, state.y, state.angle) for i in (0, 1)]
        first = 0 if gaps[0] <= gaps[1] else 1
        if gaps[first] > near:
            engine.fly(state, (gaps[0], gaps[1]))
            return
        closed = [first] if max(gaps) > near or max(gaps) - min(gaps) > near else [first, 1 - first]
        u, _, z, _ = body.seen_from(first, state)
        if len(closed) == 2:
            u = 0.0
        if abs(u) >= engine.problem.limit:
            engine.end = End.OVERTURNED
            return
        place = body.state(first, u, 0.0, z, 0.0)
        state = state._replace(x=place.x, y=place.y, angle=place.angle)
        small = SLIP_ROUNDING * (abs(state.vx) + abs(state.vy) + abs(state.omega) * body.length)
        rates = {i: body.gap_rate(i, state) for i in closed}
        held = sorted((i for i in closed if rates[i] <= small), key=lambda i: -rates[i])
        if not held:
            engine.fly(state, engine.gaps(first, u))
        elif rates[held[-1]] < -small:
            old = held[0] if len(held) == 2 else None
            engine.strike = Strike(old=old, new=held[-1], state=state, u=u, motion=MotionKind.FLIGHT)
        else:
            _, w, z, s = body.seen_from(held[0], state)
            s = 0.0 if abs(s) <= small else s
            engine.settle(held[0], u, 0.0 if len(held) == 2 else w, z, s)

    def _impact(self, strike: Strike) -> None:
        """Solve an impact, and find out what the body does after it."""
        body, engine, (old, new, before, u, _) = self.body, self.engine, strike
        struck = self.two_point._replace(old=None, new=body.contact(new, u)) if old is None else self.pairs[old]
        outcome = solve_impact(struck, Twist(before.vx, before.vy, before.omega), self.law, self.validity)
        if outcome.flags & (Flag.NO_SOLUTION | Flag.INVALID_INPUT):
            engine.end = End.NO_SOLUTION
            return
        vx, vy, omega = outcome.twist
        after = before._replace(vx=vx, vy=vy, omega=omega)
        impact = RockingImpact(
            time=engine.time,
            old=old,
            new=new,
            before=before._replace(angle=before.angle + self.shift),
            after=after._replace(angle=after.angle + self.shift),
            outcome=outcome,
        )
        self.impacts.append(impact)
        since = self._since_last()
        # Normal velocities against the approach alone: beside a fast slip the mode counts slow hops as none.
        touching = [new] if old is None else [old, new]
        approach = max(-body.gap_rate(i, before) for i in touching)
        size = abs(before.vx) + abs(before.vy) + abs(before.omega) * body.length
        least = STAYS * approach + (_SPEED_ROUNDING * size if body.rolls else 0.0)
        rates = [body.gap_rate(i, after) for i in (0, 1)]
        closed = [i for i in touching if rates[i] <= least]
        flat = any(body.restitution) and abs(body.gap_of_other(new, u)[0]) <= _QUIET * _QUIET * body.length
        quiet = flat and max(map(abs, rates)) <= _QUIET * engine.speed
        i = closed[-1] if closed else new
        _, w, z, s = body.seen_from(i, after)
        if len(closed) < len(touching):
            if quiet or (not closed and max(rates[i] for i in touching) <= _BOUNCE * engine.speed):
                self._quieten([0, 1] if quiet else touching, _QUIET if quiet else _BOUNCE, u, w, z, s)
                return
            kind = -1 if old is None else old, new, sum(1 << i for i in touching if i not in closed)
            limit = self.sequence.add(FollowedImpact(kind=kind, since=since, place=(u, w, z, s)))
            if limit is not None and self._stays_open(limit, since, after, new, u):
                self._accumulate(limit, after, new)
                return
        if closed:
            s = 0.0 if abs(s) <= STAYS * (size + approach) else s
            engine.settle(i, u, 0.0 if len(closed) == 2 else w, z, s)
        else:
            engine.fly(after, engine.gaps(new, u))

    def _since_last(self) -> float:
        """Time since the last impact, which between accumulating impacts is too short for the digits of the clock."""
        since, phases = 0.0, self.engine.phases
        for phase in phases[self.counted :]:
            since += phase.instants[-1].time
            if phase.both:
                self.sequence.forget()
        self.counted = len(phases)
        return since

    def _stays_open(self, limit: Limit, since: float, after: PlanarState, new: int, u: float) -> bool:
        """Whether nothing but the impacts that are summed can happen before their end.

        While one contact alone hops the other one may come down among the hops; then they are followed on.
        """
        if len(limit.contacts) == 2:
            return True
        gap, slope = self.body.gap_of_other(new, u)
        rate = min(0.0, self.body.gap_rate(1 - new, after), slope * limit.place[1])
        span, felt = limit.after + since, self.support.felt(self.engine.time)
        weight = abs(felt[0]) + abs(felt[1]) + self.body.length * (after.omega**2 + abs(felt[3]))
        return gap + (rate - 4.0 * weight * span) * span > 0.0

    def _quieten(self, contacts: list[int], part: float, u: float, w: float, z: float, s: float) -> None:
        """Contacts that hardly bounce any more are closed from now on: their hops may have no pattern to be summed."""
        engine, impacts = self.engine, self.sequence.impacts + 1
        if len(contacts) == 2:
            u = w = 0.0
        engine.settle(contacts[0], u, w, z, 0.0 if abs(s) <= part * engine.speed else s)
        error = 2.0 * part * engine.swing / max(0.01, 1.0 - max(self.body.restitution))
        self._add_accumulation(error, tuple(sorted(contacts)), impacts)

    def _accumulate(self, limit: Limit, after: PlanarState, new: int) -> None:
        """Pass from an impact to the end of all that follow it."""
        engine, (u, w, z, s) = self.engine, limit.place
        start, begin = engine.time, self.body.seen_from(new, after)
        engine.time = min(engine.time + limit.after, engine.until)
        if len(limit.contacts) == 2:
            u = w = 0.0
            begin = 0.0, 0.0, begin[2], begin[3]
        engine.settle(new, u, w, z, s)
        assert engine.next is not None
        summed = MotionPhase(engine.problem, engine.next.states, start, begin)
        summed.close(Instant(time=engine.time - start, u=u, w=w, z=z, s=s, alpha=0.0, beta=0.0))
        engine.phases.append(summed)
        self.counted = len(engine.phases)
        self._add_accumulation(limit.error, limit.contacts, limit.impacts)

    def _add_accumulation(self, error: float, contacts: tuple[int, ...], impacts: int) -> None:
        """Infinitely many impacts end now; the next phase is what follows them."""
        engine = self.engine
        assert engine.next is not None
        states = letters(engine.next.states)
        self.accumulations.append(
            Accumulation(time=engine.time, error=error, contacts=contacts, states=states, impacts=impacts)
        )
        self.sequence.forget()
