"""One impact of a body that also slips across the impact plane: `solve_transverse_impact`.

The body is rigid and moves in space: in the plane with (vx, vy, omega), across it with the velocity vz of the mass
centre along z = x cross y, the roll rate about x and the yaw rate about y. Its contacts lie in the plane of the mass
centre, and x, y, z are principal axes (an edge that lies along z stands for its middle). Then a contact at (x, y) moves
across the plane with

    c_z = vz + roll y - yaw x,

an impulse Z at it changes vz by Z / m, roll by y Z / J_roll and yaw by -x Z / J_yaw, and neither acts on the motion in
the plane: the contact velocities answer Z_A, Z_B with the mobilities

    w_ij = 1 / m + y_i y_j / J_roll + x_i x_j / J_yaw.

An infinite inertia blocks a rotation. Two corners at each end of an edge along z block the roll, which would lift one
of them, while the tilting moment h Z stays below their normal impulses times half the edge; yaw remains, and the
friction that the corners of one edge add against it by slipping in opposite directions is left out. A body on single
points is free to roll.

What joins the plane and z is friction: it opposes the whole slip (c_t, c_z), so that a body that slides across the
plane has less friction left in it.
"""

from __future__ import annotations

from math import inf, isfinite, sqrt
from typing import NamedTuple

from .impact import MODES, NOWHERE, flags_of, solve_impact, states_of
from .impact.answer import OLD_RESTITUTION_IGNORED, PATH, VALIDITY, doubts, mode_of, unchanged
from .impact.body import SPEED_ROUNDING, problem_of, twist_after
from .impact.contacts import NO_SOLUTION
from .transverse_law import FAR, follow
from .types import Contact, Flag, Mode, Outcome, Twist, TwoPointBody, Validity

GAIN = 10.0
"""Energy may rise by this many times the tolerance, of mass times these speeds squared: more is no error of the
steps but roundings of a body far from any shape."""

NO_IMPULSE = ((0.0, 0.0), (0.0, 0.0))


class Transverse(NamedTuple):
    """Motion of a body across the impact plane, relative to its supports, and its inertia in it.

    `velocity` of the mass centre along z in m/s; `roll` and `yaw` rates about x and y in rad/s; the inertias about x
    and y in kg m^2, infinite where the contacts block the rotation, the rate of which is 0 then.
    """

    velocity: float
    roll: float = 0.0
    yaw: float = 0.0
    roll_inertia: float = inf
    yaw_inertia: float = inf


class TransverseOutcome(NamedTuple):
    """What an impact does to a body that also slips across the plane.

    `outcome` in the plane, where + and - in the segments are the signs of the slip's part in the plane, and
    `energy_lost` is that of the whole motion; `transverse` the motion across the plane after it; `impulses` along z at
    the old and the new contact in N s.
    """

    outcome: Outcome
    transverse: Transverse
    impulses: tuple[float, float]


def solve_transverse_impact(
    body: TwoPointBody,
    twist: Twist,
    transverse: Transverse,
    tolerance: float = 1e-4,
    validity: Validity = VALIDITY,
) -> TransverseOutcome:
    """What the impact at the new contact does to a body that also moves across the impact plane.

    As `solve_impact` by its path law, with friction against the whole slip. `tolerance`, part of the sum of the contact
    speeds in the plane and 1e-7 at the finest, bounds the error of a slip in each step along the impulse; slower slips
    end.

    Without slip across the plane the answer is that of `solve_impact`, to the last bit, and where both contacts are
    struck it answers for the plane alone. Where the path is lost it does so too, with Flag.LAST_RESORT. Input that no
    body can have gives Flag.INVALID_INPUT, never an exception. Where several contact states are consistent the first
    is followed and the others are not told.
    """
    mass, inertia, old, new = body
    valid, problem, frame = problem_of(mass, inertia, old is not None, old or NOWHERE, new, twist)
    contacts, (restitution_old, restitution), (cna, cta, cnb, ctb), _ = problem
    (_, _, qa, sa, fa), (nx, ny, qb, _, _, sb, _, fb), _, _, _ = contacts
    cos, sin = ny, -nx
    pair = cos, sin, qa, sa, qb, sb, fa, fb
    cza = slip_across(old, transverse) if old is not None else 0.0
    czb = slip_across(new, transverse)
    velocity, roll, yaw, roll_inertia, yaw_inertia = transverse
    if not (isfinite(velocity + roll + yaw + cza + czb) and roll_inertia > 0.0 and yaw_inertia > 0.0):
        return invalid(twist, transverse)
    if (cza == 0.0 and czb == 0.0) or not valid or cna < 0.0 or cnb >= 0.0:
        return TransverseOutcome(solve_impact(body, twist, "path", validity), transverse, (0.0, 0.0))

    speed = abs(cta) + abs(cnb) + abs(ctb)
    waa, wab, wbb = 1.0, 0.0, mass * mobility(new, new, mass, transverse)
    if old is None:
        cna = FAR * speed
    else:
        speed += cna
        waa, wab = mass * mobility(old, old, mass, transverse), mass * mobility(old, new, mass, transverse)
    (na, ta, za, nb, tb, zb, vna, vta, vza, vnb, vtb, vzb), segments, notes = follow(
        (pair, waa, wab, wbb), (cna, cta, cza, cnb, ctb, czb), tolerance * speed, restitution
    )
    dx, dy = ta + tb * cos - nb * sin, na + tb * sin + nb * cos
    after = twist_after(twist, frame, dx, dy, qa * na + sa * ta + qb * nb + sb * tb)
    foot = old or NOWHERE
    across_after = Transverse(
        velocity + za + zb,
        roll + mass * (foot.y * za + new.y * zb) / roll_inertia,
        yaw - mass * (foot.x * za + new.x * zb) / yaw_inertia,
        roll_inertia,
        yaw_inertia,
    )
    work = nb * (cnb + vnb) + tb * (ctb + vtb) + zb * (czb + vzb)
    if old is not None:
        work += na * (cna + vna) + ta * (cta + vta) + za * (cza + vza)
    lost = notes & NO_SOLUTION or work > GAIN * tolerance * speed * speed
    if lost or not isfinite(sum(after) + sum(across_after[:3]) + mass * work):
        outcome = solve_impact(body, twist, "path", validity)
        return TransverseOutcome(outcome._replace(flags=outcome.flags | Flag.LAST_RESORT), transverse, (0.0, 0.0))

    slips = sqrt(vta * vta + vza * vza), sqrt(vtb * vtb + vzb * vzb)
    notes |= doubts(contacts, old is not None, nb, validity)
    outcome = Outcome(
        mode=MODES[mode_of(tolerance * speed, vna, slips[0], vnb, slips[1])],
        twist=Twist(*after),
        impulses=((mass * na, mass * ta), (mass * nb, mass * tb)),
        segments=states_of(segments),
        flags=flags_of(notes | (OLD_RESTITUTION_IGNORED if restitution_old > 0.0 else 0)),
        energy_lost=-0.5 * mass * work,
        unique=True,
        alternatives=(),
        law="path",
    )
    return TransverseOutcome(outcome, across_after, (mass * za, mass * zb))


def slip_across(contact: Contact, transverse: Transverse) -> float:
    """Velocity of the body at a contact across the plane (m/s); rounding counts as zero."""
    velocity, roll, yaw, _, _ = transverse
    by_roll, by_yaw = roll * contact.y, yaw * contact.x
    slip = velocity + by_roll - by_yaw
    return slip if abs(slip) > SPEED_ROUNDING * (abs(velocity) + abs(by_roll) + abs(by_yaw)) else 0.0


def mobility(one: Contact, other: Contact, mass: float, transverse: Transverse) -> float:
    """How an impulse across the plane at one contact moves the other across it (1 / kg)."""
    return 1.0 / mass + one.y * other.y / transverse.roll_inertia + one.x * other.x / transverse.yaw_inertia


def invalid(twist: Twist, transverse: Transverse) -> TransverseOutcome:
    """The outcome for motion across the plane that no body can have; what is no number becomes rest."""
    outcome = Outcome(
        Mode.NO_IMPACT, Twist(*unchanged(twist, 0, PATH)[1]), NO_IMPULSE, (), Flag.INVALID_INPUT, 0.0, True, (), "path"
    )
    velocity, roll, yaw = (rate if isfinite(rate) else 0.0 for rate in transverse[:3])
    return TransverseOutcome(outcome, transverse._replace(velocity=velocity, roll=roll, yaw=yaw), (0.0, 0.0))
