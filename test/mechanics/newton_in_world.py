"""Newton's law of a body on contacts in the world's axes, for tests of motion over fixed and moving supports.

It knows nothing of the support's frame: it takes the mass centre and the angle in the world, and finds the reactions
from what the contacts' accelerations there must be.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from harmonic_deck import Wave, from_world, harmonic_support
from scipy.integrate import solve_ivp

from impact_predictor import Contact, TwoPointBody
from impact_predictor.mechanics.motion import PlanarState
from impact_predictor.mechanics.motion.support import MovingSupport, Support, SupportMotion, in_world


class Polygon(NamedTuple):
    """A body of more than two contact points, as far as Newton's law asks for it."""

    mass: float
    inertia: float
    contacts: tuple[Contact, ...]


Body = TwoPointBody | Polygon
HELD = math.inf
"""Friction of a contact that neither slips nor lifts."""


SMOOTH = TwoPointBody(50.0, 7.0, Contact(-0.4, -0.5, 0.1), Contact(0.4, -0.5, 0.15))
DECK = harmonic_support(
    angle=(Wave(0.25, 1.1, 0.3), Wave(0.08, 2.3, 1.0)),
    x=(Wave(0.9, 0.9, 2.0),),
    y=(Wave(1.1, 1.3, 0.5), Wave(0.2, 3.1)),
).at(4.0, 2.5)


def accelerated(
    ax: float = 0.0,
    ay: float = 0.0,
    turning: float = 0.0,
    angle: float = 0.0,
    rate: float = 0.0,
    vy: float = 0.0,
    gravity: float = 9.81,
) -> MovingSupport:
    """A support of constant linear and angular acceleration."""

    def motion(t: Any) -> SupportMotion:
        angles = angle + (rate + 0.5 * turning * t) * t, rate + turning * t, 0.0 * t + turning
        places = 0.5 * ax * t * t, (vy + 0.5 * ay * t) * t
        return SupportMotion(*angles, *places, ax * t, vy + ay * t, 0.0 * t + ax, 0.0 * t + ay)

    return MovingSupport(motion, 1.0, gravity)


def contacts_of(body: Body) -> tuple[Any, ...]:
    return body.contacts if isinstance(body, Polygon) else (body.old, body.new)


class Touch(NamedTuple):
    """A contact in the world at one instant: the lever from the mass centre to it, and the support there.

    Vectors are complex numbers, x + iy: most of the time of these tests goes into this law.
    """

    lever: complex
    normal: complex
    tangent: complex
    gap: float
    slips: complex
    """Velocity against the support's point under it ..."""
    slip: float
    """... and the part of it along the tangent."""
    ground: complex
    """Acceleration of the support's point under it."""


def dot(a: complex, b: complex) -> float:
    return a.real * b.real + a.imag * b.imag


def cross(a: complex, b: complex) -> float:
    return a.real * b.imag - a.imag * b.real


def is_disc(body: Body) -> bool:
    return bool(contacts_of(body)[0].normal != (0.0, 1.0))


def touch(body: Body, support: Support, i: int, time: float, y: Any) -> Touch:
    """Contact i of a body with place, angle and their rates `y` in the world."""
    return touches(body, support, [i], time, y)[0]


def touches(body: Body, support: Support, which: Sequence[int], time: float, y: Any) -> list[Touch]:
    """Some contacts at the same instant."""
    moves = SupportMotion(*map(float, support.motion(time)))
    px, py, angle, vx, vy, omega = map(float, y)
    turned, place, velocity = cmath.rect(1.0, moves.angle), complex(px, py), complex(vx, vy)
    origin, speed, push = complex(moves.x, moves.y), complex(moves.vx, moves.vy), complex(moves.ax, moves.ay)
    contacts, disc, found = contacts_of(body), is_disc(body), []
    for i in which:
        contact, edge_0 = contacts[i], contacts[0]
        if disc:
            point = origin + turned * complex(contact.x - edge_0.x, contact.y - edge_0.y)
            distance = abs(place - point)
            normal = (place - point) / distance
            gap = distance - math.hypot(contact.x, contact.y)
        else:
            point = place + cmath.rect(1.0, angle) * complex(contact.x, contact.y)
            normal = 1j * turned
            gap = dot(normal, point - origin)
        tangent = -1j * normal
        lever, arm = point - place, point - origin
        ground = push + moves.acceleration * 1j * arm - moves.rate**2 * arm
        slips = velocity + omega * 1j * lever - (speed + moves.rate * 1j * arm)
        found.append(Touch(lever, normal, tangent, gap, slips, dot(tangent, slips), ground))
    return found


def newton(body: Body, support: Support, states: str, time: float, y: Any) -> tuple[list[float], list[float]]:
    """Rates of (x, y, angle, vx, vy, omega), and the reactions, from a linear system.

    `states` of the contacts: O open, S sticks, + or - slips along +t or -t. The reactions are N and T of a contact that
    sticks and N of one that slips, in this order.
    """
    rate, omega = float(support.motion(time).rate), float(y[5])
    # A direction and the moment about the mass centre that a force of 1 along it has.
    rows: list[tuple[complex, float]] = []
    levers: list[tuple[complex, float]] = []
    wanted: list[float] = []
    closed = [i for i, state in enumerate(states) if state != "O"]
    for i, contact in zip(closed, touches(body, support, closed, time, y), strict=True):
        lever, normal, tangent, _, slips, _, ground = contact
        along_n, along_t = (normal, cross(lever, normal)), (tangent, cross(lever, tangent))
        if is_disc(body):
            # The distance from the edge stays, and the rim rolls on it or slips.
            relative = abs(slips - omega * 1j * lever)
            want_n, want_t = dot(normal, ground) - relative**2 / abs(lever), dot(tangent, ground)
            row_n = normal, 0.0
        else:
            want = ground + 2.0 * rate * 1j * slips + omega**2 * lever
            want_n, want_t = dot(normal, want), dot(tangent, want)
            row_n = along_n
        friction = {"S": None, "+": -1.0, "-": 1.0}[states[i]]
        if friction is None:
            rows += [row_n, along_t]
            wanted += [want_n, want_t]
            levers += [along_n, along_t]
        else:
            along = normal + friction * contacts_of(body)[i].friction * tangent
            rows.append(row_n)
            wanted.append(want_n)
            levers.append((along, cross(lever, along)))
    fall = complex(0.0, -support.gravity)
    system = [
        [dot(row, force) / body.mass + arm * moment / body.inertia for force, moment in levers] for row, arm in rows
    ]
    reaction = solved(system, [want - dot(row, fall) for want, (row, _) in zip(wanted, rows, strict=True)])
    free, turns = fall, 0.0
    for (force, moment), size in zip(levers, reaction, strict=True):
        free, turns = free + size * force / body.mass, turns + size * moment / body.inertia
    return [*map(float, y[3:]), free.real, free.imag, turns], reaction


def solved(system: list[list[float]], wanted: list[float]) -> list[float]:
    """The reactions of a linear system; the least ones where two contacts bear what one could."""
    if len(wanted) == 1 and system[0][0]:
        return [wanted[0] / system[0][0]]
    if len(wanted) == 2:
        ((a, b), (c, d)), (first, second) = system, wanted
        if abs(a * d - b * c) > 1e-6 * (abs(a * d) + abs(b * c)):
            return [(first * d - b * second) / (a * d - b * c), (a * second - first * c) / (a * d - b * c)]
    return list(np.linalg.lstsq(np.array(system), np.array(wanted), rcond=None)[0].tolist()) if wanted else []


class Course(NamedTuple):
    """The way to the next strike: `states` of the contacts in each phase, from its time in `begins` on.

    `point` strikes at `time`, with `state` in the support's frame; it is -1, and `time` inf, where nothing strikes.
    """

    time: float
    point: int
    state: PlanarState
    states: list[str]
    begins: list[float]


def margins(body: Body, support: Support, states: str, time: float, y: Any) -> dict[str, float]:
    """What ends a phase where it falls to zero, by the states after it or by the contact that strikes."""
    found: dict[str, float] = {}
    reaction = newton(body, support, states, time, y)[1]
    every = touches(body, support, range(len(states)), time, y)
    for i, (state, of, contact) in enumerate(zip(states, contacts_of(body), every, strict=True)):
        if state == "O":
            found[str(i)] = contact.gap
        elif state in "+-":
            found["O" * len(states)] = reaction[0]
            found[states.replace(state, "S")] = contact.slip if state == "+" else -contact.slip
        elif of.friction < HELD:
            found["O" * len(states)] = reaction[0]
            found[states.replace("S", "+")] = of.friction * reaction[0] + reaction[1]
            found[states.replace("S", "-")] = of.friction * reaction[0] - reaction[1]
    return found


def without_slip(body: Body, support: Support, states: str, time: float, y: Any) -> str:
    """The states a contact goes on with that stood still (S in `states`): it sticks, slips one way, or is left."""
    if (
        min([value for name, value in margins(body, support, states, time, y).items() if not name.isdigit()] or [0])
        >= 0
    ):
        return states
    for sign in "+-":
        slips = states.replace("S", sign)
        rates, reaction = newton(body, support, slips, time, y)
        soon = touch(body, support, states.index("S"), time + 1e-7, y + 1e-7 * np.array(rates)).slip
        if reaction[0] > 0.0 and (soon > 0.0) is (sign == "+"):
            return slips
    return "O" * len(states)


def strike_by_newton(
    body: Body, support: Support, start: PlanarState, states: str, duration: float, max_step: float = 0.005
) -> Course:
    """Integrate phase after phase, each to the first root of its margins, from `states` on or what they allow.

    `max_step` is so short that no dip is stepped over, and roots on the interpolants are as exact.
    """
    time, y = 0.0, np.array(in_world(support.motion(0.0), start))
    course: list[str] = []
    begins: list[float] = []
    while len(course) < 20:
        if "S" in states:
            states = without_slip(body, support, states, time, y)
        elif states.strip("O") and newton(body, support, states, time, y)[1][0] <= 0.0:
            states = "O" * len(states)
        course.append(states)
        begins.append(time)
        names = list(margins(body, support, states, time, y))

        # Of a step each margin is asked for.
        @lru_cache(maxsize=2)
        def all_margins(t: float, *y: float, states: str = states) -> dict[str, float]:
            return margins(body, support, states, t, y)

        def margin(t: float, y: Any, name: str, asked: Any = all_margins, begin: float = time) -> float:
            # What begins at zero is not over as soon as rounding says so.
            return float(asked(t, *y)[name]) if t > begin + 1e-9 else 1.0

        events: list[Any] = [lambda t, y, name=name, margin=margin: margin(t, y, name) for name in names]
        for event in events:
            event.direction, event.terminal = -1.0, True
        goes = solve_ivp(
            lambda t, y, states=states: newton(body, support, states, t, y)[0],
            (time, duration),
            y,
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            max_step=max_step,
            events=events,
        )
        time, y = float(goes.t[-1]), goes.y[:, -1]
        state = from_world(support.motion(time), PlanarState(*y))
        if goes.status == 0:
            return Course(math.inf, -1, state, course, begins)
        states = next(name for name, times in zip(names, goes.t_events, strict=True) if len(times))
        if states.isdigit():
            return Course(time, int(states), state, course, begins)
    raise AssertionError("the body changes its motion without end")
