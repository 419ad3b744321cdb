"""A disc over two edges fixed in the support."""

from __future__ import annotations

import math

from ..motion import PlanarState
from ..pair import PLUS, STICK
from ..support import Felt
from ..types import TwoPointBody, Vector
from .shape import Forces, Shape, turned


class Disc(Shape):
    """A disc over two edges fixed in the support; edge 0 is the origin of its frame."""

    rolls = True

    def __init__(self, body: TwoPointBody) -> None:
        old, new = body.old, body.new
        assert old is not None
        self.radius = math.hypot(old.x, old.y)
        self.arms = (-old.x, -old.y), (-new.x, -new.y)
        self.edges = (0.0, 0.0), (new.x - old.x, new.y - old.y)
        super().__init__(body)

    def foot(self, i: int, z: float) -> Vector:
        return self.edges[i]

    def normal(self, i: int, u: float) -> Vector:
        x, y = turned(self.arms[i], u)
        return x / self.radius, y / self.radius

    def pose(self, i: int, u: float, z: float) -> tuple[float, float, float]:
        dx, dy = turned(self.arms[i], u)
        return self.edges[i][0] + dx, self.edges[i][1] + dy, u + z / self.radius

    def state(self, i: int, u: float, w: float, z: float, s: float) -> PlanarState:
        dx, dy = turned(self.arms[i], u)
        ex, ey = self.edges[i]
        return PlanarState(ex + dx, ey + dy, u + z / self.radius, -w * dy, w * dx, w + s / self.radius)

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

    def forces(self, i: int, slides: int, felt: Felt, u: float, w: float, z: float, s: float) -> Forces:
        ax, ay = self.arms[i]
        sine, cosine = math.sin(u), math.cos(u)
        dx, dy = ax * cosine - ay * sine, ax * sine + ay * cosine
        fx, fy, rate, spin_up = felt
        if rate or spin_up:
            ex, ey = self.edges[i]
            x, y = ex + dx, ey + dy
            fx += spin_up * y + rate * (rate * x + 2.0 * w * dx)
            fy += -spin_up * x + rate * (rate * y + 2.0 * w * dy)
        radius, square = self.radius, self.rho_squared
        free = w * w * radius + (fx * dx + fy * dy) / radius
        moment = dx * fy - dy * fx  # -R times the felt acceleration along the tangent
        if slides == STICK:
            alpha = (moment - square * spin_up) / self.inertia[i]
            return Forces(alpha, 0.0, -free, square * (alpha + spin_up) / radius, free)
        tangential = self.friction[i] * (free if slides == PLUS else -free)
        alpha = (moment / radius - tangential) / radius
        return Forces(alpha, radius * (radius * tangential / square - spin_up - alpha), -free, tangential, free)

    def forces_of_both(self, slides: int, felt: Felt, z: float, s: float) -> tuple[float, float, float]:
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
