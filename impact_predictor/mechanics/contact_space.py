"""One impact of any mechanism on two contacts, known by what its contacts do: `solve`.

A planar body is better served by `solve_impact`, which knows more about it than its W says.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import frexp, inf, isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .answer import (
    BOTH_STRUCK,
    ENERGY_GAINED,
    ENERGY_ROUNDING,
    INVALID_INPUT,
    LAST_RESORT,
    OLD_RESTITUTION_IGNORED,
    PATH,
    STAYS,
    TOTAL,
    mode_of,
)
from .impact import LAWS, MODES, flags_of, number_of, states_of
from .mobility import NO_MOBILITY, choose, least_push, mobility_of, strike_old
from .mobility_total import Problem, Velocities, differ, solutions
from .pair import NO_SOLUTION, SHARED_FRICTION, Impact
from .path_law import follow
from .types import Flag, Mode, Vector

SPEED_ROUNDING = 1e-12
"""A contact velocity below this part of the largest one is rounding and counts as zero."""


class ContactAlternative(NamedTuple):
    """Another answer that the law allows as well."""

    mode: Mode
    velocities: Velocities
    segments: tuple[str, ...]


class ContactOutcome(NamedTuple):
    """What an impact does to the contacts of a mechanism.

    `velocities` are c_nA, c_tA, c_nB, c_tB right after it in m/s; `impulses` as ((N_old, T_old), (N_new, T_new)) in
    N s; the rest is as in `Outcome`, the energy being that of the motion relative to the supports.
    """

    mode: Mode
    velocities: Velocities
    impulses: tuple[Vector, Vector]
    segments: tuple[str, ...]
    flags: Flag
    energy_lost: float
    unique: bool
    alternatives: tuple[ContactAlternative, ...]
    law: str


def solve(
    W: ArrayLike,
    c: Iterable[float],
    friction: Vector,
    restitution: Vector = (0.0, 0.0),
    law: str = "path",
) -> ContactOutcome:
    """What the impact at the new contact B does to a mechanism that stands on the old one, A.

    `W` (4, 4) = G M^-1 G^T in 1/kg, symmetric and positive semidefinite, of any rank; `c` (4,) = G v less the
    supports' velocities in m/s before the impact; both in the order n_A, t_A, n_B, t_B, normals out of the supports.
    `friction` and `restitution` are those of A and B. `law` is "path" or "total", as in `solve_impact`. Where there is
    no old contact c_nA is inf and what belongs to A is not read. The generalized velocities change by M^-1 G^T P with
    P the four impulses.

    A contact velocity below 1e-12 of the largest counts as zero: make one zero yourself that is the sum of far larger
    terms. The velocities after keep the digits that W has: their error is about 1e-15 of the largest velocity, times
    the condition number of W on its range, its diagonal scaled to 1; and 1e-15 of the terms of W P, which are large
    where friction all but jams. Where W leaves open how two sticking contacts share their impulses, they have the
    least of them (Flag.SHARED_FRICTION).

    Numbers that no mechanism can have give Flag.INVALID_INPUT, never an exception; an unknown law and a W of another
    shape raise ValueError. Source: the paper, sections 2 to 4, generalised.
    """
    number = number_of(law)
    w = np.asarray(W, dtype=float)
    if w.shape != (4, 4):
        raise ValueError(f"W has the shape {w.shape}; give (4, 4)")
    cna, cta, cnb, ctb = map(float, c)
    before = cna, cta, cnb, ctb
    valid, problem, mass, speed = read(w.tolist(), before, friction, restitution)
    if not valid:
        return unchanged(before, law, INVALID_INPUT)
    mobility, restitution_old, _, cna, cta, cnb, ctb, zero, _ = problem
    if cnb >= 0.0 and cna >= 0.0:
        return unchanged(before, law, 0)

    notes = OLD_RESTITUTION_IGNORED if restitution_old > 0.0 and cna >= 0.0 else 0
    if number == PATH and cna < 0.0:
        number, notes = TOTAL, notes | BOTH_STRUCK
    size = abs(cnb) + abs(ctb) + (abs(cna) + abs(cta) if cna < inf else 0.0)
    found = answers(problem, number, STAYS * size)
    if not found:
        number, notes = TOTAL, notes | LAST_RESORT
        found = answers((mobility, 0.0, 0.0, cna, cta, cnb, ctb, zero, zero), TOTAL, STAYS * size)
        if not found:
            return unchanged(before, LAWS[TOTAL], notes - LAST_RESORT | NO_SOLUTION)

    na, ta, nb, tb, vna, vta, vnb, vtb, _, _, _, _, flags, _ = found[0]
    work = nb * (cnb + vnb) + tb * (ctb + vtb)
    if cna < inf:
        work += na * (cna + vna) + ta * (cta + vta)
    if work > ENERGY_ROUNDING * size * size:
        notes |= ENERGY_GAINED
    if not mobility.lines:
        flags &= ~SHARED_FRICTION
    impulse = mass * speed
    energy_lost = -0.5 * work * impulse * speed
    first, *others = (alternative(impact, STAYS * size, speed) for impact in found)
    outcome = ContactOutcome(
        first.mode,
        first.velocities,
        ((na * impulse, ta * impulse), (nb * impulse, tb * impulse)),
        first.segments,
        flags_of(flags | notes),
        energy_lost,
        not others,
        tuple(others),
        LAWS[number],
    )
    numbers = energy_lost, *first.velocities[1:], *outcome.impulses[0], *outcome.impulses[1]
    return outcome if all(map(isfinite, numbers)) else unchanged(before, LAWS[number], notes | NO_SOLUTION)


Reading = tuple[bool, Problem, float, float]
"""Whether all numbers are in their range; what the laws are asked, in units that make W and c about 1; the mass and
the speed that are these units, powers of two, which cost no digit."""

NOT_VALID: Reading = (False, (NO_MOBILITY, 0.0, 0.0, inf, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0, 1.0)


def read(w: list[list[float]], c: Velocities, friction: Vector, restitution: Vector) -> Reading:
    fa, fb = map(float, friction)
    ea, eb = map(float, restitution)
    cna, cta, cnb, ctb = c
    stands = cna != inf
    if not stands:
        cna = cta = fa = ea = 0.0
        w = [[0.0] * 4, [0.0] * 4, [0.0, 0.0, *w[2][2:]], [0.0, 0.0, *w[3][2:]]]
    in_range = 0.0 <= fa < inf and 0.0 <= fb < inf and 0.0 <= ea <= 1.0 and 0.0 <= eb <= 1.0
    if not (in_range and isfinite(cna + cta + cnb + ctb + sum(map(sum, w)))):
        return NOT_VALID
    largest = max(abs(cna), abs(cta), abs(cnb), abs(ctb))
    speed, mass = power_of_two(largest), 1.0 / power_of_two(max(w[0][0], w[1][1], w[2][2], w[3][3]))
    valid, mobility = mobility_of([[number * mass for number in row] for row in w], (fa, fb))
    zero = SPEED_ROUNDING * largest
    cna, cta, cnb, ctb = (0.0 if abs(part) <= zero else part / speed for part in (cna, cta, cnb, ctb))
    zero /= speed
    return valid, (mobility, ea, eb, cna if stands else inf, cta, cnb, ctb, zero, zero), mass, speed


def power_of_two(number: float) -> float:
    """The power of two next to a number, within a range in which it has an inverse."""
    return 2.0 ** max(-1000, min(1000, frexp(number)[1]))


def answers(problem: Problem, law: int, zero: float) -> list[Impact]:
    """The answer of a law and those that it allows as well and that differ from it in a velocity by more than `zero`.

    Of several total solutions the one nearest to the end of the impulse path answers, which an impact reaches from its
    beginning.
    """
    if law == TOTAL:
        found = [impact for impact in solutions(problem) if is_answer(impact)]
        if len(found) > 1 and problem[3] >= 0.0:
            path = follow(choose, strike_old, least_push, problem, 0)
            if is_answer(path):
                found.sort(key=lambda impact: distance(impact, path))
        return found
    first = follow(choose, strike_old, least_push, problem, 0)
    found = [first] if is_answer(first) else []
    for choice in range(1, first[13] if found else 0):
        other = follow(choose, strike_old, least_push, problem, choice)
        if is_answer(other) and all(differ(other, impact, zero) for impact in found):
            found.append(other)
    return found


def is_answer(impact: Impact) -> bool:
    """Whether a law has come to an end, and with numbers that are finite."""
    return not impact[12] & NO_SOLUTION and isfinite(sum(impact[:4]) + sum(impact[5:8]))


def distance(one: Impact, other: Impact) -> float:
    """Twice the kinetic energy of the difference of two answers."""
    return sum((one[i] - other[i]) * (one[i + 4] - other[i + 4]) for i in range(4))


def unchanged(c: Velocities, law: str, notes: int) -> ContactOutcome:
    """The outcome where no impact changes the contact velocities; those that are no numbers become 0."""
    cna, cta, cnb, ctb = c
    kept = cna if cna == inf else finite(cna), finite(cta), finite(cnb), finite(ctb)
    return ContactOutcome(Mode.NO_IMPACT, kept, ((0.0, 0.0), (0.0, 0.0)), (), flags_of(notes), 0.0, True, (), law)


def finite(number: float) -> float:
    return number if isfinite(number) else 0.0


def alternative(impact: Impact, zero: float, speed: float) -> ContactAlternative:
    vna, vta, vnb, vtb = impact[4:8]
    velocities = vna * speed, vta * speed, vnb * speed, vtb * speed
    return ContactAlternative(MODES[mode_of(zero, vna, vta, vnb, vtb)], velocities, states_of(impact[11]))
