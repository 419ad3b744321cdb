"""Seeded walks: the ground of each, what the robot knows of it, and the loop of machine, predictor and controller."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Final, NamedTuple

import numpy as np
from controller import Announcement, Controller, Estimate
from machine import RATE, Walk
from sensors import FEET, FRAME, geometry_of, sample_of
from values import Failure, Ground, Gust, Machine

from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Prediction
from impact_predictor.ros.messages import decode_polygon, encode_polygon

TRACK: Final = 6.0
"""m to walk."""

TIME: Final = 12.0
"""Seconds for it; a machine that needs more has stopped."""

SLOPES: Final = (-0.025, 0.12)
"""rad, positive downhill."""

FRICTIONS: Final = (0.24, 0.7)
"""The lower limit on level ground and uphill; it grows with half the slope downhill, where only long steps brake."""

INERTIAS: Final = (0.5, 7.0)
"""kg m^2, of the hub with what it carries."""

GUST: Final = 60.0
"""N, standard deviation; about 0.3 rad/s in its 0.1 s."""


Announce = Callable[[Walk], Announcement | None]
"""Tells what the next touchdown will be, from the machine's sensors at every tick."""


class Trial(NamedTuple):
    """One walk to make: the ground and the gusts, which only the simulation knows, and what the robot takes it for."""

    seed: int
    machine: Machine
    ground: Ground
    gusts: tuple[Gust, ...]
    estimate: Estimate


class Result(NamedTuple):
    """How a walk ended: None where it reached its end, else why not; after `distance` m, `time` s and `steps`."""

    failure: Failure | None
    distance: float
    time: float
    steps: int


def trial(seed: int, gust: float = GUST) -> Trial:
    """The walk of a seed, in gusts of a standard deviation in N.

    The paving has slabs of 0.25 m which stand up to 3 mm off the plane; one in ten of them is worn and has 0.8 times
    the friction. About every 1.5 s a gust pushes for 0.1 s. The robot knows its load, and slope and friction of the
    ground as a whole, to 0.3 degrees and 5 % (standard deviations), but neither single slabs nor gusts.
    """
    random = np.random.default_rng([2025, seed])
    slope = random.uniform(*SLOPES)
    friction = random.uniform(FRICTIONS[0] + 0.5 * max(slope, 0.0), FRICTIONS[1])
    machine = Machine(inertia=random.uniform(*INERTIAS))
    count = 60
    worn = np.where(random.random(count) < 0.1, 0.8, 1.0)
    heights = random.uniform(-0.003, 0.003, count)
    starts = np.cumsum(random.exponential(1.5, 40))
    forces = random.normal(0.0, gust, 40)
    gusts = [Gust(start, start + 0.1, force) for start, force in zip(starts.tolist(), forces.tolist(), strict=True)]
    estimate = Estimate(slope + random.normal(0.0, 0.005), friction * (1.0 + random.normal(0.0, 0.05)))
    ground = Ground(slope, tuple((friction * worn).tolist()), tuple(heights.tolist()))
    return Trial(seed, machine, ground, tuple(gust for gust in gusts if gust.start < TIME), estimate)


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


def predicted(scene: Scene) -> Announce:
    """What the predictor of a scene announces."""
    from impact_predictor.prediction.walking.walker import Walker

    predictor = Walker(scene)

    def announce(made: Walk) -> Announcement | None:
        # Through the bytes of the message, which has float32.
        predictor.set_geometry(decode_polygon(encode_polygon(geometry_of(made))))
        return announced(predictor.update(sample_of(made)))

    return announce


def walk(trial: Trial, controller: Controller, announce: Announce | None = None) -> Result:
    """Make a walk; what is announced at a tick reaches the controller with the next one."""
    made = Walk(trial.machine, trial.ground, trial.gusts)
    ahead: Announcement | None = None
    goal = made.x + TRACK
    while made.failure is None and made.x < goal and made.ticks < TIME * RATE:
        command = controller.command(made.seen, ahead)
        ahead = announce(made) if announce else None
        made.tick(command)
    late = Failure.STOP if made.x < goal else None
    return Result(made.failure or late, made.x + TRACK - goal, made.ticks / RATE, made.steps)
