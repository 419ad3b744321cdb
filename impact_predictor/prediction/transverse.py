"""The impact of a body that the samples show to slip across its impact plane."""

from __future__ import annotations

from math import cos, hypot, inf, sin

from ..mechanics.transverse import Transverse, solve_transverse_impact
from ..mechanics.types import Outcome, Twist, TwoPointBody
from .planar import Across, Plane, inertia_about
from .scene import Scene
from .types import Vector3
from .vectors import combine

SLIPS = 0.05
"""A body slips across its plane from this part of the speed of its new contact in the plane: less changes the twist of
a landing cube by less than 0.006 of that speed, and poses measure it to 0.01."""

TOLERANCE = 5e-3
"""Of each step of the path along the impulse: half of what poses measure twists to. Most steps err by far less."""


def impact_across(
    scene: Scene,
    plane: Plane,
    normal: Vector3,
    body: TwoPointBody,
    before: Twist,
    across: Across,
    angle: float,
    blocked: bool,
) -> tuple[Outcome, Across] | None:
    """The impact of a body that also moves across its plane, and how it does so after it; None where it hardly slips.

    `normal` is the support's, in the body frame, and `angle` how far the body has turned in the plane since. Where its
    contacts are edges its roll is `blocked`.
    """
    # z = ahead cross normal is against the axis.
    velocity, yaw = -across.velocity, across.yaw
    roll = 0.0 if blocked else across.roll
    new, old = body.new, body.old
    slip = abs(velocity + roll * new.y - yaw * new.x)
    if old is not None:
        slip = max(slip, abs(velocity + roll * old.y - yaw * old.x))
    vx, vy, omega = before
    if slip <= SLIPS * hypot(vx - omega * new.y, vy + omega * new.x):
        return None
    c, s = cos(angle), sin(angle)
    upright = combine(c, normal, s, plane.ahead, 0.0, plane.axis)
    yaw_inertia = inertia_about(scene, upright, blocked)
    roll_inertia = inf
    if not blocked:
        roll_inertia = inertia_about(scene, combine(c, plane.ahead, -s, normal, 0.0, plane.axis), blocked)
    motion = Transverse(velocity, roll, yaw, roll_inertia, yaw_inertia)
    outcome, after, _ = solve_transverse_impact(body, before, motion, TOLERANCE, scene.validity)
    return outcome, Across(-after.velocity, across.roll if blocked else after.roll, after.yaw)
