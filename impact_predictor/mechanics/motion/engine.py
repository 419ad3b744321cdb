"""The motion engine: from event to event, which phase of a body on its support follows, up to its impacts.

`next_strike` follows a measured body to its first impact; `run` goes on from there.
"""

from __future__ import annotations

import math

from ..impact.contacts import MINUS, OPEN, PLUS, STICK
from ..types import TwoPointBody, Vector
from .equations import RockingBody, rocking_body, turned, two_points
from .events import Event
from .flight import FlightEnd, FlightPhase
from .phases import ContactPhase, MotionPhase, PhaseEnd
from .states import JAM, state_of_one, states_of_both
from .support import FeltSupport, FixedSupport, PlanarState
from .touchdown import Fall, MotionKind
from .trajectory import End

_LOOK_AHEAD = 1e-6
"""Part of a swing after which the states that follow a rest are asked for: at its very end two states agree."""
_OVERTURNED = 0.5 * math.pi
"""A body turned farther than this is not carried by its two contacts any more."""
_MOST_EVENTS = 100
"""More changes of stick, slip and flight before an impact come only from rounding."""
_MOST_STEPS = 1000
_SLIP_ROUNDING = 1e-12
"""A slip this small, relative to the speeds it is the difference of, is none: states come through conversions."""


class MotionEngine:
    """A body on its support at `time` s, and the phase that is next; `limit` rad is where it overturns."""

    def __init__(
        self,
        body: RockingBody,
        support: FeltSupport,
        time: float,
        until: float,
        limit: float,
        most: int,
        tolerance: float,
    ) -> None:
        self.body, self.support = body, support
        self.fixed = isinstance(support, FixedSupport)
        self.time, self.until, self.limit, self.most, self.tolerance = time, until, limit, most, tolerance
        weight = abs(support.gravity) or 1.0
        self.swing, self.speed = math.sqrt(body.length / weight), math.sqrt(body.length * weight)
        self.rests_from = 0.0
        """How long from now on a rest lasts anyway, in s."""
        self.since = 0.0
        """Time since the last impact, which between accumulating impacts is too short for the digits of `time`."""
        self.jams: list[float] = []
        self.end: End | None = None
        self.next: MotionPhase | None = None

    def _go_on(self) -> None:
        """Follow the next phase to its event, and find out what comes after it."""
        phase = self.next
        assert phase is not None
        end = self._follow(phase)
        if end is None:
            self.end = End.RESTS
            return
        self.time += end.at.time
        self.since += end.at.time
        if end.event in _ENDS:
            self.end = _ENDS[end.event]
        elif isinstance(phase, FlightPhase):
            self._land(phase.landing(end.at, end.contact))
        else:
            assert isinstance(phase, ContactPhase)
            self._change(phase, end)

    def _follow(self, phase: MotionPhase) -> PhaseEnd | None:
        """The end of a phase; None where it has none."""
        last = self.until - self.time
        if isinstance(phase, ContactPhase) and not phase.moves:
            return self._rest(phase, last)
        end = phase.follow(last, self.most)
        self.most -= len(phase.instants) - 2
        return end

    def _change(self, phase: ContactPhase, end: PhaseEnd) -> None:
        """An event of closed contacts."""
        (event, contact, at), i = end, phase.contact
        _, u, w, z, s, _, _ = at
        if event is Event.TOUCHES:
            self._strike_other(1 - contact, w, z, s)
        elif event is Event.YIELDS or (event is Event.STOPS and phase.both):
            self._hold(z, 0.0)
        elif event is Event.STOPS:
            self._stand(i, u, w, z, 0.0)
        elif event is Event.LIFTS and phase.both:
            self._start(1 - contact, phase.a, u, w, z, s)
        elif event is Event.LIFTS:
            self._fly(self.body.state(i, u, w, z, s), self._gaps(i, u))
        elif event is Event.JAMS:
            self._jam(i, u, w, z, s)
        else:
            self._slip(contact, PLUS if event is Event.SLIPS else MINUS, u, w, z)

    def _land(self, landing: FlightEnd) -> None:
        """A contact strikes out of flight, perhaps both at once."""
        body, new, state = self.body, landing.contact, landing.state
        u, gap = body.seen_from(new, state)[0], landing.gaps[1 - new]
        if abs(u) >= self.limit:
            self.end = End.OVERTURNED
            return
        if landing.together:
            both = [1 - new, new] if body.gap_rate(1 - new, state) <= 0.0 else [new]
            self._strike(both, state, 0.0)
            return
        for _ in range(2):  # the gap tells a small angle to its last digit
            here, slope = body.gap_of_other(new, u)
            if abs(slope) > 0.1 * body.length:
                u -= (here - gap) / slope
        self._strike([new], state, u)

    def _hold(self, z: float, s: float) -> None:
        """Both contacts are closed: rest, slide, or leave one."""
        ahead = 0.0 if self.fixed or s != 0.0 else _LOOK_AHEAD * min(self.swing, self.support.period)
        self.rests_from = ahead
        a, b = states_of_both(self.body, self.support.felt(self.time + ahead), z, s)
        if JAM in (a, b):
            self.jams.append(self.time)
            if a == b:
                self._hold(z, 0.0)
            else:
                self._jam(0 if a == JAM else 1, 0.0, 0.0, z, s)
        elif a == OPEN and b == OPEN:
            self._fly(self.body.state(0, 0.0, 0.0, z, s), (0.0, 0.0))
        else:
            self._begin_contact((a, b), 0.0, 0.0, z, s)

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
        state = state_of_one(self.body, i, self.support.felt(self.time), u, w, z, s)
        if state == JAM:
            self._jam(i, u, w, z, s)
        elif state == OPEN:
            self._fly(self.body.state(i, u, w, z, s), self._gaps(i, u))
        else:
            self._start(i, state, u, w, z, s)

    def _slip(self, i: int, slides: int, u: float, w: float, z: float) -> None:
        """A contact that stuck reaches the edge of its cone of friction: it slips, or leaves if it cannot."""
        forces = self.body.forces(i, slides, self.support.felt(self.time), u, w, z, 0.0)
        if math.isnan(forces.alpha):
            self._fly(self.body.state(i, u, w, z, 0.0), self._gaps(i, u))
        else:
            self._start(i, slides, u, w, z, 0.0)

    def _start(self, i: int, state: int, u: float, w: float, z: float, s: float) -> None:
        """The next phase is motion over contact i alone."""
        self._begin_contact((state, OPEN) if i == 0 else (OPEN, state), u, w, z, s)

    def _begin_contact(self, states: tuple[int, int], u: float, w: float, z: float, s: float) -> None:
        self.next = ContactPhase(
            body=self.body,
            support=self.support,
            states=states,
            start=self.time,
            place=(u, w, z, s),
            limit=self.limit,
            tolerance=self.tolerance,
        )

    def _gaps(self, i: int, u: float) -> Vector:
        """The gaps of both contacts while contact i is closed."""
        other = max(0.0, self.body.gap_of_other(i, u)[0])
        return (0.0, other) if i == 0 else (other, 0.0)

    def _fly(self, state: PlanarState, gaps: Vector) -> None:
        self.next = FlightPhase(self.body, self.support, self.time, state, gaps, self.tolerance)

    def _jam(self, i: int, u: float, w: float, z: float, s: float) -> None:
        """Slip that no finite reaction can go with ends at once; the angular momentum about the contact stays."""
        self.jams.append(self.time)
        w -= turned(self.body.arms[i], u)[1] * s / self.body.inertia[i]
        self._stand(i, u, w, z, 0.0)

    def _rest(self, phase: ContactPhase, last: float) -> PhaseEnd | None:
        """What ends a rest on both contacts within `last` s; None where nothing does."""
        return None

    def _strike(self, touching: list[int], state: PlanarState, u: float) -> None:
        """The last of the contacts that touch strikes, and perhaps the other one with it."""
        raise NotImplementedError

    def _strike_other(self, old: int, w: float, z: float, s: float) -> None:
        """The body stands on one contact, with both closed, and the other one strikes."""
        raise NotImplementedError


_ENDS = {
    Event.TIME_IS_UP: End.TIME_UP,
    Event.OVERTURNS: End.OVERTURNED,
    Event.BALANCES: End.BALANCED,
    Event.TAKES_TOO_LONG: End.TOO_MANY_EVENTS,
}


def next_strike(
    body: TwoPointBody,
    state: PlanarState,
    old: int | None,
    support: FeltSupport,
    duration: float,
    tolerance: float = 1e-9,
) -> Fall | None:
    """When, where and with which velocities a measured body strikes next over a fixed or moving support.

    `body` is as in `rock`, and so are its motions up to the first impact. `state`, in the support's frame at its time
    0, may be a measured one: contact `old` (0 is `body.old`, 1 `body.new`) is taken to stand, its gap and its normal
    velocity are dropped and its slip is kept. None is flight; in flight a body may have its contact `new` alone. A
    contact that is on the support or below it strikes at time 0 when it moves down, and after it has risen otherwise.
    `duration` in s; `tolerance` is the error allowed to a step, relative to what happens in it.

    The touchdown is told just before its impact: its time in s, the contact that strikes (0 or 1), the state in the
    support's frame. None where nothing strikes within the duration: the body rests on both contacts, balances,
    overturns, or takes longer. Numbers that are not finite, too, give None.

    Raises:
        InputError: the body is neither of the two shapes.
    """
    alone = body.old is None and old is None
    if alone:  # the contact opposite to it is above it until it touches
        body = body._replace(old=body.new._replace(x=-body.new.x, y=-body.new.y))
    engine = _ToStrike(two_points(body) if alone else rocking_body(body), support, duration, tolerance)
    if not math.isfinite(sum(state)):
        return None
    try:
        engine.follow(state, old, (1,) if alone else (0, 1))
    except ArithmeticError:  # numbers so large or so small that their products are none
        return None
    return None if alone and engine.fall is not None and engine.fall.point != 1 else engine.fall


class _ToStrike(MotionEngine):
    """The motion of a measured body to its first impact."""

    def __init__(self, body: RockingBody, support: FeltSupport, duration: float, tolerance: float) -> None:
        super().__init__(body, support, 0.0, duration, _OVERTURNED, _MOST_STEPS, tolerance)
        self.fall: Fall | None = None
        self.shift = 0.0

    def follow(self, state: PlanarState, old: int | None, contacts: tuple[int, ...]) -> None:
        """Go from event to event until a contact strikes or nothing more can."""
        body = self.body
        angle = math.remainder(state.angle + body.lean, 2.0 * math.pi)
        self.shift = state.angle - angle
        state = state._replace(angle=angle)
        if old is None:
            self._let_fly(state, contacts)
        else:
            u, w, z, s = body.seen_from(old, state)
            if abs(u) >= self.limit:
                return
            small = _SLIP_ROUNDING * (abs(state.vx) + abs(state.vy) + abs(state.omega) * body.length)
            self._stand(old, u, w, z, 0.0 if abs(s) <= small else s)
        for _ in range(_MOST_EVENTS):
            if self.fall is not None or self.end is not None:
                return
            self._go_on()

    def _let_fly(self, state: PlanarState, contacts: tuple[int, ...]) -> None:
        """No contact stands; one that is below the support is on it."""
        gaps = [max(0.0, self.body.gap(i, state.x, state.y, state.angle)) for i in (0, 1)]
        rates = [self.body.gap_rate(i, state) for i in (0, 1)]
        falling = [i for i in contacts if gaps[i] == 0.0 and rates[i] < 0.0]
        if falling:
            self._strike([min(falling, key=rates.__getitem__)], state, 0.0)
        else:
            self._fly(state, (gaps[0], gaps[1]))

    def _strike(self, touching: list[int], state: PlanarState, u: float) -> None:
        self._ends_with(touching[-1], state, MotionKind.FLIGHT)

    def _strike_other(self, old: int, w: float, z: float, s: float) -> None:
        phase = self.next
        slides = STICK not in (phase.a, phase.b) if isinstance(phase, ContactPhase) else s != 0.0
        state = self.body.state(old, 0.0, w, z, s)
        self._ends_with(1 - old, state, MotionKind.SLIDING if slides else MotionKind.TURNING)

    def _ends_with(self, new: int, state: PlanarState, motion: MotionKind) -> None:
        state = state._replace(angle=state.angle + self.shift)
        self.fall = Fall(time=self.time, point=new, state=state, motion=motion)
