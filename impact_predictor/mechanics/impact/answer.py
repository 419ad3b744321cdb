"""The answer of the laws to one impact, in contact space, and that of a planar body: what one and many have in common.

Law code (see `contacts`), so that `solve_impact` and the compiled `solve_impacts` answer the same to the last bit.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Final

from ..types import Contact, Flag, Mode, Twist, Validity
from . import path_law, total_law
from .contacts import NO_SOLUTION, ROUNDING, ContactRows, Impact, Problem, problem_of, twist_after

PATH: Final = 0
TOTAL: Final = 1
ENERGETIC_PATH: Final = 2
"""The laws: the path law with Poisson's restitution, the total law, and the path law with energetic restitution."""

STAYS: Final = 1e-10
"""A contact velocity below this part of the contact speeds before the impact is zero for the mode."""

ENERGY_ROUNDING: Final = 1e-12
"""Work of the contacts below this part of mass times the contact speeds squared is rounding."""

NO_IMPACT: Final = int(Mode.NO_IMPACT)
STOP: Final = int(Mode.STOP)
SLIDE: Final = int(Mode.SLIDE)
PIVOT_SLIDE: Final = int(Mode.PIVOT_SLIDE)
PIVOT: Final = int(Mode.PIVOT)
BACK_PIVOT: Final = int(Mode.BACK_PIVOT)
FLIGHT: Final = int(Mode.FLIGHT)

OLD_RESTITUTION_IGNORED: Final = int(Flag.OLD_RESTITUTION_IGNORED)
BOTH_STRUCK: Final = int(Flag.BOTH_STRUCK)
LAST_RESORT: Final = int(Flag.LAST_RESORT)
ENERGY_GAINED: Final = int(Flag.ENERGY_GAINED)
INVALID_INPUT: Final = int(Flag.INVALID_INPUT)
THIN_BODY: Final = int(Flag.THIN_BODY)
SLOW_IMPACT: Final = int(Flag.SLOW_IMPACT)

VALIDITY: Final = Validity()
SQRT_3: Final = sqrt(3.0)

Reaction = tuple[int, Impact, int, float, bool, int]
"""Mode; what the law says; the bits of `Flag`; work of the contacts on a body of unit mass, times 2; whether the law
allows no other answer; the law that answered."""

BodyAnswer = tuple[int, tuple[float, float, float], float, float, float, float, int, int, float, bool, int]
"""Mode; twist after; N_A, T_A, N_B, T_B in N s; the contact states as a law codes them; the bits of `Flag`; energy
lost; whether the law allows no other answer; the law that answered."""

NOTHING: Impact = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0, 0)


def follow(problem: Problem, law: int, choice: int) -> Impact:
    """The answer of a law, the one of number `choice` where it allows several."""
    if law == TOTAL:
        return total_law.solve(problem, choice)
    return path_law.solve(problem, choice, law == ENERGETIC_PATH)


def respond(problem: Problem, law: int) -> Reaction:
    """What an impact does in contact space. Where there is none, or no law has an answer, nothing (NO_IMPACT)."""
    contacts, (restitution_old, restitution), (cna, cta, cnb, ctb), zero = problem
    if cnb >= 0.0 and cna >= 0.0:
        return NO_IMPACT, NOTHING, 0, 0.0, True, law
    notes = OLD_RESTITUTION_IGNORED if restitution_old > 0.0 and cna >= 0.0 else 0
    if law != TOTAL and cna < 0.0:
        law, notes = TOTAL, notes | BOTH_STRUCK
    impact = follow(problem, law, 0)
    na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, flags, choices = impact
    if flags & NO_SOLUTION:
        law, notes, problem = TOTAL, notes | LAST_RESORT, without_restitution(problem)
        impact = total_law.solve(problem, 0)
        na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, flags, choices = impact
        if flags & NO_SOLUTION:
            return NO_IMPACT, NOTHING, notes - LAST_RESORT | NO_SOLUTION, 0.0, True, law
    unique = True
    if choices > 1:
        impact, unique = nearest(problem, law, impact)
        na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, flags, choices = impact

    speed = speed_of(problem)
    work = nb * (cnb + vnb) + tb * (ctb + vtb)
    if cna < inf:
        work += na * (cna + vna) + ta * (cta + vta)
    if work > ENERGY_ROUNDING * speed * speed:
        notes |= ENERGY_GAINED
    return mode_of(STAYS * speed, vna, vta, vnb, vtb), impact, flags | notes, work, unique, law


def answer(
    mass: float,
    inertia: float,
    stands: bool,
    old: Contact,
    new: Contact,
    twist: Twist,
    law: int,
    validity: Validity = VALIDITY,
) -> BodyAnswer:
    """What the impact at `new` does to a planar body that stands on `old`, or on nothing."""
    valid, problem, frame = problem_of(mass, inertia, stands, old, new, twist)
    if not valid:
        return unchanged(twist, INVALID_INPUT, law)
    mode, impact, notes, work, unique, law = respond(problem, law)
    if mode == NO_IMPACT:
        return unchanged(twist, notes, law)
    na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, flags, choices = impact
    after = twist_after(twist, frame, dx, dy, dq)
    energy_lost = -0.5 * mass * work
    contacts, restitutions, before, zero = problem
    notes |= doubts(contacts, stands, nb, validity)
    na, ta, nb, tb = mass * na, mass * ta, mass * nb, mass * tb
    # Numbers too large make one of these not finite, and with it their sum.
    if (after[0] + after[1] + after[2] + na + ta + nb + tb + energy_lost) * 0.0 != 0.0:
        return unchanged(twist, notes | NO_SOLUTION, law)
    return mode, after, na, ta, nb, tb, segments, notes, energy_lost, unique, law


def doubts(contacts: ContactRows, stands: bool, nb: float, validity: Validity) -> int:
    """The notes on an impact of `nb` N s per kg at the new contact for which rigid theory is too simple."""
    slenderness, gravity, contact_time, gravity_share = validity
    # the depths of the contacts below the mass centre, over rho
    (an, at, qa, depth_old, fa), (nx, ny, nq, tx, ty, depth_new, extra, fb), plane, minors, rounding = contacts
    thin = SQRT_3 * slenderness
    notes = 0
    if stands and -thin < depth_old < thin and -thin < depth_new < thin:
        notes |= THIN_BODY
    if is_slow(nb, validity):
        notes |= SLOW_IMPACT
    return notes


def is_slow(nb: float, validity: Validity) -> bool:
    """Whether gravity matters during an impact of `nb` N s per kg at the new contact (see `Validity`)."""
    slenderness, gravity, contact_time, gravity_share = validity
    return gravity_share * nb < gravity * contact_time


def unchanged(twist: Twist, notes: int, law: int) -> BodyAnswer:
    """The answer where no impact changes the twist; a twist that is no number becomes rest."""
    vx, vy, omega = twist
    kept = (vx, vy, omega) if abs(vx) + abs(vy) + abs(omega) < inf else (0.0, 0.0, 0.0)
    return NO_IMPACT, kept, 0.0, 0.0, 0.0, 0.0, 0, notes, 0.0, True, law


def without_restitution(problem: Problem) -> Problem:
    contacts, restitutions, before, zero = problem
    return contacts, (0.0, 0.0), before, zero


def speed_of(problem: Problem) -> float:
    """The sum of the contact speeds before the impact."""
    contacts, restitutions, (cna, cta, cnb, ctb), zero = problem
    speed = abs(cnb) + abs(ctb)
    return speed + abs(cna) + abs(cta) if cna < inf else speed


def nearest(problem: Problem, law: int, first: Impact) -> tuple[Impact, bool]:
    """The one to take of several answers of a law, and whether they are one within rounding.

    Of several total solutions it is the one nearest to the end of the impulse path, which an impact reaches from its
    beginning; of several paths the first.
    """
    contacts, restitutions, (cna, cta, cnb, ctb), zero = problem
    best, end, unique = first, first, True
    if law == TOTAL and cna >= 0.0:
        path = follow(problem, PATH, 0)
        if solved(path):
            end = path
    least = distance(first, end)
    na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, notes, choices = first
    for choice in range(1, choices):
        other = follow(problem, law, choice)
        if solved(other) and differ(problem, other, first):
            unique = False
            if distance(other, end) < least and differ(problem, other, best):
                least, best = distance(other, end), other
    return best, unique


def solved(impact: Impact) -> bool:
    """Whether a law has come to an end."""
    na, ta, nb, tb, vna, vta, vnb, vtb, dx, dy, dq, segments, notes, choices = impact
    return not notes & NO_SOLUTION


def distance(one: Impact, other: Impact) -> float:
    """How differently two answers change the twist."""
    na, ta, nb, tb, vna, vta, vnb, vtb, ux, uy, uq, segments, notes, choices = one
    na, ta, nb, tb, vna, vta, vnb, vtb, vx, vy, vq, segments, notes, choices = other
    return abs(ux - vx) + abs(uy - vy) + abs(uq - vq)


def differ(problem: Problem, one: Impact, other: Impact) -> bool:
    """Whether two answers change the twist differently, beyond rounding; of a W, whose digits may not tell, whether the
    contact velocities differ.
    """
    na, ta, nb, tb, una, uta, unb, utb, ux, uy, uq, segments, notes, choices = one
    na, ta, nb, tb, vna, vta, vnb, vtb, vx, vy, vq, segments, notes, choices = other
    (old, new, plane, minors, rounding), restitutions, before, zero = problem
    if rounding == ROUNDING:
        return distance(one, other) > STAYS * (abs(ux) + abs(uy) + abs(uq) + abs(vx) + abs(vy) + abs(vq))
    apart = max(abs(uta - vta), abs(unb - vnb), abs(utb - vtb))
    if una < inf:
        apart = max(apart, abs(una - vna))
    return apart > STAYS * speed_of(problem)


def mode_of(zero: float, vna: float, vta: float, vnb: float, vtb: float) -> int:
    """The mode from the contact velocities after the impact, which are zero up to `zero`."""
    if vna <= zero:
        if vnb > zero:
            return BACK_PIVOT
        return STOP if abs(vta) <= zero and abs(vtb) <= zero else SLIDE
    if vnb > zero:
        return FLIGHT
    return PIVOT if abs(vtb) <= zero else PIVOT_SLIDE
