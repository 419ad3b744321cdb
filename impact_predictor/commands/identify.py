"""`impact-predictor identify`: mass centre and inertia over mass of a recorded body, without an impact law."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Final

import click

from ..errors import InputError
from .calibrate import read_all, write_scene
from .options import BAGS, PARAMS, choice, examples, json_flag, remap_option, seed_option, text
from .outcomes import DAMAGED, FAILED
from .replay import read_scenes

MOMENTS: Final = {"isotropic": 1, "principal": 3, "full": 6}


@click.command(
    short_help="Find mass centre and inertia of a recorded body, without an impact law.",
    epilog=examples(
        "impact-predictor identify examples/cube_tosses --params config/cube_tosses.yaml -o identified.yaml",
        "impact-predictor identify run.mcap --params scene.yaml --remap odom:=/cube/odom --tensor full --json",
    ),
)
@BAGS
@PARAMS
@remap_option("Topic of an input, as for replay; may be repeated.")
@text("-o", "--output", "FILE", "Write the parameter file with the identified body in it.")
@choice(
    "--tensor",
    "Moments to find: one for all axes, those about the body's axes, or all six; as the scene has them.",
    "scene",
    *MOMENTS,
    default="scene",
)
@seed_option("Which resamples.")
@json_flag()
def identify(
    bags: tuple[str, ...],
    params: str,
    remap: tuple[str, ...],
    output: str | None,
    tensor: str,
    seed: int,
    as_json: bool,
) -> int:
    """Find mass centre and inertia of a body from its recorded motions, all together.

    Impacts that strike a single corner while nothing else touches tell them whatever the law of impacts is; free
    flight tells them, too, less sharply. What cannot be told stays as the parameter file gives it. The exit status is 3
    where only a part of a bag could be read.
    """
    from ..bags.find import bags_of
    from ..bags.replay import remapping
    from ..calibration.identify import identify as find
    from ..calibration.motions import RecordingMonitor
    from ..prediction.scene import inertia_matrix
    from ..report import identification as report
    from .progress import progress

    scenes, topics = read_scenes(params), remapping(remap)
    if output is not None and not Path(output).resolve().parent.is_dir():
        raise InputError(f"the folder of {output} does not exist; make it, or give another name")
    bags = tuple(bags_of(bags))
    monitors, results = read_all(bags, scenes, topics, RecordingMonitor)
    scene = next(iter(scenes.values()))
    motions = [motion for monitor in monitors for motion in monitor.motions]
    moments = MOMENTS.get(tensor, 1 if scene.inertia == inertia_matrix([scene.inertia[0][0]]) else 6)
    with progress("fit", "fits") as tell:
        found = find(scene, motions, moments, seed, tell)
    if output is not None:
        write_scene(params, output, report.changes_of(found))
    if as_json:
        click.echo(json.dumps(report.as_json(found, bags), allow_nan=False))
    else:
        from rich.console import Console

        from ..report.table import say, show

        console = Console()
        for table in report.tables(found):
            show(console, table)
            console.print()
        say(console, *report.sentences(found))
        if output is not None:
            click.echo(f"Scene: {output}")
    if len(results) < len(bags):
        return FAILED
    return DAMAGED if any(result.damaged for result in results) else 0
