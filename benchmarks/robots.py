"""Robots that walk in MuJoCo, and what their landings are.

    pip install -e '.[robot]'
    python benchmarks/robots.py [FOLDER [RUN...]]

Prints a row for each run of `impact-predictor simulate robot` with the options that it shows, 12 s and seed 0: true
landings, their speed in m/s (median and fastest), medians of the impulse of the landing foot in N s after 1, 2 and 5 ms
and up to the first peak of its force, and how many ms after the landing that is. Bags and scenes stay in the FOLDER;
`walker_times.py` and `walker_impacts.py` tell how right the predictions of them are, beside simple answers. Without a
FOLDER they are removed. Runs can be chosen by their numbers.
"""

from __future__ import annotations

import shlex
import sys
import tempfile
from pathlib import Path
from typing import Final

import numpy as np
from click.testing import CliRunner
from rich.console import Console
from rich.progress import track

from impact_predictor.bags.read import Bag
from impact_predictor.cli import main as command
from impact_predictor.report.table import plain_table, show
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY
from impact_predictor.scenarios.truth import LANDING_TOPIC, TrueLanding, decode_truths

NOISE: Final = "--noise-position 0.001 --noise-velocity 0.02"
RUNS: Final = (
    "go1",
    "go1 --rate 200",
    "go1 --rate 1000",
    "go1 --armature 0",
    "go1 --strike 0",
    f"go1 {NOISE} --delay 0.005",
    f"go1 {NOISE} --by-names",
    "go1 --drift 0.005",
    "go1 --slope 8",
    "go1 --slope -8",
    "go1 --blocks 0.005",
    "go1 --blocks 0.02",
    "go1 --blocks 0.02 --terrain",
    "go1 --stairs -0.05",
    "go1 --gait amble",
    "a1 --swing 0.25",
    "solo12",
    "anymal",
    "hyq",
    "hyq --stairs 0.05",
    "bolt",
    "talos --swing 0.4 --strike 0.3",
    "talos --swing 0.4 --strike 0.3 --gantry 10",
)


def row_of(name: str, landings: list[TrueLanding]) -> tuple[str, ...]:
    """What is printed of a run."""
    speeds = [landing.speed for landing in landings]
    impulses = np.median([[one.impulse(state) for state in one.after] for one in landings], axis=0)
    return (
        name,
        f"{len(landings)}",
        f"{np.median(speeds):.2f} / {max(speeds):.2f}",
        *[f"{impulse:.2f}" for impulse in impulses],
        f"{1e3 * np.median([one.after[-1].time for one in landings]):.2f}",
    )


def made(name: str, folder: Path) -> list[TrueLanding]:
    """The true landings of a run."""
    bag = folder / f"{'_'.join(name.replace('--', '').split())}.mcap"
    answer = CliRunner().invoke(command, ["simulate", "robot", *shlex.split(name), "-o", str(bag)])
    if not bag.exists():
        raise SystemExit(f"{name}: {answer.output}")
    with Bag(bag) as opened:
        told = [one.data for one in opened.messages({LANDING_TOPIC: DIAGNOSTIC_ARRAY})]
    return [landing for data in told for landing in decode_truths(TrueLanding, data)]


def main(arguments: list[str]) -> int:
    """Print the table."""
    chosen = [RUNS[int(number)] for number in arguments[1:]] or RUNS
    table = plain_table()
    for column in ("run", "landings", "speed", "1 ms", "2 ms", "5 ms", "peak", "after"):
        table.add_column(column, justify="left" if column == "run" else "right", no_wrap=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(arguments[0] if arguments else temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name in track(chosen, "runs", console=Console(stderr=True)):
            table.add_row(*row_of(name, made(name, folder)))
    show(Console(width=120), table)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
