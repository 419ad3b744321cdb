"""One impact on compliant contacts, integrated in time: `compliant_impact`, a reference for the rigid laws.

Both contacts are springs with dampers and friction (`force`); the new one starts just touching and so does
the old one, or with the load that it carries under gravity. The stiff equations (`equations`) are integrated
until the impact is over: no contact approaches any more and the forces have fallen to nothing; with gravity to twice
the weight, and no loaded contact moves. Needs scipy.
"""

from __future__ import annotations

from math import hypot, inf, isfinite, sqrt
from typing import NamedTuple

import numpy as np

from ..answer import mode_of, speed_of
from ..impact import NOWHERE
from ..problem import problem_of, see
from ..types import Contact, Mode, Twist, TwoPointBody, Vector
from .equations import Array, Equations, Point, loaded
from .force import Compliance, damping_ratio, force
from .integrator import METHODS, Run, Status, run

STAYS = 0.01
"""A contact velocity after the impact below this part of the contact speeds before is zero for the mode: a contact with
the damping of `PLASTIC` rebounds by a thousandth, one of two that push each other by several."""

APPROACHES = 1e-6
"""A contact that closes by less than this part of the contact speeds does not strike again."""

QUIET = 1e-6
"""The impact is over when the contact forces have fallen below this part of V sqrt(k m), V the contact speeds."""

LONGEST = 1e4
"""The longest impact, in units of sqrt(m / k) of the softer contact."""

SAMPLES = 8
"""Of a trajectory, from each step of the integrator."""


class Trajectory(NamedTuple):
    """An impact in time: `time` (n,) in s; `twist` (n, 3) as `Twist`; `gap` (n, contacts) in m, negative in depth;
    `force` (n, contacts, 2) in N along normal and tangent. Contacts are the old and the new one, or the new one alone.

    Of a limit (infinite stiffness) time is in units of sqrt(m / k), the gap of V sqrt(m / k), the force of V sqrt(k m),
    with V the sum of the contact speeds before the impact.
    """

    time: Array
    twist: Array
    gap: Array
    force: Array


class CompliantOutcome(NamedTuple):
    """What an impact on compliant contacts does to a body.

    `twist` after it; `velocities` c_nA, c_tA, c_nB, c_tB after it in m/s (c_nA is inf without an old contact);
    `impulses` as ((N_old, T_old), (N_new, T_new)) in N s; `energy_lost` in J, relative to the supports, what is left
    in the springs included; `duration` in s (0 in the limit); `evaluations` of the right-hand side.
    """

    mode: Mode
    twist: Twist
    velocities: tuple[float, float, float, float]
    impulses: tuple[Vector, Vector]
    energy_lost: float
    duration: float
    evaluations: int
    status: Status
    trajectory: Trajectory | None = None


class _Units(NamedTuple):
    """The units of the equations: speed in m/s, time in s (0 in the limit), and the radius of gyration in m."""

    speed: float
    time: float
    rho: float


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
    evaluations: int = 100_000,
    trajectory: bool = False,
) -> CompliantOutcome:
    """What the impact at the new contact does to a body whose contacts are compliant.

    `body` and `twist` as for `solve_impact`. `stiffness` in N/m is that of the new contact; inf is the limit of stiff
    contacts, in which neither gravity nor the body's motion during the impact counts. `ratio` is the old contact's
    stiffness over the new one's. `damping` are the damping ratios of the old and the new contact (1 is critical for a
    body that strikes this contact alone, without friction); left out they follow from the restitution of each contact,
    and none at all stands for `PLASTIC`. Friction reaches 0.71 of its full at a slip of `regularisation` times the
    contact speeds before. With `gravity` (m/s^2) the body starts with its load on the old contact. `tolerance` is the
    integrator's, relative to the contact speeds; `evaluations` of the right-hand side are allowed.

    Never raises for a number and never returns NaN: see `Status`. ValueError: an unknown method.
    """
    if method not in METHODS:
        raise ValueError(f"method is {method!r}; use one of {', '.join(METHODS)}")
    mass, inertia, old, new = body
    contacts = (new,) if old is None else (old, new)
    valid, problem, (_, _, rho) = problem_of(mass, inertia, old is not None, old or NOWHERE, new, twist)
    if damping is None:
        damping = damping_ratio(old.restitution if old else 0.0), damping_ratio(new.restitution)
    numbers = ratio, regularisation, tolerance
    if not (
        valid
        and stiffness > 0.0
        and all(0.0 < number < inf for number in numbers)
        and all(0.0 <= number < inf for number in damping)
        and all(map(isfinite, gravity))
    ):
        return _unchanged(body, twist, valid, Status.INVALID_INPUT)
    if problem[3] >= 0.0 and problem[5] >= 0.0:
        return _unchanged(body, twist, valid, Status.NO_IMPACT)

    units = _Units(speed_of(problem), sqrt(mass / stiffness), rho)
    parts = tuple(zip(contacts, (ratio, 1.0)[-len(contacts) :], damping[-len(contacts) :], strict=True))
    points = tuple(_point(contact, twist, units, regularisation, *part) for contact, *part in parts)
    weight = gravity[0] * units.time / units.speed, gravity[1] * units.time / units.speed
    start = np.zeros(6 + 2 * len(points))
    start[3:6] = twist.vx / units.speed, twist.vy / units.speed, twist.omega * rho / units.speed
    equations = Equations(points, units.speed * units.time / rho, weight)
    if old is not None and weight != (0.0, 0.0):
        equations = loaded(equations, start)

    quiet = QUIET + 2.0 * hypot(*weight)
    moves = STAYS if weight != (0.0, 0.0) else inf

    def remaining(time: float, state: Array) -> float:
        *_, ax, ay, aq = equations.rates(time, state)[:6]
        left = abs(ax - weight[0]) + abs(ay - weight[1]) + abs(aq) - quiet
        for point, (gap, rate, slip, _, _) in zip(equations.points, equations.contacts(time, state), strict=True):
            left = max(left, -APPROACHES - rate)
            if rate > moves and force(point.compliance, gap, rate, slip)[0] > 0.0:
                left = max(left, rate - moves)
        return left

    longest = LONGEST / sqrt(min(ratio, 1.0))
    way = run(
        equations.rates,
        equations.jacobian,
        start,
        longest,
        method,
        (tolerance, tolerance),
        evaluations,
        remaining,
        trajectory,
    )
    return _outcome(body, twist, units, equations, way)


def _point(
    contact: Contact, twist: Twist, units: _Units, regularisation: float, hardness: float, ratio: float
) -> Point:
    """A contact in the units of the equations; `hardness` is its stiffness over that of the new contact."""
    _, _, _, _, nx, ny, moment, _ = see(contact, twist)
    speed, _, rho = units
    mobility = 1.0 + (moment / rho) * (moment / rho)
    compliance = Compliance(hardness, 2.0 * ratio * sqrt(hardness / mobility), contact.friction, regularisation)
    ux, uy = contact.velocity
    return Point((contact.x / rho, contact.y / rho), (nx, ny), (ux / speed, uy / speed), compliance)


def _unchanged(body: TwoPointBody, twist: Twist, valid: bool, status: Status) -> CompliantOutcome:
    """The answer where nothing happens, or to numbers that no body can have."""
    kept = twist if all(map(isfinite, twist)) else Twist(0.0, 0.0, 0.0)
    velocities = _velocities(body, kept) if valid else (inf, 0.0, 0.0, 0.0)
    return CompliantOutcome(Mode.NO_IMPACT, kept, velocities, ((0.0, 0.0), (0.0, 0.0)), 0.0, 0.0, 0, status)


def _velocities(body: TwoPointBody, twist: Twist) -> tuple[float, float, float, float]:
    """c_nA, c_tA, c_nB, c_tB."""
    _, cna, cta, *_ = see(body.old, twist) if body.old is not None else (True, inf, 0.0)
    _, cnb, ctb, *_ = see(body.new, twist)
    return cna, cta, cnb, ctb


def _outcome(body: TwoPointBody, twist: Twist, units: _Units, equations: Equations, way: Run) -> CompliantOutcome:
    """The end of an integration in SI units."""
    speed, time, rho = units
    x, y, q = (speed * float(value) for value in way.state[3:6])
    after = Twist(x, y, q / rho)
    before, velocities = _velocities(body, twist), _velocities(body, after)
    impulses = [body.mass * speed * float(value) for value in way.state[6:]]
    if body.old is None:
        impulses = [0.0, 0.0, *impulses]
    work = sum(
        impulse * (one + other)
        for impulse, one, other in zip(impulses, before, velocities, strict=True)
        if impulse != 0.0
    )
    na, ta, nb, tb = impulses
    return CompliantOutcome(
        Mode(mode_of(STAYS * speed, *velocities)),
        after,
        velocities,
        ((na, ta), (nb, tb)),
        -0.5 * work,
        way.time * time,
        way.evaluations,
        way.status,
        _trajectory(body.mass, units, equations, way) if way.steps else None,
    )


def _trajectory(mass: float, units: _Units, equations: Equations, way: Run) -> Trajectory:
    """What an integration kept of its way."""
    speed, unit, rho = units
    times = [0.0]
    states = [way.steps[0](0.0)]
    for begin, end, step in zip(way.times, way.times[1:], way.steps, strict=False):
        for part in range(1, SAMPLES + 1):
            times.append(begin + (end - begin) * part / SAMPLES)
            states.append(step(times[-1]))
    contacts = np.array([equations.contacts(*now) for now in zip(times, states, strict=True)])
    forces = np.array(
        [
            [force(point.compliance, *contact[:3]) for point, contact in zip(equations.points, now, strict=True)]
            for now in contacts
        ]
    )
    unit = unit or 1.0
    twists = np.array(states)[:, 3:6] * speed
    twists[:, 2] /= rho
    depth, push = (speed * unit, mass * speed / unit) if equations.depth > 0.0 else (1.0, 1.0)
    return Trajectory(np.array(times) * unit, twists, contacts[:, :, 0] * depth, forces * push)
