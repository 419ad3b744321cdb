"""A machine on feet: how its base moves, and what impulses at the feet do to it.

It is one rigid body on legs without mass, or a robot with its joints.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import hypot, isfinite, isnan, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...mechanics.impact.spatial import ContactPoints, solve_body, solve_delassus, solve_spatial_impact
from ...mechanics.types import ContactState, Flag
from ...stamps import NANOSECONDS
from ..planar import GRAZES, ORIGIN, direction_of, hardly
from ..scene import Robot, Scene, six_numbers, triples
from ..types import Bound, Geometry, Joints, Sample, Status, Vector3
from ..vectors import (
    Axes,
    add,
    axes_of,
    cross,
    dot,
    lines,
    rotation_between,
    tensor_to_world,
    times,
    to_body,
    to_world,
    turned,
)

SINGULAR = 1e-12  # a principal moment of inertia below this part of the largest one is rounding
NOTHING = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

SPAN = 50_000_000  # ns over which the acceleration of the base is taken to be constant
LEAST_SPAN = 10_000_000  # ns from which it is told: noise of 0.02 m/s makes 1 m/s^2 of 50 ms, 10 m/s^2 of 10 ms
FEWEST = 5  # samples from which it is told; of a slow source they reach further back
REMEMBERED = 64  # samples that are kept for feet that are told later, and for landings that are noticed later

TwistLine = tuple[tuple[float, ...], tuple[float, ...]]
"""Twist of now and its rate."""


class BaseMotion:
    """The last samples of the base, and how its twist goes on from them."""

    def __init__(self) -> None:
        self.samples: deque[Sample] = deque(maxlen=REMEMBERED)
        self._twists: deque[tuple[int, tuple[float, ...]]] = deque()
        self._line: TwistLine | None = None

    def add(self, sample: Sample) -> None:
        """Take the next sample, in the order of their stamps."""
        self.samples.append(sample)
        twists = self._twists
        twists.append((sample.stamp, twist_of(sample)))
        while len(twists) > FEWEST and twists[0][0] < sample.stamp - SPAN:
            twists.popleft()
        self._line = None

    def begin(self, stamp: int) -> None:
        """Follow no twist from before a stamp in ns: an impact has changed it."""
        while self._twists and self._twists[0][0] <= stamp:
            self._twists.popleft()
        self._line = None

    def at(self, stamp: int) -> Sample:
        """The base at a stamp in ns, between its last samples or beyond them."""
        after = self.samples[-1]
        for before in reversed(self.samples):
            if before.stamp == stamp:
                return before
            if before.stamp < stamp:
                if before is not after:
                    return between(before, after, stamp)
                break
            after = before
        return extrapolated(after, None, (stamp - after.stamp) / NANOSECONDS)._replace(stamp=stamp)

    @property
    def line(self) -> TwistLine | None:
        """The line nearest to the last twists (least squares), at the last of them; None where these are too few.

        A base that turns about a foot gains speed until the next one lands, and a line averages the noise of twists.
        """
        if self._line is None:
            self._line = _line(self._twists)
        return self._line

    def line_until(self, stamp: int) -> TwistLine | None:
        """The line of the twists up to a stamp in ns, at the last of them."""
        return _line([twist for twist in self._twists if twist[0] <= stamp])


def _line(twists: Sequence[tuple[int, tuple[float, ...]]]) -> TwistLine | None:
    if len(twists) < FEWEST or twists[-1][0] - twists[0][0] < LEAST_SPAN:
        return None
    ages = [(stamp - twists[-1][0]) / NANOSECONDS for stamp, _ in twists]
    now, rates = zip(*lines(ages, zip(*[twist for _, twist in twists], strict=True)), strict=True)
    return now, rates


def twist_of(sample: Sample) -> tuple[float, ...]:
    """Linear and angular velocity of a base along the axes of the world."""
    axes = axes_of(sample.orientation)
    return to_world(axes, sample.linear) + to_world(axes, sample.angular)


def extrapolated(sample: Sample, line: TwistLine | None, time: float) -> Sample:
    """A base `time` s after a sample, whose stamp it keeps; its twists lie on a line, or are those that it has."""
    if time == 0.0:
        return sample
    (x, y, z, u, v, w), (a, b, c, p, q, r) = line or (twist_of(sample), NOTHING)
    half = 0.5 * time
    spin = to_body(axes_of(sample.orientation), (u + half * p, v + half * q, w + half * r))
    orientation = turned(sample.orientation, times(spin, time))
    then = axes_of(orientation)
    return sample._replace(
        position=add(sample.position, (x + half * a, y + half * b, z + half * c), time),
        orientation=orientation,
        linear=to_body(then, (x + a * time, y + b * time, z + c * time)),
        angular=to_body(then, (u + p * time, v + q * time, w + r * time)),
    )


def between(before: Sample, after: Sample, stamp: int) -> Sample:
    """A base at a stamp in ns between two samples: twists lie on a line, and the pose turns and bends with them."""
    span = (after.stamp - before.stamp) / NANOSECONDS
    part = (stamp - before.stamp) / (after.stamp - before.stamp)
    bend = 0.5 * part * (1.0 - part) * span
    axes = axes_of(before.orientation)
    gain = add(to_world(axes_of(after.orientation), after.linear), to_world(axes, before.linear), -1.0)
    spin = add(after.angular, before.angular, -1.0)
    place = add(before.position, add(after.position, before.position, -1.0), part)
    rotation = add(times(rotation_between(before.orientation, after.orientation), part), spin, -bend)
    return before._replace(
        stamp=stamp,
        position=add(place, gain, -bend),
        orientation=turned(before.orientation, rotation),
        linear=add(before.linear, add(after.linear, before.linear, -1.0), part),
        angular=add(before.angular, spin, part),
    )


class MachineOutcome(NamedTuple):
    """What an impact does to a machine: the fields of a `SpatialOutcome`, the bound that it is, and of a robot more.

    `jumps` are the changes of the joint velocities (rad/s or m/s), `drives` is the part of the impulses' work that the
    drives oppose, 0 to 1.
    """

    twist: NDArray[np.float64]
    impulses: NDArray[np.float64]
    velocities: NDArray[np.float64]
    states: tuple[ContactState, ...]
    flags: Flag
    energy_lost: float
    law: str
    bound: Bound
    jumps: tuple[float, ...] = ()
    drives: float = 0.0


class RigidMachine:
    """One rigid body, the scene's, with its whole inertia tensor; its legs have no mass and are held by their joints.

    Raises:
        InputError: the inertia of the scene has no inverse.
    """

    is_rigid = True
    """Whether the feet move with the base alone."""
    joints: tuple[str, ...] = ()

    def __init__(self, scene: Scene) -> None:
        moments = np.linalg.eigvalsh(np.array(scene.inertia))
        if not moments[0] > SINGULAR * moments[-1]:
            raise InputError(
                f"the inertia {scene.inertia} of the body has no inverse: give one that is positive about every axis"
            )
        self._scene = scene
        # What can be compiled is compiled before the first landing.
        axes = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        self.struck([0], ContactPoints([ORIGIN], [0.0], [0.0], velocities=[ORIGIN], gaps=[0.0]), axes, scene)

    def struck(
        self,
        points: list[int],
        contacts: ContactPoints,
        axes: Axes,
        scene: Scene,
        pulls: Sequence[Vector3] = (),
    ) -> MachineOutcome | Status:
        """What an impact at some points of the feet does to the machine; a status where it has no response.

        The `contacts`, with one normal and each with its own numbers else, are told from the base's origin, as if the
        machine were at rest and the support came with the velocities of the feet; they and the outcome are along the
        axes of the world, those of the base are `axes`.
        The twist of the outcome is the change of that of the base, at its origin. The `scene` has normal and law. Each
        contact gains as many m/s in a second as `pulls` have: what lasts for some time is not over before they show.
        """
        center = to_world(axes, self._scene.center_of_mass)
        problem = [self._scene.mass, *six_numbers(tensor_to_world(axes, self._scene.inertia)), *NOTHING]
        told: Any = contacts
        each = zip(told.positions, told.friction, told.restitution, told.velocities, told.gaps, strict=True)
        for place, friction, restitution, velocity, gap in each:
            problem += (*add(place, center, -1.0), *told.normals, friction, restitution, *velocity, gap)
        found = solve_body(np.array(problem), scene.law, scene.merge, GRAZES)
        assert found.twist is not None
        x, y, z, p, q, r = found.twist.tolist()
        found.twist[:3] = add((x, y, z), cross((p, q, r), center), -1.0)
        return MachineOutcome(
            twist=found.twist,
            impulses=found.impulses,
            velocities=found.velocities,
            states=found.states,
            flags=found.flags,
            energy_lost=found.energy_lost,
            law=found.law,
            bound=Bound.UPPER,
        )


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
        self._names: tuple[str, ...] = ()
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
        return MachineOutcome(
            twist=(change[:6].reshape(2, 3) @ np.array(axes)).ravel(),
            impulses=impulses @ ways,
            velocities=found.velocities @ ways,
            states=tuple(states),
            flags=found.flags,
            energy_lost=-0.5 * float(pushed @ (start + after)),
            law=found.law,
            bound=drives.bound,
            jumps=tuple(jumps.tolist()),
            drives=opposed,
        )

    def _know(self, names: tuple[str, ...]) -> bool:
        """Whether each joint of the model is once among the names; then their order is known."""
        if names != self._names:
            if any(names.count(name) != 1 for name in self.body.joints):
                return False
            self._names, self._order = names, [names.index(name) for name in self.body.joints]
            self.unknown = tuple([name for name in names if name not in self.body.joints])
        return True


LeggedMachine = RigidMachine | ArticulatedMachine
