"""What one sample of a walking machine with four feet costs, with what is told of its feet: the plan of HyQ.

    python benchmarks/bench_walker.py [RUNS]

Once without noise and once with that of `walker_times.py --world`. Each run goes over the whole record; of each sample
the fastest run counts, so that other programs disturb little. Messages are decoded before. Samples are told apart by
how many landings they announce.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from time import perf_counter_ns

import numpy as np
from rich.console import Console
from rich.table import Table
from walker_times import noisy, plan, scene

from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Geometry, Sample

Record = Sequence[tuple[Sample, Geometry]]


def run(machine: Scene, record: Record) -> tuple[list[float], list[int]]:
    """Microseconds of each sample with its geometry, and how many landings it announces."""
    walker = Predictor(machine)
    costs, ahead = [], []
    for sample, geometry in record:
        started = perf_counter_ns()
        walker.tell(geometry)
        prediction = walker.update(sample)
        costs.append((perf_counter_ns() - started) * 1e-3)
        ahead.append(sum(foot.lead_time is not None for foot in prediction.feet))
    return costs, ahead


def main() -> int:
    """Print what a sample costs, by what it announces."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    machine, rng = scene(), np.random.default_rng(0)
    clean = [(one.sample, one.geometry) for one in plan() if one.sample is not None and one.geometry is not None]
    records: dict[str, Record] = {
        "no noise": clean,
        "1 mm, 0.02 m/s": [noisy(sample, geometry, rng, on_robot=False) for sample, geometry in clean],
        "no velocities of the feet": [(sample, geometry._replace(velocities=())) for sample, geometry in clean],
    }
    table = Table("us per sample", "landings ahead", "samples", "median", "mean", "99 %")
    for name, record in records.items():
        measured = [run(machine, record) for _ in range(runs)]
        costs, ahead = np.min([one[0] for one in measured], axis=0), np.array(measured[0][1])
        for what, chosen in (("any", ahead >= 0), ("none", ahead == 0), ("one", ahead == 1), ("more", ahead > 1)):
            numbers = np.median(costs[chosen]), np.mean(costs[chosen]), np.percentile(costs[chosen], 99)
            table.add_row(name, what, str(chosen.sum()), *(f"{number:.0f}" for number in numbers))
    Console(width=120).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
