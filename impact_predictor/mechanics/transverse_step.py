"""One step along the impulse while slips turn: linearly implicit, with an error that is kept below a bound.

A slip that is about to vanish, or has just begun, turns faster than anything else moves: its direction follows within
an impulse r / m, r being the slip and m of the size of friction times mobility. Hence an implicit method, ROS3 of order
3 and L-stable: A. Sandu, J. G. Verwer, J. G. Blom, E. J. Spee, G. R. Carmichael, F. A. Potra, Benchmarking stiff ODE
solvers for atmospheric chemistry problems II, Atmospheric Environment 31 (1997). The rates depend on no more than the
directions of two slips, so that its linear systems are two by two.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from .transverse_states import SLIP, TURNED, Across, Rates, Way, rates, turned, way_of

GAMMA = 0.43586652150845900
C21, C31, C32 = -1.0156171083877702, 4.0759956452537700, 9.2076794298330791
M2, M3 = 6.1697947043828246, -0.42772256543218573
E1, E2, E3 = 0.5, -2.9079558716805470, 0.22354069897811570
"""Coefficients of ROS3 (the cited paper's table 2); those left out are 1."""

STRAIGHT = 0.9
"""Cosine of the largest angle by which a slip may turn in one step."""

ATTEMPTS = 40
"""How often a step is shortened before the path counts as lost: by a factor of four at least each time."""

State = Rates
"""N_A, T_A, Z_A, T_B, Z_B so far, and c_nA, c_tA, c_zA, c_nB, c_tB, c_zB."""

Stage = tuple[float, float, float, float]
"""A stage of a step: its parts of the rates at the beginning, those in the middle, and the derivatives of the former by
the angles of the slips at A and at B."""

NO_CHANGE: Rates = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Arc(NamedTuple):
    """A stretch of the path: the states at its ends, the rates there, and how far N_B grows."""

    begin: State
    end: State
    rate: Rates
    last: Rates
    span: float

    def at(self, part: float) -> State:
        """The state at a part (0..1) of the stretch, by the cubic through both ends."""
        to_end, to_rate, to_last = (
            part * part * (3.0 - 2.0 * part),
            part * (1.0 - part) ** 2,
            part * part * (part - 1.0),
        )
        p, q = self.span * to_rate, self.span * to_last
        return tuple([y + to_end * (z - y) + p * u + q * v for y, z, u, v in zip(*self[:4], strict=True)])  # type: ignore[return-value]

    def velocity(self, index: int, part: float) -> float:
        """A component of `at`."""
        y, z = self.begin[index], self.end[index]
        slopes = (1.0 - part) * self.rate[index] - part * self.last[index]
        return y + part * part * (3.0 - 2.0 * part) * (z - y) + self.span * part * (1.0 - part) * slopes

    def pressed(self, part: float) -> float:
        """Work of the normal impulse at B on the body, over a part of the stretch."""
        y, square = self.begin[8], part * part
        bend = self.rate[8] * (0.5 - part * (2.0 / 3.0 - 0.25 * part)) - self.last[8] * part * (1.0 / 3.0 - 0.25 * part)
        rise = (self.end[8] - y) * part * (1.0 - 0.5 * part)
        return self.span * (y * part + square * (rise + self.span * bend))


def straight_arc(y: State, rate: Rates, span: float) -> Arc:
    """A stretch in which the rates do not change."""
    return Arc(y, tuple([p + span * q for p, q in zip(y, rate, strict=True)]), rate, rate, span)  # type: ignore[arg-type]


def advance(
    across: Across, a: int, b: int, way: Way, y: State, rate: Rates, span: float, small: float
) -> tuple[Arc, Way, float] | None:
    """A step of at most `span` with an error below `small` in every contact velocity; None where none is found.

    A and B are in the states `a` and `b`; `rate` are the rates at y, where the slips go along `way`. Returns also the
    directions of the slips at the end, and how long the next step may be.
    """
    turn_a = derivative(across, a, b, way, rate, 0) if a == SLIP and across[0][6] > 0.0 else NO_CHANGE
    turn_b = derivative(across, a, b, way, rate, 1) if b == SLIP and across[0][7] > 0.0 else NO_CHANGE
    for _ in range(ATTEMPTS):
        if not span > 0.0:
            break
        tried = implicit_step(across, a, b, way, y, rate, turn_a, turn_b, span)
        if tried is None:
            span *= 0.25
            continue
        after, error = tried
        factor = 0.8 * sqrt(sqrt(small / error)) if error > 0.0 else 4.0
        if error <= small:
            there = way_of(after[5:], way, small)
            last = rates(across, a, b, there)
            if last is not None and turns_little(a, b, way, there):
                return Arc(y, after, rate, last, span), there, span * min(max(factor, 0.5), 4.0)
            factor = 0.3
        span *= min(max(factor, 0.1), 0.5)
    return None


def turns_little(a: int, b: int, way: Way, there: Way) -> bool:
    """Whether a step turns the slips little enough for a cubic through its ends."""
    ut, uz, wt, wz = way
    return (a != SLIP or ut * there[0] + uz * there[1] >= STRAIGHT) and (
        b != SLIP or wt * there[2] + wz * there[3] >= STRAIGHT
    )


def derivative(across: Across, a: int, b: int, way: Way, rate: Rates, contact: int) -> Rates:
    """Derivative of the rates by the angle of the slip at A (0) or at B (1)."""
    there = rates(across, a, b, turned(way, contact))
    return NO_CHANGE if there is None else tuple([(p - q) / TURNED for p, q in zip(there, rate, strict=True)])  # type: ignore[return-value]


def implicit_step(
    across: Across, a: int, b: int, way: Way, y: State, rate: Rates, turn_a: Rates, turn_b: Rates, span: float
) -> tuple[State, float] | None:
    """The state after a step of ROS3, and the largest error of a contact velocity in it.

    None where the step is too long: a slip turns away further than it can be followed, or jams.
    """
    ut, uz, wt, wz = way
    aa, ba = ut * turn_a[7] - uz * turn_a[6], wt * turn_a[10] - wz * turn_a[9]
    ab, bb = ut * turn_b[7] - uz * turn_b[6], wt * turn_b[10] - wz * turn_b[9]
    # A contact that does not slip, or without friction, has no angle that matters.
    ra = 1.0 if turn_a is NO_CHANGE else sqrt(y[6] * y[6] + y[7] * y[7])
    rb = 1.0 if turn_b is NO_CHANGE else sqrt(y[9] * y[9] + y[10] * y[10])
    h = GAMMA * span
    left_a, left_b = ra - h * aa, rb - h * bb
    det = left_a * left_b - h * h * ab * ba
    if not (left_a >= 0.5 * ra and left_b >= 0.5 * rb and det > 0.0):
        return None

    def stage(rated: float, middled: float, turned_a: float, turned_b: float) -> Stage:
        """The stage of a force that is these parts of rate, middle, turn_a and turn_b, as such parts itself."""
        # Forces across the slips turn them.
        fa = h * (rated * rate_a + middled * middle_a + turned_a * aa + turned_b * ab)
        fb = h * (rated * rate_b + middled * middle_b + turned_a * ba + turned_b * bb)
        ya, yb = (left_b * fa + h * ab * fb) / det, (left_a * fb + h * ba * fa) / det
        return h * rated, h * middled, h * (turned_a + ya), h * (turned_b + yb)

    rate_a, rate_b = ut * rate[7] - uz * rate[6], wt * rate[10] - wz * rate[9]
    middle_a = middle_b = 0.0
    a1, _, c1, d1 = stage(1.0, 0.0, 0.0, 0.0)
    moved = [v + a1 * p + c1 * q + d1 * r for v, p, q, r in zip(y[5:], rate[5:], turn_a[5:], turn_b[5:], strict=True)]
    middle = rates(across, a, b, way_of(tuple(moved), way, 0.0))
    if middle is None:
        return None
    middle_a, middle_b = ut * middle[7] - uz * middle[6], wt * middle[10] - wz * middle[9]
    c = C21 / span
    a2, b2, c2, d2 = stage(c * a1, 1.0, c * c1, c * d1)
    c, d = C31 / span, C32 / span
    a3, b3, c3, d3 = stage(c * a1 + d * a2, 1.0 + d * b2, c * c1 + d * c2, c * d1 + d * d2)

    to_rate, to_middle = a1 + M2 * a2 + M3 * a3, M2 * b2 + M3 * b3
    to_a, to_b = c1 + M2 * c2 + M3 * c3, d1 + M2 * d2 + M3 * d3
    after = tuple(
        [
            v + to_rate * p + to_middle * q + to_a * r + to_b * s
            for v, p, q, r, s in zip(y, rate, middle, turn_a, turn_b, strict=True)
        ]
    )
    to_rate, to_middle = E1 * a1 + E2 * a2 + E3 * a3, E2 * b2 + E3 * b3
    to_a, to_b = E1 * c1 + E2 * c2 + E3 * c3, E1 * d1 + E2 * d2 + E3 * d3
    error = 0.0
    for p, q, r, s in zip(rate[5:], middle[5:], turn_a[5:], turn_b[5:], strict=True):
        size = abs(to_rate * p + to_middle * q + to_a * r + to_b * s)
        if size > error:
            error = size
    return after, error  # type: ignore[return-value]
