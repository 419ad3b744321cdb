"""The two shapes that rock: a body on two points fixed in it, and a disc over two edges fixed in the support.

While contact i is closed a pose is (u, z): u the angle in rad about it from the pose with both contacts closed, and z
how far in m the contact has slipped. Either shape has its mass centre at Rot(u) d_i from contact i. The points slip
along the support, z being the place of contact 0 when both are closed; the disc slips by spinning, its angle being
u + z / R. In both the slip velocity along the contact's tangent is s = dz/dt. Contact 0 is closed for u >= 0, contact 1
for u <= 0, both for u = 0: what is left free then is z.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any, NamedTuple

from ..bodies import sine_and_cosine
from ..motion import PlanarState
from ..support import Felt
from ..types import Contact, TwoPointBody, Vector

UNIT = 1e-9
"""How far contacts may be from what a shape wants, relative to its size."""


class Forces(NamedTuple):
    """What a closed contact does: accelerations of turning (rad/s^2) and slip (m/s^2), and its reaction.

    The reaction for a mass of 1 (m/s^2) is along normal and tangent; `free` is the acceleration out of the support that
    the contact would have without it.
    """

    alpha: float
    beta: float
    normal: float
    tangential: float
    free: float


JAM = Forces(math.nan, math.nan, math.nan, math.nan, -1.0)
"""No finite reaction keeps the slipping contact on the support (Painleve)."""


class Shape:
    """What both shapes share; lengths in m, angles in rad."""

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
        self.radii = tuple(math.hypot(x, y) for x, y in self.arms)
        self.length = math.sqrt(self.rho_squared) + max(self.radii)

    def own_angle(self, angle: float) -> float:
        """The angle from the pose with both contacts closed, of a body at an angle."""
        return angle

    def foot(self, i: int, z: float) -> Vector:
        """Where contact i touches the support."""
        raise NotImplementedError

    def normal(self, i: int, u: float) -> Vector:
        """The normal of contact i, out of the support, while it is closed."""
        raise NotImplementedError

    def pose(self, i: int, u: float, z: float) -> tuple[float, float, float]:
        """Place of the mass centre and angle from the pose with both contacts closed; numbers or arrays."""
        raise NotImplementedError

    def state(self, i: int, u: float, w: float, z: float, s: float) -> PlanarState:
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
        raise NotImplementedError

    def forces(self, i: int, slides: int, felt: Felt, u: float, w: float, z: float, s: float) -> Forces:
        """What contact i does while it alone is closed and sticks or slips."""
        raise NotImplementedError

    def forces_of_both(self, slides: int, felt: Felt, z: float, s: float) -> tuple[float, float, float]:
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
        nx, ny = self.normal(i, u)
        x, y = self.to_contact(i, u)
        return Contact(x, y, self.friction[i], (nx, ny), self.restitution[i])

    def to_contact(self, i: int, u: float) -> Vector:
        x, y = turned(self.arms[i], u)
        return -x, -y

    @cached_property
    def facets(self) -> tuple[tuple[float, float, float], ...]:
        """Inward normals of the cone of the wrenches that both contacts can give while neither slips.

        A wrench is a force and its moment about the mass centre divided by rho.
        """
        rho = math.sqrt(self.rho_squared)
        rays = []
        for i in (0, 1):
            nx, ny = self.normal(i, 0.0)
            x, y = self.to_contact(i, 0.0)
            for side in (1.0, -1.0):
                fx, fy = nx + side * self.friction[i] * ny, ny - side * self.friction[i] * nx
                ray = fx, fy, (x * fy - y * fx) / rho
                size = math.sqrt(sum(part * part for part in ray))
                rays.append((ray[0] / size, ray[1] / size, ray[2] / size))
        found: list[tuple[float, float, float]] = []
        flat = None
        for k, one in enumerate(rays):
            for other in rays[:k]:
                cross = _cross(one, other)
                size = math.sqrt(_dot(cross, cross))
                if size <= UNIT:
                    continue
                for sign in (1.0 / size, -1.0 / size):
                    facet = sign * cross[0], sign * cross[1], sign * cross[2]
                    heights = [_dot(facet, ray) for ray in rays]
                    if min(heights) >= -UNIT:
                        found.append(facet)
                        if max(heights) <= UNIT:
                            flat = facet
        if flat is not None:  # without friction the cone is a fan of two rays: close it in its plane, too
            for one, other in ((rays[0], rays[2]), (rays[2], rays[0])):
                side_x, side_y, side_m = _cross(flat, one)
                sign = 1.0 if _dot((side_x, side_y, side_m), other) >= 0.0 else -1.0
                found.append((sign * side_x, sign * side_y, sign * side_m))
        return tuple(found)

    def hold_margins(self, felt: tuple[Any, Any, Any, Any], z: float) -> list[Any]:
        """What must not be negative while the body rests on both contacts, in m/s^2; numbers or arrays over time."""
        x, y, _ = self.pose(0, 0.0, z)
        fx, fy = self.felt_at(felt, x, y, 0.0, 0.0)
        moment = math.sqrt(self.rho_squared) * felt[3]
        return [kx * -fx + ky * -fy + km * moment for kx, ky, km in self.facets]


def turned(arm: Vector, angle: Any) -> tuple[Any, Any]:
    sine, cosine = sine_and_cosine(angle)
    return arm[0] * cosine - arm[1] * sine, arm[0] * sine + arm[1] * cosine


def _cross(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
