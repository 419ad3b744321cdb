"""Tunes the gains of the controllers with the same optimizer, evaluations and walks; writes gains.json.

    PYTHONPATH=. python examples/walker_controller/tune.py feedback informed predictive

The walks have other seeds than those of experiment.py. It takes some minutes for each.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from controller import FeedbackGains, PredictiveGains
from scipy.optimize import differential_evolution
from scipy.stats import qmc
from walks import TRACK, Result, Trial, foretold, trial, walk_with

GAINS: Final = Path(__file__).with_name("gains.json")
FIRST_SEED: Final = 10_000


class Effort(NamedTuple):
    """Of the optimizer: each of `generations` has `population` evaluations, each a walk over every one of `walks`."""

    population: int
    generations: int
    walks: int


EFFORT: Final = Effort(16, 10, 32)
"""The same for all."""

FELT: Final = {
    "angle": (0.12, 0.4),
    "angle_by_rate": (-0.1, 0.3),
    "angle_by_past": (-0.05, 0.05),
    "retract": (-0.03, 0.08),
    "push": (0.0, 25.0),
    "push_by_rate": (-10.0, 40.0),
    "push_by_past": (-2.0, 8.0),
}
TOLD: Final = {"angle_by_slope": (-2.0, 2.0), "push_by_slope": (0.0, 200.0), "grip": (0.6, 1.2)}
BOUNDS: Final[dict[str, dict[str, tuple[float, float]]]] = {
    "feedback": FELT,
    "informed": {**FELT, **TOLD},
    "predictive": {
        "angle": (0.15, 0.42),
        "trust": (0.6, 1.1),
        "rate": (0.6, 1.8),
        "rate_by_slope": (0.0, 30.0),
        "retract": (0.005, 0.06),
        "extend": (0.0, 0.5),
    },
}
GUESSES: Final[dict[str, Any]] = {
    "feedback": FeedbackGains(),
    "informed": FeedbackGains(angle=0.25, angle_by_slope=-1.0, push_by_slope=100.0, grip=0.9),
    "predictive": PredictiveGains(),
}
"""With which each begins, set by hand."""


def cost(trials: list[Trial], results: list[Result]) -> float:
    """The part of walks that fail, and what of their track they lack; and a little for the work of the push-offs.

    What they lack leads the optimizer where all fail; the work, a part of weight times track, decides between gains
    that fail as often.
    """
    lacks = [1.2 - 0.2 * one.distance / TRACK if one.failure else 0.0 for one in results]
    work = [
        one.work / (trial.machine.mass * trial.ground.gravity * TRACK)
        for trial, one in zip(trials, results, strict=True)
    ]
    return float(np.mean(lacks) + np.mean(work))


def tune(name: str) -> dict[str, Any]:
    """The best gains of a controller."""
    bounds, effort = BOUNDS[name], EFFORT
    trials = [trial(FIRST_SEED + number) for number in range(effort.walks)]

    def evaluate(values: Any) -> float:
        gains = dict(zip(bounds, map(float, values), strict=True))
        return cost(trials, [walk_with(name, one, gains, foretold) for one in trials])

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
        known = json.loads(GAINS.read_text()) if GAINS.exists() else {}
        GAINS.write_text(json.dumps({**known, name: tuned}, indent=2, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
