"""What Ctrl-C leaves of bags that were being written, in a sentence."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import click

NAMED: Final = 3
"""Unfinished bags that are named; of more the number is told."""


def tell_unfinished(outputs: Sequence[Path | None], scheduler: str | None = None) -> None:
    """Name the bags that are left unfinished of some outputs, where their writers were stopped.

    The workers of a scheduler are not: they write the bags to the end that they have begun.
    """
    files = [output for output in outputs if output is not None]
    if not files:
        return
    if scheduler is not None:
        click.echo("note: the workers of the scheduler finish the bags that they have begun, and write them", err=True)
        return
    from ..bags.write import left_of

    left = [str(bag) for bag in map(left_of, files) if bag is not None]
    if left:
        more = f" and {len(left) - NAMED:,} more" if len(left) > NAMED else ""
        stay, them = ("stays as a bag in", "it") if len(left) == 1 else ("stays as bags in", "them")
        click.echo(
            f"note: what was written until Ctrl-C {stay} {', '.join(left[:NAMED])}{more}, until the next run with this "
            f"-o replaces {them}",
            err=True,
        )


@contextmanager
def unfinished_is_told(output: str | None) -> Iterator[None]:
    """Name the bag that Ctrl-C leaves unfinished of an output, if any."""
    try:
        yield
    except KeyboardInterrupt:
        tell_unfinished([None if output is None else Path(output)])
        raise
