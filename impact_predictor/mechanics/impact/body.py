"""Between a planar body with its contacts and the problem that the impact laws see. Law code (see `contacts`)."""

from __future__ import annotations

from math import inf, sqrt

from ..types import Contact, Twist
from .contacts import Problem, at_one_place, planar_contacts

SPEED_ROUNDING = 1e-14
"""A contact speed below this part of the terms it is the sum of is rounding and counts as zero."""

UNIT = 1e-6
"""How far the square of a normal's length may be from 1."""

ContactVelocity = tuple[float, float, float]
"""Normal and tangential contact velocity, and the speed below which either is rounding."""

ImpactFrame = tuple[float, float, float]
"""Normal (x, y) of the old contact and the radius of gyration, in which a law gives the change of twist."""

ContactView = tuple[bool, float, float, float, float, float, float, float]
"""Whether every number of a contact is in its range; its approach (three numbers); its normal; moments of its normal
and its tangent about the mass centre."""


NOT_VALID: ContactView = (False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def see(contact: Contact, twist: Twist) -> ContactView:
    """A contact of a body that moves with `twist`."""
    x, y, friction, (nx, ny), restitution, (ux, uy) = contact
    vx, vy, omega = twist
    excess = nx * nx + ny * ny - 1.0
    if excess != 0.0:
        if not -UNIT < excess < UNIT:
            return NOT_VALID
        scale = 1.0 - (0.5 - 0.375 * excess) * excess  # 1 / sqrt(1 + excess), to rounding
        nx, ny = scale * nx, scale * ny
    px, py = omega * y, omega * x
    cx, cy = vx - px - ux, vy + py - uy
    normal = nx * cx + ny * cy
    tangential = ny * cx - nx * cy
    zero = SPEED_ROUNDING * (abs(vx) + abs(vy) + abs(px) + abs(py) + abs(ux) + abs(uy))
    if -zero <= normal <= zero:
        normal = 0.0
    if -zero <= tangential <= zero:
        tangential = 0.0
    # Any number that is not finite makes `zero` so too.
    valid = zero < inf and 0.0 <= friction < inf and 0.0 <= restitution <= 1.0
    return valid, normal, tangential, zero, nx, ny, x * ny - y * nx, -(x * nx + y * ny)


def approach(contact: Contact, twist: Twist) -> ContactVelocity:
    """Velocity of the body at the contact, relative to the support, along the normal and the tangent (m/s)."""
    return see(contact, twist)[1:4]


def problem_of(
    mass: float, inertia: float, stands: bool, old: Contact, new: Contact, twist: Twist
) -> tuple[bool, Problem, ImpactFrame]:
    """What an impact law is asked about a body that moves with `twist`, after whether its numbers are in their range.

    A body that does not stand on `old` gets a frictionless contact at its mass centre, which never closes.
    """
    valid, cnb, ctb, zero_b, bx, by, nb, tb = see(new, twist)
    x, y, fb, _, eb, _ = new
    together = False
    if stands:
        valid_a, cna, cta, zero_a, ax, ay, na, ta = see(old, twist)
        valid = valid and valid_a
        x_old, y_old, fa, _, ea, _ = old
        together = x_old == x and y_old == y
    else:
        cna, cta, zero_a, ax, ay, na, ta, fa, ea = inf, 0.0, 0.0, bx, by, 0.0, 0.0, 0.0, 0.0
    square = inertia / mass if mass > 0.0 else 0.0
    if not (valid and 0.0 < square < inf):
        return False, NO_PROBLEM, (0.0, 1.0, 1.0)
    rho = sqrt(square)
    unit = 1.0 / rho
    contacts = planar_contacts(ax * bx + ay * by, ax * by - ay * bx, na * unit, ta * unit, nb * unit, tb * unit, fa, fb)
    if together:
        contacts = at_one_place(contacts)
    return True, (contacts, (ea, eb), (cna, cta, cnb, ctb), (zero_a, zero_a, zero_b, zero_b)), (ax, ay, rho)


NO_PROBLEM: Problem = (
    planar_contacts(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 0.0),
    (inf, 0.0, 0.0, 0.0),
    (0.0, 0.0, 0.0, 0.0),
)


def twist_after(twist: Twist, frame: ImpactFrame, dx: float, dy: float, dq: float) -> tuple[float, float, float]:
    """The twist changed by (dx, dy, dq), along the frame's tangent and normal and times rho."""
    nx, ny, rho = frame
    vx, vy, omega = twist
    return vx + ny * dx + nx * dy, vy + ny * dy - nx * dx, omega + dq / rho
