"""`impact-predictor demo`: recorded tosses of a cube through ROS topics."""

from __future__ import annotations

from pathlib import Path

import click

from .options import Whole, examples


@click.command(
    short_help="Play recorded tosses through ROS topics and show the predictions.",
    epilog=examples(
        "impact-predictor demo",
        "impact-predictor demo --tosses 5 -o /tmp/tosses",
    ),
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default="out/demo",
    show_default=True,
    help="Folder in which predictions and a picture are written.",
)
@click.option(
    "--tosses",
    type=Whole(min=1, max=285),
    help="Tosses to play of the 285 recorded, as many as take about half a minute unless given.",
)
def demo(output: Path, tosses: int | None) -> int:
    """Play recorded tosses of a cube through ROS topics, and show what was predicted and what happened.

    The node and a player, which also records, run as processes of their own; ROS 2 must be installed.
    """
    from ..demo import TOSSES, run_demo

    return run_demo(output, tosses or TOSSES)
