"""Total-impulse law: Coulomb's and Newton's laws on the impulses of the whole impact, at both contacts at once.

0 <= N _|_ (c'_n + e c_n) >= 0 and T in -f N Sgn(c'_t). It needs no order of events, so it also serves where both
contacts are struck at once; it may have several solutions (a wedge), or none (supports that move apart).

Either one contact takes the whole impulse and the other opens, or both hold; each of the two has few possible states.

The solutions are written as cross products of the rows (see `pair`), the change of the twist before the impulses,
because it keeps its digits.
"""

from __future__ import annotations

from math import inf

from .one_answer import one_answer
from .pair import (
    MINUS,
    NO_SOLUTION,
    OPEN,
    PLUS,
    REVERSED,
    ROUNDING,
    SHARED_FRICTION,
    STICK,
    Impact,
    Pair,
    Problem,
    below_rounding,
    least_push,
)

SAME_TWIST = 1e-9
"""Solutions that change the twist by less than this part differently are one solution."""

LINE_ROUNDING = 2e-15
"""The line from A to B, as the moments of the contacts give it, is known up to this part of their sizes."""

Solution = tuple[bool, int, int, float, float, float, float, float, float, float]
"""Whether Coulomb's law holds; states of A and B; N_A, T_A, N_B, T_B; change of the twist (x, y, rho omega)."""

Found = tuple[int, Solution, Solution]
"""How many different solutions are found; the first of them; the one that is asked for."""

NOT_POSSIBLE: Solution = (False, OPEN, OPEN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def one_alone(pair: Pair, gna: float, gnb: float, ctb: float) -> Solution:
    """B takes all of the impulse and A opens.

    B has one answer: along the impulses that stop its approach the slip grows with T_B, so that it sticks, or slips
    against the T_B that would make it stick.
    """
    cos, sin, qa, _, qb, sb, _, fb = pair
    size = 1.0 + qb * qb + sb * sb
    off = qb * ctb - sb * gnb
    # All is multiplied by `size` until B's state and whether A opens are known: a division would delay that.
    nb, tb, dq = sb * off - gnb, -(qb * off + ctb), -(qb * gnb + sb * ctb)
    b = STICK
    if abs(tb) > fb * nb * (1.0 + ROUNDING):
        state = MINUS if tb > 0.0 else PLUS
        ray = -fb if state == PLUS else fb
        bq = qb + ray * sb
        den = 1.0 + qb * bq
        if den > 0.0 and gnb <= 0.0:
            size, b, nb, tb, dq = den, state, -gnb, -ray * gnb, -bq * gnb
        elif gnb >= 0.0:
            return NOT_POSSIBLE
        # Else it sticks, after all: only rounding said that it does not.
    dx, dy, far = cos * tb - sin * nb, cos * nb + sin * tb, gna * size
    gap = far + dy + qa * dq
    if not (gap >= 0.0 or gap >= -ROUNDING * (abs(far) + abs(dy) + abs(qa * dq))):
        return NOT_POSSIBLE
    return True, OPEN, b, 0.0, 0.0, nb / size, tb / size, dx / size, dy / size, dq / size


def both_slide(pair: Pair, a: int, b: int, gna: float, cta: float, gnb: float, ctb: float) -> Solution:
    """Both contacts slip, in the directions of `a` and `b`."""
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    ax = -fa if a == PLUS else fa
    aq = qa + ax * sa
    tb = -fb if b == PLUS else fb
    bx, by, bq = tb * cos - sin, cos + tb * sin, qb + tb * sb
    # plane: the cross product of the two rays of friction, which the change of the twist is normal to
    px, py, pq = bq - aq * by, aq * bx - ax * bq, ax * by - bx
    den = (qb - qa * cos) * px - sin * (qa * py - pq)
    if den == 0.0:
        return NOT_POSSIBLE
    na = gnb * (by + qa * bq)
    nb = -gnb * (1.0 + qa * aq)
    if gna != 0.0:
        na -= gna * (1.0 + qb * bq)
        nb += gna * (cos - sin * ax + qb * aq)
    na, nb = na / den, nb / den
    if na < -ROUNDING * abs(nb) or nb < -ROUNDING * abs(na):
        return NOT_POSSIBLE
    dx, dq = gnb * (pq - py * qa), -gnb * px
    if gna != 0.0:
        dx -= gna * (cos * pq - qb * py)
        dq += gna * (sin * py + cos * px)
    dx, dq = dx / den, dq / den
    dy = -gna - qa * dq
    slip = cta + dx + sa * dq
    if (slip < 0.0) == (a == PLUS) and below_rounding(-abs(slip), cta, dx, sa * dq):
        return NOT_POSSIBLE
    slip = ctb + cos * dx + sin * dy + sb * dq
    if (slip < 0.0) == (b == PLUS) and below_rounding(-abs(slip), ctb, cos * dx, sin * dy, sb * dq):
        return NOT_POSSIBLE
    return True, a, b, na, ax * na, nb, tb * nb, dx, dy, dq


def one_sticks(pair: Pair, gna: float, cta: float, gnb: float, ctb: float) -> Solution:
    """A sticks and B slips: three contact velocities are given, so the twist is, and the impulses follow."""
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    lever = qa * cos - sa * sin - qb
    if lever == 0.0:
        return NOT_POSSIBLE
    dq = (gnb - gna * cos + cta * sin) / lever
    dx, dy = -cta - sa * dq, -gna - qa * dq
    b = PLUS if ctb + cos * dx + sin * dy + sb * dq > 0.0 else MINUS
    tb = -fb if b == PLUS else fb
    bx, by, bq = tb * cos - sin, cos + tb * sin, qb + tb * sb
    push = sa * bx + qa * by - bq
    if push == 0.0:
        return False, STICK, b, 0.0, 0.0, 0.0, 0.0, dx, dy, dq
    nb = (sa * dx + qa * dy - dq) / push
    na = (sa * (by * dx - bx * dy) + dy * bq - by * dq) / -push
    ta = (qa * (bx * dy - by * dx) + dx * bq - bx * dq) / -push
    room = fa * na - abs(ta)
    held = not (
        na < -ROUNDING * abs(nb)
        or nb < -ROUNDING * abs(na)
        or (room < 0.0 and below_rounding(room, fa * na, ta, fa * nb))
    )
    return held, STICK, b, na, ta, nb, tb * nb, dx, dy, dq


def both_stick(pair: Pair, gna: float, cta: float, gnb: float, ctb: float, zero: float) -> Solution:
    """Both contacts stick: four velocities for three freedoms, so the supports must move as one body.

    Along the line of contacts they then move alike. Where they do, the states are given even if friction cannot hold
    the contacts. `zero` is the speed below which the contact velocities are rounding.
    """
    cos, sin, qa, sa, qb, sb, _, _ = pair
    lever, arm = qa * cos - sa * sin - qb, sa * cos + qa * sin - sb
    if lever == 0.0 and arm == 0.0:
        return NOT_POSSIBLE
    # The impulses of a push along the line of contacts are proportional to lever and arm at B.
    gap = ctb * lever - gnb * arm
    if gna != 0.0 or cta != 0.0:
        gap += gna * (sin * qb - cos * sb + sa) + cta * (cos * qb + sin * sb - qa)
    if abs(gap) > zero * (abs(lever) + abs(arm)):
        speeds = abs(gna) + abs(cta) + abs(gnb) + abs(ctb)
        if abs(gap) > LINE_ROUNDING * speeds * (abs(qa) + abs(sa) + abs(qb) + abs(sb)):
            return NOT_POSSIBLE
    normal_leads = abs(lever) >= abs(arm)
    # the row of B that fixes the twist with the two of A (x, y, q), and its velocity
    if normal_leads:
        x, y, q, g = -sin, cos, qb, gnb
    else:
        x, y, q, g, lever = cos, sin, sb, ctb, arm
    dq = (g - gna * y - cta * x) / lever
    dx, dy = -cta - sa * dq, -gna - qa * dq
    along = (sa * dx + qa * dy - dq) / lever
    na = -(sa * (y * dx - x * dy) + dy * q - y * dq) / lever
    ta = -(qa * (x * dy - y * dx) + dx * q - x * dq) / lever
    nb, tb = (along, 0.0) if normal_leads else (0.0, along)
    held, na, ta, nb, tb = least_push(pair, na, ta, nb, tb)
    return held, STICK, STICK, na, ta, nb, tb, dx, dy, dq


def both_hold(
    pair: Pair, gna: float, cta: float, gnb: float, ctb: float, zero: float, found: Found, choice: int
) -> Found:
    """Add the solutions while both contacts hold: A or both stick; B sticks; both slip, in two ways.

    The twist is free along nA x nB. There a slip of A and one of B is zero, and between the two they have the signs
    that they have at each other's zero. Beyond the two, where both slips grow, friction drives the twist back, towards
    the one that it has without friction. So a solution lies on that side only.
    """
    cos, sin, qa, sa, qb, sb, _, _ = pair
    x, y, q = qb - qa * cos, -qa * sin, sin
    grows_a, grows_b = qb - qa * cos + sa * sin, qb * cos + sb * sin - qa
    solution = both_stick(pair, gna, cta, gnb, ctb, zero)
    several = found[0] > 0
    if solution[0]:
        found = add(found, solution, choice)
        if not several and one_answer(pair, cta, ctb):
            return found
    a = b = PLUS
    if solution[1] == STICK:
        least = most = x * solution[7] + y * solution[8] + q * solution[9]
    else:
        least, most = inf, -inf
        if grows_a != 0.0:
            solution = one_sticks(pair, gna, cta, gnb, ctb)
            if solution[0]:
                found = add(found, solution, choice)
                if not several and one_answer(pair, cta, ctb):
                    return found
            b = solution[2]
            least = most = x * solution[7] + y * solution[8] + q * solution[9]
        if grows_b != 0.0:
            solution = exchange(pair, one_sticks(exchanged(pair), gnb, ctb, gna, cta))
            if solution[0]:
                found = add(found, solution, choice)
                if not several and one_answer(pair, cta, ctb):
                    return found
            a = solution[1]
            along = x * solution[7] + y * solution[8] + q * solution[9]
            least, most = min(least, along), max(most, along)
            if grows_a != 0.0:
                found = add(found, both_slide(pair, a, b, gna, cta, gnb, ctb), choice)
        if least <= 0.0 < most:
            return found
    if grows_a != 0.0:
        a = PLUS if (grows_a > 0.0) == (most <= 0.0) else MINUS
    if grows_b != 0.0:
        b = PLUS if (grows_b > 0.0) == (most <= 0.0) else MINUS
    if grows_a == 0.0 or grows_b == 0.0:  # one of the slips is the same in all of these twists
        other_a, other_b = (PLUS + MINUS - a, b) if grows_a == 0.0 else (a, PLUS + MINUS - b)
        found = add(found, both_slide(pair, other_a, other_b, gna, cta, gnb, ctb), choice)
    return add(found, both_slide(pair, a, b, gna, cta, gnb, ctb), choice)


def any_that_holds(pair: Pair, gna: float, cta: float, gnb: float, ctb: float, found: Found, choice: int) -> Found:
    """Add what holds where none of the states that seemed possible does.

    A contact leaves, but friction can hold it; or a border is met up to rounding.
    """
    found = add(found, one_alone(pair, gna, gnb, ctb), choice)
    found = add(found, exchange(pair, one_alone(exchanged(pair), gnb, gna, cta)), choice)
    for a in (PLUS, MINUS):
        for b in (PLUS, MINUS):
            found = add(found, both_slide(pair, a, b, gna, cta, gnb, ctb), choice)
    return found


def exchanged(pair: Pair) -> Pair:
    """The pair with its contacts in the other order, in the frame of B."""
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    return cos, -sin, qb, sb, qa, sa, fb, fa


def exchange(pair: Pair, solution: Solution) -> Solution:
    """A solution for the exchanged pair, brought back."""
    cos, sin, _, _, _, _, _, _ = pair
    held, b, a, nb, tb, na, ta, dx, dy, dq = solution
    return held, a, b, na, ta, nb, tb, cos * dx - sin * dy, sin * dx + cos * dy, dq


def add(found: Found, other: Solution, choice: int) -> Found:
    """Count a solution that holds if it differs from the first one, and keep the one of number `choice`."""
    count, first, chosen = found
    if not other[0] or (count and same(first, other)):
        return found
    return count + 1, first if count else other, other if count <= choice else chosen


def same(one: Solution, other: Solution) -> bool:
    """Whether two solutions change the twist in the same way, up to rounding."""
    scale = abs(one[7]) + abs(one[8]) + abs(one[9]) + abs(other[7]) + abs(other[8]) + abs(other[9])
    return abs(one[7] - other[7]) + abs(one[8] - other[8]) + abs(one[9] - other[9]) <= SAME_TWIST * scale


def solve(problem: Problem, choice: int) -> Impact:
    """Solve for the impulses of the whole impact; c_nA is inf where there is no A.

    The restitutions are Newton's. The first solution of these answers: A opens, B opens, both stick, one sticks, both
    slip; `choice` k > 0 takes the k-th that differs from it.
    """
    pair, restitution_old, restitution, cna, cta, cnb, ctb, zero_a, zero_b = problem
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    gna = (1.0 + restitution_old) * cna if cna < 0.0 else cna
    gnb = (1.0 + restitution) * cnb if cnb < 0.0 else cnb
    solution = one_alone(pair, gna, gnb, ctb) if gnb < 0.0 else NOT_POSSIBLE
    found = (1 if solution[0] else 0), solution, solution
    if cna < inf and not (solution[0] and one_answer(pair, cta, ctb)):
        # Where its own friction presses it down, A takes the impulse even if it is not struck.
        if gna < 0.0 or (gna == 0.0 and cta != 0.0 and fa * abs(qa * sa) > 1.0 + qa * qa):
            found = add(found, exchange(pair, one_alone(exchanged(pair), gnb, gna, cta)), choice)
        found = both_hold(pair, gna, cta, gnb, ctb, zero_a + zero_b, found, choice)
        if not found[0]:
            found = any_that_holds(pair, gna, cta, gnb, ctb, found, choice)

    count, _, (_, a, b, na, ta, nb, tb, dx, dy, dq) = found
    vna = cna + dy + qa * dq if a == OPEN else cna - gna
    vta = 0.0 if a == STICK else cta + dx + sa * dq
    vnb = cnb - sin * dx + cos * dy + qb * dq if b == OPEN else cnb - gnb
    vtb = 0.0 if b == STICK else ctb + cos * dx + sin * dy + sb * dq
    notes = 0 if count else NO_SOLUTION
    if (vta * cta < 0.0 and abs(vta) > zero_a) or (vtb * ctb < 0.0 and abs(vtb) > zero_b):
        notes |= REVERSED
    if a == STICK and b == STICK:
        notes |= SHARED_FRICTION
    return na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, 4 * a + b, notes, count
