"""How fast and how long a body turns over a contact that slips: one sweep of its angle, by quadrature.

With the arm (x, y) from the stance contact to the mass centre, L = x + drag y and B = rho^2 + x L, the energy of
turning w = omega^2 / 2 is linear in itself along the turned angle phi:

    B dw/dphi = (2 w y + gy) L,    so that    d(w B E)/dphi = gy L E,    d(ln E)/dphi = -drag R^2 / B,

since 2 y L = drag R^2 - dB/dphi. As B is a constant and a wave of twice the angle, ln E is an arc tangent. The motion
linearised about its start, phi'' = alpha + growth phi, is known, with its energy w0 as a function of its time s. What
is left of the rate and of the time are integrals of smooth functions, a force and a lag,

    d((w - w0) B E)/dphi = ((2 w0 y + gy) L - phi'' B) E,    1 - dt/ds = 1 - sqrt(w0 / w),

without the square roots of a start from rest and the logarithm of a balance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from .radau import RESTING, STARTING, Rule, total

_LEAST_ROOT = 1e-9
"""In place of a smaller root of the discriminant of B, relative: arc tangent and argument are one there to rounding."""
_LEAST_GROWTH = 1e-24
"""In place of none, relative: it changes nothing."""


class Stance(NamedTuple):
    """What does not change while a contact slips one way, seen so that the body turns counter-clockwise.

    `drag` has the sign of the slip, which `side` is; `rho_squared` in m^2, `gravity` the part out of the support.
    """

    drag: float
    side: int
    rho_squared: float
    gravity: float


class Pose(NamedTuple):
    """Arm from the contact to the mass centre in m, angular speed in rad/s, L in m, B in m^2, angular acceleration in
    rad/s^2, and what it gains along the motion by each radian.
    """

    x: float
    y: float
    rate: float
    lever: float
    bracket: float
    alpha: float
    growth: float


Node = tuple[float, float, float, float, float]
"""Turned angle in rad, arm (x, y) in m, L in m, B in m^2."""


class Sweep(NamedTuple):
    """A sweep: its start and its nodes, the angular speed at each, and 1 - dt/ds at the nodes.

    `rates` and `lags` end before a node that the body does not reach; then `error` is inf. `linear_time` and `time` in
    s are those of the motion linearised and of the motion, `error` is that of the polynomials through the nodes,
    relative, and `factor` is E at the end.
    """

    rule: Rule
    nodes: list[Node]
    rates: list[float]
    lags: list[float]
    linear_time: float
    time: float
    error: float
    factor: float


def pose_at(stance: Stance, x: float, y: float, rate: float) -> Pose:
    """The pose with this arm and angular speed; B must not be 0."""
    drag, _, rho_squared, gravity = stance
    lever, lever_rate = x + drag * y, drag * x - y
    bracket, bracket_rate = rho_squared + x * lever, x * lever_rate - y * lever
    square = rate * rate
    push = square * y + gravity
    alpha = push * lever / bracket
    growth = (2.0 * alpha * y + square * x) * lever + push * lever_rate - alpha * bracket_rate
    return Pose(x, y, rate, lever, bracket, alpha, growth / bracket)


def sweep(stance: Stance, pose: Pose, span: float) -> Sweep:
    """Turn by `span` rad.

    Raises ArithmeticError or ValueError where B vanishes, the motion linearised does not come that far, or numbers
    overflow.
    """
    drag, _, rho_squared, gravity = stance
    x0, y0, rate, lever, bracket0, alpha, growth = pose
    rule = STARTING if rate else RESTING
    growth = growth or _LEAST_GROWTH * (rate * rate / span + abs(alpha)) / span
    root, energy = math.sqrt(abs(growth)), rate * rate + 2.0 * alpha * span
    end_rate = math.sqrt(energy + growth * span * span)
    if growth > 0.0:
        phase = math.log1p(2.0 * root * span / (rate + energy / (end_rate + root * span)))
    else:
        phase = 2.0 * math.atan(root * span / (rate + end_rate))
    linear_time = phase / root
    odd_angle, even_angle, odd_rate = rate / root, alpha / growth, alpha / root

    radius_squared = x0 * x0 + y0 * y0
    along = 0.5 * drag * (x0 * x0 - y0 * y0) - x0 * y0
    discriminant = (2.0 * rho_squared + radius_squared - bracket0) * bracket0 - along * along
    arc = math.atan2 if discriminant > 0.0 else _artanh2
    width = max(math.sqrt(abs(discriminant)), _LEAST_ROOT * bracket0)
    decay, half = -drag * radius_squared / width, 0.5 / linear_time
    sin, cos, exp, expm1, sqrt = math.sin, math.cos, math.exp, math.expm1, math.sqrt
    nodes: list[Node] = [(0.0, x0, y0, lever, bracket0)]
    linear_rates: list[float] = []
    weights: list[float] = []
    forces: list[float] = []
    for s in rule.nodes:
        if growth > 0.0:
            more = expm1(phase * s)
            less = more / (1.0 + more)
            odd, even = 0.5 * (more + less), 0.5 * more * less
        else:
            odd, even = sin(phase * s), -2.0 * sin(0.5 * phase * s) ** 2
        turned = odd_angle * odd + even_angle * even
        linear_rate = rate + rate * even + odd_rate * odd
        sine, cosine = sin(turned), cos(turned)
        x, y = x0 * cosine - y0 * sine, x0 * sine + y0 * cosine
        lever = x + drag * y
        bracket = rho_squared + x * lever
        factor = exp(decay * arc(width * sine, bracket0 * cosine + along * sine))
        push = linear_rate * linear_rate * y + gravity
        nodes.append((turned, x, y, lever, bracket))
        linear_rates.append(linear_rate)
        weights.append(half * factor * bracket)
        forces.append(factor * linear_rate * (push * lever - (alpha + growth * turned) * bracket))

    f1, f2, f3, f4, f5, f6, f7 = forces
    rates = [rate]
    lags: list[float] = []
    least = math.inf
    for (m1, m2, m3, m4, m5, m6, m7), linear_rate, weight in zip(rule.forces, linear_rates, weights, strict=True):
        gain = m1 * f1 + m2 * f2 + m3 * f3 + m4 * f4 + m5 * f5 + m6 * f6 + m7 * f7
        square = linear_rate * linear_rate + gain / weight
        if square <= 0.0:
            return Sweep(rule, nodes, rates, lags, linear_time, 0.0, math.inf, factor)
        if weight * square < least:
            least = weight * square
        omega = sqrt(square)
        rates.append(omega)
        lags.append(1.0 - linear_rate / omega)
    share = 1.0 - total(rule.lags[6], lags)
    (force, other_force), (lag, other_lag) = rule.last_forces, rule.last_lags
    error = (abs(total(lag, lags)) + abs(total(other_lag, lags))) / share
    error += rule.share * (abs(total(force, forces)) + abs(total(other_force, forces))) / least
    return Sweep(rule, nodes, rates, lags, linear_time, linear_time * share, error, factor)


def _artanh2(sine: float, cosine: float) -> float:
    """In place of the arc tangent of two arguments where B has real zeros."""
    return math.atanh(sine / cosine)
