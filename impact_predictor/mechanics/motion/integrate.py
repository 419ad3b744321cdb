"""Steps of two coupled coordinates, such as turning about a contact and slip, and dense output of them.

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
NEAR = 1e-6
"""Way of a nudge, relative to the step that it is within: its third power is rounding."""
_ROUNDING = 1e-13
"""Part of the accelerations that is rounding: they may be small differences of large ones."""
_DENSE = 1e-12
"""Error of the rates of dense output, relative to the rates."""

Rate = Callable[[float, float, float, float, float], tuple[float, float]]
"""Accelerations (turning, slip) from time, turned angle, its rate, slipped way and its rate."""


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


class DensePiece(NamedTuple):
    """Dense output between two instants: polynomials in -1..1 through the rates and accelerations at both ends and in
    the middle, the highest power first, integrated from the start.
    """

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


def values_at(found: list[DensePiece], time: Any) -> tuple[Any, Any, Any, Any]:
    """u, w, z and s at a time, or at an array of times, within pieces that follow each other."""
    if isinstance(time, (float, int)):
        return found[max(0, bisect_right(found, time, key=lambda piece: piece.start) - 1)].at(time)
    import numpy as np

    place = np.clip(np.searchsorted([piece.start for piece in found], time, side="right") - 1, 0, None)
    values = np.empty((4, len(time)))
    for k in np.unique(place):
        values[:, place == k] = found[k].at(time[place == k])
    return values[0], values[1], values[2], values[3]


def pieces(rate: Rate, now: Instant, end: Instant, scale: Vector, tolerance: float, depth: int = 6) -> list[DensePiece]:
    """Polynomials from one instant of a step to another, halved until they agree with the step itself."""
    h, length = end.time - now.time, scale[0]
    middle, _ = step(rate, now, 0.5 * h, scale, tolerance)
    u = _through(0.5 * h, now.u, (now.w, middle.w, end.w), (now.alpha, middle.alpha, end.alpha))
    z = _through(0.5 * h, now.z, (now.s, middle.s, end.s), (now.beta, middle.beta, end.beta))
    piece = DensePiece(start=now.time, end=end.time, u=u, z=z)
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


def _through(
    half: float, start: float, rates: tuple[float, float, float], accelerations: tuple[float, float, float]
) -> tuple[float, ...]:
    """Coefficients of the polynomial from a first value with these rates and accelerations at both ends and between."""
    square = half * half
    c0, c1 = half * rates[1], square * accelerations[1]
    even, odd = 0.5 * half * (rates[2] + rates[0]) - c0, 0.5 * half * (rates[2] - rates[0]) - c1
    even_rate = 0.5 * square * (accelerations[2] - accelerations[0])
    odd_rate = 0.5 * square * (accelerations[2] + accelerations[0]) - c1
    c4, c5 = 0.5 * even_rate - even, 0.5 * (odd_rate - 3.0 * odd)
    c2, c3 = even - c4, odd - c5
    rising = c5 / 6.0, c4 / 5.0, c3 / 4.0, c2 / 3.0, c1 / 2.0, c0
    return (*rising, start - (c5 / 6.0 - c4 / 5.0 + c3 / 4.0 - c2 / 3.0 + c1 / 2.0 - c0))


def _value_and_slope(coefficients: tuple[float, ...], x: Any) -> tuple[Any, Any]:
    value = slope = 0.0 * x
    for coefficient in coefficients:
        slope = slope * x + value
        value = value * x + coefficient
    return value, slope
