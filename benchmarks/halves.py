"""A body identified and calibrated on one half of the cube tosses, its predictions judged on the other half.

    python benchmarks/halves.py

Halves are the motions of even and of odd number (`check_touchdowns.py`). From the published values on, `identify` and
`calibrate` see one half, and `uncertainty.gap` becomes that of some values with which the touchdowns of this half have
the least mean error. `replay` predicts with all this, and touchdowns of the other half are judged by themselves. Both
ways round.
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from check_touchdowns import judged, motions_of, read
from rich.console import Console
from rich.table import Table

from impact_predictor.bags.read import read_messages
from impact_predictor.bags.write import BagWriter
from impact_predictor.calibration.scene_file import NewValues, changed
from impact_predictor.parameters.file import read_values
from impact_predictor.ros.messages import ODOMETRY, POLYGON

ROOT = Path(__file__).resolve().parents[1]
BAG = ROOT / "examples/cube_tosses"
HALVES = ("even", "odd")
TYPES = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}

PUBLISHED = {
    "body.inertia": NewValues((8.1e-4,), "", listed=True),
    "body.center_of_mass": NewValues((0.0, 0.0, 0.0), "", listed=True),
    "contact.friction": NewValues((0.18,), ""),
    "contact.restitution": NewValues((0.125,), ""),
    "contact.merge": NewValues((1.5e-3,), ""),
}
"""Where every fit begins, so that nothing comes from the other half."""


GAPS = (0.0, 2e-4, 4e-4, 6e-4, 8e-4)
"""Deviations of the gaps among which the best is looked for, in m."""


def write_half(half: str, path: Path) -> None:
    """Write the motions of a half into a bag of their own."""
    track, _ = read(str(BAG))
    spans = [
        (motion.stamps[0], motion.stamps[-1])
        for number, motion in motions_of(track)
        if number % 2 == HALVES.index(half)
    ]
    with BagWriter(path) as writer:
        for topic, log_time, data in read_messages(BAG, TYPES):
            if topic != "/cube/odom" or any(begin <= log_time <= end for begin, end in spans):
                writer.write(topic, TYPES[topic], log_time, data)


def run(*arguments: object) -> None:
    command = [sys.executable, "-m", "impact_predictor", *map(str, arguments)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main() -> int:
    """Print a table of what was fitted, and the verdicts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--params", default=str(ROOT / "config/cube_tosses.yaml"), help="the scene")
    scene = Path(parser.parse_args().params).read_text()
    table = Table("fitted to", *(name.partition(".")[2] for name in (*PUBLISHED, "uncertainty.gap")))
    with TemporaryDirectory() as name:
        folder = Path(name)
        given = folder / "given.yaml"
        given.write_text(changed(scene, {**PUBLISHED, "uncertainty.gap": NewValues((-1.0,), "")}))
        for half, other in (HALVES, HALVES[::-1]):
            bag, body, fitted, out = (folder / f"{half}{end}" for end in (".mcap", "_body.yaml", ".yaml", "_out.mcap"))
            write_half(half, bag)
            run("identify", bag, "--params", given, "-o", body)
            run("calibrate", bag, "--params", body, "-o", fitted)
            text, least = fitted.read_text(), math.inf
            for gap in GAPS:
                fitted.write_text(tried := changed(text, {"uncertainty.gap": NewValues((gap,), "")}))
                run("replay", bag, "--params", fitted, "-o", out, "--json")
                error = judged(str(BAG), str(out), half)["all"].mean
                print(f"Gaps of {1e3 * gap:.1f} mm: mean error {error:.4f} on the {half} motions that were fitted")
                if error < least:
                    chosen, least = tried, error
            fitted.write_text(chosen)
            values = read_values(fitted)
            table.add_row(half, *(shown(values[name]) for name in (*PUBLISHED, "uncertainty.gap")))
            run("replay", BAG, "--params", fitted, "-o", out, "--json")
            print(f"Fitted to {half} motions, judged on {other} ones:")
            for kind, verdict in judged(str(BAG), str(out), other).items():
                print(f"  {kind:14s} {verdict}")
    Console(width=120).print(table)
    return 0


def shown(value: object) -> str:
    """A value of a parameter file with four digits."""
    return ", ".join(f"{one:.4g}" for one in (value if isinstance(value, tuple | list) else (value,)))


if __name__ == "__main__":
    sys.exit(main())
