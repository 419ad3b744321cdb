"""Phases: smooth motion between two events, stepped or in closed form, with dense output of each.

`ContactPhase` is motion over contacts that stick or slip, `FlightPhase` (in `flight`) that without.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..impact.contacts import OPEN, PLUS, STICK
from ..types import Vector
from .equations import RockingBody, turned
from .events import Condition, Event, bracketed_root, dip, fall, newton_root
from .integrate import GROWTH, NEAR, DensePiece, Instant, nudged, pieces, step, values_at
from .pivot import Pivot, roll, turn
from .support import FeltSupport, FixedSupport, PlanarState

_FIRST_STEP = 0.9
"""Length of a first step, in times that the motion needs to change."""
_FIRST_STEP_OF_BOTH = 1.2
_BEYOND = 1.05
"""A step goes as much farther than where its parabola ends the phase."""
_LEAST = 0.1
"""But it is not shorter than this part of what it could be."""
_SMALLEST = 1e-10
"""Relative to the first step. Where smaller steps are refused, no smooth motion goes on."""
_PART_OF_PERIOD = 0.125
"""The longest step, in shortest periods of the support: none of its swings is stepped over."""
_BORDER = 1e-12
"""A condition that starts below this part of the weight starts at its border."""
_SHORTEST = 1e-6
"""What begins at its border and ends sooner than this, in times of the body's swing, ends then."""
_FINER = 0.01
"""Tolerance of dense output, relative to that of steps: it must meet an end that is known exactly."""


class PhaseEnd(NamedTuple):
    """What ends a phase, at which contact, and when: `at.time` counts from the phase's start."""

    event: Event
    contact: int
    at: Instant


class MotionPhase:
    """A phase from `start` s on; the times of its instants count from there, so that short hops keep their digits."""

    a = b = OPEN
    """The states of contacts 0 and 1."""
    contact = 0
    """The contact to which what is not a contact's own happens."""
    moves = True
    events: tuple[tuple[Event, int], ...] = ()
    """What happens where a condition falls to zero, and to which contact."""
    border = 0.0
    longest = math.inf
    """The longest step in s."""
    shortest = 0.0
    """What begins at its border and fails within less than this (s) ends then."""

    def __init__(self, body: RockingBody, support: FeltSupport, start: float, length: float, tolerance: float) -> None:
        self.body, self.support, self.start, self.tolerance = body, support, start, tolerance
        self.fixed = isinstance(support, FixedSupport)
        self.felt = support.felt(start)
        self.scale = length, max(abs(support.gravity), abs(self.felt[0]) + abs(self.felt[1]))
        self.instants: list[Instant] = []
        """The ends of the steps."""
        self._pieces: list[DensePiece] = []

    @property
    def end(self) -> float:
        """When it ends, in s."""
        return self.start + self.instants[-1].time

    def rate(self, time: float, u: float, w: float, z: float, s: float) -> Vector:
        """Accelerations of the two coordinates."""
        raise NotImplementedError

    def conditions(self, now: Instant) -> list[Condition]:
        """What stays positive until one of `events`."""
        raise NotImplementedError

    def at(self, time: Any) -> PlanarState:
        """State at a time or an array of times within the phase."""
        raise NotImplementedError

    def _first_step(self, now: Instant, last: float) -> float:
        """Length of the first step; sets the longest and the shortest one, too."""
        raise NotImplementedError

    def _reach(self, now: Instant, conditions: list[Condition]) -> float:
        """A little more than the time after which the phase might end."""
        raise NotImplementedError

    def _starting(self, conditions: list[Condition]) -> list[Condition]:
        return conditions

    def _pass(self, then: Instant) -> None:
        self.instants.append(then)

    def _ended(self, k: int, at: Instant) -> PhaseEnd:
        event, contact = self.events[k]
        self.instants.append(at)
        return PhaseEnd(event, contact, at)

    def follow(self, last: float, most: int) -> PhaseEnd:
        """Step to the first event, or for `last` s, in at most `most` steps."""
        now = self.instants[-1]
        if math.isnan(now.alpha + now.beta):
            return PhaseEnd(Event.JAMS, self.contact, now)
        h = self._first_step(now, last)
        smallest = _SMALLEST * h
        before = self._starting(self.conditions(now))
        while now.time < last:
            if len(self.instants) > most:
                return PhaseEnd(Event.TAKES_TOO_LONG, self.contact, now)
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
                late = [k for k in crossed if not _began(before[k], self.border)]
                if late and h > self.shortest:
                    h *= 0.25
                    continue
                if late:
                    return self._ended(late[0], then)
                found = [(_Crossing(self, now, then, k).find(before[k], after[k]), k) for k in crossed]
                at, k = min(found, key=_time_of)
                return self._ended(k, at)
            self._pass(then)
            now, before = then, after
            h *= GROWTH[rows]
            h = min(h, max(self._reach(now, before), _LEAST * h))
        return PhaseEnd(Event.TIME_IS_UP, self.contact, now)

    def _may_dip(self, now: Instant, then: Instant, before: list[Condition], after: list[Condition]) -> bool:
        """Whether a condition that holds at both ends of a step may fail between them."""
        middle: list[Condition] | None = None
        h = then.time - now.time
        for k, ((value, rate), (end_value, end_rate)) in enumerate(zip(before, after, strict=True)):
            if value <= 0.0 or end_value <= 0.0:
                continue
            if not math.isnan(rate):
                if rate < 0.0 < end_rate and dip(value, h * rate, end_value, h * end_rate) <= 1.0:
                    return True
                continue
            if middle is None:
                middle = self.conditions(_middle(now, then))
            # The parabola through both ends and the middle, and what it may be wrong by.
            bend = value - 2.0 * middle[k][0] + end_value
            slope = end_value - value
            if bend > 0.0 and abs(slope) < 2.0 * bend:
                if middle[k][0] - 0.125 * slope * slope / bend <= 0.1 * bend:
                    return True
            elif middle[k][0] <= 0.0:
                return True
        return False

    def dense(self) -> list[DensePiece]:
        """The polynomials of the phase, made when they are first asked for."""
        if not self._pieces:
            if self.moves:
                for now, end in zip(self.instants, self.instants[1:], strict=False):
                    for then in self.steps(now, end.time):
                        # The last step ends where the phase does, to the last bit.
                        then = end if then.time == end.time else then
                        self._pieces += pieces(self.rate, now, then, self.scale, self.tolerance)
                        now = then
            if not self._pieces:
                now = self.instants[0]
                self._pieces = [DensePiece(start=0.0, end=self.instants[-1].time, u=(now.u,), z=(now.z,))]
        return self._pieces

    def steps(self, now: Instant, until: float) -> list[Instant]:
        """Ends of steps from an instant to a time, which may be far, without a look at events."""
        found = []
        h = until - now.time
        smallest = _SMALLEST * h
        while now.time < until:
            left = until - now.time
            h = min(h, left)
            then, rows = step(self.rate, now, h, self.scale, _FINER * self.tolerance)
            if not rows and h > smallest:
                h *= GROWTH[0]
                continue
            now = then._replace(time=until) if h == left else then
            found.append(now)
            h *= 2.0
        return found


class _Crossing:
    """One condition of a phase within a step, found by stepping from the last place that was asked for."""

    def __init__(self, phase: MotionPhase, now: Instant, then: Instant, k: int) -> None:
        self.phase, self.k, self.start, self.h = phase, k, now.time, then.time - now.time
        self.here, self.place = then, self.h

    def find(self, before: Condition, after: Condition) -> Instant:
        """The instant at which the condition, which fails at the end of the step, falls to zero."""
        h = self.h
        if math.isnan(after[1]):
            place = bracketed_root(self.exact, h, before[0], after[0])
        else:
            near = h * min(1.0, fall(before[0], h * before[1], after[0], h * after[1]))
            place = newton_root(self.exact, h, near)
        self.exact(place)
        return self.here

    def exact(self, place: float) -> Condition:
        """The condition at a place of the step: the nearer it is to the last one, the less it costs."""
        phase, span = self.phase, place - self.place
        if abs(span) <= NEAR * self.h:
            here = nudged(phase.rate, self.here, span)
        else:
            here, _ = step(phase.rate, self.here, span, phase.scale, phase.tolerance)
        self.here, self.place = here._replace(time=self.start + place), place
        return phase.conditions(self.here)[self.k]


class ContactPhase(MotionPhase):
    """Motion over closed contacts, of states `a` and `b`, from (u, w, z, s) on; it overturns at `limit` rad."""

    def __init__(
        self,
        body: RockingBody,
        support: FeltSupport,
        states: tuple[int, int],
        start: float,
        place: tuple[float, float, float, float],
        limit: float,
        tolerance: float,
    ) -> None:
        super().__init__(body, support, start, body.length, tolerance)
        self.a, self.b = states
        self.limit = limit
        self.both = OPEN not in states
        self.contact = i = 0 if self.a != OPEN else 1
        self.state = states[i]
        self.side = 1.0 if i == 0 else -1.0
        self.slip = 1.0 if self.state == PLUS else -1.0
        self.moves = not (self.both and self.state == STICK)
        """Whether it moves at all."""
        self.pivots = self.fixed and not self.both and self.state == STICK
        """Whether it turns about one point at rest: that is known in closed form."""
        touches = (Event.TOUCHES, 1 - i), (Event.OVERTURNS, i)
        if self.both:
            self.events = (Event.STOPS, i), (Event.LIFTS, 0), (Event.LIFTS, 1)
        elif self.state == STICK:
            self.events = *touches, (Event.SLIPS, i), (Event.SLIPS_BACK, i)
        else:
            self.events = *touches, (Event.STOPS, i), (Event.LIFTS, i)
        alpha, beta = self.rate(0.0, *place) if self.moves else (0.0, 0.0)
        self.instants.append(Instant(0.0, *place, alpha, beta))

    def rate(self, time: float, u: float, w: float, z: float, s: float) -> Vector:
        felt = self.felt if self.fixed else self.support.felt(self.start + time)
        if self.both:
            return 0.0, self.body.forces_of_both(self.state, felt, z, s)[0]
        forces = self.body.forces(self.contact, self.state, felt, u, w, z, s)
        return forces.alpha, forces.beta

    def conditions(self, now: Instant) -> list[Condition]:
        time, u, w, z, s, _, beta = now
        felt = self.felt if self.fixed else self.support.felt(self.start + time)
        stops = self.slip * s, self.slip * beta
        if self.both:
            _, normal, normal_b = self.body.forces_of_both(self.state, felt, z, s)
            return [stops, (normal, math.nan), (normal_b, math.nan)]
        gap, speed = self.side * u, self.side * w
        touches, overturns = (gap, speed), (self.limit - gap, -speed)
        forces = self.body.forces(self.contact, self.state, felt, u, w, z, s)
        if self.state != STICK:
            return [touches, overturns, stops, (-forces.free, math.nan)]
        hold = self.body.friction[self.contact] * forces.normal
        return [touches, overturns, (hold + forces.tangential, math.nan), (hold - forces.tangential, math.nan)]

    def _first_step(self, now: Instant, last: float) -> float:
        felt, length = self.felt, self.body.length
        weight = math.hypot(felt[0], felt[1]) + length * (abs(felt[3]) + felt[2] * felt[2])
        swing = math.sqrt(length / weight) if weight > 0.0 else math.inf
        self.border = _BORDER * length / (swing * swing)
        self.longest = _PART_OF_PERIOD * self.support.period
        self.shortest = _SHORTEST * min(swing, self.support.period)
        pace = abs(now.w) + math.sqrt(abs(now.alpha)) + 1.0 / swing
        first = (_FIRST_STEP_OF_BOTH if self.both else _FIRST_STEP) / pace
        return min(first, self._reach(now, []), self.longest)

    def _reach(self, now: Instant, conditions: list[Condition]) -> float:
        # By the parabola of the instant, which ends a slip or closes the other contact.
        stops = -now.s / now.beta if now.s * now.beta < 0.0 else math.inf
        if self.both:
            return _BEYOND * stops
        gap, speed, pull = self.side * now.u, self.side * now.w, -self.side * now.alpha
        square = max(0.0, speed * speed + 2.0 * pull * gap)
        touches = math.inf
        if pull > 0.0 and speed > 0.0:
            touches = (speed + math.sqrt(square)) / pull
        elif square > 0.0 and gap > 0.0 and speed < 0.0:
            touches = 2.0 * gap / (math.sqrt(square) - speed)
        return _BEYOND * min(stops, touches)

    def _ended(self, k: int, at: Instant) -> PhaseEnd:
        event, _ = self.events[k]
        if event is Event.TOUCHES:
            at = at._replace(u=0.0)
        elif event is Event.STOPS:
            at = at._replace(s=0.0)
        return super()._ended(k, at)

    def at(self, time: Any) -> PlanarState:
        return self.body.state(self.contact, *values_at(self.dense(), time - self.start))

    def close(self, end: Instant) -> None:
        """End the phase at an instant that the summed impacts lead to, uniformly."""
        now = self.instants[0]
        self.instants.append(end)
        u, z = (0.5 * (end.u - now.u), 0.5 * (end.u + now.u)), (0.5 * (end.z - now.z), 0.5 * (end.z + now.z))
        self._pieces = [DensePiece(start=now.time, end=end.time, u=u, z=z)]

    def follow(self, last: float, most: int) -> PhaseEnd:
        if not self.pivots:
            return super().follow(last, most)
        i, side = self.contact, self.side
        time, u, w, _, _, _, _ = self.instants[0]
        pivot = self._pivot(u, w)
        if pivot.event is Event.TURNS_BACK and u == 0.0:
            # What rises from both contacts comes back as it went, with the same reactions at every angle.
            return self._turned(last, Event.TOUCHES, 1 - i, time + 2.0 * pivot.time, 0.0, -w)
        if pivot.event is Event.TURNS_BACK:
            time, u, w = time + pivot.time, u + pivot.turned, 0.0
            pivot = self._pivot(u, w)
        time += pivot.time
        if pivot.event is Event.NEVER or pivot.event is Event.TURNS_BACK:
            return self._turned(last, Event.BALANCES, i, math.inf if w else time, u, w)
        u, w = u + pivot.turned, pivot.omega
        if pivot.event is not Event.TOUCHES:
            return self._turned(last, pivot.event, i, time, u, w)
        if pivot.direction * side < 0.0:
            return self._turned(last, Event.TOUCHES, 1 - i, time, 0.0, w)
        return self._turned(last, Event.OVERTURNS, i, time, side * self.limit, w)

    def _turned(self, last: float, event: Event, contact: int, time: float, u: float, w: float) -> PhaseEnd:
        if time <= last:
            z = self.instants[0].z
            alpha, _ = self.rate(time, u, w, z, 0.0)
            self.instants.append(Instant(time=time, u=u, w=w, z=z, s=0.0, alpha=alpha, beta=0.0))
            return PhaseEnd(event, contact, self.instants[-1])
        self.instants += self.steps(self.instants[0], last)
        return PhaseEnd(Event.TIME_IS_UP, self.contact, self.instants[-1])

    def _pivot(self, u: float, w: float) -> Pivot:
        """The first event of a contact that sticks; a disc's normal turns with it."""
        body, i = self.body, self.contact
        home, over = self.side * u, self.limit - self.side * u
        travel = (home, over) if i == 0 else (over, home)
        closed_form = roll if body.rolls else turn
        return closed_form(turned(body.arms[i], u), w, travel, body.rho_squared, body.friction[i], self.felt[:2])


def _time_of(found: tuple[Instant, int]) -> float:
    return found[0].time


def _began(start: Condition, border: float) -> bool:
    """Whether a condition held at the start of a step, or began to: then it fails within the step."""
    value, rate = start
    return value > border if math.isnan(rate) else value > 0.0 or rate > 0.0


def _middle(now: Instant, then: Instant) -> Instant:
    """The instant in the middle of a step, on polynomials of degree 5."""
    h = then.time - now.time
    return Instant(
        time=now.time + 0.5 * h,
        u=0.5 * (now.u + then.u) + h * (5.0 * (now.w - then.w) + 0.5 * h * (now.alpha + then.alpha)) / 32.0,
        w=1.875 * (then.u - now.u) / h - 0.4375 * (now.w + then.w) + h * (then.alpha - now.alpha) / 32.0,
        z=0.5 * (now.z + then.z) + h * (5.0 * (now.s - then.s) + 0.5 * h * (now.beta + then.beta)) / 32.0,
        s=1.875 * (then.z - now.z) / h - 0.4375 * (now.s + then.s) + h * (then.beta - now.beta) / 32.0,
        alpha=math.nan,
        beta=math.nan,
    )
