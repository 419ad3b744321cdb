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
from collections.abc import Callable
from math import acos, acosh, atan2, cos, exp, hypot, inf, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .impact import approach
from .impact.answer import mode_of
from .motion import PlanarState
from .motion.support import FixedSupport, MovingSupport, Support, SupportMotion, from_world, in_world
from .types import Contact, Mode, Twist, TwoPointBody, Vector

PLASTIC = 1e-3
"""The restitution that a contact without any gets: its damping is 15.7 times the critical one."""

LONGEST_STEP = 0.05
"""Of the integrator, in units of sqrt(rho / g): a step must not jump over a contact that closes and opens."""

LEAST_TOLERANCE = 1e-12
"""The least relative tolerance: a smaller one is rounding."""

STAYS = 0.01
"""A contact velocity after the impact below this part of the contact speeds before is zero for the mode: a contact with
the damping of `PLASTIC` rebounds by a thousandth, one of two that push each other by several."""

APPROACHES = 1e-6
"""A contact that closes by less than this part of the contact speeds does not strike again."""

QUIET = 1e-6
"""The impact is over when the contact forces have fallen below this part of V sqrt(k m), V the contact speeds."""

LONGEST = 1e4
"""The longest impact, in units of sqrt(m / k)."""


class Compliance(NamedTuple):
    """A contact's stiffness (N/m), damping (N s/m) and friction, and the slip (m/s) at which friction is 0.71 of its
    full.
    """

    stiffness: float
    damping: float
    friction: float
    regularisation: float


class ContactState(NamedTuple):
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
    """A body on compliant contacts; its state is (x, y, angle, vx, vy, omega) in the world's axes.

    `places` of the contacts from the mass centre in m, and their `supports`: one for all, or one for each.
    """

    mass: float
    inertia: float
    gravity: float
    places: tuple[Vector, ...]
    compliances: tuple[Compliance, ...]
    supports: tuple[Support, ...]

    def contacts(self, time: float, state: Any) -> list[ContactState]:
        """The contacts at a time in s."""
        x, y, angle, vx, vy, omega = state
        c, s = cos(angle), sin(angle)
        motions = [support.motion(time) for support in self.supports] * (len(self.places) // len(self.supports))
        found = []
        for (px, py), base in zip(self.places, motions, strict=True):
            nx, ny = -sin(base.angle), cos(base.angle)
            ax, ay = c * px - s * py, s * px + c * py
            dx, dy = x + ax - base.x, y + ay - base.y
            cx, cy = vx - omega * ay - base.vx + base.rate * dy, vy + omega * ax - base.vy - base.rate * dx
            found.append(
                ContactState(nx * dx + ny * dy, nx * cx + ny * cy, ny * cx - nx * cy, arm=(ax, ay), normal=(nx, ny))
            )
        return found

    def forces(self, time: float, state: Any) -> list[Vector]:
        """Normal and tangential force on each contact (N)."""
        pairs = zip(self.compliances, self.contacts(time, state), strict=True)
        return [force(compliance, one.gap, one.rate, one.slip) for compliance, one in pairs]

    def rates(self, time: float, state: NDArray[np.float64]) -> list[float]:
        """The right-hand side."""
        values = state.tolist()
        fx, fy, moment = 0.0, -self.mass * self.gravity, 0.0
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
        return from_world(self.body.supports[0].motion(time), PlanarState(*self.way(time).tolist()))

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
    model = _model(body, contacts, (support,), support.gravity, stiffness, regularisation)

    def gap(time: float, state: NDArray[np.float64]) -> float:
        return min(one.gap for one in model.contacts(time, state)[until_closed:])

    time_unit = sqrt(body.mass / stiffness)
    found = _integrated(
        model,
        np.array(in_world(support.motion(start_time), start)),
        (start_time, start_time + duration),
        method,
        (max(tolerance * time_unit, LEAST_TOLERANCE), tolerance * np.array([time_unit] * 3 + [1.0] * 3)),
        None if until_closed is None else gap,
        LONGEST_STEP * sqrt(sqrt(body.inertia / body.mass) / max(abs(support.gravity), 1.0)),
    )
    return CompliantMotion(found.status >= 0, float(found.t[-1]), int(found.nfev), model, found.sol)


def compliant_impact(
    body: TwoPointBody, twist: Twist, stiffness: float, *, regularisation: float = 1e-4, tolerance: float = 1e-8
) -> tuple[Mode, Twist] | None:
    """What the impact at the new contact does to a body whose contacts are compliant; None where it has no end.

    `body` and `twist` as for `solve_impact`, without gravity; both contacts have the `stiffness` in N/m and start just
    touching. Friction reaches 0.71 of its full at a slip of `regularisation` times the contact speeds before;
    `tolerance` is relative to these.
    """
    contacts = (*((body.old,) if body.old is not None else ()), body.new)
    before = [approach(contact, twist) for contact in contacts]
    if all(normal >= 0.0 for normal, _ in before):
        return Mode.NO_IMPACT, twist
    speed = sum(abs(normal) + abs(slip) for normal, slip in before)
    unit, rho = sqrt(body.mass / stiffness), sqrt(body.inertia / body.mass)
    supports = tuple(map(_surface, contacts))
    model = _model(body, contacts, supports, 0.0, stiffness, regularisation * speed)

    def remaining(time: float, state: NDArray[np.float64]) -> float:
        ax, ay, turning = model.rates(time, state)[3:]
        left = (abs(ax) + abs(ay) + rho * abs(turning)) * unit / speed - QUIET
        return max(left, *[-APPROACHES - one.rate / speed for one in model.contacts(time, state)])

    errors = tolerance * speed * np.array((unit, unit, unit / rho, 1.0, 1.0, 1.0 / rho))
    start = np.array((0.0, 0.0, 0.0, *twist))
    found = _integrated(model, start, (0.0, LONGEST * unit), "LSODA", (tolerance, errors), remaining)
    if found.status != 1:
        return None
    after = found.y_events[0][0]
    *old, new = [(one.rate, one.slip) for one in model.contacts(found.t[-1], after)]
    mode = mode_of(STAYS * speed, *(old[0] if old else (inf, 0.0)), *new)
    return Mode(mode), Twist(*after[3:].tolist())


def _surface(contact: Contact) -> MovingSupport:
    """The straight support under one contact, which touches it at time 0 with the body's angle 0."""
    (nx, ny), (ux, uy) = contact.normal, contact.velocity
    angle = atan2(-nx, ny)

    def motion(time: float) -> SupportMotion:
        x, y = contact.x + ux * time, contact.y + uy * time
        return SupportMotion(angle=angle, rate=0.0, acceleration=0.0, x=x, y=y, vx=ux, vy=uy, ax=0.0, ay=0.0)

    return MovingSupport(motion, period=1.0, gravity=0.0)


def _model(
    body: TwoPointBody,
    contacts: tuple[Contact, ...],
    supports: tuple[Support, ...],
    gravity: float,
    stiffness: float,
    regularisation: float,
) -> CompliantBody:
    """The body on contacts whose damping gives a body that strikes one alone, without friction, its restitution."""
    compliances = []
    for contact in contacts:
        nx, ny = contact.normal
        moment = (contact.x * ny - contact.y * nx) / hypot(nx, ny)
        mobility = 1.0 / body.mass + moment * moment / body.inertia
        damping = 2.0 * damping_ratio(contact.restitution) * sqrt(stiffness / mobility)
        compliances.append(Compliance(stiffness, damping, contact.friction, regularisation=regularisation))
    return CompliantBody(
        mass=body.mass,
        inertia=body.inertia,
        gravity=gravity,
        places=tuple((contact.x, contact.y) for contact in contacts),
        compliances=tuple(compliances),
        supports=supports,
    )


def _integrated(
    model: CompliantBody,
    start: NDArray[np.float64],
    span: tuple[float, float],
    method: str,
    tolerances: tuple[float, NDArray[np.float64]],
    remaining: Callable[[float, NDArray[np.float64]], float] | None = None,
    longest_step: float = inf,
) -> Any:
    """The solution of scipy's integrator over a span of time (s), or until `remaining` falls to zero."""
    if remaining is not None:
        remaining.terminal, remaining.direction = True, -1.0  # type: ignore[attr-defined]
    # What the integrator has to say of its troubles, its status says.
    with np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
        return solve_ivp(
            model.rates,
            span,
            start,
            method,
            dense_output=True,
            events=remaining,
            rtol=tolerances[0],
            atol=tolerances[1],
            max_step=longest_step,
        )
