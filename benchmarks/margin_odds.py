"""How reliable the told probability is that a margin passes 1 within the hour: told against how often it happened.

    python benchmarks/margin_odds.py [--seas 60] [--seed 1000]

Seas from the side, each with a seed of its own, on two decks: after twenty minutes the hour ahead is told for limits
that the push along the deck seldom or often reaches, and then sailed.
"""

from __future__ import annotations

from itertools import pairwise
from math import log, sqrt
from typing import Final

import click
import numpy as np
from bench_tracking import SHIP
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from impact_predictor.prediction.watch.peaks import HOUR, MarginPeaks
from impact_predictor.scenarios.deck.sea import SeaState, waves_of
from impact_predictor.scenarios.deck.vessel import Vessel, deck_in

DECKS: Final = (("pontoon", Vessel(), SeaState(1.0, 5.0)), ("ship", SHIP, SeaState(3.0, 9.0)))
LEARNT: Final = 1200.0
STEP: Final = 0.2
LIMITS: Final = np.linspace(0.6, 1.3, 15)
"""Limits of the push, as parts of the maximum of an hour in a Gaussian sea."""
BINS: Final = (0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)

Array = NDArray[np.float64]


def pushes(vessel: Vessel, sea: SeaState, seed: int) -> Array:
    """The part of the weight that pushes along the deck."""
    felt = deck_in(waves_of(sea, seed), vessel).at(np.arange(0.0, LEARNT + HOUR, STEP)).gravity
    return np.hypot(felt[:, 0], felt[:, 1]) / -felt[:, 2]


def told(push: Array) -> tuple[Array, Array, float, list[str]]:
    """Probabilities for the limits, whether they were passed, the told maximum over the true one, and the laws."""
    deviation = float(np.sqrt(np.mean(np.square(push))))
    limits = LIMITS * deviation * sqrt(2.0 * log(1400.0))
    peaks, now = MarginPeaks(len(limits)), round(LEARNT / STEP)
    for one in push[:now].tolist():
        peaks.update(one / limits, STEP)
    laws = [peaks.law(number) for number in range(len(limits))]
    passed = push[now:].max() >= limits
    return (
        np.array([law.probability(HOUR) for law in laws]),
        passed,
        laws[0].maximum * limits[0] / float(push[now:].max()),
        [law.name for law in laws[:1]],
    )


@click.command()
@click.option("--seas", default=60, show_default=True)
@click.option("--seed", default=1000, show_default=True, help="Of the first sea; the laws were chosen on those from 0.")
def main(seas: int, seed: int) -> None:
    """Print the table."""
    table = Table("deck", "told", "cases", "told in the mean", "happened")
    for name, vessel, sea in DECKS:
        found = [
            told(pushes(vessel, sea, seed + number))
            for number in track(range(seas), name, console=Console(stderr=True), transient=True)
        ]
        odds, passed = np.concatenate([one[0] for one in found]), np.concatenate([one[1] for one in found])
        for low, high in pairwise(BINS):
            within = (odds >= low) & ((odds < high) | (high == 1.0))
            if within.any():
                row = f"{odds[within].mean():.3f}", f"{passed[within].mean():.3f}"
                table.add_row(name, f"{low:g} to {high:g}", str(int(within.sum())), *row)
        brier, usual = np.square(odds - passed).mean(), passed.var()
        ratios = np.array([one[2] for one in found])
        laws = [law for one in found for law in one[3]]
        Console().print(
            f"{name}: Brier score {brier:.3f} (the usual frequency {usual:.3f}); most probable maximum over the true "
            f"one {np.median(ratios):.2f}, from {ratios.min():.2f} to {ratios.max():.2f}; Rayleigh in "
            f"{laws.count('rayleigh')} of {len(laws)} seas"
        )
    Console().print(table)


if __name__ == "__main__":
    main()
