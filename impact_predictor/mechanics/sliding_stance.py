"""A body that turns over a stance contact which slips: one stretch of it, with one direction of slip.

The contact stays on the support (y = 0) and friction is T = -drag N with drag = friction * sign(slip). With the arm
(x, y) from the contact to the mass centre, per unit of mass:

    along the support   x_C'' = gx - drag N
    normal to it        y_C'' = gy + N,  y_C = y
    rotation            rho^2 alpha = -N (x + drag y)

so that (rho^2 + x (x + drag y)) alpha = (omega^2 y + gy) (x + drag y), one second-order equation for the angle, which
Gragg's midpoint rule with extrapolation integrates (Bulirsch and Stoer, Numer. Math. 8, 1966). N has the sign of
-(omega^2 y + gy) while the bracket is positive. The slip needs no integration: x_C' + drag y_C' grows by
gx + drag gy per second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from .stretch import End, Stretch
from .types import Vector

_SUBSTEPS = (2, 4, 6, 8, 10, 12)
_GAINS = tuple(
    tuple(coarse**2 / (fine**2 - coarse**2) for coarse in reversed(_SUBSTEPS[:row]))
    for row, fine in enumerate(_SUBSTEPS)
)
"""What the difference of two results of extrapolation counts in the next one (Aitken and Neville, in the square)."""
_GROWTH = (0.3, 0.3, 4.0, 3.0, 2.0, 1.3, 0.9)
"""Factor on the next step, by the rows of extrapolation that this one took (0: it did not settle)."""
_MAX_STEPS = 200
"""Several times what the longest slides take."""
_SMALLEST_STEP = 1e-10
"""Relative to the first step. Where smaller steps are refused, no smooth motion goes on."""
_CLOSE = 1e-6
"""After a Newton step this small, relative to the bracket, what is left is its square."""

Event = tuple[float, float]
"""A condition, positive until the event, and its rate of change."""
Acceleration = Callable[[float, float], float]


class _Instant(NamedTuple):
    """Time in s, turned angle in rad, angular velocity in rad/s and acceleration in rad/s^2."""

    time: float
    turned: float
    omega: float
    alpha: float


class _SlippingStance:
    """What follows from the turned angle and its rate without integration: slip, load and the conditions to watch."""

    def __init__(
        self, arm: Vector, omega: float, slip: float, drag: float, gravity: Vector, direction: int, reach: float
    ) -> None:
        self.arm, self.slip, self.drag = arm, slip, drag
        self.direction, self.reach = direction, reach
        self.gravity_y = gravity[1]
        self.drive = gravity[0] + drag * gravity[1]
        self.spin = omega * (drag * arm[0] - arm[1])

    def events(self, now: _Instant) -> tuple[Event, ...]:
        """The conditions in the order of `End`; without friction it changes nothing when the slip stops."""
        time, turned, omega, alpha = now
        x, y = _rotate(self.arm, turned)
        direction, drag, square = self.direction, self.drag, omega * omega
        touches = self.reach - direction * turned, -direction * omega
        turns = direction * omega, direction * alpha
        lifts = -square * y - self.gravity_y, -omega * (2.0 * alpha * y + square * x)
        if not drag:
            return touches, turns, lifts
        lever = drag * x - y
        slip = self.slip + self.drive * time - (omega * lever - self.spin)
        slip_rate = self.drive - alpha * lever + square * (drag * y + x)
        return touches, turns, lifts, (slip, slip_rate) if drag > 0.0 else (-slip, -slip_rate)

    def end(self, end: End, now: _Instant) -> Stretch:
        """The stretch that ends now, with the value that ends it exact."""
        time, turned, omega, _ = now
        x, y = _rotate(self.arm, turned)
        slip = self.slip + self.drive * time - (omega * (self.drag * x - y) - self.spin)
        moved = (self.slip + self.spin + 0.5 * self.drive * time) * time
        moved -= self.drag * (y - self.arm[1]) + (x - self.arm[0])
        if end is End.TOUCHES:
            turned = self.direction * self.reach
        elif end is End.TURNS:
            omega = 0.0
        return Stretch(end, time, turned, omega, slip, moved, self.direction)


def slide(
    arm: Vector,
    omega: float,
    slip: float,
    drag: float,
    travel: Vector,
    rho_squared: float,
    gravity: Vector,
    horizon: float,
    tolerance: float,
) -> Stretch:
    """Follow a slipping stance until its first event.

    `arm` from the stance contact to the mass centre in m; `slip` velocity of the contact in m/s; `drag` the friction
    coefficient with the sign of the slip (which is its direction where `slip` is still 0); `travel` how far in rad
    the body can turn clockwise and counter-clockwise until another point touches (0: it rests on that point already);
    `rho_squared` in m^2; `gravity` in m/s^2; `horizon` in s; `tolerance` the error allowed to a step, relative to the
    turning in it. A body that is pressed onto a point on which it rests ends with NEVER, and so does one that nothing
    happens to within 200 steps.
    """
    acceleration = _acceleration(arm, drag, rho_squared, gravity[1])
    now = _Instant(0.0, 0.0, omega, acceleration(0.0, omega))
    heading = omega or now.alpha
    direction = (heading > 0.0) - (heading < 0.0)
    reach = travel[direction > 0] if direction else math.inf
    stance = _SlippingStance(arm, omega, slip, drag, gravity, direction, reach)
    if omega * omega * arm[1] + gravity[1] >= 0.0:
        return stance.end(End.LIFTS, now)
    if math.isnan(now.alpha):
        return stance.end(End.JAMS, now)
    if reach <= 0.0:
        return stance.end(End.TOUCHES if omega else End.NEVER, now)
    if not direction:
        return _glide(stance, horizon)

    before = stance.events(now)
    radius = math.hypot(*arm)
    pace = abs(omega) + math.sqrt(abs(now.alpha) + radius * math.hypot(*gravity) / (rho_squared + radius * radius))
    step = min(0.2 / pace, horizon)
    smallest = _SMALLEST_STEP * step
    for _ in range(_MAX_STEPS):
        step = min(step, horizon - now.time)
        then, rows = _step(acceleration, now, step, tolerance)
        if not rows:
            step *= _GROWTH[rows]
            if step < smallest:
                return stance.end(End.JAMS, now)
            continue
        after = stance.events(then)
        if step > smallest and any(_dips(start, end, step) for start, end in zip(before, after, strict=True)):
            step *= 0.25
            continue
        crossed = [index for index, (value, _) in enumerate(after) if value < 0.0 or value == 0.0 < before[index][0]]
        if crossed:
            now, index = min(
                (_crossing(stance, acceleration, tolerance, now, step, before[index], after[index], index), index)
                for index in crossed
            )
            return stance.end(End(index), now)
        now, before = then, after
        if now.time >= horizon:
            break
        step *= _GROWTH[rows]
    return stance.end(End.NEVER, now)


def _rotate(arm: Vector, turned: float) -> Vector:
    sine, cosine = math.sin(turned), math.cos(turned)
    return arm[0] * cosine - arm[1] * sine, arm[0] * sine + arm[1] * cosine


def _acceleration(arm: Vector, drag: float, rho_squared: float, gravity_y: float) -> Acceleration:
    """The angular acceleration of turned angle and rate; NaN where no finite reaction keeps the contact down."""
    arm_x, arm_y = arm

    def acceleration(turned: float, omega: float) -> float:
        sine, cosine = math.sin(turned), math.cos(turned)
        x, y = arm_x * cosine - arm_y * sine, arm_x * sine + arm_y * cosine
        lever = x + drag * y
        bracket = rho_squared + x * lever
        return (omega * omega * y + gravity_y) * lever / bracket if bracket > 0.0 else math.nan

    return acceleration


def _glide(stance: _SlippingStance, horizon: float) -> Stretch:
    """The stretch of a contact that slips while nothing turns the body: the slip changes at a constant rate."""
    if stance.drag * stance.drive < 0.0:
        time = -stance.slip / stance.drive
        if time <= horizon:
            return stance.end(End.STOPS, _Instant(time, 0.0, 0.0, 0.0))
    return Stretch(End.NEVER, 0.0, 0.0, 0.0, stance.slip)


def _dips(start: Event, end: Event, step: float) -> bool:
    """Whether a condition that is positive at both ends of a step may vanish between them."""
    (value, rate), (end_value, end_rate) = start, end
    if value <= 0.0 or end_value <= 0.0 or not rate < 0.0 < end_rate:
        return False
    # The tangents at the two ends meet below the dip.
    return value + rate * (end_value - value - end_rate * step) / (rate - end_rate) <= 0.0


def _crossing(
    stance: _SlippingStance,
    acceleration: Acceleration,
    tolerance: float,
    now: _Instant,
    step: float,
    start: Event,
    end: Event,
    index: int,
) -> _Instant:
    """How far into a step a condition vanishes: on the cubic through both ends, then by steps of that length."""
    (value, rate), (end_value, end_rate) = start, end
    chord = (end_value - value) / step
    square, cube = (3.0 * chord - 2.0 * rate - end_rate) / step, (rate + end_rate - 2.0 * chord) / (step * step)

    def cubic(h: float) -> Event:
        return value + h * (rate + h * (square + h * cube)), rate + h * (2.0 * square + 3.0 * h * cube)

    then = now

    def exact(h: float) -> Event:
        nonlocal then
        then, _ = _step(acceleration, then, now.time + h - then.time, tolerance)
        return stance.events(then)[index]

    root = now.time + _root(exact, step, _root(cubic, step, 0.5 * step))
    time, turned, omega, alpha = then
    rest = root - time
    return _Instant(root, turned + (omega + 0.5 * alpha * rest) * rest, omega + alpha * rest, alpha)


def _root(condition: Callable[[float], Event], high: float, guess: float) -> float:
    """Where in [0, high] a condition falls to zero: Newton's method, kept in its bracket by bisection."""
    low, close = 0.0, _CLOSE * high
    for _ in range(60):
        value, rate = condition(guess)
        if value >= 0.0:
            low = guess
        else:
            high = guess
        better = guess - value / rate if rate < 0.0 else math.inf
        if not low <= better <= high:
            better = 0.5 * (low + high)
        if abs(better - guess) <= close:
            return better
        guess = better
    return guess


def _step(acceleration: Acceleration, now: _Instant, step: float, tolerance: float) -> tuple[_Instant, int]:
    """One step and in how many rows of extrapolation it settled: 0 where it did not, or where it overflowed."""
    try:
        return _extrapolate(acceleration, now, step, tolerance)
    except ValueError:  # the sine of an angle that is infinite: near a jam the acceleration has a pole
        return now, 0


def _extrapolate(acceleration: Acceleration, now: _Instant, step: float, tolerance: float) -> tuple[_Instant, int]:
    """One step of the midpoint rule in more and more substeps, extrapolated until it settles; and in how many rows."""
    time, angle, omega, alpha = now
    allowed = tolerance * abs(step) * (abs(omega) + abs(step * alpha))
    table: list[Vector] = []
    turn = spin = more_turn = more_spin = 0.0
    rows = 0
    for substeps, gains in zip(_SUBSTEPS, _GAINS, strict=True):
        h = step / substeps
        twice = 2.0 * h
        last_turn = last_spin = 0.0
        turn, spin = h * omega, h * alpha
        for _ in range(substeps - 1):
            kick = acceleration(angle + turn, omega + spin)
            last_turn, turn = turn, last_turn + twice * (omega + spin)
            last_spin, spin = spin, last_spin + twice * kick
        for column, gain in enumerate(gains):
            coarse_turn, coarse_spin = table[column]
            table[column] = turn, spin
            more_turn, more_spin = gain * (turn - coarse_turn), gain * (spin - coarse_spin)
            turn += more_turn
            spin += more_spin
        table.append((turn, spin))
        if gains and abs(more_turn) + abs(step * more_spin) <= allowed:
            rows = len(table)
            break
    angle, omega = angle + turn, omega + spin
    return _Instant(time + step, angle, omega, acceleration(angle, omega)), rows
