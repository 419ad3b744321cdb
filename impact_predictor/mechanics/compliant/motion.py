"""Long motions of a rigid body on compliant contacts over a straight support that may move: `compliant_motion`.

It knows nothing of impacts, modes or events: the contact points have the forces of `force`, and Newton's and
Euler's equations are integrated in the world's axes, where there are no forces but those and gravity. So it shares
nothing with the rigid laws and can judge them. Needs scipy.
"""

from __future__ import annotations

from math import cos, inf, isfinite, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from scipy import integrate

from ..motion import PlanarState
from ..motion.support import FixedSupport, Support
from ..types import Contact, TwoPointBody, Vector
from .force import Compliance, damping_ratio, force, slopes
from .integrator import METHODS, Array, Status, run

LONGEST_STEP = 0.05
"""Of the integrator, in units of sqrt(rho / g): a step must not jump over a contact that closes and opens."""


LEAST_TOLERANCE = 1e-12
"""The least relative tolerance: a smaller one is rounding."""


LEVEL = FixedSupport()


class _Forces(NamedTuple):
    """Equations of motion of a body; the state is (x, y, angle, vx, vy, omega) in the world's axes."""

    mass: float
    inertia: float
    points: tuple[Vector, ...]
    compliances: tuple[Compliance, ...]
    support: Support

    def contacts(self, time: float, state: Any) -> tuple[Vector, list[tuple[float, float, float, float, float]]]:
        """The support's normal, and the gap, its rate, the slip and the place from the mass centre of each point."""
        x, y, angle, vx, vy, omega = state
        base = self.support.motion(time)
        nx, ny = -sin(base.angle), cos(base.angle)
        c, s = cos(angle), sin(angle)
        found = []
        for px, py in self.points:
            ax, ay = c * px - s * py, s * px + c * py
            dx, dy = x + ax - base.x, y + ay - base.y
            cx, cy = vx - omega * ay - base.vx + base.rate * dy, vy + omega * ax - base.vy - base.rate * dx
            found.append((nx * dx + ny * dy, nx * cx + ny * cy, ny * cx - nx * cy, ax, ay))
        return (nx, ny), found

    def forces(self, time: float, state: Any) -> list[Vector]:
        """Normal and tangential force on each point (N)."""
        _, contacts = self.contacts(time, state)
        return [force(each, *contact[:3]) for each, contact in zip(self.compliances, contacts, strict=True)]

    def rates(self, time: float, state: Array) -> list[float]:
        """The right-hand side."""
        values = state.tolist()
        (nx, ny), contacts = self.contacts(time, values)
        fx, fy, moment = 0.0, -self.mass * self.support.gravity, 0.0
        for compliance, (gap, rate, slip, ax, ay) in zip(self.compliances, contacts, strict=True):
            normal, tangential = force(compliance, gap, rate, slip)
            px, py = normal * nx + tangential * ny, normal * ny - tangential * nx
            fx, fy, moment = fx + px, fy + py, moment + ax * py - ay * px
        return [values[3], values[4], values[5], fx / self.mass, fy / self.mass, moment / self.inertia]

    def jacobian(self, time: float, state: Array) -> Array:
        """The derivatives of `rates` by the state, without those of the levers: the contacts are far stiffer."""
        (nx, ny), contacts = self.contacts(time, state.tolist())
        found = np.zeros((6, 6))
        found[0, 3] = found[1, 4] = found[2, 5] = 1.0
        share = np.array((1.0 / self.mass, 1.0 / self.mass, 1.0 / self.inertia))
        for compliance, (gap, rate, slip, ax, ay) in zip(self.compliances, contacts, strict=True):
            by = slopes(compliance, gap, rate, slip)
            along_n = np.array((nx, ny, ax * ny - ay * nx))
            along_t = np.array((ny, -nx, -(ax * nx + ay * ny)))
            normal = np.concatenate((by.gap * along_n, by.rate * along_n))
            tangential = np.concatenate((np.zeros(3), by.slip * along_t)) + by.tangential * normal
            found[3:] += np.outer(share * along_n, normal) + np.outer(share * along_t, tangential)
        return found


class CompliantMotion(NamedTuple):
    """A motion on compliant contacts: how it ended, when (s), and the evaluations of the right-hand side."""

    status: Status
    time: float
    evaluations: int
    equations: _Forces
    way: Any

    def world(self, time: float) -> PlanarState:
        """The state in the world's axes at a time from the start to the end."""
        return PlanarState(*self.way(time).tolist())

    def state(self, time: float) -> PlanarState:
        """The state seen from the support's frame, which turns."""
        x, y, angle, vx, vy, omega = self.world(time)
        base = self.equations.support.motion(time)
        dx, dy = x - base.x, y - base.y
        wx, wy = vx - base.vx + base.rate * dy, vy - base.vy - base.rate * dx
        c, s = cos(base.angle), sin(base.angle)
        return PlanarState(
            c * dx + s * dy, c * dy - s * dx, angle - base.angle, c * wx + s * wy, c * wy - s * wx, omega - base.rate
        )

    def gaps(self, time: float) -> tuple[float, ...]:
        """Gap of each point in m, negative in depth."""
        return tuple(contact[0] for contact in self.equations.contacts(time, self.way(time))[1])

    def forces(self, time: float) -> tuple[Vector, ...]:
        """Force on each point in N, along the support's normal and its tangent."""
        return tuple(self.equations.forces(time, self.way(time)))


def compliant_motion(
    body: TwoPointBody,
    start: PlanarState,
    support: Support = LEVEL,
    duration: float = 10.0,
    *,
    start_time: float = 0.0,
    more: tuple[Contact, ...] = (),
    stiffness: float = 1e8,
    regularisation: float = 1e-4,
    method: str = "LSODA",
    tolerance: float = 1e-8,
    evaluations: int = 1_000_000,
) -> CompliantMotion:
    """The motion of a body from `start` (the mass centre's state in the support's frame) for `duration` in s.

    The body's contacts and `more` of them are its points; of each the place, friction and restitution count, and the
    `stiffness` (N/m) is common. A restitution of 0 stands for `force.PLASTIC`. Friction reaches 0.71 of its
    full at a slip of `regularisation` (m/s): a body at rest on a slope creeps by less. `tolerance` is the
    integrator's, in m/s and rad/s, and times sqrt(mass / stiffness) in m and rad.

    Never raises for a number: see `Status`. ValueError: an unknown method.
    """
    if method not in METHODS:
        raise ValueError(f"method is {method!r}; use one of {', '.join(METHODS)}")
    mass, inertia, old, new = body
    contacts = (*((old,) if old is not None else ()), new, *more)
    numbers = (mass, inertia, stiffness, regularisation, tolerance, duration)
    in_range = all(0.0 < number < inf for number in numbers) and all(map(isfinite, (*start, start_time)))
    for contact in contacts:
        finite = isfinite(contact.x) and isfinite(contact.y)
        in_range = in_range and finite and 0.0 <= contact.friction < inf and 0.0 <= contact.restitution <= 1.0
    if not in_range:
        return CompliantMotion(
            Status.INVALID_INPUT, 0.0, 0, _Forces(mass, inertia, (), (), support), lambda time: np.zeros(6)
        )
    compliances = tuple(
        Compliance(
            stiffness,
            2.0 * damping_ratio(contact.restitution) * sqrt(stiffness / (1.0 / mass + contact.x * contact.x / inertia)),
            contact.friction,
            regularisation,
        )
        for contact in contacts
    )
    points = tuple((contact.x, contact.y) for contact in contacts)
    equations = _Forces(mass, inertia, points, compliances, support)
    time_unit = sqrt(mass / stiffness)
    way = run(
        equations.rates,
        equations.jacobian,
        np.array(_in_world(start, support, start_time)),
        duration,
        method,
        (max(tolerance * time_unit, LEAST_TOLERANCE), tolerance * np.array([time_unit] * 3 + [1.0] * 3)),
        evaluations,
        keep=True,
        start_time=start_time,
        longest_step=LONGEST_STEP * sqrt(sqrt(inertia / mass) / max(abs(support.gravity), 1.0)),
    )
    return CompliantMotion(
        way.status, way.time, way.evaluations, equations, integrate.OdeSolution(way.times, way.steps)
    )


def _in_world(state: PlanarState, support: Support, time: float) -> PlanarState:
    """A state of the support's frame in the world's axes."""
    x, y, angle, vx, vy, omega = state
    base = support.motion(time)
    c, s = cos(base.angle), sin(base.angle)
    dx, dy, wx, wy = c * x - s * y, s * x + c * y, c * vx - s * vy, s * vx + c * vy
    return PlanarState(
        base.x + dx,
        base.y + dy,
        angle + base.angle,
        wx + base.vx - base.rate * dy,
        wy + base.vy + base.rate * dx,
        omega + base.rate,
    )
