"""Small steps of a rigid body on points that press on a deck like stiff springs with dampers, with Coulomb's friction.

No impact law, no modes and no events: each step is implicit in the contacts' velocities, whose impulses are found one
after the other, again and again (projected Gauss and Seidel, with those of the last step to begin with; Catto,
"Iterative dynamics with temporal coherence", Game Developer Conference, 2005). A point sticks where friction suffices.

Law code on flat sequences (see `mechanics.compiled`).
"""

from __future__ import annotations

from math import hypot, sqrt
from typing import Any

SWEEPS = 8
"""Times that the contacts are gone through in a step."""

SLOWEST = 1e-4
"""m/s: a point that is at the end of its friction slips if it is faster."""


FINE = 4
"""Parts of a step in which points strike."""

STRIKES = 40
"""Steps that are divided from where a point is about to strike."""

HEAVY = 1.5
"""Weights with which the points press no more when nothing strikes."""


HOLDER = 10
"""Numbers of a lashing: its point from the mass centre in the body (3), its anchor in the deck's frame (3), the length
(m) at which it begins to pull, its stiffness (N/m) and damping (N s/m), and the most that it bears (N)."""


def advance(
    steps: int, n: int, given: Any, felt: Any, y: Any, points: Any, lashings: Any, work: Any, rows: Any, marks: Any
) -> int:
    """Some steps from the state y: place of the mass centre, quaternion, velocity and angular velocity in the deck's
    frame (13), which is kept up to date; returns how many rows they fill.

    `given` are the step (s), the deck's height (m), mass, friction, restitution, stiffness (N/m) and damping (N s/m) of
    a contact, the inertia about the body's axes (9 numbers) and its inverse (9); `felt` (steps, 9) the gravity at the
    frame's origin, the deck's angular velocity and its derivative; `points` (n, 3) from the mass centre in the body;
    `lashings` (k, HOLDER); `work` 11 n + 1, to begin with zeros. Fills `rows` (steps * FINE, 15) with the states, the
    sum of the normal forces over the weight and the time from the beginning, and `marks` (steps * FINE, 2 n) with which
    points press, and which of them slip.
    """
    whole, height, mass, friction = given[0], given[1], given[2], given[3]
    restitution, stiffness, damping = given[4], given[5], given[6]
    # In work after the impulses: arms; gap, two mobilities and whether it was closed; the speed at which it leaves;
    # and for how many steps more each is divided.
    arm, mobility, bounce, divided = 3 * n, 6 * n, 10 * n, 11 * n
    step = part = count = 0
    parts, time, h = 1, 0.0, whole
    r = [0.0] * 9
    spin = [0.0] * 9  # the inverse of the inertia in the deck's axes
    while step < steps:
        if part == 0:
            parts = FINE if work[divided] > 0.0 else 1
            h = whole / parts
        stiff, soft = h * stiffness, h * h * stiffness + h * damping
        at = 9 * step
        gx, gy, gz, wx, wy, wz = felt[at], felt[at + 1], felt[at + 2], felt[at + 3], felt[at + 4], felt[at + 5]
        tx, ty, tz = felt[at + 6], felt[at + 7], felt[at + 8]
        px, py, pz, qx, qy, qz, qw = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
        vx, vy, vz, ox, oy, oz = y[7], y[8], y[9], y[10], y[11], y[12]
        r[0], r[1], r[2] = 1.0 - 2.0 * (qy * qy + qz * qz), 2.0 * (qx * qy - qw * qz), 2.0 * (qx * qz + qw * qy)
        r[3], r[4], r[5] = 2.0 * (qx * qy + qw * qz), 1.0 - 2.0 * (qx * qx + qz * qz), 2.0 * (qy * qz - qw * qx)
        r[6], r[7], r[8] = 2.0 * (qx * qz - qw * qy), 2.0 * (qy * qz + qw * qx), 1.0 - 2.0 * (qx * qx + qy * qy)
        for i in range(3):
            for j in range(i, 3):
                total = 0.0
                for k in range(3):
                    row = 0.0
                    for m in range(3):
                        row += given[16 + 3 * k + m] * r[3 * j + m]
                    total += r[3 * i + k] * row
                spin[3 * i + j] = spin[3 * j + i] = total
        # What a free body does in a frame that turns: the forces of Euler, of Coriolis and centrifugal.
        cx, cy, cz = wy * pz - wz * py, wz * px - wx * pz, wx * py - wy * px
        ax = gx - (ty * pz - tz * py) - (wy * cz - wz * cy) - 2.0 * (wy * vz - wz * vy)
        ay = gy - (tz * px - tx * pz) - (wz * cx - wx * cz) - 2.0 * (wz * vx - wx * vz)
        az = gz - (tx * py - ty * px) - (wx * cy - wy * cx) - 2.0 * (wx * vy - wy * vx)
        vx, vy, vz = vx + h * ax, vy + h * ay, vz + h * az
        # Of its whole turn, in its own axes, what Euler's equations take.
        sx, sy, sz = wx + ox, wy + oy, wz + oz
        bx, by, bz = (
            r[0] * sx + r[3] * sy + r[6] * sz,
            r[1] * sx + r[4] * sy + r[7] * sz,
            r[2] * sx + r[5] * sy + r[8] * sz,
        )
        lx = given[7] * bx + given[8] * by + given[9] * bz
        ly = given[10] * bx + given[11] * by + given[12] * bz
        lz = given[13] * bx + given[14] * by + given[15] * bz
        mx, my, mz = (
            lx * r[0] + ly * r[1] + lz * r[2],
            lx * r[3] + ly * r[4] + lz * r[5],
            lx * r[6] + ly * r[7] + lz * r[8],
        )
        kx, ky, kz = my * sz - mz * sy, mz * sx - mx * sz, mx * sy - my * sx
        dx = spin[0] * kx + spin[1] * ky + spin[2] * kz + oy * wz - oz * wy - tx
        dy = spin[3] * kx + spin[4] * ky + spin[5] * kz + oz * wx - ox * wz - ty
        dz = spin[6] * kx + spin[7] * ky + spin[8] * kz + ox * wy - oy * wx - tz
        vz0, ox0, oy0 = y[9], y[10], y[11]
        for k in range(0, len(lashings), HOLDER):
            ux, uy, uz = lashings[k], lashings[k + 1], lashings[k + 2]
            ex, ey, ez = (
                r[0] * ux + r[1] * uy + r[2] * uz,
                r[3] * ux + r[4] * uy + r[5] * uz,
                r[6] * ux + r[7] * uy + r[8] * uz,
            )
            tx, ty, tz = lashings[k + 3] - px - ex, lashings[k + 4] - py - ey, lashings[k + 5] - pz - ez
            length = sqrt(tx * tx + ty * ty + tz * tz)
            rate = -(tx * (y[7] + oy * ez - oz * ey) + ty * (y[8] + oz * ex - ox * ez) + tz * (vz0 + ox * ey - oy * ex))
            pull = lashings[k + 7] * (length - lashings[k + 6]) + lashings[k + 8] * rate / length
            # A rope does not push.
            pull = h * min(max(pull, 0.0), lashings[k + 9]) / length
            tx, ty, tz = pull * tx, pull * ty, pull * tz
            vx, vy, vz = vx + tx / mass, vy + ty / mass, vz + tz / mass
            nx, ny, nz = ey * tz - ez * ty, ez * tx - ex * tz, ex * ty - ey * tx
            dx += (spin[0] * nx + spin[1] * ny + spin[2] * nz) / h
            dy += (spin[3] * nx + spin[4] * ny + spin[5] * nz) / h
            dz += (spin[6] * nx + spin[7] * ny + spin[8] * nz) / h
        ox, oy, oz = ox + h * dx, oy + h * dy, oz + h * dz
        for i in range(n):
            p, a, m = 3 * i, arm + 3 * i, mobility + 4 * i
            ux, uy, uz = points[p], points[p + 1], points[p + 2]
            ex, ey, ez = (
                r[0] * ux + r[1] * uy + r[2] * uz,
                r[3] * ux + r[4] * uy + r[5] * uz,
                r[6] * ux + r[7] * uy + r[8] * uz,
            )
            work[a], work[a + 1], work[a + 2] = ex, ey, ez
            gap = pz + ez - height
            work[m] = gap
            if gap > 0.0:
                work[p] = work[p + 1] = work[p + 2] = 0.0
                work[bounce + i] = 0.0
                continue
            # How much an impulse of 1 N s changes the point's velocity in its own direction.
            work[m + 1] = 1.0 / mass + spin[0] * ey * ey + spin[4] * ex * ex - 2.0 * spin[1] * ex * ey
            along = 1.0 / mass + spin[4] * ez * ez + spin[8] * ey * ey - 2.0 * spin[5] * ey * ez
            beside = 1.0 / mass + spin[0] * ez * ez + spin[8] * ex * ex - 2.0 * spin[2] * ex * ez
            work[m + 2] = max(along, beside)
            # The speed at which a point came down that closes now, and of which it keeps a part.
            rate = vz0 + ox0 * ey - oy0 * ex
            if work[p + 2] == 0.0 and work[m + 3] == 0.0:
                work[bounce + i] = -restitution * min(rate, 0.0)
            work[m + 3] = 1.0
            fx, fy, fz = work[p], work[p + 1], work[p + 2]
            vx, vy, vz = vx + fx / mass, vy + fy / mass, vz + fz / mass
            nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
            ox += spin[0] * nx + spin[1] * ny + spin[2] * nz
            oy += spin[3] * nx + spin[4] * ny + spin[5] * nz
            oz += spin[6] * nx + spin[7] * ny + spin[8] * nz
        for _ in range(SWEEPS):
            for i in range(n):
                p, a, m = 3 * i, arm + 3 * i, mobility + 4 * i
                if work[m] > 0.0:
                    continue
                ex, ey, ez = work[a], work[a + 1], work[a + 2]
                rate = vz + ox * ey - oy * ex - work[bounce + i]
                # P = -h (stiffness (gap + h rate) + damping rate), with the rate that it leaves.
                wanted = work[p + 2] - (work[p + 2] + stiff * work[m] + soft * rate) / (1.0 + soft * work[m + 1])
                fz = max(0.0, wanted) - work[p + 2]
                work[p + 2] += fz
                sx, sy = vx + oy * ez - oz * ey, vy + oz * ex - ox * ez
                tx, ty = work[p] - sx / work[m + 2], work[p + 1] - sy / work[m + 2]
                force, most = hypot(tx, ty), friction * work[p + 2]
                if force > most:
                    tx, ty = tx * most / force, ty * most / force
                fx, fy = tx - work[p], ty - work[p + 1]
                work[p], work[p + 1] = tx, ty
                vx, vy, vz = vx + fx / mass, vy + fy / mass, vz + fz / mass
                nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
                ox += spin[0] * nx + spin[1] * ny + spin[2] * nz
                oy += spin[3] * nx + spin[4] * ny + spin[5] * nz
                oz += spin[6] * nx + spin[7] * ny + spin[8] * nz
        load, strikes = 0.0, False
        for i in range(n):
            p, a, m = 3 * i, arm + 3 * i, mobility + 4 * i
            presses = work[m] <= 0.0 and work[p + 2] > 0.0
            ex, ey, ez = work[a], work[a + 1], work[a + 2]
            slip = hypot(vx + oy * ez - oz * ey, vy + oz * ex - ox * ez)
            held = hypot(work[p], work[p + 1]) < (1.0 - 1e-9) * friction * work[p + 2]
            marks[2 * n * count + i] = 1 if presses else 0
            marks[2 * n * count + n + i] = 1 if presses and not held and slip > SLOWEST else 0
            load += work[p + 2]
            if work[m] > 0.0:
                work[m + 3] = 0.0
                strikes = strikes or work[m] + 3.0 * whole * (vz + ox * ey - oy * ex) < 0.0
        load /= h * mass * abs(gz)
        if strikes or load > HEAVY:
            work[divided] = STRIKES
        px, py, pz = px + h * vx, py + h * vy, pz + h * vz
        ex, ey, ez = 0.5 * h * ox, 0.5 * h * oy, 0.5 * h * oz
        ax, ay = qx + ex * qw + ey * qz - ez * qy, qy + ey * qw + ez * qx - ex * qz
        az, aw = qz + ez * qw + ex * qy - ey * qx, qw - ex * qx - ey * qy - ez * qz
        size = sqrt(ax * ax + ay * ay + az * az + aw * aw)
        y[0], y[1], y[2], y[3], y[4], y[5], y[6] = px, py, pz, ax / size, ay / size, az / size, aw / size
        y[7], y[8], y[9], y[10], y[11], y[12] = vx, vy, vz, ox, oy, oz
        time += h
        for j in range(13):
            rows[15 * count + j] = y[j]
        rows[15 * count + 13], rows[15 * count + 14] = load, time
        count += 1
        part += 1
        if part == parts:
            step, part = step + 1, 0
            work[divided] = max(0.0, work[divided] - 1.0)
    return count
