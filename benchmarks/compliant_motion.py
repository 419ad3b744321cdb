"""Bodies on compliant contacts: a reference that shares no impact law, no modes and no events with the rigid laws.

Each contact has a spring and a damper in parallel, which press where it is closed and never pull, and regularised
Coulomb friction:

    N = max(0, stiffness depth + damping d depth/dt),    T = -friction N s / sqrt(1 + s^2),  s = slip / regularisation.

The damper makes a restitution that does not depend on the speed: a mass that strikes such a contact alone leaves it,
when the force has fallen to zero, with the part `restitution_of(ratio)` of its speed, where `ratio` is that of the
damping to the critical one. No finite damper stops it dead: for large ratios the restitution is 1 / (4 ratio^2).

Newton's and Euler's equations are integrated in the world's axes, where there are no forces but these and gravity.
What becomes of the rigid laws as contacts get stiffer: docs/compliant.md. Needs scipy.
"""

from __future__ import annotations

import warnings
from math import acos, acosh, cos, exp, hypot, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from harmonic_deck import from_world
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from impact_predictor.mechanics.motion import PlanarState
from impact_predictor.mechanics.motion.support import FixedSupport, Support, in_world
from impact_predictor.mechanics.types import Contact, TwoPointBody, Vector

PLASTIC = 1e-3
"""The restitution that a contact without any gets: its damping is 15.7 times the critical one."""

LONGEST_STEP = 0.05
"""Of the integrator, in units of sqrt(rho / g): a step must not jump over a contact that closes and opens."""

LEAST_TOLERANCE = 1e-12
"""The least relative tolerance: a smaller one is rounding."""


class Compliance(NamedTuple):
    """A contact's stiffness (N/m), damping (N s/m) and friction, and the slip (m/s) at which friction is 0.71 of its
    full.
    """

    stiffness: float
    damping: float
    friction: float
    regularisation: float


class ContactSpring(NamedTuple):
    """A contact's gap (m), its rate and the slip (m/s), its arm from the mass centre (m), and the support's normal."""

    gap: float
    rate: float
    slip: float
    arm: Vector
    normal: Vector


def force(contact: Compliance, gap: float, rate: float, slip: float) -> tuple[float, float]:
    """Normal and tangential force on the body (N), from its gap (m), the gap's rate and the slip along the tangent."""
    normal = -contact.stiffness * gap - contact.damping * rate
    if gap > 0.0 or normal <= 0.0:
        return 0.0, 0.0
    s = slip / contact.regularisation
    return normal, -contact.friction * normal * s / sqrt(1.0 + s * s)


def restitution_of(ratio: float) -> float:
    """The restitution of a mass that strikes a contact alone, whose damping is `ratio` times the critical one.

    The force is released when it has fallen to zero, not when the spring is slack: it never pulls.
    """
    if ratio == 1.0:
        return exp(-2.0)
    angle = acos(ratio) if ratio < 1.0 else acosh(ratio)
    return exp(-2.0 * ratio * angle / sqrt(abs((1.0 - ratio) * (1.0 + ratio))))


def damping_ratio(restitution: float) -> float:
    """The damping over the critical one that gives this restitution in 0..1; one below `PLASTIC` counts as that."""
    wanted = max(restitution, PLASTIC)
    return float(brentq(lambda ratio: restitution_of(ratio) - wanted, 0.0, 1.0 / sqrt(PLASTIC), xtol=1e-15))


class CompliantBody(NamedTuple):
    """A body on compliant contacts over a support; its state is (x, y, angle, vx, vy, omega) in the world's axes.

    `places` of the contacts from the mass centre in m.
    """

    mass: float
    inertia: float
    places: tuple[Vector, ...]
    compliances: tuple[Compliance, ...]
    support: Support

    def contacts(self, time: float, state: Any) -> list[ContactSpring]:
        """The contacts at a time in s."""
        x, y, angle, vx, vy, omega = state
        c, s = cos(angle), sin(angle)
        base = self.support.motion(time)
        nx, ny = -sin(base.angle), cos(base.angle)
        found = []
        for px, py in self.places:
            ax, ay = c * px - s * py, s * px + c * py
            dx, dy = x + ax - base.x, y + ay - base.y
            cx, cy = vx - omega * ay - base.vx + base.rate * dy, vy + omega * ax - base.vy - base.rate * dx
            found.append(
                ContactSpring(nx * dx + ny * dy, nx * cx + ny * cy, ny * cx - nx * cy, arm=(ax, ay), normal=(nx, ny))
            )
        return found

    def forces(self, time: float, state: Any) -> list[Vector]:
        """Normal and tangential force on each contact (N)."""
        pairs = zip(self.compliances, self.contacts(time, state), strict=True)
        return [force(compliance, one.gap, one.rate, one.slip) for compliance, one in pairs]

    def rates(self, time: float, state: NDArray[np.float64]) -> list[float]:
        """The right-hand side."""
        values = state.tolist()
        fx, fy, moment = 0.0, -self.mass * self.support.gravity, 0.0
        for compliance, one in zip(self.compliances, self.contacts(time, values), strict=True):
            normal, tangential = force(compliance, one.gap, one.rate, one.slip)
            (nx, ny), (ax, ay) = one.normal, one.arm
            px, py = normal * nx + tangential * ny, normal * ny - tangential * nx
            fx, fy, moment = fx + px, fy + py, moment + ax * py - ay * px
        return [*values[3:], fx / self.mass, fy / self.mass, moment / self.inertia]


class CompliantMotion(NamedTuple):
    """A motion on compliant contacts over one support: whether it came to its end, when it ended (s), and the
    integrator's evaluations of the right-hand side. `way` tells the world state at a time from the start to the end.
    """

    complete: bool
    time: float
    evaluations: int
    body: CompliantBody
    way: Any

    def state(self, time: float) -> PlanarState:
        """The state seen from the support's frame, which turns."""
        return from_world(self.body.support.motion(time), PlanarState(*self.way(time).tolist()))

    def forces(self, time: float) -> list[Vector]:
        """Force on each contact in N, along the support's normal and its tangent."""
        return self.body.forces(time, self.way(time))


def compliant_motion(
    body: TwoPointBody,
    start: PlanarState,
    support: Support = FixedSupport(),  # noqa: B008 - it is immutable
    duration: float = 10.0,
    *,
    start_time: float = 0.0,
    more: tuple[Contact, ...] = (),
    stiffness: float = 1e8,
    regularisation: float = 1e-4,
    method: str = "LSODA",
    tolerance: float = 1e-8,
    until_closed: int | None = None,
) -> CompliantMotion:
    """The motion of a body from `start` (the mass centre's state in the support's frame) for `duration` in s.

    The body's contacts and `more` of them are its points; of each the place, friction and restitution count, and the
    `stiffness` (N/m) is common. A restitution of 0 stands for `PLASTIC`. Friction reaches 0.71 of its full at a slip of
    `regularisation` (m/s): a body at rest on a slope creeps by less. `tolerance` is the integrator's, in m/s and rad/s,
    and times sqrt(mass / stiffness) in m and rad. With `until_closed` the motion ends when a contact from that one on
    closes that was open.
    """
    contacts = (*((body.old,) if body.old is not None else ()), body.new, *more)
    compliances = []
    for contact in contacts:
        nx, ny = contact.normal
        moment = (contact.x * ny - contact.y * nx) / hypot(nx, ny)
        mobility = 1.0 / body.mass + moment * moment / body.inertia
        damping = 2.0 * damping_ratio(contact.restitution) * sqrt(stiffness / mobility)
        compliances.append(Compliance(stiffness, damping, contact.friction, regularisation=regularisation))
    model = CompliantBody(
        mass=body.mass,
        inertia=body.inertia,
        places=tuple((contact.x, contact.y) for contact in contacts),
        compliances=tuple(compliances),
        support=support,
    )

    def gap(time: float, state: NDArray[np.float64]) -> float:
        return min(one.gap for one in model.contacts(time, state)[until_closed:])

    gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]
    unit = sqrt(body.mass / stiffness)
    # What the integrator has to say of its troubles, its status says.
    with np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
        found = solve_ivp(
            model.rates,
            (start_time, start_time + duration),
            np.array(in_world(support.motion(start_time), start)),
            method,
            dense_output=True,
            events=None if until_closed is None else gap,
            rtol=max(tolerance * unit, LEAST_TOLERANCE),
            atol=tolerance * np.array([unit] * 3 + [1.0] * 3),
            max_step=LONGEST_STEP * sqrt(sqrt(body.inertia / body.mass) / max(abs(support.gravity), 1.0)),
        )
    return CompliantMotion(
        complete=found.status >= 0, time=float(found.t[-1]), evaluations=int(found.nfev), body=model, way=found.sol
    )
