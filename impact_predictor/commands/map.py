"""`impact-predictor map`: which mode follows an impact, over any two parameters of a body."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from ..errors import need
from ..files import named
from .options import LAW, examples, json_flag, number, together

if TYPE_CHECKING:
    from ..report.map import Axis, MapParameter

PICTURES: Final = (".png", ".svg")
SUFFIXES: Final = (*PICTURES, ".csv")
MOST_CELLS: Final = 5000

EXAMPLES: Final = {
    "plate": (
        "impact-predictor map plate",
        "impact-predictor map plate --a 0.3 --b 0.7 -o plate.svg -o plate.csv",
        "impact-predictor map plate --slip -1 --x delta 0.1 6 --y friction 0 4",
    ),
    "rod": (
        "impact-predictor map rod",
        "impact-predictor map rod --friction 0.3 --x a 0 0.2 --y b 0 0.2 -o rod.svg",
    ),
    "cylinder": (
        "impact-predictor map cylinder",
        "impact-predictor map cylinder --friction 0.4 --x gamma 0 90 --y gamma-new 0 90 --law total",
        "impact-predictor map cylinder --gamma 50 --x inertia 0.1 1 --y friction 0 1 --json",
    ),
}
WHAT: Final = {
    "plate": ("A plate, crate or block on a flat floor", "Fig. 5 of the paper, friction over height by length"),
    "rod": ("A rod over two supports", "friction over the distance of both from the middle"),
    "cylinder": ("A cylinder that rolls from one edge onto another", "Fig. 7 of the paper, friction over angle"),
}
"""Each body, and what its map shows unless something else is asked for."""


class Maps(click.Group):
    """A command for each body, made when it is asked for: its options are the parameters of the body."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(WHAT)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        return command_of(cmd_name) if cmd_name in WHAT else None


@click.group(
    "map",
    cls=Maps,
    short_help="Draw which mode follows an impact, over two parameters.",
    no_args_is_help=False,
    epilog=examples(*(lines[0] for lines in EXAMPLES.values()), EXAMPLES["plate"][2]),
)
def map_() -> None:
    """Draw which mode follows an impact, over two parameters of a body.

    The regions are what the impact law says, cell by cell; the curves are the paper's formulas, drawn where they hold.
    Any parameter can be an axis, the others are numbers. SI units; angles in degrees.
    """


def command_of(name: str) -> click.Command:
    """The command that draws maps of one body: its parameters are options."""
    from ..report.map import SUBJECTS, option_of

    subject = SUBJECTS[name]

    def axis(option: str, default: Axis, where: str) -> Callable[[Any], Any]:
        shown = f"{option_of(default.name)} {default.low:g} {default.high:g}"
        says = f"Parameter that grows {where}, by its name above. [default: {shown}]"
        return click.option(option, type=(str, float, float), metavar="NAME LOW HIGH", help=says)

    options = together(
        *[number(f"--{option_of(one)}", help_of(says)) for one, says in subject.parameters.items()],
        axis("--x", subject.x, "along"),
        axis("--y", subject.y, "upwards"),
        LAW,
        number("--resolution", "Cells along each axis.", 1000, type=click.IntRange(2, MOST_CELLS), metavar="N"),
        click.option(
            "-o",
            "--output",
            type=click.Path(path_type=Path),
            multiple=True,
            metavar="FILE",
            help="Picture (.png, .svg) or data (.csv); may be repeated. "
            f"[default: map_{name}.png, with --json no file]",
        ),
        json_flag("Print the shares of the modes as JSON."),
    )
    body, shown = WHAT[name]
    return click.command(
        name,
        short_help=f"{body}.",
        help=f"{body}: {shown}, or what else you ask for.",
        epilog=examples(*EXAMPLES[name]),
    )(options(partial(draw, name)))


def help_of(parameter: MapParameter) -> str:
    """The help of an option: meaning, unit and what it is unless given."""
    unit = f", {parameter.unit}" if parameter.unit else ""
    default = parameter.default if isinstance(parameter.default, str) else f"{parameter.default:g}"
    meaning = parameter.meaning[0].upper() + parameter.meaning[1:]
    return f"{meaning}{unit}." + (f" [default: {default}]" if default else "")


def draw(
    name: str,
    x: tuple[str, float, float] | None,
    y: tuple[str, float, float] | None,
    law: str,
    resolution: int,
    output: tuple[Path, ...],
    as_json: bool,
    **parameters: float | None,
) -> None:
    """Compute a map, write its files and say what it shows."""
    from ..report.map import SUBJECTS, Axis, fixed_values, map_modes, shares_table, summary_of, write_csv
    from .progress import compiling_is_said, progress

    across, upwards = (
        Axis(asked[0].replace("-", "_"), *asked[1:]) if asked else most
        for asked, most in ((x, SUBJECTS[name].x), (y, SUBJECTS[name].y))
    )
    given = {name: value for name, value in parameters.items() if value is not None}
    fixed = fixed_values(SUBJECTS[name], (across, upwards), given)
    files = output or (() if as_json else (Path(f"map_{name}.png"),))
    for file in files:
        named(file, "picture or data", SUFFIXES)
        if file.suffix.lower() in PICTURES:
            need("contourpy", "matplotlib")
    with compiling_is_said(), progress(name, "cells", resolution * resolution) as tell:
        modes = map_modes(name, across, upwards, fixed, law, resolution, tell)
    for file in files:
        if file.suffix.lower() == ".csv":
            write_csv(file, modes)
        else:
            from ..report.map_figure import write_map

            write_map(file, modes)
    if as_json:
        click.echo(json.dumps(summary_of(modes), indent=2, allow_nan=False))
        return
    from rich.console import Console

    from ..report.table import show

    show(Console(), shares_table(modes))
    for file in files:
        click.echo(f"{'Picture' if file.suffix.lower() in PICTURES else 'Data'}: {file}")
