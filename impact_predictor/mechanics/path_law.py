"""Impulse-path law: Routh's hypothesis with Poisson restitution.

The contact states are followed along the growing normal impulse of the struck contact B. The *rates* of the contact
velocities obey Coulomb's law at B and, while it is closed, at the old contact A; a segment ends when a slip or an open
gap's velocity reaches zero, or with the compression of B.
"""

from __future__ import annotations

from math import inf, sqrt

from .pair import (
    JAMMED,
    MINUS,
    NO_SOLUTION,
    NOT_CONSISTENT,
    OPEN,
    PLUS,
    REVERSED,
    ROUNDING,
    SHARED_FRICTION,
    STICK,
    WORK_LIMITED,
    Impact,
    Pair,
    Problem,
    least_push,
)
from .path_states import choose

MAX_SEGMENTS = 600
"""Jams can follow each other without end while the velocities shrink by a factor each time; nothing else needs ten."""

ROOM = 1 << 52
"""A code of segments below this has room for two more in 64 bits; later segments are not told."""

ENDLESS, COMPRESSED, EXPANDED, WORK_RETURNED, OLD_CLOSES, OLD_SLIP_ENDS, NEW_SLIP_ENDS = 0, 1, 2, 3, 4, 5, 6
"""What ends a segment."""


def strike_old(pair: Pair, cta: float) -> tuple[bool, float, float, float, float, float, float, float, float, int]:
    """Tangential impact at A that ends a jam: B is held and A follows its own one-contact path.

    N_A grows while A slips to rest, which presses it into the support, and on until it leaves it. Returns whether A
    can do so, N_A, T_A, c_tA afterwards, the changes of c_nB and c_tB and of the twist, and the segments.
    """
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    a = PLUS if cta > 0.0 else MINUS
    ax = -fa if cta > 0.0 else fa
    aq = qa + ax * sa
    normal, tangential = 1.0 + qa * aq, ax + sa * aq
    if normal >= 0.0 or tangential * cta >= 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    na = -cta / tangential
    ta = ax * na
    depth = normal * na

    hold_x = -qa * sa / (1.0 + sa * sa)
    if abs(hold_x) <= fa:
        state, ax, slip_rate = STICK, hold_x, 0.0
        normal = 1.0 + qa * qa / (1.0 + sa * sa)
    else:
        state = MINUS if a == PLUS else PLUS
        ax = -ax
        normal = 1.0 + qa * (qa + ax * sa)
        slip_rate = ax + sa * (qa + ax * sa)
    rise = -depth / normal
    na += rise
    ta += ax * rise
    dx, dy, dq = ta, na, qa * na + sa * ta
    dnb = cos * dy - sin * dx + qb * dq
    dtb = cos * dx + sin * dy + sb * dq
    return True, na, ta, slip_rate * rise, dnb, dtb, dx, dy, dq, 64 * a + 4 * state


def solve(problem: Problem, choice: int) -> Impact:
    """Follow the impulse path from contact velocities with c_nB < 0 and c_nA >= 0.

    The restitution at B is Poisson's; A does not approach, so that its own has no effect. `choice` picks among the
    consistent states at the first instant that has several.
    """
    pair, _, restitution, cna, cta, cnb, ctb, zero_a, zero_b = problem
    na = ta = nb = tb = dx = dy = dq = work = 0.0
    target = inf
    compressing, decided = True, False
    segments, notes, choices = 0, 0, 1
    a = b = OPEN
    slip_a, slip_b = cta, ctb
    rate = NOT_CONSISTENT
    for _ in range(MAX_SEGMENTS):
        if not decided:
            found, a, b, rate = choose(pair, cna, cta, ctb, compressing, choice)
            if found > 1 and choices == 1:
                choices, choice = found, 0
            if found == 0:
                freed, n, t, cta, dnb, dtb, ex, ey, eq, code = strike_old(pair, cta)
                if not freed:
                    notes |= NO_SOLUTION
                    break
                notes |= JAMMED
                if segments < ROOM:
                    segments = 256 * segments + code
                na, ta, cnb, ctb = na + n, ta + t, cnb + dnb, ctb + dtb
                dx, dy, dq = dx + ex, dy + ey, dq + eq
                if abs(ctb) <= zero_b:
                    ctb = 0.0
                if compressing and cnb >= 0.0:
                    break
                continue
            if a >= PLUS:
                if slip_a == 0.0:
                    slip_a = rate[5]
                elif (slip_a > 0.0) != (a == PLUS):
                    notes |= REVERSED
            elif a == STICK and b == STICK:
                notes |= SHARED_FRICTION
            if b >= PLUS:
                if slip_b == 0.0:
                    slip_b = rate[7]
                elif (slip_b > 0.0) != (b == PLUS):
                    notes |= REVERSED
        _, pna, pta, ptb, rna, rta, rnb, rtb, ex, ey, eq = rate
        if segments < ROOM:
            segments = 16 * segments + 4 * a + b

        span, event = inf, ENDLESS
        if compressing:
            if rnb > 0.0:
                span, event = -cnb / rnb, COMPRESSED
        else:
            span, event = target - nb, EXPANDED
            square = cnb * cnb + 2.0 * rnb * work
            if square >= 0.0:
                speed = cnb + sqrt(square)
                if speed > 0.0 and 2.0 * work < span * speed * (1.0 - ROUNDING):
                    span, event = 2.0 * work / speed, WORK_RETURNED
        if a == OPEN:
            if cna > 0.0 and rna < 0.0:
                wait = -cna / rna
                if wait < span:
                    span, event = wait, OLD_CLOSES
        elif cta * rta < 0.0:
            wait = -cta / rta
            if wait < span:
                span, event = wait, OLD_SLIP_ENDS
        if ctb * rtb < 0.0:
            wait = -ctb / rtb
            if wait < span:
                span, event = wait, NEW_SLIP_ENDS
        if event == ENDLESS:
            notes |= NO_SOLUTION
            break

        na += pna * span
        ta += pta * span
        nb += span
        tb += ptb * span
        if restitution > 0.0:
            work -= span * (cnb + 0.5 * rnb * span)
        cna += rna * span
        cta += rta * span
        cnb += rnb * span
        ctb += rtb * span
        dx += ex * span
        dy += ey * span
        dq += eq * span
        if event == COMPRESSED and restitution == 0.0:
            cnb = 0.0
            break
        if cna <= zero_a or event == OLD_CLOSES:
            cna = 0.0
        if -zero_a <= cta <= zero_a or event == OLD_SLIP_ENDS:
            cta = 0.0
        if -zero_b <= ctb <= zero_b or event == NEW_SLIP_ENDS:
            ctb = 0.0

        decided = False
        if event == COMPRESSED or (compressing and cnb >= -zero_b):
            cnb = 0.0
            if restitution == 0.0:
                break
            compressing, target = False, (1.0 + restitution) * nb
            decided = (cna > 0.0 if a == OPEN else a == STICK or cta != 0.0) and (b == STICK or ctb != 0.0)
        elif event == EXPANDED or event == WORK_RETURNED:
            if event == WORK_RETURNED:
                notes |= WORK_LIMITED
            if cnb >= -zero_b:
                break
            # B was pressed again while it expanded: a plastic compression ends that.
            compressing, restitution = True, 0.0
    else:
        notes |= NO_SOLUTION
    if notes & SHARED_FRICTION:
        _, na, ta, nb, tb = least_push(pair, na, ta, nb, tb)
    return na, ta, nb, tb, cna, cta, cnb, ctb, dx, dy, dq, segments, notes, choices
