"""Reactions of a plane support on the points of a rigid body in three dimensions, and the accelerations that follow.

Law code on flat sequences (see `mechanics.compiled`), with only operations that round alike in every form. The support
is z = 0 of its frame, out of it z. A state is 13 numbers: place of the mass centre, orientation as a quaternion
(x, y, z, w) of any length, velocity and angular velocity in that frame, along its axes. Masses are 1, so that forces
are accelerations and inertias squares of radii of gyration.

A point that stands sticks or slips. Points are solved one after the other until nothing changes (Gauss and Seidel on
the Delassus matrix, whose blocks W are those of single points): forces on the body change its acceleration, and each
point's own force is what its acceleration a = b + W F asks for.

`model` is (points, body, pull, friction, scale): points (3 n) from the mass centre in body axes; body: six elements
xx yy zz xy xz yz of the inertia, six of its inverse, and 1 where it is the same about all axes; pull: gravity felt at
the frame's origin, its growth per second, angular velocity and acceleration of the frame, and 1 where it turns;
friction (n); scale: size, speed and acceleration of the motion, and the speed along its direction before that is
blended with the slip of a creeping point.

`stance` is (held, label, toward, forces, arms, blocks, frame, rows). held: indices of the points that stand, and at its
end their number; label (n): OPEN, STICKS, SLIPS or CREEPS; toward (2 n): direction of a slip; forces (3 n), kept from
one solution to the next; arms (3 n) of points that stand; blocks (12 n): their W and its inverse, as xx yy zz xy xz yz;
frame: the body's axes as columns of a matrix (9), and the inverse inertia along the support's axes (6); rows
(9 n n + 3 n) to solve equations in, and the order (3 n) in which they are solved.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from ..compiled import Count, Floats, Ints

    Model = tuple[Floats, Floats, Floats, Floats, Floats]
    Stance = tuple[Ints, Ints, Floats, Floats, Floats, Floats, Floats, Floats, Ints]

OPEN: Final = 0
STICKS: Final = 1
SLIPS: Final = 2
CREEPS: Final = 3
"""A point that creeps slips so slowly that the direction of its slip is stiff: it is blended with that before."""
_SWEEPS: Final = 100
"""Several times what two points take; more take points that share a load in many ways."""
_CONVERGED: Final = 1e-9
"""Change of a force in one sweep that ends them, relative to the scale of accelerations."""
_TURNS: Final = 60
"""Iterations for the direction in which a slip begins."""
_JAMMED: Final = 1e-3
"""Relative to W's normal element. What a normal force needs to press its slipping point away from the support."""
_SHARED: Final = 1e-7
"""A pivot below is zero: the other points hold this one, too."""
_TOO_MUCH: Final = 1e5
"""Relative to the scale of accelerations: a force that grows so jams."""


def locate(y: Floats, model: Model, stance: Stance) -> None:
    """Turn the body's inertia and the arms of its standing points to the support's axes, and find their W."""
    points, body = model[0], model[1]
    held, label, arms, blocks, frame = stance[0], stance[1], stance[4], stance[5], stance[6]
    a, b, c, d = y[3], y[4], y[5], y[6]
    s = 2.0 / (a * a + b * b + c * c + d * d)
    r0, r1, r2 = 1.0 - s * (b * b + c * c), s * (a * b - c * d), s * (a * c + b * d)
    r3, r4, r5 = s * (a * b + c * d), 1.0 - s * (a * a + c * c), s * (b * c - a * d)
    r6, r7, r8 = s * (a * c - b * d), s * (b * c + a * d), 1.0 - s * (a * a + b * b)
    frame[0], frame[1], frame[2], frame[3], frame[4], frame[5] = r0, r1, r2, r3, r4, r5
    frame[6], frame[7], frame[8] = r6, r7, r8
    jxx, jyy, jzz, jxy, jxz, jyz = body[6], body[7], body[8], body[9], body[10], body[11]
    if body[12] == 0.0:
        p0, p1, p2 = r0 * jxx + r1 * jxy + r2 * jxz, r0 * jxy + r1 * jyy + r2 * jyz, r0 * jxz + r1 * jyz + r2 * jzz
        p3, p4, p5 = r3 * jxx + r4 * jxy + r5 * jxz, r3 * jxy + r4 * jyy + r5 * jyz, r3 * jxz + r4 * jyz + r5 * jzz
        p6, p7, p8 = r6 * jxx + r7 * jxy + r8 * jxz, r6 * jxy + r7 * jyy + r8 * jyz, r6 * jxz + r7 * jyz + r8 * jzz
        jxx, jyy, jzz = p0 * r0 + p1 * r1 + p2 * r2, p3 * r3 + p4 * r4 + p5 * r5, p6 * r6 + p7 * r7 + p8 * r8
        jxy, jxz, jyz = p0 * r3 + p1 * r4 + p2 * r5, p0 * r6 + p1 * r7 + p2 * r8, p3 * r6 + p4 * r7 + p5 * r8
    frame[9], frame[10], frame[11], frame[12], frame[13], frame[14] = jxx, jyy, jzz, jxy, jxz, jyz
    for k in range(held[len(label)]):
        i = held[k]
        px, py, pz = points[3 * i], points[3 * i + 1], points[3 * i + 2]
        x, y_, z = r0 * px + r1 * py + r2 * pz, r3 * px + r4 * py + r5 * pz, r6 * px + r7 * py + r8 * pz
        arms[3 * i], arms[3 * i + 1], arms[3 * i + 2] = x, y_, z
        # Rows of the inverse inertia times the cross products of the arm with the unit vectors.
        u0, u1, u2 = jxy * z - jxz * y_, jyy * z - jyz * y_, jyz * z - jzz * y_
        v0, v1, v2 = jxz * x - jxx * z, jyz * x - jxy * z, jzz * x - jxz * z
        w0, w1, _ = jxx * y_ - jxy * x, jxy * y_ - jyy * x, 0.0
        xx, yy, zz = 1.0 + u1 * z - u2 * y_, 1.0 + v2 * x - v0 * z, 1.0 + w0 * y_ - w1 * x
        xy, xz, yz = u2 * x - u0 * z, u0 * y_ - u1 * x, v0 * y_ - v1 * x
        o = 12 * i
        blocks[o], blocks[o + 1], blocks[o + 2], blocks[o + 3], blocks[o + 4], blocks[o + 5] = xx, yy, zz, xy, xz, yz
        c0, c1, c2 = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
        t = 1.0 / (xx * c0 + xy * c1 + xz * c2)
        blocks[o + 6], blocks[o + 7], blocks[o + 8] = t * c0, t * (xx * zz - xz * xz), t * (xx * yy - xy * xy)
        blocks[o + 9], blocks[o + 10], blocks[o + 11] = t * c1, t * c2, t * (xy * xz - xx * yz)


def derive(time: float, y: Floats, out: Floats, at: Count, cones: bool, model: Model, stance: Stance) -> int:
    """Derivative of the state y into out[at:at + 13]; -1, or the point whose slip no finite reaction goes with.

    With `cones` the forces obey non-penetration and Coulomb's law in accelerations. Without, a point that sticks is
    held and one that slips stays on the support, whatever that takes: a smooth motion, to be left where its forces
    leave their cones.
    """
    points, body, pull, friction, scale = model
    held, label, forces, arms, blocks, frame = stance[0], stance[1], stance[3], stance[4], stance[5], stance[6]
    locate(y, model, stance)
    vx, vy, vz, wx, wy, wz = y[7], y[8], y[9], y[10], y[11], y[12]
    ax, ay, az = pull[0] + pull[3] * time, pull[1] + pull[4] * time, pull[2] + pull[5] * time
    alx, aly, alz, gx, gy, gz = 0.0, 0.0, 0.0, wx, wy, wz
    jxx, jyy, jzz, jxy, jxz, jyz = frame[9], frame[10], frame[11], frame[12], frame[13], frame[14]
    if pull[12] != 0.0:
        ex, ey, ez = pull[9], pull[10], pull[11]
        ux, uy, uz = pull[6] + ex * time, pull[7] + ey * time, pull[8] + ez * time
        px, py, pz = y[0], y[1], y[2]
        cx, cy, cz = uy * pz - uz * py + 2.0 * vx, uz * px - ux * pz + 2.0 * vy, ux * py - uy * px + 2.0 * vz
        ax -= ey * pz - ez * py + uy * cz - uz * cy
        ay -= ez * px - ex * pz + uz * cx - ux * cz
        az -= ex * py - ey * px + ux * cy - uy * cx
        alx, aly, alz = -ex - uy * wz + uz * wy, -ey - uz * wx + ux * wz, -ez - ux * wy + uy * wx
        gx, gy, gz = wx + ux, wy + uy, wz + uz
    if body[12] == 0.0:
        # Euler's equations: the spin and its moment of momentum along the body's axes.
        bx = frame[0] * gx + frame[3] * gy + frame[6] * gz
        by = frame[1] * gx + frame[4] * gy + frame[7] * gz
        bz = frame[2] * gx + frame[5] * gy + frame[8] * gz
        lx = body[0] * bx + body[3] * by + body[4] * bz
        ly = body[3] * bx + body[1] * by + body[5] * bz
        lz = body[4] * bx + body[5] * by + body[2] * bz
        tx, ty, tz = ly * bz - lz * by, lz * bx - lx * bz, lx * by - ly * bx
        bx = body[6] * tx + body[9] * ty + body[10] * tz
        by = body[9] * tx + body[7] * ty + body[11] * tz
        bz = body[10] * tx + body[11] * ty + body[8] * tz
        alx += frame[0] * bx + frame[1] * by + frame[2] * bz
        aly += frame[3] * bx + frame[4] * by + frame[5] * bz
        alz += frame[6] * bx + frame[7] * by + frame[8] * bz
    count, jam = held[len(label)], -1
    for k in range(count):
        i = held[k]
        rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
        fx, fy, fz = forces[3 * i], forces[3 * i + 1], forces[3 * i + 2]
        tx, ty, tz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
        ax, ay, az = ax + fx, ay + fy, az + fz
        alx += jxx * tx + jxy * ty + jxz * tz
        aly += jxy * tx + jyy * ty + jyz * tz
        alz += jxz * tx + jyz * ty + jzz * tz
    square, enough = wx * wx + wy * wy + wz * wz, _CONVERGED * scale[2]
    if count > 1 and not cones:
        return _hold_all(y, out, at, ax, ay, az, alx, aly, alz, model, stance)
    for _ in range(_SWEEPS if count else 0):
        change = 0.0
        for k in range(count):
            i = held[k]
            rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
            fx, fy, fz = forces[3 * i], forces[3 * i + 1], forces[3 * i + 2]
            o, along = 12 * i, wx * rx + wy * ry + wz * rz
            # The point's acceleration with all forces: w x (w x r) = w (w . r) - r w^2.
            bx = ax + aly * rz - alz * ry + wx * along - rx * square
            by = ay + alz * rx - alx * rz + wy * along - ry * square
            bz = az + alx * ry - aly * rx + wz * along - rz * square
            if label[i] == STICKS and not cones:
                nx = fx - blocks[o + 6] * bx - blocks[o + 9] * by - blocks[o + 10] * bz
                ny = fy - blocks[o + 9] * bx - blocks[o + 7] * by - blocks[o + 11] * bz
                nz = fz - blocks[o + 10] * bx - blocks[o + 11] * by - blocks[o + 8] * bz
            else:
                bx -= blocks[o] * fx + blocks[o + 3] * fy + blocks[o + 4] * fz
                by -= blocks[o + 3] * fx + blocks[o + 1] * fy + blocks[o + 5] * fz
                bz -= blocks[o + 4] * fx + blocks[o + 5] * fy + blocks[o + 2] * fz
                if label[i] == STICKS:
                    nx, ny, nz = coulomb(blocks, o, bx, by, bz, friction[i])
                else:
                    dx, dy = drag(y, i, model, stance)
                    lever = blocks[o + 2] + blocks[o + 4] * dx + blocks[o + 5] * dy
                    nx = ny = nz = 0.0
                    if not cones or bz < 0.0:
                        if lever > _JAMMED * blocks[o + 2]:
                            nz = -bz / lever
                            nx, ny = nz * dx, nz * dy
                        else:
                            jam = i
            forces[3 * i], forces[3 * i + 1], forces[3 * i + 2] = nx, ny, nz
            fx, fy, fz = nx - fx, ny - fy, nz - fz
            tx, ty, tz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
            ax, ay, az = ax + fx, ay + fy, az + fz
            alx += jxx * tx + jxy * ty + jxz * tz
            aly += jxy * tx + jyy * ty + jyz * tz
            alz += jxz * tx + jyz * ty + jzz * tz
            change = max(change, abs(fx), abs(fy), abs(fz))
        if not change <= _TOO_MUCH * scale[2]:
            jam = held[0]
        if count == 1 or change <= enough or jam >= 0:
            break
        share(held, label, arms, forces)
    if jam >= 0:
        forget(stance)
    fill(y, out, at, ax, ay, az, alx, aly, alz)
    return jam


def rates(time: float, y: Floats, out: Floats, at: Count, cones: bool, model: Model, stance: Stance) -> int:
    """As `derive`, which becomes a part of its callers where it is compiled: this one is called."""
    return derive(time, y, out, at, cones, model, stance)


def drag(y: Floats, i: Count, model: Model, stance: Stance) -> tuple[float, float]:
    """Friction on point i, which slips, over its normal force."""
    friction, scale = model[3], model[4]
    label, toward, arms = stance[1], stance[2], stance[4]
    dx, dy = toward[2 * i], toward[2 * i + 1]
    sx = y[7] + y[11] * arms[3 * i + 2] - y[12] * arms[3 * i + 1]
    sy = y[8] + y[12] * arms[3 * i] - y[10] * arms[3 * i + 2]
    if label[i] == CREEPS:
        sx, sy = sx + scale[3] * dx, sy + scale[3] * dy
    slip = sqrt(sx * sx + sy * sy)
    if sx * dx + sy * dy > 0.0:
        dx, dy = sx / slip, sy / slip
    return -friction[i] * dx, -friction[i] * dy


def forget(stance: Stance) -> None:
    """Take all forces away."""
    held, label, forces = stance[0], stance[1], stance[3]
    for k in range(held[len(label)]):
        forces[3 * held[k]] = forces[3 * held[k] + 1] = forces[3 * held[k] + 2] = 0.0


def _hold_all(
    y: Floats,
    out: Floats,
    at: Count,
    ax: float,
    ay: float,
    az: float,
    alx: float,
    aly: float,
    alz: float,
    model: Model,
    stance: Stance,
) -> int:
    """As `rates` without cones for two points or more, from the acceleration with the forces before.

    The linear equations of all points are solved by elimination, the largest pivot first: after a small one rounding
    would hide that others are zero. Pivots are positive, zero where points share a load in many ways, which then stays
    as it was, and negative where a slip jams.
    """
    scale = model[4]
    held, label, forces, arms = stance[0], stance[1], stance[3], stance[4]
    frame, rows, order = stance[6], stance[7], stance[8]
    count, size = held[len(label)], 0
    for k in range(count):
        size += 3 if label[held[k]] == STICKS else 1
    width, column = size + 1, 0
    wx, wy, wz = y[10], y[11], y[12]
    square = wx * wx + wy * wy + wz * wz
    jxx, jyy, jzz, jxy, jxz, jyz = frame[9], frame[10], frame[11], frame[12], frame[13], frame[14]
    # Forces of slipping points turn with their slip.
    for k in range(count):
        i = held[k]
        rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
        sticks = label[i] == STICKS
        dx, dy = (0.0, 0.0) if sticks else drag(y, i, model, stance)
        if not sticks:
            fx, fy = forces[3 * i + 2] * dx - forces[3 * i], forces[3 * i + 2] * dy - forces[3 * i + 1]
            forces[3 * i], forces[3 * i + 1] = forces[3 * i] + fx, forces[3 * i + 1] + fy
            ax, ay = ax + fx, ay + fy
            tx, ty, tz = -rz * fy, rz * fx, rx * fy - ry * fx
            alx += jxx * tx + jxy * ty + jxz * tz
            aly += jxy * tx + jyy * ty + jyz * tz
            alz += jxz * tx + jyz * ty + jzz * tz
        for part in range(3 if sticks else 1):
            fx, fy, fz = dx, dy, 1.0
            if sticks:
                fx, fy, fz = 1.0 if part == 0 else 0.0, 1.0 if part == 1 else 0.0, 1.0 if part == 2 else 0.0
            tx, ty, tz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
            ux, uy = jxx * tx + jxy * ty + jxz * tz, jxy * tx + jyy * ty + jyz * tz
            uz, row = jxz * tx + jyz * ty + jzz * tz, 0
            for m in range(count):
                j = held[m]
                px, py, pz = arms[3 * j], arms[3 * j + 1], arms[3 * j + 2]
                if label[j] == STICKS:
                    rows[row * width + column] = fx + uy * pz - uz * py
                    rows[(row + 1) * width + column] = fy + uz * px - ux * pz
                    row += 2
                rows[row * width + column] = fz + ux * py - uy * px
                row += 1
            column += 1
    row = 0
    for k in range(count):
        i = held[k]
        rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
        along = wx * rx + wy * ry + wz * rz
        if label[i] == STICKS:
            rows[row * width + size] = -(ax + aly * rz - alz * ry + wx * along - rx * square)
            rows[(row + 1) * width + size] = -(ay + alz * rx - alx * rz + wy * along - ry * square)
            row += 2
        rows[row * width + size] = -(az + alx * ry - aly * rx + wz * along - rz * square)
        row += 1
    for p in range(size):
        order[p] = p
    for p in range(size):
        largest = p
        for q in range(p + 1, size):
            if rows[order[q] * width + order[q]] > rows[order[largest] * width + order[largest]]:
                largest = q
        row = order[largest]
        order[largest], order[p] = order[p], row
        pivot = rows[row * width + row]
        if abs(pivot) <= _SHARED:
            rows[row * width + row] = 0.0
            continue
        if pivot < 0.0:
            forget(stance)
            fill(y, out, at, ax, ay, az, alx, aly, alz)
            return held[0]
        for q in range(p + 1, size):
            other = order[q]
            factor = rows[other * width + row] / pivot
            if factor != 0.0:
                for c in range(p + 1, size):
                    rows[other * width + order[c]] -= factor * rows[row * width + order[c]]
                rows[other * width + size] -= factor * rows[row * width + size]
    for p in range(size - 1, -1, -1):
        row = order[p]
        pivot, value = rows[row * width + row], rows[row * width + size]
        for c in range(p + 1, size):
            value -= rows[row * width + order[c]] * rows[order[c] * width + size]
        rows[row * width + size] = 0.0 if pivot == 0.0 else value / pivot
    row, jam = 0, -1
    for k in range(count):
        i = held[k]
        rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
        if label[i] == STICKS:
            fx, fy, fz = rows[row * width + size], rows[(row + 1) * width + size], rows[(row + 2) * width + size]
            row += 3
        else:
            fz = rows[row * width + size]
            fx, fy = drag(y, i, model, stance)
            fx, fy = fz * fx, fz * fy
            row += 1
        forces[3 * i], forces[3 * i + 1], forces[3 * i + 2] = (
            forces[3 * i] + fx,
            forces[3 * i + 1] + fy,
            forces[3 * i + 2] + fz,
        )
        tx, ty, tz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
        ax, ay, az = ax + fx, ay + fy, az + fz
        alx += jxx * tx + jxy * ty + jxz * tz
        aly += jxy * tx + jyy * ty + jyz * tz
        alz += jxz * tx + jyz * ty + jzz * tz
        if not abs(forces[3 * i + 2]) <= _TOO_MUCH * scale[2]:
            jam = i
    if jam >= 0:
        forget(stance)
    share(held, label, arms, forces)
    fill(y, out, at, ax, ay, az, alx, aly, alz)
    return jam


def fill(
    y: Floats, out: Floats, at: Count, ax: float, ay: float, az: float, alx: float, aly: float, alz: float
) -> None:
    """Write the derivative of a state with this acceleration."""
    wx, wy, wz = y[10], y[11], y[12]
    out[at], out[at + 1], out[at + 2] = y[7], y[8], y[9]
    a, b, c, d = 0.5 * y[3], 0.5 * y[4], 0.5 * y[5], 0.5 * y[6]
    out[at + 3] = wx * d + wy * c - wz * b
    out[at + 4] = wy * d + wz * a - wx * c
    out[at + 5] = wz * d + wx * b - wy * a
    out[at + 6] = -wx * a - wy * b - wz * c
    out[at + 7], out[at + 8], out[at + 9] = ax, ay, az
    out[at + 10], out[at + 11], out[at + 12] = alx, aly, alz


def share(held: Ints, label: Ints, arms: Floats, forces: Floats) -> None:
    """Let points that stick share the push along the line between them, which moves nothing, as their normal forces."""
    count = held[len(label)]
    for k in range(count):
        i = held[k]
        for m in range(k):
            j = held[m]
            x, y, z = (
                arms[3 * i] - arms[3 * j],
                arms[3 * i + 1] - arms[3 * j + 1],
                arms[3 * i + 2] - arms[3 * j + 2],
            )
            load = max(forces[3 * i + 2], 0.0) + max(forces[3 * j + 2], 0.0)
            weight = load * (x * x + y * y + z * z)  # 0 of points at one place
            if label[i] == STICKS and label[j] == STICKS and weight > 0.0:
                push = max(forces[3 * i + 2], 0.0) * (forces[3 * j] * x + forces[3 * j + 1] * y)
                push -= max(forces[3 * j + 2], 0.0) * (forces[3 * i] * x + forces[3 * i + 1] * y)
                push /= weight
                forces[3 * i], forces[3 * j] = forces[3 * i] + push * x, forces[3 * j] - push * x
                forces[3 * i + 1], forces[3 * j + 1] = forces[3 * i + 1] + push * y, forces[3 * j + 1] - push * y
                forces[3 * i + 2], forces[3 * j + 2] = forces[3 * i + 2] + push * z, forces[3 * j + 2] - push * z


def coulomb(blocks: Floats, o: Count, bx: float, by: float, bz: float, friction: float) -> tuple[float, float, float]:
    """Force on a point without slip whose acceleration is b + W F, by non-penetration and Coulomb's law.

    It lifts, sticks, or begins to slip along the acceleration that friction leaves it, W being blocks[o:o + 12].
    """
    if bz >= 0.0:
        return 0.0, 0.0, 0.0
    fx = -blocks[o + 6] * bx - blocks[o + 9] * by - blocks[o + 10] * bz
    fy = -blocks[o + 9] * bx - blocks[o + 7] * by - blocks[o + 11] * bz
    fz = -blocks[o + 10] * bx - blocks[o + 11] * by - blocks[o + 8] * bz
    drag = sqrt(fx * fx + fy * fy)
    if fz >= 0.0 and drag <= friction * fz:
        return fx, fy, fz
    xx, yy, zz, xy, xz, yz = blocks[o], blocks[o + 1], blocks[o + 2], blocks[o + 3], blocks[o + 4], blocks[o + 5]
    if friction == 0.0 or drag == 0.0:
        return 0.0, 0.0, -bz / zz
    dx, dy, pace = -fx / drag, -fy / drag, 1.0 / (xx + yy)
    normal = fz
    for _ in range(_TURNS):
        lever = zz - friction * (xz * dx + yz * dy)
        if lever <= _JAMMED * zz:
            return fx, fy, fz
        normal = -bz / lever
        drag = friction * normal
        ax = bx + normal * xz - drag * (xx * dx + xy * dy)
        ay = by + normal * yz - drag * (xy * dx + yy * dy)
        # Newton's step to the direction along which it is accelerated, or, away from it, a projection.
        stiff, along = drag * (xx * dy * dy - 2.0 * xy * dx * dy + yy * dx * dx), ax * dx + ay * dy
        turn = (ay * dx - ax * dy) / (stiff + along) if stiff + 2.0 * along > 0.0 else 2.0
        if abs(turn) <= 1.0:
            ex, ey = dx - turn * dy, dy + turn * dx
        else:
            ex, ey = drag * dx + pace * ax, drag * dy + pace * ay
        size = sqrt(ex * ex + ey * ey)
        if size == 0.0:
            break
        ex, ey = ex / size, ey / size
        change = abs(ex - dx) + abs(ey - dy)
        dx, dy = ex, ey
        if change <= _CONVERGED:
            break
    return -friction * normal * dx, -friction * normal * dy, normal


def hold(y: Floats, stance: Stance, enough: float) -> None:
    """Take from the state's velocity what lets standing points leave their places, by the least impulse that does.

    A point that sticks comes to rest, one that slips goes on along the support.
    """
    held, label, arms, blocks, frame = stance[0], stance[1], stance[4], stance[5], stance[6]
    count = held[len(label)]
    jxx, jyy, jzz, jxy, jxz, jyz = frame[9], frame[10], frame[11], frame[12], frame[13], frame[14]
    vx, vy, vz, wx, wy, wz = y[7], y[8], y[9], y[10], y[11], y[12]
    for _ in range(_SWEEPS if count else 0):
        change = 0.0
        for k in range(count):
            i = held[k]
            rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
            o = 12 * i
            cx, cy, cz = vx + wy * rz - wz * ry, vy + wz * rx - wx * rz, vz + wx * ry - wy * rx
            fx, fy, fz = 0.0, 0.0, -cz / blocks[o + 2]
            if label[i] == STICKS:
                fx = -blocks[o + 6] * cx - blocks[o + 9] * cy - blocks[o + 10] * cz
                fy = -blocks[o + 9] * cx - blocks[o + 7] * cy - blocks[o + 11] * cz
                fz = -blocks[o + 10] * cx - blocks[o + 11] * cy - blocks[o + 8] * cz
            tx, ty, tz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
            vx, vy, vz = vx + fx, vy + fy, vz + fz
            wx += jxx * tx + jxy * ty + jxz * tz
            wy += jxy * tx + jyy * ty + jyz * tz
            wz += jxz * tx + jyz * ty + jzz * tz
            change = max(change, abs(fx), abs(fy), abs(fz))
        if change <= enough:
            break
    y[7], y[8], y[9], y[10], y[11], y[12] = vx, vy, vz, wx, wy, wz
