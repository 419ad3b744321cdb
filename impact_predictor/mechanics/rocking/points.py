"""A body on two points fixed in it, over a straight support."""

from __future__ import annotations

import math

from ..motion import PlanarState
from ..pair import PLUS, STICK
from ..support import Felt
from ..types import TwoPointBody, Vector
from .shape import JAM, Forces, Shape, turned


class Points(Shape):
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

    def foot(self, i: int, z: float) -> Vector:
        return z + i * self.span, 0.0

    def normal(self, i: int, u: float) -> Vector:
        return 0.0, 1.0

    def pose(self, i: int, u: float, z: float) -> tuple[float, float, float]:
        dx, dy = turned(self.arms[i], u)
        return z + i * self.span + dx, dy, u

    def state(self, i: int, u: float, w: float, z: float, s: float) -> PlanarState:
        dx, dy = turned(self.arms[i], u)
        return PlanarState(z + i * self.span + dx, dy, u, s - w * dy, w * dx, w)

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
        dx, dy = turned(self.arms[i], state.angle + 0.5 * angle)
        return y - 2.0 * math.sin(0.5 * angle) * float(dx)

    def gap_rate(self, i: int, state: PlanarState) -> float:
        return state.vy - state.omega * float(turned(self.arms[i], state.angle)[0])

    def forces(self, i: int, slides: int, felt: Felt, u: float, w: float, z: float, s: float) -> Forces:
        ax, ay = self.arms[i]
        sine, cosine = math.sin(u), math.cos(u)
        dx, dy = ax * cosine - ay * sine, ax * sine + ay * cosine
        fx, fy, rate, spin_up = felt
        if rate or spin_up:
            x = z + i * self.span + dx
            fx += spin_up * dy + rate * (rate * x + 2.0 * w * dx)
            fy += -spin_up * x + rate * (rate * dy - 2.0 * (s - w * dy))
        square = w * w
        out = square * dy + fy
        if slides == STICK:
            alpha = (dx * fy - dy * fx - self.rho_squared * spin_up) / self.inertia[i]
            normal, tangential = alpha * dx - out, -alpha * dy - square * dx - fx
            return Forces(alpha, 0.0, normal, tangential, out + spin_up * dx)
        drag = self.friction[i] if slides == PLUS else -self.friction[i]
        lever = dx + drag * dy
        bracket = self.rho_squared + dx * lever
        if bracket <= 0.0:
            return JAM if out + spin_up * dx < 0.0 else JAM._replace(free=0.0)
        alpha = (lever * out - self.rho_squared * spin_up) / bracket
        free = out + spin_up * dx
        normal = -self.rho_squared * free / bracket
        return Forces(alpha, fx - drag * normal + alpha * dy + square * dx, normal, -drag * normal, free)

    def forces_of_both(self, slides: int, felt: Felt, z: float, s: float) -> tuple[float, float, float]:
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
