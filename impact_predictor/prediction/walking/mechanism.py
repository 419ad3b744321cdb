"""What impulses at its feet do to a machine: one rigid body on legs without mass, or a robot with its joints."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple, Protocol

import numpy as np

from ...errors import InputError
from ..scene import Robot, Scene
from ..types import Geometry, Joints, Status, Vector3
from ..vectors import cross, mean

SINGULAR = 1e-12
"""A principal moment of inertia below this part of the largest one is rounding."""


NOTHING = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class ImpulseResponse(NamedTuple):
    """What unit impulses at two contacts do, in the order n_old, t_old, n_new, t_new.

    `W` (4, 4) = G M^-1 G^T in 1/kg gives the change of the contact velocities; `twist` (6, 4), the base's rows of
    M^-1 G^T, that of the velocity of the base's origin in m/s and of its angular velocity in rad/s, along its axes.
    What belongs to an old contact that there is not is 0.
    """

    W: tuple[tuple[float, ...], ...]
    twist: tuple[tuple[float, ...], ...]


class LeggedMachine(Protocol):
    """A machine with contact points, as its impulses see it; `is_rigid` where its feet move with its base alone."""

    is_rigid: bool

    def response(
        self,
        old: tuple[int, ...],
        new: tuple[int, ...],
        normal: Vector3,
        ahead: Vector3,
        points: tuple[Vector3, ...],
    ) -> ImpulseResponse | Status:
        """The response at the mean of the `old` and at the mean of the `new` points, by their indices.

        `points` are in m in the base's frame, as are the unit vectors `normal` of the support and `ahead`, the
        tangent. Where the machine has none a status says why.
        """


class RigidMachine:
    """One rigid body, the scene's, with its whole inertia tensor; its legs have no mass and are held by their joints.

    Raises:
        InputError: the inertia of the scene has no inverse.
    """

    is_rigid = True

    def __init__(self, scene: Scene) -> None:
        inertia = np.array(scene.inertia)
        moments = np.linalg.eigvalsh(inertia)
        if not moments[0] > SINGULAR * moments[-1]:
            raise InputError(
                f"the inertia {scene.inertia} of the body has no inverse: give one that is positive about every axis"
            )
        inverse = np.linalg.inv(inertia)
        x, y, z = scene.center_of_mass
        center = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
        # An impulse moves the mass centre, whose velocity is that of the base's origin and omega x center.
        moved = center @ inverse
        rows = np.block([[np.eye(3) / scene.mass - moved @ center, moved], [-inverse @ center, inverse]])
        self._inverse_mass: list[list[float]] = rows.tolist()

    def response(
        self,
        old: tuple[int, ...],
        new: tuple[int, ...],
        normal: Vector3,
        ahead: Vector3,
        points: tuple[Vector3, ...],
    ) -> ImpulseResponse | Status:
        rows: list[tuple[float, ...]] = []
        for those in (old, new):
            place = mean([points[i] for i in those]) if those else (0.0, 0.0, 0.0)
            rows += [(*way, *cross(place, way)) if those else NOTHING for way in (normal, ahead)]
        changes = [[_product(line, row) for line in self._inverse_mass] for row in rows]
        W = tuple([tuple([_product(row, change) for change in changes]) for row in rows])
        return ImpulseResponse(W, tuple(zip(*changes, strict=True)))


def _product(u: list[float] | tuple[float, ...], v: list[float] | tuple[float, ...]) -> float:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2] + u[3] * v[3] + u[4] * v[4] + u[5] * v[5]


class ArticulatedMachine:
    """A robot at the joint positions that were told last; its base is the root link of the URDF, `body` its model.

    Raises:
        InputError: see `WholeBody`.
    """

    is_rigid = False

    def __init__(self, robot: Robot) -> None:
        from ...mechanics.articulated import WholeBody  # only where a scene has a robot

        self.body = WholeBody(robot.urdf, robot.frames)
        self.unknown: tuple[str, ...] = ()
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
    ) -> ImpulseResponse | Status:
        """See `LeggedMachine`; the `points` are the model's own, at the last joint positions."""
        if self._status is not Status.ACCEPTED:
            return self._status
        W, moved = self.body.mobility((old, new), (normal, ahead))
        return ImpulseResponse(tuple(map(tuple, W.tolist())), tuple(map(tuple, moved[:6].tolist())))

    def _know(self, names: tuple[str, ...]) -> bool:
        """Whether each joint of the model is once among the names; then their order is known."""
        if names != self._names:
            if any(names.count(name) != 1 for name in self.body.joints):
                return False
            self._names, self._order = names, [names.index(name) for name in self.body.joints]
            self.unknown = tuple([name for name in names if name not in self.body.joints])
        return True
