"""`impact-predictor identify`: mass centre and inertia over mass of a recorded body, without an impact law."""

from __future__ import annotations

import json
from typing import Final

import click

from ..prediction.scene import read_scenes
from .calibrate import read_all, say_fit, status_of, write_scene
from .options import BAGS, PARAMS, choice, examples, json_flag, remap_option, seed_option, text

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
    from ..calibration.search import RESAMPLES
    from ..files import named
    from ..prediction.scene import inertia_matrix
    from ..report import identification as report
    from ..wording import counted
    from .progress import progress

    scenes, topics = read_scenes(params), remapping(remap)
    if output is not None:
        named(output, "parameter file")
    bags = tuple(bags_of(bags))
    monitors, results = read_all(bags, scenes, topics, RecordingMonitor)
    scene = next(iter(scenes.values()))
    motions = [motion for monitor in monitors for motion in monitor.motions]
    moments = MOMENTS.get(tensor, 1 if scene.inertia == inertia_matrix([scene.inertia[0][0]]) else 6)
    fitted_to = f"{counted(len(motions), 'motion')} and {RESAMPLES:,} resamples of them"
    with progress("fit", "fits", note=f"fitting mass centre and inertia to {fitted_to}") as tell:
        found = find(scene, motions, moments, seed, tell)
    if output is not None:
        write_scene(params, output, report.changes_of(found))
    if as_json:
        click.echo(json.dumps(report.as_json(found, bags), allow_nan=False))
    else:
        say_fit(report.tables(found), report.sentences(found), output)
    return status_of(bags, results)
