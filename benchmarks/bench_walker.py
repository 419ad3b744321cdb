"""What one sample of a walking machine with four feet costs, with what is told of its feet: the plan of HyQ.

    python benchmarks/bench_walker.py [RUNS]

Once without noise, once with that of `walker_times.py --world` and once without velocities of the feet. Each run goes
over the whole record; of each sample the fastest run counts, in the thread's own time, so that other programs disturb
little. The largest cost of any run but the first, which warms up, stands beside them, with what Python's collector took
of it. What was there before is frozen, as in the node. Messages are decoded before. Samples are told apart by how many
landings they announce.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence
from time import thread_time_ns
from typing import Any

import numpy as np
from forms import in_both_forms
from rich.console import Console
from rich.table import Table
from walker_times import noisy, plan, scene

from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Geometry, Sample

Record = Sequence[tuple[Sample, Geometry]]


class Collector:
    """The time that Python's collector takes."""

    def __init__(self) -> None:
        self.spent = self._began = 0
        gc.callbacks.append(self._see)

    def _see(self, phase: str, _: Any) -> None:
        now = thread_time_ns()
        if phase == "start":
            self._began = now
        else:
            self.spent += now - self._began


def run(machine: Scene, record: Record, collector: Collector) -> tuple[list[float], list[float], list[int]]:
    """Microseconds of each sample with its geometry, those of the collector in it, and how many landings it tells."""
    walker = Predictor(machine)
    costs, collected, ahead = [], [], []
    for sample, geometry in record:
        before, started = collector.spent, thread_time_ns()
        walker.tell(geometry)
        prediction = walker.update(sample)
        costs.append((thread_time_ns() - started) * 1e-3)
        collected.append((collector.spent - before) * 1e-3)
        ahead.append(sum(foot.lead_time is not None for foot in prediction.feet))
    return costs, collected, ahead


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
    columns = "samples", "median", "mean", "99 %", "largest", "of any run", "collector in it"
    table, collector = Table("us per sample", "landings ahead", *columns), Collector()
    gc.collect()
    gc.freeze()
    for name, record in records.items():
        measured = [run(machine, record, collector) for _ in range(runs + 1)][1:]
        each, collected, ahead = (np.array(values) for values in zip(*measured, strict=True))
        costs, ahead = each.min(axis=0), ahead[0]
        for what, chosen in (("any", ahead >= 0), ("none", ahead == 0), ("one", ahead == 1), ("more", ahead > 1)):
            own, worst = costs[chosen], each[:, chosen].argmax()
            numbers = np.median(own), np.mean(own), np.percentile(own, 99), own.max()
            shares = each[:, chosen].flat[worst], collected[:, chosen].flat[worst]
            table.add_row(name, what, str(chosen.sum()), *(f"{number:.0f}" for number in (*numbers, *shares)))
    Console(width=120).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(in_both_forms(main))
