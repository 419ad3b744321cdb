"""Total-impulse law of any mechanism on two contacts, by trial of their states (see `total_law` and `mobility`)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from math import inf

from .mobility import (
    CANCELLED,
    CLOSED,
    Block,
    Cross,
    Mobility,
    against,
    impulses_that_change,
    least_push,
    rounded,
    singular,
    ways_to_hold,
)
from .pair import MINUS, OPEN, PLUS, REVERSED, SHARED_FRICTION, STICK, Impact

SAME = 1e-9
"""Solutions whose contact velocities differ by less than this part of those before the impact are one solution."""

Problem = tuple[Mobility, float, float, float, float, float, float, float, float]
"""As `pair.Problem`, of a mechanism."""

Velocities = tuple[float, float, float, float]
"""Of c_nA, c_tA, c_nB, c_tB."""

Try = tuple[int, int, float, float, float, float]
"""States of A and B; N_A, T_A, N_B, T_B that they need."""


def solutions(problem: Problem) -> list[Impact]:
    """The different solutions in the order A opens, B opens, both stick, one sticks, both slip.

    c_nA is inf where there is no A. The restitutions are Newton's.
    """
    mobility, restitution_old, restitution, cna, cta, cnb, ctb, zero_a, zero_b = problem
    gna = (1.0 + restitution_old) * cna if cna < 0.0 else cna
    gnb = (1.0 + restitution) * cnb if cnb < 0.0 else cnb
    if cna == inf:
        return agreeing(problem, (0.0, 0.0, gnb, ctb), tries_alone(mobility, (inf, 0.0, gnb, ctb)))
    c = gna, cta, gnb, ctb
    tries = chain(tries_alone(mobility, c), tries_together(mobility, c, zero_a + zero_b))
    # A contact that leaves can be held by its own friction; but that is no answer where there is another.
    return agreeing(problem, c, tries) or agreeing(problem, c, tries_alone(mobility, c, leaving=True))


def agreeing(problem: Problem, c: Velocities, tries: Iterable[Try]) -> list[Impact]:
    """The different ones of some tries after which c + W P agrees with the states."""
    mobility, _, _, cna, cta, cnb, ctb, zero_a, zero_b = problem
    gna, _, gnb, _ = c
    same = SAME * max(map(abs, c))
    found: list[Impact] = []
    for a, b, na, ta, nb, tb in tries:
        agree, vna, vta, vnb, vtb = velocities(mobility, c, a, b, na, ta, nb, tb)
        if not agree:
            continue
        a = STICK if a != OPEN and vta == 0.0 else a
        b = STICK if b != OPEN and vtb == 0.0 else b
        notes = SHARED_FRICTION if a == STICK and b == STICK else 0
        if (vta * cta < 0.0 and abs(vta) > zero_a) or (vtb * ctb < 0.0 and abs(vtb) > zero_b):
            notes |= REVERSED
        vna, vnb = vna + (cna - gna), vnb + (cnb - gnb)
        impact = (na, ta, nb, tb, vna, vta, vnb, vtb, 0.0, 0.0, 0.0, 4 * a + b, notes, 1)
        if all(differ(impact, other, same) for other in found):
            found.append(impact)
    return found


def differ(one: Impact, other: Impact, zero: float) -> bool:
    """Whether two answers differ in a contact velocity by more than `zero`."""
    _, _, _, _, una, uta, unb, utb, _, _, _, _, _, _ = one
    _, _, _, _, vna, vta, vnb, vtb, _, _, _, _, _, _ = other
    return abs(una - vna) > zero or abs(uta - vta) > zero or abs(unb - vnb) > zero or abs(utb - vtb) > zero


def velocities(
    mobility: Mobility, c: Velocities, a: int, b: int, na: float, ta: float, nb: float, tb: float
) -> tuple[bool, float, float, float, float]:
    """Whether c + W P agrees with the states, and c + W P, which is 0 where a contact holds."""
    (ann, ant, att), (bnn, bnt, btt), (xnn, xnt, xtn, xtt), _, _, _ = mobility
    cna, cta, cnb, ctb = c
    vna = vta = vnb = vtb = 0.0
    if a == OPEN:
        vna = rounded(ann * na, ant * ta, xnn * nb, xnt * tb, cna)
    if a != STICK:
        vta = rounded(ant * na, att * ta, xtn * nb, xtt * tb, cta)
    if vna < 0.0 or against(a, vta):
        return False, vna, vta, vnb, vtb
    if b == OPEN:
        vnb = rounded(xnn * na, xtn * ta, bnn * nb, bnt * tb, cnb)
    if b != STICK:
        vtb = rounded(xnt * na, xtt * ta, bnt * nb, btt * tb, ctb)
    return vnb >= 0.0 and not against(b, vtb), vna, vta, vnb, vtb


def tries_alone(mobility: Mobility, c: Velocities, leaving: bool = False) -> Iterator[Try]:
    """One contact takes the whole impulse, one that leaves without it or one that does not, and the other opens."""
    old, new, _, (fa, fb), _, _ = mobility
    cna, cta, cnb, ctb = c
    if (cnb > 0.0) is leaving:
        for b, nb, tb in ways_to_hold(new, new, fb, CLOSED, cnb, ctb):
            yield OPEN, b, 0.0, 0.0, nb, tb
    if (cna > 0.0) is leaving:
        for a, na, ta in ways_to_hold(old, old, fa, CLOSED, cna, cta):
            yield a, OPEN, na, ta, 0.0, 0.0


def tries_together(mobility: Mobility, c: Velocities, zero: float) -> Iterator[Try]:
    """Both contacts hold; `zero` is the speed below which contact velocities are rounding."""
    old, new, (xnn, xnt, xtn, xtt), (fa, fb), steps, _ = mobility
    cna, cta, cnb, ctb = c
    yield from both_stick(mobility, c, zero)
    if len(steps) > 2:  # else a contact that sticks leaves the other no mobility but rounding
        for b, na, ta, nb, tb in one_sticks(old, new, (xnn, xnt, xtn, xtt), fa, fb, c):
            yield STICK, b, na, ta, nb, tb
        for a, nb, tb, na, ta in one_sticks(new, old, (xnn, xtn, xnt, xtt), fb, fa, (cnb, ctb, cna, cta)):
            yield a, STICK, na, ta, nb, tb
    yield from both_slide(mobility, cna, cnb)


def both_stick(mobility: Mobility, c: Velocities, zero: float) -> Iterator[Try]:
    """Both contacts stick, if W allows it, with the least impulses where it leaves a choice."""
    cna, cta, cnb, ctb = c
    possible, *needed = impulses_that_change(mobility, (-cna, -cta, -cnb, -ctb), zero)
    held, na, ta, nb, tb = least_push(mobility, *needed)
    if possible and held:
        yield STICK, STICK, na, ta, nb, tb


def one_sticks(
    old: Block, new: Block, cross: Cross, fa: float, fb: float, c: Velocities
) -> Iterator[tuple[int, float, float, float, float]]:
    """A sticks and B slips: what A does to hold is taken out of B's mobility."""
    if singular(old, old):
        return
    (ann, ant, att), (bnn, bnt, btt), (xnn, xnt, xtn, xtt), (cna, cta, cnb, ctb) = old, new, cross, c
    part, part_n, part_t = ant / ann, xnn / ann, xnt / ann
    att, xtn, xtt, cta = att - part * ant, xtn - part * xnn, xtt - part * xnt, cta - part * cna
    bnn, bnt, cnb = bnn - part_n * xnn, bnt - part_n * xnt, cnb - part_n * cna
    btt, ctb = btt - part_t * xnt, ctb - part_t * cna
    part_n, part_t = xtn / att, xtt / att
    bnn, bnt, cnb = bnn - part_n * xtn, bnt - part_n * xtt, cnb - part_n * cta
    btt, ctb = btt - part_t * xtt, ctb - part_t * cta
    for b, nb, tb in ways_to_hold((bnn, bnt, btt), new, fb, CLOSED, cnb, ctb):
        ta = -(cta + xtn * nb + xtt * tb) / att
        na = -(cna + ant * ta + xnn * nb + xnt * tb) / ann
        if b != STICK and na >= 0.0 and abs(ta) <= fa * na * (1.0 + CANCELLED):
            yield b, na, ta, nb, tb


def both_slide(mobility: Mobility, cna: float, cnb: float) -> Iterator[Try]:
    """Both contacts slip."""
    (ann, ant, _), (bnn, bnt, _), (xnn, xnt, xtn, _), (fa, fb), _, _ = mobility
    for a, ray_a in ((PLUS, -fa), (MINUS, fa)):
        for b, ray_b in ((PLUS, -fb), (MINUS, fb)):
            aa, ab = ann + ray_a * ant, xnn + ray_b * xnt
            ba, bb = xnn + ray_a * xtn, bnn + ray_b * bnt
            size = aa * bb - ab * ba
            na, nb = ab * cnb - bb * cna, ba * cna - aa * cnb
            if abs(size) > CANCELLED * (abs(aa * bb) + abs(ab * ba)) and na * size >= 0.0 and nb * size >= 0.0:
                yield a, b, na / size, ray_a * na / size, nb / size, ray_b * nb / size
