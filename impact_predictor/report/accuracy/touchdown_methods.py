"""Methods for the next touchdown that make no steps: extrapolations, quadratures, and the program's own predictor."""

from __future__ import annotations

from functools import cache
from math import acos, atan2, cos, hypot, inf, sin, sqrt

import numpy as np

from ...mechanics.motion import next_touchdown
from ...mechanics.types import Twist
from ...prediction.points import ACCURACY
from .methods import Method, method, over
from .touchdown_equations import gap_of, slip_of, stance_of, striking, twist_rates
from .touchdown_scenes import Falling, Landing

FINEST = 1e-10
"""Tolerance of a stance that slips, besides the node's."""

NODES = (2, 4, 8, 16, 32, 64)

FAMILIES = {
    "constant twist": "The gap of the new contact goes on closing at the rate that it has now.",
    "ballistic": "As if the body were thrown without turning: gravity alone changes the gap and the twist.",
    "constant acceleration": "Gap and twist go on with the accelerations that they have now.",
    "quadrature": "The energy integral of d phi / omega by Gauss's rule with n nodes, as it stands: it is singular "
    "where the body rests.",
    "regular quadrature": "The same integral over the square root of the angle from the point of rest, where nothing "
    "is singular; n nodes.",
    "exact": "This program's next_touchdown: an elliptic integral while the stance sticks, extrapolated steps within "
    "a tolerance while it slips, safe root finding in flight, and every change between them.",
}


def constant_twist(fall: Falling) -> Landing | None:
    """Linear extrapolation of the gaps."""
    return extrapolated(fall, Twist(0.0, 0.0, 0.0), 0.0)


def ballistic(fall: Falling) -> Landing | None:
    """Gaps that gravity alone accelerates."""
    return extrapolated(fall, Twist(*fall.gravity, 0.0), 0.0)


def constant_acceleration(fall: Falling) -> Landing | None:
    """Gaps with their present accelerations."""
    return extrapolated(fall, twist_rates(fall), 1.0)


def extrapolated(fall: Falling, rates: Twist, turning: float) -> Landing | None:
    """The first root of the parabolas of the gaps; `turning` 1 takes their acceleration by the turning, too."""
    first = inf
    for point in striking(fall):
        gap, rate, acceleration = gap_of(fall.state, point, rates)
        first = min(first, first_root(gap, rate, acceleration if turning else rates.vy))
    if first == inf:
        return None
    state = fall.state
    return Landing(
        first, Twist(state.vx + rates.vx * first, state.vy + rates.vy * first, state.omega + rates.omega * first)
    )


def first_root(gap: float, rate: float, acceleration: float) -> float:
    """First t > 0 at which gap + rate t + acceleration t^2 / 2 is zero, inf if there is none."""
    square = rate * rate - 2.0 * acceleration * gap
    if square < 0.0:
        return inf
    down = sqrt(square) - rate
    return 2.0 * gap / down if down > 0.0 else inf


def sticks(fall: Falling) -> bool:
    """Whether a body turns about a stance that sticks."""
    return fall.stance is not None and slip_of(fall) == 0.0


@cache
def gauss(count: int) -> list[tuple[float, float]]:
    """Nodes in 0..1 and weights of Gauss's rule."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return list(zip((0.5 + 0.5 * nodes).tolist(), (0.5 * weights).tolist(), strict=True))


def quadrature(fall: Falling, count: int) -> Landing:
    """Gauss's rule on d phi / omega, up to the point of rest of a body that rises and from there down."""
    k, lean, rest, end = swing_of(fall)
    omega = fall.state.omega
    square = omega * omega

    def time(begin: float, until: float) -> float:
        size = until - begin
        total = 0.0
        for node, weight in gauss(count):
            part = size * node
            gain = 4.0 * k * sin(0.5 * (begin + part - lean)) * sin(0.5 * (begin + part + lean))
            total += weight / sqrt(square + gain)
        return size * total

    if omega > 0.0:
        return landing(fall, time(rest, lean) + time(rest, end))
    return landing(fall, time(lean, end))


def regular_quadrature(fall: Falling, count: int) -> Landing:
    """Gauss's rule over s, where the lean is that of the point of rest plus s^2."""
    k, lean, rest, end = swing_of(fall)

    def time(begin: float, until: float) -> float:
        size = until - begin
        total = 0.0
        for node, weight in gauss(count):
            s = begin + size * node
            half = 0.5 * s * s
            total += weight * s / sqrt(k * sin(rest + half) * sin(half))
        return size * total

    now, last = sqrt(max(0.0, lean - rest)), sqrt(end - rest)
    if fall.state.omega > 0.0:
        return landing(fall, time(0.0, now) + time(0.0, last))
    return landing(fall, time(now, last))


def swing_of(fall: Falling) -> tuple[float, float, float, float]:
    """k of omega^2 = 2 k (cos(rest) - cos(lean)), and the lean from the balance now, at rest and at the touchdown."""
    stance = stance_of(fall)
    x, y = stance.arm(0.0)
    k = -fall.gravity[1] * hypot(x, y) / (fall.rho_squared + x * x + y * y)
    end = atan2(x, y)
    lean, omega = end - fall.state.angle, fall.state.omega
    rest = acos(min(1.0, cos(lean) + omega * omega / (2.0 * k))) if omega else lean
    return k, lean, rest, end


def landing(fall: Falling, time: float) -> Landing:
    """The touchdown at a time, with the rate that the energy gives."""
    stance = stance_of(fall)
    x, y = stance.arm(0.0)
    end = atan2(x, y)
    k = -fall.gravity[1] * hypot(x, y) / (fall.rho_squared + x * x + y * y)
    angle, omega = fall.state.angle, fall.state.omega
    rate = -sqrt(omega * omega + 4.0 * k * sin(0.5 * angle) * sin(end - 0.5 * angle))
    return Landing(time, stance.twist(0.0, rate, 0.0))


def exact(fall: Falling, tolerance: float = FINEST) -> Landing | None:
    """The program's own predictor."""
    end = next_touchdown(*fall, tolerance=tolerance)
    return Landing(end.time, Twist(*end.state[3:])) if end.point >= 0 else None


METHODS: list[Method] = [
    method("constant twist", "constant twist", "", constant_twist),
    method("ballistic", "ballistic", "", ballistic),
    method("constant acceleration", "constant acceleration", "", constant_acceleration),
    *over("quadrature", "quadrature", "n = {}", NODES, quadrature, applies=sticks),
    *over("regular quadrature", "regular quadrature", "n = {}", NODES, regular_quadrature, applies=sticks),
    *over("exact", "next_touchdown", "tolerance = {:g}", (ACCURACY, FINEST), exact),
]
