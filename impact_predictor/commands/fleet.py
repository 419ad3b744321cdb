"""Bags through the replay, one after the other or on workers, and where the predictions of each go."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError

if TYPE_CHECKING:
    from ..fleet.job import BagOutcome, Job


def outputs_of(bags: Sequence[str], output: str | None) -> list[Path | None]:
    """Where the predictions of each bag go: one output, or a file for each of several bags in a folder.

    Raises:
        InputError: a bag is there twice, or there is no place for the folder.
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
    """The folders of several outputs; those that were made for them and are empty at the end are removed.

    Raises:
        InputError: a folder cannot be made.
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
    from .progress import compiling_is_said, progress

    samples = any(scene.samples for scene in job.scenes.values())
    for number, (bag, output) in enumerate(zip(bags, outputs, strict=True), 1):
        label = f"{Path(bag).name} ({number:,} of {len(bags):,})" if len(bags) > 1 else Path(bag).name
        with progress(label) as tell, compiling_is_said() if samples else nullcontext():
            outcome = replay_bag(job, bag, output, tell)
        yield outcome


def on_workers(
    job: Job, bags: Sequence[str], outputs: Sequence[Path | None], workers: int, scheduler: str | None
) -> Generator[BagOutcome]:
    """What became of each bag, in their order, replayed by so many processes here or by the workers of a scheduler.

    Raises:
        InputError: Dask is missing, or the scheduler does not answer, has no workers, or is lost.
    """
    from ..fleet.cluster import Fleet, connected
    from ..fleet.job import renamed
    from .progress import progress

    # The folder in which a worker of a scheduler runs may be another one; what is told has the names that were given.
    far = scheduler is not None
    sent = [os.fspath(Path(bag).absolute()) if far else bag for bag in bags]
    into = [output.absolute() if far and output is not None else output for output in outputs]
    with connected(min(workers, len(bags)), scheduler) as client, progress("bags", "bags", len(bags)) as bar:
        for number, outcome in enumerate(Fleet(client, job, sent, into).outcomes(bar)):
            bar.hide()
            yield renamed(outcome, {sent[number]: bags[number], str(into[number]): str(outputs[number])})
