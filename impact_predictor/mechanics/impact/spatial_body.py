"""An impact of a rigid body, or of a mechanism, in three dimensions as its contacts see it, and back.

All is law code on flat sequences, as in `spatial_path`.

A problem is one flat sequence: mass; the inertia ixx, iyy, izz, ixy, ixz, iyz about the mass centre; the twist vx, vy,
vz, wx, wy, wz of the mass centre; then of each contact its position x, y, z from the mass centre, its normal, friction,
restitution, the velocity of its support, and its gap. An answer is the twist, the energy lost, and of each contact its
impulse, its velocity relative to the support, its state, all along the axes of the problem, and how fast an impulse
along the normal moves it there, over the impulse.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import TYPE_CHECKING, Final

from .spatial_path import WORK, solve

if TYPE_CHECKING:
    from ..compiled import Count, Floats, Ints

BODY: Final = 13
"""Numbers of a problem that come before its contacts."""

CONTACT: Final = 12
"""Numbers of each contact of a problem."""

ANSWER: Final = 7
"""Numbers of an answer that come before its contacts; each of them has `RESULT`."""

RESULT: Final = 8

INVALID: Final = 4
"""The flag of numbers that no body can have."""

LARGEST: Final = 1e100
SINGULAR: Final = 1e-21
"""An inertia about any axis counts as this part of the trace at least."""

SYMMETRY: Final = 1e-9

ROUNDING: Final = 1e-14
ROUNDED: Final = 0.01
"""By this part of its trace an inertia may miss the triangle inequality: thin plates are given with few digits."""


def is_valid(n: Count, problem: Floats) -> bool:
    """Whether a body can have these numbers: finite, with moments of inertia that a distribution of mass can have."""
    for j in range(BODY + n * CONTACT):
        if not -LARGEST <= problem[j] <= LARGEST:
            return False
    xx, yy, zz, xy, xz, yz = problem[1], problem[2], problem[3], problem[4], problem[5], problem[6]
    trace = xx + yy + zz
    if problem[0] <= 0.0 or trace <= 0.0:
        return False
    # Half the trace less the tensor is the matrix of the second moments of mass, which is positive semidefinite.
    half = (0.5 + ROUNDED) * trace
    ax, ay, az = half - xx, half - yy, half - zz
    small = -SYMMETRY * half
    if min(ax, ay, az) < small:
        return False
    if min(ax * ay - xy * xy, ax * az - xz * xz, ay * az - yz * yz) < small * half:
        return False
    whole = ax * (ay * az - yz * yz) - xy * (xy * az + yz * xz) - xz * (xy * yz + ay * xz)
    if whole < small * half * half or determinant(xx, yy, zz, xy, xz, yz) <= 1e-12 * half * half * half * SYMMETRY:
        return False
    for i in range(n):
        k = BODY + i * CONTACT
        size = problem[k + 3] ** 2 + problem[k + 4] ** 2 + problem[k + 5] ** 2
        if not (abs(size - 1.0) <= SYMMETRY and min(problem[k + 6], problem[k + 11]) >= 0.0):
            return False
        if not 0.0 <= problem[k + 7] <= 1.0:
            return False
    return True


def determinant(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> float:
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)


def room(n: Count, r: int) -> int:
    """Numbers that an impact of n contacts is worked with, where motion has r coordinates."""
    return 3 * n * r + (15 + WORK) * n + 2 * r


def strike_all(
    n: Count,
    problems: Sequence[Floats],
    total: bool,
    merge: float,
    threshold: float,
    steps: int,
    answers: Sequence[Floats],
    notes: Ints,
    work: Floats,
    marks: Ints,
) -> None:
    """Fill in the answers to problems of as many contacts each, and the flags of each: see `strike`."""
    for i in range(len(problems)):
        notes[i] = strike(n, problems[i], total, merge, threshold, steps, answers[i], work, marks)


def strike(
    n: Count,
    problem: Floats,
    total: bool,
    merge: float,
    threshold: float,
    steps: int,
    answer: Floats,
    work: Floats,
    marks: Ints,
) -> int:
    """Fill in the answer to a problem; its flags, as those of `spatial_path.solve`, and `INVALID`."""
    for j in range(ANSWER + RESULT * n):
        answer[j] = 0.0
    if not is_valid(n, problem):
        for j in range(6):
            answer[j] = problem[7 + j] if -LARGEST <= problem[7 + j] <= LARGEST else 0.0
        return INVALID
    m = 3 * n
    rows, start, o = work[0 : 6 * m], work[6 * m : 7 * m], 7 * m
    friction, restitution, gaps = work[o : o + n], work[o + n : o + 2 * n], work[o + 2 * n : o + 3 * n]
    c, impulse, v, rest = work[8 * m : 9 * m], work[9 * m : 10 * m], work[10 * m : 10 * m + 6], work[10 * m + 6 :]
    # With the inertia L L^T the rows are along coordinates in which twice the energy is the square of the motion.
    root = sqrt(problem[0])
    xx, yy, zz, xy, xz, yz = problem[1], problem[2], problem[3], problem[4], problem[5], problem[6]
    least = SINGULAR * (xx + yy + zz)
    lxx = sqrt(max(xx, least))
    lxy, lxz = xy / lxx, xz / lxx
    lyy = sqrt(max(yy - lxy * lxy, least))
    lyz = (yz - lxy * lxz) / lyy
    lzz = sqrt(max(zz - lxz * lxz - lyz * lyz, least))
    vx, vy, vz, wx, wy, wz = problem[7], problem[8], problem[9], problem[10], problem[11], problem[12]
    for i in range(n):
        k = BODY + i * CONTACT
        rx, ry, rz = problem[k], problem[k + 1], problem[k + 2]
        nx, ny, nz = problem[k + 3], problem[k + 4], problem[k + 5]
        friction[i], restitution[i], gaps[i] = problem[k + 6], problem[k + 7], problem[k + 11]
        # The tangents: t1 across the normal in the plane of x and z unless the normal is along y there.
        if abs(nx) + abs(nz) > 1e-3:
            size = sqrt(nx * nx + nz * nz)
            ax, ay, az = nz / size, 0.0, -nx / size
        else:
            size = sqrt(1.0 + nx / ny * (nx / ny))
            ax, ay, az = 1.0 / size, -nx / ny / size, 0.0
        bx, by, bz = ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax
        ux = vx + wy * rz - wz * ry - problem[k + 8]
        uy = vy + wz * rx - wx * rz - problem[k + 9]
        uz = vz + wx * ry - wy * rx - problem[k + 10]
        for t in range(3):
            dx, dy, dz = nx, ny, nz
            if t < 2:
                dx, dy, dz = (ax, ay, az) if t == 0 else (bx, by, bz)
            at = 6 * (3 * i + t)
            jx = (ry * dz - rz * dy) / lxx
            jy = (rz * dx - rx * dz - lxy * jx) / lyy
            jz = (rx * dy - ry * dx - lxz * jx - lyz * jy) / lzz
            rows[at], rows[at + 1], rows[at + 2] = dx / root, dy / root, dz / root
            rows[at + 3], rows[at + 4], rows[at + 5] = jx, jy, jz
            start[3 * i + t] = dx * ux + dy * uy + dz * uz
    system = (rows, start, friction, restitution, gaps)
    flags = solve(n, system, total, merge, threshold, steps, c, impulse, v, rest, marks)
    for j in range(m):
        answer[6] -= 0.5 * impulse[j] * (start[j] + c[j])
        at = ANSWER + RESULT * (j // 3)
        for t in range(3):
            direction = rows[6 * j + t] * root
            answer[at + t] += direction * impulse[j]
            answer[at + 3 + t] += direction * c[j]
    for i in range(n):
        at = ANSWER + RESULT * i
        answer[at + 6] = float(marks[i])
        for k in range(18 * i + 12, 18 * i + 18):
            answer[at + 7] += rows[k] * rows[k]
    turn = v[5] / lzz
    roll = (v[4] - lyz * turn) / lyy
    answer[0], answer[1], answer[2] = vx + v[0] / root, vy + v[1] / root, vz + v[2] / root
    answer[3] = wx + (v[3] - lxy * roll - lxz * turn) / lxx
    answer[4], answer[5] = wy + roll, wz + turn
    return flags


def strike_mechanism(
    n: Count,
    W: Floats,
    friction: Floats,
    restitution: Floats,
    gaps: Floats,
    total: bool,
    merge: float,
    threshold: float,
    steps: int,
    start: Floats,
    c: Floats,
    impulse: Floats,
    work: Floats,
    marks: Ints,
) -> int:
    """Solve the impact of a mechanism from its velocities at the contacts, as `spatial_path.solve` does."""
    m = 3 * n
    r = coordinates(n)
    rows, v = work[0 : m * r], work[m * r : m * r + r]
    # W = A A^T (Cholesky): of the velocities next is that of which most is left, until what is left is rounding.
    for j in range(m):
        c[j] = 1.0 if W[j * m + j] > 0.0 else 0.0
        for k in range(r):
            rows[j * r + k] = 0.0
    for k in range(m):
        best = 0
        for j in range(m):
            best = j if c[j] > c[best] else best
        if c[best] <= ROUNDING:
            break
        c[best], root = 0.0, sqrt(c[best] * W[best * m + best])
        rows[best * r + k] = root
        for j in range(m):
            if c[j] > 0.0:
                rest = W[j * m + best]
                for i in range(k):
                    rest -= rows[j * r + i] * rows[best * r + i]
                rows[j * r + k] = rest / root
                c[j] -= rest / root * (rest / root) / W[j * m + j]
    system = (rows, start, friction, restitution, gaps)
    return solve(n, system, total, merge, threshold, steps, c, impulse, v, work[m * r + r :], marks)


def coordinates(n: Count) -> int:
    """Coordinates of the motion that n contacts of a mechanism see, in sixes."""
    return 6 * ((n + 1) // 2)
