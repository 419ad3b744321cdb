"""What it costs to know how sure an impact is: margins, sensitivity, and points that carry uncertainty through it.

    python benchmarks/bench_confidence.py [--without-numba]

Prints medians in microseconds: for one impact of each of the paper's bodies, and for one sample of the recorded tosses
of a cube that announces a touchdown (`Predictor.update`), without and with uncertainty.
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Callable
from functools import partial
from itertools import islice
from pathlib import Path
from time import perf_counter_ns

if "--without-numba" in sys.argv:
    sys.modules["numba"] = None  # type: ignore[assignment]  # an import of it fails

import numpy as np
from rich.console import Console
from rich.table import Table
from uncertain_impact import propagate

from impact_predictor import Twist, cylinder, plate
from impact_predictor.bags.read import read_messages
from impact_predictor.mechanics.margins import margins
from impact_predictor.mechanics.sensitivity import sensitivity
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.ros.messages import ODOMETRY, POLYGON, decode_odometry, decode_polygon, encode_prediction
from impact_predictor.ros.messages.typed import encode_typed_prediction

ROOT = Path(__file__).resolve().parents[1]
TOSSES = ROOT / "examples/cube_tosses/cube_tosses.mcap"
PARAMETERS = ROOT / "config/cube_tosses.yaml"

TURNS = 30
MESSAGES = 4000
COUNTS = (32, 64, 128)

PLATE = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
CUBE = plate(length=0.1, height=0.1, mass=0.37, friction=0.18, inertia=8.1e-4, restitution=0.125)
CYLINDER = cylinder(radius=1.0, gamma=0.9, mass=2.0, friction=0.5)
CASES = {
    "plate, slides": (PLATE, PLATE.turning(-1.0)),
    "cube with slip, restitution": (CUBE, Twist(-0.3, -0.5, -10.0)),
    "cylinder, rolls over the edge": (CYLINDER, CYLINDER.turning(-1.0)),
}


def cost(function: Callable[[], object]) -> float:
    """Microseconds of a call, median of TURNS after a first one."""
    function()
    times = []
    for _ in range(TURNS):
        start = perf_counter_ns()
        function()
        times.append((perf_counter_ns() - start) * 1e-3)
    return statistics.median(times)


def impacts_table() -> Table:
    """Each body, one impact."""
    covariance = np.diag([0.02, 0.02, 0.3]) ** 2
    table = Table("one impact", "margins", "sensitivity", *(f"{n} points" for n in COUNTS), title="us, median")
    for name, (body, twist) in CASES.items():
        costs = [cost(partial(of, body, twist)) for of in (margins, sensitivity)]
        costs += [cost(partial(propagate, body, twist, covariance, 0.02, 0.02, samples=n)) for n in COUNTS]
        table.add_row(name, *(f"{value:.0f}" for value in costs))
    return table


def samples_table() -> Table:
    """The samples that announce a touchdown, in scenes that ask for more and more."""
    scene = Scene.from_parameters(validate(read_parameters(PARAMETERS)))
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


def main() -> None:
    """Print both tables."""
    console = Console()
    console.print(impacts_table())
    console.print(samples_table())


if __name__ == "__main__":
    main()
