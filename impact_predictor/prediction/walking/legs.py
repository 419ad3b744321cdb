"""A machine with joints as a mechanism: where its feet are, and what impulses at them do, from its joint positions."""

from __future__ import annotations

from math import isfinite

import numpy as np

from ...mechanics.articulated import WholeBody
from ..scene import Robot
from ..types import Geometry, Joints, Status, Vector3
from .mechanism import Response


class Articulated:
    """A robot at the joint positions that were told last; its base is the root link of the URDF, `body` its model.

    Raises:
        InputError: see `WholeBody`.
    """

    is_rigid = False

    def __init__(self, robot: Robot) -> None:
        self.body = WholeBody(robot.urdf, robot.frames)
        self.left_out: tuple[str, ...] = ()
        """Joints that were told last and that the model does not know."""
        self._names: tuple[str, ...] = ()
        self._order: list[int] = []
        self._status = Status.NO_GEOMETRY

    def geometry_of(self, joints: Joints) -> Geometry | Status:
        """The contact points of the robot with such joints, and their velocities where the joints have theirs.

        All joints of the model that move must be among them, in any order; others, of an arm or a gripper, are left
        out. Wrong ones, which a status tells, leave the last; where the inertia has no inverse there is no response
        until the next.
        """
        names, positions, velocities = joints.names, joints.positions, joints.velocities
        if len(positions) != len(names) or len(velocities) not in (0, len(names)) or not self._know(names):
            return Status.WRONG_JOINTS
        angles, rates = ([values[i] for i in self._order] for values in (positions, velocities or positions))
        if not all(map(isfinite, (*angles, *rates))):
            return Status.NOT_FINITE
        body = self.body
        self._status = Status.ACCEPTED if body.place(np.array(angles)) else Status.SINGULAR_INERTIA
        if self._status is not Status.ACCEPTED:
            return self._status
        moving = body.velocities(np.array(rates)).tolist() if velocities else ()
        return Geometry(joints.stamp, "", tuple(map(tuple, body.points.tolist())), tuple(map(tuple, moving)))

    def response(
        self,
        old: tuple[int, ...],
        new: tuple[int, ...],
        normal: Vector3,
        ahead: Vector3,
        points: tuple[Vector3, ...],
    ) -> Response | Status:
        """See `Mechanism`; the `points` are the model's own, at the last joint positions."""
        if self._status is not Status.ACCEPTED:
            return self._status
        W, moved = self.body.mobility((old, new), (normal, ahead))
        return Response(tuple(map(tuple, W.tolist())), tuple(map(tuple, moved[:6].tolist())))

    def _know(self, names: tuple[str, ...]) -> bool:
        """Whether each joint of the model is once among the names; then their order is known."""
        if names != self._names:
            if any(names.count(name) != 1 for name in self.body.joints):
                return False
            self._names, self._order = names, [names.index(name) for name in self.body.joints]
            self.left_out = tuple([name for name in names if name not in self.body.joints])
        return True
