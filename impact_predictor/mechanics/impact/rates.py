"""Contact states that Coulomb's law allows at one instant of the impulse path, and the rates that they give.

Law code (see `contacts`).
"""

from __future__ import annotations

from .contacts import CANCELLED, MINUS, OPEN, PLUS, ROUNDING, STICK, ContactRows, below_rounding, push_interval

Rates = tuple[bool, float, float, float, float, float, float, float, float, float, float]
"""Whether the states are consistent; N_A, T_A, T_B; rates of c_nA, c_tA, c_nB, c_tB and of the twist (x, y, rho
omega): all per unit N_B."""

States = tuple[int, int, int, Rates]
"""How many pairs of states are consistent; the chosen states of A and B; their rates."""

NOT_CONSISTENT: Rates = (False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def state_alone(contacts: ContactRows, ctb: float) -> int:
    """State of B while A is open: friction stops its slip, and keeps it at rest if it can."""
    if ctb != 0.0:
        return PLUS if ctb > 0.0 else MINUS
    old, (nx, ny, nq, tx, ty, tq, extra, fb), (bnn, bnt, btt, size), minors, rounding = contacts
    drive, hold = bnt + nq * tq, fb * (btt + tq * tq)
    if drive > hold:
        return PLUS
    return MINUS if drive < -hold else STICK


def open_rates(contacts: ContactRows, b: int, cna: float) -> Rates:
    """Rates while A is open, with B in the state `b` that `state_alone` gives."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), (bnn, bnt, btt, new_size), minors, rounding = contacts
    if b == STICK:
        hold = btt + tq * tq
        if hold > 0.0:
            bq = (nq * btt - tq * bnt) / hold
            tb = -(bnt + nq * tq) / hold
            rnb = new_size / hold + extra
        else:
            bq, tb, rnb = nq, 0.0, bnn + nq * nq + extra
        rtb = 0.0
    else:
        tb = -fb if b == PLUS else fb
        bq = nq + tb * tq
        rnb, rtb = bnn + tb * bnt + nq * bq + extra, bnt + tb * btt + tq * bq
    bx, by = nx + tb * tx, ny + tb * ty
    rna = an * by + qa * bq
    if rna < 0.0 and cna <= 0.0 and below_rounding(rna, rounding, an * by, qa * bq):
        return NOT_CONSISTENT
    return True, 0.0, 0.0, tb, rna, at * bx + sa * bq, rnb, rtb, bx, by, bq


def stick_rates(contacts: ContactRows, b: int, ctb: float) -> Rates:
    """Rates while A sticks and B slips. Where friction cannot hold A, the T_A that would do so is still given."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    # The twist turns about A: it is a multiple of nA x tA = (an sa, at qa, -an at).
    sa2, qa2, k = at * at + sa * sa, an * an + qa * qa, an * at
    size = k * k + (an * sa) * (an * sa) + (at * qa) * (at * qa)
    if size == 0.0:
        return NOT_CONSISTENT
    tb = -fb if b == PLUS else fb
    bx, by, bq = nx + tb * tx, ny + tb * ty, nq + tb * tq
    na = at * qa * (sa * bx - at * bq) - an * by * sa2
    ta = an * sa * (qa * by - an * bq) - at * bx * qa2
    room = fa * na - abs(ta)
    if (na < 0.0 and below_rounding(na, rounding, at * qa * sa * bx, at * at * qa * bq, an * by * sa2)) or (
        room < 0.0 and below_rounding(room, rounding, fa * na, an * sa * qa * by, an * an * sa * bq, at * bx * qa2)
    ):
        return False, na, ta, tb, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    turn = (lever + tb * arm) / size
    rtb = turn * arm
    if ctb == 0.0 and (rtb < 0.0 if b == PLUS else rtb > 0.0):
        if below_rounding(-abs(rtb), rounding, turn * an * sa * tx, turn * at * qa * ty, turn * k * tq):
            return NOT_CONSISTENT
    dx, dy, dq = turn * an * sa, turn * at * qa, -turn * k
    return True, na / size, ta / size, tb, 0.0, 0.0, turn * lever + extra, rtb, dx, dy, dq


def slide_rates(contacts: ContactRows, a: int, b: int, cta: float, ctb: float) -> Rates:
    """Rates while both contacts slip."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    ax = -fa if a == PLUS else fa
    aq = qa + ax * sa
    tb = -fb if b == PLUS else fb
    bx, by, bq = nx + tb * tx, ny + tb * ty, nq + tb * tq
    den = an * an + qa * aq
    lift = an * by + qa * bq
    if abs(den) <= (rounding - ROUNDING) * (an * an + abs(qa * aq)) or (
        lift * den > 0.0 and below_rounding(-abs(lift), rounding, an * by, qa * bq)
    ):
        return NOT_CONSISTENT
    na = -lift / den
    dx = bx + na * ax * at
    dq = an * (an * bq - by * aq) / den
    dy = -qa * dq / an if an > 0.0 else by
    rta = at * dx + sa * dq
    if cta == 0.0 and (rta < 0.0 if a == PLUS else rta > 0.0):
        if below_rounding(-abs(rta), rounding, at * dx, sa * dq):
            return NOT_CONSISTENT
    rtb = tx * dx + ty * dy + tq * dq
    if ctb == 0.0 and (rtb < 0.0 if b == PLUS else rtb > 0.0):
        if below_rounding(-abs(rtb), rounding, tx * dx, ty * dy, tq * dq):
            return NOT_CONSISTENT
    return True, na, ax * na, tb, 0.0, rta, nx * dx + ny * dy + nq * dq + extra, rtb, dx, dy, dq


def slide_stick_rates(contacts: ContactRows, a: int, cta: float) -> Rates:
    """Rates while A slips and B sticks."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), (bnn, bnt, btt, size), minors, rounding = contacts
    ax = -fa if a == PLUS else fa
    aq = qa + ax * sa
    # The twist keeps c_nA and c_tB: it is a multiple of nA x tB.
    qx, qy, qq = an * tq - qa * ty, qa * tx, -an * tx
    ex, ey, eq = an * tq - aq * ty, aq * tx - ax * at * tq, ax * at * ty - an * tx
    den = qx * ex + qy * ey + qq * eq
    lift_x, lift_y, lift_q = qx * (ny * tq - nq * ty), qy * (nq * tx - nx * tq), qq * (nx * ty - ny * tx)
    lift = lift_x + lift_y + lift_q
    if abs(den) <= (rounding - ROUNDING) * (abs(qx * ex) + abs(qy * ey) + abs(qq * eq)) or (
        lift * den > 0.0 and below_rounding(-abs(lift), rounding, lift_x, lift_y, lift_q)
    ):
        return NOT_CONSISTENT
    na = -lift / den
    tb = -(bnt + nq * tq + na * (ax * at * tx + an * ty + aq * tq)) / (btt + tq * tq)
    if abs(tb) > fb * (1.0 + rounding):
        return NOT_CONSISTENT
    turn = (nx * ex + ny * ey + nq * eq) / den
    dx, dy, dq = turn * qx, turn * qy, turn * qq
    rta = at * dx + sa * dq
    if cta == 0.0 and (rta < 0.0 if a == PLUS else rta > 0.0):
        if below_rounding(-abs(rta), rounding, at * dx, sa * dq):
            return NOT_CONSISTENT
    return True, na, ax * na, tb, 0.0, rta, nx * dx + ny * dy + nq * dq + extra, 0.0, dx, dy, dq


def rolling_rates(contacts: ContactRows) -> Rates:
    """Rates while both contacts stick and B's tangent passes through A, so that the body can turn about A.

    B's friction is then free within an interval, of which the end nearest to zero is taken. Where friction cannot
    hold both, the T_A that would do so is still given.
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    k = an * at
    size = k * k + (an * sa) * (an * sa) + (at * qa) * (at * qa)
    if size == 0.0:
        return NOT_CONSISTENT
    na = (at * qa * (sa * nx - at * nq) - an * ny * (at * at + sa * sa)) / size
    ta = (an * sa * (qa * ny - an * nq) - at * nx * (an * an + qa * qa)) / size
    zn, zt = -ty / an, -tx / at
    low, high = push_interval(na, ta, zn, zt, fa)
    if low < -fb:
        low = -fb
    if high > fb:
        high = fb
    if low > high and below_rounding(high - low, rounding, fb, ta, fa * na):
        return False, na, ta, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    tb = low if low > 0.0 else high if high < 0.0 else 0.0
    turn = lever / size
    dx, dy, dq = turn * an * sa, turn * at * qa, -turn * k
    return True, na + tb * zn, ta + tb * zt, tb, 0.0, 0.0, turn * lever + extra, 0.0, dx, dy, dq


def wedged_rates(contacts: ContactRows) -> Rates:
    """Rates while both contacts stick and lock the body: the impulses push along their line and nothing moves."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    if arm == 0.0:
        return NOT_CONSISTENT
    na, ta, tb = old_arm / arm, -old_lever / arm, -lever / arm
    held = na >= 0.0 and abs(ta) <= fa * na * (1.0 + rounding) and abs(tb) <= fb * (1.0 + rounding)
    return held, na, ta, tb, 0.0, 0.0, extra, 0.0, 0.0, 0.0, 0.0


def choose(contacts: ContactRows, cna: float, cta: float, ctb: float, compressing: bool, choice: int) -> States:
    """The `choice`-th consistent pair of states in the order O S + -, A before B.

    While B slips its friction is given, and A meets a load as a single contact does. A load that lifts A opens it,
    unless friction can press A down all the same. Under a load that presses A it has one answer: along the impulses
    that hold A down its slip grows with T_A, so that A sticks, or slips against the T_A that would make it stick.
    """
    (an, at, qa, sa, fa), new, plane, minors, rounding = contacts
    b = state_alone(contacts, ctb)
    best = open_rates(contacts, b, cna)
    if cna > 0.0:
        return 1, OPEN, b, best
    if rounding != ROUNDING or ctb == 0.0:
        return try_all(contacts, b, best, cta, ctb, compressing, choice)
    opens, na, ta, tb, rna, rta, rnb, rtb, dx, dy, dq = best
    if opens:
        if fa * abs(qa * sa) < 1.0 + qa * qa:
            return 1, OPEN, b, best
        return try_all(contacts, b, best, cta, ctb, compressing, choice)
    if cta == 0.0:
        best = stick_rates(contacts, b, ctb)
        consistent, na, ta, tb, rna, rta, rnb, rtb, dx, dy, dq = best
        a = STICK if consistent else MINUS if ta > 0.0 else PLUS
    else:
        a = PLUS if cta > 0.0 else MINUS
    if a != STICK:
        best = slide_rates(contacts, a, b, cta, ctb)
    return 1 if goes_on(best, a, b, cta, ctb, compressing) else 0, a, b, best


def tied(contacts: ContactRows) -> bool:
    """Whether B's tangent passes through A, so that at rest both contacts stick or none does."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    if arm == 0.0:
        return an > 0.0
    return rounding == ROUNDING and abs(arm) <= ROUNDING * (abs(sa * tx) + abs(qa * ty) + abs(tq))


def one_answer(contacts: ContactRows, cta: float) -> bool:
    """Whether a planar body whose B does not slip has one pair of consistent states, as far as is told at once.

    On one flat floor it has at rest. Where A slips c_nA and c_tB answer N_A and T_B linearly: one answer if that 2 x 2
    matrix has positive principal minors (a P-matrix).
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    if rounding != ROUNDING:
        return False
    if cta == 0.0:
        return nx == 0.0 and ny > 0.0 and nq > qa and tied(contacts)
    ax = -fa if cta > 0.0 else fa
    aq = qa + ax * sa
    normal = 1.0 + qa * aq
    return normal > 0.0 and normal * (1.0 + tq * tq) > (ty + tq * qa) * (tx * ax + ty + tq * aq)


def try_all(
    contacts: ContactRows, b: int, best: Rates, cta: float, ctb: float, compressing: bool, choice: int
) -> States:
    """As `choose`, by trial of all states of two closed contacts; `best` are the rates if A opens, with B in state `b`.

    Where the rows come from a W that is singular a contact may stick by more than one set of impulses; one at the
    border of the friction cone is then taken, which is a slip that does not begin, and counts as sticking.
    """
    old, new, plane, minors, rounding = contacts
    given = rounding != ROUNDING
    together = cta == 0.0 and ctb == 0.0 and tied(contacts)
    single = ctb == 0.0 and one_answer(contacts, cta)
    opens, na, ta, tb, rna, rta, rnb, rtb, dx, dy, dq = best
    if given and opens:
        a, b, best = without_rounding(contacts, OPEN, b, best, 1.0, ctb)
    best_a, best_b, found, seen = OPEN, b, 1 if opens else 0, 0
    first_a, last_a = (STICK, MINUS) if cta == 0.0 else (PLUS, PLUS) if cta > 0.0 else (MINUS, MINUS)
    first_b, last_b = (STICK, MINUS) if ctb == 0.0 else (PLUS, PLUS) if ctb > 0.0 else (MINUS, MINUS)
    for state_a in range(first_a, last_a + 1):
        for state_b in range(first_b, last_b + 1):
            a, b = state_a, state_b
            if single and found:
                return found, best_a, best_b, best
            if together and (a == STICK) != (b == STICK):
                continue
            if a > STICK and b > STICK:
                rate = slide_rates(contacts, a, b, cta, ctb)
            elif b > STICK:
                rate = stick_rates(contacts, b, ctb)
            elif a > STICK:
                rate = slide_stick_rates(contacts, a, cta)
            else:
                rate = rolling_rates(contacts) if together else wedged_rates(contacts)
            if given:
                a, b, rate = without_rounding(contacts, a, b, rate, cta, ctb)
            if goes_on(rate, a, b, cta, ctb, compressing) and not seen & (1 << (4 * a + b)):
                seen |= 1 << (4 * a + b)
                if found <= choice:
                    best_a, best_b, best = a, b, rate
                found += 1
    return found, best_a, best_b, best


def without_rounding(
    contacts: ContactRows, a: int, b: int, rate: Rates, cta: float, ctb: float
) -> tuple[int, int, Rates]:
    """States and rates without the rounding of W: a slip that does not begin counts as sticking."""
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    consistent, na, ta, tb, rna, rta, rnb, rtb, dx, dy, dq = rate
    old_n, old_t = an + abs(qa), at + abs(sa)
    new_n, new_t = abs(nx) + abs(ny) + abs(nq), abs(tx) + abs(ty) + abs(tq)
    zero = CANCELLED * (old_n * abs(na) + old_t * abs(ta) + new_n + new_t * abs(tb))
    if abs(rna) <= zero * old_n:
        rna = 0.0
    if abs(rta) <= zero * old_t:
        rta = 0.0
    if abs(rnb) <= zero * new_n:
        rnb = 0.0
    if abs(rtb) <= zero * new_t:
        rtb = 0.0
    if a >= PLUS and cta == 0.0 and rta == 0.0:
        a = STICK
    if b >= PLUS and ctb == 0.0 and rtb == 0.0:
        b = STICK
    return a, b, (consistent, na, ta, tb, rna, rta, rnb, rtb, dx, dy, dq)


def goes_on(rate: Rates, a: int, b: int, cta: float, ctb: float, compressing: bool) -> bool:
    """Whether rates of closed contacts are consistent and end: when the approach of B or a slip comes to zero.

    While B expands they always end, with its impulse.
    """
    consistent, na, ta, tb, rna, rta, rnb, rtb, dx, dy, dq = rate
    if not consistent:
        return False
    return rnb > 0.0 or not compressing or (a >= PLUS and cta * rta < 0.0) or (b >= PLUS and ctb * rtb < 0.0)
