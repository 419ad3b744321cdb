"""How fast and how long a body turns over a contact that slips: one sweep of its angle, by quadrature.

With the arm (x, y) from the stance contact to the mass centre, L = x + drag y and B = rho^2 + x L, the energy of
turning w = omega^2 / 2 is linear in itself along the turned angle phi:

    B dw/dphi = (2 w y + gy) L,    so that    d(w B E)/dphi = gy L E,    d(ln E)/dphi = -drag R^2 / B,

since 2 y L = drag R^2 - dB/dphi. As B is a constant and a wave of twice the angle, ln E is an arc tangent. The motion
linearised about its start, phi'' = alpha + growth phi, is known, with its energy w0 as a function of its time s. What
is left of the rate and of the time are integrals of smooth functions, a force and a lag,

    d((w - w0) B E)/dphi = ((2 w0 y + gy) L - phi'' B) E,    1 - dt/ds = 1 - sqrt(w0 / w),

without the square roots of a start from rest and the logarithm of a balance.

Two rules integrate them on 0..1 from their values at six nodes and at the end. `STARTING` is for functions that begin
like s^2; its nodes are Radau's for the weight s^2, with the zeros of the Jacobi polynomial P_6^(1,2), so that whole
integrals are exact to degree 14. `RESTING` is for functions that are a power times a function of s^2 and begin like s^5
or like s^4 (force and lag of a motion from rest); the squares of its nodes are the zeros of P_6^(1,3/2). Integrals up
to a node are exact to seven terms, however small they are.
"""

from __future__ import annotations

import math
from typing import NamedTuple

_LEAST_ROOT = 1e-9
"""In place of a smaller root of the discriminant of B, relative: arc tangent and argument are one there to rounding."""
_LEAST_GROWTH = 1e-24
"""In place of none, relative: it changes nothing."""

NodeWeights = tuple[float, ...]
"""What the seven values of a function at the nodes count in something linear in it."""

_GAUSS = (
    (0.01304673574141414, 0.03333567215434407),
    (0.06746831665550775, 0.0747256745752903),
    (0.1602952158504878, 0.10954318125799102),
    (0.2833023029353764, 0.13463335965499817),
    (0.4255628305091844, 0.14776211235737644),
    (0.5744371694908156, 0.14776211235737644),
    (0.7166976970646236, 0.13463335965499817),
    (0.8397047841495122, 0.10954318125799102),
    (0.9325316833444922, 0.0747256745752903),
    (0.9869532642585859, 0.03333567215434407),
)
"""Nodes and weights of Gauss's rule of ten nodes on 0..1, exact to degree 19."""


class QuadratureRule(NamedTuple):
    """The nodes, rows for the integrals up to each node of a force and of a lag, and rows for the last coefficients.

    The last two coefficients of the polynomials that describe seven values tell how well they do; `share` is what they
    count in a force, beside those in a lag, found by trial.
    """

    nodes: NodeWeights
    forces: tuple[NodeWeights, ...]
    lags: tuple[NodeWeights, ...]
    last_forces: tuple[NodeWeights, NodeWeights]
    last_lags: tuple[NodeWeights, NodeWeights]
    share: float


def weighted(row: NodeWeights, values: list[float]) -> float:
    """What the row says of a function with these values at the nodes."""
    m1, m2, m3, m4, m5, m6, m7 = row
    f1, f2, f3, f4, f5, f6, f7 = values
    return m1 * f1 + m2 * f2 + m3 * f3 + m4 * f4 + m5 * f5 + m6 * f6 + m7 * f7


def _integrals(nodes: NodeWeights, power: int, step: int) -> tuple[NodeWeights, ...]:
    """Rows for the integrals up to each node of s^power times a polynomial in s^step."""
    places = [s**step for s in nodes]
    scales = [
        s**power * math.prod(z - other for other in places if other != z) for s, z in zip(nodes, places, strict=True)
    ]
    rows = []
    for end in nodes:
        row = [0.0] * len(nodes)
        for share, weight in _GAUSS:
            s = end * share
            whole = end * weight * s**power * math.prod(s**step - other for other in places)
            row = [
                so_far + whole / (scale * (s**step - z)) for so_far, scale, z in zip(row, scales, places, strict=True)
            ]
        rows.append(tuple(row))
    return tuple(rows)


def _last(nodes: NodeWeights, weights: NodeWeights, power: int, step: int) -> tuple[NodeWeights, NodeWeights]:
    """Rows for the last two coefficients over s^power, in polynomials in s^step.

    These are orthogonal on the nodes, and 1 at the end: a divided difference is orthogonal to all lower powers.
    """
    places = [s**step for s in nodes]
    differences = [1.0 / math.prod(place - other for other in places if other != place) for place in places]
    masses = [weight * s**power for weight, s in zip(weights, nodes, strict=True)]
    squares = [d * d / mass for d, mass in zip(differences, masses, strict=True)]
    middle = weighted(tuple(places), squares) / weighted((1.0,) * 7, squares)
    rows = []
    for factors in ([place - middle for place in places], [1.0] * 7):
        terms = [factor * d for factor, d in zip(factors, differences, strict=True)]
        end = terms[6] / (masses[6] * weighted(tuple([factor * factor for factor in factors]), squares))
        rows.append(tuple([end * term / s**power for term, s in zip(terms, nodes, strict=True)]))
    return rows[0], rows[1]


def _rule(inner: tuple[float, ...], force: int, lag: int, step: int, share: float) -> QuadratureRule:
    nodes = *inner, 1.0
    forces = _integrals(nodes, force, step)
    lags = forces if lag == force else _integrals(nodes, lag, step)
    return QuadratureRule(
        nodes=nodes,
        forces=forces,
        lags=lags,
        last_forces=_last(nodes, forces[-1], force, step),
        last_lags=_last(nodes, lags[-1], lag, step),
        share=share,
    )


STARTING = _rule(
    inner=(
        0.10030907272538186,
        0.2540471043305593,
        0.4441330323002051,
        0.6417698862240983,
        0.8168966635278575,
        0.942844240891898,
    ),
    force=2,
    lag=2,
    step=1,
    share=0.05,
)
RESTING = _rule(
    inner=(
        0.2866931768366051,
        0.4793963839520358,
        0.6486752725863241,
        0.7900276557072898,
        0.8983054071351697,
        0.969308255786329,
    ),
    force=5,
    lag=4,
    step=2,
    share=0.015,
)


class SlipStance(NamedTuple):
    """What does not change while a contact slips one way, seen so that the body turns counter-clockwise.

    `drag` has the sign of the slip, which `side` is; `rho_squared` in m^2, `gravity` the part out of the support.
    """

    drag: float
    side: int
    rho_squared: float
    gravity: float


class PivotPose(NamedTuple):
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


SweepNode = tuple[float, float, float, float, float]
"""Turned angle in rad, arm (x, y) in m, L in m, B in m^2."""


class Sweep(NamedTuple):
    """A sweep: its start and its nodes, the angular speed at each, and 1 - dt/ds at the nodes.

    `rates` and `lags` end before a node that the body does not reach; then `error` is inf. `linear_time` and `time` in
    s are those of the motion linearised and of the motion, `error` is that of the polynomials through the nodes,
    relative, and `factor` is E at the end.
    """

    rule: QuadratureRule
    nodes: list[SweepNode]
    rates: list[float]
    lags: list[float]
    linear_time: float
    time: float
    error: float
    factor: float


def pose_at(stance: SlipStance, x: float, y: float, rate: float) -> PivotPose:
    """The pose with this arm and angular speed; B must not be 0."""
    drag, _, rho_squared, gravity = stance
    lever, lever_rate = x + drag * y, drag * x - y
    bracket, bracket_rate = rho_squared + x * lever, x * lever_rate - y * lever
    square = rate * rate
    push = square * y + gravity
    alpha = push * lever / bracket
    growth = (2.0 * alpha * y + square * x) * lever + push * lever_rate - alpha * bracket_rate
    return PivotPose(x=x, y=y, rate=rate, lever=lever, bracket=bracket, alpha=alpha, growth=growth / bracket)


def sweep(stance: SlipStance, pose: PivotPose, span: float) -> Sweep:
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
    nodes: list[SweepNode] = [(0.0, x0, y0, lever, bracket0)]
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
    least, time, error = math.inf, 0.0, math.inf
    for (m1, m2, m3, m4, m5, m6, m7), linear_rate, weight in zip(rule.forces, linear_rates, weights, strict=True):
        gain = m1 * f1 + m2 * f2 + m3 * f3 + m4 * f4 + m5 * f5 + m6 * f6 + m7 * f7
        square = linear_rate * linear_rate + gain / weight
        if square <= 0.0:
            break
        if weight * square < least:
            least = weight * square
        omega = sqrt(square)
        rates.append(omega)
        lags.append(1.0 - linear_rate / omega)
    else:
        share = 1.0 - weighted(rule.lags[6], lags)
        (force, other_force), (lag, other_lag) = rule.last_forces, rule.last_lags
        error = (abs(weighted(lag, lags)) + abs(weighted(other_lag, lags))) / share
        error += rule.share * (abs(weighted(force, forces)) + abs(weighted(other_force, forces))) / least
        time = linear_time * share
    return Sweep(
        rule=rule,
        nodes=nodes,
        rates=rates,
        lags=lags,
        linear_time=linear_time,
        time=time,
        error=error,
        factor=factor,
    )


def _artanh2(sine: float, cosine: float) -> float:
    """In place of the arc tangent of two arguments where B has real zeros."""
    return math.atanh(sine / cosine)
