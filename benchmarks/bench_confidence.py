"""What it costs a sample to know how sure its impact is: margins, and points that carry uncertainty through it.

    python benchmarks/bench_confidence.py [--without-numba]

Prints medians in microseconds for one sample of the recorded tosses of a cube that announces a touchdown: of
`Predictor.update`, without and with uncertainty, and of encoding what it tells.
"""

from __future__ import annotations

import statistics
import sys
from itertools import islice
from pathlib import Path
from time import perf_counter_ns

if "--without-numba" in sys.argv:
    sys.modules["numba"] = None  # type: ignore[assignment]  # an import of it fails

import numpy as np
from rich.console import Console
from rich.table import Table

from impact_predictor.bags.read import read_messages
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import read_scenes
from impact_predictor.ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon, encode_prediction
from impact_predictor.ros.messages.typed import encode_typed_prediction

ROOT = Path(__file__).resolve().parents[1]
TOSSES = ROOT / "examples/cube_tosses/cube_tosses.mcap"
PARAMETERS = ROOT / "config/cube_tosses.yaml"

MESSAGES = 4000
COUNTS = (32, 64, 128)


def samples_table() -> Table:
    """The samples that announce a touchdown, in scenes that ask for more and more."""
    scene = read_scenes(PARAMETERS)[""]
    topics = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
    messages = list(islice(read_messages(TOSSES, topics), MESSAGES))
    covariance = tuple(np.diag([1e-4] * 3 + [1e-2] * 3).ravel().tolist())
    table = Table("one sample", "update", "encoded as strings", "typed", title="us, median")
    for name, changes in (
        ("as shipped", {}),
        *((f"{n} points", {"samples": n, "friction_deviation": 0.02, "restitution_deviation": 0.02}) for n in COUNTS),
        ("margins", {"margins": True}),
    ):
        predictor = Predictor(scene._replace(**changes))  # type: ignore[arg-type]
        updates, strings, typed = [], [], []
        for topic, _, data in messages:
            if topic == "/cube/contact_geometry":
                predictor.tell(decode_polygon(data))
                continue
            sample = decode_odometry(data)._replace(twist_covariance=covariance)
            start = perf_counter_ns()
            prediction = predictor.update(sample)
            updated = perf_counter_ns()
            encode_prediction(prediction)
            told = perf_counter_ns()
            encode_typed_prediction(prediction)
            if prediction.touchdown is not None:
                updates.append((updated - start) * 1e-3)
                strings.append((told - updated) * 1e-3)
                typed.append((perf_counter_ns() - told) * 1e-3)
        table.add_row(name, *(f"{statistics.median(times):.0f}" for times in (updates, strings, typed)))
    return table


if __name__ == "__main__":
    Console().print(samples_table())
