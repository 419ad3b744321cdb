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

    which acts as an inertia of each joint: the derivation is in docs/walking.md.

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

    def inertia(self, body: WholeBody, direction: Array, scene: Scene) -> Array | None:
        """The inertia (joints) that gains add, where a point of the body is struck; None without gains.

        `direction` (n,) is the row of the generalized velocities that the blow stops, the point's along the normal.
        """
        if not self._have_gains:
            return None
        if not scene.stiffness:
            return self._over(scene.contact_time, min(scene.merge, scene.contact_time))

        def next_time(squeezed: float) -> float:
            """The time of the compression, from the mass that the foot has with another one."""
            inertia = body.inertia_with(self._over(max(scene.contact_time, squeezed), squeezed))
            mobility = float(direction @ np.linalg.solve(inertia, direction))
            return 0.5 * pi / sqrt(scene.stiffness * mobility)

        # Mass and time follow from each other: Aitken's extrapolation of two steps errs by some percent at most.
        first = next_time(scene.contact_time)
        second = next_time(first)
        before, step = first - scene.contact_time, second - first
        squeezed = second - step * step / (step - before) if abs(step) < abs(before) else second
        return self._over(max(scene.contact_time, squeezed), squeezed)

    def _over(self, whole: float, squeezed: float) -> Array:
        moved = 0.5 * whole * (whole - squeezed) + squeezed * squeezed / 6.0
        return (whole - 0.5 * squeezed) * self._kd + moved * self._kp


def _in_order(values: Sequence[float], names: Sequence[str], joints: Sequence[str]) -> Array:
    """A value for each of the `joints`: of one for all, of values in the order of `names`, or 0."""
    if len(values) < 2:
        return np.full(len(joints), values[0] if values else 0.0)
    return np.array([values[names.index(joint)] for joint in joints])
