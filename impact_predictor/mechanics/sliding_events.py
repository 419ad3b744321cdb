"""A slipping stance as it goes on, and the events that end it: the load vanishes, or the slip stops.

The slip needs no integration: x_C' + drag y_C' of the mass centre grows by gx + drag gy per second.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from .radau import total
from .sliding_sweep import Pose, Stance, Sweep, pose_at
from .stretch import End, Stretch
from .types import Vector

_ROUNDING = 16.0 * 2.0**-52
"""Some units in the last place of a slip that is a sum of a few terms."""
_MARGIN = 0.05
"""Relative to its terms: more than a smooth condition falls between two nodes."""
_NEWTON_STEPS = 4
"""On a cubic between two nodes, from its secant."""
_NOWHERE = 2.0
"""A place beyond a gap, which goes from 0 to 1."""

Condition = tuple[float, float]
"""A value that is positive until the event, and its rate of change per second."""
Instant = tuple[float, float, float, float, float, float, float]
"""Time in s and angle in rad since the start of a sweep, angular speed, and the arm (x, y), L and B there."""


class Slip:
    """One stretch of a slipping stance: what does not change in it, and how far it is.

    Angles count positive the way the body turns, and lengths along the support with them.
    """

    __slots__ = ("direction", "drive", "radius", "rate", "slip", "spin", "stance", "time", "turned", "x", "y")

    def __init__(
        self,
        arm: Vector,
        omega: float,
        slip: float,
        drag: float,
        rho_squared: float,
        gravity: Vector,
        direction: int,
    ) -> None:
        drag, self.direction = direction * drag, direction
        self.stance = Stance(drag, (drag > 0.0) - (drag < 0.0), rho_squared, gravity[1])
        self.x, self.y, self.radius = direction * arm[0], arm[1], math.hypot(*arm)
        self.slip, self.drive = direction * slip, direction * gravity[0] + drag * gravity[1]
        self.spin = abs(omega) * (drag * self.x - self.y)
        self.time, self.turned, self.rate = 0.0, 0.0, abs(omega)

    def arm(self, turned: float) -> Vector:
        """From the contact to the mass centre, that much further."""
        sine, cosine = math.sin(self.turned + turned), math.cos(self.turned + turned)
        return self.x * cosine - self.y * sine, self.x * sine + self.y * cosine

    def pose(self, turned: float, rate: float) -> Pose:
        """The pose that much further, with its angular speed."""
        return pose_at(self.stance, *self.arm(turned), rate)

    def mirrored(self) -> Stance:
        """The stance seen so that the body turns back."""
        drag, side, rho_squared, gravity = self.stance
        return Stance(-drag, side, rho_squared, gravity)

    def standstill(self, turned: float) -> Pose:
        """A standstill that much further, seen so that the body turns back from it."""
        x, y = self.arm(turned)
        return pose_at(self.mirrored(), -x, y, 0.0)

    def until_stop(self, pose: Pose) -> float:
        """How far in rad the body turns until the slip stops, if slip and turning change at their present rates."""
        (drag, side, *_), (x, y, rate, lever, _, alpha, _) = self.stance, pose
        swing = drag * x - y
        slip = side * (self.slip + self.drive * self.time - (rate * swing - self.spin))
        change = side * (self.drive - alpha * swing + rate * rate * lever)
        if not slip > 0.0 > change:
            return math.inf
        time = -slip / change
        return (rate + 0.5 * alpha * time) * time if rate + alpha * time > 0.0 else math.inf

    def stays(self, swept: Sweep, back: bool) -> bool:
        """Whether load and slip keep far from zero in a sweep, forth or back, by bounds that cost little."""
        drag, side, _, gravity = self.stance
        fastest = max(swept.rates)
        if fastest * fastest * self.radius > (_MARGIN - 1.0) * gravity:
            return False
        if not side:
            return True
        if back:
            drag = -drag
        # Every other node, with both ends, tells enough of so smooth a function.
        some = zip(swept.nodes[1::2], swept.rates[1::2], strict=True)
        spins = [(drag * x - y) * rate for (_, x, y, _, _), rate in some]
        if back:
            spins.append(0.0)
        loss = max(spins) if side > 0 else -min(spins)
        start, drift = side * (self.slip + self.spin), side * self.drive
        least = start + drift * (self.time + swept.time if drift < 0.0 else self.time) - loss
        return least > _MARGIN * (abs(start) + abs(loss))

    def first_event(self, swept: Sweep, back: bool, horizon: float) -> tuple[float, End] | None:
        """At which angle of a sweep the load or the slip vanishes first, or might, and which."""
        along = _instants(swept, back)
        (drag, side, _, gravity), fastest = self.stance, max(swept.rates)
        lifts = stops = (math.inf, 0.0)
        if fastest * fastest * self.radius > (_MARGIN - 1.0) * gravity:
            lifts = _first_fall(along, [-rate * rate * y - gravity for _, _, rate, _, y, _, _ in along], self.load, 0.0)
        if side:
            start, drive = self.slip + self.spin + self.drive * self.time, self.drive
            slips = [side * (start + drive * time - rate * (drag * x - y)) for time, _, rate, x, y, _, _ in along]
            terms = abs(self.slip) + abs(self.spin) + fastest * self.radius * (1.0 + abs(drag))
            # A slip that begins is smaller than the errors at the nodes, and does not end by them.
            noise = _ROUNDING if self.slip or self.time else max(_ROUNDING, swept.error)
            stops = _first_fall(along, slips, self.slips, noise * (terms + abs(drive) * swept.time))
        time, angle = min(lifts, stops)
        if time == math.inf or self.time + time > horizon:
            return None
        return angle, End.LIFTS if time == lifts[0] else End.STOPS

    def load(self, now: Instant) -> Condition:
        """The normal force over a factor that stays positive."""
        _, _, rate, x, y, lever, bracket = now
        square = rate * rate
        push = square * y + self.stance.gravity
        return -push, -rate * (2.0 * push * lever / bracket * y + square * x)

    def slips(self, now: Instant) -> Condition:
        """The speed of the slip."""
        drag, side, _, gravity = self.stance
        time, _, rate, x, y, lever, bracket = now
        square, swing = rate * rate, drag * x - y
        alpha = (square * y + gravity) * lever / bracket
        slip = self.slip + self.drive * (self.time + time) - (rate * swing - self.spin)
        return side * slip, side * (self.drive - alpha * swing + square * lever)

    def reaches(self, end: End, time: float, turned: float, rate: float, within: float) -> tuple[bool, float]:
        """Go to an event if it lies within so many seconds of an instant that much further, by Newton's method.

        Returns whether it does, and how far in rad the body turns from that instant until the event.
        """
        x, y, _, lever, bracket, alpha, _ = self.pose(turned, rate)
        now = time, turned, rate, x, y, lever, bracket
        value, change = self.load(now) if end is End.LIFTS else self.slips(now)
        left = -value / change if change < 0.0 else math.inf
        more = (rate + 0.5 * alpha * left) * left
        if not abs(left) <= within:
            return False, more
        self.go(time + left, turned + more, rate + alpha * left)
        return True, more

    def go(self, time: float, turned: float, rate: float) -> None:
        """Go on to an instant that much further."""
        self.time, self.turned, self.rate = self.time + time, self.turned + turned, rate

    def end(self, end: End) -> Stretch:
        """The stretch that ends now."""
        x, y = self.arm(0.0)
        drag, sign, rate = self.stance.drag, self.direction, self.rate
        slip = self.slip + self.drive * self.time - (rate * (drag * x - y) - self.spin)
        moved = (self.slip + self.spin + 0.5 * self.drive * self.time) * self.time
        moved -= drag * (y - self.y) + (x - self.x)
        return Stretch(end, self.time, sign * self.turned, sign * rate, sign * slip, sign * moved, sign)


def _instants(swept: Sweep, back: bool) -> list[Instant]:
    """The instants of a sweep, also of one back from a standstill, in the order of time."""
    (nodes, _, rows, *_), places, rates, lags, linear_time, end, *_ = swept
    times = [0.0, *[linear_time * (s - total(row, lags)) for s, row in zip(nodes, rows, strict=True)]]
    all_of_it = zip(times, places, rates, strict=True)
    if not back:
        return [(time, turned, rate, x, y, lever, bracket) for time, (turned, x, y, lever, bracket), rate in all_of_it]
    angle = places[-1][0]
    return [(end - t, angle - turned, rate, -x, y, -lever, b) for t, (turned, x, y, lever, b), rate in all_of_it][::-1]


def _first_fall(
    along: list[Instant], values: list[float], condition: Callable[[Instant], Condition], noise: float
) -> tuple[float, float]:
    """Time and turned angle where a condition with these values first falls to zero, or might; inf where none."""
    last = len(values) - 1
    for index in range(1, last + 1):
        before, here = values[index - 1], values[index]
        dips = before <= here and (index == 1 or values[index - 2] >= before)
        dips = dips or (here <= before and (index == last or values[index + 1] >= here))
        if here <= 0.0 or dips:
            start, now = along[index - 1], along[index]
            (value, slope), (end_value, end_slope), gap = condition(start), condition(now), now[0] - start[0]
            at = _falls(value, slope * gap, end_value, end_slope * gap, noise)
            if at <= 1.0:
                square, cube = _cubic(start[1], start[2] * gap, now[1], now[2] * gap)
                return start[0] + at * gap, start[1] + at * (start[2] * gap + at * (square + at * cube))
    return math.inf, 0.0


def _falls(value: float, slope: float, end_value: float, end_slope: float, noise: float) -> float:
    """Where on 0..1 a condition with these values and slopes falls to zero or might; beyond 1 where it does not."""
    square, cube = _cubic(value, slope, end_value, end_slope)
    if value <= noise:
        # It begins at zero; the root that is not there.
        root = math.sqrt(max(0.0, square * square - 4.0 * slope * cube))
        numerator, denominator = (-square - root, 2.0 * cube) if square > 0.0 else (2.0 * slope, root - square)
        at = numerator / denominator if denominator else 0.0
        return (at if 0.0 < at <= 1.0 else 0.0) if end_value < -noise else _NOWHERE
    if end_value > 0.0:
        if not slope < 0.0 < end_slope:
            return _NOWHERE
        # The tangents at the two ends of a dip meet below it.
        at = (end_value - value - end_slope) / (slope - end_slope)
        return at if value + slope * at <= 0.0 else _NOWHERE
    low, high, at = 0.0, 1.0, value / (value - end_value)
    for _ in range(_NEWTON_STEPS):
        here, change = value + at * (slope + at * (square + at * cube)), slope + at * (2.0 * square + 3.0 * at * cube)
        low, high = (at, high) if here > 0.0 else (low, at)
        at = at - here / change if change < 0.0 else high
        at = at if low <= at <= high else 0.5 * (low + high)
    return at


def _cubic(value: float, slope: float, end_value: float, end_slope: float) -> tuple[float, float]:
    """Square and cube of the cubic on 0..1 with these values and slopes at its ends."""
    rise = end_value - value
    return 3.0 * rise - 2.0 * slope - end_slope, slope + end_slope - 2.0 * rise
