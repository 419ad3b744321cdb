"""What `impact-predictor simulate` makes of a motion: a bag, pictures, and a table or JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import click

from ..mechanics.bodies import refuse
from .options import F, json_flag, number, text, together
from .progress import progress, writing

if TYPE_CHECKING:
    from rich.console import Console

    from ..report.plot import Film
    from ..scenarios.record import Actor

RATE: Final = 1000.0
"""Samples of a bag for each second, unless another rate is given."""


def picture_options(figure: str, film: str) -> Callable[[F], F]:
    """The options that ask for pictures, of what each shows."""
    return together(
        text("--plot", "FILE", f"Draw {figure} into a .png or .svg file."),
        text("--animate", "FILE", f"Draw {film} into a .gif file."),
    )


def bag_option(truth: str) -> Callable[[F], F]:
    """The option that asks for a bag with what is true."""
    says = f"Write a bag for `replay`, with {truth}: NAME.mcap is one file, any other name a rosbag2 folder."
    return text("-o", "--output", "BAG", says)


RATES_AS_MAGNITUDES: Final = "Print JSON, rates as magnitudes"
record_options = together(
    bag_option("the true impacts"),
    number("--rate", f"Samples of the bag for each second. [default: {RATE:g}]", show_default=False),
)
as_json_option = json_flag(f"{RATES_AS_MAGNITUDES}.")


class Products(NamedTuple):
    """What is asked for of a motion: names of files, or None, and whether what is printed is JSON."""

    as_json: bool
    output: str | None = None
    rate: float | None = None
    plot: str | None = None
    animate: str | None = None

    def check(self) -> None:
        """Refuse what cannot be made, before any work is done.

        Raises:
            click.UsageError: a rate is given, and no bag is.
            InputError: the rate is out of its range, a picture is of no known format, or its folder does not exist.
        """
        if self.rate is not None and self.output is None:
            raise click.UsageError("--rate is that of a bag: give -o BAG too")
        refuse(
            {"rate": RATE if self.rate is None else self.rate},
            lambda value: 0.0 < value <= 1e6,
            "a number above 0, up to 1e6",
        )
        if self.draws:
            from ..files import named
            from ..report.plot import FILM, PICTURE

            for path, what in ((self.plot, PICTURE), (self.animate, FILM)):
                if path is not None:
                    named(path, *what)

    @property
    def draws(self) -> bool:
        """Whether a picture is asked for."""
        return self.plot is not None or self.animate is not None

    def record(self, actors: Sequence[Actor]) -> None:
        """Write the bag."""
        from ..scenarios.record import write_record

        assert self.output is not None
        rate = RATE if self.rate is None else self.rate
        with writing(self.output, round(max(actor.duration for actor in actors))) as bar:
            write_record(self.output, actors, rate, bar)

    def draw(self, write_figure: Callable[[str], object], film: Callable[[], Film]) -> None:
        """Draw the pictures that are asked for."""
        if self.plot is not None:
            write_figure(self.plot)
        if self.animate is not None:
            from ..report.plot import write_film

            moving = film()
            with progress(Path(self.animate).name, "frames", len(moving.times)) as bar:
                write_film(self.animate, moving, bar)

    def say(self, fields: Callable[[], object], show: Callable[[Console], None]) -> None:
        """Print what happened, and which files have been written."""
        if self.as_json:
            click.echo(json.dumps(fields(), allow_nan=False))
            return
        from rich.console import Console

        show(Console())
        for what, file in (("Bag", self.output), ("Picture", self.plot), ("Animation", self.animate)):
            if file is not None:
                click.echo(f"{what}: {file}")
