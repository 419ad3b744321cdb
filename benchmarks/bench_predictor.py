"""What one sample costs: `Predictor.update` over the recorded tosses of a cube.

    python benchmarks/bench_predictor.py [RUNS]

Each run goes over the whole record; of each sample the fastest run counts, so that other programs disturb little. The
messages are decoded as they come, as in the node, but only the predictor is timed.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter_ns

import numpy as np

from impact_predictor.bags.read import BagMessage, read_messages
from impact_predictor.parameter_file import read_parameters
from impact_predictor.parameters import validate
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon

ROOT = Path(__file__).resolve().parents[1]
TOSSES = ROOT / "examples/cube_tosses/cube_tosses.mcap"
PARAMETERS = ROOT / "config/cube_tosses.yaml"

KINDS = ("no touchdown ahead", "in flight", "standing")


def run(scene: Scene, record: Sequence[BagMessage]) -> tuple[list[float], list[int]]:
    """Microseconds of each sample, and the index of its kind."""
    predictor = Predictor(scene)
    costs, kinds = [], []
    for topic, _, data in record:
        if topic == "/cube/contact_geometry":
            predictor.set_geometry(decode_polygon(data))
            continue
        sample = decode_odometry(data)
        started = perf_counter_ns()
        touchdown = predictor.update(sample).touchdown
        costs.append((perf_counter_ns() - started) * 1e-3)
        kinds.append(0 if touchdown is None else 2 if touchdown.old else 1)
    return costs, kinds


def main() -> int:
    """Print the cost of a sample in all, and by what the body does."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    scene = Scene.from_parameters(validate(read_parameters(PARAMETERS)))
    record = list(read_messages(TOSSES, {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}))
    results = [run(scene, record) for _ in range(runs)]
    costs = np.min([costs for costs, _ in results], axis=0)
    kinds = np.array(results[0][1])
    print(f"{'us per sample':20}{'samples':>9}{'median':>9}{'mean':>9}{'99 %':>9}")
    for name, chosen in [("all", costs), *((kind, costs[kinds == k]) for k, kind in enumerate(KINDS))]:
        row = (np.median(chosen), np.mean(chosen), np.percentile(chosen, 99))
        print(f"{name:20}{len(chosen):9}" + "".join(f"{value:9.1f}" for value in row))
    return 0


if __name__ == "__main__":
    sys.exit(main())
