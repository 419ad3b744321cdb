"""A progress bar on standard error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

PATIENCE: Final = 1.0
"""Seconds of work before a bar appears."""


class Bar:
    """A bar that is told how much is done."""

    def __init__(self, progress: Progress, task: TaskID) -> None:
        """Show it when the work has taken its time."""
        self._progress, self._task = progress, task
        self._began = perf_counter()

    def __call__(self, done: int) -> None:
        """Show how much is done."""
        self._progress.update(self._task, completed=done)
        if not self._progress.live.is_started and perf_counter() - self._began > PATIENCE:
            self._progress.start()

    def hide(self) -> None:
        """Take it away until it is told again, so that something else can be printed."""
        if self._progress.live.is_started:
            self._progress.stop()


@contextmanager
def progress(label: str, unit: str = "samples", total: int | None = None) -> Iterator[Bar]:
    """A bar while work goes on that takes more than a second, on a terminal; gone when it is done."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        ProgressColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    times: list[ProgressColumn] = [TimeElapsedColumn()]
    if total is not None:
        times.append(TimeRemainingColumn())
    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn(f"{{task.completed:,}} {unit}"),
        TaskProgressColumn(show_speed=True),
        *times,
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
    try:
        yield Bar(bar, bar.add_task(label, total=total))
    finally:
        bar.stop()
