"""Newton's law of a body on contacts in the world's axes, for tests of motion over fixed and moving supports.

It knows nothing of the support's frame: it takes the mass centre and the angle in the world, and finds the reactions
from what the contacts' accelerations there must be.
"""

from __future__ import annotations

import math
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
    """A contact in the world at one instant: the lever from the mass centre to it, and the support there."""

    lever: Any
    normal: Any
    tangent: Any
    gap: float
    slip: float
    ground: Any
    """Acceleration of the support's point under it."""


def cross(a: Any, b: Any) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def left_of(a: Any) -> Any:
    return np.array([-a[1], a[0]])


def is_disc(body: Body) -> bool:
    return bool(contacts_of(body)[0].normal != (0.0, 1.0))


def touch(body: Body, support: Support, i: int, time: float, y: Any) -> Touch:
    """Contact i of a body with place, angle and their rates `y` in the world."""
    moves = support.motion(time)
    contact, edge_0 = contacts_of(body)[i], contacts_of(body)[0]
    c, s = math.cos(moves.angle), math.sin(moves.angle)
    origin, speed, push = (np.array(pair) for pair in ((moves.x, moves.y), (moves.vx, moves.vy), (moves.ax, moves.ay)))
    place, velocity, omega = y[:2], y[3:5], y[5]
    if is_disc(body):
        edge = np.array([contact.x - edge_0.x, contact.y - edge_0.y])
        point = origin + np.array([c * edge[0] - s * edge[1], s * edge[0] + c * edge[1]])
        distance = np.linalg.norm(place - point)
        normal = (place - point) / distance
        gap = float(distance) - math.hypot(contact.x, contact.y)
    else:
        cb, sb = math.cos(y[2]), math.sin(y[2])
        point = place + np.array([cb * contact.x - sb * contact.y, sb * contact.x + cb * contact.y])
        normal = np.array([-s, c])
        gap = float(normal @ (point - origin))
    tangent = np.array([normal[1], -normal[0]])
    lever, arm = point - place, point - origin
    ground = push + moves.acceleration * left_of(arm) - moves.rate**2 * arm
    slip = velocity + omega * left_of(lever) - (speed + moves.rate * left_of(arm))
    return Touch(lever, normal, tangent, gap, float(tangent @ slip), ground)


def newton(body: Body, support: Support, states: str, time: float, y: Any) -> tuple[list[float], Any]:
    """Rates of (x, y, angle, vx, vy, omega), and the reactions, from a linear system.

    `states` of the contacts: O open, S sticks, + or - slips along +t or -t. The reactions are N and T of a contact that
    sticks and N of one that slips, in this order.
    """
    moves = support.motion(time)
    velocity, omega = y[3:5], y[5]
    rows, wanted, levers = [], [], []
    for i, state in enumerate(states):
        if state == "O":
            continue
        lever, normal, tangent, _, _, ground = touch(body, support, i, time, y)
        arm = y[:2] + lever - np.array([moves.x, moves.y])
        ground_speed = np.array([moves.vx, moves.vy]) + moves.rate * left_of(arm)
        if is_disc(body):
            # The distance from the edge stays, and the rim rolls on it or slips.
            relative = velocity - ground_speed
            want_n, want_t = normal @ ground - relative @ relative / math.hypot(*lever), tangent @ ground
            row_n = np.array([normal[0], normal[1], 0.0])
        else:
            slip = velocity + omega * left_of(lever) - ground_speed
            want = ground + 2.0 * moves.rate * left_of(slip) + omega**2 * lever
            want_n, want_t = normal @ want, tangent @ want
            row_n = np.array([*normal, cross(lever, normal)])
        row_t = np.array([*tangent, cross(lever, tangent)])
        friction = {"S": None, "+": -1.0, "-": 1.0}[state]
        if friction is None:
            rows += [row_n, row_t]
            wanted += [want_n, want_t]
            levers += [[*normal, cross(lever, normal)], [*tangent, cross(lever, tangent)]]
        else:
            along = normal + friction * contacts_of(body)[i].friction * tangent
            rows.append(row_n)
            wanted.append(want_n)
            levers.append([*along, cross(lever, along)])
    free = np.array([0.0, -support.gravity, 0.0])
    reaction = np.zeros(0)
    if rows:
        weights = np.array([1.0 / body.mass, 1.0 / body.mass, 1.0 / body.inertia])
        forces = np.array(levers)
        system = np.array(rows) @ (weights[:, None] * forces.T)
        reaction = np.linalg.lstsq(system, np.array(wanted) - np.array(rows) @ free, rcond=None)[0]
        free = free + weights * (forces.T @ reaction)
    return [y[3], y[4], y[5], *free], reaction


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
    for i, (state, of) in enumerate(zip(states, contacts_of(body), strict=True)):
        contact = touch(body, support, i, time, y)
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

        def margin(t: float, y: Any, name: str, states: str = states, begin: float = time) -> float:
            # What begins at zero is not over as soon as rounding says so.
            return margins(body, support, states, t, y)[name] if t > begin + 1e-9 else 1.0

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
