"""One impact on compliant contacts in units of its own, up to the limit of stiff ones, for benchmarks/compliant.py.

Time counts in sqrt(m / k), speeds in V, lengths in V sqrt(m / k): m is the mass, k the stiffness of the new contact and
V the sum of the contact speeds before the impact; the mass is 1 in the equations and angles are measured by rho times
the angle, rho the radius of gyration. What is left of the stiffness then is a single small number,

    depth = V sqrt(m / k) / rho,

how far the body turns and the contacts move during the impact, and the weight g sqrt(m / k) / V. Both vanish as
k**-0.5. All else does not depend on k: the ratio of the two stiffnesses, the damping ratios, the friction, the
regularisation and the shape. With depth and weight zero these are the equations of the limit itself.

The forces are those of `impact_predictor.mechanics.compliant`. An impact is over when no contact approaches any more
and the forces have fallen to nothing; with gravity to twice the weight, and no loaded contact moves.
"""

from __future__ import annotations

import warnings
from math import cos, hypot, inf, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from compliant_motion import Compliance, damping_ratio, force
from numpy.typing import NDArray
from scipy import integrate

from impact_predictor.mechanics.impact import approach, see
from impact_predictor.mechanics.impact.answer import mode_of
from impact_predictor.mechanics.types import Contact, Mode, Twist, TwoPointBody, Vector

STAYS = 0.01
"""A contact velocity after the impact below this part of the contact speeds before is zero for the mode: a contact with
the damping of `PLASTIC` rebounds by a thousandth, one of two that push each other by several."""

APPROACHES = 1e-6
"""A contact that closes by less than this part of the contact speeds does not strike again."""

QUIET = 1e-6
"""The impact is over when the contact forces have fallen below this part of V sqrt(k m), V the contact speeds."""

LONGEST = 1e4
"""The longest impact, in units of sqrt(m / k)."""

METHODS = ("Radau", "BDF", "LSODA", "DOP853", "RK45")
"""The integrators of scipy: three for stiff equations, two explicit ones for comparison."""


class ContactPoint(NamedTuple):
    """A contact: its place from the mass centre over rho, the support's normal and velocity, its force, and its gap at
    the touchdown.
    """

    place: Vector
    normal: Vector
    velocity: Vector
    compliance: Compliance
    gap: float = 0.0


class Equations(NamedTuple):
    """A body on its contacts. The state is (x, y, q, vx, vy, vq) and then the normal and tangential impulse of each
    contact; x, y, q count from the moment of the touchdown.
    """

    points: tuple[ContactPoint, ...]
    depth: float
    weight: Vector

    def contacts(self, time: float, state: Any) -> list[tuple[float, float, float, float, float]]:
        """Gap, its rate, slip and the moments of normal and tangent of each contact."""
        x, y, q, vx, vy, vq = state[:6]
        depth = self.depth
        c, s = cos(depth * q), sin(depth * q)
        # (sin a) / depth and (1 - cos a) / depth, which have a limit.
        if depth > 0.0:
            half = sin(0.5 * depth * q)
            across, along = s / depth, 2.0 * half * half / depth
        else:
            across, along = q, 0.0
        found = []
        for (px, py), (nx, ny), (ux, uy), _, gap in self.points:
            ax, ay = c * px - s * py, s * px + c * py
            dx, dy = x - across * py - along * px - ux * time, y + across * px - along * py - uy * time
            cx, cy = vx - vq * ay - ux, vy + vq * ax - uy
            found.append(
                (gap + nx * dx + ny * dy, nx * cx + ny * cy, ny * cx - nx * cy, ax * ny - ay * nx, -(ax * nx + ay * ny))
            )
        return found

    def rates(self, time: float, state: Any) -> list[float]:
        """The right-hand side."""
        values = state.tolist()
        fx, fy = self.weight
        fq = 0.0
        impulses = []
        contacts = self.contacts(time, values)
        for (_, (nx, ny), _, compliance, _), (gap, rate, slip, mn, mt) in zip(self.points, contacts, strict=True):
            normal, tangential = force(compliance, gap, rate, slip)
            impulses += [normal, tangential]
            fx += normal * nx + tangential * ny
            fy += normal * ny - tangential * nx
            fq += normal * mn + tangential * mt
        return [values[3], values[4], values[5], fx, fy, fq, *impulses]


def loaded(equations: Equations, state: Any) -> Equations:
    """With the first contact as deep as its load asks for: it neither lifts nor sinks before the impact.

    It sticks if its friction can hold it, else it slips.
    """
    first, *others = equations.points
    (px, py), (nx, ny), _, compliance, _ = first
    _, _, slip, mn, mt = equations.contacts(0.0, state)[0]
    vq, (gx, gy) = state[5], equations.weight
    # Acceleration of the contact without its force.
    ax, ay = gx - equations.depth * vq * vq * px, gy - equations.depth * vq * vq * py
    an, at = nx * ax + ny * ay, ny * ax - nx * ay
    wnn, wnt, wtt = 1.0 + mn * mn, mn * mt, 1.0 + mt * mt
    determinant = wnn * wtt - wnt * wnt
    normal, tangential = (wnt * at - wtt * an) / determinant, (wnt * an - wnn * at) / determinant
    friction = compliance.friction
    if abs(slip) > compliance.regularisation or abs(tangential) > friction * normal:
        share = -friction if (slip > 0.0 if slip != 0.0 else tangential < 0.0) else friction
        normal = -an / (wnn + share * wnt)
    return equations._replace(points=(first._replace(gap=-max(normal, 0.0) / compliance.stiffness), *others))


class CompliantOutcome(NamedTuple):
    """What an impact on compliant contacts does to a body.

    `twist` after it; `velocities` c_nA, c_tA, c_nB, c_tB after it in m/s (c_nA is inf without an old contact);
    `impulses` as ((N_old, T_old), (N_new, T_new)) in N s; `energy_lost` in J, relative to the supports, what is left
    in the springs included; `duration` in s (0 in the limit); `evaluations` of the right-hand side; whether it is
    `over`.
    """

    mode: Mode
    twist: Twist
    velocities: tuple[float, float, float, float]
    impulses: tuple[Vector, Vector]
    energy_lost: float
    duration: float
    evaluations: int
    over: bool


def compliant_impact(
    body: TwoPointBody,
    twist: Twist,
    stiffness: float,
    *,
    ratio: float = 1.0,
    damping: tuple[float, float] | None = None,
    regularisation: float = 1e-4,
    gravity: Vector = (0.0, 0.0),
    method: str = "LSODA",
    tolerance: float = 1e-8,
    start_loaded: bool = True,
) -> CompliantOutcome:
    """What the impact at the new contact does to a body whose contacts are compliant.

    `body` and `twist` as for `solve_impact`. `stiffness` in N/m is that of the new contact; inf is the limit of stiff
    contacts, in which neither gravity nor the body's motion during the impact counts. `ratio` is the old contact's
    stiffness over the new one's. `damping` are the damping ratios of the old and the new contact (1 is critical for a
    body that strikes this contact alone, without friction); left out they follow from the restitution of each contact,
    and none at all stands for `PLASTIC`. Friction reaches 0.71 of its full at a slip of `regularisation` times the
    contact speeds before. With `gravity` (m/s^2) the body starts with its load on the old contact, or just touching.
    `tolerance` is the integrator's, relative to the contact speeds.
    """
    old, new = body.old, body.new
    contacts = (new,) if old is None else (old, new)
    if damping is None:
        damping = damping_ratio(old.restitution if old else 0.0), damping_ratio(new.restitution)
    before = velocities(body, twist)
    speed = sum(abs(one) for one in before if one != inf)
    # The units of the equations are V, this time (0 in the limit) and the radius of gyration.
    unit, rho = sqrt(body.mass / stiffness), sqrt(body.inertia / body.mass)

    def point(contact: Contact, hardness: float, damping: float) -> ContactPoint:
        """A contact in these units; `hardness` is its stiffness over that of the new contact."""
        _, _, _, _, nx, ny, moment, _ = see(contact, twist)
        mobility = 1.0 + (moment / rho) * (moment / rho)
        compliance = Compliance(hardness, 2.0 * damping * sqrt(hardness / mobility), contact.friction, regularisation)
        ux, uy = contact.velocity
        return ContactPoint((contact.x / rho, contact.y / rho), (nx, ny), (ux / speed, uy / speed), compliance)

    points = tuple(map(point, contacts, (ratio, 1.0)[-len(contacts) :], damping[-len(contacts) :]))
    weight = gravity[0] * unit / speed, gravity[1] * unit / speed
    start = np.zeros(6 + 2 * len(points))
    start[3:6] = twist.vx / speed, twist.vy / speed, twist.omega * rho / speed
    equations = Equations(points, speed * unit / rho, weight)
    if old is not None and weight != (0.0, 0.0) and start_loaded:
        equations = loaded(equations, start)

    quiet = QUIET + 2.0 * hypot(*weight)
    moves = STAYS if weight != (0.0, 0.0) else inf

    def remaining(time: float, state: NDArray[np.float64]) -> float:
        *_, ax, ay, aq = equations.rates(time, state)[:6]
        left = abs(ax - weight[0]) + abs(ay - weight[1]) + abs(aq) - quiet
        for point, (gap, rate, slip, _, _) in zip(equations.points, equations.contacts(time, state), strict=True):
            left = max(left, -APPROACHES - rate)
            if rate > moves and force(point.compliance, gap, rate, slip)[0] > 0.0:
                left = max(left, rate - moves)
        return left

    end = LONGEST / sqrt(min(ratio, 1.0))
    with np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
        solver = getattr(integrate, method)(equations.rates, 0.0, start, end, rtol=tolerance, atol=tolerance)
        while solver.status == "running" and remaining(solver.t, solver.y) > 0.0:
            solver.step()
        time, state = solver.t, solver.y
        over = remaining(time, state) <= 0.0
        if over and solver.t_old is not None:
            # Halved, because what remains jumps: a contact that has left counts no more.
            way, before_end = solver.dense_output(), solver.t_old
            while time - before_end > 1e-12 * time:
                middle = 0.5 * (before_end + time)
                before_end, time = (middle, time) if remaining(middle, way(middle)) > 0.0 else (before_end, middle)
            state = way(time)
    x, y, q = (speed * float(value) for value in state[3:6])
    after = Twist(x, y, q / rho)
    left = velocities(body, after)
    impulses = [body.mass * speed * float(value) for value in state[6:]]
    na, ta, nb, tb = impulses if old is not None else (0.0, 0.0, *impulses)
    pairs = zip((na, ta, nb, tb), before, left, strict=True)
    return CompliantOutcome(
        mode=Mode(mode_of(STAYS * speed, *left)),
        twist=after,
        velocities=left,
        impulses=((na, ta), (nb, tb)),
        energy_lost=-0.5 * sum(impulse * (one + other) for impulse, one, other in pairs if impulse != 0.0),
        duration=float(time) * unit,
        evaluations=int(solver.nfev),
        over=over,
    )


def velocities(body: TwoPointBody, twist: Twist) -> tuple[float, float, float, float]:
    """c_nA, c_tA, c_nB, c_tB; c_nA is inf without an old contact."""
    return *((inf, 0.0) if body.old is None else approach(body.old, twist)), *approach(body.new, twist)
