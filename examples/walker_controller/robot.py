"""Solo12 in MuJoCo on uneven ground, pushed now and then: what moves it, what it measures, what its feet feel.

The robot is the URDF of example-robot-data with balls for feet and drives that make the torque they are told. It
measures as a real one does: trunk and feet with noise, contacts late.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections import deque
from importlib.util import find_spec
from pathlib import Path
from typing import Final, NamedTuple

import mujoco
import numpy as np
from controller import FEET, TICK, Array, Command, Measured

MODEL: Final = "cmeel.prefix/share/example-robot-data/robots/solo_description/robots/solo12.urdf"
STEPS: Final = 4
"""Steps of the physics in a tick of the controller."""
RADIUS: Final = 0.016
"""m, of the balls that are the feet."""
ARMATURE: Final = 4e-4
"""kg m^2, of each drive's rotor, seen from its joint."""
LARGEST_TORQUE: Final = 2.7
STIFFNESS, DAMPING = 5e4, 60.0
"""N/m and N s/m of the ground."""
STANCE: Final = (0.0, 0.8, -1.6)
LATENCY: Final = 3
"""Ticks that a command takes to the drives, 6 ms."""
DEBOUNCE: Final = 6
"""Ticks that a foot must feel the ground before its sensor says so, 12 ms."""
FELT: Final = 2.0
"""N that its sensor feels."""


class Trial(NamedTuple):
    """What one walk meets: heights of the slabs (m), pushes on the trunk as ticks with forces (N) and moments (N m)."""

    seed: int
    heights: Array
    pushes: tuple[tuple[int, Array], ...]


class Noise(NamedTuple):
    """Standard deviations of what the robot measures, white in each sample, in SI units."""

    position: float = 0.001
    velocity: float = 0.02
    tilt: float = 0.002
    rate: float = 0.01
    foot: float = 0.0002
    foot_velocity: float = 0.02


NOISE: Final = Noise()


class Robot:
    """The simulated robot on the ground of a trial."""

    def __init__(self, trial: Trial, noise: Noise = NOISE) -> None:
        self.model = _model(trial)
        self.data = mujoco.MjData(self.model)
        self._noise, self._random = noise, np.random.default_rng([7, trial.seed])
        self._pushes = deque(trial.pushes)
        self._push, self._push_ends = np.zeros(6), 0
        self._feet = [self.model.body(f"{foot}_FOOT").id for foot in FEET]
        self._leg = np.array(
            [[self.model.joint(f"{foot}_{part}").dofadr[0] for part in ("HAA", "HFE", "KFE")] for foot in FEET]
        )
        self._balls = {self.model.geom(f"{foot}_ball").id: i for i, foot in enumerate(FEET)}
        self._trunk = self.model.body("base_link").id
        self.mass = float(self.model.body_subtreemass[self._trunk])
        self.ticks = 0
        self._told: deque[list[Command]] = deque(maxlen=LATENCY + 1)
        self._felt = [0] * 4
        self.forces = np.zeros((STEPS, 4))
        """Normal force on each foot in the steps of the last tick, N."""
        data = self.data
        data.qpos[7:] = STANCE * 4
        mujoco.mj_forward(self.model, data)
        lowest = min(data.xpos[foot][2] for foot in self._feet)
        data.qpos[2] = RADIUS - lowest + max(0.0, float(trial.heights[:3].max()))
        mujoco.mj_forward(self.model, data)

    def tick(self, commands: list[Command]) -> None:
        """Go on for a tick; the drives follow what they were told some ticks ago."""
        model, data = self.model, self.data
        self._told.append(commands)
        feet, velocities, jacobians = self._legs()
        torques = np.empty((4, 3))
        for i, told in enumerate(self._told[0]):
            pull = told.stiffness * (told.reference - feet[i]) + told.damping * (told.moves - velocities[i])
            torques[i] = jacobians[i].T @ (pull + told.force)
        if self._pushes and self._pushes[0][0] <= self.ticks:
            at, self._push = self._pushes.popleft()
            self._push_ends = at + 25
        data.xfrc_applied[self._trunk] = self._push if self.ticks < self._push_ends else 0.0
        data.qfrc_applied[self._leg.ravel()] = np.clip(torques.ravel(), -LARGEST_TORQUE, LARGEST_TORQUE)
        wrench = np.zeros(6)
        for step in range(STEPS):
            mujoco.mj_step(model, data)
            self.forces[step] = 0.0
            for i in range(data.ncon):
                pair = data.contact[i].geom
                foot = self._balls.get(int(pair[0]), self._balls.get(int(pair[1])))
                if foot is not None:
                    mujoco.mj_contactForce(model, data, i, wrench)
                    self.forces[step, foot] += wrench[0]
        self.ticks += 1
        for i in range(4):
            self._felt[i] = self._felt[i] + 1 if self.forces[-1, i] > FELT else 0

    @property
    def fallen(self) -> bool:
        """Whether the trunk is down or has turned over."""
        return bool(
            self.data.qpos[2] < 0.12 or self.data.xmat[self._trunk][8] < 0.7 or not np.isfinite(self.data.qpos[2])
        )

    def measure(self) -> Measured:
        """What the robot measures now."""
        data, noise, random = self.data, self._noise, self._random
        true = data.xmat[self._trunk].reshape(3, 3)
        x, y, z = random.normal(0.0, noise.tilt, 3)
        axes = true @ np.array([[1.0, -z, y], [z, 1.0, -x], [-y, x, 1.0]])
        axes /= np.linalg.norm(axes, axis=0)
        feet, velocities, _ = self._legs()
        return Measured(
            tick=self.ticks,
            position=data.qpos[:3] + random.normal(0.0, noise.position, 3),
            velocity=data.qvel[:3] + random.normal(0.0, noise.velocity, 3),
            axes=axes,
            spin=true @ data.qvel[3:6] + random.normal(0.0, noise.rate, 3),
            feet=feet + random.normal(0.0, noise.foot, (4, 3)),
            feet_velocity=velocities + random.normal(0.0, noise.foot_velocity, (4, 3)),
            felt=tuple(count >= DEBOUNCE for count in self._felt),
        )

    def _legs(self) -> tuple[Array, Array, Array]:
        """Where the lowest points of the feet are, how they move, and by which Jacobians, along the trunk's axes."""
        data = self.data
        true = data.xmat[self._trunk].reshape(3, 3)
        feet, velocities, jacobians, whole = (
            np.empty((4, 3)),
            np.empty((4, 3)),
            np.empty((4, 3, 3)),
            np.zeros((3, self.model.nv)),
        )
        for i, foot in enumerate(self._feet):
            lowest = data.xpos[foot] - (0.0, 0.0, RADIUS)
            mujoco.mj_jac(self.model, data, whole, None, lowest, foot)
            jacobians[i] = true.T @ whole[:, self._leg[i]]
            velocities[i] = jacobians[i] @ data.qvel[self._leg[i]]
            feet[i] = (lowest - data.xpos[self._trunk]) @ true
        return feet, velocities, jacobians


def _model(trial: Trial) -> mujoco.MjModel:
    prefix = next(iter(find_spec("cmeel").submodule_search_locations))
    tree = ElementTree.parse(Path(prefix).parent / MODEL).getroot()
    for link in tree.iter("link"):
        for shape in link.findall("visual") + link.findall("collision"):
            link.remove(shape)
    compiler = ElementTree.SubElement(ElementTree.SubElement(tree, "mujoco"), "compiler")
    compiler.set("fusestatic", "false")
    compiler.set("balanceinertia", "true")
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(tree, encoding="unicode"))
    spec.option.timestep = TICK / STEPS
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.body("base_link").add_freejoint()
    looks = {
        "solref": [-STIFFNESS, -DAMPING],
        "solimp": [0.95, 0.99, 0.001, 0.5, 2],
        "friction": [0.8, 0.005, 0.0001],
        "condim": 3,
    }
    for foot in FEET:
        ball = spec.body(f"{foot}_FOOT").add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[RADIUS, 0, 0], contype=1, conaffinity=2, mass=0.0, **looks
        )
        ball.name = f"{foot}_ball"
    for (i, j), height in np.ndenumerate(trial.heights):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[0.05, 0.1, 0.1],
            pos=[0.1 * (i - 5), 0.2 * (j - 2.5), height - 0.1],
            contype=2,
            conaffinity=1,
            **looks,
        )
    model = spec.compile()
    model.dof_armature[6:], model.dof_damping[6:], model.jnt_limited[:] = ARMATURE, 0.01, 0
    return model
