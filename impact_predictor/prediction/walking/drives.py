"""What the joints of a robot and their drives add to its inertia in an impact: `JointDrives`."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...mechanics.articulated import WholeBody
from ..scene import Robot, Scene
from ..types import Bound

Array = NDArray[np.float64]


class JointDrives:
    """The armature and the drives of a robot's joints, in the order of its model.

    Drives with gains oppose the velocities that an impact gives their joints, and the way that these then go. Over a
    contact of T s, in whose first s, the compression, the velocities change evenly by dv, that is the impulse

        (T - s / 2) Kd dv + (T^2 / 2 - T s / 2 + s^2 / 6) Kp dv,

    which acts as an inertia of each joint: the derivation is in docs/walking.md. Where the stiffness of the contact is
    known, T and s are a quarter of an oscillation on it; else they are contact.time and contact.merge.

    Raises:
        InputError: the robot's joints are not those of the model.
    """

    def __init__(self, robot: Robot, joints: Sequence[str]) -> None:
        if robot.joints and sorted(robot.joints) != sorted(joints):
            raise InputError(
                f"robot.joints are {', '.join(robot.joints)}, but {robot.urdf} has the joints {', '.join(joints)}: "
                "name each of these once"
            )
        each = [_in_order(values, robot.joints, joints) for values in (robot.armature, robot.kp, robot.kd)]
        self.armature, self._kp, self._kd = each
        self.are_held = robot.drives == "held"
        self._have_gains = robot.drives == "pd"
        known = self._have_gains or bool(np.any(self.armature))
        self.bound = Bound.UPPER if self.are_held else Bound.ESTIMATE if known else Bound.LOWER
        """What impulses are with them: less is known of the joints, and the legs give way as much, or as little, as
        they can."""

    def inertia(self, body: WholeBody, point: int, normal: Array, scene: Scene) -> tuple[Array | None, float]:
        """The inertia (joints) that gains add where a point of the body is struck along a normal of its base's axes,
        None without gains; and how long the contact lasts, in s.
        """
        if not self._have_gains:
            return None, scene.contact_time
        if not scene.stiffness:
            return self._over(scene.contact_time, min(scene.merge, scene.contact_time)), scene.contact_time

        direction = normal @ body.jacobians[point]

        def next_time(time: float) -> float:
            """A quarter of the oscillation of the mass that the foot has when its contact lasts for another time."""
            mobility = float(direction @ np.linalg.solve(body.inertia_with(self._over(time, time)), direction))
            return 0.5 * pi / sqrt(scene.stiffness * mobility)

        # Mass and time follow from each other: Aitken's extrapolation of two steps errs by some percent at most.
        first = next_time(scene.contact_time)
        time = next_time(first)
        before, step = first - scene.contact_time, time - first
        if abs(step) < abs(before):
            time -= step * step / (step - before)
        return self._over(time, time), time

    def _over(self, whole: float, squeezed: float) -> Array:
        moved = 0.5 * whole * (whole - squeezed) + squeezed * squeezed / 6.0
        return (whole - 0.5 * squeezed) * self._kd + moved * self._kp


def _in_order(values: Sequence[float], names: Sequence[str], joints: Sequence[str]) -> Array:
    """A value for each of the `joints`: of one for all, of values in the order of `names`, or 0."""
    if len(values) < 2:
        return np.full(len(joints), values[0] if values else 0.0)
    return np.array([values[names.index(joint)] for joint in joints])
