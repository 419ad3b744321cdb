"""Contact states of any mechanism on two contacts, and the rates that they give, from its mobility W alone.

W = G M^-1 G^T is what impulses at the contacts do to the contact velocities, c' = c + W P, in the order n_A, t_A, n_B,
t_B. `path_law.follow` takes its steps with `choose`, `strike_old` and `least_push` of this module as it does with those
of a planar body. Those are apart because they know the body's rows, which keep digits that W has lost.

A sum of terms with W carries the rounding of W, so that one that nearly cancels is zero. Where W is singular a contact
may stick by more than one set of impulses; unless the laws say which, one at the border of the friction cone is taken,
which is a slip that does not begin, and counts as sticking.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple

from .pair import MINUS, NOT_CONSISTENT, OPEN, PLUS, STICK, Push, Rates, push_along, push_interval
from .path_law import OldImpact
from .path_states import States, goes_on

CANCELLED = 1e-12
"""A sum below this part of its terms is the rounding of W and counts as zero."""

ASYMMETRY = 1e-9
"""How far W may be from symmetric, and its pivots below 0, as a part of its diagonal."""

ROUNDS = 20
"""How often the impulses of sticking contacts are pushed along each of several lines."""

CLOSED, SLIPS = (STICK, PLUS, MINUS), (PLUS, MINUS)
"""States of a closed contact."""

Impulses = tuple[float, float, float, float]
"""N_A, T_A, N_B, T_B."""

Block = tuple[float, float, float]
"""Of one contact: normal by normal, normal by tangent, tangent by tangent."""

Cross = tuple[float, float, float, float]
"""Of A by B: normal by normal, normal by tangent, tangent by normal, tangent by tangent."""

Step = tuple[int, float, Impulses]
"""Which velocity's row is eliminated; its pivot; the rest of the row, which is 0 in the columns eliminated before."""


class Mobility(NamedTuple):
    """What the laws know of a mechanism: the blocks of W, the frictions, and how W is eliminated.

    `steps` are the eliminations by a pivot that is not rounding; `lines` are impulses that move nothing, and span all
    that do not.
    """

    old: Block
    new: Block
    cross: Cross
    frictions: tuple[float, float]
    steps: tuple[Step, ...]
    lines: tuple[Impulses, ...]


NO_MOBILITY = Mobility((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0), (), ())


def mobility_of(w: list[list[float]], frictions: tuple[float, float]) -> tuple[bool, Mobility]:
    """Whether W is symmetric and positive semidefinite up to rounding, and what the laws know of it."""
    for i in range(4):
        for j in range(i):
            if w[i][j] != w[j][i] and abs(w[i][j] - w[j][i]) > ASYMMETRY * sqrt(abs(w[i][i] * w[j][j])):
                return False, NO_MOBILITY
    rest, left, steps = [row[:] for row in w], [0, 1, 2, 3], []
    while left:
        i, most = left[0], 0.0
        for j in left:
            if rest[j][j] > most * w[j][j]:
                i, most = j, rest[j][j] / w[j][j]
        if most <= CANCELLED:
            break
        left.remove(i)
        row = rest[i]
        pivot, row[i] = row[i], 0.0
        steps.append((i, pivot, (row[0], row[1], row[2], row[3])))
        for j in left:
            other = rest[j]
            part = other[i] / pivot
            other[i] = 0.0
            for k in left:
                other[k] -= part * row[k]
    for i in left:
        for j in left:
            if abs(rest[i][j]) > ASYMMETRY * sqrt(abs(w[i][i] * w[j][j])):
                return False, NO_MOBILITY
    lines = [substituted(steps, [float(i == j) for j in range(4)]) for i in left]
    (ann, ant, xnn, xnt), (_, att, xtn, xtt), (_, _, bnn, bnt), (_, _, _, btt) = w
    return True, Mobility((ann, ant, att), (bnn, bnt, btt), (xnn, xnt, xtn, xtt), frictions, tuple(steps), tuple(lines))


def substituted(steps: Sequence[Step], p: list[float]) -> Impulses:
    """The impulses for the right-hand sides `p` after the eliminations; where no row was eliminated they are p's."""
    for i, pivot, (na, ta, nb, tb) in reversed(steps):
        p[i] = (p[i] - na * p[0] - ta * p[1] - nb * p[2] - tb * p[3]) / pivot
    return p[0], p[1], p[2], p[3]


def impulses_that_change(mobility: Mobility, c: Impulses, zero: float) -> Push:
    """Whether there are impulses that change the contact velocities by `c`, up to `zero`, and one choice of them."""
    p, left = list(c), {0, 1, 2, 3}
    for i, pivot, row in mobility.steps:
        left.remove(i)
        part = p[i] / pivot
        for j in left:
            p[j] -= row[j] * part
    possible = all(abs(p[i]) <= zero for i in left)
    for i in left:
        p[i] = 0.0
    return possible, *substituted(mobility.steps, p)


def rounded(u: float, v: float, w: float, x: float, y: float = 0.0) -> float:
    """The sum of terms, or 0 where they cancel up to rounding."""
    total = u + v + w + x + y
    return 0.0 if abs(total) <= CANCELLED * (abs(u) + abs(v) + abs(w) + abs(x) + abs(y)) else total


def choose(mobility: Mobility, cna: float, cta: float, ctb: float, compressing: bool, choice: int) -> States:
    """The `choice`-th consistent pair of states in the order O S + -, A before B, as `path_states.choose`."""
    old, (bnn, bnt, btt), (xnn, xnt, xtn, xtt), (fa, fb), _, _ = mobility
    _, ant, att = old
    states_a = closed_states(cta)
    found: dict[int, Rates] = {}
    for b in closed_states(ctb):
        left, un, ut, tb = load_on_old(mobility, b)
        ways = [(OPEN, 0.0, 0.0)]
        # A load that lifts A opens it, unless friction can press A down all the same.
        if cna <= 0.0 and (un < 0.0 or fa * abs(left[1]) >= left[0]):
            ways += ways_to_hold(left, old, fa, states_a, un, ut)
            if b == STICK and cta == 0.0:
                ways += rolling(mobility, left)
        for a, na, ta in ways:
            if b == STICK and btt > 0.0:
                tb = -(bnt + xnt * na + xtt * ta) / btt
                if abs(tb) > fb * (1.0 + CANCELLED):
                    continue
            rna = rta = rtb = 0.0
            if a == OPEN:
                rna = rounded(0.0, 0.0, xnn, xnt * tb)
                if rna < 0.0 and cna <= 0.0:
                    continue
            if a != STICK:
                rta = rounded(ant * na, att * ta, xtn, xtt * tb)
                if cta == 0.0 and against(a, rta):
                    continue
            if b != STICK:
                rtb = rounded(xnt * na, xtt * ta, bnt, btt * tb)
                if ctb == 0.0 and against(b, rtb):
                    continue
            rnb = rounded(xnn * na, xtn * ta, bnn, bnt * tb)
            rate = (True, na, ta, tb, rna, rta, rnb, rtb, 0.0, 0.0, 0.0)
            if a != OPEN and not rnb > 0.0 and not goes_on(rate, a, b, cta, ctb, compressing):
                continue
            if a != OPEN and cta == 0.0 and rta == 0.0:
                a = STICK
            state_b = STICK if ctb == 0.0 and rtb == 0.0 else b
            found.setdefault(4 * a + state_b, rate)
    if not found:
        return 0, OPEN, OPEN, NOT_CONSISTENT
    states = sorted(found)[min(choice, len(found) - 1)]
    return len(found), states // 4, states % 4, found[states]


def closed_states(slip: float) -> tuple[int, ...]:
    """The states of a closed contact that slips so."""
    return CLOSED if slip == 0.0 else (PLUS,) if slip > 0.0 else (MINUS,)


def against(state: int, slip: float) -> bool:
    """Whether a slip, or its rate, is against the direction of the state."""
    return slip < 0.0 if state == PLUS else state == MINUS and slip > 0.0


def load_on_old(mobility: Mobility, b: int) -> tuple[Block, float, float, float]:
    """A's mobility while B is in state `b`; the rates of c_nA and c_tA per unit N_B; T_B if B slips."""
    (ann, ant, att), (_, bnt, btt), (xnn, xnt, xtn, xtt), (_, fb), _, _ = mobility
    if b != STICK:
        tb = -fb if b == PLUS else fb
        return (ann, ant, att), xnn + tb * xnt, xtn + tb * xtt, tb
    if not btt > 0.0:
        return (ann, ant, att), xnn, xtn, 0.0
    kn, kt = xnt / btt, xtt / btt
    return (ann - kn * xnt, ant - kn * xtt, att - kt * xtt), xnn - kn * bnt, xtn - kt * bnt, 0.0


def ways_to_hold(
    block: Block, full: Block, friction: float, states: tuple[int, ...], cn: float, ct: float
) -> list[tuple[int, float, float]]:
    """The ones of these states in which a contact can hold, and the impulses N and T that bring cn, or a stick cn and
    ct, to zero; `block` is what is left of its mobility, `full`.

    Against an approach it has one answer: along the impulses that stop the approach its slip grows with T, so that it
    sticks, or slips against the T that would make it stick.
    """
    nn, nt, tt = block
    ways = []
    if states is CLOSED and not singular(block, full):
        part = nt / nn
        t = (part * cn - ct) / (tt - part * nt)
        n = -(cn + nt * t) / nn
        if n >= 0.0 and abs(t) <= friction * n * (1.0 + CANCELLED):
            ways.append((STICK, n, t))
            states = () if cn < 0.0 else SLIPS
        elif cn < 0.0:
            states = (MINUS,) if t > 0.0 else (PLUS,)
    for state in states:
        along = -friction if state == PLUS else friction
        size = nn + along * nt
        if state != STICK and abs(size) > CANCELLED * (full[0] + abs(along * full[1])) and cn * size <= 0.0:
            ways.append((state, -cn / size, -along * cn / size))
    return ways


def singular(block: Block, full: Block) -> bool:
    """Whether `block`, what is left of a contact's mobility `full`, leaves it a direction without mobility."""
    nn, nt, tt = block
    return nn <= CANCELLED * full[0] or tt - nt / nn * nt <= CANCELLED * full[2]


def rolling(mobility: Mobility, left: Block) -> list[tuple[int, float, float]]:
    """As `ways_to_hold`, where both contacts stick and B's tangent moves only with A: what B leaves A is singular.

    T_B is then free within an interval, of which the end nearest to zero is taken.
    """
    old, _, (xnn, xnt, xtn, xtt), (fa, fb), _, _ = mobility
    ann, ant, att = old
    if singular(old, old) or not singular(left, old):
        return []
    part = ant / ann
    rest = att - part * ant
    ta, zt = (part * xnn - xtn) / rest, (part * xnt - xtt) / rest
    na, zn = -(xnn + ant * ta) / ann, -(xnt + ant * zt) / ann
    low, high = push_interval(na, ta, zn, zt, fa)
    low, high = max(low, -fb), min(high, fb)
    if low > high + CANCELLED * fb:
        return []
    tb = low if low > 0.0 else high if high < 0.0 else 0.0
    return [(STICK, na + tb * zn, ta + tb * zt)]


def strike_old(mobility: Mobility, cta: float) -> OldImpact:
    """Tangential impact at A that ends a jam, as `path_law.strike_old`."""
    (ann, ant, att), _, (xnn, xnt, xtn, xtt), (fa, _), _, _ = mobility
    a = PLUS if cta > 0.0 else MINUS
    ax = -fa if a == PLUS else fa
    normal, tangential = ann + ax * ant, ant + ax * att
    if normal >= 0.0 or tangential * cta >= 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    na = -cta / tangential
    ta = ax * na
    depth = normal * na

    hold, state, slip_rate = -ant / att, STICK, 0.0
    if abs(hold) > fa:
        hold, state = -ax, MINUS if a == PLUS else PLUS
        slip_rate = ant + hold * att
    if ann + hold * ant <= CANCELLED * ann:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    rise = -depth / (ann + hold * ant)
    na += rise
    ta += hold * rise
    dnb, dtb = xnn * na + xtn * ta, xnt * na + xtt * ta
    return True, na, ta, slip_rate * rise, dnb, dtb, 0.0, 0.0, 0.0, 64 * a + 4 * state


def least_push(mobility: Mobility, na: float, ta: float, nb: float, tb: float) -> Push:
    """Share the impulses of two sticking contacts with the least push that moves nothing and that both cones allow.

    Along several lines the pushes are taken in turns, and need not come to the least of all.
    """
    _, _, _, (fa, fb), _, lines = mobility
    for line in lines * ROUNDS if len(lines) > 1 else lines:
        _, na, ta, nb, tb = push_along(line, fa, fb, na, ta, nb, tb)
    size = CANCELLED * (abs(na) + abs(nb))
    old = na >= -size and abs(ta) <= fa * (na + size)
    return old and nb >= -size and abs(tb) <= fb * (nb + size), na, ta, nb, tb
