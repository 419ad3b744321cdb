"""A robot that walks: the steps of its physics, its states at any time, and the landings of its feet."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any, Final, NamedTuple

import numpy as np

from ...prediction.types import Vector3
from ...stamps import NANOSECONDS
from ..truth import LandingState, TrueLanding
from .description import Values
from .gait import PlannedGait, references
from .ground import SimulatedGround
from .machine import STEP, Machine

SETTLE: Final = 0.6
"""Seconds in which a robot comes to rest on its feet before it walks, and those of them that are recorded."""
STANDS: Final = 0.3

GANTRY: Final = 0.1
"""Of the springs of a gantry, in s: their damping over their stiffness."""

FALLEN: Final = 0.5
"""Cosine of the tilt from which a robot has fallen."""

SWING: Final = 0.03
"""Seconds without a lasting contact from which a foot has swung."""

LASTS: Final = 0.02
"""Seconds in half of which a contact that lasts has a force."""

ENDS: Final = 0.01
"""Seconds without a force that end a contact."""

HOPS: Final = 0.005
"""The part of a robot's height by which a foot rises at most that hops."""

MARKS: Final = (0.001, 0.002, 0.005)
"""Seconds after a landing at which the truth tells the state, besides the first peak of the force."""

LATEST: Final = 0.05
"""Seconds after a landing in which the first peak is looked for."""

FALLS: Final = 0.1
"""The part by which the force falls after a peak."""


class Walk(NamedTuple):
    """A robot that has walked, step by step of the physics from the first recorded one.

    MuJoCo's positions (n, nq), velocities (n, nv) and efforts (n, joints) of the drives, and the force of the ground on
    each foot (n, feet, 3) in N in the axes of the world; whether it has `fallen`, which ends the walk.
    """

    machine: Machine
    ground: SimulatedGround
    gait: PlannedGait
    positions: Values
    velocities: Values
    efforts: Values
    forces: Values
    fallen: bool

    @property
    def duration(self) -> float:
        """Seconds from the first recorded step to the last."""
        return (len(self.positions) - 1) * STEP

    def states(self, times: Values) -> RobotStates:
        """The states at times (n,) in s, between steps by interpolation."""
        return states(self, np.clip(times / STEP, 0.0, len(self.positions) - 1.0))


class RobotStates(NamedTuple):
    """A robot at some times: of its base position (n, 3), orientation (n, 4) as x, y, z, w and twist (n, 6) along its
    axes; positions, velocities and efforts (n, joints) of its joints; of the points that touch first position and
    velocity (n, feet, points, 3) and of the feet the force (n, feet, 3), in the world.
    """

    position: Values
    orientation: Values
    twist: Values
    joints: Values
    rates: Values
    efforts: Values
    points: Values
    point_velocities: Values
    forces: Values


def walk(
    machine: Machine,
    ground: SimulatedGround,
    gait: PlannedGait,
    duration: float,
    gantry: float = 0.0,
    tell: Callable[[int], None] | None = None,
) -> Walk:
    """Let a machine stand for STANDS and walk until `duration` s are recorded, or it falls.

    Its drives follow the gait, whatever happens. A `gantry` holds the trunk upright by springs of so many m g h to a
    rad, and leaves it free to move.
    `tell` takes now and then how many seconds are done.
    """
    told = references(machine, gait, ground.slope, ground.obstacle)
    mujoco, model, data = machine.mujoco, machine.model, machine.data
    mujoco.mj_resetData(model, data)
    half, normal = -0.5 * ground.slope, np.array(ground.normal)
    data.qpos[:7] = (*(machine.height * normal), cos(half), 0.0, sin(half), 0.0)
    data.qpos[machine.places] = machine.posture
    stiffness, damping = machine.gains
    skipped = round((SETTLE - STANDS) / STEP)
    count = skipped + round(duration / STEP) + 1
    positions, velocities = np.zeros((count, model.nq)), np.zeros((count, model.nv))
    efforts, forces = np.zeros((count, len(machine.joints))), np.zeros((count, len(machine.feet), 3))
    hold = gantry * machine.mass * 9.81 * machine.height * np.array([1.0, GANTRY])
    wrench, fallen, k = np.zeros(6), False, 0
    for k in range(count):
        time = k * STEP - SETTLE
        if time < 0.0:
            part = min(2.0 * (1.0 + time / SETTLE), 1.0)
            data.ctrl[:] = machine.posture + part * (told.positions[0] - machine.posture)
        else:
            wanted, rates = told.at(time)
            data.ctrl[:] = wanted + damping / stiffness * rates
        positions[k], velocities[k] = data.qpos, data.qvel
        if gantry:
            _hold(machine, hold)
        mujoco.mj_step(model, data)
        efforts[k] = data.actuator_force
        for number in range(data.ncon):
            contact = data.contact[number]
            if contact.efc_address >= 0:
                mujoco.mj_contactForce(model, data, number, wrench)
                force = contact.frame.reshape(3, 3).T @ wrench[:3]
                # It is that on the second body, and MuJoCo orders two bodies by their shapes.
                if contact.geom2 in machine.geoms:
                    forces[k, machine.geoms[contact.geom2]] += force
                else:
                    forces[k, machine.geoms[contact.geom1]] -= force
        w, x, y, z = data.qpos[3:7]
        if not 1.0 - 2.0 * (x * x + y * y) > FALLEN:
            fallen = True
            break
        if tell is not None and k % 400 == 0:
            tell(round(max(k - skipped, 0) * STEP))
    rows = slice(skipped, k + 1)
    return Walk(
        machine=machine,
        ground=ground,
        gait=gait,
        positions=positions[rows],
        velocities=velocities[rows],
        efforts=efforts[rows],
        forces=forces[rows],
        fallen=fallen,
    )


def _hold(machine: Machine, hold: Values) -> None:
    """Turn the trunk upright and ahead by a spring and a damper; they change nothing within an impact."""
    data = machine.data
    upright = data.qpos[4:7] * (2.0 if data.qpos[3] > 0.0 else -2.0)
    turned = np.zeros(3)
    machine.mujoco.mju_rotVecQuat(turned, -hold[0] * upright - hold[1] * data.qvel[3:6], data.qpos[3:7])
    data.xfrc_applied[1, 3:] = turned


def states(walk: Walk, places: Values) -> RobotStates:
    """The states of a walk at places (n,), which count steps."""
    machine = walk.machine
    mujoco, model, data = machine.mujoco, machine.model, machine.data
    first = np.minimum(places.astype(int), len(walk.positions) - 2)
    part = (places - first)[:, None]

    def between(rows: Values) -> Values:
        shaped = part.reshape(-1, *[1] * (rows.ndim - 1))
        found: Values = (1.0 - shaped) * rows[first] + shaped * rows[first + 1]
        return found

    positions, velocities = between(walk.positions), between(walk.velocities)
    positions[:, 3:7] /= np.linalg.norm(positions[:, 3:7], axis=1)[:, None]
    twist, moving = velocities[:, :6].copy(), np.zeros(6)
    local, radius = machine.sole.points, machine.sole.radius
    points = np.zeros((len(places), len(machine.feet), len(local), 3))
    rates = np.zeros_like(points)
    down = -radius * np.array(walk.ground.normal)
    for k, (place, velocity) in enumerate(zip(positions, velocities, strict=True)):
        data.qpos[:], data.qvel[:] = place, velocity
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        twist[k, :3] = data.xmat[1].reshape(3, 3).T @ velocity[:3]
        points[k] = machine.soles() + down
        for foot, body in enumerate(machine.bodies):
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, moving, 0)
            rates[k, foot] = moving[3:] + np.cross(moving[:3], points[k, foot] - data.xpos[body])
    return RobotStates(
        position=positions[:, :3],
        orientation=positions[:, [4, 5, 6, 3]],
        twist=twist,
        joints=positions[:, machine.places],
        rates=velocities[:, machine.rates],
        efforts=between(walk.efforts),
        points=points,
        point_velocities=rates,
        forces=between(walk.forces),
    )


def landings_of(walk: Walk) -> list[TrueLanding]:
    """The landings of all feet in the order of their stamps: contacts that last, after swings.

    A contact lasts that has a force in half of its first LASTS seconds. It is a landing where the last one of the foot
    has ended SWING seconds before or earlier, the foot has risen since, and 5 ms of the walk, the last of the MARKS,
    follow it.
    """
    found = []
    for foot in range(len(walk.machine.feet)):
        touched = [(end, step) for end, step in _touched(walk.forces[:, foot]) if _swings(walk, foot, end, step)]
        found += [_landing(walk, foot, step) for _, step in touched]
    return sorted(found, key=lambda landing: landing.stamp)


def _swings(walk: Walk, foot: int, end: int, step: int) -> bool:
    """Whether a foot rises between two steps by more than a hop."""
    points = states(walk, np.linspace(end, step, 1 + (step - end) // round(0.005 / STEP))).points[:, foot]
    gaps = points[..., 2] - walk.ground.heights(points[..., 0], points[..., 1])
    return bool(gaps.min(axis=1).max() > HOPS * walk.machine.height)


def _touched(forces: Values) -> list[tuple[int, int]]:
    """The steps between which a foot has no lasting contact, by the forces (n, 3) on it."""
    has_force = np.any(forces != 0.0, axis=1)
    counted = np.concatenate([[0], np.cumsum(has_force)])
    lasts, ends, swing, last = (round(time / STEP) for time in (LASTS, ENDS, SWING, MARKS[-1]))
    steps: list[tuple[int, int]] = []
    k = stood = 0
    end = len(has_force) - max(lasts, last)
    while k < end:
        if has_force[k] and 2 * (counted[k + lasts] - counted[k]) >= lasts:
            if k - stood >= swing:
                steps.append((stood, k))
            while k < end and counted[min(k + ends, len(has_force))] > counted[k]:
                k += 1
            stood = k
        k += 1
    return steps


def _landing(walk: Walk, foot: int, step: int) -> TrueLanding:
    """What happened when a foot came to the ground in a step."""
    feet, normal = walk.machine.feet, np.array(walk.ground.normal)
    marks = [step + round(mark / STEP) for mark in MARKS] + [step + _peak(walk.forces[step:, foot] @ normal)]
    marks = [min(mark, len(walk.positions) - 1) for mark in marks]
    seen = states(walk, np.array([step - 1.0, *marks]))
    loaded = walk.forces[max(step - round(ENDS / STEP), 0) : step] @ normal > 0.0

    def state(k: int, mark: int) -> LandingState:
        lowest = np.argmin(seen.points[k] @ normal, axis=1)
        velocities = [seen.point_velocities[k, number, point] for number, point in enumerate(lowest)]
        return LandingState(
            time=(mark - step) * STEP,
            twist=tuple(seen.twist[k].tolist()),
            rates=tuple(seen.rates[k].tolist()),
            velocities=tuple([_vector(velocity) for velocity in velocities]),
            impulses=tuple([_vector(impulse) for impulse in walk.forces[step:mark].sum(axis=0) * STEP]),
        )

    return TrueLanding(
        stamp=round(step * STEP * NANOSECONDS),
        body=walk.machine.base,
        foot=feet[foot],
        feet=feet,
        standing=tuple([name for k, name in enumerate(feet) if k != foot and loaded[:, k].mean() > 0.5]),
        normal=walk.ground.normal,
        states=(state(0, step), *[state(k, mark) for k, mark in enumerate(marks, 1)]),
    )


def _peak(force: Values) -> int:
    """The step of the first maximum of a force from which it falls by the part FALLS, or of its greatest one."""
    soon = force[: round(LATEST / STEP)]
    highest = np.maximum.accumulate(soon)
    # The side of a stair may push a foot first, and not up.
    fallen = np.flatnonzero((highest > 0.0) & (soon < (1.0 - FALLS) * highest))
    return int(np.argmax(soon[: fallen[0]] if len(fallen) else soon))


def _vector(values: Any) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z
