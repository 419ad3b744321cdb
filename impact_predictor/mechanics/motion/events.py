"""What ends a phase of motion, and where within a step or a phase known in closed form a condition falls to 0.

A condition is positive until its event.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import IntEnum
from typing import Any, Final

Condition = tuple[float, float]
"""A value, not negative until its event, and its rate (NaN where it is not known)."""
Sinusoid = tuple[float, float, float]
"""Amplitudes of cosine and sine, and their rate."""

ROUNDING: Final = 8.0 * 2.0**-52
"""A few units in the last place of a value that is a sum of a few terms."""
SLIP_ROUNDING: Final = 1e-12
"""A slip this small, relative to the speeds it is the difference of, is none: states come through conversions."""
_MAX_ADVANCES: Final = 1000
"""Several times what the worst grazing needs."""
_CLOSE: Final = 1e-7
_CLOSE_BY_SECANT: Final = 1e-14
"""After an iteration this small, relative to the root, what is left is its square (by the secant: less of it)."""
_NEWTON_STEPS: Final = 4
"""On a cubic, from its secant."""
_BEYOND: Final = 2.0
"""A place beyond a step, which goes from 0 to 1."""


class Event(IntEnum):
    """What ends a phase of motion that goes on after it."""

    TOUCHES = 0
    """An open contact reaches the support."""
    STOPS = 1
    """The slip is zero."""
    LIFTS = 2
    """The support would have to pull at a contact (so a body leaves it where it might as well press on, Painleve)."""
    SLIPS = 3
    """A contact that stuck begins to slip along +t."""
    SLIPS_BACK = 4
    YIELDS = 5
    """A body that rested on both contacts begins to move."""
    JAMS = 6
    """No finite reaction keeps the slipping contact on the support (Painleve)."""
    TURNS_BACK = 7
    """The angular velocity is zero and changes its sign."""
    NEVER = 8
    """Nothing happens any more, or nothing within the horizon."""


class End(IntEnum):
    """Why a motion is followed no further."""

    RESTS = 0
    """At rest on both contacts of a fixed support, for ever."""
    BALANCED = 1
    """At rest on one contact of a fixed support, for ever."""
    OVERTURNED = 2
    """Turned too far to be carried by its two contacts; a disc has left its edges."""
    TIME_UP = 3
    """The duration is over; `phases` tell how the body moved then."""
    TOO_MANY_EVENTS = 4
    """As many events, or steps in all, as were allowed came first."""
    NO_SOLUTION = 5
    """No law has an answer to an impact, or numbers become too large or too small."""
    INVALID_INPUT = 6
    """A number is not finite or out of its range."""


def first_descent(
    level: float, slope: float, curvature: float, sinusoids: tuple[Sinusoid, ...], last: float, leaving: bool = False
) -> float:
    """First s in 0..last at which a condition is not positive and falls; inf when there is none.

    The condition is level + slope s + curvature s^2 / 2 + the sum of (c cos(r s) + q sin(r s)) over the sinusoids
    (c, q, r). Its derivatives have known bounds, so from each s a step is known in which it cannot vanish: the steps
    add up to the first root, quadratically, and pass none. A condition that begins at zero or below it must rise first;
    one that is `leaving` zero, at rest, does not begin with a fall, whatever an inexact start says.
    """
    amplitude = speed = bend = jolt = snap = 0.0
    for cosine_part, sine_part, rate in sinusoids:
        size, rate = math.hypot(cosine_part, sine_part), abs(rate)
        amplitude += size
        speed += size * rate
        bend += size * rate * rate
        jolt += size * rate * rate * rate
        snap += size * rate * rate * rate * rate
    fall = max(0.0, bend - curvature)
    s = 0.0
    for _ in range(_MAX_ADVANCES):
        if not s <= last or s == math.inf:
            break
        base, base_rate = level + (slope + 0.5 * curvature * s) * s, slope + curvature * s
        value, change, bow, jerk = base, base_rate, curvature, 0.0
        for cosine_part, sine_part, rate in sinusoids:
            cosine, sine = math.cos(rate * s), math.sin(rate * s)
            here, ahead = cosine_part * cosine + sine_part * sine, sine_part * cosine - cosine_part * sine
            value += here
            change += rate * ahead
            bow -= rate * rate * here
            jerk -= rate * rate * rate * ahead
        if leaving and s == 0.0:
            bow = max(0.0, bow)
        top_speed, top_bend = abs(slope) + abs(curvature) * s + speed, abs(curvature) + bend
        rounding = ROUNDING * (abs(level) + amplitude + top_speed * s)
        if value > rounding:
            step = safe_step(value, change, fall)
            if base > amplitude:
                step = max(step, safe_step(base - amplitude, base_rate, max(0.0, -curvature)))
        elif abs(change) > ROUNDING * (top_speed + top_bend * s):
            if change < 0.0:
                return s
            step = safe_step(change, bow, jolt)
        elif abs(bow) > ROUNDING * (top_bend + jolt * s):
            if bow < 0.0:
                return s
            step = safe_step(bow, jerk, snap)
        elif jerk > ROUNDING * jolt:
            step = safe_step(0.0, jerk, snap)
        else:
            return s if jolt > 0.0 else math.inf
        if s + step == s:
            return s  # within rounding of zero, in sinusoids too fast for the rounding of s
        s += step
    return math.inf


def safe_step(value: float, rate: float, fall: float) -> float:
    """The longest step in which value + rate s - fall s^2/2 stays positive."""
    root = math.sqrt(max(0.0, rate * rate + 2.0 * fall * value))
    if rate > 0.0:
        return (rate + root) / fall if fall > 0.0 else math.inf
    return 2.0 * value / (root - rate) if root > rate else math.inf


def dip(value: float, slope: float, end_value: float, end_slope: float) -> float:
    """Where on 0..1 a condition that is positive at both ends may fall to zero between them; beyond 1 if it does not.

    The tangents at the two ends of a dip meet below it, unless it also bends the other way: then its cubic shows it.
    """
    if value <= 0.0 or end_value <= 0.0 or not slope < 0.0 < end_slope:
        return _BEYOND
    at = (end_value - value - end_slope) / (slope - end_slope)
    if value + slope * at <= 0.0:
        return at
    rise = end_value - value
    square, cube = 3.0 * rise - 2.0 * slope - end_slope, slope + end_slope - 2.0 * rise
    root = math.sqrt(max(0.0, square * square - 3.0 * slope * cube))
    # Of both forms of where its slope is zero and grows, the one in which nothing cancels.
    at = -slope / (square + root) if square > 0.0 else (root - square) / (3.0 * cube)
    return at if value + at * (slope + at * (square + at * cube)) <= 0.0 else _BEYOND


def fall(value: float, slope: float, end_value: float, end_slope: float) -> float:
    """Where on 0..1 a condition with these values and slopes, which is below zero at the end, falls to zero."""
    rise = end_value - value
    square, cube = 3.0 * rise - 2.0 * slope - end_slope, slope + end_slope - 2.0 * rise
    if value <= 0.0:
        # It begins at zero; the root that is not there.
        root = math.sqrt(max(0.0, square * square - 4.0 * slope * cube))
        numerator, denominator = (-square - root, 2.0 * cube) if square > 0.0 else (2.0 * slope, root - square)
        at = numerator / denominator if denominator else 0.0
        return at if 0.0 < at <= 1.0 else 0.0
    low, high, at = 0.0, 1.0, value / (value - end_value)
    for _ in range(_NEWTON_STEPS):
        here, change = value + at * (slope + at * (square + at * cube)), slope + at * (2.0 * square + 3.0 * at * cube)
        low, high = (at, high) if here > 0.0 else (low, at)
        at = at - here / change if change < 0.0 else high
        at = at if low <= at <= high else 0.5 * (low + high)
    return at


def may_fall(first: Any, half: Any, last: Any) -> Any:
    """Whether a value may fall below zero between three samples, numbers or arrays, at equal distances.

    Their parabola does, with what it may be wrong by.
    """
    bend, slope = first - 2.0 * half + last, last - first
    bends = abs(bend) + (bend == 0.0)  # no division by zero
    dips = (bend > 0.0) & (abs(slope) < 2.0 * bend) & (half - 0.125 * slope * slope / bends - 0.1 * bend < 0.0)
    return dips | (first < 0.0) | (half < 0.0) | (last < 0.0)


def falling_root(condition: Callable[[float], Condition], high: float, high_value: float, guess: float) -> float:
    """Where in 0..high a condition falls to zero, from a guess and its value at the end.

    By Newton's method, or by the secant's where its rate is not known, kept in the bracket by bisection.
    """
    low, at, value = 0.0, high, high_value
    for _ in range(80):
        last, last_value, at = at, value, guess
        value, slope = condition(at)
        close = _CLOSE
        if math.isnan(slope):
            slope, close = (value - last_value) / (at - last) if at != last else 0.0, _CLOSE_BY_SECANT
        if value >= 0.0:
            low = at
        else:
            high = at
        guess = at - value / slope if slope < 0.0 else math.inf
        if not low <= guess <= high:
            guess = 0.5 * (low + high)
        if abs(guess - at) <= close * guess:
            break
    return guess
