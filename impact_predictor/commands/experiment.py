"""`impact-predictor bench experiment`: the paper's falling rods, predicted and observed."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

import click

from .options import Real, examples

if TYPE_CHECKING:
    from rich.table import Table

    from ..report.experiment import RodTrial

MILLIMETRES: Final = 1e3
SYMMETRIC: Final = (*range(10, 111, 20), 115, 116, *range(130, 191, 20), 200)
"""mm from the middle to both supports; nearer than 10 mm the paper says nothing."""

STANDS: Final = 1e-9
"""A ratio of angular velocities below this is rounding."""

VERY_CLOSE: Final = ((10, 200), (10, 100), (20, 200), (50, 200))
"""mm from the middle to the old and to the new support."""


@click.command(
    "experiment",
    short_help="Predict the paper's falling rods, beside what it observed.",
    epilog=examples("impact-predictor bench experiment", "impact-predictor bench experiment --angle 30 --json"),
)
@click.option("--friction", type=Real(0.0, 100.0), default=0.4, show_default=True, help="Of rod and supports.")
@click.option(
    "--angle",
    type=Real(0.0, 90.0, min_open=True, max_open=True),
    default=15.0,
    show_default=True,
    metavar="DEGREES",
    help="From which the rods are released; in the experiment 15 to 30.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON only.")
def experiment(friction: float, angle: float, as_json: bool) -> None:
    """Predict the paper's falling rods, beside what it observed.

    Rods of 400 mm turn about one support and strike a second one (Polukoshko and Sokolova, section 2.2). Where rigid
    theory is too simple for what was seen, the prediction itself says so by a flag.
    """
    from ..report.experiment import THICKNESSES, border, trial

    even = [
        [trial(thickness, a / MILLIMETRES, a / MILLIMETRES, friction, angle) for thickness in THICKNESSES]
        for a in SYMMETRIC
    ]
    close = [
        [trial(thickness, a / MILLIMETRES, b / MILLIMETRES, friction, angle) for thickness in THICKNESSES]
        for a, b in VERY_CLOSE
    ]
    borders = {thickness: border(thickness, friction) for thickness in THICKNESSES}
    trials = [trial for row in (*even, *close) for trial in row]
    if as_json:
        answer = {
            "borders": [{"thickness": h, "a": a} for h, a in borders.items()],
            "trials": list(map(fields, trials)),
        }
        click.echo(json.dumps(answer, indent=2, allow_nan=False))
        return

    from rich.console import Console

    from ..report.table import show

    console = Console()
    for heading, rows in (
        ("Supports at the same distance from the middle of the rod", even),
        ("The old support close to the middle, the new one farther", close),
    ):
        console.print(f"{heading}\n", highlight=False)
        show(console, table_of(rows))
        console.print()
    at = ", ".join(f"{a * MILLIMETRES:.1f} mm ({h * MILLIMETRES:g} mm thick)" for h, a in borders.items())
    others = [trial for trial in trials if not trial.agrees]
    said = sum(trial.doubted for trial in others)
    for line in (
        "Numbers: omega after over omega before.  *: seen otherwise.",
        "t, s: the prediction itself warns that rigid theory is too simple (flags THIN_BODY, SLOW_IMPACT).",
        "Seen: what the paper says of all its rods in words; it has no table of them.\n",
        f"Predicted: with a = b the rod stops from a = {at}.",
        "Seen: sticking from a = 115.5 mm and no sliding; rods of 2 mm rebound at both supports everywhere (FLIGHT).",
        f"As seen: {len(trials) - len(others)} of {len(trials)}; of the {len(others)} others {said} are flagged.",
    ):
        console.print(line, highlight=False, soft_wrap=True)


def fields(trial: RodTrial) -> dict[str, object]:
    """A trial as JSON has it."""
    return {
        "thickness": trial.thickness,
        "a": trial.a,
        "b": trial.b,
        "predicted": trial.outcome.mode.name,
        "observed": trial.observed.name,
        "omega_ratio": trial.ratio,
        "gravity_share": trial.gravity_share,
        "flags": [flag.name for flag in type(trial.outcome.flags) if flag & trial.outcome.flags],
    }


def table_of(rows: list[list[RodTrial]]) -> Table:
    """One row for each place of the supports, one column for each thickness.

    The last column is what was seen of all but the thinnest, which was seen to rebound everywhere.
    """
    from ..report.table import Column, table_of

    thicknesses = tuple(f"predicted\n{trial.thickness * MILLIMETRES:g} mm thick" for trial in rows[0])
    columns = [
        Column("a\nmm", lambda row: f"{row[0].a * MILLIMETRES:g}"),
        Column("b\nmm", lambda row: f"{row[0].b * MILLIMETRES:g}"),
        Column(thicknesses, lambda row: tuple(map(cell, row)), left=True),
        Column("seen", lambda row: row[0].observed.name, left=True),
    ]
    return table_of(columns, rows)


def cell(trial: RodTrial) -> str:
    """The predicted mode, how much of the rate is left, and whether that is doubted or not what was seen."""
    from ..mechanics.types import Flag

    marks = [mark for mark, flag in (("t", Flag.THIN_BODY), ("s", Flag.SLOW_IMPACT)) if flag & trial.outcome.flags]
    left = f" {trial.ratio:.2f}" if abs(trial.ratio) > STANDS else ""
    return f"{trial.outcome.mode.name}{left} {'' if trial.agrees else '*'}{''.join(marks)}".rstrip()
