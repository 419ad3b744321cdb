"""Contact states that Coulomb's law allows at one instant of the impulse path."""

from __future__ import annotations

from .pair import (
    MINUS,
    OPEN,
    PLUS,
    ROUNDING,
    STICK,
    Pair,
    Rates,
    open_rates,
    rolling_rates,
    slide_rates,
    slide_stick_rates,
    state_alone,
    stick_rates,
    wedged_rates,
)

States = tuple[int, int, int, Rates]
"""How many pairs of states are consistent; the chosen states of A and B; their rates."""


def choose(pair: Pair, cna: float, cta: float, ctb: float, compressing: bool, choice: int) -> States:
    """The `choice`-th consistent pair of states in the order O S + -, A before B.

    While B slips its friction is given, and A meets a load as a single contact does. A load that lifts A opens it,
    unless friction can press A down all the same. Under a load that presses A it has one answer: along the impulses
    that hold A down its slip grows with T_A, so that A sticks, or slips against the T_A that would make it stick.
    """
    _, _, qa, sa, qb, sb, fa, fb = pair
    b = state_alone(qb, sb, fb, ctb)
    best = open_rates(pair, b, cna)
    if cna > 0.0:
        return 1, OPEN, b, best
    if ctb == 0.0:
        if cta == 0.0:
            return at_rest(pair, b, best, compressing, choice)
        return while_old_slides(pair, b, best, cta, compressing, choice)
    if best[0]:
        if fa * abs(qa * sa) < 1.0 + qa * qa:
            return 1, OPEN, b, best
        return try_all(pair, False, b, best, cta, ctb, compressing, choice)
    if cta == 0.0:
        best = stick_rates(pair, b, ctb)
        a = STICK if best[0] else MINUS if best[2] > 0.0 else PLUS
    else:
        a = PLUS if cta > 0.0 else MINUS
    if a != STICK:
        best = slide_rates(pair, a, b, cta, ctb)
    found = best[0] and (best[6] > 0.0 or goes_on(best, a, b, cta, ctb, compressing))
    return 1 if found else 0, a, b, best


def at_rest(pair: Pair, b: int, best: Rates, compressing: bool, choice: int) -> States:
    """As `choose`, where neither contact slips; `best` are the rates if A opens, with B in state `b`.

    If B's tangent passes through A, both stick or none does. On one flat floor they have one answer.
    """
    cos, sin, qa, sa, qb, sb, _, _ = pair
    arm = sa * cos + qa * sin - sb
    tied = arm == 0.0 or abs(arm) <= ROUNDING * (abs(sa * cos) + abs(qa * sin) + abs(sb))
    if not (tied and sin == 0.0 and cos > 0.0 and qb > qa):
        return try_all(pair, tied, b, best, 0.0, 0.0, compressing, choice)
    if best[0]:
        return 1, OPEN, b, best
    rate = rolling_rates(pair)
    if rate[0]:
        return 1, STICK, STICK, rate
    a = MINUS if rate[2] > 0.0 else PLUS
    rate = slide_rates(pair, a, a, 0.0, 0.0)
    if not rate[0]:
        a = PLUS + MINUS - a
        rate = slide_rates(pair, a, a, 0.0, 0.0)
    return 1 if rate[0] else 0, a, a, rate


def while_old_slides(pair: Pair, b: int, best: Rates, cta: float, compressing: bool, choice: int) -> States:
    """As `choose`, where A slips and B does not; `best` are the rates if A opens, with B in state `b`.

    c_nA and c_tB answer N_A and T_B linearly. If that 2 x 2 matrix has positive principal minors (a P-matrix), there
    is one answer.
    """
    cos, sin, qa, sa, _, sb, fa, _ = pair
    a = PLUS if cta > 0.0 else MINUS
    ax = -fa if cta > 0.0 else fa
    aq = qa + ax * sa
    normal = 1.0 + qa * aq
    minor = normal * (1.0 + sb * sb) - (sin + sb * qa) * (cos * ax + sin + sb * aq)
    one_answer = normal > 0.0 and minor > 0.0
    best_a, best_b, found = OPEN, b, 1 if best[0] else 0
    for b in (STICK, PLUS, MINUS):
        if one_answer and found:
            break
        candidate = slide_stick_rates(pair, a, cta) if b == STICK else slide_rates(pair, a, b, cta, 0.0)
        if candidate[0] and (candidate[6] > 0.0 or goes_on(candidate, a, b, cta, 0.0, compressing)):
            if found <= choice:
                best_a, best_b, best = a, b, candidate
            found += 1
    return found, best_a, best_b, best


def try_all(
    pair: Pair, tied: bool, b: int, best: Rates, cta: float, ctb: float, compressing: bool, choice: int
) -> States:
    """As `choose`, by trial of all states of two closed contacts; `best` are the rates if A opens, with B in state `b`.

    `tied` says that both stick or none does.
    """
    best_a, best_b, found = OPEN, b, 1 if best[0] else 0
    first_a, last_a = (STICK, MINUS) if cta == 0.0 else (PLUS, PLUS) if cta > 0.0 else (MINUS, MINUS)
    first_b, last_b = (STICK, MINUS) if ctb == 0.0 else (b, b)
    for a in range(first_a, last_a + 1):
        for b in range(first_b, last_b + 1):
            if tied and (a == STICK) != (b == STICK):
                continue
            if a > STICK and b > STICK:
                candidate = slide_rates(pair, a, b, cta, ctb)
            elif b > STICK:
                candidate = stick_rates(pair, b, ctb)
            elif a > STICK:
                candidate = slide_stick_rates(pair, a, cta)
            else:
                candidate = rolling_rates(pair) if tied else wedged_rates(pair)
            if candidate[0] and (candidate[6] > 0.0 or goes_on(candidate, a, b, cta, ctb, compressing)):
                if found <= choice:
                    best_a, best_b, best = a, b, candidate
                found += 1
    return found, best_a, best_b, best


def goes_on(rate: Rates, a: int, b: int, cta: float, ctb: float, compressing: bool) -> bool:
    """Whether rates of closed contacts that do not slow down the approach of B end: when a slip comes to zero.

    While B expands they always do, with its impulse.
    """
    return not compressing or (a >= PLUS and cta * rate[5] < 0.0) or (b >= PLUS and ctb * rate[7] < 0.0)
