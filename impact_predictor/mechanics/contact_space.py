"""One impact of any mechanism on two contacts, known by what its contacts do: `solve`.

A planar body is better served by `solve_impact`, which knows more about it than its W says.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import copysign, frexp, inf, isfinite, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .impact.answer import INVALID_INPUT, NOTHING, STAYS, mode_of, respond, speed_of
from .impact.contacts import CANCELLED, NO_SOLUTION, ContactRows, Impact, NewRows, OldRows, Problem, Velocities
from .impact.solve import MODES, NAMES, flags_of, number_of, others, states_of
from .types import Flag, Mode, Vector

SPEED_ROUNDING = 1e-12
"""A contact velocity below this part of the largest one is rounding and counts as zero."""

ASYMMETRY = 1e-9
"""How far W may be from symmetric, and its pivots below 0, as a part of its diagonal."""


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
    impulses: tuple[Vector, Vector] = ((0.0, 0.0), (0.0, 0.0))
    segments: tuple[str, ...] = ()
    flags: Flag = Flag.NONE
    energy_lost: float = 0.0
    unique: bool = True
    alternatives: tuple[ContactAlternative, ...] = ()
    law: str = "path"


def solve(
    W: ArrayLike,
    c: Iterable[float],
    friction: Vector,
    restitution: Vector = (0.0, 0.0),
    law: str = "path",
    rule: str = "poisson",
) -> ContactOutcome:
    """What the impact at the new contact B does to a mechanism that stands on the old one, A.

    `W` (4, 4) = G M^-1 G^T in 1/kg, symmetric and positive semidefinite, of any rank; `c` (4,) = G v less the
    supports' velocities in m/s before the impact; both in the order n_A, t_A, n_B, t_B, normals out of the supports.
    `friction` and `restitution` are those of A and B. `law` is "path" or "total" and `rule`, that of the restitution,
    "poisson" or "energetic", as in `solve_impact`. Where there is no old contact c_nA is inf and what belongs to A is
    not read. The generalized velocities change by M^-1 G^T P with P the four impulses.

    A contact velocity below 1e-12 of the largest counts as zero: make one zero yourself that is the sum of far larger
    terms. The velocities after keep the digits that W has: their error is about 1e-15 of the largest velocity, times
    the condition number of W on its range, its diagonal scaled to 1; and 1e-15 of the terms of W P, which are large
    where friction all but jams. Where W, of rank 3, leaves open how two sticking contacts share their impulses, they
    have the least of them (Flag.SHARED_FRICTION); of a lower rank, some of them.

    Numbers that no mechanism can have give Flag.INVALID_INPUT, never an exception; an unknown law or rule and a W of
    another shape raise ValueError. Source: the paper, sections 2 to 4, generalised.
    """
    number = number_of(law, rule)
    w = np.asarray(W, dtype=float)
    if w.shape != (4, 4):
        raise ValueError(f"W has the shape {w.shape}; give (4, 4)")
    cna, cta, cnb, ctb = map(float, c)
    before = cna, cta, cnb, ctb
    read = reading_of(w.tolist(), before, friction, restitution)
    if read is None:
        return unchanged(before, law, INVALID_INPUT)
    _, impact, notes, work, _, used = respond(read.problem, number)
    if impact == NOTHING:
        return unchanged(before, NAMES[used], notes)
    first = alternative(impact, read)
    na, ta, nb, tb, _, _, _, _, _, _, _, _, _, _ = impact
    push = read.mass * read.speed
    impulses = (na * push, ta * push), (nb * push, tb * push)
    energy_lost = -0.5 * work * push * read.speed
    if not all(map(isfinite, (energy_lost, *first.velocities[1:], *impulses[0], *impulses[1]))):
        return unchanged(before, NAMES[used], notes | NO_SOLUTION)
    found = [alternative(other, read) for other in others(read.problem, used, notes)]
    found = [other for other in found if all(map(isfinite, other.velocities[1:]))]
    return ContactOutcome(
        mode=first.mode,
        velocities=first.velocities,
        impulses=impulses,
        segments=first.segments,
        flags=flags_of(notes),
        energy_lost=energy_lost,
        unique=not found,
        alternatives=tuple(found),
        law=NAMES[used],
    )


class Reading(NamedTuple):
    """What the laws are asked, in units that make W and c about 1; the mass and the speed that are these units, powers
    of two, which cost no digit.
    """

    problem: Problem
    mass: float
    speed: float


def reading_of(w: list[list[float]], c: Velocities, friction: Vector, restitution: Vector) -> Reading | None:
    """What the laws are asked; None where a number is not in its range."""
    fa, fb = map(float, friction)
    ea, eb = map(float, restitution)
    cna, cta, cnb, ctb = c
    stands = cna != inf
    if not stands:
        cna = cta = fa = ea = 0.0
        w = [[0.0] * 4, [0.0] * 4, [0.0, 0.0, *w[2][2:]], [0.0, 0.0, *w[3][2:]]]
    in_range = 0.0 <= fa < inf and 0.0 <= fb < inf and 0.0 <= ea <= 1.0 and 0.0 <= eb <= 1.0
    if not (in_range and isfinite(cna + cta + cnb + ctb + sum(map(sum, w)))):
        return None
    largest = max(abs(cna), abs(cta), abs(cnb), abs(ctb))
    speed, mass = power_of_two(largest), 1.0 / power_of_two(max(w[0][0], w[1][1], w[2][2], w[3][3]))
    rows = rows_of([[number * mass for number in row] for row in w])
    if rows is None:
        return None
    zero = SPEED_ROUNDING * largest
    cna, cta, cnb, ctb = (0.0 if abs(part) <= zero else part / speed for part in (cna, cta, cnb, ctb))
    zero /= speed
    before = cna if stands else inf, cta, cnb, ctb
    problem = contacts_of(*rows, fa=fa, fb=fb), (ea, eb), before, (zero, zero, zero, zero)
    return Reading(problem=problem, mass=mass, speed=speed)


def power_of_two(number: float) -> float:
    """The power of two next to a number, within a range in which it has an inverse."""
    return 2.0 ** max(-1000, min(1000, frexp(number)[1]))


def rows_of(w: list[list[float]]) -> tuple[list[float], list[float], list[float], list[float]] | None:
    """Four rows whose products are W, by elimination of its largest pivots (Cholesky).

    None where W is not symmetric and positive semidefinite up to rounding.
    """
    for i in range(4):
        for j in range(i):
            if w[i][j] != w[j][i] and abs(w[i][j] - w[j][i]) > ASYMMETRY * sqrt(abs(w[i][i] * w[j][j])):
                return None
    rest, left, rows = [row[:] for row in w], [0, 1, 2, 3], [[0.0] * 4 for _ in range(4)]
    for column in range(4):
        i, most = left[0], 0.0
        for j in left:
            if rest[j][j] > most * w[j][j]:
                i, most = j, rest[j][j] / w[j][j]
        if most <= CANCELLED:
            break
        left.remove(i)
        pivot = sqrt(rest[i][i])
        rows[i][column] = pivot
        for j in left:
            rows[j][column] = rest[i][j] / pivot
        for j in left:
            for k in left:
                rest[j][k] -= rows[j][column] * rows[k][column]
    if any(abs(rest[i][j]) > ASYMMETRY * sqrt(abs(w[i][i] * w[j][j])) for i in left for j in left):
        return None
    first, second, third, fourth = rows
    return first, second, third, fourth


def contacts_of(
    na: list[float], ta: list[float], nb: list[float], tb: list[float], fa: float, fb: float
) -> ContactRows:
    """The contacts of a mechanism by the rows of its W, turned so that they are of the form that the laws know.

    The rows of A are given as much of the third component as their product needs. The first two axes are in their
    plane; the next one is where a row of B leaves it, and `extra` what B's normal has besides.
    """
    ann, att, bnn, btt = (dot(row, row) for row in (na, ta, nb, tb))
    axes = [axis for axis in (beyond(na, []),) if axis is not None]
    second = beyond(ta, axes)
    regular = bool(axes) and second is not None
    if second is not None:
        axes.append(second)
    for row in (tb, nb):
        axis = beyond(row, axes)
        if axis is not None:
            axes.append(axis)
    axes += [[0.0] * 4] * (4 - len(axes))
    a1, a2, _, _ = (dot(ta, axis) for axis in axes)
    n1, n2, n3, n4 = (dot(nb, axis) for axis in axes)
    t1, t2, t3, _ = (dot(tb, axis) for axis in axes)
    if regular:
        size, share = sqrt(ann) * a2, min(abs(a1) / sqrt(att), 1.0)
        free = a2 * a2 / (att * (1.0 + share))  # 1 - share
        an, at, qa, sa = sqrt(ann * free), sqrt(att * free), sqrt(ann * share), copysign(sqrt(att * share), a1)
        normal = an * sa / size, at * qa / size, -an * at / size
        first = 0.0, an / sqrt(ann), qa / sqrt(ann)
        turned = list(zip(first, crossed(normal, first), normal, strict=True))
        nx, ny, nq = [n1 * u + n2 * v + n3 * w for u, v, w in turned]
        tx, ty, tq = [t1 * u + t2 * v + t3 * w for u, v, w in turned]
        extra = n4 * n4
    else:
        # A moves in one direction at most: the third one.
        an = at = size = extra = 0.0
        qa, sa = sqrt(ann), copysign(sqrt(att), a1)
        if not ann + att > 0.0:
            n1, n2, n3, t1, t2, t3 = 0.0, n1, n2, 0.0, t1, t2
        nx, ny, nq, tx, ty, tq = n2, n3, n1, t2, t3, t1
    turn_x, turn_y, turn_q = crossed((nx, ny, nq), (tx, ty, tq))
    new_size = turn_x * turn_x + turn_y * turn_y + turn_q * turn_q
    if new_size <= CANCELLED * bnn * btt:
        new_size = 0.0
    minors = n3 * size, t3 * size, an * turn_y + qa * turn_q, at * turn_x + sa * turn_q
    if regular and n3 == 0.0 and t3 == 0.0:
        minors = 0.0, 0.0, 0.0, 0.0
    old: OldRows = an, at, qa, sa, fa
    new: NewRows = nx, ny, nq, tx, ty, tq, extra, fb
    plane = nx * nx + ny * ny, nx * tx + ny * ty, tx * tx + ty * ty, new_size
    return old, new, plane, minors, CANCELLED


def beyond(row: list[float], axes: list[list[float]]) -> list[float] | None:
    """The unit vector along what a row has besides the axes, or None where that is rounding."""
    rest = row
    for _ in range(2):  # the second time for the roundings of the first
        for axis in axes:
            part = dot(rest, axis)
            rest = [number - part * other for number, other in zip(rest, axis, strict=True)]
    square = dot(rest, rest)
    if square <= CANCELLED * dot(row, row):
        return None
    size = sqrt(square)
    return [number / size for number in rest]


def dot(one: list[float], other: list[float]) -> float:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2] + one[3] * other[3]


def crossed(one: tuple[float, float, float], other: tuple[float, float, float]) -> tuple[float, float, float]:
    (ux, uy, uq), (vx, vy, vq) = one, other
    return uy * vq - uq * vy, uq * vx - ux * vq, ux * vy - uy * vx


def unchanged(c: Velocities, law: str, notes: int) -> ContactOutcome:
    """The outcome where no impact changes the contact velocities; those that are no numbers become 0."""
    kept = [speed if isfinite(speed) else 0.0 for speed in c]
    cna, cta, cnb, ctb = c[0] if c[0] == inf else kept[0], *kept[1:]
    return ContactOutcome(mode=Mode.NO_IMPACT, velocities=(cna, cta, cnb, ctb), flags=flags_of(notes), law=law)


def alternative(impact: Impact, read: Reading) -> ContactAlternative:
    _, _, _, _, vna, vta, vnb, vtb, _, _, _, segments, _, _ = impact
    speed = read.speed
    mode = MODES[mode_of(STAYS * speed_of(read.problem), vna, vta, vnb, vtb)]
    velocities = vna * speed, vta * speed, vnb * speed, vtb * speed
    return ContactAlternative(mode=mode, velocities=velocities, segments=states_of(segments))
