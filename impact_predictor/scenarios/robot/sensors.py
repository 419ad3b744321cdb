"""What the sensors of a robot tell of its walk, and the bag and the scene for a replay of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from ...prediction.types import FeetStates, Geometry, Joints, Sample, Schedule, Terrain, Vector3, Wrench
from ...ros.messages import (
    JOINT_STATE,
    JOINT_TRAJECTORY,
    MULTI_DOF_JOINT_STATE,
    ODOMETRY,
    POINT_CLOUD,
    POLYGON,
    WRENCH,
    encode_odometry,
    encode_polygon,
)
from ...ros.messages.walker_inputs import encode_feet, encode_joints, encode_schedule, encode_terrain, encode_wrench
from ...stamps import NANOSECONDS
from ..record import FRAME, RecordedMessage, nothing_happened, truth_messages
from ..sensors import covariance, rotations, stamps_of
from ..truth import LANDING_TOPIC, TrueLanding
from .description import Values
from .walk import STANDS, RobotStates, Walk

CELL: Final = 0.02
"""Size in m of the cells whose heights are told, and how far they reach beyond the way of the base."""
MARGIN: Final = 0.8

FORCE_RATE: Final = 100.0
"""Messages in Hz of each force sensor, at most."""


class WalkSensors(NamedTuple):
    """How a walk is observed: `rate` in Hz, and the seed of the noise.

    White noise with standard deviations of `position` (m) and `velocity` (m/s) is on each coordinate of base and feet,
    and on the joints as much as moves a foot so far. Feet, joints and forces are those of `delay` s before their stamp.
    The told height of the base runs away from the true one with `drift` in m/s. Feet are told `by_names` on
    feet_states, with velocities and forces, or in their order on contact_geometry, without.
    """

    rate: float = 400.0
    position: float = 0.0
    velocity: float = 0.0
    delay: float = 0.0
    drift: float = 0.0
    seed: int = 0
    by_names: bool = False


def walk_messages(walk: Walk, landings: list[TrueLanding], sensors: WalkSensors) -> list[Iterator[RecordedMessage]]:
    """The streams of messages of a walk, each ordered by its log times: the truth, the plan, the heights of ground that
    is not plane, and the sensors.

    Feet and joints come before the base of the same stamp.
    """
    known = [_plan(walk), _terrain(walk)] if walk.ground.boxes else [_plan(walk)]
    truth = nothing_happened((LANDING_TOPIC,), FRAME), iter(truth_messages(landings, FRAME))
    return [*truth, iter(known), _sensed(walk, sensors)]


def _sensed(walk: Walk, sensors: WalkSensors) -> Iterator[RecordedMessage]:
    machine, rng = walk.machine, np.random.default_rng((sensors.seed, 1))
    stamps = stamps_of(0.0, walk.duration, sensors.rate, last=True)
    times = np.array(stamps) / NANOSECONDS
    now, then = walk.states(times), walk.states(times - sensors.delay)
    points, velocities, forces = (part.reshape(len(times), -1, 3) for part in _relative(then))
    names = tuple([foot for foot in machine.feet for _ in machine.sole.points])
    position, velocity = sensors.position, sensors.velocity
    height = np.stack([0.0 * times, 0.0 * times, sensors.drift * times], axis=1)
    blurred = {
        "points": points + position * rng.standard_normal(points.shape),
        "velocities": velocities + velocity * rng.standard_normal(points.shape),
        "base": now.position + height + position * rng.standard_normal(now.position.shape),
        "linear": now.twist[:, :3] + velocity * rng.standard_normal(now.position.shape),
        "joints": then.joints + position / machine.height * rng.standard_normal(then.joints.shape),
        "rates": then.rates + velocity / machine.height * rng.standard_normal(then.rates.shape),
    }
    pose, twist = covariance(position, 0.0), covariance(velocity, 0.0)
    forces_every = max(1, round(sensors.rate / FORCE_RATE))
    for k, stamp in enumerate(stamps):
        row = {name: rows[k] for name, rows in blurred.items()}
        parts = [tuple(part.tolist()) for part in (row["joints"], row["rates"], then.efforts[k])]
        sample = Sample(
            stamp=stamp,
            frame_id=FRAME,
            child_frame_id=machine.base,
            position=_tuples(row["base"][None])[0],
            orientation=tuple(now.orientation[k].tolist()),
            linear=_tuples(row["linear"][None])[0],
            angular=_tuples(now.twist[k, None, 3:])[0],
            pose_covariance=pose,
            twist_covariance=twist,
        )
        yield RecordedMessage(stamp, "/joint_states", JOINT_STATE, encode_joints(Joints(stamp, machine.joints, *parts)))
        if k % forces_every == 0:
            for foot, force in zip(machine.feet, _tuples(then.forces[k]), strict=True):
                yield RecordedMessage(stamp, "/contact_wrench", WRENCH, encode_wrench(Wrench(stamp, foot, force)))
        places = _tuples(row["points"])
        if sensors.by_names:
            told = FeetStates(stamp, machine.base, names, places, _tuples(row["velocities"]), _tuples(forces[k]))
            yield RecordedMessage(stamp, "/feet_states", MULTI_DOF_JOINT_STATE, encode_feet(told))
        else:
            geometry = encode_polygon(Geometry(stamp, machine.base, places))
            yield RecordedMessage(stamp, "/contact_geometry", POLYGON, geometry)
        yield RecordedMessage(stamp, "/odom", ODOMETRY, encode_odometry(sample))


def _relative(seen: RobotStates) -> tuple[Values, Values, Values]:
    """Positions and velocities of the points relative to the base, and their parts of the forces, along its axes."""
    axes = rotations(seen.orientation)
    points = np.einsum("nij,nfpi->nfpj", axes, seen.points - seen.position[:, None, None])
    moved = np.einsum("nij,nfpi->nfpj", axes, seen.point_velocities)
    carried = seen.twist[:, None, None, :3] + np.cross(seen.twist[:, None, None, 3:], points)
    pressed = np.einsum("nij,nfi->nfj", axes, seen.forces)[:, :, None] / points.shape[2]
    return points, moved - carried, np.broadcast_to(pressed, points.shape)


def _tuples(rows: Values) -> tuple[Vector3, ...]:
    return tuple(map(tuple, rows.tolist()))


def _terrain(walk: Walk) -> RecordedMessage:
    """The heights about the way, in the middle of cells, as one message at the beginning."""
    ways = walk.positions[:, :2]
    low, high = ((end + side * MARGIN) / CELL for end, side in ((ways.min(axis=0), -1.0), (ways.max(axis=0), 1.0)))
    x, y = (CELL * (np.arange(np.floor(low[k]), np.ceil(high[k])) + 0.5) for k in range(2))
    across, aside = (part.ravel() for part in np.meshgrid(x, y))
    points = np.stack([across, aside, walk.ground.heights(across, aside)], axis=1)
    return RecordedMessage(0, "/terrain", POINT_CLOUD, encode_terrain(Terrain(0, FRAME, points)))


def _plan(walk: Walk) -> RecordedMessage:
    """When the gait wants the feet to stand, as one message at the beginning."""
    gait = walk.gait
    ends = np.array([part for foot in gait.offsets for part in (foot, foot + gait.duty)])
    strides = np.arange(-1, int(walk.duration / gait.period) + 1)
    changes = np.unique(np.round(gait.period * (strides[:, None] + ends).ravel(), 9))
    changes = changes[(changes >= 0.0) & (changes <= walk.duration)]
    times = [0, *np.round((STANDS + changes) * NANOSECONDS).astype(int).tolist()]
    stands = [(True,) * len(gait.offsets), *map(tuple, gait.stands(changes + 1e-6).tolist())]
    schedule = Schedule(0, walk.machine.feet, tuple(times), tuple(stands))
    return RecordedMessage(0, "/schedule", JOINT_TRAJECTORY, encode_schedule(schedule))
