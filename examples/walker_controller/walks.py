"""Seeded walks: the ground of each, what the robot knows of it, and the loop of machine, predictor and controller."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import cos, sin, sqrt
from typing import Final, NamedTuple

import numpy as np
from controller import Controller, Feedback, FeedbackGains, Predictive, PredictiveGains
from machine import PERIOD, RATE, Failure, Ground, Gust, Walk
from sensors import FEET, FRAME, geometry_of, sample_of
from values import Announcement, Estimate, Machine

from impact_predictor import Mode
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Prediction
from impact_predictor.ros.messages import decode_polygon, encode_polygon
from impact_predictor.scenarios.wheel import Hub
from impact_predictor.scenarios.wheel_closed_forms import impact_friction, kept

TRACK: Final = 6.0
"""m to walk."""

TIME: Final = 12.0
"""Seconds for it; a machine that needs more has stopped."""

SLOPES: Final = (-0.06, 0.18)
"""rad, positive downhill."""

FRICTIONS: Final = (0.14, 0.5)
"""The lower limit on level ground. It grows with the slope downhill, where only long steps brake, and ..."""

UPHILL: Final = 2.5
"""... with so much of it uphill, where only long steps push off well."""

GUST: Final = 40.0
"""N, standard deviation; about 0.15 rad/s in its 0.1 s."""

SPAN: Final = 25
"""Ticks over which `foretold` takes the acceleration, as the predictor does."""

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
    """How a walk ended: None where it reached its end, else why not; after `distance` m, `time` s and `steps`.

    `work` in J, of all push-offs.
    """

    failure: Failure | None
    distance: float
    time: float
    steps: int
    work: float


def trial(seed: int) -> Trial:
    """The walk of a seed.

    The paving has slabs of 0.25 m which stand up to 3 mm off the plane. About every 1.5 s a gust pushes for 0.1 s. The
    robot knows slope and friction of the ground to 0.3 degrees and 5 % (standard deviations), but neither slabs nor
    gusts.
    """
    random = np.random.default_rng([2025, seed])
    slope = random.uniform(*SLOPES)
    friction = random.uniform(FRICTIONS[0] + max(slope, -UPHILL * slope), FRICTIONS[1])
    heights = random.uniform(-0.003, 0.003, 60)
    starts = np.cumsum(random.exponential(1.5, 40))
    forces = random.normal(0.0, GUST, 40)
    gusts = [Gust(start, start + 0.1, force) for start, force in zip(starts.tolist(), forces.tolist(), strict=True)]
    estimate = Estimate(slope + random.normal(0.0, 0.005), friction * (1.0 + random.normal(0.0, 0.05)))
    ground = Ground(slope, friction, tuple(heights.tolist()))
    return Trial(seed, Machine(), ground, tuple(gust for gust in gusts if gust.start < TIME), estimate)


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
        horizon=0.15,
        walking=Walking(feet=FEET, dead_time=0.006),
    )


def announced(prediction: Prediction) -> Announcement | None:
    """What the topics ~/post_impact and ~/mode tell of a prediction."""
    touchdown = prediction.touchdown
    if touchdown is None:
        return None
    stamp = prediction.sample.stamp + round(touchdown.lead_time * 1e9)
    return Announcement(stamp, touchdown.mode, touchdown.angular[1])


def predicted(machine: Machine, scene: Scene) -> Announce:
    """What the predictor of a scene announces."""
    predictor = Predictor(scene)

    def announce(made: Walk) -> Announcement | None:
        # Through the bytes of the message, which has float32.
        predictor.tell(decode_polygon(encode_polygon(geometry_of(made))))
        return announced(predictor.update(sample_of(made)))

    return announce


def foretold(machine: Machine, scene: Scene) -> Announce:
    """What the predictor announces once the leg is held, in closed form and some twenty times faster: for the tuning.

    As the predictor's, the acceleration is that of the last 50 ms, and goes on.
    """
    hub = Hub(machine.mass, machine.inertia, machine.leg, scene.friction)
    rates: deque[float] = deque(maxlen=SPAN + 1)
    steps = 0

    def announce(made: Walk) -> Announcement | None:
        nonlocal steps
        if made.steps != steps:
            steps = made.steps
            rates.clear()
        rates.append(made.rate)
        angle = 0.5 * made.angle
        way = angle - made.lean
        if not made.seen.ready or way <= 0.0 or len(rates) < 2:
            return None
        acceleration = (rates[-1] - rates[0]) / ((len(rates) - 1) * PERIOD)
        square = rates[-1] ** 2 + 2.0 * acceleration * way
        if square <= 0.0:
            return None
        before = sqrt(square)
        lead_time = 2.0 * way / (rates[-1] + before)
        if lead_time > scene.horizon:
            return None
        mode = Mode.PIVOT if impact_friction(hub, angle) <= scene.friction else Mode.PIVOT_SLIDE
        return Announcement(made.stamp + round(1e9 * lead_time), mode, kept(hub, angle) * before)

    return announce


def walk_with(
    name: str, trial: Trial, gains: dict[str, float], prediction: Callable[[Machine, Scene], Announce] = predicted
) -> Result:
    """Make a walk with a controller and its gains: "feedback", "informed" or "predictive"."""
    machine, estimate = trial.machine, trial.estimate
    if name != "predictive":
        return walk(trial, Feedback(machine, estimate, FeedbackGains(**gains)))
    own = PredictiveGains(**gains)
    announce = prediction(machine, scene_of(machine, estimate, own.trust))
    return walk(trial, Predictive(machine, estimate, own), announce)


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
    return Result(made.failure or late, made.x + TRACK - goal, made.ticks / RATE, made.steps, made.work)
