"""Seeded walks: the ground of each, what the robot knows of it, and the loop of machine, predictor and controller."""

from __future__ import annotations

from math import cos, sin
from typing import Final, NamedTuple, Protocol

import numpy as np
from controller import Announcement, Controller, Estimate
from machine import RATE, Walk
from sensors import FEET, FRAME, geometry_of, sample_of
from values import Failure, Ground, Gust, Machine

from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Geometry, Prediction, Sample, Status
from impact_predictor.ros.messages import decode_polygon, encode_polygon

TRACK: Final = 6.0
"""m to walk."""

TIME: Final = 12.0
"""Seconds for it; a machine that needs more has stopped."""

SLOPES: Final = (-0.05, 0.12)
"""rad, positive downhill."""

FRICTIONS: Final = (0.22, 0.7)


class Predictor(Protocol):
    """What the loop needs of the library's `Walker`."""

    def set_geometry(self, geometry: Geometry) -> Status: ...

    def update(self, sample: Sample) -> Prediction: ...


class Trial(NamedTuple):
    """One walk to make: the ground and the gusts, which only the simulation knows, and what the robot takes it for."""

    seed: int
    ground: Ground
    gusts: tuple[Gust, ...]
    estimate: Estimate


class Result(NamedTuple):
    """How a walk ended: None where it reached its end, else why not; after `distance` m, `time` s and `steps`."""

    failure: Failure | None
    distance: float
    time: float
    steps: int


def trial(seed: int) -> Trial:
    """The walk of a seed.

    The paving has slabs of 0.25 m which stand up to 3 mm off the plane; one in ten of them is worn and has 0.8 times
    the friction. About every 1.5 s a gust pushes for 0.1 s. The robot knows slope and friction of the ground as a
    whole, to 0.3 degrees and 5 % (standard deviations), but neither single slabs nor gusts.
    """
    random = np.random.default_rng([2024, seed])
    slope, friction = random.uniform(*SLOPES), random.uniform(*FRICTIONS)
    count = 60
    worn = np.where(random.random(count) < 0.1, 0.8, 1.0)
    heights = random.uniform(-0.003, 0.003, count)
    starts = np.cumsum(random.exponential(1.5, 40))
    forces = random.normal(0.0, 35.0, 40)
    gusts = [Gust(start, start + 0.1, force) for start, force in zip(starts.tolist(), forces.tolist(), strict=True)]
    estimate = Estimate(slope + random.normal(0.0, 0.005), friction * (1.0 + random.normal(0.0, 0.05)))
    ground = Ground(slope, tuple((friction * worn).tolist()), tuple(heights.tolist()))
    return Trial(seed, ground, tuple(gust for gust in gusts if gust.start < TIME), estimate)


def scene_of(machine: Machine, estimate: Estimate, trust: float) -> Scene:
    """The scene of the predictor, from what the robot knows: config/walker.yaml with its estimates of the ground."""
    inertia = machine.inertia
    gravity = estimate.gravity
    return Scene(
        mass=machine.mass,
        inertia=((inertia, 0.0, 0.0), (0.0, inertia, 0.0), (0.0, 0.0, inertia)),
        friction=trust * estimate.friction,
        frame=FRAME,
        gravity=(gravity * sin(estimate.slope), 0.0, -gravity * cos(estimate.slope)),
        tolerance=0.005,
        horizon=0.25,
        walking=Walking(feet=FEET, window=0.02, dead_time=0.006),
    )


def announced(prediction: Prediction) -> Announcement | None:
    """What the topics ~/post_impact and ~/mode tell of a prediction."""
    touchdown = prediction.touchdown
    if touchdown is None:
        return None
    stamp = prediction.sample.stamp + round(touchdown.lead_time * 1e9)
    return Announcement(stamp, touchdown.mode, touchdown.angular[1])


def walk(trial: Trial, controller: Controller, predictor: Predictor | None = None, every: int = 1) -> Result:
    """Make a walk; what the predictor says of a sample, one in `every`, reaches the controller with the next tick."""
    made = Walk(Machine(), trial.ground, trial.gusts)
    ahead: Announcement | None = None
    goal = made.x + TRACK
    while made.failure is None and made.x < goal and made.ticks < TIME * RATE:
        command = controller.command(made.seen, ahead)
        if predictor is not None and made.ticks % every == 0:
            # Through the bytes of the message, which has float32.
            predictor.set_geometry(decode_polygon(encode_polygon(geometry_of(made))))
            ahead = announced(predictor.update(sample_of(made)))
        made.tick(command)
    late = Failure.STOP if made.x < goal else None
    return Result(made.failure or late, made.x + TRACK - goal, made.ticks / RATE, made.steps)
