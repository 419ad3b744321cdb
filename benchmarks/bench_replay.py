"""How fast recorded tosses are replayed, and what each part of it costs.

    python benchmarks/bench_replay.py

Prints samples per second of the whole replay, with and without output, and then us per sample of each part alone. Both
are of CPU time, because a machine that does other things besides makes the clock on the wall useless; that of the whole
replay is shown too.
"""

from __future__ import annotations

import gc
import statistics
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Final

from forms import in_both_forms
from rich.console import Console
from rich.table import Table

from impact_predictor.bags.read import read_messages
from impact_predictor.bags.replay import NODE, replay
from impact_predictor.bags.write import BagWriter
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, read_scenes
from impact_predictor.resources import find
from impact_predictor.ros.messages import ODOMETRY, OUTPUTS, POLYGON, decode_odometry, decode_polygon

RUNS: Final = 7
TOPICS: Final = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
LEAST: Final = {"replay": 8000.0, "replay with output": 4000.0}
"""Samples per second that are expected of the median run."""


def seconds(work: Callable[[], object]) -> tuple[list[float], list[float]]:
    """What some work takes of CPU time and by the clock on the wall, one number for each run."""
    cpu, wall = [], []
    for _ in range(RUNS):
        begin = process_time(), perf_counter()
        work()
        cpu.append(process_time() - begin[0])
        wall.append(perf_counter() - begin[1])
    return cpu, wall


def parts(bag: Path, scene: Scene, output: Path) -> dict[str, Callable[[], object]]:
    """The parts of a replay, each on what the part before it has left."""
    messages = list(read_messages(bag, TOPICS))
    odometry = [data for topic, _, data in messages if topic == "/cube/odom"]
    # The geometry of these tosses is the same in all of them.
    geometry = decode_polygon(next(data for topic, _, data in messages if topic != "/cube/odom"))
    samples = [decode_odometry(data) for data in odometry]

    def predict() -> None:
        predictor = Predictor(scene)
        predictor.tell(geometry)
        for sample in samples:
            predictor.update(sample)

    def decode() -> None:
        for data in odometry:
            decode_odometry(data)

    def encode() -> None:
        for prediction in predictions:
            for one in OUTPUTS.values():
                one.encode(prediction)

    predictor = Predictor(scene)
    predictor.tell(geometry)
    predictions = [predictor.update(sample) for sample in samples]
    encoded = [
        (f"{NODE}/{name}", output_.type_name, prediction.sample.stamp, data)
        for prediction in predictions
        for name, output_ in OUTPUTS.items()
        if (data := output_.encode(prediction)) is not None
    ]

    def write() -> None:
        with BagWriter(output) as writer:
            for message in encoded:
                writer.write(*message)

    # The parts are handed many objects at once, which the collector would visit again and again.
    gc.collect()
    gc.freeze()
    return {
        "reading": lambda: sum(1 for _ in read_messages(bag, TOPICS)),
        "decoding": decode,
        "predicting": predict,
        "encoding": encode,
        "writing": write,
    }


def main() -> int:
    """Print the tables; the exit status says whether the replay is fast enough."""
    bag = find("examples/cube_tosses")
    scene = read_scenes(find("config/cube_tosses.yaml"))[""]
    columns = ("median", "slowest", "fastest", "expected", "median by the wall clock")
    wholes = Table("", *columns, title=f"Samples per second, {RUNS} runs each")
    shares = Table("part", "median", "slowest", "fastest", title="us per sample, each part alone")
    fast_enough = True
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "predictions.mcap"
        samples = replay(bag, scene).samples
        for name, its_output in (("replay", None), ("replay with output", output)):
            cpu, wall = seconds(partial(replay, bag, scene, output=its_output))
            median = samples / statistics.median(cpu)
            fast_enough = fast_enough and median >= LEAST[name]
            rates = median, samples / max(cpu), samples / min(cpu), LEAST[name], samples / statistics.median(wall)
            wholes.add_row(name, *(f"{rate:,.0f}" for rate in rates))
        for name, work in parts(bag, scene, output).items():
            costs = [time / samples * 1e6 for time in seconds(work)[0]]
            shares.add_row(name, *(f"{cost:.1f}" for cost in (statistics.median(costs), max(costs), min(costs))))
    Console().print(wholes, shares)
    return 0 if fast_enough else 1


if __name__ == "__main__":
    sys.exit(in_both_forms(main))
