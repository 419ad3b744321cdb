"""A progress bar on standard error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Final, Protocol

PATIENCE: Final = 1.0
"""Seconds of work before a bar appears."""


class Tell(Protocol):
    """Takes how much is done."""

    def __call__(self, done: int) -> None: ...


@contextmanager
def progress(label: str, unit: str = "samples", total: int | None = None) -> Iterator[Tell]:
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
    task = bar.add_task(label, total=total)
    began = perf_counter()

    def tell(done: int) -> None:
        bar.update(task, completed=done)
        if not bar.live.is_started and perf_counter() - began > PATIENCE:
            bar.start()

    try:
        yield tell
    finally:
        bar.stop()
