"""The two bodies that rock, their poses, gaps and equations of motion while contacts are closed.

A body stands on two points fixed in it, over a straight support (`TwoPoints`), or it is a disc over two edges fixed in
the support (`Disc`). While contact i is closed a pose is (u, z): u the angle in rad about it from the pose with both
contacts closed, and z how far in m the contact has slipped. The mass centre is at Rot(u) d_i from contact i. The points
slip along the support, z being the place of contact 0 when both are closed; the disc slips by spinning, its angle being
u + z / R. The slip velocity along the contact's tangent is s = dz/dt. Contact 0 is closed for u >= 0, contact 1 for
u <= 0, both for u = 0: what is left free then is z.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any, NamedTuple

from ...errors import InputError
from ..bodies import sine_and_cosine
from ..impact.contacts import PLUS, STICK
from ..types import Contact, TwoPointBody, Vector
from .support import FrameAcceleration, PlanarState

_UNIT = 1e-9
"""How far contacts may be from what a body that rocks has, relative to its size."""


class ContactForces(NamedTuple):
    """What a closed contact does: accelerations of turning (rad/s^2) and slip (m/s^2), and its reaction.

    The reaction for a mass of 1 (m/s^2) is along normal and tangent; `free` is the acceleration out of the support that
    the contact would have without it.
    """

    alpha: float
    beta: float
    normal: float
    tangential: float
    free: float


_NONE = ContactForces(alpha=math.nan, beta=math.nan, normal=math.nan, tangential=math.nan, free=-1.0)
"""No finite reaction keeps the slipping contact on the support (Painleve)."""


class RockingBody:
    """A body with two contacts; lengths in m, angles in rad."""

    arms: tuple[Vector, Vector]
    """Mass centre seen from the contacts when both are closed."""
    edges: tuple[Vector, Vector]
    """The contacts in the support's frame when both are closed and z = 0."""
    rolls: bool
    lean = 0.0
    """Direction from contact 0 to contact 1 in a body at angle 0."""

    def __init__(self, body: TwoPointBody) -> None:
        old, new = body.old, body.new
        assert old is not None
        self.body = body
        self.rho_squared = body.inertia / body.mass
        self.friction = old.friction, new.friction
        self.restitution = old.restitution, new.restitution
        self.inertia = tuple(self.rho_squared + x * x + y * y for x, y in self.arms)
        self.length = math.sqrt(self.rho_squared) + max(math.hypot(x, y) for x, y in self.arms)

    def own_angle(self, angle: float) -> float:
        """The angle from the pose with both contacts closed, of a body at an angle."""
        return angle

    def normal(self, i: int, u: float) -> Vector:
        """The normal of contact i, out of the support, while it is closed."""
        raise NotImplementedError

    def state(self, i: int, u: float, w: float, z: float, s: float) -> PlanarState:
        """The state in which contact i is closed; numbers or arrays."""
        raise NotImplementedError

    def seen_from(self, i: int, state: PlanarState) -> tuple[float, float, float, float]:
        """u, w, z and s of a state in which contact i is closed."""
        raise NotImplementedError

    def gap(self, i: int, x: float, y: float, angle: float) -> float:
        """How far contact i is from the support, in m."""
        raise NotImplementedError

    def gap_of_other(self, i: int, u: float) -> Vector:
        """The gap of the other contact while contact i is closed, and its derivative with respect to u."""
        raise NotImplementedError

    def gap_change(self, i: int, state: PlanarState, x: float, y: float, angle: float) -> float:
        """How much the gap of contact i changes from a state, where the body moves by (x, y) and turns."""
        raise NotImplementedError

    def gap_rate(self, i: int, state: PlanarState) -> float:
        """The rate of the gap of contact i, in m/s."""
        raise NotImplementedError

    def forces(
        self, i: int, slides: int, felt: FrameAcceleration, u: float, w: float, z: float, s: float
    ) -> ContactForces:
        """What contact i does while it alone is closed and sticks or slips."""
        raise NotImplementedError

    def forces_of_both(self, slides: int, felt: FrameAcceleration, z: float, s: float) -> tuple[float, float, float]:
        """Slip's acceleration and both normal reactions for a mass of 1, while both contacts slip."""
        raise NotImplementedError

    def felt_at(self, felt: tuple[Any, Any, Any, Any], x: float, y: float, vx: float, vy: float) -> tuple[Any, Any]:
        """Acceleration that the mass centre feels."""
        gx, gy, rate, spin_up = felt
        return (
            gx + spin_up * y + rate * (rate * x + 2.0 * vy),
            gy - spin_up * x + rate * (rate * y - 2.0 * vx),
        )

    def contact(self, i: int, u: float) -> Contact:
        """Contact i as an impact law sees it."""
        x, y = turned(self.arms[i], u)
        return Contact(-x, -y, self.friction[i], self.normal(i, u), self.restitution[i])

    @cached_property
    def facets(self) -> tuple[tuple[float, float, float], ...]:
        """Inward normals of the cone of the wrenches that both contacts can give while neither slips.

        A wrench is a force and its moment about the mass centre divided by rho.
        """
        rho = math.sqrt(self.rho_squared)
        rays = []
        for i in (0, 1):
            x, y, friction, (nx, ny), *_ = self.contact(i, 0.0)
            for side in (friction, -friction):
                fx, fy = nx + side * ny, ny - side * nx
                ray = fx, fy, (x * fy - y * fx) / rho
                size = math.sqrt(_dot(ray, ray))
                rays.append((ray[0] / size, ray[1] / size, ray[2] / size))
        found: list[tuple[float, float, float]] = []
        flat = None
        for k, one in enumerate(rays):
            for other in rays[:k]:
                cross = _cross(one, other)
                size = math.sqrt(_dot(cross, cross))
                if size <= _UNIT:
                    continue
                for sign in (1.0 / size, -1.0 / size):
                    facet = sign * cross[0], sign * cross[1], sign * cross[2]
                    heights = [_dot(facet, ray) for ray in rays]
                    if min(heights) >= -_UNIT:
                        found.append(facet)
                        if max(heights) <= _UNIT:
                            flat = facet
        if flat is not None:  # without friction the cone is a fan of two rays: close it in its plane, too
            for one, other in ((rays[0], rays[2]), (rays[2], rays[0])):
                side_x, side_y, side_m = _cross(flat, one)
                sign = 1.0 if _dot((side_x, side_y, side_m), other) >= 0.0 else -1.0
                found.append((sign * side_x, sign * side_y, sign * side_m))
        return tuple(found)

    def hold_margins(self, felt: tuple[Any, Any, Any, Any], z: float) -> list[Any]:
        """What must not be negative while the body rests on both contacts, in m/s^2; numbers or arrays over time."""
        place = self.state(0, 0.0, 0.0, z, 0.0)
        fx, fy = self.felt_at(felt, place.x, place.y, 0.0, 0.0)
        moment = math.sqrt(self.rho_squared) * felt[3]
        return [kx * -fx + ky * -fy + km * moment for kx, ky, km in self.facets]


class TwoPoints(RockingBody):
    """A body on two points fixed in it, over the straight support y = 0."""

    rolls = False

    def __init__(self, body: TwoPointBody) -> None:
        old, new = body.old, body.new
        assert old is not None
        dx, dy = new.x - old.x, new.y - old.y
        self.span = math.hypot(dx, dy)
        self.lean = math.atan2(dy, dx)
        c, s = dx / self.span, dy / self.span
        arm_x, arm_y = -(c * old.x + s * old.y), s * old.x - c * old.y
        self.arms = (arm_x, arm_y), (arm_x - self.span, arm_y)
        self.edges = (0.0, 0.0), (self.span, 0.0)
        super().__init__(body)

    def own_angle(self, angle: float) -> float:
        return math.remainder(angle + self.lean, 2.0 * math.pi)

    def normal(self, i: int, u: float) -> Vector:
        return 0.0, 1.0

    def state(self, i: int, u: float, w: float, z: float, s: float) -> PlanarState:
        dx, dy = turned(self.arms[i], u)
        return PlanarState(x=z + i * self.span + dx, y=dy, angle=u, vx=s - w * dy, vy=w * dx, omega=w)

    def seen_from(self, i: int, state: PlanarState) -> tuple[float, float, float, float]:
        x, _, u, vx, _, w = state
        dx, dy = turned(self.arms[i], u)
        return u, w, x - dx - i * self.span, vx + w * dy

    def gap(self, i: int, x: float, y: float, angle: float) -> float:
        return y - float(turned(self.arms[i], angle)[1])

    def gap_of_other(self, i: int, u: float) -> Vector:
        side = self.span if i == 0 else -self.span
        return side * math.sin(u), side * math.cos(u)

    def gap_change(self, i: int, state: PlanarState, x: float, y: float, angle: float) -> float:
        # Of the contact's height -d_y: Rot(angle) - 1 by half angles, in which nothing cancels.
        dx, _ = turned(self.arms[i], state.angle + 0.5 * angle)
        return y - 2.0 * math.sin(0.5 * angle) * float(dx)

    def gap_rate(self, i: int, state: PlanarState) -> float:
        return state.vy - state.omega * float(turned(self.arms[i], state.angle)[0])

    def forces(
        self, i: int, slides: int, felt: FrameAcceleration, u: float, w: float, z: float, s: float
    ) -> ContactForces:
        ax, ay = self.arms[i]
        sine, cosine = math.sin(u), math.cos(u)
        dx, dy = ax * cosine - ay * sine, ax * sine + ay * cosine
        fx, fy, rate, spin_up = felt
        if rate or spin_up:
            fx, fy = self.felt_at(felt, z + i * self.span + dx, dy, s - w * dy, w * dx)
        square = w * w
        out = square * dy + fy
        free = out + spin_up * dx
        if slides == STICK:
            alpha = (dx * fy - dy * fx - self.rho_squared * spin_up) / self.inertia[i]
            normal, tangential = alpha * dx - out, -alpha * dy - square * dx - fx
            return ContactForces(alpha=alpha, beta=0.0, normal=normal, tangential=tangential, free=free)
        drag = self.friction[i] if slides == PLUS else -self.friction[i]
        lever = dx + drag * dy
        bracket = self.rho_squared + dx * lever
        if bracket <= 0.0:
            return _NONE if free < 0.0 else _NONE._replace(free=0.0)
        alpha = (lever * out - self.rho_squared * spin_up) / bracket
        normal = -self.rho_squared * free / bracket
        beta = fx - drag * normal + alpha * dy + square * dx
        return ContactForces(alpha=alpha, beta=beta, normal=normal, tangential=-drag * normal, free=free)

    def forces_of_both(self, slides: int, felt: FrameAcceleration, z: float, s: float) -> tuple[float, float, float]:
        (a, h), (b, _) = self.arms
        fx, fy = self.felt_at(felt, z + a, h, s, 0.0)
        sign = 1.0 if slides == PLUS else -1.0
        drag, drag_b = sign * self.friction[0], sign * self.friction[1]
        lever, lever_b = a + drag * h, b + drag_b * h
        width = lever - lever_b
        if width <= 0.0:
            return math.nan, math.nan, math.nan
        moment = self.rho_squared * felt[3]
        normal, normal_b = (lever_b * fy - moment) / width, (moment - lever * fy) / width
        return fx - drag * normal - drag_b * normal_b, normal, normal_b


class Disc(RockingBody):
    """A disc over two edges fixed in the support; edge 0 is the origin of its frame."""

    rolls = True

    def __init__(self, body: TwoPointBody) -> None:
        old, new = body.old, body.new
        assert old is not None
        self.radius = math.hypot(old.x, old.y)
        self.arms = (-old.x, -old.y), (-new.x, -new.y)
        self.edges = (0.0, 0.0), (new.x - old.x, new.y - old.y)
        super().__init__(body)

    def normal(self, i: int, u: float) -> Vector:
        x, y = turned(self.arms[i], u)
        return x / self.radius, y / self.radius

    def state(self, i: int, u: float, w: float, z: float, s: float) -> PlanarState:
        dx, dy = turned(self.arms[i], u)
        ex, ey = self.edges[i]
        spin, rate = z / self.radius, s / self.radius
        return PlanarState(x=ex + dx, y=ey + dy, angle=u + spin, vx=-w * dy, vy=w * dx, omega=w + rate)

    def seen_from(self, i: int, state: PlanarState) -> tuple[float, float, float, float]:
        x, y, angle, vx, vy, omega = state
        (ex, ey), (ax, ay) = self.edges[i], self.arms[i]
        dx, dy = x - ex, y - ey
        u = math.atan2(ax * dy - ay * dx, ax * dx + ay * dy)
        w = (dx * vy - dy * vx) / (dx * dx + dy * dy)
        return u, w, self.radius * (angle - u), self.radius * (omega - w)

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

    def forces(
        self, i: int, slides: int, felt: FrameAcceleration, u: float, w: float, z: float, s: float
    ) -> ContactForces:
        ax, ay = self.arms[i]
        sine, cosine = math.sin(u), math.cos(u)
        dx, dy = ax * cosine - ay * sine, ax * sine + ay * cosine
        fx, fy, rate, spin_up = felt
        if rate or spin_up:
            ex, ey = self.edges[i]
            fx, fy = self.felt_at(felt, ex + dx, ey + dy, -w * dy, w * dx)
        radius, square = self.radius, self.rho_squared
        free = w * w * radius + (fx * dx + fy * dy) / radius
        moment = dx * fy - dy * fx  # -R times the felt acceleration along the tangent
        if slides == STICK:
            alpha = (moment - square * spin_up) / self.inertia[i]
            tangential = square * (alpha + spin_up) / radius
            return ContactForces(alpha=alpha, beta=0.0, normal=-free, tangential=tangential, free=free)
        tangential = self.friction[i] * (free if slides == PLUS else -free)
        alpha = (moment / radius - tangential) / radius
        beta = radius * (radius * tangential / square - spin_up - alpha)
        return ContactForces(alpha=alpha, beta=beta, normal=-free, tangential=tangential, free=free)

    def forces_of_both(self, slides: int, felt: FrameAcceleration, z: float, s: float) -> tuple[float, float, float]:
        (ax, ay), (bx, by) = self.arms
        fx, fy = self.felt_at(felt, ax, ay, 0.0, 0.0)
        sign = 1.0 if slides == PLUS else -1.0
        drag, drag_b = sign * self.friction[0], sign * self.friction[1]
        radius = self.radius
        # Directions of the two reactions: n - drag t.
        px, py = (ax - drag * ay) / radius, (ay + drag * ax) / radius
        qx, qy = (bx - drag_b * by) / radius, (by + drag_b * bx) / radius
        width = px * qy - py * qx
        if width <= 0.0:
            return math.nan, math.nan, math.nan
        normal, normal_b = (fy * qx - fx * qy) / width, (fx * py - fy * px) / width
        push = -drag * normal - drag_b * normal_b
        return radius * (radius * push / self.rho_squared - felt[3]), normal, normal_b


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
        return TwoPoints(body)
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
    return Disc(body)


def turned(arm: Vector, angle: Any) -> tuple[Any, Any]:
    sine, cosine = sine_and_cosine(angle)
    return arm[0] * cosine - arm[1] * sine, arm[0] * sine + arm[1] * cosine


def _cross(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
