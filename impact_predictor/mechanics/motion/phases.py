"""Phases: smooth motion between two events, stepped or in closed form, with dense output of each.

`MotionPhase` is motion over contacts that stick or slip, `FlightPhase` that without: the mass centre is thrown and the
body turns at a constant rate in the world.
"""

from __future__ import annotations

import math
from typing import Any, Final, NamedTuple

from ..impact.contacts import OPEN, PLUS, STICK
from ..types import Vector
from .accumulation import Place
from .equations import RockingBody, turned
from .events import Condition, End, Event, dip, fall, falling_root, may_fall, safe_step
from .felt import FrameAcceleration
from .integrate import GROWTH, NEAR, Instant, add_dense, middle_of, nudged, step, values_at
from .pivot import Pivot, roll, turn
from .support import FeltSupport, FixedSupport, MovingSupport, PlanarState

_FIRST_STEP: Final = 0.9
_STEP_OF_FLIGHT: Final = 0.25
"""Length of a first step, and of the longest one in flight, in times that the motion needs to change."""
_BEYOND: Final = 1.1
"""A step goes as much farther than where its parabola ends the phase."""
_LEAST: Final = 0.1
"""But it is not shorter than this part of what it could be."""
_SMALLEST: Final = 1e-10
"""Relative to the first step. Where smaller steps are refused, no smooth motion goes on."""
_PART_OF_PERIOD: Final = 0.125
"""The longest step, in shortest periods of the support: none of its swings is stepped over."""
_BORDER: Final = 1e-12
"""A condition that starts below this part of the weight starts at its border."""
_SHORTEST: Final = 1e-9
"""What begins at its border and ends sooner than this, in times of the body's swing, ends then."""
_FINER: Final = 0.01
"""Tolerance of dense output, relative to that of steps: it must meet an end that is known exactly."""
_ROUNDING: Final = 1e-14
"""A gap below this part of what the body moved is rounding."""
_SPEED_ROUNDING: Final = 1e-15
"""Part of a body's speeds that is rounding in the rate of a gap."""
_GAUSS = (
    (0.0469100770306680, 0.1184634425280946),
    (0.2307653449471584, 0.2393143352496833),
    (0.5, 0.28444444444444444),
    (0.7692346550528415, 0.2393143352496833),
    (0.9530899229693320, 0.1184634425280946),
)
"""Gauss' quadrature of order 10 on 0..1: nodes and weights."""


class RockingProblem(NamedTuple):
    """A body on its support, where in rad it overturns, and the error allowed to a step, relative to what happens."""

    body: RockingBody
    support: FeltSupport
    limit: float
    tolerance: float

    @property
    def fixed(self) -> bool:
        """Whether the support stands still."""
        return isinstance(self.support, FixedSupport)


class PhaseEnd(NamedTuple):
    """What ends a phase, at which contact, and when: `at.time` counts from the phase's start."""

    event: Event | End
    contact: int
    at: Instant


class MotionPhase:
    """Motion over closed contacts, of `states`, from (u, w, z, s) at `start` s on.

    The times of its instants count from its start, so that short hops keep their digits.
    """

    def __init__(self, problem: RockingProblem, states: tuple[int, int], start: float, place: Place) -> None:
        self.body, support, self.limit, self.tolerance = problem
        self.support, self.states, self.start = support, states, start
        self.fixed = problem.fixed
        self.felt = felt = support.felt(start)
        self.both = OPEN not in states
        self.contact = i = 1 if states[0] == OPEN else 0
        self.state = states[i]
        self.side = 1.0 if i == 0 else -1.0
        self.slip = 1.0 if self.state == PLUS else -1.0
        self.home = 0.0
        """How far from home u is counted: there another contact touches."""
        self.moves = not (self.both and self.state == STICK)
        """Whether it moves at all."""
        self.pivots = self.fixed and not self.both and self.state == STICK
        """Whether it turns about one point at rest: that is known in closed form."""
        touches = (Event.TOUCHES, 1 - i), (End.OVERTURNED, i)
        self.events: tuple[tuple[Event | End, int], ...]
        """What happens where a condition falls to zero, and to which contact."""
        if self.both:
            self.events = (Event.STOPS, i), (Event.LIFTS, 0), (Event.LIFTS, 1)
        elif self.state == STICK:
            self.events = *touches, (Event.SLIPS, i), (Event.SLIPS_BACK, i)
        else:
            self.events = *touches, (Event.STOPS, i), (Event.LIFTS, i)
        self.scale = self.body.length, max(abs(support.gravity), abs(felt[0]) + abs(felt[1]))
        u, w, z, s = place
        self.instants = [Instant(0.0, u, w, z, s, 0.0, 0.0)]
        """The ends of the steps."""
        if self.moves and not self.pivots:
            self.instants = [self._accelerated(self.instants[0])]
        self._dense: list[Instant] = []

    @property
    def end(self) -> float:
        """When it ends, in s."""
        return self.start + self.instants[-1].time

    def at(self, times: Any) -> PlanarState:
        """States at an array of times within the phase."""
        return self.body.state(self.contact, *values_at(self.dense(), times - self.start))

    def close(self, end: Instant) -> None:
        """End the phase at an instant that the summed impacts lead to, uniformly."""
        now = self.instants[0]
        w, s = ((end.u - now.u) / end.time, (end.z - now.z) / end.time) if end.time > 0.0 else (0.0, 0.0)
        self.instants = self._dense = [Instant(one.time, one.u, w, one.z, s, 0.0, 0.0) for one in (now, end)]

    def dense(self) -> list[Instant]:
        """Instants of the phase between which polynomials tell where it is, made when they are first asked for."""
        if not self._dense:
            now, *ends = self.instants
            self._dense = [self._accelerated(now) if self.moves else now]
            for end in ends if self.moves else ():
                if end.time > self._dense[-1].time:
                    end = self._accelerated(end) if self.pivots else end
                    add_dense(self._dense, self.rate, self._dense[-1], end, self.scale, _FINER * self.tolerance)
        return self._dense

    def follow(self, last: float, most: int) -> PhaseEnd:
        """Go on to the first event, or for `last` s, in at most `most` steps."""
        if self.pivots:
            return self._turn(last)
        now = self.instants[-1]
        if math.isnan(now.alpha + now.beta):
            return PhaseEnd(Event.JAMS, self.contact, now)
        before = self.conditions(now)
        h = min(self._first_step(now, last), self._reach(now, before), self.longest, last)
        smallest = _SMALLEST * h
        while now.time < last:
            if len(self.instants) > most:
                return PhaseEnd(End.TOO_MANY_EVENTS, self.contact, now)
            h = min(h, self.longest)
            left = last - now.time
            if h > left * (1.0 - 1e-9):
                h = left
            then, rows = step(self.rate, now, h, self.scale, self.tolerance)
            if not rows or math.isnan(then.alpha + then.beta):
                h *= GROWTH[0]
                if h < smallest:
                    return PhaseEnd(Event.JAMS, self.contact, now)
                continue
            after = self.conditions(then)
            if h > smallest and self._may_dip(now, then, before, after):
                h *= 0.25
                continue
            crossed = [k for k, (value, _) in enumerate(after) if value < 0.0]
            if crossed:
                # A slip of both contacts may begin so slowly that its end is found in the rounding of its beginning.
                slow = self.both and now.s == 0.0
                late = [k for k in crossed if slow or not _began(before[k], self.border)]
                if late and h > self.shortest:
                    h *= 0.25
                    continue
                at, k = then, (late or crossed)[0]
                if not late:
                    found = [_Crossing(self, now, then, k).find(before[k], after[k]) for k in crossed]
                    _, k, at = min([(one.time, k, one) for one, k in zip(found, crossed, strict=True)])
                self.instants.append(at)
                return PhaseEnd(*self.events[k], at)
            self._pass(then)
            now, before = then, after
            h *= GROWTH[rows]
            h = min(h, max(self._reach(now, before), _LEAST * h))
        return PhaseEnd(End.TIME_UP, self.contact, now)

    def rate(self, time: float, u: float, w: float, z: float, s: float) -> Vector:
        """Accelerations of the two coordinates."""
        felt = self._felt(time)
        if self.both:
            return 0.0, self.body.forces_of_both(self.state, felt, z, s)[0]
        forces = self.body.forces(self.contact, self.state, felt, u, w, z, s)
        return forces.alpha, forces.beta

    def conditions(self, now: Instant) -> list[Condition]:
        """What stays positive until one of `events`."""
        u, w, z, s = now.u, now.w, now.z, now.s
        felt = self._felt(now.time)
        stops = self.slip * s, self.slip * now.beta
        if self.both:
            _, normal, normal_b = self.body.forces_of_both(self.state, felt, z, s)
            return [stops, (normal, math.nan), (normal_b, math.nan)]
        gap, speed = self.side * u + self.home, self.side * w
        touches, overturns = (gap, speed), (self.limit - self.side * u, -speed)
        forces = self.body.forces(self.contact, self.state, felt, u, w, z, s)
        if self.state != STICK:
            return [touches, overturns, stops, (-forces.free, math.nan)]
        hold = self.body.friction[self.contact] * forces.normal
        return [touches, overturns, (hold + forces.tangential, math.nan), (hold - forces.tangential, math.nan)]

    def _felt(self, time: float) -> FrameAcceleration:
        return self.felt if self.fixed else self.support.felt(self.start + time)

    def _accelerated(self, now: Instant) -> Instant:
        alpha, beta = self.rate(now.time, now.u, now.w, now.z, now.s)
        return Instant(now.time, now.u, now.w, now.z, now.s, alpha, beta)

    def _first_step(self, now: Instant, last: float) -> float:
        """Length of the first step; sets the longest and the shortest one, too."""
        felt, length, period = self.felt, self.body.length, self.support.period
        weight = math.hypot(felt[0], felt[1]) + length * (abs(felt[3]) + felt[2] * felt[2])
        swing = math.sqrt(length / weight) if weight > 0.0 else math.inf
        self.border = _BORDER * length / (swing * swing)
        self.longest = _PART_OF_PERIOD * period
        self.shortest = _SHORTEST * min(swing, period, last)
        """What begins at its border and fails within less than this (s) ends then."""
        pace = abs(now.w) + math.sqrt(abs(now.alpha)) + 1.0 / swing
        return _FIRST_STEP / pace if pace > 0.0 else last

    def _reach(self, now: Instant, conditions: list[Condition]) -> float:
        """A little more than the time after which the phase might end, by the parabola of the instant."""
        stops = -now.s / now.beta if now.s * now.beta < 0.0 else math.inf
        if self.both:
            return _BEYOND * stops
        gap, speed, pull = max(0.0, self.side * now.u + self.home), self.side * now.w, -self.side * now.alpha
        return _BEYOND * min(stops, safe_step(gap, speed, pull))

    def _pass(self, then: Instant) -> None:
        self.instants.append(then)

    def _may_dip(self, now: Instant, then: Instant, before: list[Condition], after: list[Condition]) -> bool:
        """Whether a condition that holds at both ends of a step may fail between them."""
        middle: list[Condition] = []
        h = then.time - now.time
        for k, ((value, rate), (end_value, end_rate)) in enumerate(zip(before, after, strict=True)):
            if value <= 0.0 or end_value <= 0.0:
                continue
            if math.isnan(rate):
                middle = middle or self.conditions(middle_of(now, then))
                if may_fall(value, middle[k][0], end_value):
                    return True
            elif rate < 0.0 < end_rate and dip(value, h * rate, end_value, h * end_rate) <= 1.0:
                return True
        return False

    def _turn(self, last: float) -> PhaseEnd:
        """Turn about one point at rest to the first event, in closed form."""
        contact, side = self.contact, self.side
        start = self.instants[0]
        time, u, w = start.time, start.u, start.w
        pivot = self._pivot(u, w)
        event: Event | End = pivot.event
        if event is Event.TURNS_BACK and u == 0.0:
            # What rises from both contacts comes back as it went, with the same reactions at every angle.
            event, contact, time, w = Event.TOUCHES, 1 - contact, 2.0 * pivot.time, -w
        else:
            if event is Event.TURNS_BACK:
                time, u = pivot.time, u + pivot.turned
                pivot = self._pivot(u, 0.0)
                event = pivot.event
            time, u, w = time + pivot.time, u + pivot.turned, pivot.omega
            if event is Event.NEVER or event is Event.TURNS_BACK:
                event, time = End.BALANCED, math.inf if w else time
            elif event is Event.TOUCHES and pivot.direction * side < 0.0:
                contact, u = 1 - contact, 0.0
            elif event is Event.TOUCHES:
                event, u = End.OVERTURNED, side * self.limit
        if not time <= last:  # where it is then, its dense output finds
            event, contact, time, u = End.TIME_UP, self.contact, last, math.nan
        self.instants.append(Instant(time, u, w, start.z, start.s, start.alpha, start.beta))
        return PhaseEnd(event, contact, self.instants[-1])

    def _pivot(self, u: float, w: float) -> Pivot:
        """The first event of a contact that sticks; a disc's normal turns with it."""
        body, i = self.body, self.contact
        home, over = self.side * u, self.limit - self.side * u
        travel = (home, over) if i == 0 else (over, home)
        closed_form = roll if body.rolls else turn
        return closed_form(turned(body.arms[i], u), w, travel, body.rho_squared, body.friction[i], self.felt[:2])


class FlightPhase(MotionPhase):
    """Flight from `state` with known gaps of the contacts; coordinates are the displacements of the mass centre.

    These count from the start, so that the gap of a contact that has just left keeps its digits, too.
    """

    def __init__(self, problem: RockingProblem, start: float, state: PlanarState, gaps: Vector) -> None:
        self.begin, self.gaps = state, gaps
        self._mark = 0.0, 0.0
        """A time and the angle turned until then."""
        super().__init__(problem, (OPEN, OPEN), start, (0.0, state.vx, 0.0, state.vy))
        self.contact = 0
        self.events = (Event.TOUCHES, 0), (Event.TOUCHES, 1)
        if self.body.rolls:
            self.events = *self.events, (End.OVERTURNED, 0)
        self.scale = 1.0, self.scale[1]
        self.weight = math.hypot(self.felt[0], self.felt[1])

    def at(self, times: Any) -> PlanarState:
        begin, t = self.begin, times - self.start
        x, vx, y, vy = values_at(self.dense(), t)
        assert isinstance(self.support, (FixedSupport, MovingSupport))
        first, now = self.support.motion(self.start), self.support.motion(times)
        spin = begin.omega + first.rate
        angle = begin.angle + spin * t - (now.angle - first.angle)
        return PlanarState(x=begin.x + x, y=begin.y + y, angle=angle, vx=vx, vy=vy, omega=spin - now.rate)

    def rate(self, time: float, u: float, w: float, z: float, s: float) -> Vector:
        return self.body.felt_at(self._felt(time), self.begin.x + u, self.begin.y + z, w, s)

    def conditions(self, now: Instant) -> list[Condition]:
        body, (turned, state) = self.body, self._state(now)
        found = []
        for i in (0, 1):
            gap = self.gaps[i] + body.gap_change(i, self.begin, now.u, now.z, turned)
            rate = body.gap_rate(i, state)
            if now.time == 0.0 and gap <= 0.0:
                # A contact that is leaving just now does not begin with a fall, whatever rounding says.
                speeds = abs(state.vx) + abs(state.vy) + abs(state.omega) * body.length
                rate = rate if rate > _SPEED_ROUNDING * speeds else 0.0
            found.append((gap, rate))
        if body.rolls:  # the height above the edges
            ex, ey = body.edges[1]
            size = math.hypot(ex, ey)
            found.append(((ex * state.y - ey * state.x) / size, (ex * state.vy - ey * state.vx) / size))
        return found

    def landing(self, end: Instant, contact: int) -> tuple[PlanarState, float, bool]:
        """The state at an instant at which a contact touches; the gap of the other one, and whether it touches, too."""
        turned, state = self._state(end)
        gap = max(0.0, self.conditions(end)[1 - contact][0])
        moved = self.gaps[1 - contact] + abs(end.u) + abs(end.z) + self.body.length * abs(turned)
        return state, gap, gap <= _ROUNDING * moved

    def _state(self, now: Instant) -> tuple[float, PlanarState]:
        """How far the body has turned since the start, and its state."""
        turned, omega = self._angle(now.time)
        x, y, angle, _, _, _ = self.begin
        return turned, PlanarState(x=x + now.u, y=y + now.z, angle=angle + turned, vx=now.w, vy=now.s, omega=omega)

    def _angle(self, time: float) -> Vector:
        """The angle turned since the start until a time, and the rate then."""
        omega, (since, turned) = self.begin.omega, self._mark
        span = time - since
        if self.fixed:
            return turned + omega * span, omega
        felt, rate = self.support.felt, self.felt[2]
        for node, weight in _GAUSS:
            turned += weight * span * (omega + rate - felt(self.start + since + node * span)[2])
        return turned, omega + rate - felt(self.start + time)[2]

    def _pass(self, then: Instant) -> None:
        self._mark = then.time, self._angle(then.time)[0]
        super()._pass(then)

    def _first_step(self, now: Instant, last: float) -> float:
        super()._first_step(now, last)
        pace = abs(self.begin.omega) + math.sqrt(self.weight / self.body.length)
        self.longest = min(0.5 * self.longest, _STEP_OF_FLIGHT / pace if pace > 0.0 else last)
        return self.longest

    def _reach(self, now: Instant, conditions: list[Condition]) -> float:
        # Under the weight at the start.
        return _BEYOND * min(safe_step(max(0.0, gap), rate, self.weight) for gap, rate in conditions)


class _Crossing:
    """One condition of a phase within a step, found by stepping from the last place that was asked for."""

    def __init__(self, phase: MotionPhase, now: Instant, then: Instant, k: int) -> None:
        self.phase, self.k, self.start, self.h = phase, k, now.time, then.time - now.time
        self.here, self.place = then, self.h

    def find(self, before: Condition, after: Condition) -> Instant:
        """The instant at which the condition, which fails at the end of the step, falls to zero."""
        h, (value, rate), (end_value, end_rate) = self.h, before, after
        guess = value / (value - end_value) if value > 0.0 else 0.5
        if not math.isnan(rate):
            guess = min(1.0, fall(value, h * rate, end_value, h * end_rate))
        self.exact(falling_root(self.exact, h, end_value, h * guess))
        return self.here

    def exact(self, place: float) -> Condition:
        """The condition at a place of the step: the nearer it is to the last one, the less it costs."""
        phase, span = self.phase, place - self.place
        if abs(span) <= NEAR * self.h:
            here = nudged(phase.rate, self.here, span)
        else:
            here, _ = step(phase.rate, self.here, span, phase.scale, phase.tolerance)
        self.here, self.place = here.at(self.start + place), place
        return phase.conditions(self.here)[self.k]


def _began(start: Condition, border: float) -> bool:
    """Whether a condition held at the start of a step, or began to: then it fails within the step."""
    value, rate = start
    return value > border if math.isnan(rate) else value > 0.0 or rate > 0.0
