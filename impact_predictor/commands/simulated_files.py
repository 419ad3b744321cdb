"""The files that `impact-predictor simulate` writes: what is refused before anything is, and what is said of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from ..mechanics.bodies import refuse

if TYPE_CHECKING:
    from ..report.film import Film

RATE: Final = 1000.0
"""Samples of a bag for each second, unless told otherwise."""


def rate_of_bag(rate: float | None, output: str | None) -> float:
    """Samples of the bag for each second.

    Raises:
        click.UsageError: they are given, and no bag is.
        InputError: the number is out of its range.
    """
    if rate is not None and output is None:
        raise click.UsageError("--rate is that of a bag: give -o BAG too")
    rate = RATE if rate is None else rate
    refuse({"rate": rate}, lambda value: 0.0 < value <= 1e6, "a number above 0, up to 1e6")
    return rate


def check_pictures(plot: str | None, animate: str | None) -> None:
    """Refuse pictures that cannot be written.

    Raises:
        InputError: the format is another one, or there is no such folder.
    """
    if plot is not None:
        from ..report.plot import check_picture

        check_picture(plot)
    if animate is not None:
        from ..report.plot import check_film

        check_film(animate)


def draw_film(path: str, film: Film) -> None:
    """Draw a moving picture, with a progress bar."""
    from ..report.film import write_film
    from .progress import progress

    with progress(Path(path).name, "frames", len(film.times)) as tell:
        write_film(path, film, tell)


def say_files(output: str | None, plot: str | None, animate: str | None) -> None:
    """Print which files have been written."""
    for what, file in (("Bag", output), ("Picture", plot), ("Animation", animate)):
        if file is not None:
            click.echo(f"{what}: {file}")
