"""`impact-predictor replay`: recorded bags through the predictor, one after the other or on workers."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import InputError
from ..parameters.file import read_values
from ..prediction.scene import scenes_of
from .options import BAGS, PARAMS, examples, json_flag, number, remap_option, text
from .progress import compiling_is_said, progress, say_unfinished

if TYPE_CHECKING:
    from ..fleet.job import BagOutcome, Job


@click.command(
    short_help="Predict and score the touchdowns in recorded bags.",
    epilog=examples(
        "impact-predictor replay examples/cube_tosses --params config/cube_tosses.yaml",
        "impact-predictor replay run.mcap --params scene.yaml --remap odom:=/cube/odom -o predictions.mcap --json",
        "impact-predictor replay voyage.mcap --params config/deck_many.yaml --remap support/odom:=/deck/odom",
        "impact-predictor replay examples/hyq/hyq.bag --params config/walker_hyq.yaml --report gait.html",
        "impact-predictor replay monday.mcap tuesday.mcap --params scene.yaml -o predictions --report errors.html",
        "impact-predictor replay runs --params scene.yaml --workers 2 --table results.parquet",
    ),
)
@BAGS
@PARAMS
@remap_option("Topic of an input: odom, contact_geometry, joint_states, crate/odom, support/odom ...; may be repeated.")
@text(
    "-o",
    "--output",
    "NAME",
    "Write the predictions: NAME.mcap is one file, a name without an ending a rosbag2 folder; with several bags, "
    "a folder with one file for each. The folder that it is in must be there.",
)
@click.option("--markers", is_flag=True, help="Write the markers for RViz and Foxglove too, into the output.")
@text(
    "--report",
    "FILE",
    "Write a page about all bags into one .html file; a name without an ending is a folder with one of each bag too.",
)
@text(
    "--table",
    "FILE",
    "Write the touchdowns of all bags into one .parquet or .csv file; docs/fleets.md has its columns.",
)
@text(
    "--series",
    "FILE",
    "Write what a watch over a deck saw, four rows a second, into one .parquet or .csv file: docs/deck.md.",
)
@click.option("--all", "every", is_flag=True, help="List every touchdown, not only the first scored ones.")
@json_flag("Print JSON only: an object, or a list for several bags; docs/replay.md has its keys and units.")
@number(
    "--workers",
    "Replay so many bags at a time, each in a process of its own.",
    1,
    type=click.IntRange(min=1),
    metavar="N",
)
@text(
    "--scheduler",
    "ADDRESS",
    "Replay the bags on the workers of this Dask scheduler, as in tcp://host:8786; they open the same paths.",
)
def replay(
    bags: tuple[str, ...],
    params: str,
    remap: tuple[str, ...],
    output: str | None,
    markers: bool,
    workers: int,
    scheduler: str | None,
    **wanted: Any,
) -> int:
    """Predict the touchdowns in recorded bags as the node would, and score them by what was recorded after them.

    A BAG is an .mcap or .db3 file, a rosbag2 folder, a ROS 1 .bag file, or a folder or a pattern of many. Topics are
    found by the names of the inputs; for a body without a name the only other topic of the right type is taken too, or
    the only one whose messages have an adapter (docs/adapters.md), and where there are several, --remap says which.
    What is the deck is never guessed, nor a plan or a force of feet. The exit status is 3 where only a part of a bag
    could be read.
    """
    from ..bags.find import bags_of
    from ..bags.replay import remapping
    from ..fleet.job import Job
    from .outcomes import ReplayReport, Wanted

    if markers and output is None:
        raise InputError("--markers are written into an output: give its name with -o")
    asked = Wanted(**wanted)
    bags = tuple(bags_of(bags))
    values = read_values(params)
    form = str(values["messages"])
    job = Job(scenes_of(values), remapping(remap), markers, asked.answers, asked.logs, form)
    stopped: BaseException | None = None
    with ExitStack() as stack:
        report = ReplayReport(bags, asked, stack)
        outputs = outputs_of(bags, output)
        stack.enter_context(folders_of(outputs))
        if scheduler is not None or min(workers, len(bags)) > 1:
            outcomes = on_workers(job, bags, outputs, workers, scheduler)
        else:
            outcomes = one_by_one(job, bags, outputs)
        try:
            with closing(outcomes):
                for outcome, its_output in zip(outcomes, outputs, strict=True):
                    if outcome.error and len(bags) == 1:
                        raise InputError(outcome.error)
                    report.take(outcome, its_output)
        except (KeyboardInterrupt, InputError) as error:
            done = report.number
            if done:
                stopped = error
                click.echo(f"note: stopped after {done:,} of {len(bags):,} bags; what they gave is kept", err=True)
            if isinstance(error, KeyboardInterrupt):
                say_unfinished(outputs[done:], scheduler)
            if stopped is None:
                raise
        report.finish()
    report.say_table()
    if stopped is not None:
        raise stopped
    return report.status


def outputs_of(bags: Sequence[str], output: str | None) -> list[Path | None]:
    """Where the predictions of each bag go: one output, or a file for each of several bags in a folder; InputError
    where a bag is there twice, or there is no place for the folder.
    """
    if output is None:
        return [None for _ in bags]
    if len(bags) == 1:
        return [Path(output)]
    folder = Path(output)
    if folder.suffix == ".mcap":
        raise InputError(f"{output} is one file, but {len(bags)} bags are given; give the name of a folder")
    from ..bags.find import names_of

    files = [folder / f"{name}.mcap" for name in names_of(bags)]
    if not folder.absolute().parent.exists():
        raise InputError(f"the folder of {output} does not exist; make it, or give another name")
    return list(files)


@contextmanager
def folders_of(outputs: Sequence[Path | None]) -> Iterator[None]:
    """The folders of several outputs; those that were made for them and are empty at the end are removed. InputError
    where a folder cannot be made.
    """
    # That of a single output must be there.
    files = [file for file in outputs if file is not None] if len(outputs) > 1 else []
    made: list[Path] = []
    try:
        try:
            for folder in dict.fromkeys(folder for file in files for folder in reversed(file.parents)):
                if not folder.is_dir():
                    folder.mkdir()
                    made.append(folder)
        except OSError as error:
            raise InputError(f"the folder {error.filename} cannot be made: {error.strerror}") from error
        yield
    finally:
        for folder in reversed(made):
            with suppress(OSError):
                folder.rmdir()


def one_by_one(job: Job, bags: Sequence[str], outputs: Sequence[Path | None]) -> Generator[BagOutcome]:
    """What became of each bag, replayed here."""
    from ..fleet.job import replay_bag

    samples = any(scene.samples for scene in job.scenes.values())
    for place, (bag, output) in enumerate(zip(bags, outputs, strict=True), 1):
        label = f"{Path(bag).name} ({place:,} of {len(bags):,})" if len(bags) > 1 else Path(bag).name
        with progress(label) as tell, compiling_is_said() if samples else nullcontext():
            outcome = replay_bag(job, bag, output, tell)
        yield outcome


def on_workers(
    job: Job, bags: Sequence[str], outputs: Sequence[Path | None], workers: int, scheduler: str | None
) -> Generator[BagOutcome]:
    """What became of each bag, in their order, replayed by so many processes here or by the workers of a scheduler;
    InputError where Dask is missing, or the scheduler does not answer, has no workers, or is lost.
    """
    from ..fleet.cluster import Fleet, connected
    from ..fleet.job import renamed

    # The folder in which a worker of a scheduler runs may be another one; what is told has the names that were given.
    far = scheduler is not None
    sent = [os.fspath(Path(bag).absolute()) if far else bag for bag in bags]
    into = [output.absolute() if far and output is not None else output for output in outputs]
    with connected(min(workers, len(bags)), scheduler) as client, progress("bags", "bags", len(bags)) as bar:
        for place, outcome in enumerate(Fleet(client, job, sent, into).outcomes(bar)):
            bar.hide()
            yield renamed(outcome, {sent[place]: bags[place], str(into[place]): str(outputs[place])})
