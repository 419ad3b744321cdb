"""Newton's law of a body on contacts in the world's axes, for tests of motion over moving supports.

It knows nothing of the support's frame: it takes the mass centre and the angle in the world, and finds the reactions
from what the contacts' accelerations there must be.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from impact_predictor import TwoPointBody
from impact_predictor.mechanics.motion.support import Support


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


def is_disc(body: TwoPointBody) -> bool:
    return body.old is not None and body.old.normal != (0.0, 1.0)


def touch(body: TwoPointBody, support: Support, i: int, time: float, y: Any) -> Touch:
    """Contact i of a body with place, angle and their rates `y` in the world."""
    moves = support.motion(time)
    assert body.old is not None
    contact = body.new if i else body.old
    c, s = math.cos(moves.angle), math.sin(moves.angle)
    origin, speed, push = (np.array(pair) for pair in ((moves.x, moves.y), (moves.vx, moves.vy), (moves.ax, moves.ay)))
    place, velocity, omega = y[:2], y[3:5], y[5]
    if is_disc(body):
        edge = np.array([contact.x - body.old.x, contact.y - body.old.y])
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


def newton(body: TwoPointBody, support: Support, states: str, time: float, y: Any) -> tuple[list[float], Any]:
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
        contact = body.new if i else body.old
        assert contact is not None
        friction = {"S": None, "+": -contact.friction, "-": contact.friction}[state]
        if friction is None:
            rows += [row_n, row_t]
            wanted += [want_n, want_t]
            levers += [[*normal, cross(lever, normal)], [*tangent, cross(lever, tangent)]]
        else:
            along = normal + friction * tangent
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
