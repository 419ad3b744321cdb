"""A rigid body among plastic contacts with its support, in small steps that go on through every impact (Moreau, 1988).

Written as `reactions` is. In each step the impulses of all points that would reach the support obey non-penetration and
Coulomb's law as a whole: a strike ends plastically, and what stands is held. Errors are of the order of the step.
"""

from __future__ import annotations

from math import sqrt

from .reactions import OPEN, STICKS, Floats, Model, Stance, coulomb, locate, rates, share

_SWEEPS = 60
_CONVERGED = 1e-4
"""Change of a velocity in one sweep that ends them, relative to the scale of speeds: less than what a step errs by, and
the next step begins with the impulses that this one found."""


def advance(time: float, h: float, y: Floats, k: Floats, offsets: Floats, model: Model, stance: Stance) -> None:
    """One step of h seconds from `time` on: y is the state, k (13) is filled with its free motion."""
    points, _, _, friction, scale = model
    held, label, closing, impulses, arms, blocks, frame, _ = stance
    n = len(label)
    held[n] = 0
    rates(time, y, k, 0, False, model, stance)
    vx, vy, vz = y[7] + h * k[7], y[8] + h * k[8], y[9] + h * k[9]
    wx, wy, wz = y[10] + h * k[10], y[11] + h * k[11], y[12] + h * k[12]
    for i in range(n):
        px, py, pz = points[3 * i], points[3 * i + 1], points[3 * i + 2]
        rx, ry = frame[0] * px + frame[1] * py + frame[2] * pz, frame[3] * px + frame[4] * py + frame[5] * pz
        gap = y[2] + frame[6] * px + frame[7] * py + frame[8] * pz - offsets[i]
        label[i] = OPEN
        if gap + h * (vz + wx * ry - wy * rx) <= 0.0:
            label[i] = STICKS
            held[held[n]] = i
            held[n] += 1
            closing[2 * i] = max(gap, 0.0) / h  # how fast it may still approach
        else:
            impulses[3 * i] = impulses[3 * i + 1] = impulses[3 * i + 2] = 0.0
    count = held[n]
    locate(y, model, stance)
    jxx, jyy, jzz, jxy, jxz, jyz = frame[9], frame[10], frame[11], frame[12], frame[13], frame[14]
    for sweep in range(_SWEEPS if count else 0):
        change = 0.0
        for slot in range(count):
            i = held[slot]
            rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
            fx, fy, fz = 0.0, 0.0, 0.0
            if sweep > 0:
                fx, fy, fz = impulses[3 * i], impulses[3 * i + 1], impulses[3 * i + 2]
                o = 12 * i
                bx = vx + wy * rz - wz * ry - blocks[o] * fx - blocks[o + 3] * fy - blocks[o + 4] * fz
                by = vy + wz * rx - wx * rz - blocks[o + 3] * fx - blocks[o + 1] * fy - blocks[o + 5] * fz
                bz = vz + wx * ry - wy * rx - blocks[o + 4] * fx - blocks[o + 5] * fy - blocks[o + 2] * fz
                nx, ny, nz = coulomb(blocks, o, bx, by, bz + closing[2 * i], friction[i])
            else:
                nx, ny, nz = impulses[3 * i], impulses[3 * i + 1], impulses[3 * i + 2]
            impulses[3 * i], impulses[3 * i + 1], impulses[3 * i + 2] = nx, ny, nz
            fx, fy, fz = nx - fx, ny - fy, nz - fz
            tx, ty, tz = ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx
            vx, vy, vz = vx + fx, vy + fy, vz + fz
            wx += jxx * tx + jxy * ty + jxz * tz
            wy += jxy * tx + jyy * ty + jyz * tz
            wz += jxz * tx + jyz * ty + jzz * tz
            change = max(change, abs(fx), abs(fy), abs(fz))
        if sweep > 0 and change <= _CONVERGED * scale[1]:
            break
        share(held, label, arms, impulses)
    # Free motion is exact to second order; an impulse acts at once.
    part = 0.5 if count == 0 else 0.0
    y[0] += h * (vx + part * (y[7] - vx))
    y[1] += h * (vy + part * (y[8] - vy))
    y[2] += h * (vz + part * (y[9] - vz))
    ux, uy = 0.5 * h * (wx + part * (y[10] - wx)), 0.5 * h * (wy + part * (y[11] - wy))
    uz = 0.5 * h * (wz + part * (y[12] - wz))
    a, b, c, d = y[3], y[4], y[5], y[6]
    y[3], y[4] = a + ux * d + uy * c - uz * b, b + uy * d + uz * a - ux * c
    y[5], y[6] = c + uz * d + ux * b - uy * a, d - ux * a - uy * b - uz * c
    length = 1.0 / sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6])
    y[3], y[4], y[5], y[6] = y[3] * length, y[4] * length, y[5] * length, y[6] * length
    y[7], y[8], y[9], y[10], y[11], y[12] = vx, vy, vz, wx, wy, wz
