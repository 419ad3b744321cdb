"""Total-impulse law: Coulomb's and Newton's laws on the impulses of the whole impact, at both contacts at once.

0 <= N _|_ (c'_n + e c_n) >= 0 and T in -f N Sgn(c'_t). It needs no order of events, so it also serves where both
contacts are struck at once; it may have several solutions (a wedge), or none (supports that move apart).

Either one contact takes the whole impulse and the other opens, or both hold; each of the two has few possible states.
The change of the twist is computed before the impulses, because it keeps its digits. Law code (see `contacts`).
"""

from __future__ import annotations

from math import inf
from typing import Final

from .contacts import (
    MINUS,
    NO_SOLUTION,
    OPEN,
    PLUS,
    REVERSED,
    ROUNDING,
    SHARED_FRICTION,
    STICK,
    ContactRows,
    Impact,
    Problem,
    Velocities,
    below_rounding,
    least_push,
    planar_contacts,
)
from .restitution import newton

SAME_TWIST: Final = 1e-9
"""Solutions that change the twist by less than this part differently are one solution."""

LINE_ROUNDING: Final = 2e-15
"""The line from A to B, as the moments of the contacts give it, is known up to this part of their sizes."""

RowTriple = tuple[float, float, float]
"""A row, or the products nn, nt and tt of those of a contact."""

Solution = tuple[bool, int, int, float, float, float, float, float, float, float]
"""Whether Coulomb's law holds; states of A and B; N_A, T_A, N_B, T_B; change of the twist (x, y, rho omega)."""

Solutions = tuple[int, Solution, Solution]
"""How many different solutions are found; the first of them; the one that is asked for."""

NOT_POSSIBLE: Solution = (False, OPEN, OPEN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def new_alone(contacts: ContactRows, gna: float, gnb: float, ctb: float) -> Solution:
    """B takes all of the impulse and A opens."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), (bnn, bnt, btt, size), minors, rounding = contacts
    block, size = (bnn + extra, bnt, btt), size + extra * (btt + tq * tq)
    held, b, nb, tb, dx, dy, dq = one_alone((nx, ny, nq), (tx, ty, tq), block, size, fb, gnb, ctb, rounding)
    u, v = an * dy, qa * dq
    gap = gna + u + v
    if not held or not (gap >= 0.0 or gap >= -rounding * (abs(gna) + abs(u) + abs(v))):
        return NOT_POSSIBLE
    return True, OPEN, b, 0.0, 0.0, nb, tb, dx, dy, dq


def old_alone(contacts: ContactRows, gna: float, cta: float, gnb: float) -> Solution:
    """A takes all of the impulse and B opens."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    size = (an * at) * (an * at) + (an * sa) * (an * sa) + (at * qa) * (at * qa)
    block = an * an, 0.0, at * at
    held, a, na, ta, dx, dy, dq = one_alone((0.0, an, qa), (at, 0.0, sa), block, size, fa, gna, cta, rounding)
    u, v, w = nx * dx, ny * dy, nq * dq
    gap = gnb + u + v + w
    if not held or not (gap >= 0.0 or gap >= -rounding * (abs(gnb) + abs(u) + abs(v) + abs(w))):
        return NOT_POSSIBLE
    return True, a, OPEN, na, ta, 0.0, 0.0, dx, dy, dq


def one_alone(
    normal: RowTriple,
    tangent: RowTriple,
    block: RowTriple,
    size: float,
    friction: float,
    gn: float,
    ct: float,
    rounding: float,
) -> tuple[bool, int, float, float, float, float, float]:
    """Whether a contact can take an impulse alone, its state, N, T and the change of the twist.

    It has one answer: along the impulses that stop its approach the slip grows with T, so that it sticks, or slips
    against the T that would make it stick. `block` are the products of its rows without q, and `size` is the
    determinant of its block of W.
    """
    (nx, ny, nq), (tx, ty, tq), (nn, nt, tt) = normal, tangent, block
    off = nq * ct - tq * gn
    n, t = tq * off - tt * gn + nt * ct, nt * gn - nn * ct - nq * off
    q = -(nq * tt - tq * nt) * gn - (tq * nn - nq * nt) * ct
    state = STICK
    if not size > 0.0:
        # Its slip changes with its approach alone, so that it sticks only where the two end together.
        nn, nt = nn + nq * nq, nt + nq * tq
        if not nn > 0.0 or gn > 0.0:
            return False, state, 0.0, 0.0, 0.0, 0.0, 0.0
        slip, ray = ct - nt / nn * gn, 0.0
        if abs(slip) > rounding * (abs(ct) + abs(nt / nn * gn)):
            state, ray = (PLUS, -friction) if slip > 0.0 else (MINUS, friction)
        size, n, t, q = nn + ray * nt, -gn, -ray * gn, -(nq + ray * tq) * gn
        if not size > 0.0:
            return False, state, 0.0, 0.0, 0.0, 0.0, 0.0
    elif abs(t) > friction * n * (1.0 + rounding):
        state = MINUS if t > 0.0 else PLUS
        ray = -friction if state == PLUS else friction
        den = nn + ray * nt + nq * (nq + ray * tq)
        if den > 0.0 and gn <= 0.0:
            size, n, t, q = den, -gn, -ray * gn, -(nq + ray * tq) * gn
        elif gn >= 0.0:
            return False, state, 0.0, 0.0, 0.0, 0.0, 0.0
        else:
            state = STICK  # after all: only rounding said that it does not
    return True, state, n / size, t / size, (nx * n + tx * t) / size, (ny * n + ty * t) / size, q / size


def both_slide(contacts: ContactRows, a: int, b: int, gna: float, cta: float, gnb: float, ctb: float) -> Solution:
    """Both contacts slip, in the directions of `a` and `b`."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    ax = -fa if a == PLUS else fa
    aq = qa + ax * sa
    tb = -fb if b == PLUS else fb
    bx, by, bq = nx + tb * tx, ny + tb * ty, nq + tb * tq
    # plane: the cross product of the two rays of friction, which the change of the twist is normal to
    px, py, pq = an * bq - aq * by, aq * bx - ax * at * bq, ax * at * by - an * bx
    old_ray = an * an + qa * aq
    u, v, w = (an * nq - qa * ny) * px, nx * (qa * py - an * pq), extra * old_ray
    den = u + v + w
    if abs(den) <= (rounding - ROUNDING) * (abs(u) + abs(v) + abs(w)):
        return NOT_POSSIBLE
    na, nb = gnb * (an * by + qa * bq), -gnb * old_ray
    if gna != 0.0:
        na -= gna * (nx * bx + ny * by + nq * bq + extra)
        nb += gna * (ny * an + nx * ax * at + nq * aq)
    na, nb = na / den, nb / den
    if na < -rounding * abs(nb) or nb < -rounding * abs(na):
        return NOT_POSSIBLE
    dx, dq = gnb * (an * pq - py * qa), -gnb * an * px
    if gna != 0.0:
        dx -= gna * (ny * pq - nq * py + extra * ax * at)
        dq -= gna * (nx * py - ny * px + extra * aq)
    dx, dq = dx / den, dq / den
    dy = (-gna - qa * dq) / an if an > 0.0 else by * nb
    slip_a, slip_b = cta + at * dx + sa * dq, ctb + tx * dx + ty * dy + tq * dq
    begins_a = below_rounding(-abs(slip_a), rounding, cta, at * dx, sa * dq)
    begins_b = below_rounding(-abs(slip_b), rounding, ctb, tx * dx, ty * dy, tq * dq)
    if (begins_a and (slip_a < 0.0) == (a == PLUS)) or (begins_b and (slip_b < 0.0) == (b == PLUS)):
        return NOT_POSSIBLE
    if rounding != ROUNDING:
        a, b = a if begins_a else STICK, b if begins_b else STICK
    return True, a, b, na, ax * na, nb, tb * nb, dx, dy, dq


def old_sticks(contacts: ContactRows, gna: float, cta: float, gnb: float, ctb: float) -> Solution:
    """A sticks and B slips: three contact velocities are given, so the twist is, and the impulses follow."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    if lever == 0.0:
        return NOT_POSSIBLE
    dq = (gnb - gna * ny - cta * nx) / lever
    dx, dy = -cta - sa * dq, -gna - qa * dq
    b = PLUS if ctb + tx * dx + ty * dy + tq * dq > 0.0 else MINUS
    tb = -fb if b == PLUS else fb
    bx, by, bq = nx + tb * tx, ny + tb * ty, nq + tb * tq
    push = lever + tb * arm
    if push == 0.0:
        return False, STICK, b, 0.0, 0.0, 0.0, 0.0, dx, dy, dq
    nb = (sa * dx + qa * dy - dq) / push
    na = (sa * (by * dx - bx * dy) + dy * bq - by * dq) / -push
    ta = (qa * (bx * dy - by * dx) + dx * bq - bx * dq) / -push
    room = fa * na - abs(ta)
    held = not (
        na < -ROUNDING * abs(nb)
        or nb < -ROUNDING * abs(na)
        or (room < 0.0 and below_rounding(room, ROUNDING, fa * na, ta, fa * nb))
    )
    return held, STICK, b, na, ta, nb, tb * nb, dx, dy, dq


def new_sticks(contacts: ContactRows, gna: float, cta: float, gnb: float, ctb: float) -> Solution:
    """B sticks and A slips, of a planar body: as `old_sticks`, of the pair in the other order and in the frame of B."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    other = planar_contacts(ny, nx, nq, tq, qa, sa, fb, fa)
    held, b, a, nb, tb, na, ta, dx, dy, dq = old_sticks(other, gnb, ctb, gna, cta)
    return held, a, b, na, ta, nb, tb, tx * dx + nx * dy, tx * dy - nx * dx, dq


def both_stick(contacts: ContactRows, gna: float, cta: float, gnb: float, ctb: float, zero: float) -> Solution:
    """Both contacts stick: four velocities for three freedoms, so the supports must move as one body.

    Along the line of contacts they then move alike. Where they do, the states are given even if friction cannot hold
    the contacts. `zero` is the speed below which the contact velocities are rounding. With four freedoms there is one
    answer whatever the supports do.
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    lever, arm, old_lever, old_arm = minors
    if lever == 0.0 and arm == 0.0:
        return NOT_POSSIBLE
    along = 0.0
    if extra == 0.0:
        # The impulses of a push along the line of contacts are proportional to lever and arm at B.
        gap = ctb * lever - gnb * arm
        if gna != 0.0 or cta != 0.0:
            gap += cta * old_lever - gna * old_arm
        if abs(gap) > zero * (abs(lever) + abs(arm)):
            sizes = abs(qa) + abs(sa) + abs(nq) + abs(tq)
            if rounding != ROUNDING:
                sizes = (an + abs(qa)) * (at + abs(sa)) * (sizes + abs(nx) + abs(ny) + abs(tx) + abs(ty))
            if abs(gap) > LINE_ROUNDING * sizes * (abs(gna) + abs(cta) + abs(gnb) + abs(ctb)):
                return NOT_POSSIBLE
    normal_leads = extra == 0.0 and abs(lever) >= abs(arm)
    # the row of B that fixes the twist with the two of A (x, y, q), and its velocity
    if normal_leads:
        x, y, q, g = nx, ny, nq, gnb
    else:
        x, y, q, g, lever = tx, ty, tq, ctb, arm
    k = an * at
    dq = (g * k - gna * at * y - cta * an * x) / lever
    dx, dy = (-cta - sa * dq) / at, (-gna - qa * dq) / an
    ex, ey, eq = dx, dy, dq
    if extra > 0.0:
        along = -(gnb + nx * dx + ny * dy + nq * dq) / extra
        ex, ey, eq = dx - along * nx, dy - along * ny, dq - along * nq
    push = (an * sa * ex + at * qa * ey - k * eq) / lever
    na = (at * (y * eq - q * ey) - sa * (y * ex - x * ey)) / lever
    ta = (an * (x * eq - q * ex) - qa * (x * ey - y * ex)) / lever
    nb, tb = (push, 0.0) if normal_leads else (along, push)
    if extra > 0.0:
        near = rounding * (abs(na) + abs(nb))
        held = na >= -near and nb >= -near and abs(ta) <= fa * na + near and abs(tb) <= fb * nb + near
    else:
        held, na, ta, nb, tb = least_push(contacts, na, ta, nb, tb)
    return held, STICK, STICK, na, ta, nb, tb, dx, dy, dq


def one_sticks(contacts: ContactRows, new_slips: bool, state: int, c: Velocities) -> Solution:
    """One contact sticks and the other slips as `state` says, from W itself: what the former does to hold is taken out
    of the mobility of the latter. `c` are g_nA, c_tA, g_nB, c_tB.
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), (bnn, bnt, btt, new_size), minors, rounding = contacts
    gna, cta, gnb, ctb = c
    ann, ant, att = an * an + qa * qa, qa * sa, at * at + sa * sa
    bnn, bnt, btt = bnn + nq * nq + extra, bnt + nq * tq, btt + tq * tq
    xnn, xnt, xtn, xtt = an * ny + qa * nq, an * ty + qa * tq, at * nx + sa * nq, at * tx + sa * tq
    friction, other_friction = fa, fb
    if not new_slips:
        gna, cta, gnb, ctb = gnb, ctb, gna, cta
        ann, ant, att, bnn, bnt, btt, xnt, xtn = bnn, bnt, btt, ann, ant, att, xtn, xnt
        friction, other_friction = fb, fa
    if not ann > 0.0 or att - ant / ann * ant <= rounding * att:
        return NOT_POSSIBLE
    part, part_n, part_t = ant / ann, xnn / ann, xnt / ann
    rest, rest_n, rest_t, slip = att - part * ant, xtn - part * xnn, xtt - part * xnt, cta - part * gna
    nn, nt, tt = bnn - part_n * xnn, bnt - part_n * xnt, btt - part_t * xnt
    gn, ct = gnb - part_n * gna, ctb - part_t * gna
    part_n, part_t = rest_n / rest, rest_t / rest
    nn, nt, tt = nn - part_n * rest_n, nt - part_n * rest_t, tt - part_t * rest_t
    gn, ct = gn - part_n * slip, ct - part_t * slip
    ray = -other_friction if state == PLUS else other_friction
    size = nn + ray * nt
    if abs(size) <= rounding * (bnn + abs(ray * bnt)):
        return NOT_POSSIBLE
    nb = -gn / size
    tb = ray * nb
    after = ct + nt * nb + tt * tb
    ta = -(slip + rest_n * nb + rest_t * tb) / rest
    na = -(gna + ant * ta + xnn * nb + xnt * tb) / ann
    if abs(after) <= rounding * (abs(ctb) + abs(xnt * na) + abs(xtt * ta) + abs(bnt * nb) + abs(btt * tb)):
        other = STICK
    elif (after > 0.0) == (state == PLUS):
        other = state
    else:
        return NOT_POSSIBLE
    if nb < 0.0 or na < 0.0 or abs(ta) > friction * na * (1.0 + rounding):
        return NOT_POSSIBLE
    a, b = STICK, other
    if not new_slips:
        a, b, na, ta, nb, tb = other, STICK, nb, tb, na, ta
    dx, dy, dq = at * ta + nx * nb + tx * tb, an * na + ny * nb + ty * tb, qa * na + sa * ta + nq * nb + tq * tb
    return True, a, b, na, ta, nb, tb, dx, dy, dq


def all_that_hold(contacts: ContactRows, c: Velocities, zero: float, found: Solutions, choice: int) -> Solutions:
    """Add the solutions while both contacts hold, by trial of all states: of any W."""
    gna, cta, gnb, ctb = c
    solution = both_stick(contacts, gna, cta, gnb, ctb, zero)
    stick, a, b, na, ta, nb, tb, dx, dy, dq = solution
    found = add(found, solution, choice)
    for number in range(8):
        state, other = PLUS + number % 2, PLUS + number // 2 % 2
        if number < 4:
            solution = one_sticks(contacts, number < 2, state, c)
        else:
            solution = both_slide(contacts, other, state, gna, cta, gnb, ctb)
        held, a, b, na, ta, nb, tb, dx, dy, dq = solution
        if not (stick and a == STICK and b == STICK):  # that is `both_stick`, at the border of a cone
            found = add(found, solution, choice)
    return found


def both_hold(contacts: ContactRows, c: Velocities, zero: float, found: Solutions, choice: int) -> Solutions:
    """Add the solutions while both contacts of a planar body hold: A or both stick; B sticks; both slip, in two ways.

    The twist is free along nA x nB. There a slip of A and one of B is zero, and between the two they have the signs
    that they have at each other's zero. Beyond the two, where both slips grow, friction drives the twist back, towards
    the one that it has without friction. So a solution lies on that side only.
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    gna, cta, gnb, ctb = c
    x, y, q = nq - qa * ny, qa * nx, -nx
    several, first, chosen = found
    solution = both_stick(contacts, gna, cta, gnb, ctb, zero)
    held, state, new_state, na, ta, nb, tb, dx, dy, dq = solution
    if held:
        found = add(found, solution, choice)
        if not several and one_answer(contacts, cta, ctb):
            return found
    a = b = PLUS
    if state == STICK:
        least = most = x * dx + y * dy + q * dq
    else:
        least, most = inf, -inf
        if lever != 0.0:
            solution = old_sticks(contacts, gna, cta, gnb, ctb)
            held, old_state, b, na, ta, nb, tb, dx, dy, dq = solution
            if held:
                found = add(found, solution, choice)
                if not several and one_answer(contacts, cta, ctb):
                    return found
            least = most = x * dx + y * dy + q * dq
        if old_lever != 0.0:
            solution = new_sticks(contacts, gna, cta, gnb, ctb)
            held, a, new_state, na, ta, nb, tb, dx, dy, dq = solution
            if held:
                found = add(found, solution, choice)
                if not several and one_answer(contacts, cta, ctb):
                    return found
            along = x * dx + y * dy + q * dq
            least, most = min(least, along), max(most, along)
            if lever != 0.0:
                found = add(found, both_slide(contacts, a, b, gna, cta, gnb, ctb), choice)
        if least <= 0.0 < most:
            return found
    if lever == 0.0 and old_lever == 0.0:
        found = add(found, both_slide(contacts, PLUS, MINUS, gna, cta, gnb, ctb), choice)
        found = add(found, both_slide(contacts, MINUS, MINUS, gna, cta, gnb, ctb), choice)
    if lever != 0.0:
        a = PLUS if (lever < 0.0) == (most <= 0.0) else MINUS
    if old_lever != 0.0:
        b = PLUS if (old_lever > 0.0) == (most <= 0.0) else MINUS
    if lever == 0.0 or old_lever == 0.0:  # one of the slips is the same in all of these twists
        other_a, other_b = (PLUS + MINUS - a, b) if lever == 0.0 else (a, PLUS + MINUS - b)
        found = add(found, both_slide(contacts, other_a, other_b, gna, cta, gnb, ctb), choice)
    return add(found, both_slide(contacts, a, b, gna, cta, gnb, ctb), choice)


def any_that_holds(contacts: ContactRows, c: Velocities, found: Solutions, choice: int) -> Solutions:
    """Add what holds where none of the states that seemed possible does.

    A contact leaves, but friction can hold it; or a border is met up to rounding.
    """
    gna, cta, gnb, ctb = c
    found = add(found, new_alone(contacts, gna, gnb, ctb), choice)
    found = add(found, old_alone(contacts, gna, cta, gnb), choice)
    for a in (PLUS, MINUS):
        for b in (PLUS, MINUS):
            found = add(found, both_slide(contacts, a, b, gna, cta, gnb, ctb), choice)
    return found


def one_answer(contacts: ContactRows, cta: float, ctb: float) -> bool:
    """Whether the total law has one answer for all impacts of a planar body, as far as determinants tell.

    The law is a map: from the impulses of the contacts that hold and the velocities of those that open or slip, to the
    contact velocities before the impact. It is linear while the contact states stay, one piece for each pair of states.
    If the determinants of all pieces are positive, every velocity before the impact is met equally often; and one at
    which nothing touches is met once, because impulses would only cost energy there. So the law then has one answer.

    The determinants are linear in each friction, which enters with both signs. The slips c_tA and c_tB before the
    impact matter on one flat floor alone, where they stay the same if they are.
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    # A contact slips and the other is open.
    if fa * abs(qa * sa) >= 1.0 + qa * qa or fb * abs(nq * tq) >= 1.0 + nq * nq:
        return False
    if nx == 0.0 and ny > 0.0 and sa == tq and cta == ctb:
        return abs((fb - fa) * sa) < abs(nq - qa)
    # A contact slips and the other sticks.
    if fa * abs(old_arm) >= abs(old_lever) or fb * abs(arm) >= abs(lever):
        return False
    # Both slip: nA x nB, which is (x, y, -nx), times the cross product of nA +- fa tA and nB +- fb tB.
    x, y = nq - qa * ny, qa * nx
    normals = x * x + y * y + nx * nx
    old = fa * (y * (nq - sa * nx) + ny * (x * sa + nx))
    new = fb * (x * (tq + qa * nx) + ny * (y * qa + nx))
    both = fa * fb * (-x * sa * nx - y * (sa * ny - tq) - nx * nx)
    return abs(old + new) < normals + both and abs(old - new) < normals - both


def add(found: Solutions, other: Solution, choice: int) -> Solutions:
    """Count a solution that holds if it differs from the first one, and keep the one of number `choice`."""
    count, first, chosen = found
    held, a, b, na, ta, nb, tb, dx, dy, dq = other
    if not held or (count and same(first, other)):
        return found
    return count + 1, first if count else other, other if count <= choice else chosen


def same(one: Solution, other: Solution) -> bool:
    """Whether two solutions change the twist in the same way, up to rounding."""
    held, a, b, na, ta, nb, tb, ux, uy, uq = one
    held, a, b, na, ta, nb, tb, vx, vy, vq = other
    scale = abs(ux) + abs(uy) + abs(uq) + abs(vx) + abs(vy) + abs(vq)
    return abs(ux - vx) + abs(uy - vy) + abs(uq - vq) <= SAME_TWIST * scale


def solve(problem: Problem, choice: int) -> Impact:
    """Solve for the impulses of the whole impact; c_nA is inf where there is no A.

    The restitutions are Newton's. The first solution of these answers: A opens, B opens, both stick, one sticks, both
    slip; `choice` k > 0 takes the k-th that differs from it.
    """
    contacts, (restitution_old, restitution), (cna, cta, cnb, ctb), (zero_na, zero_ta, zero_nb, zero_tb) = problem
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    given = rounding != ROUNDING
    gna, gnb = newton(restitution_old, cna), newton(restitution, cnb)
    solution = new_alone(contacts, gna, gnb, ctb) if gnb < 0.0 or (given and gnb == 0.0) else NOT_POSSIBLE
    alone, a, b, na, ta, nb, tb, dx, dy, dq = solution
    found = (1 if alone else 0), solution, solution
    if cna < inf and not (alone and not given and one_answer(contacts, cta, ctb)):
        # Where its own friction presses it down, A takes the impulse even if it is not struck.
        if gna < 0.0 or (gna == 0.0 and (given or (cta != 0.0 and fa * abs(qa * sa) > 1.0 + qa * qa))):
            found = add(found, old_alone(contacts, gna, cta, gnb), choice)
        c, zero = (gna, cta, gnb, ctb), max(zero_na, zero_ta) + max(zero_nb, zero_tb)
        if given:
            found = all_that_hold(contacts, c, zero, found, choice)
        else:
            found = both_hold(contacts, c, zero, found, choice)
        count, first, chosen = found
        if not count:
            found = any_that_holds(contacts, c, found, choice)

    count, first, (held, a, b, na, ta, nb, tb, dx, dy, dq) = found
    vna = cna + an * dy + qa * dq if a == OPEN else cna - gna
    vta = 0.0 if a == STICK else cta + at * dx + sa * dq
    vnb = cnb + nx * dx + ny * dy + nq * dq if b == OPEN else cnb - gnb
    vtb = 0.0 if b == STICK else ctb + tx * dx + ty * dy + tq * dq
    notes = 0 if count else NO_SOLUTION
    if (vta * cta < 0.0 and abs(vta) > zero_ta) or (vtb * ctb < 0.0 and abs(vtb) > zero_tb):
        notes |= REVERSED
    if a == STICK and b == STICK and extra == 0.0:
        notes |= SHARED_FRICTION
    return na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, 4 * a + b, notes, count
