"""Steps of two coupled coordinates: turning about a contact, and slip.

Gragg's midpoint rule with extrapolation (Bulirsch and Stoer, Numer. Math. 8, 1966): the order rises until a step
settles, so that the tiny hops of accumulating impacts cost a few evaluations and long arcs take long steps, and
any instant of a step is had by stepping there again.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from typing import Any, NamedTuple

from ..types import Vector

_SUBSTEPS = (2, 4, 6, 8, 10, 12)
_GAINS = tuple(
    tuple(coarse**2 / (fine**2 - coarse**2) for coarse in reversed(_SUBSTEPS[:row]))
    for row, fine in enumerate(_SUBSTEPS)
)
"""What the difference of two results of extrapolation counts in the next one (Aitken and Neville, in the square)."""
GROWTH = (0.3, 3.0, 4.0, 3.0, 2.0, 1.3, 0.9)
"""Factor on the next step, by the rows of extrapolation that this one took (0: it did not settle)."""
_CLOSE = 1e-7
"""After a Newton step this small, relative to the root, what is left is its square."""

NEAR = 1e-6
"""Way of a nudge, relative to the step that it is within: its third power is rounding."""
_ROUNDING = 1e-13
"""Part of the accelerations that is rounding: they may be small differences of large ones."""

Rate = Callable[[float, float, float, float, float], tuple[float, float]]
"""Accelerations (turning, slip) from time, turned angle, its rate, slipped way and its rate."""

Value = tuple[float, float]
"""A condition, not negative until its event, and its rate (NaN where it is not known)."""


class Instant(NamedTuple):
    """Time in s; turned angle in rad, slipped way in m; their rates and accelerations."""

    time: float
    u: float
    w: float
    z: float
    s: float
    alpha: float
    beta: float


def step(rate: Rate, now: Instant, h: float, scale: Vector, tolerance: float) -> tuple[Instant, int]:
    """One step and in how many rows of extrapolation it settled: 0 where it did not, or where it overflowed.

    `tolerance` is the error allowed, relative to what happens in the step; `scale` is the length (m) that
    makes turning a way, and an acceleration (m/s^2) whose rounding is in those of the body.
    """
    try:
        return _extrapolate(rate, now, h, scale, tolerance)
    except (ValueError, OverflowError, ZeroDivisionError):  # near a pole of the accelerations (a jam)
        return now, 0


def _extrapolate(rate: Rate, now: Instant, h: float, scale: Vector, tolerance: float) -> tuple[Instant, int]:
    time, u, w, z, s, alpha, beta = now
    size = abs(h)
    length, weight = scale
    rounding = _ROUNDING * size * size * weight
    table: list[tuple[float, float, float, float]] = []
    du = dw = dz = ds = eu = ew = ez = es = 0.0
    rows = 0
    for substeps, gains in zip(_SUBSTEPS, _GAINS, strict=True):
        d = h / substeps
        twice = 2.0 * d
        pu = pw = pz = ps = 0.0
        du, dw, dz, ds = d * w, d * alpha, d * s, d * beta
        for k in range(1, substeps):
            kick, push = rate(time + k * d, u + du, w + dw, z + dz, s + ds)
            pu, du = du, pu + twice * (w + dw)
            pz, dz = dz, pz + twice * (s + ds)
            pw, dw = dw, pw + twice * kick
            ps, ds = ds, ps + twice * push
        for column, gain in enumerate(gains):
            cu, cw, cz, cs = table[column]
            table[column] = du, dw, dz, ds
            eu, ew, ez, es = gain * (du - cu), gain * (dw - cw), gain * (dz - cz), gain * (ds - cs)
            du += eu
            dw += ew
            dz += ez
            ds += es
        table.append((du, dw, dz, ds))
        if gains:
            error_turn = abs(eu) + size * abs(ew)
            allowed_turn = tolerance * size * (abs(w) + abs(dw)) + rounding / length
            allowed = length * allowed_turn + tolerance * size * (abs(s) + abs(ds))
            if error_turn <= allowed_turn and length * error_turn + abs(ez) + size * abs(es) <= allowed:
                rows = len(table)
                break
    time, u, w, z, s = time + h, u + du, w + dw, z + dz, s + ds
    alpha, beta = rate(time, u, w, z, s)
    return Instant(time, u, w, z, s, alpha, beta), rows


def nudged(rate: Rate, now: Instant, h: float) -> Instant:
    """A step so short that the third power of its length is rounding."""
    time, u, w, z, s, alpha, beta = now
    u, w, z, s = u + h * (w + 0.5 * h * alpha), w + h * alpha, z + h * (s + 0.5 * h * beta), s + h * beta
    return Instant(time + h, u, w, z, s, *rate(time + h, u, w, z, s))


def root(condition: Callable[[float], Value], high: float, guess: float) -> float:
    """Where in 0..high a condition (value, rate) falls to zero: Newton's method, kept in its bracket by bisection."""
    low = 0.0
    for _ in range(60):
        value, slope = condition(guess)
        if value >= 0.0:
            low = guess
        else:
            high = guess
        better = guess - value / slope if slope < 0.0 else math.inf
        if not low <= better <= high:
            better = 0.5 * (low + high)
        if abs(better - guess) <= _CLOSE * better:
            return better
        guess = better
    return guess


class Piece(NamedTuple):
    """Dense output between two instants: polynomials of degree 8 in -1..1 through both ends and the middle."""

    start: float
    end: float
    u: tuple[float, ...]
    z: tuple[float, ...]

    def at(self, time: Any) -> tuple[Any, Any, Any, Any]:
        """u, w, z and s at a time or an array of times."""
        half = 0.5 * (self.end - self.start)
        x = (time - self.start) / half - 1.0 if half else 0.0 * time
        u, w = _value_and_slope(self.u, x)
        z, s = _value_and_slope(self.z, x)
        return u, (w / half if half else w), z, (s / half if half else s)


def values_at(found: list[Piece], time: Any) -> tuple[Any, Any, Any, Any]:
    """u, w, z and s at a time, or at an array of times, within pieces that follow each other."""
    if isinstance(time, (float, int)):
        return found[max(0, bisect_right(found, time, key=lambda piece: piece.start) - 1)].at(time)
    import numpy as np

    place = np.clip(np.searchsorted([piece.start for piece in found], time, side="right") - 1, 0, None)
    values = np.empty((4, len(time)))
    for k in np.unique(place):
        values[:, place == k] = found[k].at(time[place == k])
    return values[0], values[1], values[2], values[3]


def pieces(rate: Rate, now: Instant, end: Instant, scale: Vector, tolerance: float, depth: int = 5) -> list[Piece]:
    """Polynomials from one instant of a step to another, halved until they agree with the step itself."""
    h, length = end.time - now.time, scale[0]
    middle, _ = step(rate, now, 0.5 * h, scale, tolerance)
    piece = Piece(
        now.time,
        end.time,
        _through(0.5 * h, (now.u, now.w, now.alpha), (middle.u, middle.w, middle.alpha), (end.u, end.w, end.alpha)),
        _through(0.5 * h, (now.z, now.s, now.beta), (middle.z, middle.s, middle.beta), (end.z, end.s, end.beta)),
    )
    if depth:
        quarter, rows = step(rate, now, 0.25 * h, scale, tolerance)
        _, w, _, s = piece.at(quarter.time)
        size = length * (abs(now.w) + abs(end.w)) + abs(now.s) + abs(end.s) + h * length * abs(middle.alpha)
        noise = (length * math.ulp(now.u) + math.ulp(now.z)) / h
        if not rows or length * abs(w - quarter.w) + abs(s - quarter.s) > _DENSE * size + 50.0 * noise:
            return [
                *pieces(rate, now, middle, scale, tolerance, depth - 1),
                *pieces(rate, middle, end, scale, tolerance, depth - 1),
            ]
    return [piece]


_DENSE = 1e-12
"""Error of the rates of dense output, relative to the rates."""
_NOISE = 1e-12
"""Rounding of places above this part of the way between them would spoil the rates."""


def _through(
    half: float, low: tuple[float, float, float], middle: tuple[float, float, float], high: tuple[float, float, float]
) -> tuple[float, ...]:
    """Coefficients, the highest power first, of the polynomial with three values, rates and accelerations."""
    if 4.0 * math.ulp(middle[0]) > _NOISE * half * (abs(low[1]) + abs(high[1])):
        return _through_rates(half, low, middle, high)
    square = half * half
    c0, c1, c2 = middle[0], half * middle[1], 0.5 * square * middle[2]
    rise, fall = high[0] - c0, low[0] - c0
    a, b, c = 0.5 * (rise + fall) - c2, 0.5 * half * (high[1] - low[1]) - 2.0 * c2, 0.5 * square * (high[2] + low[2])
    c -= 2.0 * c2
    c8 = 0.125 * (c - 9.0 * b + 24.0 * a)
    c6 = 0.5 * (b - 4.0 * a) - 2.0 * c8
    c4 = a - c6 - c8
    a, b, c = 0.5 * (rise - fall) - c1, 0.5 * half * (high[1] + low[1]) - c1, 0.5 * square * (high[2] - low[2])
    c7 = 0.125 * (c - 7.0 * b + 15.0 * a)
    c5 = 0.5 * (b - 3.0 * a) - 2.0 * c7
    c3 = a - c5 - c7
    return c8, c7, c6, c5, c4, c3, c2, c1, c0


def _through_rates(
    half: float, low: tuple[float, float, float], middle: tuple[float, float, float], high: tuple[float, float, float]
) -> tuple[float, ...]:
    """As `_through`, from the rates and accelerations and the first value alone."""
    square = half * half
    c0, c1 = half * middle[1], square * middle[2]
    even, odd = 0.5 * half * (high[1] + low[1]) - c0, 0.5 * half * (high[1] - low[1]) - c1
    even_rate, odd_rate = 0.5 * square * (high[2] - low[2]), 0.5 * square * (high[2] + low[2]) - c1
    c4, c5 = 0.5 * even_rate - even, 0.5 * (odd_rate - 3.0 * odd)
    c2, c3 = even - c4, odd - c5
    rising = c5 / 6.0, c4 / 5.0, c3 / 4.0, c2 / 3.0, c1 / 2.0, c0
    start = c5 / 6.0 - c4 / 5.0 + c3 / 4.0 - c2 / 3.0 + c1 / 2.0 - c0
    return (*rising, low[0] - start)


def _value_and_slope(coefficients: tuple[float, ...], x: Any) -> tuple[Any, Any]:
    value = slope = 0.0 * x
    for coefficient in coefficients:
        slope = slope * x + value
        value = value * x + coefficient
    return value, slope
