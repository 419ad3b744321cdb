"""Error against run time of many methods for touchdowns and impacts: python benchmarks/bench_accuracy.py [--quick]

Every method meets the same problems: extrapolation, integration by scipy, the laws of this program in the plane and in
three dimensions, one at a time and over arrays, and MuJoCo where it is installed. The recorded tosses of a cube are
scored by what was measured. Prints which method to choose for a wanted accuracy, and writes report.html (one page that
needs no network), report.json and report.csv into a folder; docs/report.md tells what they have. Needs plotly, Jinja2
and scipy.
"""

from __future__ import annotations

import argparse
import csv
import json
from pathlib import Path
from typing import Any

import accuracy
from accuracy.page import accuracy_page
from rich.console import Console

from impact_predictor.files import make_folder, whole
from impact_predictor.report.page import script_inside, write_html
from impact_predictor.report.table import Column, say, show, table_of

COLUMNS = [
    Column("question", lambda one: one["question"], left=True),
    Column("error below", lambda one: f"{one['accuracy']:.0e}"),
    Column("cheapest method that is so good on every scene", lambda one: accuracy.name_of(one) or "-", left=True),
    Column("us", lambda one: "-" if one["us"] is None else f"{one['us']:.3g}"),
]


def write(folder: Path, report: dict[str, Any]) -> None:
    """Write page, JSON and CSV."""
    with whole(folder / "report.json") as partial:
        partial.write_text(json.dumps(report, indent=1, allow_nan=False), encoding="utf-8")
    with whole(folder / "report.csv") as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(report["rows"][0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(report["rows"])
    write_html(folder / "report.html", accuracy_page(report, script_inside()))


def main(arguments: list[str] | None = None) -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("report"), metavar="FOLDER")
    parser.add_argument("--quick", action="store_true", help="a seventh of the problems")
    asked = parser.parse_args(arguments)
    make_folder(asked.output)  # before the long work, so that a wrong name is told at once
    report = accuracy.report(accuracy.QUICK if asked.quick else 1.0)
    write(asked.output, report)
    console = Console()
    show(console, table_of(COLUMNS, report["choices"]))
    for question, used in report["node"].items():
        say(console, f"The node answers the {question} by {accuracy.name_of(used)}: {used['why']}")
    powers = ", ".join(f"{scene} {power:.1f}" for scene, power in report["orders"].items())
    say(console, f"In three dimensions the error of the path law falls with this power of its steps: {powers}.")
    say(console, f"Page: {asked.output / 'report.html'}")


if __name__ == "__main__":
    main()
