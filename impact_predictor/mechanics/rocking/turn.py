"""Turning about a contact that sticks on a fixed support, in closed form."""

from __future__ import annotations

import math

from ..first_root import first_descent
from ..stretch import End, Stretch
from ..turning_stance import turn
from ..types import Vector
from .arcs import Arc, Happening
from .follow import Event
from .shape import Shape, turned
from .step import Instant


def turn_about(arc: Arc, last: float, limit: float) -> Event:
    """Turn about the contact that sticks to the first event, or for `last` s; `limit` rad is where it overturns."""
    shape, i = arc.shape, arc.contact
    now = arc.instants[0]
    time, u, w = now.time, now.u, now.w
    side = 1.0 if i == 0 else -1.0
    felt = arc.support.felt(arc.start)
    gravity = felt[0], felt[1]
    home, over = side * u, limit - side * u
    stretch = _stretch(shape, i, u, w, (home, over) if i == 0 else (over, home), gravity)
    if stretch.end is End.TURNS and u == 0.0:
        # What rises from both contacts comes back as it went, with the same reactions at every angle.
        return _ends(arc, last, Happening.TOUCHES, 1 - i, time + 2.0 * stretch.time, 0.0, -w)
    if stretch.end is End.TURNS:
        time, u, w = time + stretch.time, u + stretch.turned, 0.0
        home, over = side * u, limit - side * u
        stretch = _stretch(shape, i, u, w, (home, over) if i == 0 else (over, home), gravity)
    time += stretch.time
    if stretch.end is End.NEVER or stretch.end is End.TURNS:
        return _ends(arc, last, Happening.BALANCES, i, math.inf if w else time, u, w)
    u += stretch.turned
    if stretch.end is End.SLIPS:
        slips = Happening.SLIPS if stretch.direction > 0 else Happening.SLIPS_BACK
        return _ends(arc, last, slips, i, time, u, stretch.omega)
    if stretch.direction * side < 0.0:
        return _ends(arc, last, Happening.TOUCHES, 1 - i, time, 0.0, stretch.omega)
    return _ends(arc, last, Happening.OVERTURNS, i, time, side * limit, stretch.omega)


def _ends(arc: Arc, last: float, happening: Happening, contact: int, time: float, u: float, w: float) -> Event:
    if time <= last:
        z = arc.instants[0].z
        alpha, _ = arc.rate()(time, u, w, z, 0.0)
        arc.instants.append(Instant(time, u, w, z, 0.0, alpha, 0.0))
        return Event(happening, contact, arc.instants[-1])
    arc.instants += arc.steps(arc.instants[0], last)
    return Event(Happening.TIME_IS_UP, arc.contact, arc.instants[-1])


def _stretch(shape: Shape, i: int, u: float, w: float, travel: Vector, gravity: Vector) -> Stretch:
    """As `turn`, for either shape: a disc's normal turns with it."""
    arm = turned(shape.arms[i], u)
    if not shape.rolls:
        return turn(arm, w, travel, shape.rho_squared, shape.friction[i], gravity)
    stretch = turn(arm, w, travel, shape.rho_squared, math.inf, gravity)
    if not stretch.turned:
        return stretch
    direction = 1.0 if stretch.turned > 0.0 else -1.0
    nearest, slips = math.inf, 0
    for slip in (1, -1):
        travel_to = _first_slip_of_disc(shape, i, arm, w, direction, slip, gravity, abs(stretch.turned))
        if travel_to < nearest:
            nearest, slips = travel_to, slip
    if not slips:
        return stretch
    if nearest == 0.0:
        return Stretch(End.SLIPS, 0.0, 0.0, w, direction=slips)
    part = turn(arm, w, (nearest, nearest), shape.rho_squared, math.inf, gravity)
    return part._replace(end=End.SLIPS, direction=slips)


def _first_slip_of_disc(
    shape: Shape, i: int, arm: Vector, w: float, direction: float, slip: int, gravity: Vector, last: float
) -> float:
    """How far in rad a disc turns about an edge until friction cannot hold it against the slip +1 or -1.

    With the angle x turned, energy gives w^2, and f N + slip T is a constant, a cosine and a sine of x.
    """
    (dx, dy), (gx, gy) = arm, gravity
    square, inertia = shape.rho_squared, shape.inertia[i]
    radius, friction = shape.radii[i], shape.friction[i]
    # g . d and d x g turn into each other; N = -(g . d)/R - w^2 R, T = rho^2 (d x g)/(R I), and w^2 grows by twice
    # what g . d does, over I.
    along, across = gx * dx + gy * dy, dx * gy - dy * gx
    load = friction * (1.0 / radius + 2.0 * radius / inertia)
    drag = slip * square / (radius * inertia)
    level = friction * radius * (2.0 * along / inertia - w * w)
    cosine, sine = -load * along + drag * across, direction * (-load * across - drag * along)
    if level + cosine < 0.0:
        return 0.0
    return first_descent(level, 0.0, 0.0, ((cosine, sine, 1.0),), last)
