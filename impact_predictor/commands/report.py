"""`impact-predictor report`: error against run time of every method, as a page and as data."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from ..errors import InputError, need
from .options import examples

if TYPE_CHECKING:
    from rich.table import Table

    from ..report.accuracy.rows import Report

PAGE: Final = "report.html"
DATA: Final = "report.json"
CELLS: Final = "report.csv"


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
    help=f"Folder for {PAGE}, {DATA} and {CELLS}; made if there is none. [default: report, with --json none]",
)
@click.option("--quick", is_flag=True, help="Fewer problems and repetitions: a minute instead of several.")
@click.option("--json", "as_json", is_flag=True, help="Print the report as JSON.")
def report(output: Path | None, quick: bool, as_json: bool) -> None:
    """Compare error and run time of many methods for touchdowns and impacts.

    Every method meets the same problems, beside a reference of 40 digits: extrapolation, quadrature, integration, time
    stepping, compliant contacts, closed forms, the laws of this program, and MuJoCo where it is installed. The recorded
    tosses of a cube are scored by what was measured. One page shows error over run time, and which method to choose for
    a wanted accuracy; the same stands in a JSON and a CSV file.
    """
    folder = output or (None if as_json else Path("report"))
    if folder is not None:
        make(folder)
    found = measured(quick, folder)
    from ..report.accuracy.rows import to_json

    fields = to_json(found)
    if folder is not None:
        write(folder, found, fields)
    if as_json:
        click.echo(json.dumps(fields, allow_nan=False))
        return

    from rich.console import Console

    from ..report.table import show

    show(Console(), table_of(found))
    for question, default in found.node.items():
        name = ", ".join(filter(None, (default.method, default.setting)))
        click.echo(f"The node answers the {question} by {name}: {default.why}")
    for note in found.notes:
        click.echo(f"note: {note}", err=True)
    assert folder is not None
    click.echo(f"Page: {folder / PAGE}")


def make(folder: Path) -> None:
    """Make the folder before the long work, so that a wrong name is told at once.

    Raises:
        InputError: it cannot be made or written into.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"the folder {folder} cannot be made: {error.strerror}; give another name") from error
    if not os.access(folder, os.W_OK):
        raise InputError(f"the folder {folder} cannot be written into; give another name")


def measured(quick: bool, folder: Path | None) -> Report:
    """The report, with a bar on standard error.

    Raises:
        InputError: what the references are computed with is not installed.
    """
    need("mpmath", "scipy")
    from ..report.accuracy.study import FULL, QUICK, steps
    from ..report.accuracy.study import report as measure
    from .progress import compiling_is_said, progress

    size = QUICK if quick else FULL
    command = "impact-predictor report" + (" --quick" if quick else "") + (f" -o {folder}" if folder else " --json")
    with compiling_is_said(), progress("report", "methods", steps(size)) as tell:
        return measure(size, command, tell)


def write(folder: Path, found: Report, fields: dict[str, Any]) -> None:
    """Write page, JSON and CSV: each under another name first, so that none is ever there by half.

    Raises:
        InputError: a file cannot be written.
    """
    from ..report.accuracy.rows import write_csv
    from ..report.files import whole
    from ..report.page.write import write_page

    writers: dict[str, Callable[[Path], object]] = {
        DATA: lambda file: file.write_text(json.dumps(fields, indent=1, allow_nan=False), encoding="utf-8"),
        CELLS: lambda file: write_csv(file, found.rows),
        PAGE: lambda file: write_page(file, fields),
    }
    for name, writer in writers.items():
        with whole(folder / name) as partial:
            writer(partial)


def table_of(found: Report) -> Table:
    """The cheapest method for each wanted accuracy that holds on every computed scene, and what the node uses."""
    from ..report.accuracy.rows import ACCURACIES, ALL_SCENES
    from ..report.table import plain_table

    table = plain_table()
    table.add_column("question", no_wrap=True)
    table.add_column("error below", justify="right", no_wrap=True)
    table.add_column("cheapest method that is so good on every scene", no_wrap=True)
    table.add_column("us", justify="right", no_wrap=True)
    for question, scene, accuracy, row in found.choices:
        if scene == ALL_SCENES:
            name = "-" if row is None else ", ".join(filter(None, (row.method, row.setting)))
            first = accuracy == ACCURACIES[0]
            if first and table.row_count:
                table.add_section()
            table.add_row(question if first else "", f"{accuracy:.0e}", name, "-" if row is None else f"{row.us:.3g}")
    return table
