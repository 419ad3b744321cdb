"""The impact of a body that the samples show to slip across its impact plane."""

from __future__ import annotations

from math import cos, hypot, inf, sin

from ..mechanics.transverse import Transverse, slip_across, solve_transverse_impact
from ..mechanics.types import Outcome, Twist, TwoPointBody
from .planar import Across, Plane, inertia_about
from .scene import Scene
from .types import Vector3
from .vectors import combine

SLIPS = 0.05
"""A body slips across its plane from this part of the speed of its new contact in the plane: less changes the twist of
a landing cube by less than 0.006 of that speed, and poses measure it to 0.01."""

TOLERANCE = 1e-3
"""Of the path along the impulse: a tenth of what twists are measured to."""


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
    motion = Transverse(-across.velocity, 0.0 if blocked else across.roll, across.yaw)
    slip = abs(slip_across(body.new, motion))
    if body.old is not None:
        slip = max(slip, abs(slip_across(body.old, motion)))
    vx, vy, omega = before
    if slip <= SLIPS * hypot(vx - omega * body.new.y, vy + omega * body.new.x):
        return None
    c, s = cos(angle), sin(angle)
    upright = combine(c, normal, s, plane.ahead, 0.0, plane.axis)
    yaw_inertia = inertia_about(scene, upright, blocked)
    roll_inertia = inf
    if not blocked:
        roll_inertia = inertia_about(scene, combine(c, plane.ahead, -s, normal, 0.0, plane.axis), blocked)
    motion = motion._replace(roll_inertia=roll_inertia, yaw_inertia=yaw_inertia)
    outcome, after, _ = solve_transverse_impact(body, before, motion, TOLERANCE)
    return outcome, Across(-after.velocity, across.roll if blocked else after.roll, after.yaw)
