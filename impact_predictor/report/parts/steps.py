"""A machine that steps on the spot, made up to measure what its scene costs."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Final

from ...prediction.scene import Robot, Scene, Walking
from ...prediction.types import Geometry, Joints, Sample, Schedule, Vector3, Wrench
from ...prediction.vectors import add
from ...stamps import NANOSECONDS
from .record import RATE, Message, Record, ground_of, stamped, upright_of

SAMPLES: Final = 400
STEP: Final = 60
"""Samples for which a foot stands, and then swings."""
DOWN: Final = 0.5
"""m from the body frame's origin down to feet that stand, and out to them."""
LIFT: Final = 0.05
"""m that a foot is lifted; or the whole machine, where a model tells where feet are but not how legs are bent."""
SOLE: Final = 0.1
"""m from heel to toe."""
FORCE: Final = 30.0
"""N on a foot that stands, where no more is asked for."""


def steps_of(scene: Scene, walking: Walking) -> Record:
    """Every second foot in turn; with what sensors and a planner would tell, whether the scene asks for it or not."""
    robot, place, upright = walking.robot, ground_of(scene), upright_of(scene)
    joints, fixed = ((), ()) if robot is None else _model_of(robot)
    down = -min([z for _, _, z in fixed], default=-DOWN)
    motion, points = [], []
    for k in range(SAMPLES):
        high, rate = _lift(0, k) if fixed else (0.0, 0.0)
        motion.append((add(place, scene.normal, down + high), upright, (0.0, 0.0, rate), (0.0, 0.0, 0.0)))
        points.append(fixed or tuple(_points_at(walking, k)))
    samples = stamped(scene, motion)
    messages: list[Message] = [_plan_of(walking, samples, bool(fixed))]
    for k, sample in enumerate(samples):
        messages.append(Geometry(sample.stamp, "", points[k]))
        if fixed:
            messages.append(Joints(sample.stamp, joints, (0.0,) * len(joints), ()))
        for number, foot in enumerate(walking.feet):
            force = max(walking.force, FORCE) if _stands(0 if fixed else number, k) else 0.0
            messages.append(Wrench(sample.stamp, foot, (0.0, 0.0, force)))
        messages.append(sample)
    return Record(
        tuple(messages),
        points[0],
        f"{SAMPLES} samples at {RATE} Hz of steps on the spot of this machine, made up for this",
    )


def _stands(number: int, k: int) -> bool:
    """Whether a foot stands at a sample: those with odd numbers stand while the others swing."""
    return (k // STEP + number) % 2 == 1


def _lift(number: int, k: int) -> tuple[float, float]:
    """How high a foot is above the ground at a sample, in m, and how fast it rises, in m/s."""
    if _stands(number, k):
        return 0.0, 0.0
    share = k % STEP / STEP
    return 4.0 * LIFT * share * (1.0 - share), 4.0 * LIFT * (1.0 - 2.0 * share) * RATE / STEP


def _points_at(walking: Walking, k: int) -> list[Vector3]:
    """The contact points of the feet at a sample, in the body frame, on a circle about its origin."""
    points = []
    for number in range(len(walking.feet)):
        angle = pi * (2 * number + 1) / len(walking.feet)
        heel = DOWN * cos(angle), DOWN * sin(angle), _lift(number, k)[0] - DOWN
        points += [add(heel, (SOLE, 0.0, 0.0), float(i)) for i in range(walking.points)]
    return points


def _plan_of(walking: Walking, samples: list[Sample], hops: bool) -> Schedule:
    """When the feet are to stand: as they do."""
    changes = range(0, SAMPLES, STEP)
    stands = [tuple(_stands(0 if hops else number, k) for number in range(len(walking.feet))) for k in changes]
    first = samples[0].stamp
    return Schedule(first, walking.feet, tuple(first + k * NANOSECONDS // RATE for k in changes), tuple(stands))


def _model_of(robot: Robot) -> tuple[tuple[str, ...], tuple[Vector3, ...]]:
    """The names of the joints of a model, and its contact points in the base's frame where every joint is at zero."""
    import numpy as np

    from ...mechanics.articulated import WholeBody

    body = WholeBody(robot.urdf, robot.frames)
    body.place(np.zeros(len(body.joints)))
    return body.joints, tuple((float(x), float(y), float(z)) for x, y, z in body.points)
