"""Contact space of two contacts: what impulses at the old contact A and the new one B do to their velocities.

The contact velocities c = (c_nA, c_tA, c_nB, c_tB) change by W P with the impulses P in the same order, and
W = G M^-1 G^T is of rank 4 at most. The laws know W by the rows of a G for which M is 1:

    nA = (0, an, qa), tA = (at, 0, sa), nB = (nx, ny, nq), tB = (tx, ty, tq),  and W_nBnB is greater by `extra`.

So every W can be written. Of a planar body of unit mass the rows are its own, in the frame of A with (x, y, rho omega)
as twist: an = at = 1, nB = (-sin, cos, qb), tB = (cos, sin, sb) with the angle between the normals and the moments of
normals and tangents about the mass centre, and `extra` is 0. An impulse along a row changes the twist by that row.
Minors of W are products of cross products of the rows (Binet and Cauchy); written so, they keep the digits that W loses
of slender and squat bodies. Of a W that is given the rows follow by elimination, and what is rounding counts as zero.

Law code, here and in the modules of the laws, uses + - * / sqrt abs and comparisons only, on numbers and tuples of
fixed size: it means the same number on every machine, and a compiler can take it as it is. They are unpacked by names,
whether or not each is used, because machine code makes an object of what goes to `_`.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Final

from ..types import Contact, Flag, Twist

OPEN: Final = 0
STICK: Final = 1
PLUS: Final = 2
MINUS: Final = 3
"""States of a contact, in the order in which a law prefers them; PLUS and MINUS slip along +t and -t."""

ROUNDING: Final = 1e-14
"""A condition violated by less than this part of its terms holds: it is a border met up to rounding."""

CANCELLED: Final = 1e-12
"""The same where the rows come from a W; a sum below this part of its terms is then the rounding of W."""

OldRows = tuple[float, float, float, float, float]
"""an, at, qa, sa and the friction of A."""

NewRows = tuple[float, float, float, float, float, float, float, float]
"""nx, ny, nq, tx, ty, tq, `extra` and the friction of B."""

Plane = tuple[float, float, float, float]
"""nx^2 + ny^2, nx tx + ny ty and tx^2 + ty^2, which are 1, 0 and 1 of a planar body; |nB x tB|^2."""

Minors = tuple[float, float, float, float]
"""Volumes of three rows: (nA x tA) nB and (nA x tA) tB, the lever and the arm of B about A; (nB x tB) nA and
(nB x tB) tA, those of A about B. The impulses that move nothing are in proportion to them."""

ContactRows = tuple[OldRows, NewRows, Plane, Minors, float]
"""What the laws know of two contacts; the last is ROUNDING, or CANCELLED where the rows come from a W."""

Velocities = tuple[float, float, float, float]
"""Of the contacts: c_nA, c_tA, c_nB and c_tB."""

Problem = tuple[ContactRows, tuple[float, float], Velocities, Velocities]
"""What a law is asked: contacts; restitutions at A and B; the velocities before the impact, c_nA being inf where there
is no A; and the speeds below which each of them is rounding and counts as zero."""

Impact = tuple[float, float, float, float, float, float, float, float, float, float, float, int, int, int]
"""What a law answers, for a body of unit mass: N_A, T_A, N_B, T_B; c_nA, c_tA, c_nB, c_tB after the impact; change of
the twist (x, y, rho omega); the contact states along it (a hexadecimal digit 4 a + b each, the last one lowest);
notes; and how many answers the law allows."""

Push = tuple[bool, float, float, float, float]
"""Whether the cones of friction allow a push; N_A, T_A, N_B, T_B with it."""

REVERSED: Final = int(Flag.REVERSED_SLIP)
JAMMED: Final = int(Flag.JAMMED)
WORK_LIMITED: Final = int(Flag.WORK_LIMITED)
SHARED_FRICTION: Final = int(Flag.SHARED_FRICTION)
NO_SOLUTION: Final = int(Flag.NO_SOLUTION)
"""Notes on an answer, the bits of `Flag`."""


SPEED_ROUNDING: Final = 1e-14
"""A contact speed below this part of the terms it is the sum of is rounding and counts as zero."""

UNIT: Final = 1e-6
"""How far the square of a normal's length may be from 1."""

ImpactFrame = tuple[float, float, float]
"""Normal (x, y) of the old contact and the radius of gyration, in which a law gives the change of twist."""

ContactView = tuple[bool, float, float, float, float, float, float, float]
"""Whether every number of a contact is in its range; its normal and tangential velocity, and the speed below which
either is rounding; its normal; moments of its normal and its tangent about the mass centre."""

NOT_VALID: ContactView = (False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def planar_contacts(
    cos: float, sin: float, qa: float, sa: float, qb: float, sb: float, fa: float, fb: float
) -> ContactRows:
    """The contacts of a planar body of unit mass."""
    return (
        (1.0, 1.0, qa, sa, fa),
        (-sin, cos, qb, cos, sin, sb, 0.0, fb),
        (1.0, 0.0, 1.0, 1.0 + qb * qb + sb * sb),
        (qa * cos - sa * sin - qb, sa * cos + qa * sin - sb, cos * qb + sin * sb - qa, cos * sb - sin * qb - sa),
        ROUNDING,
    )


def below_rounding(value: float, rounding: float, u: float, v: float = 0.0, w: float = 0.0, x: float = 0.0) -> bool:
    """Whether a negative sum of the terms u, v, w, x is more than rounding."""
    return value < -rounding * (abs(u) + abs(v) + abs(w) + abs(x))


def push_interval(n: float, t: float, zn: float, zt: float, f: float) -> tuple[float, float]:
    """The lowest and the highest push p for which |t + p zt| <= f (n + p zn) and n + p zn >= 0 (inf, -inf if none)."""
    low, high = -inf, inf
    fn, fz = f * n, f * zn
    slope, room = zt - fz, fn - t
    if slope > 0.0:
        high = room / slope
    elif slope < 0.0:
        low = room / slope
    elif below_rounding(room, ROUNDING, fn, t):
        return inf, -inf
    slope, room = -zt - fz, fn + t
    if slope > 0.0:
        if slope * high > room:
            high = room / slope
    elif slope < 0.0:
        if slope * low > room:
            low = room / slope
    elif below_rounding(room, ROUNDING, fn, t):
        return inf, -inf
    if f == 0.0:  # else n + p zn >= 0 follows from the two above
        if zn > 0.0:
            low = max(low, -n / zn)
        elif zn < 0.0:
            high = min(high, -n / zn)
        elif below_rounding(n, ROUNDING, t):
            return inf, -inf
    return low, high


def least_push(contacts: ContactRows, na: float, ta: float, nb: float, tb: float) -> Push:
    """Share the impulses of two sticking contacts with the least push along their line that both cones allow.

    The push is the only freedom; it is measured from the impulses without any component along it.
    """
    (an, at, qa, sa, fa), (nx, ny, nq, tx, ty, tq, extra, fb), plane, (lever, arm, old_lever, old_arm), rounding = (
        contacts
    )
    zna, zta, znb, ztb = -old_arm, old_lever, -arm, lever
    low, high = push_interval(na, ta, zna, zta, fa)
    if low < inf:
        low_b, high_b = push_interval(nb, tb, znb, ztb, fb)
        if low_b > low:
            low = low_b
        if high_b < high:
            high = high_b
    square = zna * zna + zta * zta + znb * znb + ztb * ztb
    if square == 0.0 or (low > high and below_rounding((high - low) * sqrt(square), rounding, na, ta, nb, tb)):
        return False, na, ta, nb, tb
    push = -(na * zna + ta * zta + nb * znb + tb * ztb) / square
    if push < low:
        push = low
    elif push > high:
        push = high
    return True, na + push * zna, ta + push * zta, nb + push * znb, tb + push * ztb


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


def approach(contact: Contact, twist: Twist) -> tuple[float, float]:
    """Velocity of the body at the contact, relative to the support, along the normal and the tangent (m/s)."""
    valid, normal, tangential, zero, nx, ny, nq, tq = see(contact, twist)
    return normal, tangential


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
    if not unit * (abs(na) + abs(ta) + abs(nb) + abs(tb)) < FARTHEST:
        return False, NO_PROBLEM, (0.0, 1.0, 1.0)
    contacts = planar_contacts(ax * bx + ay * by, ax * by - ay * bx, na * unit, ta * unit, nb * unit, tb * unit, fa, fb)
    if together:  # neither has a lever about the other, not even one of rounding
        rows_old, rows_new, plane, minors, rounding = contacts
        contacts = rows_old, rows_new, plane, (0.0, 0.0, 0.0, 0.0), rounding
    return True, (contacts, (ea, eb), (cna, cta, cnb, ctb), (zero_a, zero_a, zero_b, zero_b)), (ax, ay, rho)


FARTHEST: Final = 1e100
"""Radii of gyration beyond which no body has contacts: products of such levers overflow."""

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
