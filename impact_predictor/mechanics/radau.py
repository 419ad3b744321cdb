"""Quadrature on 0..1 of functions that begin like a power, from their values at six nodes and at the end.

Two rules. `STARTING` is for functions that begin like s^2; its nodes are Radau's for the weight s^2, with the zeros of
the Jacobi polynomial P_6^(1,2), so that whole integrals are exact to degree 14. `RESTING` is for functions that are a
power times a function of s^2 and begin like s^5 or like s^4 (force and lag of a motion from rest); the squares of its
nodes are the zeros of P_6^(1,3/2). Integrals up to a node are exact to seven terms, however small they are.
"""

from __future__ import annotations

import math
import operator
from functools import reduce
from typing import NamedTuple

Row = tuple[float, float, float, float, float, float, float]
"""What the values of a function at the nodes count in something linear in it."""

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


class Rule(NamedTuple):
    """The nodes, rows for the integrals up to each node of a force and of a lag, and rows for the last coefficients.

    The last two coefficients of the polynomials that describe seven values tell how well they do; `share` is what they
    count in a force, beside those in a lag, found by trial.
    """

    nodes: Row
    forces: tuple[Row, ...]
    lags: tuple[Row, ...]
    last_forces: tuple[Row, Row]
    last_lags: tuple[Row, Row]
    share: float


def total(row: Row, values: list[float]) -> float:
    """What the row says of a function with these values at the nodes."""
    m1, m2, m3, m4, m5, m6, m7 = row
    f1, f2, f3, f4, f5, f6, f7 = values
    return m1 * f1 + m2 * f2 + m3 * f3 + m4 * f4 + m5 * f5 + m6 * f6 + m7 * f7


def _row(values: list[float]) -> Row:
    a, b, c, d, e, f, g = values
    return a, b, c, d, e, f, g


def _integrals(nodes: Row, power: int, step: int) -> tuple[Row, ...]:
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
        rows.append(_row(row))
    return tuple(rows)


def _last(nodes: Row, weights: Row, power: int, step: int) -> tuple[Row, Row]:
    """Rows for the last two coefficients over s^power, in polynomials in s^step.

    These are orthogonal on the nodes, and 1 at the end (Stieltjes' procedure).
    """
    masses = [weight * s**power for weight, s in zip(weights, nodes, strict=True)]
    rows: list[Row] = []
    last, values, last_norm = [0.0] * 7, [1.0] * 7, 1.0
    for _ in nodes:
        # Not `sum`, which compensates its rounding from Python 3.12 on: every Python shall give the same bits.
        norm = reduce(operator.add, [mass * value * value for mass, value in zip(masses, values, strict=True)])
        rows.append(_row([w * value * values[-1] / norm for w, value in zip(weights, values, strict=True)]))
        products = [m * s**step * v * v for m, s, v in zip(masses, nodes, values, strict=True)]
        middle = reduce(operator.add, products) / norm
        ratio = norm / last_norm
        following = [(s**step - middle) * v - ratio * w for s, v, w in zip(nodes, values, last, strict=True)]
        last, values, last_norm = values, following, norm
    return rows[-2], rows[-1]


def _rule(inner: tuple[float, ...], force: int, lag: int, step: int, share: float) -> Rule:
    nodes = _row([*inner, 1.0])
    forces = _integrals(nodes, force, step)
    lags = forces if lag == force else _integrals(nodes, lag, step)
    return Rule(nodes, forces, lags, _last(nodes, forces[-1], force, step), _last(nodes, lags[-1], lag, step), share)


STARTING = _rule(
    (
        0.10030907272538186,
        0.2540471043305593,
        0.4441330323002051,
        0.6417698862240983,
        0.8168966635278575,
        0.942844240891898,
    ),
    2,
    2,
    1,
    0.05,
)
RESTING = _rule(
    (
        0.2866931768366051,
        0.4793963839520358,
        0.6486752725863241,
        0.7900276557072898,
        0.8983054071351697,
        0.969308255786329,
    ),
    5,
    4,
    2,
    0.015,
)
