"""Touchdowns by integrating the equations of motion in steps up to the event that a point touches."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any

from scipy.integrate import solve_ivp

from ...mechanics.types import Twist
from .methods import Method, over
from .touchdown_equations import stance_of, striking
from .touchdown_methods import constant_acceleration
from .touchdown_scenes import Falling, Landing

STEPS = (4, 16, 64, 256, 1024)
TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)

LONGEST = 50
"""A body that has not touched down after this many times the steps that were planned is given up."""

SECANTS = 10
"""Most repetitions of the last step; three or four do."""

HORIZON = 20.0
"""s within which DOP853 looks for the touchdown."""

FAMILIES = {
    "RK4": "Runge-Kutta of order 4 with a fixed step, 1/n of the time that constant acceleration takes; the last step "
    "ends at the touchdown.",
    "DOP853": "scipy's solve_ivp of order 8 with adaptive steps; its event function is the gap.",
}

Values = tuple[float, ...]
Equations = tuple[Values, Callable[[Values], Values], Callable[[Values], float], Callable[[Values], Twist]]
"""Start; its rates; the gap, which is zero at the touchdown; the twist of the mass centre."""


def equations_of(fall: Falling) -> Equations:
    """Angle, rate and slip of a body that stands; place and velocity of one in flight."""
    x, y, angle, vx, vy, omega = fall.state
    if fall.stance is None:
        pull_x, pull_y = fall.gravity
        points = striking(fall)

        def lowest(values: Values) -> float:
            c, s = cos(values[1]), sin(values[1])
            return values[0] + min([s * px + c * py for px, py in points])

        return (
            (y, angle, vx, vy),
            lambda values: (values[3], omega, pull_x, pull_y),
            lowest,
            lambda values: Twist(values[2], values[3], omega),
        )
    stance = stance_of(fall)
    accelerations = stance.accelerations

    def rates(values: Values) -> Values:
        alpha, slide = accelerations(values[0], values[1])
        return values[1], alpha, slide

    slip = 0.0 if stance.drag is None else vx + omega * y
    # Both points are at one height at angle 0.
    return (angle, omega, slip), rates, lambda values: values[0], lambda values: stance.twist(*values)


def step(rates: Callable[[Values], Values], values: Values, first: Values, h: float) -> Values:
    """One step of the classical Runge-Kutta method; `first` are the rates at its beginning."""
    half, sixth = 0.5 * h, h / 6.0
    second = rates(tuple([v + half * k for v, k in zip(values, first, strict=True)]))
    third = rates(tuple([v + half * k for v, k in zip(values, second, strict=True)]))
    fourth = rates(tuple([v + h * k for v, k in zip(values, third, strict=True)]))
    return tuple(
        [
            v + sixth * (k + 2.0 * (m + n) + o)
            for v, k, m, n, o in zip(values, first, second, third, fourth, strict=True)
        ]
    )


def rk4(fall: Falling, steps: int) -> Landing | None:
    """Fixed steps; the step in which the gap closes is repeated with its length found by the secant rule."""
    guess = constant_acceleration(fall)
    if guess is None:
        return None
    values, rates, gap, twist = equations_of(fall)
    h, time = guess.time / steps, 0.0
    above = gap(values)
    for _ in range(LONGEST * steps):
        first = rates(values)
        after = step(rates, values, first, h)
        below = gap(after)
        if below <= 0.0 < above:
            part, after = last_step(rates, gap, values, first, above, h, below)
            return Landing(time + part, twist(after))
        values, above, time = after, below, time + h
    return None


def last_step(
    rates: Callable[[Values], Values],
    gap: Callable[[Values], float],
    values: Values,
    first: Values,
    above: float,
    h: float,
    below: float,
) -> tuple[float, Values]:
    """The step at whose end the gap is zero, by the secant rule, and where it ends."""
    last, part, after = 0.0, h, values
    for _ in range(SECANTS):
        if below == above or abs(part - last) <= 1e-15 * h:
            break
        last, part, above = part, part - below * (part - last) / (below - above), below
        after = step(rates, values, first, part)
        below = gap(after)
    return part, after


def dop853(fall: Falling, tolerance: float) -> Landing | None:
    """solve_ivp up to its terminal event."""
    values, rates, gap, twist = equations_of(fall)

    def touches(time: float, now: Any) -> float:
        return gap(now)

    touches.terminal, touches.direction = True, -1.0  # type: ignore[attr-defined]
    found = solve_ivp(
        lambda time, now: rates(now), (0.0, HORIZON), values, "DOP853", rtol=tolerance, atol=tolerance, events=touches
    )
    if not found.t_events[0].size:
        return None
    return Landing(float(found.t_events[0][0]), twist(tuple(found.y_events[0][0].tolist())))


METHODS: list[Method] = [
    *over("RK4", "RK4", "n = {}", STEPS, rk4),
    *over("DOP853", "scipy DOP853 with an event", "rtol = {:g}", TOLERANCES, dop853),
]
