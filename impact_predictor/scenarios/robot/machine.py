"""Robots as MuJoCo has them: a URDF with feet, drives and a ground."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from math import cos, sin
from typing import Any, Final, NamedTuple

import numpy as np

from ...errors import InputError
from .description import RobotFiles, Values, ball_of, posture_of, read_xml, simplify
from .ground import SimulatedGround

STEP: Final = 1.0 / 4000.0
"""Seconds of a step of the physics."""

STIFFNESS: Final = 16.0
"""Of the drives, in m g h to a rad, weight times standing height, for all feet together."""

DAMPING: Final = 0.03
"""Of the drives, in s: their gain on velocities over that on positions."""

ARMATURE: Final = 0.011
"""What a drive weighs at its joint, in m h^2: about 0.01 kg m^2 for a robot of 13 kg that stands 0.26 m high."""

BEND: Final = 0.6
"""rad by which joints are bent, the way in which their limits allow more, where no posture is known."""

SQUAT: Final = 0.15
"""The part of the length of the straight legs by which such a robot squats."""

_REACHED: Final = 1e-7


class Physics(NamedTuple):
    """How drives and ground behave: `armature` (kg m^2 or kg) of every joint, None for that of a robot of its size;
    friction coefficient; `contact_time`, the time constant in s with which a contact is stopped (MuJoCo's solref).
    """

    armature: float | None = None
    friction: float = 0.8
    contact_time: float = 0.002


class Machine:
    """A robot that MuJoCo moves over a ground.

    `joints` are the names of those that are driven, `feet` the links of the feet; `base` is the name of the URDF's root
    link, `mass` in kg; `height` in m of its origin over the soles in its `posture` (joint positions in rad or m).
    InputError where the files are not those of a robot with these feet.
    """

    def __init__(self, robot: RobotFiles, ground: SimulatedGround, physics: Physics) -> None:
        import mujoco

        self.mujoco: Any = mujoco
        self.files, self.feet, self.physics = robot, robot.feet, physics
        tree = read_xml(robot.urdf)
        self.sole = robot.sole or ball_of(tree, robot)
        self._spec = self._specified(tree, ground)
        root = self._spec.worldbody.first_body()
        self.base: str = root.name
        root.add_freejoint(name="")
        hinge, slide = (getattr(self.mujoco.mjtJoint, f"mjJNT_{name}") for name in ("HINGE", "SLIDE"))
        moving = [joint for joint in self._spec.joints if joint.type in (hinge, slide)]
        self.joints = tuple([joint.name for joint in moving])
        self._compile()
        self.mass = float(self.model.body_mass.sum())
        self.posture = self._bent() if robot.srdf is None else posture_of(robot.srdf, self.joints)
        self.height = float(-self.at_rest(self.posture)[:, :, 2].mean() + self.sole.radius)
        armature, weight = physics.armature, self.mass * 9.81 * self.height
        self.armature = ARMATURE * self.mass * self.height**2 if armature is None else armature
        stiffness = STIFFNESS * weight / len(robot.feet)
        self.gains = stiffness, DAMPING * stiffness
        for joint in moving:
            joint.armature = self.armature
            self._drive(joint.name)
        self._compile()

    def at_rest(self, positions: Values) -> Values:
        """The points of the soles (feet, points, 3) in the base's frame, at joint positions."""
        data = self.data
        data.qpos[:7], data.qpos[self.places] = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), positions
        self.mujoco.mj_kinematics(self.model, data)
        self.mujoco.mj_comPos(self.model, data)
        return self.soles()

    def soles(self) -> Values:
        """The points of the soles (feet, points, 3) where the data are placed now."""
        turned = self.data.xmat[self.bodies].reshape(-1, 3, 3)
        points: Values = self.data.xpos[self.bodies][:, None] + np.einsum("fij,pj->fpi", turned, self.sole.points)
        return points

    def reach(self, targets: Values, start: Values) -> Values:
        """The joint positions nearest to `start` that put the soles' points at targets (feet, points, 3) in the base's
        frame, by damped least squares.
        """
        positions, flat = start.copy(), self.sole.radius == 0.0
        towards = np.zeros((3, self.model.nv))
        about = np.zeros((3, self.model.nv))
        for _ in range(100):
            miss = targets - self.at_rest(positions)
            rows, wanted = [], []
            for body, missed in zip(self.bodies, miss, strict=True):
                self.mujoco.mj_jacBody(self.model, self.data, towards, about, body)
                rows.append(towards[:, self.rates].copy())
                wanted.append(missed.mean(axis=0))
                if flat:
                    # The sole stays level, and points ahead.
                    turned = self.data.xmat[body].reshape(3, 3)
                    rows.append(about[:, self.rates].copy())
                    wanted.append(0.5 * np.cross(turned, np.eye(3), axisa=0, axisb=0).sum(axis=0))
            error = np.concatenate(wanted)
            if np.abs(error).max() < _REACHED:
                break
            jacobian = np.concatenate(rows)
            square = jacobian @ jacobian.T + 1e-8 * np.eye(len(error))
            positions = positions + np.clip(jacobian.T @ np.linalg.solve(square, error), -0.2, 0.2)
        return positions

    def sag(self, positions: Values, shares: Values, slope: float) -> Values:
        """How much further the joints (rad or m) have to be told to go, so that they carry the weight there.

        Each foot carries its part (feet,) of the weight, the base inclined by a `slope` in rad.
        """
        self.at_rest(positions)
        pulled, towards = np.zeros(len(self.joints)), np.zeros((3, self.model.nv))
        weight = self.mass * 9.81 * np.array([sin(slope), 0.0, cos(slope)])
        for body, share in zip(self.bodies, shares, strict=True):
            self.mujoco.mj_jacBody(self.model, self.data, towards, None, body)
            pulled -= share * weight @ towards[:, self.rates]
        return pulled / self.gains[0]

    def inertia(self) -> tuple[Values, Values]:
        """With all joints locked in its posture: mass centre (3,) in the base's frame, and inertia (3, 3) about it."""
        self.at_rest(self.posture)
        data, masses = self.data, self.model.body_mass
        center: Values = masses @ data.xipos / self.mass
        found = np.zeros((3, 3))
        for mass, place, turned, own in zip(
            masses, data.xipos, data.ximat.reshape(-1, 3, 3), self.model.body_inertia, strict=True
        ):
            lever = place - center
            found += turned * own @ turned.T + mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
        return center, found

    def _specified(self, tree: ET.Element, ground: SimulatedGround) -> Any:
        """The specification of robot and ground; feet alone touch the ground."""
        mujoco, physics = self.mujoco, self.physics
        simplify(tree)
        try:
            spec = mujoco.MjSpec.from_string(ET.tostring(tree, encoding="unicode"))
        except ValueError as error:
            raise InputError(f"{self.files.urdf} is not a URDF that MuJoCo can read: {error}") from error
        spec.option.timestep, spec.option.impratio = STEP, 10.0
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        half = -0.5 * ground.slope
        plane = mujoco.mjtGeom.mjGEOM_PLANE
        place = {"pos": [0.0, 0.0, ground.floor], "quat": [cos(half), 0.0, sin(half), 0.0]}
        geoms = [spec.worldbody.add_geom(type=plane, size=[0, 0, 1], **place)]
        box = mujoco.mjtGeom.mjGEOM_BOX
        for x, y, length, width, top in ground.boxes:
            half_height = 0.5 * (top - ground.floor)
            size = [0.5 * length, 0.5 * width, half_height]
            geoms.append(spec.worldbody.add_geom(type=box, pos=[x, y, ground.floor + half_height], size=size))
        for geom in geoms:
            geom.contype, geom.conaffinity = 1, 2
        for foot in self.feet:
            body = spec.body(foot)
            if body is None:
                raise InputError(f"{self.files.urdf} has no link {foot!r}; --feet names the links of the feet")
            geoms.append(body.add_geom(**self._shape(foot), contype=2, conaffinity=1, mass=0.0))
        for geom in geoms:
            geom.friction, geom.condim = [physics.friction, 0.0, 0.0], 3
            geom.solref, geom.solimp = [physics.contact_time, 1.0], [0.02, 0.98, 0.001, 0.5, 2.0]
        return spec

    def _shape(self, foot: str) -> dict[str, Any]:
        radius, heel, toe, width = self.sole
        if radius > 0.0:
            return {"name": f"sole of {foot}", "type": self.mujoco.mjtGeom.mjGEOM_SPHERE, "size": [radius, 0.0, 0.0]}
        thick = 0.1 * (toe - heel)
        return {
            "name": f"sole of {foot}",
            "type": self.mujoco.mjtGeom.mjGEOM_BOX,
            "size": [0.5 * (toe - heel), 0.5 * width, 0.5 * thick],
            "pos": [0.5 * (heel + toe), 0.0, 0.5 * thick],
        }

    def _drive(self, joint: str) -> None:
        """A drive that pulls a joint to a position, with a damping that the integrator takes implicitly."""
        mujoco, (stiffness, damping) = self.mujoco, self.gains
        drive = self._spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        drive.gaintype, drive.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        drive.gainprm[0], drive.biasprm[1], drive.biasprm[2] = stiffness, -stiffness, -damping

    def _compile(self) -> None:
        try:
            self.model = self._spec.compile()
        except ValueError as error:
            raise InputError(f"MuJoCo cannot move {self.files.urdf}: {' '.join(str(error).split())}") from error
        self.data = self.mujoco.MjData(self.model)
        self.places = np.array([self.model.joint(name).qposadr[0] for name in self.joints])
        self.rates = np.array([self.model.joint(name).dofadr[0] for name in self.joints])
        self.bodies = np.array([self.model.body(foot).id for foot in self.feet])
        self.geoms = {self.model.geom(f"sole of {foot}").id: number for number, foot in enumerate(self.feet)}

    def _bent(self) -> Values:
        """A posture with bent legs: the feet below where straight legs have them, the joints bent as limits allow."""
        straight = np.zeros(len(self.joints))
        hips = [self._hip(body) for body in self.bodies]
        targets = self.at_rest(straight)
        for target, hip in zip(targets, hips, strict=True):
            target[:, 2] += SQUAT * (self.data.xpos[hip][2] - target[:, 2])
        limits = np.array([self.model.joint(name).range for name in self.joints])
        bent = BEND * np.sign(np.round(limits.sum(axis=1), 3))
        return self.reach(targets, bent)

    def _hip(self, body: int) -> int:
        """The first link of a leg, by its foot."""
        while self.model.body_parentid[self.model.body_parentid[body]] != 1 and self.model.body_parentid[body] > 1:
            body = int(self.model.body_parentid[body])
        return body
