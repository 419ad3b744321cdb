"""The impact of any number of contacts in three dimensions, in contact space: how the impulses grow.

Law code on flat sequences (see `mechanics.compiled`), with the same bits in every form. Of n contacts the contact
velocities are `c` (3 n): along t1, t2 and the normal of one after the other, and impulses go like velocities. The
Delassus matrix is W = A A^T, so that impulses p change the motion v by A^T p, and the velocities are start + A v. A
rigid body has 6 such coordinates of motion, a mechanism up to 3 n.

`system` is (rows, start, friction, restitution, gaps): A row by row, the number of its columns a multiple of 6; the
velocities before the impact; numbers of each contact. `blocks` (`BLOCK` n) has zz, aa, bb, ab, az, bz of the 3 x 3
blocks of W on its diagonal; aa, bb, ab of the inverse of their tangential part, and one over its largest eigenvalue.
`springs` is (softness, bias, blocks, capped), as `sweep` takes them.

The path law: struck contacts are springs of one stiffness along a pseudo-time, with energetic restitution (Stronge); a
contact that rests has 0 <= dN _|_ c_n >= 0 at each instant; friction opposes the whole slip, or sticks (Routh and
Keller in three dimensions). A step is implicit, and takes the forces of springs and of slip at its middle: so neither
of them gives energy, and the error falls with the square of the step.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from ..compiled import Count, Floats, Ints

    System = tuple[Floats, Floats, Floats, Floats, Floats]
    Springs = tuple[Floats, Floats, Floats, Ints]

RESTING: Final = 0
LOADING: Final = 1
UNLOADING: Final = 2
OPEN: Final = 3

HARDEST: Final = 0.05
"""Steps resolve the unloading of a spring down to this restitution; below it the spring is stiffer than they are."""

SINGULAR: Final = 1e-12
"""Where the determinant of the tangential block is this part of its size, one direction alone moves."""

SLIDING: Final = 1.0 - 1e-9
"""A contact whose friction is more than this part of its greatest slides."""

PRESSED: Final = 0.1
"""A contact that answers to a push by less than this part, because its own friction presses it, is swept without."""

TOLERANCE: Final = 1e-2
"""Of the sweeps, relative, for one step to a quarter; it falls with their cube, as the error of a step does."""

SWEEPS: Final = 60

LOOSE: Final = 1e5
"""Sweeps that still change a velocity by so many tolerances have failed."""

THOROUGH: Final = 1000
"""Sweeps that may be needed where what is left has to vanish."""

ROUNDING: Final = 1e-12

UNBLENDED: Final = 0.999

FAR: Final = 1e9
"""The distance, in speeds, of a contact that is open while the others strike."""

STATE_ROUNDING: Final = 1e-4
"""A contact leaves, or slips, faster than this part of the fastest contact before the impact: sweeps err by less ..."""

APPROACHING: Final = 1e-5
"""... and one that approaches faster than this part has not been stopped."""

LEAVES: Final = 0
SLIPS: Final = 1
STICKS: Final = 2
NEARS: Final = 3

BLOCK: Final = 10
"""Numbers of a contact's block."""

WORK: Final = 21
"""Numbers for each contact that `solve` works with, besides as many as the motion has."""

NOT_CONVERGED: Final = 1
BLENDED: Final = 2

CUTS: Final = 4
"""How often a step is cut, until compressions end where it does ..."""

NEARLY: Final = 0.9
"""... up to this part of it; what is left of it then is lost to the contact alone."""

SLOW: Final = 0.4
"""No step is cut for a contact that is slower than this part of the fastest one, for one step to a quarter."""

LATEST: Final = 4
"""Quarters of its own oscillation after which a contact that has not closed is left to a later impact."""

LONGEST: Final = 100
"""Quarters of an oscillation after which a path that has not ended is ended plastically: a vice that closes has no end,
and on a floor paths end within a tenth of it."""


def sweep(
    n: Count,
    system: System,
    springs: Springs,
    before: Floats,
    middle: float,
    tolerance: float,
    most: int,
    v: Floats,
    p: Floats,
) -> int:
    """Solve for the impulses p of one step by projected Gauss-Seidel; how many sweeps it took, `most` if it failed.

    0 <= p_n _|_ c_n + softness p_n - bias >= 0 at each contact whose softness is not negative, and friction within
    its cone: sticking where c_t = 0 can be had, else against the slip c_t + middle before_t. A `capped` contact is
    not pushed faster than c_n = 0. The motion v has A^T p in it all along; it ends when no velocity changes by more
    than the tolerance.
    """
    rows, start, friction, restitution, gaps = system
    softness, bias, blocks, capped = springs
    r, change = len(v), 0.0
    for count in range(most):
        change = 0.0
        for k in range(n):
            # Forth and back, so that the order of the contacts matters less.
            i = k if count % 2 == 0 else n - 1 - k
            block = BLOCK * i
            soft, zz = softness[i], blocks[block]
            if soft < 0.0 or zz + soft <= 0.0:
                continue
            a, b, z = 3 * i, 3 * i + 1, 3 * i + 2
            cz = start[z]
            for j in range(0, r, 6):
                o = z * r + j
                cz += rows[o] * v[j] + rows[o + 1] * v[j + 1] + rows[o + 2] * v[j + 2]
                cz += rows[o + 3] * v[j + 3] + rows[o + 4] * v[j + 4] + rows[o + 5] * v[j + 5]
            press = p[z]
            if press == 0.0 and cz >= bias[i]:
                continue
            ca, cb, oldx, oldy, most_drag = start[a], start[b], p[a], p[b], friction[i]
            for j in range(0, r, 6):
                o, q = a * r + j, b * r + j
                v0, v1, v2, v3, v4, v5 = v[j], v[j + 1], v[j + 2], v[j + 3], v[j + 4], v[j + 5]
                ca += rows[o] * v0 + rows[o + 1] * v1 + rows[o + 2] * v2
                ca += rows[o + 3] * v3 + rows[o + 4] * v4 + rows[o + 5] * v5
                cb += rows[q] * v0 + rows[q + 1] * v1 + rows[q + 2] * v2
                cb += rows[q + 3] * v3 + rows[q + 4] * v4 + rows[q + 5] * v5
            aa, bb, ab, az, bz = (
                blocks[block + 1],
                blocks[block + 2],
                blocks[block + 3],
                blocks[block + 4],
                blocks[block + 5],
            )
            # While the contact slides its friction grows with the normal impulse: both change at once.
            ua = ub = 0.0
            size = sqrt(oldx * oldx + oldy * oldy)
            if size > 0.0 and size >= SLIDING * most_drag * press:
                part = most_drag / size
                ua, ub = part * oldx, part * oldy
                both = zz + az * ua + bz * ub
                if both >= PRESSED * zz:
                    zz = both
                else:
                    ua = ub = 0.0
            new = press - (cz + soft * press - bias[i]) / (zz + soft)
            if capped[i] == 1:
                new = min(new, press - cz / zz)
            new = max(new, 0.0)
            step, limit, x, y = new - press, most_drag * new, 0.0, 0.0
            nowx, nowy = oldx + ua * step, oldy + ub * step
            if limit > 0.0:
                x, y = nowx, nowy
                ca += (az + ua * aa + ub * ab) * step
                cb += (bz + ua * ab + ub * bb) * step
                sx = x - blocks[block + 6] * ca - blocks[block + 8] * cb
                sy = y - blocks[block + 8] * ca - blocks[block + 7] * cb
                if sx * sx + sy * sy <= limit * limit:
                    x, y = sx, sy
                else:
                    x -= blocks[block + 9] * (ca + middle * before[a])
                    y -= blocks[block + 9] * (cb + middle * before[b])
                    size = x * x + y * y
                    if size > limit * limit:
                        part = limit / sqrt(size)
                        x, y = part * x, part * y
            moved = step * step * zz * zz + (x - nowx) * (x - nowx) * aa * aa + (y - nowy) * (y - nowy) * bb * bb
            change = moved if moved > change else change
            p[a], p[b], p[z] = x, y, new
            x, y = x - oldx, y - oldy
            for j in range(0, r, 6):
                o, q, s = a * r + j, b * r + j, z * r + j
                v[j] += rows[o] * x + rows[q] * y + rows[s] * step
                v[j + 1] += rows[o + 1] * x + rows[q + 1] * y + rows[s + 1] * step
                v[j + 2] += rows[o + 2] * x + rows[q + 2] * y + rows[s + 2] * step
                v[j + 3] += rows[o + 3] * x + rows[q + 3] * y + rows[s + 3] * step
                v[j + 4] += rows[o + 4] * x + rows[q + 4] * y + rows[s + 4] * step
                v[j + 5] += rows[o + 5] * x + rows[q + 5] * y + rows[s + 5] * step
        if change <= tolerance * tolerance:
            return count + 1
    return most if change > LOOSE * LOOSE * tolerance * tolerance else most - 1


def velocities(system: System, v: Floats, c: Floats) -> None:
    """Contact velocities c of a motion v."""
    rows, start, friction, restitution, gaps = system
    r = len(v)
    for j in range(len(start)):
        speed = start[j]
        for k in range(0, r, 6):
            o = j * r + k
            speed += rows[o] * v[k] + rows[o + 1] * v[k + 1] + rows[o + 2] * v[k + 2]
            speed += rows[o + 3] * v[k + 3] + rows[o + 4] * v[k + 4] + rows[o + 5] * v[k + 5]
        c[j] = speed


def measure(at: Count, r: Count, rows: Floats, blocks: Floats, block: Count) -> None:
    """Fill in the block of the contact whose rows of r numbers begin at a place."""
    aa = bb = zz = ab = az = bz = 0.0
    for k in range(at, at + r):
        a, b, z = rows[k], rows[k + r], rows[k + 2 * r]
        aa, bb, zz, ab, az, bz = aa + a * a, bb + b * b, zz + z * z, ab + a * b, az + a * z, bz + b * z
    blocks[block], blocks[block + 1], blocks[block + 2], blocks[block + 3] = zz, aa, bb, ab
    blocks[block + 4], blocks[block + 5] = az, bz
    half, det, rest = 0.5 * (aa + bb), aa * bb - ab * ab, 0.5 * (aa - bb)
    if det > SINGULAR * half * half:
        blocks[block + 6], blocks[block + 7], blocks[block + 8] = bb / det, aa / det, -ab / det
    else:
        # One direction alone moves, or none: the inverse on it.
        part = 0.25 / (half * half) if half > 0.0 else 0.0
        blocks[block + 6], blocks[block + 7], blocks[block + 8] = part * aa, part * bb, part * ab
    blocks[block + 9] = 1.0 / (half + sqrt(rest * rest + ab * ab)) if half > 0.0 else 0.0


def push(system: System, p: Floats, v: Floats) -> None:
    """Add what impulses p do to a motion v."""
    rows, r = system[0], len(v)
    for j in range(len(p)):
        if p[j] != 0.0:
            for k in range(r):
                v[k] += rows[j * r + k] * p[j]


def follow(
    n: Count,
    system: System,
    springs: Springs,
    distances: Floats,
    threshold: float,
    steps: int,
    scale: float,
    c: Floats,
    impulse: Floats,
    scratch: tuple[Floats, Floats, Floats, Floats],
    depth: Floats,
    deepest: Floats,
    phase: Ints,
) -> int:
    """Follow the path: `c` becomes the velocities after it, `impulse` grows by what acted; whether it came to its end.

    Contacts that approach faster than `threshold` are struck, the others rest; one that is struck closes once it has
    come nearer by its distance, at speeds in the unit of the pseudo-time. `scale` is the speed that errors are measured
    by; `steps` resolve a quarter of an oscillation. The rest is scratch.
    """
    m = 3 * n
    restitution = system[3]
    softness, bias, blocks, capped = springs
    before, p, v, last_v = scratch
    struck = 0
    for i in range(n):
        p[3 * i] = p[3 * i + 1] = p[3 * i + 2] = 0.0
        deepest[i] = 0.0
        depth[i] = -distances[i]
        phase[i] = RESTING
        if c[3 * i + 2] < -threshold or depth[i] < 0.0:
            phase[i] = LOADING
            struck += 1
    elapsed = 0.0
    angle = 0.5 * pi / steps
    slow = SLOW * scale / steps
    tolerance = TOLERANCE * scale / (steps * steps * steps)
    last = 0.0
    for _ in range(LONGEST * steps):
        if struck == 0:
            return 1
        stiffest = 0.0
        for i in range(n):
            if phase[i] == LOADING or phase[i] == UNLOADING:
                e = 1.0 if phase[i] == LOADING else max(restitution[i], HARDEST)
                stiffest = max(stiffest, blocks[BLOCK * i] / (e * e))
        if stiffest == 0.0:
            return 0
        h = 0.5 * pi / (steps * sqrt(stiffest))
        for j in range(m):
            before[j] = c[j]
        for j in range(len(v)):
            last_v[j] = v[j]
        for _ in range(CUTS):
            ratio = h / last if last > 0.0 else 0.0
            last = h
            for i in range(n):
                z = 3 * i + 2
                keep = 0.0 if phase[i] == OPEN else ratio
                p[z - 2], p[z - 1], p[z] = keep * p[z - 2], keep * p[z - 1], keep * p[z]
                capped[i] = 0
                softness[i] = bias[i] = 0.0
                if phase[i] == OPEN:
                    softness[i] = -1.0
                elif phase[i] != RESTING:
                    # The force at the middle of the step, k (d - h (c + c') / 4), times h, solved for c'.
                    e = restitution[i]
                    stiffness = 1.0 / (e * e) if phase[i] == UNLOADING else 1.0
                    rest = (1.0 - e * e) * deepest[i] if phase[i] == UNLOADING else 0.0
                    softness[i] = 4.0 / (h * h * stiffness)
                    bias[i] = 4.0 * (depth[i] - rest) / h - before[z]
                    capped[i] = 1 if phase[i] == LOADING and e < angle else 0
            for j in range(len(v)):
                v[j] = last_v[j]
            push(system, p, v)
            sweep(n, system, springs, before, 1.0, tolerance, SWEEPS, v, p)
            velocities(system, v, c)
            # Where a compression ends within the step, the step ends there.
            part = 1.0
            for i in range(n):
                z = 3 * i + 2
                force = depth[i] - 0.25 * h * (before[z] + c[z])
                if capped[i] == 1 and before[z] < -slow and 0.0 < p[z] < h * force:
                    # Without the cap it would leave; of two at one place the cap leaves one without impulse.
                    leaves = c[z] + blocks[BLOCK * i] * (h * force - p[z])
                    part = min(part, before[z] / (before[z] - max(leaves, 0.0)))
            if part > NEARLY:
                break
            h *= part
        pushed = 0.0
        for i in range(n):
            if phase[i] != RESTING:
                pushed += p[3 * i + 2]
        if pushed == 0.0:
            # Without a push of springs the contacts that rest do nothing of themselves, though they could lock.
            for j in range(m):
                p[j] = 0.0
            for j in range(len(v)):
                v[j] = last_v[j]
            sweep(n, system, springs, before, 1.0, tolerance, SWEEPS, v, p)
            velocities(system, v, c)
        elapsed += h
        moves = 0.0
        for j in range(m):
            moves = max(moves, abs(before[j]), abs(c[j]))
            if moves > tolerance:
                break
        if moves <= tolerance:
            # The contacts lock the body, and the springs keep their work.
            return 1
        struck = 0
        for i in range(n):
            z = 3 * i + 2
            impulse[z] += p[z]
            impulse[z - 1] += p[z - 1]
            impulse[z - 2] += p[z - 2]
            nearer = -0.5 * h * (before[z] + c[z])
            if phase[i] == LOADING:
                force = depth[i] + 0.5 * nearer
                if capped[i] == 1 and p[z] < h * force:
                    nearer *= p[z] / (h * force)
                elif before[z] < 0.0 < c[z]:
                    # It was deepest within the step, where its speed was zero.
                    deepest[i] = max(deepest[i], depth[i] + 0.5 * h * before[z] * before[z] / (c[z] - before[z]))
                depth[i] += nearer
                deepest[i] = max(deepest[i], depth[i])
                if depth[i] > 0.0 and c[z] >= -tolerance:
                    phase[i] = UNLOADING if restitution[i] > 0.0 else RESTING
                elif deepest[i] > 0.0 or distances[i] == 0.0:
                    phase[i] = OPEN if c[z] >= 0.0 else LOADING
            elif phase[i] == UNLOADING:
                depth[i] += nearer
                if depth[i] > deepest[i]:
                    phase[i] = LOADING
                elif depth[i] <= (1.0 - restitution[i] * restitution[i]) * deepest[i]:
                    phase[i] = OPEN
            if phase[i] == OPEN:
                depth[i] = 0.0
            if phase[i] == OPEN and c[z] < -threshold:
                phase[i] = LOADING
                deepest[i] = 0.0
            if phase[i] == UNLOADING or (phase[i] == LOADING and depth[i] > 0.0):
                struck += 1
            elif phase[i] == LOADING and c[z] < 0.0:
                struck += 1 if elapsed * sqrt(blocks[BLOCK * i]) < LATEST * 0.5 * pi else 0
    return 0


def finish(
    n: Count,
    system: System,
    springs: Springs,
    scale: float,
    c: Floats,
    impulse: Floats,
    depth: Floats,
    p: Floats,
    v: Floats,
) -> int:
    """Stop plastically what still approaches of the contacts that have closed: sweeps as those of `sweep`."""
    softness, bias, blocks, capped = springs
    lowest = 0.0
    for i in range(n):
        bias[i] = 0.0
        capped[i] = 0
        softness[i] = -1.0 if depth[i] < 0.0 else 0.0
        if depth[i] >= 0.0:
            lowest = min(lowest, c[3 * i + 2])
    if lowest >= -ROUNDING * scale:
        return 0
    for j in range(len(p)):
        p[j] = 0.0
    used = sweep(n, system, springs, c, 0.0, ROUNDING * scale, THOROUGH, v, p)
    velocities(system, v, c)
    for j in range(len(p)):
        impulse[j] += p[j]
    return used


def solve(
    n: Count,
    system: System,
    total: bool,
    merge: float,
    threshold: float,
    steps: int,
    c: Floats,
    impulse: Floats,
    v: Floats,
    work: Floats,
    marks: Ints,
) -> int:
    """Solve an impact: c becomes the velocities after it, `impulse` what acted, v what it did to the motion, and
    marks[:n] the states of the contacts.

    The flags are `NOT_CONVERGED`, and `BLENDED` where the answer would have gained energy, which Newton's restitution
    can do, and the errors of steps. It works with `WORK` numbers for each contact, and as many as v
    has.
    """
    m = 3 * n
    rows, start, friction, restitution, gaps = system
    r = len(v)
    before, p, blocks, other = (
        work[0:m],
        work[m : 2 * m],
        work[2 * m : 2 * m + BLOCK * n],
        work[WORK * n : WORK * n + r],
    )
    o = 2 * m + BLOCK * n
    depth, deepest, distances = work[o : o + n], work[o + n : o + 2 * n], work[o + 2 * n : o + m]
    softness, bias = work[o + m : o + m + n], work[o + m + n : o + m + 2 * n]
    phase, capped = marks[0:n], marks[n : 2 * n]
    springs = (softness, bias, blocks, capped)
    for i in range(n):
        measure(3 * i * r, r, rows, blocks, BLOCK * i)
    scale = 0.0
    for j in range(m):
        c[j] = start[j]
        impulse[j] = 0.0
        scale = max(scale, abs(c[j]))
    for j in range(r):
        v[j] = 0.0
    flags = 0
    for i in range(n):
        # A compression lasts `merge`, a quarter of an oscillation in the pseudo-time.
        distances[i] = 0.0
        if gaps[i] > 0.0:
            w = blocks[BLOCK * i]
            distances[i] = gaps[i] / merge * 0.5 * pi / sqrt(w) if merge > 0.0 and w > 0.0 else FAR * scale
            if distances[i] <= ROUNDING * scale:
                # Rounding alone does not decide whether a slow contact is struck.
                distances[i] = 0.0
    if total:
        for i in range(n):
            # What closes within a compression has closed: this law knows no order.
            late = gaps[i] > merge * max(0.0, -c[3 * i + 2])
            depth[i] = -distances[i] if late else 0.0
            softness[i] = -1.0 if late else 0.0
            bias[i] = max(0.0, -restitution[i] * c[3 * i + 2])
            capped[i] = 0
        if sweep(n, system, springs, start, 0.0, ROUNDING * scale, THOROUGH, v, impulse) == THOROUGH:
            flags |= NOT_CONVERGED
    elif not follow(
        *(n, system, springs, distances, max(threshold, ROUNDING * scale), steps, scale, c, impulse),
        *((before, p, v, other), depth, deepest, phase),
    ):
        flags |= NOT_CONVERGED
    # Without the roundings of the steps.
    for j in range(r):
        v[j] = 0.0
    push(system, impulse, v)
    velocities(system, v, c)
    if finish(n, system, springs, scale, c, impulse, depth, p, v) == THOROUGH:
        flags |= NOT_CONVERGED
    gained = 0.0
    for j in range(m):
        gained += 0.5 * impulse[j] * (start[j] + c[j])
    if gained > 0.0:
        flags |= lose(n, system, springs, scale, c, impulse, depth, (before, p, v, other))
    zero = STATE_ROUNDING * scale
    for i in range(n):
        a = 3 * i
        if depth[i] < 0.0:
            marks[i] = NEARS
        elif c[a + 2] > zero:
            marks[i] = LEAVES
        else:
            marks[i] = SLIPS if c[a] * c[a] + c[a + 1] * c[a + 1] > zero * zero else STICKS
            if c[a + 2] < -APPROACHING * scale:
                flags |= NOT_CONVERGED
    return flags


def lose(
    n: Count,
    system: System,
    springs: Springs,
    scale: float,
    c: Floats,
    impulse: Floats,
    depth: Floats,
    scratch: tuple[Floats, Floats, Floats, Floats],
) -> int:
    """Draw an answer to the plastic one by so much that it gains no energy: both are in the same convex cones."""
    start = system[1]
    plastic, p, v, whole = scratch
    for j in range(len(c)):
        plastic[j] = 0.0
        c[j] = start[j]
    for k in range(len(v)):
        whole[k] = v[k]
        v[k] = 0.0
    finish(n, system, springs, scale, c, plastic, depth, p, v)
    # Along P = plastic + s (impulse - plastic) the work is a + b s + q s^2, and a <= 0 < a + b + q.
    a = b = q = 0.0
    for j in range(len(c)):
        a += plastic[j] * start[j]
        b += (impulse[j] - plastic[j]) * start[j]
    for k in range(len(v)):
        more = whole[k] - v[k]
        a += 0.5 * v[k] * v[k]
        b += v[k] * more
        q += 0.5 * more * more
    root = sqrt(max(0.0, b * b - 4.0 * q * min(a, 0.0)))
    s = -2.0 * min(a, 0.0) / (b + root) if b + root > 0.0 else 0.0
    for j in range(len(c)):
        impulse[j] = plastic[j] + s * (impulse[j] - plastic[j])
    for k in range(len(v)):
        v[k] += s * (whole[k] - v[k])
    velocities(system, v, c)
    return BLENDED if s < UNBLENDED else 0
