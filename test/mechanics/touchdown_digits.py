"""Touchdowns in 40 digits, by other formulas than the program's own.

A body that turns: the energy integral by quadrature. One that slips: the equations of motion over the angle, by
extrapolation. One in flight: the root of the path of the point that strikes first.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

from mpmath import mp

from impact_predictor.report.accuracy.touchdowns import FallingBody, PredictedTouchdown

Real = Any
"""A number of mpmath."""

DIGITS = 40
GUARD = 20
"""Digits more in the computation: a body out of its balance by 1e-12 loses as many."""

STEPS = 3
"""Steps of the extrapolation over the angle."""

LOOKS = 1000
"""How often the flight is looked at for its first strike."""


class Touchdown40(NamedTuple):
    """A touchdown: time in s and twist in 40 digits."""

    time: Real
    twist: tuple[Real, Real, Real]


def reference_of(fall: FallingBody) -> Touchdown40:
    """The touchdown of a body that goes on moving as it moves now."""
    with mp.workdps(DIGITS + GUARD):
        if fall.stance is None:
            return flight(fall)
        slip = mp.mpf(fall.state.vx) + mp.mpf(fall.state.omega) * arm_of(fall, mp.mpf(fall.state.angle))[1]
        speeds = abs(fall.state.vx) + abs(fall.state.omega * fall.state.y)
        return sliding(fall, slip) if abs(slip) > 1e-12 * speeds else turning(fall)


def arm_of(fall: FallingBody, angle: Real) -> tuple[Real, Real]:
    """The mass centre from the stance contact, at an angle."""
    assert fall.stance is not None
    x, y = map(mp.mpf, fall.points[fall.stance])
    c, s = mp.cos(angle), mp.sin(angle)
    return s * y - c * x, -s * x - c * y


def turning(fall: FallingBody) -> Touchdown40:
    """omega^2 = 2 k (cos(rest) - cos(lean)), the lean from the balance; and with lean = rest + s^2 no root is left."""
    x, y = arm_of(fall, mp.mpf(0))
    k = -mp.mpf(fall.gravity[1]) * mp.hypot(x, y) / (mp.mpf(fall.rho_squared) + x * x + y * y)
    lean = mp.atan2(x, y) - mp.mpf(fall.state.angle)
    omega = mp.mpf(fall.state.omega)
    rest = mp.acos(mp.cos(lean) + omega * omega / (2 * k)) if omega else lean

    def density(s: Real) -> Real:
        return s / mp.sqrt(k * mp.sin(rest + s * s / 2) * mp.sin(s * s / 2)) if s else 1 / mp.sqrt(k / 2 * mp.sin(rest))

    def time_to(end: Real) -> Real:
        # Near the balance the integrand falls from the root of `rest` on, over decades.
        last = mp.sqrt(end - rest)
        places = [mp.mpf(0)]
        place = mp.sqrt(abs(rest)) / 4
        while place < last / 2:
            places.append(place)
            place *= 4
        return mp.quad(density, [*places, last])

    end = mp.atan2(x, y)
    before = mp.mpf(0) if lean <= rest else time_to(lean)
    rate = -mp.sqrt(2 * k * (mp.cos(rest) - mp.cos(end)))
    return Touchdown40(time_to(end) + (before if omega > 0 else -before), (-rate * y, rate * x, rate))


def sliding(fall: FallingBody, slip: Real) -> Touchdown40:
    """Square of the rate, time and slip over the angle, to where B touches."""
    drag = mp.sign(slip) * mp.mpf(fall.friction)
    rho_squared, gravity = mp.mpf(fall.rho_squared), mp.mpf(fall.gravity[1])

    def slopes(angle: Real, values: list[Real]) -> list[Real]:
        square = values[0]
        x, y = arm_of(fall, angle)
        lever = x + drag * y
        alpha = (square * y + gravity) * lever / (rho_squared + x * lever)
        normal = alpha * x - square * y - gravity
        omega = -mp.sqrt(square)
        return [2 * alpha, 1 / omega, (alpha * y + square * x - drag * normal) / omega]

    start = [mp.mpf(fall.state.omega) ** 2, mp.mpf(0), slip]
    square, time, after = extrapolated(slopes, mp.mpf(fall.state.angle), mp.mpf(0), start)
    x, y = arm_of(fall, mp.mpf(0))
    omega = -mp.sqrt(square)
    return Touchdown40(time, (after - omega * y, omega * x, omega))


def extrapolated(
    slopes: Callable[[Real, list[Real]], list[Real]], begin: Real, end: Real, values: list[Real]
) -> list[Real]:
    """Integrate by the midpoint rule, extrapolated until it settles (Gragg, Bulirsch and Stoer)."""
    close = mp.mpf(10) ** -(DIGITS + 2)
    for place, following in pairwise(mp.linspace(begin, end, STEPS + 1)):
        table: list[list[Real]] = []
        first = slopes(place, values)
        for substeps in range(2, 200, 2):
            h = (following - place) / substeps
            last, now = values, [v + h * s for v, s in zip(values, first, strict=True)]
            for i in range(1, substeps):
                rates = slopes(place + i * h, now)
                last, now = now, [v + 2 * h * s for v, s in zip(last, rates, strict=True)]
            row = [now]
            for column, coarse in enumerate(table[-1] if table else []):
                gain = mp.mpf(substeps) ** 2 / (substeps - 2 * column - 2) ** 2 - 1
                row.append([v + (v - w) / gain for v, w in zip(row[-1], coarse, strict=True)])
            if table and all(
                abs(v - w) <= close * (abs(v) + abs(w)) for v, w in zip(row[-1], table[-1][-1], strict=True)
            ):
                break
            table.append(row)
        values = row[-1]
    return values


def flight(fall: FallingBody) -> Touchdown40:
    """The earliest root of the gaps, found on a fine grid and then polished."""
    x, y, angle, vx, vy, omega = map(mp.mpf, fall.state)
    pull_x, pull_y = map(mp.mpf, fall.gravity)

    def gap(point: tuple[float, float]) -> Callable[[Real], Real]:
        def at(t: Real) -> Real:
            turned = angle + omega * t
            return y + (vy + pull_y * t / 2) * t + mp.sin(turned) * point[0] + mp.cos(turned) * point[1]

        return at

    gaps = [gap(point) for point in fall.points]
    last = 2 * (abs(vy) + mp.sqrt(vy * vy - 2 * pull_y * y)) / -pull_y
    with mp.workdps(15):
        first, until = next(
            (a, b) for a, b in pairwise(mp.linspace(0, last, LOOKS)) if any(each(a) > 0 >= each(b) for each in gaps)
        )
    struck = (each for each in gaps if each(first) > 0 >= each(until))
    time = min(mp.findroot(each, (first, until), solver="anderson", tol=mp.mpf(10) ** -(2 * DIGITS)) for each in struck)
    return Touchdown40(time, (vx + pull_x * time, vy + pull_y * time, omega))


def errors_of(fall: FallingBody, arrival: PredictedTouchdown) -> tuple[float, float]:
    """Error of the time, relative to it, and of the twist, relative to its size by the kinetic energy."""
    with mp.workdps(DIGITS):
        right, rho = reference_of(fall), mp.sqrt(fall.rho_squared)
        weights = (1, 1, rho)
        apart = [w * (mp.mpf(v) - u) for v, u, w in zip(arrival.twist, right.twist, weights, strict=True)]
        size = [w * u for u, w in zip(right.twist, weights, strict=True)]
        return float(abs(arrival.time - right.time) / right.time), float(mp.norm(apart) / mp.norm(size))
