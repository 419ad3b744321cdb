"""`impact-predictor explain`: what a scene pays for, and what it leaves out."""

from __future__ import annotations

import json

import click

from .examples import examples


@click.command(
    short_help="Tell which parts a scene has, which it leaves out, and what each costs.",
    epilog=examples(
        "impact-predictor explain config/cube_tosses.yaml",
        "impact-predictor explain scene.yaml --json",
    ),
)
@click.argument("params", metavar="PARAMS.yaml")
@click.option("--json", "as_json", is_flag=True, help="Print JSON only.")
def explain(params: str, as_json: bool) -> None:
    """Tell which parts of the predictor and of its node a scene has, which it leaves out and why.

    PARAMS.yaml is the ROS 2 parameter file of the scene. What each part costs is measured on this machine, in some
    seconds: CPU time for each sample, CPU time and memory at the start. Parts left out show what they would add.
    """
    from ..report.parts.measure import measure_parts
    from .compiling import compiling_is_said
    from .progress import progress

    with progress("measuring", "of 100", total=100) as tell, compiling_is_said():
        answer = measure_parts(params, lambda done: tell(round(done)))
    if as_json:
        click.echo(json.dumps(answer, allow_nan=False))
        return
    from rich.console import Console

    from ..report.parts.table import print_parts

    print_parts(Console(), answer)
