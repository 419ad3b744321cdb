"""Impulse-path law: Routh's hypothesis with Poisson's or with energetic restitution.

The contact states are followed along the growing normal impulse of the struck contact B. The *rates* of the contact
velocities obey Coulomb's law at B and, while it is closed, at the old contact A; a segment ends when a slip or an open
gap's velocity reaches zero, with the compression of B, or with its expansion.

By the energetic rule (Stronge) B is a spring, which stores the work -c_nB dN_B while it is compressed, keeps the part
e^2 of it when that ends, and opens when it has given this part back. Along a segment c_nB is linear in N_B and so the
work quadratic: the impulse at which B opens is exact. Where B is pressed again before it opens, the work goes back into
the store as it came out of it. If the store is full before B leaves again, the compression goes on from where it ended,
and the part e^2 is kept of all that it has stored by its next end. So B opens once, while it leaves, and gives no more
than e^2 of the work that it took: no impact gains energy. Where the contacts lock the body before B opens, the rest of
the work stays in B. Law code (see `contacts`).
"""

from __future__ import annotations

from math import inf
from typing import Final, NamedTuple

from .contacts import (
    JAMMED,
    MINUS,
    NO_SOLUTION,
    OPEN,
    PLUS,
    REVERSED,
    ROUNDING,
    SHARED_FRICTION,
    STICK,
    WORK_LIMITED,
    ContactRows,
    Impact,
    Problem,
    least_push,
)
from .rates import NOT_CONSISTENT, choose
from .restitution import energetic, poisson, span_of_work, span_to_give

OldImpact = tuple[bool, float, float, float, float, float, float, float, float, int]
"""Whether a tangential impact at A is possible; N_A, T_A; c_tA afterwards; the changes of c_nB and c_tB and of the
twist; the segments."""


class Jam(NamedTuple):
    """Velocities, impulses, change of the twist and stored work after a jam."""

    cnb: float
    ctb: float
    na: float
    ta: float
    nb: float
    tb: float
    dx: float
    dy: float
    dq: float
    work: float


NO_JAM: Final = Jam(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

REST: Final = 1e-10
"""Below this part of the speeds before the impact B has no normal velocity, where both contacts rest otherwise."""

LEFT: Final = 1e-9
"""Below this part of its own size an approach that is left after endless jams is none."""

SLOWEST: Final = 1e-6
"""Jams whose slips become smaller by no more than this part are not followed to their limit."""

MAX_SEGMENTS: Final = 600
"""Jams after which A slips can be many, while the slips shrink by a factor each time; nothing else needs ten."""

ROOM: Final = 1 << 52
"""A code of segments below this has room for two more in 64 bits; later segments are not told."""

ENDLESS: Final = 0
COMPRESSED: Final = 1
EXPANDED: Final = 2
WORK_RETURNED: Final = 3
OLD_CLOSES: Final = 4
OLD_SLIP_ENDS: Final = 5
NEW_SLIP_ENDS: Final = 6
FULL: Final = 7
OPENED: Final = 8
"""What ends a segment."""


def strike_old(contacts: ContactRows, cta: float) -> OldImpact:
    """Tangential impact at A that ends a jam: B is held and A follows its own one-contact path.

    N_A grows while A slips to rest, which presses it into the support, and on until it leaves it.
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    a = PLUS if cta > 0.0 else MINUS
    ax = -fa if cta > 0.0 else fa
    aq = qa + ax * sa
    normal, tangential = an * an + qa * aq, ax * at * at + sa * aq
    square, k = an * an + qa * qa, an * at
    size = k * k + (an * sa) * (an * sa) + (at * qa) * (at * qa)
    if normal >= 0.0 or tangential * cta >= 0.0 or size == 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    hold = at * at + sa * sa
    if abs(qa * sa) <= fa * hold:
        state, after = STICK, 0.0
    else:
        state = MINUS if a == PLUS else PLUS
        back = qa - ax * sa
        rise = an * an + qa * back
        if abs(rise) <= (rounding - ROUNDING) * square:
            return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
        after = cta * (normal / rise) * ((sa * back - ax * at * at) / tangential)
    # All in all c_nA is unchanged, and c_tA goes from `cta` to `after`: the twist changes along nA x (nA x tA).
    change = (cta - after) / size
    dnb = nx * (after - cta) / at + an * sa * lever * change / at
    dtb = tx * (after - cta) / at + an * sa * arm * change / at
    dx, dy, dq = -at * square * change, an * qa * sa * change, -an * an * sa * change
    return True, dy / an, dx / at, after, dnb, dtb, dx, dy, dq, 64 * a + 4 * state


def rest_of_jams(before: Jam, after: Jam) -> tuple[float, float, float]:
    """What is still to come of jams that follow each other without end, after the two last ones that A sticks after.

    With A at rest all depends on c_tB, which is a factor smaller after each: a geometric series. Returns how many times
    the changes from one jam to the other are still to come (0 if the series diverges; inf if they become so little
    smaller that rounding hides it), c_nB after all of them, and their work.
    """
    cnb, ctb = after.cnb, after.ctb
    fall = before.ctb - ctb
    if ctb != 0.0 and abs(fall) <= SLOWEST * abs(ctb):
        return inf, 0.0, 0.0
    if ctb * fall <= 0.0:
        return 0.0, 0.0, 0.0
    part = ctb / fall
    change = cnb - before.cnb
    left = cnb + part * change
    if abs(left) <= LEFT * (abs(cnb) + abs(before.cnb)):
        left = 0.0
    push = after.nb - before.nb
    steady = -left * push
    returned = part * steady + (after.work - before.work - steady) * (part * ctb / (before.ctb + ctb))
    return part, left, returned


def rests(problem: Problem, cnb: float) -> bool:
    """Whether a normal velocity of B is rounding of the speeds before the impact."""
    contacts, restitutions, (cna, cta, before, ctb), zero = problem
    return abs(cnb) <= REST * (abs(cta) + abs(before) + abs(ctb))


def push_is_free(problem: Problem, cnb: float) -> bool:
    """Whether a push along the line of two sticking contacts does no work (see `least_push`).

    It does some where B moves along that line, as it can while the supports part.
    """
    (old, new, plane, (lever, arm, old_lever, old_arm), rounding), restitutions, before, zero = problem
    size = abs(lever) + abs(arm) + abs(old_lever) + abs(old_arm)
    return size == 0.0 or rests(problem, cnb * arm / size)


def solve(problem: Problem, choice: int, by_energy: bool) -> Impact:
    """Follow the impulse path from contact velocities with c_nB < 0 and c_nA >= 0.

    The restitution at B is the energetic one or Poisson's; A does not approach, so that its own has no effect. `choice`
    picks among the consistent states at the first instant that has several.
    """
    contacts, (restitution_old, restitution), (cna, cta, cnb, ctb), (zero_na, zero_ta, zero_nb, zero_tb) = problem
    old, (nx, ny, nq, tx, ty, tq, extra, fb), plane, minors, rounding = contacts
    na = ta = nb = tb = dx = dy = dq = work = stored = 0.0
    target = inf
    compressing, decided = True, False
    segments, notes, choices = 0, 0, 1
    a = b = OPEN
    slip_a, slip_b = cta, ctb
    consistent, pna, pta, ptb, rna, rta, rnb, rtb, ex, ey, eq = NOT_CONSISTENT
    jam = NO_JAM
    for _ in range(MAX_SEGMENTS):
        if not decided:
            found, a, b, rate = choose(contacts, cna, cta, ctb, compressing, choice)
            if found > 1 and choices == 1:
                choices, choice = found, 0
            if found == 0:
                freed, n, t, after, dnb, dtb, ex, ey, eq, code = strike_old(contacts, cta)
                if not freed:
                    # Where both contacts rest up to rounding nothing moves any more.
                    if cta != 0.0 or ctb != 0.0 or (cnb < 0.0 and not rests(problem, cnb)):
                        notes |= NO_SOLUTION
                    elif cnb < 0.0:
                        cnb = 0.0
                    break
                notes |= JAMMED
                if segments < ROOM:
                    segments = 256 * segments + code
                na, ta, cta, cnb, ctb = na + n, ta + t, after, cnb + dnb, ctb + dtb
                dx, dy, dq = dx + ex, dy + ey, dq + eq
                if abs(ctb) <= zero_tb:
                    ctb = 0.0
                if compressing and cnb > zero_nb and not (by_energy and restitution > 0.0):
                    break
                if cta == 0.0 and not (compressing and cnb >= -zero_nb):
                    before = jam
                    jam = Jam(cnb=cnb, ctb=ctb, na=na, ta=ta, nb=nb, tb=tb, dx=dx, dy=dy, dq=dq, work=work)
                    part, left, returned = rest_of_jams(before, jam)
                    if part == inf:
                        notes |= NO_SOLUTION
                        break
                    push = part * (nb - before.nb)
                    # The impact may end before the series does, or be pressed again.
                    if compressing:
                        within = left <= 0.0
                    elif by_energy:
                        within = cnb * left >= 0.0 and 0.0 <= work + returned <= energetic(restitution, stored)
                    else:
                        within = nb + push <= target and work + returned >= 0.0
                    if part > 0.0 and within:
                        na, ta = na + part * (na - before.na), ta + part * (ta - before.ta)
                        nb, tb = nb + push, tb + part * (tb - before.tb)
                        dx, dy = dx + part * (dx - before.dx), dy + part * (dy - before.dy)
                        dq += part * (dq - before.dq)
                        cnb, ctb, work = left, 0.0, work + returned
                if compressing and cnb >= -zero_nb:
                    if cnb <= zero_nb:
                        cnb = 0.0
                    if restitution == 0.0:
                        break
                    compressing, target, jam = False, poisson(restitution, nb), NO_JAM
                    if by_energy:
                        stored, work = work, energetic(restitution, work)
                continue
            consistent, pna, pta, ptb, rna, rta, rnb, rtb, ex, ey, eq = rate
            if a >= PLUS:
                if slip_a == 0.0:
                    slip_a = rta
                elif (slip_a > 0.0) != (a == PLUS):
                    notes |= REVERSED
            elif a == STICK and b == STICK and extra == 0.0 and push_is_free(problem, cnb):
                notes |= SHARED_FRICTION
            if b >= PLUS:
                if slip_b == 0.0:
                    slip_b = rtb
                elif (slip_b > 0.0) != (b == PLUS):
                    notes |= REVERSED
        if segments < ROOM:
            segments = 16 * segments + 4 * a + b

        span, event = inf, ENDLESS
        if compressing:
            if rnb > 0.0:
                span, event = -cnb / rnb, COMPRESSED
        elif by_energy:
            span, event = span_to_give(work, cnb, rnb), OPENED
            room = energetic(restitution, stored) - work
            filled = span_to_give(room if room > 0.0 else 0.0, -cnb, -rnb)
            if filled < span:
                span, event = filled, FULL
            if span == inf or (rnb == 0.0 and rests(problem, cnb)):
                span, event = inf, ENDLESS
        else:
            span, event = target - nb, EXPANDED
            returned = span_of_work(work, cnb, rnb)
            if returned < span * (1.0 - ROUNDING):
                span, event = returned, WORK_RETURNED
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
            # A body that is locked while B expands is at rest; one that is locked while it approaches has no answer.
            if compressing:
                notes |= NO_SOLUTION
            break

        na += pna * span
        ta += pta * span
        nb += span
        tb += ptb * span
        if restitution > 0.0:
            work -= span * (cnb + 0.5 * rnb * span)
        was_a, was_b = cta, ctb
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
        if cna <= zero_na or event == OLD_CLOSES:
            cna = 0.0
        # A slip that all but ends, or goes past its end by a rounding, is one that ends.
        rest = ROUNDING * abs(was_a)
        if event == OLD_SLIP_ENDS or abs(cta) <= zero_ta or abs(cta) <= rest or (a >= PLUS and cta * was_a < 0.0):
            cta = 0.0
        rest = ROUNDING * abs(was_b)
        if event == NEW_SLIP_ENDS or abs(ctb) <= zero_tb or abs(ctb) <= rest or ctb * was_b < 0.0:
            ctb = 0.0

        decided = False
        if event == COMPRESSED or (compressing and cnb >= -zero_nb):
            cnb = 0.0
            if restitution == 0.0:
                break
            compressing, target, jam = False, poisson(restitution, nb), NO_JAM
            if by_energy:
                stored, work = work, energetic(restitution, work)
            decided = (cna > 0.0 if a == OPEN else a == STICK or cta != 0.0) and (b == STICK or ctb != 0.0)
        elif event == EXPANDED or event == WORK_RETURNED:
            if event == WORK_RETURNED:
                notes |= WORK_LIMITED
            if cnb >= -zero_nb:
                break
            # B was pressed again while it expanded: a plastic compression ends that.
            compressing, restitution, jam = True, 0.0, NO_JAM
        elif event == OPENED:
            break
        elif event == FULL:
            compressing, work, jam = True, stored, NO_JAM
            if cnb > 0.0:
                cnb = 0.0
    else:
        notes |= NO_SOLUTION
    if notes & SHARED_FRICTION:
        held, na, ta, nb, tb = least_push(contacts, na, ta, nb, tb)
    return na, ta, nb, tb, cna, cta, cnb, ctb, dx, dy, dq, segments, notes, choices
