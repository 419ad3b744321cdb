"""Equations of motion of a falling body, in plain numbers: what extrapolations and integrators start from."""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from ...mechanics.motion import PlanarState
from ...mechanics.types import Twist, Vector
from .touchdown_scenes import Falling

RESTS = 1e-12
"""A slip of the stance below this part of the speeds that it is the difference of is none."""


def slip_of(fall: Falling) -> float:
    """Velocity of the stance contact along the support (m/s)."""
    state = fall.state
    slip = state.vx + state.omega * state.y
    return slip if abs(slip) > RESTS * (abs(state.vx) + abs(state.omega * state.y)) else 0.0


class Stance(NamedTuple):
    """A body about its stance contact: the point seen from the mass centre at angle 0, and how it is dragged.

    `drag` is friction with the sign of the slip, None while the contact sticks.
    """

    foot: Vector
    rho_squared: float
    drag: float | None
    gravity: float

    def arm(self, angle: float) -> Vector:
        """The mass centre from the contact."""
        (x, y), c, s = self.foot, cos(angle), sin(angle)
        return s * y - c * x, -s * x - c * y

    def accelerations(self, angle: float, omega: float) -> Vector:
        """Angular acceleration, and the acceleration of the contact along the support."""
        x, y = self.arm(angle)
        square = omega * omega
        if self.drag is None:
            return self.gravity * x / (self.rho_squared + x * x + y * y), 0.0
        lever = x + self.drag * y
        alpha = (square * y + self.gravity) * lever / (self.rho_squared + x * lever)
        normal = alpha * x - square * y - self.gravity
        return alpha, alpha * y + square * x - self.drag * normal

    def twist(self, angle: float, omega: float, slip: float) -> Twist:
        """The twist of the mass centre."""
        x, y = self.arm(angle)
        return Twist(slip - omega * y, omega * x, omega)


def stance_of(fall: Falling) -> Stance:
    """The stance of a body that stands, on a level support."""
    assert fall.stance is not None
    slip = slip_of(fall)
    drag = None if slip == 0.0 else fall.friction if slip > 0.0 else -fall.friction
    return Stance(fall.points[fall.stance], fall.rho_squared, drag, fall.gravity[1])


def striking(fall: Falling) -> list[Vector]:
    """The points that can touch next."""
    return [point for index, point in enumerate(fall.points) if index != fall.stance]


def twist_rates(fall: Falling) -> Twist:
    """The acceleration of the mass centre and the angular acceleration, now."""
    if fall.stance is None:
        return Twist(*fall.gravity, 0.0)
    stance = stance_of(fall)
    x, y = stance.arm(fall.state.angle)
    omega = fall.state.omega
    alpha, slide = stance.accelerations(fall.state.angle, omega)
    return Twist(slide - alpha * y - omega * omega * x, alpha * x - omega * omega * y, alpha)


def gap_of(state: PlanarState, point: Vector, rates: Twist) -> tuple[float, float, float]:
    """Height of a point over the support, its rate and its acceleration."""
    c, s = cos(state.angle), sin(state.angle)
    x, y = c * point[0] - s * point[1], s * point[0] + c * point[1]
    omega = state.omega
    return state.y + y, state.vy + omega * x, rates.vy + rates.omega * x - omega * omega * y
