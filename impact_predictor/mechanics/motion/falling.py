"""The motion of a rigid body on points over a plane support in three dimensions, up to its next touchdown.

Written as `reactions` is. Each phase in which no point begins or ends to stick, slip or stand is smooth, and is
integrated by the embedded method of Dormand and Prince (1980, RK5(4)7M); a step that goes beyond a change, or beyond a
strike, is cut there.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Final

from .reactions import CREEPS, OPEN, SLIPS, STICKS, derive, hold, locate, rates
from .stances import (
    NONE,
    ROUNDING,
    SLOW,
    change,
    creep,
    head,
    margins,
    near,
    settle,
    stand,
    stays,
    steady,
    stiff,
    stop,
    veers,
)

if TYPE_CHECKING:
    from ..compiled import Count, Floats
    from .reactions import Model, Stance

    Scratch = tuple[Floats, Floats, Floats, Floats, Floats, Floats]

# As tuples of any length: one of a known length would be made anew in machine code each time that a part is taken.
_NODES: Final[tuple[float, ...]] = 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0
_STAGES: Final[tuple[float, ...]] = (
    *(0.2,),
    *(3.0 / 40.0, 9.0 / 40.0),
    *(44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0),
    *(19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0),
    *(9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0),
    *(35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0),
)
_ERRORS: Final[tuple[float, ...]] = (
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -0.025,
)
_TOLERANCE: Final = 1e-6
"""Error of a step, relative to the scales of the motion."""
_TURN: Final = 0.8
"""rad in one step at most: a gap is a polynomial of degree 3 over it, up to `_BEND`."""
_BEND: Final = 1.0 / 192.0
"""Twice the error of such a polynomial, relative to the size and to the fourth power of the turn."""
_MANY: Final = 300
"""Steps, after which slips that creep end: else some would take thousands."""
_MAX_STEPS: Final = 400
_MAX_CUTS: Final = 30
"""More than the secant needs to find the events of a step."""
_STUCK: Final = 12
"""Events, besides one of each point, in a `_MOMENT`: more come only from rounding, or from forces near zero."""
_MOMENT: Final = 1e-3
"""Relative to the time scale of the motion."""
_LONGER: Final = 8.0
"""Each time that a motion is stuck, its points are held so many times longer."""
_BLEND: Final = 0.35
"""Of the speed that friction takes in a step is blended with the slip of a creeping point; directions are unstable
below 0.3, and lag the more above."""
_POOR: Final = 4.0
"""Error of a step that is cut, relative to the tolerance, that is too much."""
_GAP: Final = 1e-8
"""How near to zero a gap is found to close, relative to the size."""
_THIN: Final = 1e-13
"""Relative to the size: a point that rested has to come so far below the support; rounding moves it by less."""
_LIGHT: Final = 1e-6
"""Relative to the scale of speeds: a point that approaches more slowly comes to rest, and does not strike."""
_WILD: Final = 1e6
"""Error of the smallest step, relative to the tolerance, that tells a jam."""
_ON: Final = 0
_STAYS: Final = 1
_EARLY: Final = 2
"""How a step goes that is cut at an event."""


def step(time: float, h: float, y: Floats, k: Floats, trial: Floats, model: Model, stance: Stance) -> tuple[float, int]:
    """One step from y, whose derivative is k[:13], to `trial`, whose derivative is k[78:]; error and jammed point."""
    size, speed, _, _ = model[4]
    row, jam = 0, -1
    for stage in range(6):
        for i in range(13):
            slope = 0.0
            for j in range(stage + 1):
                slope += _STAGES[row + j] * k[13 * j + i]
            trial[i] = y[i] + h * slope
        row += stage + 1
        if stage == 5:
            normalise(trial)
        jam = max(jam, derive(time + _NODES[stage] * h, trial, k, 13 * stage + 13, False, model, stance))
    error = 0.0
    for i in range(13):
        part = 0.0
        for j in range(7):
            part += _ERRORS[j] * k[13 * j + i]
        part = h * abs(part)
        part *= 1.0 / size if i < 3 else 1.0 if i < 7 else 1.0 / speed if i < 10 else size / speed
        error = max(error, part)
    return error / _TOLERANCE, jam


def normalise(y: Floats) -> None:
    length = 1.0 / sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6])
    y[3], y[4], y[5], y[6] = y[3] * length, y[4] * length, y[5] * length, y[6] * length


def measure(y: Floats, k: Floats, at: Count, points: Floats, frame: Floats, offsets: Floats, out: Floats) -> None:
    """Gap, its rate and its second derivative of each point into `out` (3 n)."""
    wx, wy, wz = y[10], y[11], y[12]
    square, az, alx, aly = wx * wx + wy * wy + wz * wz, k[at + 9], k[at + 10], k[at + 11]
    for i in range(len(offsets)):
        px, py, pz = points[3 * i], points[3 * i + 1], points[3 * i + 2]
        x = frame[0] * px + frame[1] * py + frame[2] * pz
        y_ = frame[3] * px + frame[4] * py + frame[5] * pz
        z = frame[6] * px + frame[7] * py + frame[8] * pz
        out[3 * i] = y[2] + z - offsets[i]
        out[3 * i + 1] = y[9] + wx * y_ - wy * x
        out[3 * i + 2] = az + alx * y_ - aly * x + wz * (wx * x + wy * y_ + wz * z) - z * square


def crossing(now: Floats, then: Floats, i: Count, h: float, dip: float, slack: float) -> float:
    """Part of a step at which gap i first falls to -`slack` or below, or falls there; 2 for none.

    Minus the part where the gap may have been there between: it is nearer to 0 than `dip`.
    """
    g0, g1, r0, r1 = now[3 * i] + slack, then[3 * i] + slack, h * now[3 * i + 1], h * then[3 * i + 1]
    if g0 > 0.0 and g1 > dip and g0 + r0 / 3.0 > dip and g1 - r1 / 3.0 > dip:
        return 2.0
    c2, c3 = 3.0 * (g1 - g0) - 2.0 * r0 - r1, 2.0 * (g0 - g1) + r0 + r1
    # The pieces on which the cubic falls lie between the zeros of its derivative r0 + 2 c2 s + 3 c3 s^2.
    first, second, root = 2.0, 2.0, c2 * c2 - 3.0 * c3 * r0
    if root > 0.0:
        q = -c2 - sqrt(root) if c2 > 0.0 else -c2 + sqrt(root)
        if q != 0.0:
            first = r0 / q
        if c3 != 0.0:
            second = q / (3.0 * c3)
        if first > second:
            first, second = second, first
    start: float = 0.0
    found: float = 2.0
    for piece in range(3):
        end = first if piece == 0 else second if piece == 1 else 1.0
        end = min(max(end, start), 1.0)
        high = g0 + start * (r0 + start * (c2 + start * c3))
        low = g0 + end * (r0 + end * (c2 + end * c3))
        if end > start and low < high:
            if high <= 0.0:
                return start
            if low <= 0.0:
                s, lower, upper = start + (end - start) * high / (high - low), start, end
                for _ in range(30):
                    value = g0 + s * (r0 + s * (c2 + s * c3))
                    if value > 0.0:
                        lower = s
                    else:
                        upper = s
                    slope = r0 + s * (2.0 * c2 + 3.0 * s * c3)
                    shift = -value / slope if slope < 0.0 else 0.0
                    s = s + shift if lower < s + shift < upper else 0.5 * (lower + upper)
                    if abs(shift) <= 1e-9:
                        break
                # The second derivatives at both ends make it a polynomial of degree 5.
                a0, a1, d = h * h * now[3 * i + 2], h * h * then[3 * i + 2], g1 - g0
                b2, b3 = 0.5 * a0, 10.0 * d - 6.0 * r0 - 4.0 * r1 - 1.5 * a0 + 0.5 * a1
                b4, b5 = -15.0 * d + 8.0 * r0 + 7.0 * r1 + 1.5 * a0 - a1, 6.0 * d - 3.0 * (r0 + r1) + 0.5 * (a1 - a0)
                for _ in range(2):
                    value = g0 + s * (r0 + s * (b2 + s * (b3 + s * (b4 + s * b5))))
                    slope = r0 + s * (2.0 * b2 + s * (3.0 * b3 + s * (4.0 * b4 + s * 5.0 * b5)))
                    if slope < 0.0:
                        s = min(max(s - value / slope, start), 1.0)
                return s
            if found == 2.0 and low < dip and 0.02 < end < 0.98:
                found = -end
        start = end
    return found


def follow(
    y: Floats, horizon: float, offsets: Floats, model: Model, stance: Stance, scratch: Scratch
) -> tuple[float, int]:
    """Follow the state y up to the first strike: its time and point; -1 as point where there is none by the horizon.

    y becomes the state there, `scratch[2]` (3 n) the gaps with their derivatives, and the stance what stands then.
    """
    points, scale = model[0], model[4]
    held, label, frame = stance[0], stance[1], stance[6]
    k, trial, now, then, before, after = scratch
    size, speed, weight = scale[0], scale[1], scale[2]
    n, time, since, events = len(label), 0.0, 0.0, 0
    moment, most = _MOMENT * sqrt(size / weight), _STUCK + len(label)
    struck = begin(y, offsets, model, stance, scratch)
    if struck >= 0:
        return 0.0, struck
    again, h = True, (0.3 if held[n] else 1.0) * sqrt(size / weight)
    for taken in range(_MAX_STEPS):
        if taken == _MANY:
            stop(y, model, stance, SLOW)
            again = True
        if events == most:
            # Points that lift and rest in turns are held for a while: what would lift or begin to slip does not.
            since, moment, events = time, moment * _LONGER, events + 1
        if again:
            settle(time, y, k, events < most, model, stance)
            if stays(time, horizon, y, k, trial, model, stance):
                return horizon, -1
            locate(y, model, stance)
            measure(y, k, 0, points, frame, offsets, now)
            margins(y, model, stance, before)
            for i in range(n):
                # What lifts does not approach first.
                rests = abs(now[3 * i]) <= _GAP * size and abs(now[3 * i + 1]) <= _LIGHT * speed
                if label[i] == OPEN and rests and now[3 * i + 2] > 0.0:
                    now[3 * i], now[3 * i + 1] = max(now[3 * i], 0.0), max(now[3 * i + 1], 0.0)
            again = False
        left, turn = horizon - time, sqrt(y[10] * y[10] + y[11] * y[11] + y[12] * y[12])
        if left <= 0.0:
            return horizon, -1
        h = min(h, left, steady(y, model, stance))
        if turn * h > _TURN:
            h = _TURN / turn
        blend = _BLEND * h * stiff(CREEPS, model, stance)
        if blend > 0.0 and scale[3] != blend:
            scale[3] = blend
            rates(time, y, k, 0, False, model, stance)
        error, jam = step(time, h, y, k, trial, model, stance)
        small = h <= 1e-6 * sqrt(size / weight)
        if not small and veers(trial, h, model, stance):
            h *= 0.3
            continue
        if small and jam < 0 and not error < _WILD:
            jam = 0
        if jam >= 0 and small:
            stop(y, model, stance, 2.0)
            again, events = True, events + 1
            continue
        if jam >= 0 or (not error <= 1.0 and not small):
            h *= 0.2 if jam >= 0 or not error < 600.0 else 0.9 / sqrt(sqrt(error))
            continue
        root = sqrt(sqrt(sqrt(max(error, 1e-12))))  # error^(1/8)
        longer = h * min(4.0, 0.9 / (root * sqrt(root)))
        h, error, event, goes = cut_at_event(time, h, error, turn, events < most, y, offsets, model, stance, scratch)
        if (goes == _EARLY or not error <= _POOR) and not small:
            # What was at its border comes back to it, or leaves it at once.
            h, events = h * 0.25, events + 1
            continue
        if goes == _ON:
            for i in range(13):
                y[i], k[i] = trial[i], k[78 + i]
            for i in range(3 * n):
                now[i] = then[i]
            for i in range(2 * n):
                before[i] = after[i]
            time += h
            if time - since > moment:
                since, events = time, 0
        else:
            rates(time, y, k, 0, False, model, stance)
        if event < 0:
            # Points that stick may have crept by the errors of the step.
            if creep(y, stance) > NONE * speed:
                hold(y, stance, ROUNDING * speed)
                rates(time, y, k, 0, False, model, stance)
            for slot in range(held[n]):
                if label[held[slot]] >= SLIPS:
                    head(y, held[slot], model, stance)
            scale[3] = scale[1]  # not before the last has its direction from the blend of this step
            h = longer
            margins(y, model, stance, before)
            continue
        locate(y, model, stance)
        if event >= n:
            change(event - n, y, before, model, stance)
        else:
            time = close(time, h, event, y, k, now, offsets, model, stance)
            if now[3 * event + 1] < -_LIGHT * speed:
                normalise(y)
                return time, event
            offsets[event] += now[3 * event]
            stand(y, event, model, stance)
        hold(y, stance, ROUNDING * speed)
        again, h, events = True, longer, events + 1
    return horizon, -1


def begin(y: Floats, offsets: Floats, model: Model, stance: Stance, scratch: Scratch) -> int:
    """Label the points that stand, and let stand what touches and does not approach; the point that strikes, or -1."""
    points, scale = model[0], model[4]
    held, label, frame = stance[0], stance[1], stance[6]
    k, now = scratch[0], scratch[2]
    size, speed, n = scale[0], scale[1], len(label)
    locate(y, model, stance)
    for slot in range(held[n]):
        label[held[slot]] = SLIPS
        if head(y, held[slot], model, stance) <= NONE:
            label[held[slot]] = STICKS
    hold(y, stance, ROUNDING * speed)
    rates(0.0, y, k, 0, False, model, stance)
    measure(y, k, 0, points, frame, offsets, now)
    struck, fastest = -1, -ROUNDING * speed
    for i in range(n):
        if label[i] == OPEN and now[3 * i] <= ROUNDING * size:
            if now[3 * i + 1] < fastest:
                struck, fastest = i, now[3 * i + 1]
            elif now[3 * i] >= -ROUNDING * size and abs(now[3 * i + 1]) <= ROUNDING * speed:
                stand(y, i, model, stance)
    return struck


def cut_at_event(
    time: float,
    h: float,
    error: float,
    turn: float,
    may_change: bool,
    y: Floats,
    offsets: Floats,
    model: Model,
    stance: Stance,
    scratch: Scratch,
) -> tuple[float, float, int, int]:
    """Cut a step of h s until it ends at the first event in it: its length, its error, the event, and how it goes.

    The step goes `_ON` to its end, `_STAYS` where it is, or is `_EARLY`: a margin was at zero before it.
    """
    k, trial, now, then, before, after = scratch
    label = stance[1]
    low, high, low_value, high_value, target, event = 0.0, h, 0.0, 0.0, -1, -1
    for _ in range(_MAX_CUTS):
        measure(trial, k, 78, model[0], stance[6], offsets, then)
        margins(trial, model, stance, after)
        if target >= 0:
            # The secant between both sides of a change, by the Illinois method.
            value, border = after[target], near(target, label)
            if value < -border:
                high_value, low_value = value, low_value * (1.0 if high_value == 0.0 else 0.5)
                high = h
            elif value > border:
                low, low_value, high_value = h, value, 0.5 * high_value
            if abs(value) > border:
                event, h = -1, high - high_value * (high - low) / (high_value - low_value)
                error, _ = step(time, h, y, k, trial, model, stance)
                continue
            target = -1
        event, cut, is_early = first_event(h, turn, may_change, model, stance, scratch)
        if is_early or cut == 1.0:
            return h, error, event, _EARLY if is_early else _ON
        if cut == 0.0:
            return h, error, event, _STAYS
        if event >= len(label):
            target = event - len(label)
            low, low_value, high, high_value = 0.0, before[target], h, after[target]
        h *= cut
        error, _ = step(time, h, y, k, trial, model, stance)
    return h, error, event, _ON


def first_event(
    h: float, turn: float, may_change: bool, model: Model, stance: Stance, scratch: Scratch
) -> tuple[int, float, bool]:
    """The first event in a step of h s, the part of the step before it, and whether it was at its border before.

    Event i below n is that gap i closes; n + m that margin m of a point that stands comes to zero, where it
    `may_change`; -1 is none. An event at the end of the step has the part 1.
    """
    size, speed = model[4][0], model[4][1]
    label = stance[1]
    now, then, before, after = scratch[2], scratch[3], scratch[4], scratch[5]
    n, bent = len(label), turn * h
    dip = _BEND * size * bent * bent * bent * bent
    event, cut, reached, is_early = -1, 1.0, -1, False
    for i in range(n):
        if label[i] == OPEN:
            rate = then[3 * i + 1]
            rests = then[3 * i] < 0.0 and abs(rate) <= _LIGHT * speed and now[3 * i + 1] > rate
            if (abs(then[3 * i]) <= _GAP * size and rate < 0.0) or rests:
                reached = i
                continue
            rested = now[3 * i] <= _GAP * size and 0.0 <= now[3 * i + 1] <= _LIGHT * speed
            s = crossing(now, then, i, h, dip, _THIN * size + max(0.0, -now[3 * i]) if rested else 0.0)
            if abs(s) < cut:
                event, cut = i, abs(s)
        else:
            for m in range(2 * i, 2 * i + 2):
                if not may_change and (m == 2 * i or label[i] == STICKS):
                    continue
                border = near(m, label)
                if after[m] >= -border:
                    if after[m] <= border and after[m] < before[m]:
                        reached = n + m
                elif before[m] > border:
                    s = before[m] / (before[m] - after[m])
                    if s < cut:
                        event, cut = n + m, s
                else:
                    is_early, reached = True, n + m
    if is_early or event < 0:
        return reached, 1.0, is_early
    return event, cut, False


def close(
    time: float,
    h: float,
    point: Count,
    y: Floats,
    k: Floats,
    now: Floats,
    offsets: Floats,
    model: Model,
    stance: Stance,
) -> float:
    """Move the state, by the derivative at the end of a step of h s, to where a gap is zero; the time there."""
    size = model[4][0]
    for _ in range(2):
        shift = 0.0
        if now[3 * point + 1] < 0.0 and abs(now[3 * point]) <= _GAP * size:
            shift = -now[3 * point] / now[3 * point + 1]
        shift = max(min(max(shift, -1e-3 * h), 1e-3 * h), -time)
        for i in range(13):
            y[i] += shift * k[i]
        time += shift
        locate(y, model, stance)
        measure(y, k, 0, model[0], stance[6], offsets, now)
    return time
