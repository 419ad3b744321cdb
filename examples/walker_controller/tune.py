"""Tunes the gains of the controllers with the same optimizer, evaluations and walks; writes gains.json.

    PYTHONPATH=. python examples/walker_controller/tune.py feedback informed predictive

The walks have other seeds than those of experiment.py, and stronger gusts. It takes some minutes.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from functools import partial
from math import atan2, hypot, sqrt
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from controller import Announcement, Feedback, FeedbackGains, Predictive, PredictiveGains
from machine import Walk
from scipy.optimize import differential_evolution
from scipy.stats import qmc
from trials import GUST, TRACK, Announce, Result, Trial, predicted, scene_of, trial, walk

from impact_predictor import Mode
from impact_predictor.prediction.scene import Scene
from impact_predictor.scenarios.walking.closed_forms import gained, impact_friction, kept
from impact_predictor.scenarios.walking.stride import Hub

GAINS: Final = Path(__file__).with_name("gains.json")
FIRST_SEED: Final = 10_000

HARDER: Final = 1.5 * GUST
"""Gusts while tuning: in those of experiment.py some gains get over all walks, and nothing tells which are good."""


class Effort(NamedTuple):
    """Of the optimizer: each of `generations` has `population` evaluations, each a walk over every one of `walks`."""

    population: int
    generations: int
    walks: int


EFFORT: Final = Effort(16, 10, 24)
"""The same for all."""

FELT: Final = {
    "angle": (0.2, 0.45),
    "angle_by_rate": (-0.1, 0.4),
    "angle_by_past": (-0.05, 0.1),
    "retract": (0.0, 0.1),
    "push": (0.0, 20.0),
    "push_by_rate": (0.0, 30.0),
    "push_by_past": (0.0, 10.0),
}
TOLD: Final = {
    "angle_by_slope": (-1.0, 3.0),
    "push_by_slope": (0.0, 120.0),
    "grip": (0.5, 1.2),
    "grip_by_inertia": (-0.5, 2.0),
}
BOUNDS: Final[dict[str, dict[str, tuple[float, float]]]] = {
    "feedback": FELT,
    "informed": {**FELT, **TOLD},
    "predictive": {
        "angle": (0.2, 0.42),
        "trust": (0.6, 1.1),
        "rate": (0.6, 1.8),
        "retract": (0.005, 0.06),
        "extend": (0.0, 0.5),
        "lead_time": (0.02, 0.2),
    },
}
GUESSES: Final[dict[str, Any]] = {
    "feedback": FeedbackGains(),
    "informed": FeedbackGains(0.3, 0.1, 0.0, 0.03, 8.0, 20.0, 0.0, 0.5, 80.0, 0.8, 0.0),
    "predictive": PredictiveGains(),
}
"""With which each begins, set by hand."""


def feedback_walk(one: Trial, gains: dict[str, float]) -> Result:
    """A walk without the predictor."""
    return walk(one, Feedback(one.machine, one.estimate, FeedbackGains(**gains)))


def predictive_walk(
    one: Trial, gains: dict[str, float], announcements: Callable[[Scene], Announce] = predicted
) -> Result:
    """A walk with the predictor, whose scene has the estimates of the robot."""
    own = PredictiveGains(**gains)
    announce = announcements(scene_of(one.machine, one.estimate, own.trust))
    return walk(one, Predictive(one.machine, one.estimate, own), announce)


def foretold(scene: Scene) -> Announce:
    """What the predictor would announce, in closed form: as fast as feedback, so that all get the same effort.

    It is exact on even ground without gusts; the walks of experiment.py have the predictor itself.
    """
    slope, gravity = atan2(scene.gravity[0], -scene.gravity[2]), hypot(*scene.gravity)

    def announce(made: Walk) -> Announcement | None:
        machine, angle = made.machine, 0.5 * made.angle
        if not made.seen.ready or made.lean >= angle:
            return None
        hub = Hub(machine.mass, machine.inertia, machine.leg, scene.friction, slope, gravity)
        before = sqrt(max(0.0, made.rate**2 + gained(hub, made.lean, angle)))
        lead_time = 2.0 * (angle - made.lean) / (made.rate + before)
        if lead_time > scene.horizon:
            return None
        mode = Mode.PIVOT if impact_friction(hub, angle) <= scene.friction else Mode.PIVOT_SLIDE
        return Announcement(made.stamp + round(1e9 * lead_time), mode, kept(hub, angle) * before)

    return announce


WALKS: Final[dict[str, Callable[[Trial, dict[str, float]], Result]]] = {
    "feedback": feedback_walk,
    "informed": feedback_walk,
    "predictive": predictive_walk,
}

TUNED: Final[dict[str, Callable[[Trial, dict[str, float]], Result]]] = {
    **WALKS,
    "predictive": partial(predictive_walk, announcements=foretold),
}
"""The walks of the tuning."""


def cost(results: list[Result]) -> float:
    """Failures, and a little of what failed walks lack of the track, which leads the optimizer where all fail."""
    return float(np.mean([1.2 - 0.2 * one.distance / TRACK if one.failure else 0.0 for one in results]))


def tune(name: str) -> dict[str, Any]:
    """The best gains of a controller."""
    bounds, effort = BOUNDS[name], EFFORT
    trials = [trial(FIRST_SEED + number, HARDER) for number in range(effort.walks)]

    def evaluate(values: Any) -> float:
        gains = dict(zip(bounds, map(float, values), strict=True))
        return cost([TUNED[name](one, gains) for one in trials])

    low, high = np.array(list(bounds.values())).T
    first = qmc.scale(qmc.LatinHypercube(len(bounds), seed=1).random(effort.population), low, high)
    guess = [GUESSES[name]._asdict()[key] for key in bounds]
    found = differential_evolution(
        evaluate,
        list(bounds.values()),
        x0=guess,
        init=first,
        maxiter=effort.generations - 1,
        polish=False,
        seed=1,
        tol=0.0,
        callback=lambda best, convergence: print(name, np.round(best, 4).tolist(), flush=True),
    )
    gains = {key: round(float(value), 4) for key, value in zip(bounds, found.x, strict=True)}
    return {"gains": gains, "cost": round(float(found.fun), 4), "evaluations": int(found.nfev), "walks": len(trials)}


def main() -> None:
    """Tune the controllers that are named."""
    for name in sys.argv[1:] or list(BOUNDS):
        tuned = tune(name)
        # Read only now: others may be tuned at the same time.
        known = json.loads(GAINS.read_text()) if GAINS.exists() else {}
        GAINS.write_text(json.dumps({**known, name: tuned}, indent=2, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
