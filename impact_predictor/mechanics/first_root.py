"""The first root of a condition made of a parabola and waves: gaps of a thrown body, margins of a friction cone."""

from __future__ import annotations

import math

_ROUNDING = 8.0 * 2.0**-52
"""A few units in the last place of a value that is a sum of a few terms."""
_MAX_ADVANCES = 1000
"""Several times what the worst grazing needs."""

Wave = tuple[float, float, float]
"""Amplitudes of cosine and sine, and their rate."""


def first_descent(
    level: float, slope: float, curvature: float, waves: tuple[Wave, ...], last: float, leaving: bool = False
) -> float:
    """First s in 0..last at which a condition is not positive and falls; inf when there is none.

    The condition is level + slope s + curvature s^2 / 2 + the sum of (c cos(r s) + q sin(r s)) over the waves
    (c, q, r). Its derivatives have known bounds, so from each s a step is known in which it cannot vanish: the steps
    add up to the first root, quadratically, and pass none. A condition that begins at zero or below it must rise first;
    one that is `leaving` zero, at rest, does not begin with a fall, whatever an inexact start says.
    """
    amplitude = speed = bend = jolt = snap = 0.0
    for cosine_part, sine_part, rate in waves:
        size, rate = math.hypot(cosine_part, sine_part), abs(rate)
        amplitude += size
        speed += size * rate
        bend += size * rate * rate
        jolt += size * rate * rate * rate
        snap += size * rate * rate * rate * rate
    fall = max(0.0, bend - curvature)
    s = 0.0
    for _ in range(_MAX_ADVANCES):
        if not s <= last or s == math.inf:
            break
        base, base_rate = level + (slope + 0.5 * curvature * s) * s, slope + curvature * s
        value, change, bow, jerk = base, base_rate, curvature, 0.0
        for cosine_part, sine_part, rate in waves:
            cosine, sine = math.cos(rate * s), math.sin(rate * s)
            here, ahead = cosine_part * cosine + sine_part * sine, sine_part * cosine - cosine_part * sine
            value += here
            change += rate * ahead
            bow -= rate * rate * here
            jerk -= rate * rate * rate * ahead
        if leaving and s == 0.0:
            bow = max(0.0, bow)
        top_speed, top_bend = abs(slope) + abs(curvature) * s + speed, abs(curvature) + bend
        rounding = _ROUNDING * (abs(level) + amplitude + top_speed * s)
        if value > rounding:
            step = _safe_step(value, change, fall)
            if base > amplitude:
                step = max(step, _safe_step(base - amplitude, base_rate, max(0.0, -curvature)))
        elif abs(change) > _ROUNDING * (top_speed + top_bend * s):
            if change < 0.0:
                return s
            step = _safe_step(change, bow, jolt)
        elif abs(bow) > _ROUNDING * (top_bend + jolt * s):
            if bow < 0.0:
                return s
            step = _safe_step(bow, jerk, snap)
        elif jerk > _ROUNDING * jolt:
            step = _safe_step(0.0, jerk, snap)
        else:
            return s if jolt > 0.0 else math.inf
        if s + step == s:
            return s  # within rounding of zero, in waves too fast for the rounding of s
        s += step
    return math.inf


def _safe_step(value: float, rate: float, fall: float) -> float:
    """The longest step in which value + rate s - fall s^2/2 stays positive."""
    root = math.sqrt(rate * rate + 2.0 * fall * value)
    if rate > 0.0:
        return (rate + root) / fall if fall > 0.0 else math.inf
    return 2.0 * value / (root - rate) if root > rate else math.inf
