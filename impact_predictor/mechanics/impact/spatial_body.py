"""An impact of a rigid body in three dimensions as its contacts see it, and back: law code on flat sequences.

A problem is one flat sequence: mass; the inertia ixx, iyy, izz, ixy, ixz, iyz about the mass centre; the twist vx, vy,
vz, wx, wy, wz of the mass centre; then of each contact its position x, y, z from the mass centre, its normal, friction,
restitution, the velocity of its support, and its gap. An answer is the twist, the energy lost, and of each contact its
impulse, its velocity relative to the support, and its state, all along the axes of the problem.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from math import sqrt

from .spatial_path import Given, Scratch, solve

BODY = 13
"""Numbers of a problem that come before its contacts."""

CONTACT = 12
"""Numbers of each contact of a problem."""

ANSWER = 7
"""Numbers of an answer that come before its contacts; each of them has `RESULT`."""

RESULT = 7

START = 11
"""Where the scratch has the velocities before the impact."""

INVALID = 4
"""The flag of numbers that no body can have."""

LARGEST = 1e100
SYMMETRY = 1e-9

ROUNDED = 0.01
"""By this part of its trace an inertia may miss the triangle inequality: thin plates are given with few digits."""


def is_valid(n: int, problem: Given) -> bool:
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


def strike(
    n: int,
    problem: Given,
    total: bool,
    merge: float,
    threshold: float,
    steps: int,
    answer: Scratch,
    W: Scratch,
    rows: Scratch,
    scratch: Sequence[Scratch],
    marks: Sequence[MutableSequence[int]],
) -> int:
    """Fill in the answer to a problem; its flags, as those of `spatial_path.solve`, and `INVALID`."""
    for j in range(ANSWER + RESULT * n):
        answer[j] = 0.0
    if not is_valid(n, problem):
        for j in range(6):
            answer[j] = problem[7 + j] if -LARGEST <= problem[7 + j] <= LARGEST else 0.0
        return INVALID
    mass = problem[0]
    xx, yy, zz, xy, xz, yz = problem[1], problem[2], problem[3], problem[4], problem[5], problem[6]
    det = determinant(xx, yy, zz, xy, xz, yz)
    ixx = (yy * zz - yz * yz) / det
    iyy = (xx * zz - xz * xz) / det
    izz = (xx * yy - xy * xy) / det
    ixy = (xz * yz - xy * zz) / det
    ixz = (xy * yz - xz * yy) / det
    iyz = (xy * xz - xx * yz) / det
    vx, vy, vz, wx, wy, wz = problem[7], problem[8], problem[9], problem[10], problem[11], problem[12]
    impulse, c, friction, restitution, gaps = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4]
    m = 3 * n
    for i in range(n):
        k = BODY + i * CONTACT
        rx, ry, rz = problem[k], problem[k + 1], problem[k + 2]
        nx, ny, nz = problem[k + 3], problem[k + 4], problem[k + 5]
        friction[i] = problem[k + 6]
        restitution[i] = problem[k + 7]
        gaps[i] = problem[k + 11]
        # The tangents: t1 across the normal in the plane of x and z unless the normal is along y there.
        if abs(nx) + abs(nz) > 1e-3:
            size = sqrt(nx * nx + nz * nz)
            ax, ay, az = nz / size, 0.0, -nx / size
        else:
            ax, ay, az = 1.0, -nx / ny, 0.0
            size = sqrt(ax * ax + ay * ay)
            ax /= size
            ay /= size
        bx, by, bz = ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax
        ux = vx + wy * rz - wz * ry - problem[k + 8]
        uy = vy + wz * rx - wx * rz - problem[k + 9]
        uz = vz + wx * ry - wy * rx - problem[k + 10]
        for t in range(3):
            if t == 0:
                dx, dy, dz = ax, ay, az
            elif t == 1:
                dx, dy, dz = bx, by, bz
            else:
                dx, dy, dz = nx, ny, nz
            at = 6 * (3 * i + t)
            rows[at] = dx
            rows[at + 1] = dy
            rows[at + 2] = dz
            rows[at + 3] = ry * dz - rz * dy
            rows[at + 4] = rz * dx - rx * dz
            rows[at + 5] = rx * dy - ry * dx
            c[3 * i + t] = dx * ux + dy * uy + dz * uz
    for j in range(m):
        g = 6 * j
        jx, jy, jz = rows[g + 3], rows[g + 4], rows[g + 5]
        hx = ixx * jx + ixy * jy + ixz * jz
        hy = ixy * jx + iyy * jy + iyz * jz
        hz = ixz * jx + iyz * jy + izz * jz
        for k in range(j, m):
            q = 6 * k
            linear = rows[g] * rows[q] + rows[g + 1] * rows[q + 1] + rows[g + 2] * rows[q + 2]
            w = linear / mass + hx * rows[q + 3] + hy * rows[q + 4] + hz * rows[q + 5]
            W[j * m + k] = w
            W[k * m + j] = w
    flags = solve(n, W, friction, restitution, gaps, total, merge, threshold, steps, c, impulse, scratch[5:], marks)
    fx = fy = fz = tx = ty = tz = lost = 0.0
    for j in range(m):
        g = 6 * j
        p = impulse[j]
        fx += rows[g] * p
        fy += rows[g + 1] * p
        fz += rows[g + 2] * p
        tx += rows[g + 3] * p
        ty += rows[g + 4] * p
        tz += rows[g + 5] * p
        lost -= 0.5 * p * (scratch[START][j] + c[j])
        at = ANSWER + RESULT * (j // 3)
        for t in range(3):
            answer[at + t] += rows[g + t] * p
            answer[at + 3 + t] += rows[g + t] * c[j]
    for i in range(n):
        answer[ANSWER + RESULT * i + 6] = float(marks[0][i])
    answer[0] = vx + fx / mass
    answer[1] = vy + fy / mass
    answer[2] = vz + fz / mass
    answer[3] = wx + ixx * tx + ixy * ty + ixz * tz
    answer[4] = wy + ixy * tx + iyy * ty + iyz * tz
    answer[5] = wz + ixz * tx + iyz * ty + izz * tz
    answer[6] = lost
    return flags
