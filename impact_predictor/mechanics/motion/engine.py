"""The motion engine: from event to event, which phase of a body on its support follows, up to each strike.

`next_strike` follows a measured body to its first strike; `run` solves the impact of each and goes on.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from ..impact.contacts import MINUS, OPEN, PLUS
from ..types import TwoPointBody, Vector
from .equations import rocking_body, turned, two_points
from .events import SLIP_ROUNDING, End, Event
from .phases import FlightPhase, MotionPhase, PhaseEnd, RockingProblem
from .states import JAM, rest, state_of_one, states_of_both
from .support import FeltSupport, PlanarState
from .touchdown import Fall, MotionKind

_LOOK_AHEAD: Final = 1e-6
"""Part of a swing after which the states that follow a rest are asked for: at its very end two states agree."""
_OVERTURNED: Final = 0.5 * math.pi
"""A body turned farther than this is not carried by its two contacts any more."""
_MOST_EVENTS: Final = 100
"""More changes of stick, slip and flight before an impact come only from rounding."""
_MOST_STEPS: Final = 1000
_STUCK: Final = 1000
"""Events without any time between them; more come only from rounding."""


class Strike(NamedTuple):
    """Contact `new` strikes, just before its impact, of a body that stands on contact `old` or strikes it, too.

    Where `old` is None the body stands on `new` alone from then on, at an angle `u` to the pose with both closed.
    """

    old: int | None
    new: int
    state: PlanarState
    u: float
    motion: MotionKind


class MotionEngine:
    """A body on its support at `time` s, and the phase that is next."""

    def __init__(
        self, problem: RockingProblem, time: float, until: float, most_events: int, most_steps: int, waits: bool
    ) -> None:
        """Follow `most_events` events and `most_steps` steps at most; a rest on a moving support is the end, unless the
        engine `waits` until the body moves.
        """
        self.problem, self.body, self.support, self.fixed = problem, problem.body, problem.support, problem.fixed
        self.time, self.until, self.waits = time, until, waits
        self.events, self.most = most_events, most_steps
        length, weight = problem.body.length, abs(problem.support.gravity) or 1.0
        self.swing, self.speed = math.sqrt(length / weight), math.sqrt(length * weight)
        self.rests_from = 0.0
        """How long from now on a rest lasts anyway, in s."""
        self.still = 0
        """Events since time last went on."""
        self.phases: list[MotionPhase] = []
        self.jams: list[float] = []
        self.next: MotionPhase | None = None
        self.strike: Strike | None = None
        self.end: End | None = None

    def next_strike(self) -> Strike | None:
        """Follow the motion until a contact strikes; None where nothing strikes any more, and `end` tells why."""
        while self.strike is None and self.end is None:
            if self.events <= 0:
                self.end = End.TOO_MANY_EVENTS
                break
            self.events -= 1
            self._follow_next()
        found, self.strike = self.strike, None
        return found

    def settle(self, i: int, u: float, w: float, z: float, s: float) -> None:
        """Contact i is closed, and the other one, too, where u and w are 0: stick, slip, leave, or strike at once."""
        side = 1.0 if i == 0 else -1.0
        u = u if side * u > 0.0 else 0.0
        if u == 0.0 and side * w < 0.0:
            self._strike_other(i, w, z, s)
            return
        if u == w == 0.0:
            ahead = 0.0 if self.fixed or s != 0.0 else _LOOK_AHEAD * min(self.swing, self.support.period)
            self.rests_from = ahead
            states = states_of_both(self.body, self.support.felt(self.time + ahead), z, s)
        else:
            state = state_of_one(self.body, i, self.support.felt(self.time), u, w, z, s)
            states = (state, OPEN) if i == 0 else (OPEN, state)
        if states == (JAM, JAM):
            self.jams.append(self.time)
            self.settle(i, 0.0, 0.0, z, 0.0)
        elif JAM in states:
            self._jam(states.index(JAM), u, w, z, s)
        else:
            self._begin(states, i, u, w, z, s)

    def fly(self, state: PlanarState, gaps: Vector) -> None:
        """No contact is closed; `gaps` in m."""
        self.next = FlightPhase(self.problem, self.time, state, gaps)

    def gaps(self, i: int, u: float) -> Vector:
        """The gaps of both contacts while contact i is closed."""
        other = max(0.0, self.body.gap_of_other(i, u)[0])
        return (0.0, other) if i == 0 else (other, 0.0)

    def _begin(self, states: tuple[int, int], i: int, u: float, w: float, z: float, s: float) -> None:
        """The next phase, in which the contacts have these states; contact i was closed."""
        if states == (OPEN, OPEN):
            self.fly(self.body.state(i, u, w, z, s), self.gaps(i, u))
            return
        self.next = MotionPhase(self.problem, states, self.time, (u, w, z, s))

    def _follow_next(self) -> None:
        """Follow the next phase to its event, and find out what comes after it."""
        phase, last = self.next, self.until - self.time
        assert phase is not None
        self.phases.append(phase)
        if phase.moves:
            end = phase.follow(last, self.most)
            self.most -= len(phase.instants) - 2
        elif self.waits and not self.fixed:
            end = rest(phase, self.rests_from, last, self.most)
        else:
            self.end = End.RESTS
            return
        before, self.time = self.time, self.time + end.at.time
        self.still = 0 if self.time > before else self.still + 1
        if self.still > _STUCK:
            self.end = End.NO_SOLUTION
        elif isinstance(end.event, End):
            self.end = end.event
        elif isinstance(phase, FlightPhase):
            self._land(phase, end)
        else:
            self._change(phase, end)

    def _change(self, phase: MotionPhase, end: PhaseEnd) -> None:
        """An event of closed contacts."""
        (event, contact, at), i = end, phase.contact
        u, w, z, s = at.u, at.w, at.z, at.s
        if event is Event.TOUCHES:
            self._strike_other(1 - contact, w, z, s)
        elif event is Event.YIELDS or event is Event.STOPS:
            self.settle(i, u, w, z, 0.0)
        elif event is Event.LIFTS:
            a, b = phase.states
            self._begin((OPEN, b) if contact == 0 else (a, OPEN), i, u, w, z, s)
        elif event is Event.JAMS:
            self._jam(i, u, w, z, s)
        else:  # the edge of its cone of friction: it slips, or leaves if it cannot
            state = PLUS if event is Event.SLIPS else MINUS
            if math.isnan(self.body.forces(i, state, self.support.felt(self.time), u, w, z, 0.0).alpha):
                state = OPEN
            self._begin((state, OPEN) if i == 0 else (OPEN, state), i, u, w, z, 0.0)

    def _land(self, phase: FlightPhase, end: PhaseEnd) -> None:
        """A contact strikes out of flight, perhaps both at once."""
        body, new = self.body, end.contact
        state, gap, together = phase.landing(end.at, new)
        u = body.seen_from(new, state)[0]
        if abs(u) >= self.problem.limit:
            self.end = End.OVERTURNED
            return
        old = None
        if together:
            u = 0.0
            old = 1 - new if body.gap_rate(1 - new, state) <= 0.0 else None
        else:
            for _ in range(2):  # the gap tells a small angle to its last digit
                here, slope = body.gap_of_other(new, u)
                if abs(slope) > 0.1 * body.length:
                    u -= (here - gap) / slope
        self.strike = Strike(old=old, new=new, state=state, u=u, motion=MotionKind.FLIGHT)

    def _jam(self, i: int, u: float, w: float, z: float, s: float) -> None:
        """Slip that no finite reaction can go with ends at once; the angular momentum about the contact stays."""
        self.jams.append(self.time)
        w -= turned(self.body.arms[i], u)[1] * s / self.body.inertia[i]
        self.settle(i, u, w, z, 0.0)

    def _strike_other(self, old: int, w: float, z: float, s: float) -> None:
        """The body stands on one contact, with both closed, and the other one strikes."""
        motion = MotionKind.SLIDING if s else MotionKind.TURNING
        self.strike = Strike(old=old, new=1 - old, state=self.body.state(old, 0.0, w, z, s), u=0.0, motion=motion)


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
    problem = RockingProblem(two_points(body) if alone else rocking_body(body), support, _OVERTURNED, tolerance)
    engine = MotionEngine(problem, 0.0, duration, _MOST_EVENTS, _MOST_STEPS, waits=False)
    if not math.isfinite(sum(state)):
        return None
    own_angle = math.remainder(state.angle + engine.body.lean, 2.0 * math.pi)
    try:
        _begin_measured(engine, state._replace(angle=own_angle), old, (1,) if alone else (0, 1))
        strike = engine.next_strike()
    except ArithmeticError:  # numbers so large or so small that their products are none
        return None
    if strike is None or (alone and strike.new != 1):
        return None
    end = strike.state._replace(angle=strike.state.angle + (state.angle - own_angle))
    return Fall(time=engine.time, point=strike.new, state=end, motion=strike.motion)


def _begin_measured(engine: MotionEngine, state: PlanarState, old: int | None, contacts: tuple[int, ...]) -> None:
    """Begin from a measured state, in which contact `old` is taken to stand; without it one below the support is on it.

    Only `contacts` strike.
    """
    body = engine.body
    if old is not None:
        u, w, z, s = body.seen_from(old, state)
        if abs(u) >= engine.problem.limit:
            engine.end = End.OVERTURNED
            return
        small = SLIP_ROUNDING * (abs(state.vx) + abs(state.vy) + abs(state.omega) * body.length)
        engine.settle(old, u, w, z, 0.0 if abs(s) <= small else s)
        return
    gaps = [max(0.0, body.gap(i, state.x, state.y, state.angle)) for i in (0, 1)]
    rates = [body.gap_rate(i, state) for i in (0, 1)]
    falling = [i for i in contacts if gaps[i] == 0.0 and rates[i] < 0.0]
    if falling:
        new = min(falling, key=rates.__getitem__)
        engine.strike = Strike(old=None, new=new, state=state, u=0.0, motion=MotionKind.FLIGHT)
    else:
        engine.fly(state, (gaps[0], gaps[1]))
