"""What `impact-predictor simulate` makes of a motion: a bag, a picture, and a table or JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import click

from ..errors import InputError
from .options import F, json_flag, number, refuse_given, text, together, within
from .progress import writing

if TYPE_CHECKING:
    from rich.console import Console

    from ..scenarios.record import Actor

RATE: Final = 1000.0
"""Samples of a bag for each second, unless another rate is given."""


def _bag(context: click.Context, option: click.Parameter, name: str | None) -> str | None:
    """The name of a bag, unless it ends as a file of another kind; `run.2` is a folder."""
    ending = Path(name or "").suffix
    if ending != ".mcap" and ending[1:2].isalpha():
        raise InputError(f"{name} is no bag; give a name that ends in .mcap, or a folder without an ending")
    return name


def bag_option(truth: str) -> Callable[[F], F]:
    """The option that asks for a bag with what is true."""
    says = f"Write a bag for `replay`, with {truth}: NAME.mcap is one file, a name without an ending a rosbag2 folder."
    return text("-o", "--output", "BAG", says, callback=_bag)


RATES_AS_MAGNITUDES: Final = "Print JSON, rates as magnitudes"
record_options = together(
    bag_option("the true impacts"),
    number(
        "--rate",
        "Samples of the bag for each second.",
        RATE,
        **within(lambda value: 0.0 < value <= 1e6, "a number above 0, up to 1e6"),
    ),
)
as_json_option = json_flag(f"{RATES_AS_MAGNITUDES}.")


class Products(NamedTuple):
    """What is asked for of a motion: names of files, or None, and whether what is printed is JSON."""

    as_json: bool
    output: str | None = None
    rate: float = RATE
    plot: str | None = None

    def check(self) -> None:
        """Refuse what cannot be made, before any work is done; click.UsageError where a rate is given, and no bag is;
        InputError where a picture is of no known format, or its folder does not exist.
        """
        if self.output is None:
            refuse_given(["rate"], "is that of a bag: give -o BAG too")
        if self.plot is not None:
            from ..files import named
            from ..report.plot import PICTURE

            named(self.plot, *PICTURE)

    def record(self, actors: Sequence[Actor]) -> None:
        from ..scenarios.record import write_record

        assert self.output is not None
        with writing(self.output, round(max(actor.duration for actor in actors))) as bar:
            write_record(self.output, actors, self.rate, bar)

    def say(self, fields: Callable[[], object], show: Callable[[Console], None]) -> None:
        """Print what happened, and which files have been written."""
        if self.as_json:
            click.echo(json.dumps(fields(), allow_nan=False))
            return
        from rich.console import Console

        show(Console())
        for what, file in (("Bag", self.output), ("Picture", self.plot)):
            if file is not None:
                click.echo(f"{what}: {file}")
