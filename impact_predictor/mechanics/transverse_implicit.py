"""A step along the impulse where slips turn faster than anything else moves: linearly implicit.

The direction of a slip that is about to vanish, or has just begun, follows within an impulse r / m, r being the slip
and m of the size of friction times mobility. The method is ROS3, of order 3 and L-stable: A. Sandu, J. G. Verwer,
J. G. Blom, E. J. Spee, G. R. Carmichael, F. A. Potra, Benchmarking stiff ODE solvers for atmospheric chemistry problems
II, Atmospheric Environment 31 (1997). The rates depend on no more than the directions of two slips, so that its linear
systems are two by two.
"""

from __future__ import annotations

from math import sqrt

from .transverse_states import SLIP, Across, RatesAcross, Slips, rates, way_of

GAMMA = 0.43586652150845900
C21, C31, C32 = -1.0156171083877702, 4.0759956452537700, 9.2076794298330791
M2, M3 = 6.1697947043828246, -0.42772256543218573
E1, E2, E3 = 0.5, -2.9079558716805470, 0.22354069897811570
"""Coefficients of ROS3 (the cited paper's table 2); those left out are 1."""

TURNED = 1e-7
"""rad. How far a slip is turned to see how the rates depend on its direction: half the digits of a double."""

Stage = tuple[float, float, float, float]
"""A stage of a step: its parts of the rates at the beginning, those in the middle, and the derivatives of the former by
the angles of the slips at A and at B."""

NO_CHANGE: RatesAcross = (0.0,) * 12


def implicit_step(
    across: Across, a: int, b: int, way: Slips, y: RatesAcross, rate: RatesAcross, span: float
) -> tuple[RatesAcross, float] | None:
    """The state after a growth of N_B by `span`, and the largest error of a contact velocity in it.

    None where the step is too long: a slip turns away further than it can be followed, or jams.
    """
    ut, uz, wt, wz = way
    turn_a = turn_b = NO_CHANGE
    # A contact that does not slip, or without friction, has no angle that matters.
    ra = rb = 1.0
    if a == SLIP and across[0][6] > 0.0:
        turn_a = derivative(across, a, b, (ut - TURNED * uz, uz + TURNED * ut, wt, wz), rate)
        ra = sqrt(y[7] * y[7] + y[8] * y[8])
    if b == SLIP and across[0][7] > 0.0:
        turn_b = derivative(across, a, b, (ut, uz, wt - TURNED * wz, wz + TURNED * wt), rate)
        rb = sqrt(y[10] * y[10] + y[11] * y[11])
    aa, ba = ut * turn_a[8] - uz * turn_a[7], wt * turn_a[11] - wz * turn_a[10]
    ab, bb = ut * turn_b[8] - uz * turn_b[7], wt * turn_b[11] - wz * turn_b[10]
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

    rate_a, rate_b = ut * rate[8] - uz * rate[7], wt * rate[11] - wz * rate[10]
    middle_a = middle_b = 0.0
    a1, _, c1, d1 = stage(1.0, 0.0, 0.0, 0.0)
    cta, cza, _, ctb, czb = [
        v + a1 * p + c1 * q + d1 * r for v, p, q, r in zip(y[7:], rate[7:], turn_a[7:], turn_b[7:], strict=True)
    ]
    middle = rates(across, a, b, way_of(cta, cza, ctb, czb, way, 0.0))
    if middle is None:
        return None
    middle_a, middle_b = ut * middle[8] - uz * middle[7], wt * middle[11] - wz * middle[10]
    c = C21 / span
    a2, b2, c2, d2 = stage(c * a1, 1.0, c * c1, c * d1)
    c, d = C31 / span, C32 / span
    a3, b3, c3, d3 = stage(c * a1 + d * a2, 1.0 + d * b2, c * c1 + d * c2, c * d1 + d * d2)

    to_rate, to_middle = a1 + M2 * a2 + M3 * a3, M2 * b2 + M3 * b3
    to_a, to_b = c1 + M2 * c2 + M3 * c3, d1 + M2 * d2 + M3 * d3
    changes = list(zip(rate, middle, turn_a, turn_b, strict=True))
    after = tuple(
        [v + to_rate * p + to_middle * q + to_a * r + to_b * s for v, (p, q, r, s) in zip(y, changes, strict=True)]
    )
    to_rate, to_middle = E1 * a1 + E2 * a2 + E3 * a3, E2 * b2 + E3 * b3
    to_a, to_b = E1 * c1 + E2 * c2 + E3 * c3, E1 * d1 + E2 * d2 + E3 * d3
    error = max([abs(to_rate * p + to_middle * q + to_a * r + to_b * s) for p, q, r, s in changes[6:]])
    return after, error  # type: ignore[return-value]


def derivative(across: Across, a: int, b: int, turned: Slips, rate: RatesAcross) -> RatesAcross:
    """Derivative of the rates by the angle of a slip, from those where it is turned a little."""
    there = rates(across, a, b, turned)
    return NO_CHANGE if there is None else tuple([(p - q) / TURNED for p, q in zip(there, rate, strict=True)])  # type: ignore[return-value]
