"""What is said on standard error while work goes on: what is done, how far, that numba compiles, what Ctrl-C left."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Final

import click

from ..mechanics.compiled import told_of_compiling
from ..wording import listed

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

PATIENCE: Final = 1.0
"""Seconds of work before a bar appears."""

NAMED: Final = 3
"""Unfinished bags that are named; of more the number is given."""


class ProgressBar:
    """A bar that shows how much is done."""

    def __init__(self, progress: Progress, task: TaskID, note: str) -> None:
        """Show it when the work has taken its time; say a note, if any, when the work begins."""
        self._progress, self._task, self._note = progress, task, note
        self._began = perf_counter()

    def __call__(self, done: int) -> None:
        if self._note:
            click.echo(f"note: {self._note}", err=True)
            self._note = ""
        self._progress.update(self._task, completed=done)
        if not self._progress.live.is_started and perf_counter() - self._began > PATIENCE:
            self._progress.start()

    def hide(self) -> None:
        """Take it away until more is done, so that something else can be printed."""
        if self._progress.live.is_started:
            self._progress.stop()


@contextmanager
def progress(label: str, unit: str = "samples", total: int | None = None, note: str = "") -> Iterator[ProgressBar]:
    """A bar while work goes on that takes more than a second, on a terminal; gone when it is done.

    Elsewhere a note says what is done, as soon as the bar is first told how much.
    """
    from rich import progress as rich
    from rich.console import Console

    console = Console(stderr=True)
    times: list[rich.ProgressColumn] = [rich.TimeElapsedColumn()]
    if total is not None:
        times.append(rich.TimeRemainingColumn())
    bar = rich.Progress(
        rich.TextColumn("{task.description}", markup=False),
        rich.BarColumn(),
        rich.TextColumn(f"{{task.completed:,}} {unit}"),
        rich.TaskProgressColumn(show_speed=True),
        *times,
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
    try:
        yield ProgressBar(bar, bar.add_task(label, total=total), "" if console.is_terminal else note)
    finally:
        bar.stop()


def compiling_is_said() -> AbstractContextManager[None]:
    """Say so when numba compiles meanwhile, instead of taking what it compiled before."""
    return told_of_compiling(lambda said: click.echo(f"note: {said}", err=True))


def say_unfinished(outputs: Sequence[Path | None], scheduler: str | None = None) -> None:
    """Name the bags that stopped writers left unfinished; the workers of a scheduler write theirs to the end."""
    from ..bags.write import left_of

    files = [output for output in outputs if output is not None]
    left = [str(bag) for bag in map(left_of, files) if bag is not None] if scheduler is None else []
    if files and scheduler is not None:
        click.echo("note: the workers of the scheduler finish the bags that they have begun, and write them", err=True)
    elif left:
        stay, them = ("stays as a bag in", "it") if len(left) == 1 else ("stays as bags in", "them")
        click.echo(
            f"note: what was written until Ctrl-C {stay} {listed(left, NAMED)}, until the next run with this "
            f"-o replaces {them}",
            err=True,
        )


@contextmanager
def writing(output: str, seconds: int | None) -> Iterator[ProgressBar]:
    """A bar while a bag of so many seconds is written; the bag that Ctrl-C leaves unfinished is named."""
    try:
        with progress(Path(output).name, "s", seconds) as bar:
            yield bar
    except KeyboardInterrupt:
        say_unfinished([Path(output)])
        raise
