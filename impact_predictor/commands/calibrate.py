"""`impact-predictor calibrate`: friction, restitution and merge time from the touchdowns of recorded bags."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from ..errors import InputError
from ..prediction.scene import read_scenes
from .options import BAGS, PARAMS, examples, json_flag, remap_option, seed_option, text
from .outcomes import DAMAGED, FAILED

if TYPE_CHECKING:
    from rich.table import Table

    from ..bags.replay import Result
    from ..calibration.scene_file import NewValues
    from ..prediction.monitor import Monitor
    from ..prediction.scene import Scene
    from ..prediction.watch.slips import FrictionSeen

M = TypeVar("M", bound="Monitor")


@click.command(
    short_help="Fit friction, restitution and merge time to recorded touchdowns.",
    epilog=examples(
        "impact-predictor calibrate examples/cube_tosses --params config/cube_tosses.yaml -o fitted.yaml",
        "impact-predictor calibrate monday.mcap tuesday.mcap --params scene.yaml --inertia",
        "impact-predictor calibrate run.mcap --params scene.yaml --remap odom:=/cube/odom --json",
    ),
)
@BAGS
@PARAMS
@remap_option("Topic of an input, as for replay; may be repeated.")
@text("-o", "--output", "FILE", "Write the parameter file with the fitted values in it.")
@click.option(
    "--inertia",
    is_flag=True,
    help="Fit a factor on the inertia, too; where single corners strike, identify tells it better.",
)
@seed_option("Which resamples and folds.")
@json_flag()
def calibrate(
    bags: tuple[str, ...],
    params: str,
    remap: tuple[str, ...],
    output: str | None,
    inertia: bool,
    seed: int,
    as_json: bool,
) -> int:
    """Fit friction, restitution and merge time to the touchdowns of recorded bags, all together.

    The fit makes the mean relative error of the predicted twists least. It comes with intervals, and with an error
    on motions that it was not fitted to. What the touchdowns cannot tell stays as the parameter file gives it. The
    exit status is 3 where only a part of a bag could be read.
    """
    from ..bags.find import bags_of
    from ..bags.replay import remapping
    from ..calibration.fit import calibrate as fit
    from ..calibration.search import RESAMPLES
    from ..calibration.touchdowns import touchdowns_of
    from ..files import named
    from ..prediction.monitor import Monitor
    from ..report import calibration as report
    from ..wording import counted, words
    from .progress import compiling_is_said, progress

    scenes, topics = read_scenes(params), remapping(remap)
    if output is not None:
        named(output, "parameter file")
    bags = tuple(bags_of(bags))
    # How sure a prediction is matters to no fit.
    scenes = {body: scene._replace(samples=0, margins=False) for body, scene in scenes.items()}
    monitors, results = read_all(bags, scenes, topics, Monitor)
    seen = friction_seen(monitors)
    told = {"friction_seen": {body: [one.held, one.slid if one.slid < inf else None] for body, one in seen.items()}}
    said = [f"Friction of {body or 'the body'}, from when it held and when it slid: {seen[body]}." for body in seen]
    records = [touchdowns_of(result.settled, scenes) for result in results]
    scores = [settled.score for result in results for settled in result.settled]
    fitted_to = f"{counted(sum(map(len, records)), 'touchdown')} and {RESAMPLES:,} resamples of them"
    try:
        with progress("fit", "impacts", note=f"fitting coefficients to {fitted_to}") as tell, compiling_is_said():
            calibration = fit(records, inertia, seed, tell)
    except InputError as error:
        if reasons := report.unscored(scores):
            counts = ", ".join(f"{count:,} {words(reason)}" for reason, count in reasons.items())
            error = InputError(f"{error}; not scored are {counts}")
        if not seen or output:
            raise error from None
        click.echo(f"note: nothing is fitted: {error}", err=True)
        if as_json:
            click.echo(json.dumps(told))
        else:
            say_fit((), said)
        return status_of(bags, results)
    if output is not None:
        from ..calibration.scene_file import changes_of

        write_scene(params, output, changes_of(calibration))
    if as_json:
        fields = report.as_json(calibration, bags, scores) | (told if seen else {})
        click.echo(json.dumps(fields, allow_nan=False))
    else:
        sentences = [*report.sentences(calibration, scores), *said]
        say_fit(report.tables(calibration), sentences, output)
    return status_of(bags, results)


def friction_seen(monitors: Iterable[Monitor]) -> dict[str, FrictionSeen]:
    """What the watches have seen of the friction of each body, if anything."""
    from ..prediction.watch.slips import FrictionSeen

    found: dict[str, FrictionSeen] = {}
    for watch in [monitor.watch for monitor in monitors if monitor.watch is not None]:
        for body, seen in watch.friction_seen().items():
            found[body] = seen.and_also(found.get(body, FrictionSeen()))
    return {body: seen for body, seen in found.items() if seen != FrictionSeen()}


def say_fit(tables: Iterable[Table], sentences: Iterable[str], scene: str | None = None) -> None:
    """Print what a fit found, and the name of the scene that was written."""
    from rich.console import Console

    from ..report.table import say, show

    console = Console()
    for table in tables:
        show(console, table)
        console.print()
    say(console, *sentences)
    if scene is not None:
        click.echo(f"Scene: {scene}")


def status_of(bags: Sequence[str], results: Sequence[Result]) -> int:
    """The exit status where some bags could not be used, or not all of them."""
    if len(results) < len(bags):
        return FAILED
    return DAMAGED if any(result.damaged for result in results) else 0


def write_scene(params: str, output: str, changes: Mapping[str, NewValues]) -> None:
    """Write a parameter file with other values in it, where it can still be read then."""
    from ..calibration.scene_file import changed
    from ..files import whole

    given = Path(params).read_text(encoding="utf-8")
    with whole(Path(output)) as partial:
        partial.write_text(changed(given, changes), encoding="utf-8")
        read_scenes(str(partial))


def read_all(
    bags: tuple[str, ...], scenes: dict[str, Scene], topics: dict[str, str], monitor_of: Callable[[dict[str, Scene]], M]
) -> tuple[list[M], list[Result]]:
    """Each bag that can be used, read by a monitor of its own, and its replay; what is wrong with others is said.
    InputError where the only bag cannot be used.
    """
    from ..bags.replay import replay
    from .progress import progress

    monitors, results = [], []
    for bag in bags:
        monitor = monitor_of(scenes)
        try:
            with progress(Path(bag).name) as tell:
                result = replay(bag, scenes, topics, progress=tell, monitor=monitor)
            if result.unpredictable:
                raise InputError(f"{bag}: {result.unpredictable}")
        except InputError as error:
            if len(bags) == 1:
                raise
            click.echo(f"error: {error}", err=True)
            continue
        for note in result.notes:
            click.echo(f"note: {note}", err=True)
        if result.damaged:
            click.echo(f"warning: {result.damaged}", err=True)
        monitors.append(monitor)
        results.append(result)
    return monitors, results
