"""What the standing points of a rigid body do: which of them stick, slip and lift, and when that changes.

Written as `reactions` is, whose `model` and `stance` it takes; k is the derivative of the state y.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Final

from .reactions import CREEPS, OPEN, SLIPS, STICKS, drag, hold, locate, rates

if TYPE_CHECKING:
    from ..compiled import Count, Floats, Ints
    from .reactions import Model, Stance

_FORCE: Final = 1e-6
_SLIP: Final = 1e-7
"""How near to its zero an event is found, relative to the scales. Forces are continuous there."""
_ALIKE: Final = 10.0
"""Factor on these within which the events of several points are one."""
_VEERS: Final = 1e-5
"""Error in a step, relative to the scale of speeds, by the direction of a creeping point's friction, which lags."""
SLOW: Final = 1e-3
"""Relative to the scale of speeds: a slower slip creeps."""
NONE: Final = 1e-8
"""Relative to the scale of speeds: a slower slip is none."""
ROUNDING: Final = 1e-10
"""Relative to the scales: gaps, speeds and accelerations below count as none."""
_RESTS: Final = 1e-6
"""Relative to the scales: a body is at rest that moves and is accelerated by less."""
_STEADY: Final = 2.0
"""Steps, in the time in which friction would stop the slowest slip: it takes 3.3 to make them unstable."""
_SAFE: Final = 1.1
"""Factor on the overturning moment of friction below which a body surely lies flat."""
_TINY: Final = 1e-300
_LONG: Final = 1e6


def settle(time: float, y: Floats, k: Floats, may_change: bool, model: Model, stance: Stance) -> None:
    """Which of the standing points stick, slip and lift, with the derivative of y into k[:13]; a jam ends its slip.

    Unless they `may_change`, each does what it did before.
    """
    friction, scale = model[3], model[4]
    held, label, toward, forces, arms = stance[0], stance[1], stance[2], stance[3], stance[4]
    n = len(label)
    scale[3] = scale[1]
    for slot in range(held[n]):
        if label[held[slot]] == SLIPS:
            head(y, held[slot], model, stance)
    if not may_change:
        rates(time, y, k, 0, False, model, stance)
        return
    if rates(time, y, k, 0, True, model, stance) >= 0:
        stop(y, model, stance, 2.0)
        if rates(time, y, k, 0, True, model, stance) >= 0:
            # No forces within their cones go with the motion, and friction is so large that the points hold.
            rates(time, y, k, 0, False, model, stance)
            return
    count, kept = held[n], 0
    wx, wy, wz = y[10], y[11], y[12]
    square = wx * wx + wy * wy + wz * wz
    for slot in range(count):
        i = held[slot]
        rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
        along = wx * rx + wy * ry + wz * rz
        ax = k[7] + k[11] * rz - k[12] * ry + wx * along - rx * square
        ay = k[8] + k[12] * rx - k[10] * rz + wy * along - ry * square
        az = k[9] + k[10] * ry - k[11] * rx + wz * along - rz * square
        tx, ty, normal = forces[3 * i], forces[3 * i + 1], forces[3 * i + 2]
        if normal <= 0.0 and az > _FORCE * scale[2]:
            label[i] = OPEN
            forces[3 * i] = forces[3 * i + 1] = forces[3 * i + 2] = 0.0
            continue
        slip = sqrt(ax * ax + ay * ay)
        saturated = sqrt(tx * tx + ty * ty) >= (1.0 - ROUNDING) * friction[i] * normal
        if label[i] == STICKS and saturated and slip > _FORCE * scale[2]:
            label[i] = CREEPS
            toward[2 * i], toward[2 * i + 1] = ax / slip, ay / slip
        held[kept] = i
        kept += 1
    held[n] = kept
    rates(time, y, k, 0, False, model, stance)


def stand(y: Floats, i: Count, model: Model, stance: Stance) -> None:
    """Let point i stand: it slips if it moves along the support."""
    held, label, forces = stance[0], stance[1], stance[3]
    n = len(label)
    held[held[n]] = i
    held[n] += 1
    forces[3 * i] = forces[3 * i + 1] = forces[3 * i + 2] = 0.0
    locate(y, model, stance)
    label[i] = SLIPS
    if head(y, i, model, stance) <= NONE:
        label[i] = STICKS


def drop(i: Count, stance: Stance) -> None:
    """Take point i out of those that stand."""
    held, label, forces = stance[0], stance[1], stance[3]
    n, kept = len(label), 0
    for slot in range(held[n]):
        if held[slot] != i:
            held[kept] = held[slot]
            kept += 1
    held[n] = kept
    forces[3 * i] = forces[3 * i + 1] = forces[3 * i + 2] = 0.0


def head(y: Floats, i: Count, model: Model, stance: Stance) -> float:
    """Take the direction of point i's slip; its speed, relative to the scale."""
    friction = model[3]
    label, toward, arms = stance[1], stance[2], stance[4]
    sx = y[7] + y[11] * arms[3 * i + 2] - y[12] * arms[3 * i + 1]
    sy = y[8] + y[12] * arms[3 * i] - y[10] * arms[3 * i + 2]
    slip = sqrt(sx * sx + sy * sy)
    part: float = slip / model[4][1]
    if label[i] == CREEPS:
        if part > 2.0 * SLOW:
            label[i] = SLIPS
        elif friction[i] > 0.0:
            sx, sy = drag(y, i, model, stance)
            toward[2 * i], toward[2 * i + 1] = -sx / friction[i], -sy / friction[i]
    if label[i] == SLIPS and part > NONE:
        toward[2 * i], toward[2 * i + 1] = sx / slip, sy / slip
        if part < SLOW:
            label[i] = CREEPS
    return part


def stop(y: Floats, model: Model, stance: Stance, slowest: float) -> None:
    """Let points stick that slip more slowly than a part of the scale of speeds; all, by an impulse, where they jam."""
    held, label, forces = stance[0], stance[1], stance[3]
    locate(y, model, stance)
    for slot in range(held[len(label)]):
        i = held[slot]
        if slowest > 1.0:
            forces[3 * i] = forces[3 * i + 1] = forces[3 * i + 2] = 0.0
        if label[i] >= SLIPS and (slowest > 1.0 or head(y, i, model, stance) < slowest):
            label[i] = STICKS
    hold(y, stance, ROUNDING * model[4][1])


def margins(y: Floats, model: Model, stance: Stance, out: Floats) -> None:
    """How far each standing point is from a change, relative to the scales, into `out` (2 n): normal force, and what
    is left of its cone of friction or of its slip.
    """
    friction, scale = model[3], model[4]
    held, label, toward, forces, arms = stance[0], stance[1], stance[2], stance[3], stance[4]
    for k in range(held[len(label)]):
        i = held[k]
        out[2 * i] = forces[3 * i + 2] / scale[2]
        if label[i] >= SLIPS:
            sx = y[7] + y[11] * arms[3 * i + 2] - y[12] * arms[3 * i + 1]
            sy = y[8] + y[12] * arms[3 * i] - y[10] * arms[3 * i + 2]
            out[2 * i + 1] = (sx * toward[2 * i] + sy * toward[2 * i + 1]) / scale[1] if friction[i] > 0.0 else 1.0
        else:
            tx, ty = forces[3 * i], forces[3 * i + 1]
            out[2 * i + 1] = (friction[i] * forces[3 * i + 2] - sqrt(tx * tx + ty * ty)) / scale[2]


def near(m: Count, label: Ints) -> float:
    """How near to zero a margin counts as zero."""
    return _SLIP if m % 2 == 1 and label[m // 2] >= SLIPS else _FORCE


def change(event: Count, y: Floats, before: Floats, model: Model, stance: Stance) -> None:
    """Let the point of this margin lift, stick, or begin to slip, with all others that do so now."""
    held, label, toward, forces = stance[0], stance[1], stance[2], stance[3]
    kind, which, count = label[event // 2], event % 2, held[len(label)]
    if which == 1 and kind >= SLIPS:
        stop(y, model, stance, SLOW if head(y, event // 2, model, stance) <= SLOW else 0.0)
        return
    for slot in range(count - 1, -1, -1):
        i = held[slot]
        if before[2 * i + which] > _ALIKE * _FORCE:
            continue
        if which == 0:
            label[i] = OPEN
            drop(i, stance)
        elif label[i] == STICKS:
            tx, ty = forces[3 * i], forces[3 * i + 1]
            size = sqrt(tx * tx + ty * ty)
            if size > 0.0:
                label[i], toward[2 * i], toward[2 * i + 1] = CREEPS, -tx / size, -ty / size


def veers(y: Floats, h: float, model: Model, stance: Stance) -> bool:
    """Whether the friction of a creeping point turns too far in a step."""
    held, label, toward, forces = stance[0], stance[1], stance[2], stance[3]
    for slot in range(held[len(label)]):
        i = held[slot]
        if label[i] == CREEPS:
            sx, sy = drag(y, i, model, stance)
            if abs(sx * toward[2 * i + 1] - sy * toward[2 * i]) * forces[3 * i + 2] * h > _VEERS * model[4][1]:
                return True
    return False


def steady(y: Floats, model: Model, stance: Stance) -> float:
    """The longest step in which the directions of slips stay stable: small against slip over friction."""
    held, label, arms = stance[0], stance[1], stance[4]
    least = _LONG * model[4][1]
    for slot in range(held[len(label)]):
        i = held[slot]
        if label[i] == SLIPS:
            sx = y[7] + y[11] * arms[3 * i + 2] - y[12] * arms[3 * i + 1]
            sy = y[8] + y[12] * arms[3 * i] - y[10] * arms[3 * i + 2]
            least = min(least, sqrt(sx * sx + sy * sy))
    return _STEADY * least / (stiff(SLIPS, model, stance) + _TINY)


def stiff(kind: Count, model: Model, stance: Stance) -> float:
    """The acceleration along the support that friction gives points of a kind at most, in m/s^2.

    A slender body is far lighter in one direction at a point than in others, so its weight alone does not tell it.
    """
    friction = model[3]
    held, label, forces, blocks = stance[0], stance[1], stance[3], stance[5]
    most = 0.0
    for slot in range(held[len(label)]):
        i = held[slot]
        if label[i] == kind:
            xx, yy, xy = blocks[12 * i], blocks[12 * i + 1], blocks[12 * i + 3]
            largest = 0.5 * (xx + yy + sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy))
            most += friction[i] * abs(forces[3 * i + 2]) * largest
    return most


def creep(y: Floats, stance: Stance) -> float:
    """The largest velocity that a standing point should not have, in m/s."""
    held, label, arms = stance[0], stance[1], stance[4]
    most = 0.0
    for slot in range(held[len(label)]):
        i = held[slot]
        rx, ry, rz = arms[3 * i], arms[3 * i + 1], arms[3 * i + 2]
        most = max(most, abs(y[9] + y[10] * ry - y[11] * rx))
        if label[i] == STICKS:
            most = max(most, abs(y[7] + y[11] * rz - y[12] * ry), abs(y[8] + y[12] * rx - y[10] * rz))
    return most


def stays(time: float, horizon: float, y: Floats, k: Floats, trial: Floats, model: Model, stance: Stance) -> bool:
    """Whether nothing will move the body off the points that it stands on."""
    held, label, pull = stance[0], stance[1], model[2]
    n = len(label)
    count = held[n]
    if count == 0:
        return False
    if rests(y, k, model):
        return True
    if count < 3:
        return False
    held[n] = 0
    rates(time, y, trial, 0, False, model, stance)
    held[n] = count
    flat = lies(time, y, trial, model, stance)
    if flat and abs(pull[3]) + abs(pull[4]) + abs(pull[5]) + pull[12] > 0.0:
        held[n] = 0
        rates(horizon, y, trial, 0, False, model, stance)
        held[n] = count
        flat = lies(horizon, y, trial, model, stance)
    return flat


def rests(y: Floats, k: Floats, model: Model) -> bool:
    """Whether a body on a support that does not turn neither moves nor is accelerated."""
    pull, (size, speed, weight, _) = model[2], model[4]
    moves, changes = 0.0, abs(pull[3]) + abs(pull[4]) + abs(pull[5]) + pull[12]
    for i in range(3):
        moves = max(moves, abs(y[7 + i]), abs(y[10 + i]) * size)
        changes = max(changes, abs(k[7 + i]), abs(k[10 + i]) * size)
    return moves <= _RESTS * speed and changes <= _RESTS * weight


def lies(time: float, y: Floats, k: Floats, model: Model, stance: Stance) -> bool:
    """Whether a body on three points or more surely stays flat: no friction can tip it over a side of their hull.

    It needs the derivative k of its free motion at the time.
    """
    friction, scale = model[3], model[4]
    held, label, arms, frame = stance[0], stance[1], stance[4], stance[6]
    n = len(label)
    count, press = held[n], -k[9]
    det = frame[9] * frame[10] - frame[12] * frame[12]
    if press <= _RESTS * scale[2] or det <= 0.0:
        return False
    # The moments that keep it from tipping, and where the support's pressure then acts, seen from the mass centre.
    tx, ty = (frame[12] * k[11] - frame[10] * k[10]) / det, (frame[12] * k[10] - frame[9] * k[11]) / det
    x, y_, slips, most, height = -ty / press, tx / press, False, 0.0, 0.0
    for slot in range(count):
        i = held[slot]
        most, height, slips = max(most, friction[i]), max(height, -arms[3 * i + 2]), slips or label[i] >= SLIPS
    if not slips:
        most = min(most, sqrt(k[7] * k[7] + k[8] * k[8]) / press)
    reach, sides = _SAFE * most * height + _RESTS * scale[0], 0
    for first in range(count):
        for second in range(first):
            i, j = held[first], held[second]
            ux, uy = arms[3 * j] - arms[3 * i], arms[3 * j + 1] - arms[3 * i + 1]
            length = sqrt(ux * ux + uy * uy)
            left, right = 0.0, 0.0
            for slot in range(count):
                p = held[slot]
                side = ux * (arms[3 * p + 1] - arms[3 * i + 1]) - uy * (arms[3 * p] - arms[3 * i])
                left, right = max(left, side), min(right, side)
            inside = ux * (y_ - arms[3 * i + 1]) - uy * (x - arms[3 * i])
            small = _RESTS * scale[0] * length
            if left > small and right >= -small:
                sides += 1
            elif right < -small and left <= small:
                sides, inside = sides + 1, -inside
            else:
                continue
            if inside < reach * length:
                return False
    return sides >= 3
