"""`impact-predictor report`: error against run time of every method, as a page and as data."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import click

from ..errors import need
from ..files import make_folder, whole, write_text
from .options import examples, json_flag


@click.command(
    short_help="Compare error and run time of many methods, as a page.",
    epilog=examples(
        "impact-predictor report -o report",
        "impact-predictor report --quick -o report",
        "impact-predictor report --quick --json",
    ),
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Folder for report.html, .json and .csv; made if there is none. [default: report, with --json none]",
)
@click.option("--quick", is_flag=True, help="A seventh of the problems.")
@json_flag("Print the report as JSON.")
def report(output: Path | None, quick: bool, as_json: bool) -> None:
    """Compare error and run time of many methods for touchdowns and impacts.

    Every method meets the same problems: extrapolation, integration by scipy, the laws of this program in the plane and
    in three dimensions. The recorded tosses of a cube are scored by what was measured.
    One page shows error over run time, and which method to choose for a wanted accuracy; the same stands in a JSON and
    a CSV file.
    """
    folder = output or (None if as_json else Path("report"))
    if folder is not None:
        # Before the long work, so that a wrong name is told at once.
        make_folder(folder)
    need(*(["plotly", "jinja2"] if folder else []), "scipy")
    from ..report import accuracy
    from .progress import compiling_is_said, progress

    command = "impact-predictor report" + (" --quick" if quick else "") + (f" -o {folder}" if folder else " --json")
    number = accuracy.number_of_rows()
    note = f"measuring error and run time of {number} pairs of a method and a scene"
    with compiling_is_said(), progress("report", "methods", number, note) as tell:
        tell(0)
        fields = accuracy.report(accuracy.QUICK if quick else 1.0, command, tell)
    if folder is not None:
        write(folder, fields)
    if as_json:
        click.echo(json.dumps(fields, allow_nan=False))
        return

    from rich.console import Console

    from ..report.accuracy.page import CHOICE_COLUMNS
    from ..report.table import Column, say, show, table_of

    console, question = Console(), Column("question", lambda one: one["question"], left=True)
    show(console, table_of([question, *CHOICE_COLUMNS], fields["choices"]))
    for question, used in fields["node"].items():
        say(console, f"The node answers the {question} by {accuracy.name_of(used)}:", used["why"])
    say(console, f"Page: {folder}/report.html")


def write(folder: Path, fields: dict[str, Any]) -> None:
    """Write JSON, CSV and page; InputError where a file cannot be written."""
    from ..report.accuracy.page import accuracy_page
    from ..report.page import script_inside

    write_text(folder / "report.json", json.dumps(fields, indent=1, allow_nan=False))
    with whole(folder / "report.csv") as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(fields["rows"][0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(fields["rows"])
    write_text(folder / "report.html", accuracy_page(fields, script_inside()))
