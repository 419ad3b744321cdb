"""What `impact-predictor calibrate` is worth on the recorded cube tosses: fitted to one half, scored on the other.

    python benchmarks/calibrate_halves.py

The halves are the tosses of even and of odd number, the first and the last, and five random ones with their others.
What the inertia is worth is left to the program. Prints for each what was fitted, and the errors of the other half with
it and with the published values; it takes some minutes.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from impact_predictor.bags.replay import replay
from impact_predictor.calibration.fit import calibrate
from impact_predictor.calibration.solver import Solver
from impact_predictor.calibration.touchdowns import Coefficients, ObservingMonitor, ScoredTouchdown
from impact_predictor.commands.replay import read_scenes

ROOT = Path(__file__).resolve().parents[1]
FIRST_TOSS, TOSS = 10.0, 20.0
"""s: when the first toss begins in the record, and how far apart they are (examples/cube_tosses/README.md)."""

RANDOM = 5


def numbers(touchdowns: list[ScoredTouchdown], coefficients: Coefficients) -> NDArray[np.float64]:
    """Median, 90 % and mean of the relative errors."""
    errors = np.hypot(*Solver([one.approached(coefficients) for one in touchdowns]).misses(coefficients).T)
    return np.array([np.median(errors), np.quantile(errors, 0.9), np.mean(errors)])


def main() -> int:
    """Print the table."""
    scenes = read_scenes(str(ROOT / "config/cube_tosses.yaml"))
    monitor = ObservingMonitor(scenes)
    replay(ROOT / "examples/cube_tosses", scenes, monitor=monitor)
    touchdowns = monitor.touchdowns
    tosses = np.array([int((one.stamp * 1e-9 - FIRST_TOSS) / TOSS) for one in touchdowns])
    rng = np.random.default_rng(0)
    halves = [("even", tosses % 2 == 0), ("first", tosses <= np.median(tosses))]
    halves += [
        (f"random {i}", np.isin(tosses, rng.permutation(np.unique(tosses))[: len(np.unique(tosses)) // 2]))
        for i in range(RANDOM)
    ]
    splits = [(f"{name}{'' if whole else ', the others'}", half == whole) for name, half in halves for whole in (1, 0)]
    given = Coefficients(scenes[""].friction, scenes[""].restitution)
    table = Table(
        "fitted to", "friction", "restitution", "inertia", "scored", "published: median, 90 %, mean", "fitted"
    )
    found = []
    for name, half in track(splits, "fitting", console=Console(stderr=True)):
        fitted = calibrate([[one for one, here in zip(touchdowns, half, strict=True) if here]]).fitted
        others = [one for one, here in zip(touchdowns, half, strict=True) if not here]
        before, after = numbers(others, given), numbers(others, fitted)
        found.append((before, after))
        said = [" ".join(f"{100.0 * number:.2f}" for number in errors) for errors in (before, after)]
        table.add_row(
            name,
            f"{fitted.friction:.3f}",
            f"{fitted.restitution:.3f}",
            f"{fitted.inertia:.3g}",
            str(len(others)),
            *said,
        )
    table.title = "Relative errors in %, held out"
    console = Console(width=120)
    console.print(table)
    before, after = np.mean(found, axis=0)
    better = np.sum([after < before for before, after in found], axis=0)
    for name, one, other, count in zip(("median", "90 %", "mean"), before, after, better, strict=True):
        console.print(
            f"{name}: published {100 * one:.2f} %, fitted {100 * other:.2f} %; better in {count} of {len(found)}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
