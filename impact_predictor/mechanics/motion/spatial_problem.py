"""Problems of a rigid body over its support in flat sequences: what is given, what is worked with, what is answered.

Written as `reactions` is. Numbers of a problem: horizon; place, quaternion, velocity and angular velocity; the
inertia over the mass as xx yy zz xy xz yz; gravity, its growth, angular velocity and acceleration of the frame;
friction (n); points (3 n). `marks` (5 n + 1) of points that stand are not 0. An answer: time, state, and of each point
its gap and its rate.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Final

from .falling import follow, normalise
from .reactions import OPEN, locate

if TYPE_CHECKING:
    from ..compiled import Count, Floats, Ints
    from .reactions import Model, Stance

_STICKY: Final = 1e6
"""More friction makes no difference."""
_LARGEST: Final = 1e100

INPUT: Final = 32
"""Numbers of a problem before those of its points: horizon, state, inertia over mass, pull; friction and points."""
OUTPUT: Final = 14
"""Numbers of an answer before those of its points: time and state; gap and rate of each."""
WORK = 162, 38, 9
"""Numbers to work with: some, some for each point, and some for each pair of points."""
INVALID: Final = -2


def prepare(n: Count, numbers: Floats, marks: Ints, work: Floats) -> tuple[bool, Floats, Floats, Model, Stance]:
    """Whether a body can have these numbers; its state, the offsets of its points' gaps, and what moves it."""
    y, body, pull, scale, frame = work[0:13], work[13:26], work[26:39], work[39:43], work[43:58]
    o = 58
    points, friction, offsets = work[o : o + 3 * n], work[o + 3 * n : o + 4 * n], work[o + 4 * n : o + 5 * n]
    o += 5 * n
    toward, forces, arms = work[o : o + 2 * n], work[o + 2 * n : o + 5 * n], work[o + 5 * n : o + 8 * n]
    blocks, rows = work[o + 8 * n : o + 20 * n], work[o + 20 * n : o + 23 * n + 9 * n * n]
    label, held, order = marks[0:n], marks[n : 2 * n + 1], marks[2 * n + 1 : 5 * n + 1]
    model = (points, body, pull, friction, scale)
    stance = (held, label, toward, forces, arms, blocks, frame, rows, order)
    for i in range(INPUT + 4 * n):
        if not -_LARGEST <= numbers[i] <= _LARGEST:
            return False, y, offsets, model, stance
    for i in range(13):
        y[i] = numbers[1 + i]
    turned = y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6]
    if not (numbers[0] >= 0.0 and turned > 0.0 and fill_body(numbers, body)):
        return False, y, offsets, model, stance
    normalise(y)
    pull[12] = 0.0
    for i in range(12):
        pull[i] = numbers[20 + i]
        if i >= 6 and pull[i] != 0.0:
            pull[12] = 1.0
    size = 0.0
    for i in range(n):
        if numbers[INPUT + i] < 0.0:
            return False, y, offsets, model, stance
        friction[i], square = min(numbers[INPUT + i], _STICKY), 0.0
        for j in range(3):
            points[3 * i + j], forces[3 * i + j] = numbers[INPUT + n + 3 * i + j], 0.0
            square += points[3 * i + j] * points[3 * i + j]
        size = max(size, square)
        toward[2 * i], toward[2 * i + 1] = 1.0, 0.0
    size = sqrt(size) if size > 0.0 else 1.0
    turn = y[10] * y[10] + y[11] * y[11] + y[12] * y[12]
    weight = sqrt(pull[0] * pull[0] + pull[1] * pull[1] + pull[2] * pull[2]) + turn * size
    weight = weight if weight > 0.0 else 1.0
    speed = sqrt(y[7] * y[7] + y[8] * y[8] + y[9] * y[9]) + size * sqrt(turn) + sqrt(weight * size)
    scale[0], scale[1], scale[2], scale[3] = size, speed, weight, 0.0
    held[n] = 0
    locate(y, model, stance)
    for i in range(n):
        offsets[i] = 0.0
        if label[i] != OPEN:
            px, py, pz = points[3 * i], points[3 * i + 1], points[3 * i + 2]
            offsets[i] = y[2] + frame[6] * px + frame[7] * py + frame[8] * pz
            held[held[n]] = i
            held[n] += 1
    return True, y, offsets, model, stance


def fill_body(numbers: Floats, body: Floats) -> bool:
    """The inertia over the mass, its inverse, and whether it is the same about all axes; False where no body has it."""
    xx, yy, zz, xy, xz, yz = numbers[14], numbers[15], numbers[16], numbers[17], numbers[18], numbers[19]
    c0, c1, c2 = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    det, largest = xx * c0 + xy * c1 + xz * c2, max(xx, yy, zz)
    if not (xx > 0.0 and xx * yy - xy * xy > 0.0 and det > 1e-12 * largest * largest * largest):
        return False
    body[0], body[1], body[2], body[3], body[4], body[5] = xx, yy, zz, xy, xz, yz
    body[6], body[7], body[8] = c0 / det, (xx * zz - xz * xz) / det, (xx * yy - xy * xy) / det
    body[9], body[10], body[11] = c1 / det, c2 / det, (xy * xz - xx * yz) / det
    body[12] = 1.0 if xx == yy == zz and xy == xz == yz == 0.0 else 0.0
    return True


def fall(n: Count, numbers: Floats, marks: Ints, work: Floats, out: Floats) -> int:
    """The point that strikes next, -1 for none, INVALID for numbers that no body can have; the marks of what stands."""
    valid, y, offsets, model, stance = prepare(n, numbers, marks, work)
    if not valid:
        return INVALID
    o = WORK[0] - 104 + (WORK[1] - 10) * n + WORK[2] * n * n
    k, trial = work[o : o + 91], work[o + 91 : o + 104]
    o += 104
    now, then = work[o : o + 3 * n], work[o + 3 * n : o + 6 * n]
    before, after = work[o + 6 * n : o + 8 * n], work[o + 8 * n : o + 10 * n]
    for i in range(2 * n):
        before[i] = after[i] = 0.0
    out[0], point = follow(y, numbers[0], offsets, model, stance, (k, trial, now, then, before, after))
    for i in range(13):
        out[1 + i] = y[i]
    for i in range(n):
        out[OUTPUT + 2 * i], out[OUTPUT + 2 * i + 1] = now[3 * i], now[3 * i + 1]
        marks[i] = stance[1][i]
    return point
