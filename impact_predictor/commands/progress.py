"""A progress bar on standard error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Final, Protocol

PATIENCE: Final = 1.0
"""Seconds of work before a bar appears."""


class Tell(Protocol):
    """Takes how many samples are done."""

    def __call__(self, samples: int) -> None: ...


@contextmanager
def progress(label: str) -> Iterator[Tell]:
    """A bar while work goes on that takes more than a second, on a terminal; gone when it is done."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.completed:,} samples"),
        TaskProgressColumn("", show_speed=True),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
    task = bar.add_task(label, total=None)
    began = perf_counter()

    def tell(samples: int) -> None:
        bar.update(task, completed=samples)
        if not bar.live.is_started and perf_counter() - began > PATIENCE:
            bar.start()

    try:
        yield tell
    finally:
        bar.stop()
