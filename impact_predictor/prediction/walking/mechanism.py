"""A machine on feet: how its base moves, and what impulses at the feet do to it.

It is one rigid body on legs without mass, or a robot with its joints.
"""

from __future__ import annotations

from collections import deque
from math import isfinite
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ...stamps import NANOSECONDS
from ..scene import Robot, Scene
from ..types import Geometry, Joints, Sample, Status, Vector3
from ..vectors import add, axes_of, cross, lines, mean, times, to_body, to_world, turned

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
        """The base at a stamp in ns, from the nearest of its last samples; the older of two that are equally near."""
        near = self.samples[-1]
        for sample in reversed(self.samples):
            if abs(sample.stamp - stamp) > abs(near.stamp - stamp):
                break
            near = sample
        if near.stamp == stamp:
            return near
        return extrapolated(near, None, (stamp - near.stamp) / NANOSECONDS)._replace(stamp=stamp)

    @property
    def line(self) -> TwistLine | None:
        """The line nearest to the last twists (least squares), at the last of them; None where these are too few.

        A base that turns about a foot gains speed until the next one lands, and a line averages the noise of twists.
        """
        twists = self._twists
        if self._line is None and len(twists) >= FEWEST and twists[-1][0] - twists[0][0] >= LEAST_SPAN:
            ages = [(stamp - twists[-1][0]) / NANOSECONDS for stamp, _ in twists]
            found = lines(ages, zip(*[twist for _, twist in twists], strict=True))
            self._line = tuple([now for now, _ in found]), tuple([rate for _, rate in found])
        return self._line


def twist_of(sample: Sample) -> tuple[float, ...]:
    """Linear and angular velocity of a base along the axes of the world."""
    axes = axes_of(sample.orientation)
    return to_world(axes, sample.linear) + to_world(axes, sample.angular)


def extrapolated(sample: Sample, line: TwistLine | None, time: float) -> Sample:
    """A base `time` s after a sample, whose stamp it keeps; its twists lie on a line, or are those that it has."""
    if line is None and time == 0.0:
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


class ImpulseResponse(NamedTuple):
    """What unit impulses at two contacts do, in the order n_old, t_old, n_new, t_new.

    `W` (4, 4) = G M^-1 G^T in 1/kg gives the change of the contact velocities; `twist` (6, 4), the base's rows of
    M^-1 G^T, that of the velocity of the base's origin in m/s and of its angular velocity in rad/s, along its axes.
    What belongs to an old contact that there is not is 0.
    """

    W: tuple[tuple[float, ...], ...]
    twist: tuple[tuple[float, ...], ...]


class RigidMachine:
    """One rigid body, the scene's, with its whole inertia tensor; its legs have no mass and are held by their joints.

    Raises:
        InputError: the inertia of the scene has no inverse.
    """

    is_rigid = True
    """Whether the feet move with the base alone."""

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
        self, old: tuple[int, ...], new: tuple[int, ...], normal: Vector3, ahead: Vector3, points: tuple[Vector3, ...]
    ) -> ImpulseResponse | Status:
        """The response at the mean of the `old` and at the mean of the `new` points, by their indices.

        `points` are in m in the base's frame, as are the unit vectors `normal` of the support and `ahead`, the
        tangent. Where the machine has none a status says why.
        """
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
        self, old: tuple[int, ...], new: tuple[int, ...], normal: Vector3, ahead: Vector3, points: tuple[Vector3, ...]
    ) -> ImpulseResponse | Status:
        """See `RigidMachine`; the `points` are the model's own, at the last joint positions."""
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


LeggedMachine = RigidMachine | ArticulatedMachine
