"""What impulses at the feet of a robot do to it, with its joints."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, isfinite, isnan, nan

import numpy as np

from ...mechanics.impact.spatial import ContactPoints, solve_delassus, solve_spatial_impact
from ...mechanics.types import ContactState
from ..planar import GRAZES, ORIGIN, direction_of, hardly
from ..scene import Robot, Scene, triples
from ..types import Bound, Geometry, Joints, Status, Vector3
from ..vectors import Axes, cross, dot, times, to_body
from .base import NOTHING
from .machine import MachineOutcome, RigidMachine


class ArticulatedMachine:
    """A robot at the joint positions that were told last; its base is the root link of the URDF, `body` its model.

    Raises:
        InputError: see `WholeBody` and `JointDrives`.
    """

    is_rigid = False

    def __init__(self, robot: Robot, radii: Sequence[float] = ()) -> None:
        # Only where a scene has a robot.
        from ...mechanics.articulated import WholeBody
        from .drives import JointDrives

        self.body = WholeBody(robot.urdf, robot.frames, radii, triples(robot.soles))
        self.joints = self.body.joints
        self._drives = JointDrives(robot, self.joints)
        self.body.armature = self._drives.armature
        self.unknown: tuple[str, ...] = ()
        """Joints that were told last and that the model does not know."""
        self.doubt = ""
        """What speaks against the joint positions that were told last."""
        self._names: tuple[str, ...] | None = None
        self._order: list[int] = []
        self._status = Status.NO_GEOMETRY
        solve_spatial_impact(np.eye(3), ContactPoints([ORIGIN], 0.0), NOTHING[:3])  # compiled as that of RigidMachine

    def geometry_of(self, joints: Joints, down: Vector3 = (0.0, 0.0, -1.0)) -> Geometry | Status:
        """The contact points of the robot with such joints, and their velocities where the joints have theirs.

        All joints of the model that move must be among them, in any order; others, of an arm or a gripper, are left
        out. Wrong ones, which a status tells, leave the last; where the inertia has no inverse there is no response
        until the next.
        The ground lies `down` from the feet, along the base's axes.
        """
        names, positions, velocities = joints.names, joints.positions, joints.velocities
        if len(positions) != len(names) or len(velocities) not in (0, len(names)) or not self._know(names):
            return Status.WRONG_JOINTS
        angles, rates = ([values[i] for i in self._order] for values in (positions, velocities or positions))
        if any(map(isnan, rates)):  # what a driver tells that does not measure them
            velocities, rates = (), angles
        if not all(map(isfinite, (*angles, *rates))):
            return Status.NOT_FINITE
        body = self.body
        self.doubt = self._beyond(angles)
        self._status = Status.ACCEPTED if body.place(np.array(angles), down) else Status.SINGULAR_INERTIA
        if self._status is not Status.ACCEPTED:
            return self._status
        moving = body.velocities(np.array(rates)).tolist() if velocities else ()
        return Geometry(joints.stamp, "", tuple(map(tuple, body.points.tolist())), tuple(map(tuple, moving)))

    def forces_of(self, joints: Joints, gravity: Vector3) -> list[Vector3] | None:
        """Forces in N on the contact points by the efforts of the joints that were placed last (see `WholeBody`).

        Those and `gravity` are along the base's axes. None where the efforts are missing.
        """
        efforts = [joints.efforts[i] for i in self._order] if len(joints.efforts) == len(joints.names) else [nan]
        if not all(map(isfinite, efforts)):
            return None
        return [(x, y, z) for x, y, z in self.body.foot_forces(np.array(efforts), gravity).tolist()]

    def struck(
        self,
        points: list[int],
        contacts: ContactPoints,
        axes: Axes,
        scene: Scene,
        pulls: Sequence[Vector3] = (),
    ) -> MachineOutcome | Status:
        """See `RigidMachine`; the contacts are where the model has them, at the last joint positions."""
        if self._status is not Status.ACCEPTED:
            return self._status
        first, drives = direction_of(scene.normal, []), self._drives
        frame = first, cross(scene.normal, first), scene.normal
        ways, local = np.array(frame), np.array([to_body(axes, way) for way in frame])
        c = -(np.asarray(contacts.velocities, float) @ ways.T)
        added, time = drives.inertia(self.body, points[int(c[:, 2].argmin())], local[2], scene)
        W, moved = self.body.mobility(points, local, added, drives.are_held)
        law, merge, load, each = scene.law, scene.merge, np.zeros(c.shape), np.empty((3, len(points)))
        each[0], each[1], each[2] = contacts.friction, contacts.restitution, contacts.gaps
        rests = [i for i, row in enumerate(c.tolist()) if not any(row)]
        if drives.bound is Bound.ESTIMATE and len(rests) < len(points):
            # What stands carries the weight as long as the impact lasts: a small blow takes off a part of that load,
            # and lifts nothing. Load and blow go on together, so that the law is that of the whole impulse, to which
            # belong the compressions that end in that time.
            weight = [dot(way, scene.gravity) * (-scene.mass * time / max(len(rests), 1)) for way in frame]
            if pulls:
                c += [[0.0] * 3 if i in rests else to_body(frame, times(pull, time)) for i, pull in enumerate(pulls)]
            for i in rests:
                load[i], each[1, i] = weight, 0.0
            law, merge = "total", max(merge, time - merge)
        start = c.ravel()
        found = solve_delassus(W, each[0], each[1], each[2], start - W @ load.ravel(), law, merge, GRAZES)
        impulses, after = found.impulses - load, found.velocities.ravel()
        pushed = impulses.ravel()
        change, given = moved @ pushed, pushed @ (after - start)
        jumps = change[6:]
        # What slips no faster than gravity moves it in a contact time hardly slips: its load stops it.
        least = hardly(scene) if drives.bound is Bound.ESTIMATE else 0.0
        states = [
            ContactState.STICKS if one is ContactState.SLIPS and hypot(x, y) <= least else one
            for one, (x, y, _) in zip(found.states, found.velocities.tolist(), strict=True)
        ]
        opposed = 0.0 if added is None or given <= 0.0 else float(added @ (jumps * jumps) / given)
        impact = found._replace(
            twist=(change[:6].reshape(2, 3) @ np.array(axes)).ravel(),
            impulses=impulses @ ways,
            velocities=found.velocities @ ways,
            states=tuple(states),
            energy_lost=-0.5 * float(pushed @ (start + after)),
        )
        return MachineOutcome(
            impact=impact,
            bound=drives.bound,
            jumps=tuple(jumps.tolist()),
            drives=opposed,
        )

    def _beyond(self, angles: Sequence[float]) -> str:
        """Which joint is further beyond its limits than these are apart, as one that is told in degrees."""
        for i, low, high in self.body.limits:
            if not 2.0 * low - high <= angles[i] <= 2.0 * high - low:
                return (
                    f"joint {self.joints[i]} is told at {angles[i]:.4g}, but robot.urdf lets it go from {low:.4g} to "
                    f"{high:.4g}: compare the units (rad, m) and the zeros of the joints"
                )
        return ""

    def _know(self, names: tuple[str, ...]) -> bool:
        """Whether each joint of the model is once among the names; then their order is known."""
        if names != self._names:
            if any(names.count(name) != 1 for name in self.body.joints):
                return False
            self._names, self._order = names, [names.index(name) for name in self.body.joints]
            self.unknown = tuple([name for name in names if name not in self.body.joints])
        return True


LeggedMachine = RigidMachine | ArticulatedMachine
