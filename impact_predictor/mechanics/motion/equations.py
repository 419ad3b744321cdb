"""The two bodies that rock, their poses, gaps and equations of motion while contacts are closed.

A body stands on two points fixed in it, over a straight support, or it is a disc over two edges fixed in the support.
While contact i is closed a pose is (u, z): u the angle in rad about it from the pose with both contacts closed, and z
how far in m the contact has slipped. The mass centre is at Rot(u) d_i from contact i. The points slip along the
support, z being the place of contact 0 when both are closed; the disc slips by spinning, its angle being u + z / R. The
slip velocity along the contact's tangent is s = dz/dt. Contact 0 is closed for u >= 0, contact 1 for u <= 0, both for
u = 0: what is left free then is z.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any, Final

from ...errors import InputError
from ..bodies import sine_and_cosine
from ..impact.contacts import PLUS, STICK
from ..types import Contact, TwoPointBody, Vector
from .felt import FrameAcceleration
from .support import PlanarState

_UNIT: Final = 1e-9
"""How far contacts may be from what a body that rocks has, relative to its size."""

PlanarWrench = tuple[float, float, float]
"""A force and its moment about the mass centre."""


class ContactForces:
    """What a closed contact does: accelerations of turning (rad/s^2) and slip (m/s^2), and its reaction.

    The reaction for a mass of 1 (m/s^2) is along normal and tangent; `free` is the acceleration out of the support that
    the contact would have without it.
    """

    # No tuple: machine code makes objects of its own in a tenth of the time.
    def __init__(self, alpha: float, beta: float, normal: float, tangential: float, free: float) -> None:
        self.alpha, self.beta, self.normal, self.tangential, self.free = alpha, beta, normal, tangential, free


class RockingBody:
    """A body on two points fixed in it, over the straight support y = 0; lengths in m, angles in rad."""

    rolls = False
    along = 1.0
    """How far the mass centre moves along the support where a contact slips by 1 m."""
    held = 1, 2
    free = 0
    """Which parts of a wrench both contacts take up while both slip: the body moves along the other one."""

    def __init__(
        self,
        body: TwoPointBody,
        arms: tuple[Vector, Vector],
        edges: tuple[Vector, Vector],
        lean: float = 0.0,
        radius: float = 0.0,
    ) -> None:
        """With both contacts closed and z = 0 `arms` lead from the contacts to the mass centre, and `edges` are the
        contacts in the support's frame; `lean` is the direction from contact 0 to contact 1 in the body at angle 0.
        """
        old, new = body.old, body.new
        assert old is not None
        self.lean, self.radius = lean, radius
        # As tuples of any length: machine code makes those of a known one anew at each index.
        self.arms: tuple[Vector, ...] = arms
        self.edges: tuple[Vector, ...] = edges
        self.spin = 1.0 / radius if self.rolls else 0.0
        """By how much the body turns where a contact slips by 1 m."""
        self.rho_squared = body.inertia / body.mass
        self.friction: tuple[float, ...] = (old.friction, new.friction)
        self.restitution: tuple[float, ...] = (old.restitution, new.restitution)
        self.inertia = tuple([self.rho_squared + x * x + y * y for x, y in arms])
        self.length = math.sqrt(self.rho_squared) + max(math.hypot(x, y) for x, y in arms)
        self._facets: tuple[PlanarWrench, ...] | None = None

    def normal(self, dx: float, dy: float) -> Vector:
        """The normal out of the support of a contact from which the mass centre is at (dx, dy)."""
        return 0.0, 1.0

    def seen_from(self, i: int, state: PlanarState) -> tuple[float, float, float, float]:
        """u, w, z and s of a state in which contact i is closed."""
        dx, dy = turned(self.arms[i], state.angle)
        return state.angle, state.omega, state.x - dx - self.edges[i][0], state.vx + state.omega * dy

    def gap(self, i: int, x: float, y: float, angle: float) -> float:
        """How far contact i is from the support, in m."""
        return y - float(turned(self.arms[i], angle)[1])

    def gap_of_other(self, i: int, u: float) -> Vector:
        """The gap of the other contact while contact i is closed, and its derivative with respect to u."""
        side = self.edges[1 - i][0] - self.edges[i][0]
        return side * math.sin(u), side * math.cos(u)

    def gap_change(self, i: int, state: PlanarState, x: float, y: float, angle: float) -> float:
        """How much the gap of contact i changes from a state, where the body moves by (x, y) and turns."""
        # Of the contact's height -d_y: Rot(angle) - 1 by half angles, in which nothing cancels.
        dx, _ = turned(self.arms[i], state.angle + 0.5 * angle)
        return y - 2.0 * math.sin(0.5 * angle) * float(dx)

    def gap_rate(self, i: int, state: PlanarState) -> float:
        """The rate of the gap of contact i, in m/s."""
        return state.vy - state.omega * float(turned(self.arms[i], state.angle)[0])

    def state(self, i: int, u: Any, w: Any, z: Any, s: Any) -> PlanarState:
        """The state in which contact i is closed; numbers or arrays."""
        dx, dy = turned(self.arms[i], u)
        (ex, ey), along, spin = self.edges[i], self.along, self.spin
        return PlanarState(
            x=ex + along * z + dx,
            y=ey + dy,
            angle=u + spin * z,
            vx=along * s - w * dy,
            vy=w * dx,
            omega=w + spin * s,
        )

    def felt_at(self, felt: FrameAcceleration, x: float, y: float, vx: float, vy: float) -> Vector:
        """Acceleration that the mass centre feels."""
        gx, gy, rate, spin_up = felt
        return (
            gx + spin_up * y + rate * (rate * x + 2.0 * vy),
            gy - spin_up * x + rate * (rate * y - 2.0 * vx),
        )

    def forces(
        self, i: int, slides: int, felt: FrameAcceleration, u: float, w: float, z: float, s: float
    ) -> ContactForces:
        """What contact i does while it alone is closed and sticks or slips, by its own Delassus matrix."""
        ax, ay = self.arms[i]
        sine, cosine = math.sin(u), math.cos(u)
        dx, dy = ax * cosine - ay * sine, ax * sine + ay * cosine
        fx, fy, rate, spin_up = felt
        if rate or spin_up:
            (ex, ey), along = self.edges[i], self.along
            fx, fy = self.felt_at(felt, ex + along * z + dx, ey + dy, along * s - w * dy, w * dx)
        high, side, pull, pull_along = dy, dx, fy, fx  # along the contact's normal and tangent
        if self.rolls:
            high, side = self.radius, 0.0
            pull, pull_along = (fx * dx + fy * dy) / high, (fx * dy - fy * dx) / high
        square, inertia, rho_squared = w * w, self.inertia[i], self.rho_squared
        free = pull + square * high + spin_up * side
        if slides == STICK:  # the reaction is what the mass centre's acceleration lacks
            alpha = (dx * fy - dy * fx - rho_squared * spin_up) / inertia
            normal, tangential = alpha * side - square * high - pull, -alpha * high - square * side - pull_along
            return ContactForces(alpha=alpha, beta=0.0, normal=normal, tangential=tangential, free=free)
        # Acceleration along the tangent without a reaction, and rho^2 times what a reaction adds.
        free_slip = pull_along + square * side - spin_up * high
        nn, nt, tt = rho_squared + side * side, -side * high, rho_squared + high * high
        drag = self.friction[i] if slides == PLUS else -self.friction[i]
        bracket = nn - drag * nt
        if bracket <= 0.0:
            # No finite reaction keeps the slipping contact on the support (Painleve).
            none, free = math.nan, -1.0 if free < 0.0 else 0.0
            return ContactForces(alpha=none, beta=none, normal=none, tangential=none, free=free)
        push = -free / bracket
        drive = -drag * push
        beta = free_slip + nt * push + tt * drive
        alpha = high * drive - side * push - spin_up - self.spin * beta
        return ContactForces(
            alpha=alpha, beta=beta, normal=rho_squared * push, tangential=rho_squared * drive, free=free
        )

    def wrench(self, i: int, side: float) -> PlanarWrench:
        """What contact i does for a normal force of 1, with both contacts closed and `side` along its tangent."""
        dx, dy = self.arms[i]
        nx, ny = self.normal(dx, dy)
        fx, fy = nx + side * ny, ny - side * nx
        return fx, fy, dy * fx - dx * fy

    def forces_of_both(self, slides: int, felt: FrameAcceleration, z: float, s: float) -> tuple[float, float, float]:
        """Slip's acceleration and both normal reactions for a mass of 1, while both contacts slip."""
        (x, y), along = self.arms[0], self.along
        fx, fy = self.felt_at(felt, along * z + x, y, along * s, 0.0)
        load = fx, fy, -self.rho_squared * felt[3]
        sign = 1.0 if slides == PLUS else -1.0
        a, b = (self.wrench(i, -sign * self.friction[i]) for i in (0, 1))
        (j, k), free = self.held, self.free
        width = a[j] * b[k] - a[k] * b[j]
        if width <= 0.0:
            return math.nan, math.nan, math.nan
        normal, normal_b = (load[k] * b[j] - load[j] * b[k]) / width, (load[j] * a[k] - load[k] * a[j]) / width
        drive = load[free] + normal * a[free] + normal_b * b[free]
        return drive / (self.spin * self.rho_squared if self.rolls else 1.0), normal, normal_b

    def contact(self, i: int, u: float) -> Contact:
        """Contact i as an impact law sees it."""
        x, y = turned(self.arms[i], u)
        return Contact(-x, -y, self.friction[i], self.normal(x, y), self.restitution[i])

    @property
    def facets(self) -> tuple[PlanarWrench, ...]:
        """Inward normals of the cone of the wrenches that both contacts can give while neither slips.

        Moments are divided by rho.
        """
        if self._facets is None:
            self._facets = self._cone()
        return self._facets

    def _cone(self) -> tuple[PlanarWrench, ...]:
        rho = math.sqrt(self.rho_squared)
        wrenches = [self.wrench(i, side) for i in (0, 1) for side in (self.friction[i], -self.friction[i])]
        rays = [_unit((fx, fy, moment / rho)) for fx, fy, moment in wrenches]
        found: list[PlanarWrench] = []
        for one, other in combinations(rays, 2):
            across = _cross(one, other)
            if _dot(across, across) <= _UNIT * _UNIT:
                continue
            x, y, m = _unit(across)
            for facet in ((x, y, m), (-x, -y, -m)):
                heights = [_dot(facet, ray) for ray in rays]
                if min(heights) >= -_UNIT:
                    found.append(facet)
                    if max(heights) <= _UNIT:  # without friction the cone is a fan of two rays: its sides, too
                        side, far_side = _cross(facet, rays[0]), _cross(facet, rays[2])
                        sign = 1.0 if _dot(side, rays[2]) >= 0.0 else -1.0
                        found += [(sign * side[0], sign * side[1], sign * side[2])]
                        found += [(-sign * far_side[0], -sign * far_side[1], -sign * far_side[2])]
        return tuple(found)

    def hold_margins(self, felt: tuple[Any, Any, Any, Any], z: float) -> list[Any]:
        """What must not be negative while the body rests on both contacts, in m/s^2; numbers or arrays over time."""
        (x, y), (gx, gy, rate, spin_up) = self.arms[0], felt
        x += self.along * z
        # As `felt_at` of what is at rest, which takes no arrays: it is asked for at each step.
        fx, fy = gx + spin_up * y + rate * (rate * x), gy - spin_up * x + rate * (rate * y)
        moment = math.sqrt(self.rho_squared) * spin_up
        return [kx * -fx + ky * -fy + km * moment for kx, ky, km in self.facets]


class Disc(RockingBody):
    """A disc over two edges fixed in the support; edge 0 is the origin of its frame."""

    rolls = True
    along = 0.0
    held = 0, 1
    free = 2

    def normal(self, dx: float, dy: float) -> Vector:
        return dx / self.radius, dy / self.radius

    def seen_from(self, i: int, state: PlanarState) -> tuple[float, float, float, float]:
        (ex, ey), (ax, ay) = self.edges[i], self.arms[i]
        dx, dy = state.x - ex, state.y - ey
        u = math.atan2(ax * dy - ay * dx, ax * dx + ay * dy)
        w = (dx * state.vy - dy * state.vx) / (dx * dx + dy * dy)
        return u, w, self.radius * (state.angle - u), self.radius * (state.omega - w)

    def gap(self, i: int, x: float, y: float, angle: float) -> float:
        return math.hypot(x - self.edges[i][0], y - self.edges[i][1]) - self.radius

    def gap_of_other(self, i: int, u: float) -> Vector:
        ex, ey = self.edges[i][0] - self.edges[1 - i][0], self.edges[i][1] - self.edges[1 - i][1]
        # |C - e|^2 - R^2 from the half angle, in which nothing cancels.
        (dx, dy), (mid_x, mid_y) = turned(self.arms[i], u), turned(self.arms[i], 0.5 * u)
        excess = 4.0 * math.sin(0.5 * u) * float(ey * mid_x - ex * mid_y)
        distance = math.sqrt(max(0.0, self.radius * self.radius + excess))
        return excess / (distance + self.radius), float(ey * dx - ex * dy) / (distance or self.radius)

    def gap_change(self, i: int, state: PlanarState, x: float, y: float, angle: float) -> float:
        dx, dy = state.x - self.edges[i][0], state.y - self.edges[i][1]
        distance = math.hypot(dx, dy)
        return (x * (2.0 * dx + x) + y * (2.0 * dy + y)) / (math.hypot(dx + x, dy + y) + distance)

    def gap_rate(self, i: int, state: PlanarState) -> float:
        dx, dy = state.x - self.edges[i][0], state.y - self.edges[i][1]
        size = math.hypot(dx, dy)
        return (dx * state.vx + dy * state.vy) / size if size > 0.0 else 0.0


def rocking_body(body: TwoPointBody) -> RockingBody:
    """The body on points or the disc on edges that a body with its contacts is.

    Raises:
        InputError: it is neither; it has one contact; or its contacts lie in one place.
    """
    old, new = body.old, body.new
    if old is None:
        raise InputError("a body that rocks needs two contacts; give TwoPointBody.old, too")
    radius, radius_b = math.hypot(old.x, old.y), math.hypot(new.x, new.y)
    size = radius + radius_b
    span = math.hypot(new.x - old.x, new.y - old.y)
    if not (span > _UNIT * size and 0.0 < span * span < math.inf):
        raise InputError("the two contacts lie in one place or endlessly far from each other; give two that are apart")
    if all(abs(nx) <= _UNIT and ny > 0.0 for nx, ny in (old.normal, new.normal)):
        return two_points(body)
    radial = all(
        abs(contact.x + radius * contact.normal[0]) + abs(contact.y + radius * contact.normal[1]) <= _UNIT * size
        for contact in (old, new)
    )
    ahead = old.x * new.y - old.y * new.x > 0.0
    if not (radial and ahead and abs(radius - radius_b) <= _UNIT * size):
        raise InputError(
            "the contacts are neither points over a straight support (both normals (0, 1)) nor the edges under a disc "
            "(normals through the mass centre, equal distances, contact 1 ahead); give one of these"
        )
    arms, edges = ((-old.x, -old.y), (-new.x, -new.y)), ((0.0, 0.0), (new.x - old.x, new.y - old.y))
    return Disc(body, arms, edges, radius=radius)


def two_points(body: TwoPointBody) -> RockingBody:
    """The body on its two contacts as points, whatever their normals are."""
    old, new = body.old, body.new
    assert old is not None
    dx, dy = new.x - old.x, new.y - old.y
    span = math.hypot(dx, dy)
    c, s = dx / span, dy / span
    x, y = -(c * old.x + s * old.y), s * old.x - c * old.y
    return RockingBody(body, ((x, y), (x - span, y)), ((0.0, 0.0), (span, 0.0)), lean=math.atan2(dy, dx))


def turned(arm: Vector, angle: Any) -> tuple[Any, Any]:
    sine, cosine = sine_and_cosine(angle)
    return arm[0] * cosine - arm[1] * sine, arm[0] * sine + arm[1] * cosine


def _unit(a: PlanarWrench) -> PlanarWrench:
    size = math.sqrt(_dot(a, a))
    return a[0] / size, a[1] / size, a[2] / size


def _cross(a: PlanarWrench, b: PlanarWrench) -> PlanarWrench:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: PlanarWrench, b: PlanarWrench) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
