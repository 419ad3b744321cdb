"""Tunes the gains of both controllers with the same optimizer, evaluations and walks; writes gains.json.

    PYTHONPATH=. python examples/walker_controller/tune.py feedback predictive

The walks have other seeds than those of experiment.py.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from controller import Feedback, FeedbackGains, Predictive, PredictiveGains
from scipy.optimize import differential_evolution
from scipy.stats import qmc
from trials import TRACK, Result, Trial, scene_of, trial, walk
from values import Machine

GAINS: Final = Path(__file__).with_name("gains.json")
FIRST_SEED: Final = 10_000


class Effort(NamedTuple):
    """Of the optimizer: each of `generations` has `population` evaluations, each a walk over every one of `walks`."""

    population: int
    generations: int
    walks: int


EFFORTS: Final = {"feedback": Effort(16, 10, 24), "informed": Effort(16, 10, 24), "predictive": Effort(8, 6, 12)}
"""The walks of the baselines cost a twentieth, so that they get more of them."""

EVERY: Final = 2
"""While the gains are tuned the predictor hears every second sample, which takes half the time."""

FELT: Final = {
    "angle": (0.2, 0.45),
    "angle_by_rate": (-0.1, 0.4),
    "angle_by_past": (-0.05, 0.1),
    "retract": (0.0, 0.1),
    "push": (0.0, 15.0),
    "push_by_rate": (0.0, 30.0),
    "push_by_past": (0.0, 10.0),
}
BOUNDS: Final[dict[str, dict[str, tuple[float, float]]]] = {
    "feedback": FELT,
    "informed": {**FELT, "angle_by_slope": (-1.0, 3.0), "push_by_slope": (0.0, 120.0), "grip": (0.5, 1.2)},
    "predictive": {
        "angle": (0.25, 0.42),
        "trust": (0.6, 1.1),
        "rate": (0.6, 1.2),
        "retract": (0.01, 0.06),
        "shorten": (-0.03, 0.03),
        "extend": (0.0, 0.5),
        "lead_time": (0.02, 0.12),
    },
}
GUESSES: Final[dict[str, Any]] = {
    "feedback": FeedbackGains(),
    "informed": FeedbackGains(0.3, 0.1, 0.0, 0.03, 8.0, 20.0, 0.0, 0.5, 80.0, 0.8),
    "predictive": PredictiveGains(),
}
"""With which each begins, set by hand."""


def feedback_walk(one: Trial, gains: dict[str, float], every: int = 1) -> Result:
    """A walk without the predictor."""
    return walk(one, Feedback(Machine(), one.estimate, FeedbackGains(**gains)))


def predictive_walk(one: Trial, gains: dict[str, float], every: int = 1) -> Result:
    """A walk with the predictor, which gets the samples of the machine and the estimates of the robot."""
    from impact_predictor.prediction.walking.walker import Walker

    own = PredictiveGains(**gains)
    controller = Predictive(Machine(), one.estimate, own)
    return walk(one, controller, Walker(scene_of(Machine(), one.estimate, own.trust)), every)


WALKS: Final[dict[str, Callable[[Trial, dict[str, float], int], Result]]] = {
    "feedback": feedback_walk,
    "informed": feedback_walk,
    "predictive": predictive_walk,
}


def cost(results: list[Result]) -> float:
    """Failures, and a little of what failed walks lack of the track, which leads the optimizer where all fail."""
    return float(np.mean([1.2 - 0.2 * one.distance / TRACK if one.failure else 0.0 for one in results]))


def tune(name: str) -> dict[str, Any]:
    """The best gains of a controller."""
    bounds, effort = BOUNDS[name], EFFORTS[name]
    trials = [trial(FIRST_SEED + number) for number in range(effort.walks)]

    def evaluate(values: Any) -> float:
        gains = dict(zip(bounds, map(float, values), strict=True))
        return cost([WALKS[name](one, gains, EVERY) for one in trials])

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
