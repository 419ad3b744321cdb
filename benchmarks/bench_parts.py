"""What the features of a scene cost: CPU time for each sample, and CPU time and memory at the start.

    python benchmarks/bench_parts.py config/cube_tosses.yaml
    python benchmarks/bench_parts.py scene.yaml --rounds 9

Each row switches one feature of the scene on, or off, and nothing else; both are measured in turns. Samples are those
of `tools/made_motions.py`. The scatter is half the range over the rounds: a difference below it is none.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from typing import Any, Final

ROOT: Final = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

from fuzz_messages import encode, made_course  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.table import Table  # noqa: E402

from impact_predictor.bags.replay import replay  # noqa: E402
from impact_predictor.bags.write import BagWriter  # noqa: E402
from impact_predictor.errors import InputError  # noqa: E402
from impact_predictor.parameters.file import read_parameters  # noqa: E402
from impact_predictor.parameters.validation import validate  # noqa: E402
from impact_predictor.prediction.scene import features_of, scenes_of  # noqa: E402
from impact_predictor.ros.messages import INPUT_TYPES  # noqa: E402

SWITCHES: Final[dict[str, tuple[dict[str, Any], dict[str, Any]]]] = {
    "friction": ({"contact.friction": 0.0}, {"contact.friction": 0.3}),
    "restitution": ({"contact.restitution": 0.0}, {"contact.restitution": 0.3}),
    "twist window": ({"odom.twist_window": 0.0}, {"odom.twist_window": 0.01}),
    "onset watch": ({"onset.watch": False}, {"onset.watch": True}),
    "force sensors": ({"feet.force": 0.0}, {"feet.force": 30.0}),
    "schedule": ({"feet.has_schedule": False}, {"feet.has_schedule": True}),
    "margins": ({"margins": False}, {"margins": True}),
    "uncertainty": ({"uncertainty.samples": 0}, {"uncertainty.samples": 64, "uncertainty.friction": 0.02}),
}
"""The parameters that switch each feature off and on."""

START: Final = """
import json, os, sys, time
def memory():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") * 1e-6
values, had, began = json.load(sys.stdin), memory(), time.process_time()
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import scenes_of
monitor = Monitor(scenes_of(values))
print(1e3 * (time.process_time() - began), memory() - had)
"""


def costs(given: dict[str, Any], folder: Path) -> tuple[float, float, float]:
    """us of a sample, without its outputs; ms and MB of a start in a process of its own."""
    values, course = validate(given), made_course("", given)
    with BagWriter(folder / "made.mcap") as writer:
        for one, value in course.messages:
            writer.write(f"/{one.name}", INPUT_TYPES[one.kind].name, value.stamp, encode(value))
    us = median(replay(folder / "made.mcap", scenes_of(values)).costs) * 1e6
    command = [sys.executable, "-c", START]
    done = subprocess.run(command, input=json.dumps(values), cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    ms, mb = map(float, done.stdout.split())
    return us, ms, mb


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    given = dict(read_parameters(options.scene))
    on = {feature.name for feature in features_of(validate(given)) if feature.on}
    title = f"{Path(options.scene).stem}: what each feature adds, medians of {options.rounds} rounds"
    table = Table("feature", "", "us a sample", "scatter", "ms at the start", "MB", title=title)
    with tempfile.TemporaryDirectory() as folder:
        whole = [costs(given, Path(folder)) for _ in range(options.rounds)]
        table.add_row("this scene", "", *_cells(whole), style="bold")
        for name, (off, switched_on) in SWITCHES.items():
            other = {**given, **(off if name in on else switched_on)}
            try:
                others_on = {feature.name for feature in features_of(validate(other)) if feature.on}
            except InputError:
                continue  # such a body cannot have it
            if (name in others_on) == (name in on):
                continue  # or it has it for another reason
            added = []
            for _ in range(options.rounds):
                mine, others = costs(given, Path(folder)), costs(other, Path(folder))
                without, those = (others, mine) if name in on else (mine, others)
                added.append((those[0] - without[0], those[1] - without[1], those[2] - without[2]))
            table.add_row(name, "on" if name in on else "off", *_cells(added))
    Console().print(table)


def _cells(rows: list[tuple[float, float, float]]) -> tuple[str, str, str, str]:
    us, ms, mb = zip(*rows, strict=True)
    return f"{median(us):.1f}", f"{0.5 * (max(us) - min(us)):.1f}", f"{median(ms):.0f}", f"{median(mb):.1f}"


if __name__ == "__main__":
    main()
