"""One impact, from the numbers of a body to the numbers of its outcome: what one body and many have in common.

It is law code (see `pair`), so that `solve_impact` and the compiled `solve_impacts` answer the same to the last bit.
"""

from __future__ import annotations

from math import inf, sqrt

from . import path_law, total_law
from .pair import NO_SOLUTION, Impact, Pair, Problem
from .problem import problem_of, twist_after
from .types import Contact, Flag, Mode, Twist, Validity

PATH, TOTAL = 0, 1
"""The laws."""

STAYS = 1e-10
"""A contact velocity below this part of the contact speeds before the impact is zero for the mode."""

ENERGY_ROUNDING = 1e-12
"""Work of the contacts below this part of mass times the contact speeds squared is rounding."""

NO_IMPACT, STOP, SLIDE, PIVOT_SLIDE, PIVOT, BACK_PIVOT, FLIGHT = (int(mode) for mode in Mode)

OLD_RESTITUTION_IGNORED, BOTH_STRUCK, LAST_RESORT, ENERGY_GAINED, INVALID_INPUT, THIN_BODY, SLOW_IMPACT = (
    int(flag)
    for flag in (
        Flag.OLD_RESTITUTION_IGNORED,
        Flag.BOTH_STRUCK,
        Flag.LAST_RESORT,
        Flag.ENERGY_GAINED,
        Flag.INVALID_INPUT,
        Flag.THIN_BODY,
        Flag.SLOW_IMPACT,
    )
)

VALIDITY = Validity()
SQRT_3 = sqrt(3.0)

Answer = tuple[int, tuple[float, float, float], float, float, float, float, int, int, float, bool, int]
"""Mode; twist after; N_A, T_A, N_B, T_B in N s; the contact states as a law codes them; the bits of `Flag`; energy
lost; whether the law allows no other answer; the law that answered."""


def answer(
    mass: float,
    inertia: float,
    stands: bool,
    old: Contact,
    new: Contact,
    twist: Twist,
    law: int,
    validity: Validity = VALIDITY,
) -> Answer:
    """What the impact at `new` does to a body that stands on `old`, or on nothing."""
    valid, problem, frame = problem_of(mass, inertia, stands, old, new, twist)
    if not valid:
        return unchanged(twist, INVALID_INPUT, law)
    _, restitution_old, _, cna, cta, cnb, ctb, _, _ = problem
    if cnb >= 0.0 and cna >= 0.0:
        return unchanged(twist, 0, law)

    notes = OLD_RESTITUTION_IGNORED if restitution_old > 0.0 and cna >= 0.0 else 0
    if law == PATH and cna < 0.0:
        law, notes = TOTAL, notes | BOTH_STRUCK
    impact = path_law.solve(problem, 0) if law == PATH else total_law.solve(problem, 0)
    if impact[12] & NO_SOLUTION:
        law, notes, problem = TOTAL, notes | LAST_RESORT, without_restitution(problem)
        impact = total_law.solve(problem, 0)
        if impact[12] & NO_SOLUTION:
            return unchanged(twist, notes - LAST_RESORT | NO_SOLUTION, law)
    unique = True
    if impact[13] > 1:
        impact, unique = nearest(problem, law, impact)

    na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, flags, _ = impact
    after = twist_after(twist, frame, dx, dy, dq)
    speed = speed_of(problem)
    work = nb * (cnb + vnb) + tb * (ctb + vtb)
    if stands:
        work += na * (cna + vna) + ta * (cta + vta)
    if work > ENERGY_ROUNDING * speed * speed:
        notes |= ENERGY_GAINED
    energy_lost = -0.5 * mass * work
    notes |= doubts(problem[0], stands, nb, validity)
    na, ta, nb, tb = mass * na, mass * ta, mass * nb, mass * tb
    # Numbers too large make one of these not finite, and with it their sum.
    if (after[0] + after[1] + after[2] + na + ta + nb + tb + energy_lost) * 0.0 != 0.0:
        return unchanged(twist, notes | NO_SOLUTION, law)
    mode = mode_of(STAYS * speed, vna, vta, vnb, vtb)
    return mode, after, na, ta, nb, tb, segments, flags | notes, energy_lost, unique, law


def doubts(pair: Pair, stands: bool, nb: float, validity: Validity) -> int:
    """The notes on an impact of `nb` N s per kg at the new contact for which rigid theory is too simple."""
    slenderness, gravity, contact_time, gravity_share = validity
    _, _, _, depth_old, _, depth_new, _, _ = pair  # of the contacts below the mass centre, over rho
    thin = SQRT_3 * slenderness
    notes = 0
    if stands and -thin < depth_old < thin and -thin < depth_new < thin:
        notes |= THIN_BODY
    if gravity_share * nb < gravity * contact_time:
        notes |= SLOW_IMPACT
    return notes


def unchanged(twist: Twist, notes: int, law: int) -> Answer:
    """The answer where no impact changes the twist; a twist that is no number becomes rest."""
    vx, vy, omega = twist
    kept = (vx, vy, omega) if abs(vx) + abs(vy) + abs(omega) < inf else (0.0, 0.0, 0.0)
    return NO_IMPACT, kept, 0.0, 0.0, 0.0, 0.0, 0, notes, 0.0, True, law


def without_restitution(problem: Problem) -> Problem:
    pair, _, _, cna, cta, cnb, ctb, zero_a, zero_b = problem
    return pair, 0.0, 0.0, cna, cta, cnb, ctb, zero_a, zero_b


def speed_of(problem: Problem) -> float:
    """The sum of the contact speeds before the impact."""
    _, _, _, cna, cta, cnb, ctb, _, _ = problem
    speed = abs(cnb) + abs(ctb)
    return speed + abs(cna) + abs(cta) if cna < inf else speed


def nearest(problem: Problem, law: int, first: Impact) -> tuple[Impact, bool]:
    """The one to take of several answers of a law, and whether they are one within rounding.

    Of several total solutions it is the one nearest to the end of the impulse path, which an impact reaches from its
    beginning; of several paths the first.
    """
    best, end, unique = first, first, True
    if law == TOTAL and problem[3] >= 0.0:
        path = path_law.solve(problem, 0)
        if not path[12] & NO_SOLUTION:
            end = path
    least = distance(first, end)
    for choice in range(1, first[13]):
        other = path_law.solve(problem, choice) if law == PATH else total_law.solve(problem, choice)
        if not other[12] & NO_SOLUTION and differ(other, first):
            unique = False
            if distance(other, end) < least:
                least, best = distance(other, end), other
    return best, unique


def distance(one: Impact, other: Impact) -> float:
    """How differently two answers change the twist."""
    return abs(one[8] - other[8]) + abs(one[9] - other[9]) + abs(one[10] - other[10])


def differ(one: Impact, other: Impact) -> bool:
    """Whether two answers change the twist differently, beyond rounding."""
    scale = abs(one[8]) + abs(one[9]) + abs(one[10]) + abs(other[8]) + abs(other[9]) + abs(other[10])
    return distance(one, other) > STAYS * scale


def mode_of(zero: float, vna: float, vta: float, vnb: float, vtb: float) -> int:
    """The mode from the contact velocities after the impact, which are zero up to `zero`."""
    if vna <= zero:
        if vnb > zero:
            return BACK_PIVOT
        return STOP if abs(vta) <= zero and abs(vtb) <= zero else SLIDE
    if vnb > zero:
        return FLIGHT
    return PIVOT if abs(vtb) <= zero else PIVOT_SLIDE
