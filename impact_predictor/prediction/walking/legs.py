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

    def __init__(self, robot: Robot) -> None:
        self.body = WholeBody(robot.urdf, robot.frames)
        self._names: tuple[str, ...] = ()
        self._order: list[int] = []
        self._status = Status.NO_GEOMETRY

    def geometry_of(self, joints: Joints) -> Geometry | Status:
        """The contact points of the robot with such joints, and their velocities where the joints have theirs.

        Their names are those of all joints of the model that move, in any order. Wrong ones, which a status tells,
        leave the last; where the inertia has no inverse there is no response until the next.
        """
        status = self._check(joints)
        if status is not Status.ACCEPTED:
            return status
        body, order = self.body, self._order
        self._status = status if body.place(np.array(joints.positions)[order]) else Status.SINGULAR_INERTIA
        if self._status is not Status.ACCEPTED:
            return self._status
        velocities = body.velocities(np.array(joints.velocities)[order]).tolist() if joints.velocities else ()
        return Geometry(joints.stamp, "", tuple(map(tuple, body.points.tolist())), tuple(map(tuple, velocities)))

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

    def _check(self, joints: Joints) -> Status:
        names, positions, velocities = joints.names, joints.positions, joints.velocities
        if len(positions) != len(names) or len(velocities) not in (0, len(names)):
            return Status.WRONG_JOINTS
        if names != self._names:
            if sorted(names) != sorted(self.body.joints):
                return Status.WRONG_JOINTS
            self._names, self._order = names, [names.index(name) for name in self.body.joints]
        return Status.ACCEPTED if all(map(isfinite, (*positions, *velocities))) else Status.NOT_FINITE
