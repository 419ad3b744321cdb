"""Steps of two coupled coordinates, such as turning about a contact and slip, and dense output of them.

Gragg's midpoint rule with extrapolation (Bulirsch and Stoer, Numer. Math. 8, 1966): the order rises until a step
settles, so that the tiny hops of accumulating impacts cost a few evaluations and long arcs take long steps, and
any instant of a step is had by stepping there again.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from ..types import Vector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_SUBSTEPS = (2, 4, 6, 8, 10, 12)
_GAINS = tuple(
    tuple(coarse**2 / (fine**2 - coarse**2) for coarse in reversed(_SUBSTEPS[:row]))
    for row, fine in enumerate(_SUBSTEPS)
)
"""What the difference of two results of extrapolation counts in the next one (Aitken and Neville, in the square)."""
GROWTH = (0.3, 3.0, 4.0, 3.0, 2.0, 1.3, 0.9)
"""Factor on the next step, by the rows of extrapolation that this one took (0: it did not settle)."""
NEAR: Final = 1e-6
"""Way of a nudge, relative to the step that it is within: its third power is rounding."""
_ROUNDING: Final = 1e-13
"""Part of the accelerations that is rounding: they may be small differences of large ones."""
_DENSE: Final = 1e-10
"""Error of the rates of dense output, relative to the rates."""
_DEEPEST: Final = 12
"""Halvings of a step, or of a phase known in closed form, for its dense output."""

Rate = Callable[[float, float, float, float, float], tuple[float, float]]
"""Accelerations (turning, slip) from time, turned angle, its rate, slipped way and its rate."""


class Instant:
    """Time in s; turned angle in rad, slipped way in m; their rates and accelerations."""

    def __init__(self, time: float, u: float, w: float, z: float, s: float, alpha: float, beta: float) -> None:
        self.time, self.u, self.w, self.z, self.s, self.alpha, self.beta = time, u, w, z, s, alpha, beta

    def at(self, time: float) -> Instant:
        """The same at another time."""
        return Instant(time, self.u, self.w, self.z, self.s, self.alpha, self.beta)


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
    time, u, w, z, s, alpha, beta = now.time, now.u, now.w, now.z, now.s, now.alpha, now.beta
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
    u, w, z, s, alpha, beta = now.u, now.w, now.z, now.s, now.alpha, now.beta
    time = now.time + h
    u, w, z, s = u + h * (w + 0.5 * h * alpha), w + h * alpha, z + h * (s + 0.5 * h * beta), s + h * beta
    alpha, beta = rate(time, u, w, z, s)
    return Instant(time, u, w, z, s, alpha, beta)


def middle_of(now: Instant, then: Instant) -> Instant:
    """The instant in the middle of a step, on polynomials of degree 5 through both ends; without accelerations."""
    h = then.time - now.time
    u, w = _between(0.5, h, (now.u, now.w, now.alpha), (then.u, then.w, then.alpha))
    z, s = _between(0.5, h, (now.z, now.s, now.beta), (then.z, then.s, then.beta))
    return Instant(time=now.time + 0.5 * h, u=u, w=w, z=z, s=s, alpha=math.nan, beta=math.nan)


def add_dense(
    found: list[Instant], rate: Rate, now: Instant, end: Instant, scale: Vector, tolerance: float, depth: int = 0
) -> None:
    """Add instants after `now` up to `end`, so close that polynomials of degree 5 between them are exact.

    Of the end only the time need be known.
    """
    h, length = end.time - now.time, scale[0]
    middle, rows = step(rate, now, 0.5 * h, scale, tolerance)
    if not rows:
        middle = Instant(now.time + 0.5 * h, math.nan, now.w, now.z, now.s, now.alpha, now.beta)
    elif math.isnan(end.u):
        then, rows = step(rate, middle, 0.5 * h, scale, tolerance)
        end = then.at(end.time) if rows else end
    if rows:
        guess = middle_of(now, end)
        size = length * (abs(now.w) + abs(end.w)) + abs(now.s) + abs(end.s) + h * length * abs(middle.alpha)
        noise = (length * math.ulp(now.u) + math.ulp(now.z)) / h
        # The error of the rates is nearly zero in the middle; a quarter of a step away it is what that of the way says.
        error = length * (4.0 * abs(guess.u - middle.u) / h + abs(guess.w - middle.w))
        error += 4.0 * abs(guess.z - middle.z) / h + abs(guess.s - middle.s)
        rows = error <= _DENSE * size + 50.0 * noise
    if rows or depth == _DEEPEST:
        found.append(end)
        return
    add_dense(found, rate, now, middle, scale, tolerance, depth + 1)
    add_dense(found, rate, found[-1], end, scale, tolerance, depth + 1)


def values_at(instants: list[Instant], times: NDArray[np.float64]) -> tuple[Any, Any, Any, Any]:
    """u, w, z and s at some times, from polynomials of degree 5 between instants."""
    import numpy as np

    numbers = [(one.time, one.u, one.w, one.z, one.s, one.alpha, one.beta) for one in instants]
    known, u, w, z, s, alpha, beta = np.array(numbers).T
    k = np.clip(np.searchsorted(known, times, side="right") - 1, 0, max(0, len(known) - 2))
    then = np.minimum(k + 1, len(known) - 1)
    h = np.where(known[then] > known[k], known[then] - known[k], 1.0)
    x = (times - known[k]) / h
    return (
        *_between(x, h, (u[k], w[k], alpha[k]), (u[then], w[then], alpha[then])),
        *_between(x, h, (z[k], s[k], beta[k]), (z[then], s[then], beta[then])),
    )


def _between(x: Any, h: Any, start: tuple[Any, Any, Any], end: tuple[Any, Any, Any]) -> tuple[Any, Any]:
    """Value and rate at x in 0..1 of steps h, from values, rates and accelerations at both ends."""
    (u, w, a), (end_u, end_w, end_a) = start, end
    c1, c2 = h * w, 0.5 * h * h * a
    rise, slope, bend = end_u - u, h * end_w - c1 - 2.0 * c2, h * h * (end_a - a)
    # Where a rise is rounding of the value, the rates tell it better.
    by_rates = c1 + c2 + 0.5 * slope - bend / 12.0
    rise = by_rates + (rise - by_rates) * (abs(rise - by_rates) > 1e-15 * abs(u)) - c1 - c2
    c5 = 6.0 * rise - 3.0 * slope + 0.5 * bend
    c3, c4 = 4.0 * rise - slope + c5, 7.0 * slope - 15.0 * rise - bend
    value = u + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5))))
    return value, (c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) / h
