"""`impact-predictor replay`: recorded bags through the predictor."""

from __future__ import annotations

import json
from collections import Counter
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from ..errors import InputError
from .examples import examples

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..prediction.scene import Scene
    from .baseline import Baseline

CHANGED: Final = 1
"""Exit status where something has changed against a baseline."""

FAILED: Final = 2
DAMAGED: Final = 3
"""Exit status where the readable part of a bag was used."""


@click.command(
    short_help="Predict and score the touchdowns in recorded bags.",
    epilog=examples(
        "impact-predictor replay examples/cube_tosses --params config/cube_tosses.yaml",
        "impact-predictor replay run.mcap --params scene.yaml --remap odom:=/cube/odom -o predictions.mcap --json",
        "impact-predictor replay voyage.mcap --params config/deck_many.yaml --remap support/odom:=/deck/odom",
        "impact-predictor replay examples/hyq/hyq.bag --params config/walker_hyq.yaml --figure gait.png",
        "impact-predictor replay monday.mcap tuesday.mcap --params scene.yaml -o predictions --figure errors.png",
        "impact-predictor replay run.mcap --params scene.yaml --baseline predictions.mcap",
    ),
)
@click.argument("bags", nargs=-1, required=True, metavar="BAG...")
@click.option("--params", required=True, metavar="FILE", help="ROS 2 parameter file of the scene.")
@click.option(
    "-r",
    "--remap",
    multiple=True,
    metavar="FROM:=TO",
    help="Topic of an input: odom, contact_geometry, joint_states, crate/odom, support/odom ...; may be repeated.",
)
@click.option(
    "-o",
    "--output",
    metavar="NAME",
    help="Write the predictions: NAME.mcap is one file, any other name a rosbag2 folder; with several bags, "
    "a folder with one file for each. The folder that it is in must be there.",
)
@click.option("--markers", is_flag=True, help="Write the markers for RViz and Foxglove too, into the output.")
@click.option(
    "--figure",
    metavar="FILE",
    help="Draw errors and velocities, of a walking machine its gait, into a .png or .svg file.",
)
@click.option("--all", "every", is_flag=True, help="List every touchdown, not only the first scored ones.")
@click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print JSON only: an object, or a list for several bags; docs/replay.md has its keys and units.",
)
@click.option(
    "--baseline",
    metavar="RUN",
    help="Tell what has changed against an earlier run: what it wrote with -o, or printed with --json.",
)
@click.option(
    "--baseline-time",
    type=click.FloatRange(min=0.0),
    default=1e-3,
    show_default=True,
    help="Times that differ by up to so many s have not changed.",
)
@click.option(
    "--baseline-error",
    type=click.FloatRange(min=0.0),
    default=0.01,
    show_default=True,
    help="Errors and velocities that differ by up to this part of 1 have not changed.",
)
def replay(
    bags: tuple[str, ...],
    params: str,
    remap: tuple[str, ...],
    output: str | None,
    markers: bool,
    figure: str | None,
    every: bool,
    as_json: bool,
    baseline: str | None,
    baseline_time: float,
    baseline_error: float,
) -> int:
    """Predict the touchdowns in recorded bags as the node would, and score them by what was recorded after them.

    A BAG is an .mcap file, a rosbag2 folder or a ROS 1 .bag file. Topics are found by the names of the inputs; for a
    body without a name the only other topic of the right type is taken too, or the only one whose messages have an
    adapter (docs/adapters.md), and where there are several, --remap says which. What is the deck is never guessed, nor
    a plan or a force of feet. The exit status is 3 where only a part of a bag could be read, and 1 where something has
    changed against a baseline.
    """
    from ..bags.replay import remapping

    if markers and output is None:
        raise InputError("--markers are written into an output: give its name with -o")
    scenes = read_scenes(params)
    topics = remapping(remap)
    outputs = outputs_of(bags, output)
    earlier: Baseline | None = None
    if baseline is not None:
        from .baseline import Baseline

        earlier = Baseline(baseline, bags, baseline_time, baseline_error)
    if figure is not None:
        from ..report.figure import check_figure

        check_figure(figure)
    results: list[Result] = []
    answers: list[dict[str, Any]] = []
    for bag, its_output in zip(bags, outputs, strict=True):
        try:
            result = replay_one(bag, scenes, topics, its_output, markers)
        except InputError as error:
            if len(bags) == 1:
                raise
            click.echo(f"error: {error}", err=True)
            answers.append({"bag": bag, "error": str(error)})
            continue
        results.append(result)
        if as_json:
            from ..report.summary import as_json as fields_of

            answers.append(fields_of(result))
        else:
            print_result(result, every, its_output)
        if earlier is not None:
            told = earlier.judge(result, every, as_json)
            if as_json:
                answers[-1] |= told
    if as_json:
        click.echo(json.dumps(answers if len(bags) > 1 else answers[0], allow_nan=False))
    elif len(results) > 1:
        print_all_together(results)
    if figure is not None and results:
        draw(figure, results)
        if not as_json:
            click.echo(f"Picture: {figure}")
    if len(results) < len(bags) or any(result.unpredictable for result in results):
        return FAILED
    if any(result.damaged for result in results):
        return DAMAGED
    return CHANGED if earlier is not None and earlier.has_changed else 0


def read_scenes(params: str) -> dict[str, Scene]:
    """The scenes of the bodies of a parameter file, by their names.

    Raises:
        InputError: the file cannot be read, or a parameter is wrong.
    """
    from ..parameters.file import read_values
    from ..prediction.scene import scenes_of

    return scenes_of(read_values(params))


def outputs_of(bags: tuple[str, ...], output: str | None) -> list[Path | None]:
    """Where the predictions of each bag go: one output, or a file for each of several bags in a folder.

    Raises:
        InputError: the files of two bags would have one name, or the folder cannot be made.
    """
    if output is None:
        return [None for _ in bags]
    if len(bags) == 1:
        return [Path(output)]
    folder = Path(output)
    if folder.suffix == ".mcap":
        raise InputError(f"{output} is one file, but {len(bags)} bags are given; give the name of a folder")
    from ..report.earlier import name_of

    files = [folder / f"{name_of(bag)}.mcap" for bag in bags]
    twice = [file for file, count in Counter(files).items() if count > 1]
    if twice:
        raise InputError(f"{twice[0]} would be written for two bags; replay bags of one name one after the other")
    if not folder.absolute().parent.exists():
        raise InputError(f"the folder of {output} does not exist; make it, or give another name")
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"the folder {output} cannot be made: {error.strerror}") from error
    return list(files)


def replay_one(
    bag: str, scenes: dict[str, Scene], topics: dict[str, str], output: Path | None, markers: bool
) -> Result:
    """Replay a bag, and say on standard error what was chosen or is wrong."""
    from ..bags.replay import replay as replay_bag
    from .compiling import compiling_is_said
    from .progress import progress

    samples = any(scene.samples for scene in scenes.values())
    with progress(Path(bag).name) as tell, compiling_is_said() if samples else nullcontext():
        result = replay_bag(bag, scenes, topics, output, tell, markers)
    for note in result.notes:
        click.echo(f"note: {note}", err=True)
    if result.unpredictable:
        click.echo(f"error: {bag}: {result.unpredictable}", err=True)
    if result.damaged:
        click.echo(f"warning: {result.damaged}", err=True)
    return result


def print_result(result: Result, every: bool, output: Path | None) -> None:
    """Print the tables of one bag."""
    from rich.console import Console

    from ..report.replay import print_replay

    print_replay(Console(), result, every)
    if output is not None:
        click.echo(f"Predictions: {output}")


def print_all_together(results: list[Result]) -> None:
    """Print what several bags say together."""
    from ..report.replay import concluded

    click.echo(f"\n{len(results)} bags together")
    for sentence in concluded(settled for result in results for settled in result.settled):
        click.echo(sentence)


def draw(path: str, results: list[Result]) -> None:
    """Draw one picture of all bags.

    Raises:
        InputError: it cannot be written.
    """
    if any(result.gaits for result in results):
        from ..report.gait import machines_of, write_gait

        write_gait(path, machines_of(results))
        return
    from ..report.figure import write_figure
    from ..report.summary import error_by_lead_time, row_of
    from ..report.table import conclusions

    rows = [row_of(*settled) for result in results for settled in result.settled]
    errors = error_by_lead_time(settled.score for result in results for settled in result.settled)
    names = ", ".join(Path(result.bag).name for result in results[:3]) + (", ..." if len(results) > 3 else "")
    write_figure(path, rows, errors, f"{names}: {conclusions(rows)[0].rstrip('.')}")
