"""The impact of any number of contacts in three dimensions, in contact space: how the impulses grow.

Everything here is law code on flat sequences: lists where it runs as Python, arrays where numba compiles it, with the
same bits. Of n contacts the contact velocities are `c` (3 n): along t1, t2 and the normal of one after the other, `W`
(9 n^2) is the Delassus matrix row by row, and impulses go like velocities.

The path law: struck contacts are springs of one stiffness along a pseudo-time, with energetic restitution (Stronge); a
contact that rests has 0 <= dN _|_ c_n >= 0 at each instant; friction opposes the whole slip, or sticks (Routh and
Keller in three dimensions). A step is implicit, and takes the forces of springs and of slip at its middle: so neither
of them gives energy, and the error falls with the square of the step.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from math import pi, sqrt

Given = Sequence[float]
Scratch = MutableSequence[float]

RESTING, LOADING, UNLOADING, OPEN = 0, 1, 2, 3

HARDEST = 0.05
"""Steps resolve the unloading of a spring down to this restitution; below it the spring is stiffer than they are."""

SINGULAR = 1e-12
"""Where the determinant of the tangential block is this part of its size, one direction alone moves."""

SLIDING = 1.0 - 1e-9
"""A contact whose friction is more than this part of its greatest slides."""

PRESSED = 0.1
"""A contact that answers to a push by less than this part, because its own friction presses it, is swept without."""

TOLERANCE = 1e-3
"""Of the sweeps, relative, for one step to a quarter; it falls with their cube, as the error of a step does."""

SWEEPS = 60

LOOSE = 1e5
"""Sweeps that still change a velocity by so many tolerances have failed."""

THOROUGH = 1000
"""Sweeps that may be needed where what is left has to vanish."""

ROUNDING = 1e-12

UNBLENDED = 0.999

FAR = 1e9
"""The distance, in speeds, of a contact that is open while the others strike."""

STATE_ROUNDING = 1e-5
"""A contact leaves, or slips, faster than this part of the fastest contact before the impact."""

LEAVES, SLIPS, STICKS, NEARS = 0, 1, 2, 3

NOT_CONVERGED, BLENDED = 1, 2

CUTS = 4
"""How often a step is cut, until compressions end where it does ..."""

NEARLY = 0.9
"""... up to this part of it; what is left of it then is lost to the contact alone."""

SLOW = 0.4
"""No step is cut for a contact that is slower than this part of the fastest one, for one step to a quarter."""

LATEST = 4
"""Quarters of its own oscillation after which a contact that has not closed is left to a later impact."""

LONGEST = 100
"""Quarters of an oscillation after which a path that has not ended is ended plastically: a vice that closes has no end,
and on a floor paths end within a tenth of it."""


def sweep(
    n: int,
    W: Given,
    before: Given,
    friction: Given,
    softness: Given,
    bias: Given,
    capped: Sequence[int],
    middle: float,
    tolerance: float,
    most: int,
    c: Scratch,
    p: Scratch,
) -> int:
    """Solve for the impulses p of one step by projected Gauss-Seidel; how many sweeps it took, `most` if it failed.

    0 <= p_n _|_ c_n + softness p_n - bias >= 0 at each contact whose softness is not negative, and friction within
    its cone: sticking where c_t = 0 can be had, else against the slip c_t + middle before_t. A `capped` contact is
    not pushed faster than c_n = 0. `c` is `before` + W p all along; it ends when no velocity changes by more than the
    tolerance.
    """
    m = 3 * n
    change = 0.0
    for count in range(most):
        change = 0.0
        for k in range(n):
            # Forth and back, so that the order of the contacts matters less.
            i = k if count % 2 == 0 else n - 1 - k
            if softness[i] < 0.0:
                continue
            a = 3 * i
            b = a + 1
            z = a + 2
            wzz = W[z * m + z]
            if wzz + softness[i] <= 0.0:
                continue
            # While the contact slides its friction grows with the normal impulse: both change at once.
            ua = ub = 0.0
            size = sqrt(p[a] * p[a] + p[b] * p[b])
            if size > 0.0 and size >= SLIDING * friction[i] * p[z]:
                ua = friction[i] * p[a] / size
                ub = friction[i] * p[b] / size
                both = wzz + W[z * m + a] * ua + W[z * m + b] * ub
                if both >= PRESSED * wzz:
                    wzz = both
                else:
                    ua = ub = 0.0
            new = p[z] - (c[z] + softness[i] * p[z] - bias[i]) / (wzz + softness[i])
            if capped[i] == 1:
                new = min(new, p[z] - c[z] / wzz)
            if new < 0.0:
                new = 0.0
            step = new - p[z]
            if step != 0.0:
                p[z] = new
                p[a] += ua * step
                p[b] += ub * step
                for j in range(m):
                    c[j] += (W[z * m + j] + ua * W[a * m + j] + ub * W[b * m + j]) * step
                change = max(change, abs(step) * wzz)
            limit = friction[i] * new
            if limit == 0.0:
                x = y = 0.0
            else:
                waa = W[a * m + a]
                wab = W[a * m + b]
                wbb = W[b * m + b]
                x = p[a]
                y = p[b]
                half = 0.5 * (waa + wbb)
                det = waa * wbb - wab * wab
                if det > SINGULAR * half * half:
                    sx = x - (wbb * c[a] - wab * c[b]) / det
                    sy = y - (waa * c[b] - wab * c[a]) / det
                elif half > 0.0:
                    # One direction alone moves: the inverse on it.
                    sx = x - (waa * c[a] + wab * c[b]) / (4.0 * half * half)
                    sy = y - (wab * c[a] + wbb * c[b]) / (4.0 * half * half)
                else:
                    sx = x
                    sy = y
                if sx * sx + sy * sy <= limit * limit:
                    x = sx
                    y = sy
                elif half > 0.0:
                    rest = 0.5 * (waa - wbb)
                    w = half + sqrt(rest * rest + wab * wab)
                    x -= (c[a] + middle * before[a]) / w
                    y -= (c[b] + middle * before[b]) / w
                    size = sqrt(x * x + y * y)
                    if size > limit:
                        x *= limit / size
                        y *= limit / size
            dx = x - p[a]
            dy = y - p[b]
            if dx != 0.0 or dy != 0.0:
                p[a] = x
                p[b] = y
                for j in range(m):
                    c[j] += W[a * m + j] * dx + W[b * m + j] * dy
                change = max(change, abs(dx) * W[a * m + a], abs(dy) * W[b * m + b])
        if change <= tolerance:
            return count + 1
    return most if change > LOOSE * tolerance else most - 1


def follow(
    n: int,
    W: Given,
    friction: Given,
    restitution: Given,
    distances: Given,
    threshold: float,
    steps: int,
    scale: float,
    c: Scratch,
    impulse: Scratch,
    before: Scratch,
    p: Scratch,
    depth: Scratch,
    deepest: Scratch,
    softness: Scratch,
    bias: Scratch,
    phase: MutableSequence[int],
    capped: MutableSequence[int],
) -> int:
    """Follow the path: `c` becomes the velocities after it, `impulse` grows by what acted; whether it came to its end.

    Contacts that approach faster than `threshold` are struck, the others rest; one that is struck closes once it has
    come nearer by its distance, at speeds in the unit of the pseudo-time. `scale` is the speed that errors are measured
    by; `steps` resolve a quarter of an oscillation. The rest is scratch.
    """
    m = 3 * n
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
                stiffest = max(stiffest, W[(3 * i + 2) * (m + 1)] / (e * e))
        if stiffest == 0.0:
            return 0
        h = 0.5 * pi / (steps * sqrt(stiffest))
        for j in range(m):
            before[j] = c[j]
        for _ in range(CUTS):
            ratio = h / last if last > 0.0 else 0.0
            last = h
            for j in range(m):
                c[j] = before[j]
                p[j] *= ratio
            for i in range(n):
                capped[i] = 0
                if phase[i] == OPEN:
                    softness[i] = -1.0
                    p[3 * i] = p[3 * i + 1] = p[3 * i + 2] = 0.0
                elif phase[i] == RESTING:
                    softness[i] = bias[i] = 0.0
                else:
                    # The force at the middle of the step, k (d - h (c + c') / 4), times h, solved for c'.
                    e = restitution[i]
                    stiffness = 1.0 / (e * e) if phase[i] == UNLOADING else 1.0
                    rest = (1.0 - e * e) * deepest[i] if phase[i] == UNLOADING else 0.0
                    softness[i] = 4.0 / (h * h * stiffness)
                    bias[i] = 4.0 * (depth[i] - rest) / h - c[3 * i + 2]
                    capped[i] = 1 if phase[i] == LOADING and e < angle else 0
            for j in range(m):
                if p[j] != 0.0:
                    for k in range(m):
                        c[k] += W[j * m + k] * p[j]
            sweep(n, W, before, friction, softness, bias, capped, 1.0, tolerance, SWEEPS, c, p)
            # Where a compression ends within the step, the step ends there.
            part = 1.0
            for i in range(n):
                z = 3 * i + 2
                force = depth[i] - 0.25 * h * (before[z] + c[z])
                if capped[i] == 1 and before[z] < -slow and 0.0 < p[z] < h * force:
                    # Without the cap it would leave; of two at one place the cap leaves one without impulse.
                    leaves = c[z] + W[z * (m + 1)] * (h * force - p[z])
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
                c[j] = before[j]
                p[j] = 0.0
            sweep(n, W, before, friction, softness, bias, capped, 1.0, tolerance, SWEEPS, c, p)
        elapsed += h
        moves = 0.0
        for j in range(m):
            moves = max(moves, abs(before[j]), abs(c[j]))
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
                struck += 1 if elapsed * sqrt(W[z * (m + 1)]) < LATEST * 0.5 * pi else 0
    return 0


def finish(
    n: int,
    W: Given,
    friction: Given,
    scale: float,
    c: Scratch,
    impulse: Scratch,
    before: Scratch,
    p: Scratch,
    depth: Given,
    softness: Scratch,
    bias: Scratch,
    capped: MutableSequence[int],
) -> int:
    """Stop plastically what still approaches of the contacts that have closed: sweeps as those of `sweep`."""
    lowest = 0.0
    for i in range(n):
        bias[i] = 0.0
        capped[i] = 0
        softness[i] = -1.0 if depth[i] < 0.0 else 0.0
        if depth[i] >= 0.0:
            lowest = min(lowest, c[3 * i + 2])
    if lowest >= -ROUNDING * scale:
        return 0
    m = 3 * n
    for j in range(m):
        before[j] = c[j]
        p[j] = 0.0
    used = sweep(n, W, before, friction, softness, bias, capped, 0.0, ROUNDING * scale, THOROUGH, c, p)
    for j in range(m):
        impulse[j] += p[j]
    return used


def solve(
    n: int,
    W: Given,
    friction: Given,
    restitution: Given,
    gaps: Given,
    total: bool,
    merge: float,
    threshold: float,
    steps: int,
    c: Scratch,
    impulse: Scratch,
    scratch: Sequence[Scratch],
    marks: Sequence[MutableSequence[int]],
) -> int:
    """Solve an impact: `c` becomes the velocities after it, `impulse` what acted, marks[0] the states of the contacts.

    The flags are `NOT_CONVERGED`, and `BLENDED` where the answer would have gained energy, which Newton's restitution
    can do, and the errors of steps.
    """
    before, p, depth, deepest, softness, bias, start, plastic, distances = scratch
    phase, capped = marks
    m = 3 * n
    scale = 0.0
    for j in range(m):
        start[j] = c[j]
        impulse[j] = 0.0
        scale = max(scale, abs(c[j]))
    flags = 0
    for i in range(n):
        # A compression lasts `merge`, a quarter of an oscillation in the pseudo-time.
        distances[i] = 0.0
        if gaps[i] > 0.0:
            w = W[(3 * i + 2) * (m + 1)]
            distances[i] = gaps[i] / merge * 0.5 * pi / sqrt(w) if merge > 0.0 and w > 0.0 else FAR * scale
    if total:
        for i in range(n):
            softness[i] = 0.0
            bias[i] = max(0.0, -restitution[i] * c[3 * i + 2])
            capped[i] = 0
            # What closes within a compression has closed: this law knows no order.
            late = gaps[i] > merge * max(0.0, -c[3 * i + 2])
            depth[i] = -distances[i] if late else 0.0
            if late:
                softness[i] = -1.0
        for j in range(m):
            p[j] = 0.0
        if (
            sweep(n, W, start, friction, softness, bias, capped, 0.0, ROUNDING * scale, THOROUGH, c, impulse)
            == THOROUGH
        ):
            flags |= NOT_CONVERGED
    elif not follow(
        *(n, W, friction, restitution, distances, max(threshold, ROUNDING * scale), steps, scale, c, impulse),
        *(before, p, depth, deepest, softness, bias, phase, capped),
    ):
        flags |= NOT_CONVERGED
    for j in range(m):
        # Without the roundings of the steps.
        c[j] = start[j]
    for k in range(m):
        if impulse[k] != 0.0:
            for j in range(m):
                c[j] += W[k * m + j] * impulse[k]
    if finish(n, W, friction, scale, c, impulse, before, p, depth, softness, bias, capped) == THOROUGH:
        flags |= NOT_CONVERGED
    work = 0.0
    for j in range(m):
        work += 0.5 * impulse[j] * (start[j] + c[j])
    if work > 0.0:
        flags |= lose(n, W, friction, scale, start, c, impulse, plastic, before, p, depth, softness, bias, capped)
    zero = STATE_ROUNDING * scale
    for i in range(n):
        a = 3 * i
        if depth[i] < 0.0:
            phase[i] = NEARS
        elif c[a + 2] > zero:
            phase[i] = LEAVES
        else:
            phase[i] = SLIPS if c[a] * c[a] + c[a + 1] * c[a + 1] > zero * zero else STICKS
            if c[a + 2] < -zero:
                flags |= NOT_CONVERGED
    return flags


def lose(
    n: int,
    W: Given,
    friction: Given,
    scale: float,
    start: Given,
    c: Scratch,
    impulse: Scratch,
    plastic: Scratch,
    before: Scratch,
    p: Scratch,
    depth: Given,
    softness: Scratch,
    bias: Scratch,
    capped: MutableSequence[int],
) -> int:
    """Draw an answer to the plastic one by so much that it gains no energy: both are in the same convex cones."""
    m = 3 * n
    for j in range(m):
        plastic[j] = 0.0
        c[j] = start[j]
    finish(n, W, friction, scale, c, plastic, before, p, depth, softness, bias, capped)
    # Along P = plastic + s (impulse - plastic) the work is a + b s + q s^2, and a <= 0 < a + b + q.
    a = b = q = 0.0
    for j in range(m):
        more = impulse[j] - plastic[j]
        wp = wm = 0.0
        for k in range(m):
            wp += W[j * m + k] * plastic[k]
            wm += W[j * m + k] * (impulse[k] - plastic[k])
        a += plastic[j] * (start[j] + 0.5 * wp)
        b += more * (start[j] + wp)
        q += 0.5 * more * wm
    root = sqrt(max(0.0, b * b - 4.0 * q * min(a, 0.0)))
    s = -2.0 * min(a, 0.0) / (b + root) if b + root > 0.0 else 0.0
    for j in range(m):
        impulse[j] = plastic[j] + s * (impulse[j] - plastic[j])
    for j in range(m):
        c[j] = start[j]
        for k in range(m):
            c[j] += W[j * m + k] * impulse[k]
    return BLENDED if s < UNBLENDED else 0
