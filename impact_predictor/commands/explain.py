"""`impact-predictor explain`: what a scene has, what it leaves out, and why."""

from __future__ import annotations

import json
from pathlib import Path

import click

from .options import examples, json_flag


@click.command(
    short_help="Tell which features a scene has, which it leaves out, and why.",
    epilog=examples("impact-predictor explain config/cube_tosses.yaml", "impact-predictor explain scene.yaml --json"),
)
@click.argument("params", metavar="PARAMS.yaml")
@json_flag()
def explain(params: str, as_json: bool) -> None:
    """Tell which features of the predictor and of its node a scene has, which it leaves out and why.

    PARAMS.yaml is the ROS 2 parameter file of the scene. What is left out is neither imported nor subscribed to. The
    parameter that is named switches a feature on or off. The last line says whether the predictor runs compiled.
    """
    from ..native import form
    from ..parameters.file import read_values
    from ..prediction.scene import features_of, inputs_of, scenes_of

    values = read_values(params)
    scene, features = Path(params).stem, features_of(values)
    topics = [one.name for one in inputs_of(scenes_of(values))]
    if as_json:
        parts = [one._asdict() for one in features]
        click.echo(json.dumps({"scene": scene, "parts": parts, "topics": topics, "runs": form()}))
        return
    from rich.console import Console
    from rich.markup import escape

    from ..report.table import Column, show, table_of

    columns = [
        Column("feature", lambda one: one.name, left=True),
        Column("", lambda one: "on" if one.on else "off", left=True),
        Column("why", lambda one: escape(one.why), left=True, fold=40),
    ]
    rows = sorted(features, key=lambda feature: not feature.on)
    table = table_of(columns, rows, lambda one: "" if one.on else "dim")
    console = Console()
    console.print(f"[bold]{escape(scene)}[/]: what this scene has, and what it leaves out\n", highlight=False)
    show(console, table)
    console.print(f"\nThe node subscribes to {' and '.join(topics)}.", highlight=False, markup=False, soft_wrap=True)
    console.print(f"The predictor runs {form()}.", highlight=False, markup=False, soft_wrap=True)
