"""Contact states of a planar body on two contacts, and the rates that they give.

The pair of contacts is six numbers, in units of the body's mass and radius of gyration rho: the angle between the
contacts' normals (`cos`, `sin`) and the moments of their normals and tangents about the mass centre (`qa`, `sa` at
the old contact A, `qb`, `sb` at the new contact B). In the frame of A, with (x, y, rho omega) as twist, the rows of
the contact velocities are nA = (0, 1, qa), tA = (1, 0, sa), nB = (-sin, cos, qb), tB = (cos, sin, sb), and an impulse
along a row changes the twist by that row. Where sums of products would cancel they are written as the cross products
they are (Binet and Cauchy), so that slender and squat bodies keep their digits.

Law code uses + - * / sqrt abs and comparisons only, on numbers and tuples of fixed size: it means the same number on
every machine, and a compiler can take it as it is.
"""

from __future__ import annotations

from math import inf, sqrt

from .types import Flag

OPEN, STICK, PLUS, MINUS = 0, 1, 2, 3
"""States of a contact, in the order in which a law prefers them; PLUS and MINUS slip along +t and -t."""

ROUNDING = 1e-14
"""A condition violated by less than this part of its terms holds: it is a border met up to rounding."""

Pair = tuple[float, float, float, float, float, float, float, float]
"""cos, sin, qa, sa, qb, sb and the frictions fa, fb."""

Problem = tuple[Pair, float, float, float, float, float, float, float, float]
"""What a law is asked: pair; restitutions at A and B; c_nA, c_tA, c_nB, c_tB before the impact, c_nA being inf where
there is no A; the speeds at A and at B below which a velocity is rounding and counts as zero."""

Rates = tuple[bool, float, float, float, float, float, float, float, float, float, float]
"""Whether the states are consistent; N_A, T_A, T_B; rates of c_nA, c_tA, c_nB, c_tB and of the twist (x, y, rho
omega): all per unit N_B."""

Impact = tuple[float, float, float, float, float, float, float, float, float, float, float, int, int, int]
"""What a law answers, for a body of unit mass: N_A, T_A, N_B, T_B; c_nA, c_tA, c_nB, c_tB after the impact; change of
the twist (x, y, rho omega); the contact states along it (a hexadecimal digit 4 a + b each, the last one lowest);
notes; and how many answers the law allows."""

Push = tuple[bool, float, float, float, float]
"""Whether the cones of friction allow a push; N_A, T_A, N_B, T_B with it."""

REVERSED, JAMMED, WORK_LIMITED, SHARED_FRICTION, NO_SOLUTION = (
    int(flag) for flag in (Flag.REVERSED_SLIP, Flag.JAMMED, Flag.WORK_LIMITED, Flag.SHARED_FRICTION, Flag.NO_SOLUTION)
)
"""Notes on an answer, the bits of `Flag`."""

NOT_CONSISTENT: Rates = (False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def below_rounding(value: float, u: float, v: float = 0.0, w: float = 0.0, x: float = 0.0) -> bool:
    """Whether a negative sum of the terms u, v, w, x is more than rounding."""
    return value < -ROUNDING * (abs(u) + abs(v) + abs(w) + abs(x))


def state_alone(qb: float, sb: float, fb: float, ctb: float) -> int:
    """State of B while A is open: friction stops its slip, and keeps it at rest if it can."""
    if ctb != 0.0:
        return PLUS if ctb > 0.0 else MINUS
    drive, hold = qb * sb, fb * (1.0 + sb * sb)
    if drive > hold:
        return PLUS
    return MINUS if drive < -hold else STICK


def open_rates(pair: Pair, b: int, cna: float) -> Rates:
    """Rates while A is open, with B in the state `b` that `state_alone` gives."""
    cos, sin, qa, sa, qb, sb, _, fb = pair
    if b == STICK:
        bq = qb / (1.0 + sb * sb)
        tb = -bq * sb
    else:
        tb = -fb if b == PLUS else fb
        bq = qb + tb * sb
    bx, by = tb * cos - sin, tb * sin + cos
    rna = by + qa * bq
    if rna < 0.0 and cna <= 0.0 and rna < -ROUNDING * (abs(by) + abs(qa * bq)):
        return NOT_CONSISTENT
    rtb = 0.0 if b == STICK else tb + sb * bq
    return True, 0.0, 0.0, tb, rna, bx + sa * bq, 1.0 + qb * bq, rtb, bx, by, bq


def stick_rates(pair: Pair, b: int, ctb: float) -> Rates:
    """Rates while A sticks and B slips. Where friction cannot hold A, the T_A that would do so is still given."""
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    tb = -fb if b == PLUS else fb
    bx, by, bq = tb * cos - sin, tb * sin + cos, qb + tb * sb
    sa2, qa2 = 1.0 + sa * sa, 1.0 + qa * qa
    na = qa * (sa * bx - bq) - by * sa2
    ta = sa * (qa * by - bq) - bx * qa2
    room = fa * na - abs(ta)
    if (na < 0.0 and below_rounding(na, qa * sa * bx, qa * bq, by * sa2)) or (
        room < 0.0 and below_rounding(room, fa * na, sa * qa * by, sa * bq, bx * qa2)
    ):
        return False, na, ta, tb, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    # The twist turns about A: it is a multiple of nA x tA = (sa, qa, -1).
    size = sa2 + qa * qa
    lever, arm = qa * cos - sa * sin - qb, sa * cos + qa * sin - sb
    turn = (lever + tb * arm) / size
    rtb = turn * arm
    if ctb == 0.0 and (rtb < 0.0 if b == PLUS else rtb > 0.0):
        if below_rounding(-abs(rtb), turn * sa * cos, turn * qa * sin, turn * sb):
            return NOT_CONSISTENT
    return True, na / size, ta / size, tb, 0.0, 0.0, turn * lever, rtb, turn * sa, turn * qa, -turn


def slide_rates(pair: Pair, a: int, b: int, cta: float, ctb: float) -> Rates:
    """Rates while both contacts slip."""
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    ax = -fa if a == PLUS else fa
    aq = qa + ax * sa
    tb = -fb if b == PLUS else fb
    bx, by, bq = tb * cos - sin, tb * sin + cos, qb + tb * sb
    den = 1.0 + qa * aq
    lift = by + qa * bq
    if den == 0.0 or (lift * den > 0.0 and below_rounding(-abs(lift), by, qa * bq)):
        return NOT_CONSISTENT
    na = -lift / den
    dx = bx + na * ax
    dq = (bq - by * aq) / den
    dy = -qa * dq
    rta = dx + sa * dq
    if cta == 0.0 and (rta < 0.0 if a == PLUS else rta > 0.0) and below_rounding(-abs(rta), dx, sa * dq):
        return NOT_CONSISTENT
    rtb = cos * dx + (sb - qa * sin) * dq
    if ctb == 0.0 and (rtb < 0.0 if b == PLUS else rtb > 0.0):
        if below_rounding(-abs(rtb), cos * dx, sin * dy, sb * dq):
            return NOT_CONSISTENT
    return True, na, ax * na, tb, 0.0, rta, dq * (qb - qa * cos) - sin * dx, rtb, dx, dy, dq


def slide_stick_rates(pair: Pair, a: int, cta: float) -> Rates:
    """Rates while A slips and B sticks."""
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    ax = -fa if a == PLUS else fa
    aq = qa + ax * sa
    # The twist keeps c_nA and c_tB: it is a multiple of nA x tB = (qx, qy, -cos).
    qx, qy = sb - qa * sin, qa * cos
    ex, ey, eq = sb - aq * sin, aq * cos - ax * sb, ax * sin - cos
    den = qx * ex + qy * ey - cos * eq
    lift_x, lift_y = qx * (cos * sb - sin * qb), qy * (cos * qb + sin * sb)
    lift = lift_x + lift_y + cos
    if den == 0.0 or (lift * den > 0.0 and below_rounding(-abs(lift), lift_x, lift_y, cos)):
        return NOT_CONSISTENT
    na = -lift / den
    tb = -(qb * sb + na * (cos * ax + sin + sb * aq)) / (1.0 + sb * sb)
    if abs(tb) > fb * (1.0 + ROUNDING):
        return NOT_CONSISTENT
    turn = (cos * ey - sin * ex + qb * eq) / den
    dx, dq = turn * qx, -turn * cos
    rta = dx + sa * dq
    if cta == 0.0 and (rta < 0.0 if a == PLUS else rta > 0.0) and below_rounding(-abs(rta), dx, sa * dq):
        return NOT_CONSISTENT
    return True, na, ax * na, tb, 0.0, rta, dq * (qb - qa * cos) - sin * dx, 0.0, dx, -qa * dq, dq


def rolling_rates(pair: Pair) -> Rates:
    """Rates while both contacts stick and B's tangent passes through A, so that the body can turn about A.

    B's friction is then free within an interval, of which the end nearest to zero is taken. Where friction cannot
    hold both, the T_A that would do so is still given.
    """
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    size = 1.0 + sa * sa + qa * qa
    na = (-qa * (sa * sin + qb) - cos * (1.0 + sa * sa)) / size
    ta = (sa * (qa * cos - qb) + sin * (1.0 + qa * qa)) / size
    low, high = push_interval(na, ta, -sin, -cos, fa)
    if low < -fb:
        low = -fb
    if high > fb:
        high = fb
    if low > high and below_rounding(high - low, fb, ta, fa * na):
        return False, na, ta, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    tb = low if low > 0.0 else high if high < 0.0 else 0.0
    lever = qa * cos - sa * sin - qb
    turn = lever / size
    return True, na - tb * sin, ta - tb * cos, tb, 0.0, 0.0, turn * lever, 0.0, turn * sa, turn * qa, -turn


def wedged_rates(pair: Pair) -> Rates:
    """Rates while both contacts stick and lock the body: the impulses push along their line and nothing moves."""
    na, ta, nb, tb = line_of_contacts(pair)
    if nb == 0.0:
        return NOT_CONSISTENT
    na, ta, tb = na / nb, ta / nb, tb / nb
    fa, fb = pair[6], pair[7]
    held = na >= 0.0 and abs(ta) <= fa * na * (1.0 + ROUNDING) and abs(tb) <= fb * (1.0 + ROUNDING)
    return held, na, ta, tb, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


def line_of_contacts(pair: Pair) -> tuple[float, float, float, float]:
    """The impulses N_A, T_A, N_B, T_B of a push along the line from A to B, which do not move the body."""
    cos, sin, qa, sa, qb, sb, _, _ = pair
    x, y = cos * qb + sin * sb - qa, sin * qb - cos * sb + sa
    return y, x, sin * x - cos * y, -cos * x - sin * y


def push_interval(n: float, t: float, zn: float, zt: float, f: float) -> tuple[float, float]:
    """The lowest and the highest push p for which |t + p zt| <= f (n + p zn) and n + p zn >= 0 (inf, -inf if none)."""
    low, high = -inf, inf
    fn, fz = f * n, f * zn
    slope, room = zt - fz, fn - t
    if slope > 0.0:
        high = room / slope
    elif slope < 0.0:
        low = room / slope
    elif below_rounding(room, fn, t):
        return inf, -inf
    slope, room = -zt - fz, fn + t
    if slope > 0.0:
        if slope * high > room:
            high = room / slope
    elif slope < 0.0:
        if slope * low > room:
            low = room / slope
    elif below_rounding(room, fn, t):
        return inf, -inf
    if f == 0.0:  # else n + p zn >= 0 follows from the two above
        if zn > 0.0:
            low = max(low, -n / zn)
        elif zn < 0.0:
            high = min(high, -n / zn)
        elif below_rounding(n, t):
            return inf, -inf
    return low, high


def least_push(pair: Pair, na: float, ta: float, nb: float, tb: float) -> Push:
    """Share the impulses of two sticking contacts with the least push along their line that both cones allow."""
    return push_along(line_of_contacts(pair), pair[6], pair[7], na, ta, nb, tb)


def push_along(
    line: tuple[float, float, float, float], fa: float, fb: float, na: float, ta: float, nb: float, tb: float
) -> Push:
    """Add to the impulses those of a push along `line` that puts them in both cones and leaves least of the push.

    The push is the only freedom; it is measured from the impulses without any component along it.
    """
    zna, zta, znb, ztb = line
    low, high = push_interval(na, ta, zna, zta, fa)
    if low < inf:
        low_b, high_b = push_interval(nb, tb, znb, ztb, fb)
        if low_b > low:
            low = low_b
        if high_b < high:
            high = high_b
    square = zna * zna + zta * zta + znb * znb + ztb * ztb
    if square == 0.0 or (low > high and below_rounding((high - low) * sqrt(square), na, ta, nb, tb)):
        return False, na, ta, nb, tb
    push = -(na * zna + ta * zta + nb * znb + tb * ztb) / square
    if push < low:
        push = low
    elif push > high:
        push = high
    return True, na + push * zna, ta + push * zta, nb + push * znb, tb + push * ztb
