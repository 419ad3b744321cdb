"""Follow closed contacts step by step to the first event: where a contact slips, or the support moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from ..pair import OPEN, PLUS, STICK
from ..support import FeltSupport
from .arcs import Arc, Happening
from .shape import Shape
from .step import GROWTH, NEAR, Instant, Rate, Value, nudged, root, step

_FIRST_STEP = 0.9
"""Length of a first step, in times that the motion needs to change."""
_FIRST_STEP_OF_BOTH = 1.2
_BEYOND = 1.05
"""A step goes as much farther than where its parabola ends the arc."""
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


class Event(NamedTuple):
    """What ends an arc, at which contact, and when: `at.time` counts from the arc's start."""

    happening: Happening
    contact: int
    at: Instant


class _Watch:
    """The conditions of an arc, and whose event each is."""

    def __init__(self, arc: Arc, limit: float) -> None:
        shape, support = arc.shape, arc.support
        self.shape, self.support, self.start, self.limit = shape, support, arc.start, limit
        self.contact = i = arc.contact
        self.state = state = arc.a if i == 0 else arc.b
        self.side = 1.0 if i == 0 else -1.0
        self.slip = 1.0 if state == PLUS else -1.0
        self.both = arc.a != OPEN and arc.b != OPEN
        other = 1 - i
        if self.both:
            self.events = [(Happening.STOPS, i), (Happening.LIFTS, 0), (Happening.LIFTS, 1)]
        elif state == STICK:
            self.events = [(Happening.TOUCHES, other), (Happening.OVERTURNS, i)]
            self.events += [(Happening.SLIPS, i), (Happening.SLIPS_BACK, i)]
        else:
            self.events = [(Happening.TOUCHES, other), (Happening.OVERTURNS, i)]
            self.events += [(Happening.STOPS, i), (Happening.LIFTS, i)]

    def motion(self, now: Instant) -> list[Value]:
        """The conditions that the motion alone tells: the first ones of `events`."""
        stops = self.slip * now.s, self.slip * now.beta
        if self.both:
            return [stops]
        turned, pace = self.side * now.u, self.side * now.w
        turning = [(turned, pace), (self.limit - turned, -pace)]
        return turning if self.state == STICK else [*turning, stops]

    def __call__(self, now: Instant) -> list[Value]:
        time, u, w, z, s, _, _ = now
        felt = self.support.felt(self.start + time)
        if self.both:
            _, normal, normal_b = self.shape.forces_of_both(self.state, felt, z, s)
            return [*self.motion(now), (normal, math.nan), (normal_b, math.nan)]
        forces = self.shape.forces(self.contact, self.state, felt, u, w, z, s)
        if self.state == STICK:
            hold = self.shape.friction[self.contact] * forces.normal
            return [*self.motion(now), (hold + forces.tangential, math.nan), (hold - forces.tangential, math.nan)]
        return [*self.motion(now), (-forces.free, math.nan)]


def first_instant(rate: Rate, u: float, w: float, z: float, s: float) -> Instant:
    alpha, beta = rate(0.0, u, w, z, s)
    return Instant(0.0, u, w, z, s, alpha, beta)


def swing_time(shape: Shape, support: FeltSupport, time: float) -> float:
    """Time in which the body's motion on a contact changes: of its swing about it under what it feels."""
    felt = support.felt(time)
    weight = math.hypot(felt[0], felt[1]) + shape.length * (abs(felt[3]) + felt[2] * felt[2])
    return math.sqrt(shape.length / weight) if weight > 0.0 else math.inf


def follow(arc: Arc, last: float, limit: float, most: int) -> Event:
    """Add the ends of at most `most` steps to an arc until its first event, or for `last` s.

    `limit` rad is where the body overturns.
    """
    shape, support, rate = arc.shape, arc.support, arc.rate()
    length, tolerance = shape.length, arc.tolerance
    watch = _Watch(arc, limit)
    now = arc.instants[-1]
    if math.isnan(now.alpha + now.beta):
        return Event(Happening.JAMS, arc.contact, now)
    swing = swing_time(shape, support, arc.start)
    weight = length / (swing * swing)
    longest = _PART_OF_PERIOD * support.period
    pace = abs(now.w) + math.sqrt(abs(now.alpha)) + 1.0 / swing
    h = min((_FIRST_STEP_OF_BOTH if watch.both else _FIRST_STEP) / pace, _reach(now, watch), longest)
    smallest, shortest = _SMALLEST * h, _SHORTEST * min(swing, support.period)
    before = watch(now)
    while now.time < last:
        if len(arc.instants) > most:
            return Event(Happening.TAKES_TOO_LONG, arc.contact, now)
        h = min(h, longest)
        left = last - now.time
        if h > left * (1.0 - 1e-9):
            h = left
        then, rows = step(rate, now, h, arc.scale, tolerance)
        if not rows or math.isnan(then.alpha + then.beta):
            h *= GROWTH[0]
            if h < smallest:
                return Event(Happening.JAMS, arc.contact, now)
            continue
        after = watch(then)
        if h > smallest and _may_dip(watch, now, then, before, after):
            h *= 0.25
            continue
        crossed = [k for k, (value, _) in enumerate(after) if value < 0.0]
        if crossed:
            late = [k for k in crossed if not _began(before[k], _BORDER * weight)]
            if late and h > shortest:
                h *= 0.25
                continue
            if late:
                event, then_at = late[0], then
            else:
                event, then_at = _first_crossing(arc, rate, watch, now, then, before, after, crossed)
            return _ended(arc, watch, event, then_at)
        arc.instants.append(then)
        now, before = then, after
        h *= GROWTH[rows]
        h = min(h, max(_reach(now, watch), _LEAST * h))
    return Event(Happening.TIME_IS_UP, arc.contact, now)


def _began(start: Value, border: float) -> bool:
    """Whether a condition held at the start of a step, or began to: then it fails within the step."""
    value, rate = start
    return value > border if math.isnan(rate) else value > 0.0 or rate > 0.0


def _reach(now: Instant, watch: _Watch) -> float:
    """A little more than the time in which the parabola of an instant ends a slip, or closes the other contact."""
    stops = -now.s / now.beta if now.s * now.beta < 0.0 else math.inf
    if watch.both:
        return _BEYOND * stops
    gap, speed, fall = watch.side * now.u, watch.side * now.w, -watch.side * now.alpha
    square = max(0.0, speed * speed + 2.0 * fall * gap)
    touches = math.inf
    if fall > 0.0 and speed > 0.0:
        touches = (speed + math.sqrt(square)) / fall
    elif square > 0.0 and gap > 0.0 and speed < 0.0:
        touches = 2.0 * gap / (math.sqrt(square) - speed)
    return _BEYOND * min(stops, touches)


def _may_dip(watch: _Watch, now: Instant, then: Instant, before: list[Value], after: list[Value]) -> bool:
    """Whether a condition that holds at both ends of a step may fail between them."""
    middle: list[Value] | None = None
    h = then.time - now.time
    for k, ((value, rate), (end_value, end_rate)) in enumerate(zip(before, after, strict=True)):
        if value <= 0.0 or end_value <= 0.0:
            continue
        if not math.isnan(rate):
            # The tangents at the two ends meet below the dip.
            if rate < 0.0 < end_rate:
                if value + rate * (end_value - value - end_rate * h) / (rate - end_rate) <= 0.0:
                    return True
            continue
        if middle is None:
            middle = watch(_between(now, then, 0.5))
        # The parabola through both ends and the middle, and what it may be wrong by.
        bend = value - 2.0 * middle[k][0] + end_value
        slope = end_value - value
        if bend > 0.0 and abs(slope) < 2.0 * bend:
            if middle[k][0] - 0.125 * slope * slope / bend <= 0.1 * bend:
                return True
        elif middle[k][0] <= 0.0:
            return True
    return False


def _between(now: Instant, then: Instant, part: float) -> Instant:
    """An instant within a step, on polynomials of degree 5."""
    h = then.time - now.time
    u, w = _quintic(h, (now.u, now.w, now.alpha), (then.u, then.w, then.alpha), part)
    z, s = _quintic(h, (now.z, now.s, now.beta), (then.z, then.s, then.beta), part)
    return Instant(now.time + part * h, u, w, z, s, math.nan, math.nan)


def _quintic(
    h: float, low: tuple[float, float, float], high: tuple[float, float, float], part: float
) -> tuple[float, float]:
    """Value and rate on the polynomial with value, rate and acceleration at both ends."""
    c0, c1, c2 = low[0], h * low[1], 0.5 * h * h * low[2]
    a, b, c = high[0] - c0 - c1 - c2, h * high[1] - c1 - 2.0 * c2, h * h * high[2] - 2.0 * c2
    c3, c4, c5 = 10.0 * a - 4.0 * b + 0.5 * c, -15.0 * a + 7.0 * b - c, 6.0 * a - 3.0 * b + 0.5 * c
    value = c0 + part * (c1 + part * (c2 + part * (c3 + part * (c4 + part * c5))))
    rate = c1 + part * (2.0 * c2 + part * (3.0 * c3 + part * (4.0 * c4 + part * 5.0 * c5)))
    return value, rate / h


def _first_crossing(
    arc: Arc,
    rate: Rate,
    watch: _Watch,
    now: Instant,
    then: Instant,
    before: list[Value],
    after: list[Value],
    crossed: list[int],
) -> tuple[int, Instant]:
    """Which of the conditions that fail at the end of a step fails first, and when."""
    found = [(k, _crossing(arc, rate, watch, now, then, before[k], after[k], k)) for k in crossed]
    return min(found, key=lambda one: one[1].time)


def _crossing(
    arc: Arc, rate: Rate, watch: _Watch, now: Instant, then: Instant, before: Value, after: Value, k: int
) -> Instant:
    """The instant within a step at which a condition fails."""
    h = then.time - now.time
    here, here_at = then, h

    def exact(at: float) -> Value:
        # From the last place: the nearer it is, the less the step costs.
        nonlocal here, here_at
        if abs(at - here_at) <= NEAR * h:
            here = nudged(rate, here, at - here_at)
        else:
            here, _ = step(rate, here, at - here_at, arc.scale, arc.tolerance)
        here, here_at = here._replace(time=now.time + at), at
        values = watch.motion(here)
        return values[k] if k < len(values) else watch(here)[k]

    def near(at: float) -> Value:
        return watch.motion(_between(now, then, at / h))[k]

    at = 0.5 * h
    if math.isnan(after[1]):
        at = _bracketed(lambda at: exact(at)[0], h, before[0], after[0])
    elif watch.events[k][0] is not Happening.STOPS:
        back = h - after[0] / after[1] if after[1] < 0.0 else at
        at = root(exact, h, root(near, h, max(back, at)))
    elif before[0] > 0.0:
        at = root(exact, h, _bracketed(lambda at: near(at)[0], h, before[0], after[0]))
    else:
        at = root(exact, h, at)
    exact(at)
    return here


def _bracketed(condition: Callable[[float], float], high: float, value: float, high_value: float) -> float:
    """Where in 0..high a condition falls to zero: the false position with Illinois' weights."""
    low, start = 0.0, value
    side = 0
    at = high
    for _ in range(80):
        at = (low * high_value - high * value) / (high_value - value) if value > 0.0 else 0.5 * (low + high)
        here = condition(at)
        if abs(here) <= 1e-14 * (abs(start) + abs(high_value)) or high - low <= 1e-15 * high:
            break
        if here > 0.0:
            low, value = at, here
            if side == 1:
                high_value *= 0.5
            side = 1
        else:
            high, high_value = at, here
            if side == -1:
                value *= 0.5
            side = -1
    return at


def _ended(arc: Arc, watch: _Watch, k: int, at: Instant) -> Event:
    """The event, with the value that makes it exact."""
    happening, contact = watch.events[k]
    if happening is Happening.TOUCHES:
        at = at._replace(u=0.0)
    elif happening is Happening.STOPS:
        at = at._replace(s=0.0)
    arc.instants.append(at)
    return Event(happening, contact, at)
