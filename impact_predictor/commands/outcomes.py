"""What `impact-predictor replay` says of bags, one after the other, and of all of them at the end."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from ..report.summary import without_bag
from ..wording import counted

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..fleet.job import Outcome
    from ..report.page.answers import Kept
    from ..report.parquet import TouchdownTable
    from ..report.picture import Picture
    from .baseline import Baseline

CHANGED: Final = 1
"""Exit status where something has changed against a baseline."""

FAILED: Final = 2
DAMAGED: Final = 3
"""Exit status where the readable part of a bag was used."""

MANY: Final = 20
"""Bags above which each has one line on standard output, not its tables, and one kind of note is said once."""


class Outcomes:
    """Takes what became of each bag, says it, and hands it on to what is made of all of them; it keeps none."""

    def __init__(
        self,
        bags: int,
        every: bool,
        as_json: bool,
        baseline: Baseline | None,
        table: TouchdownTable | None,
        picture: Picture | None,
        answers: Kept | None,
    ) -> None:
        """Say it of so many bags, with `every` touchdown or `as_json`; `answers` take the JSON of each."""
        self.number = 0
        self._bags, self._every, self._as_json = bags, every, as_json
        self._baseline, self._table, self._picture, self._answers = baseline, table, picture, answers
        self.replayed = 0
        self._failed = self._damaged = False
        # What is said of many bags is said once.
        self._notes: Counter[str] = Counter()
        if not as_json:
            from ..report.tally import ReplayTally

            self._together = ReplayTally()

    def take(self, outcome: Outcome, output: Path | None) -> None:
        """Say what became of a bag.

        Raises:
            InputError: what is made of the bags cannot be written.
        """
        result, answer = outcome.result, outcome.answer
        if result is None:
            click.echo(f"error: {outcome.error}", err=True)
            self._failed = True
        else:
            self._say(result)
            self.replayed += 1
            if output is not None and self._bags <= MANY:
                self.tell_file("Predictions", output)
            if self._baseline is not None:
                answer |= self._baseline.judge(result, self._every, self._as_json)
        if self._as_json:
            # A list is printed as it grows, so that thousands of bags need no memory.
            before = ("[" if not self.number else ", ") if self._bags > 1 else ""
            click.echo(f"{before}{json.dumps(answer, allow_nan=False)}", nl=False)
        if self._table is not None:
            self._table.add(answer)
        if self._answers is not None:
            self._answers.append(answer)
        self.number += 1

    def finish(self) -> None:
        """Say what all bags say together."""
        for note, count in self._notes.items():
            click.echo(f"note: of {counted(count, 'bag')}: {note}", err=True)
        if self._as_json:
            click.echo("]" if self._bags > 1 else "")
        elif self.replayed > 1:
            click.echo(f"\n{self.replayed:,} bags together")
            for sentence in self._together.sentences():
                click.echo(sentence)

    def tell_file(self, what: str, path: str | Path) -> None:
        """Say where something was written."""
        if not self._as_json:
            click.echo(f"{what}: {path}")

    @property
    def status(self) -> int:
        """The exit status."""
        if self._failed:
            return FAILED
        if self._damaged:
            return DAMAGED
        return CHANGED if self._baseline is not None and self._baseline.has_changed else 0

    def _say(self, result: Result) -> None:
        """Say what was chosen or is wrong on standard error, and on standard output what was found."""
        for note in result.notes:
            if self._bags <= MANY:
                click.echo(f"note: {note}", err=True)
            else:
                self._notes[without_bag(note, result.bag)] += 1
        if result.unpredictable:
            click.echo(f"error: {result.bag}: {result.unpredictable}", err=True)
            self._failed = True
        if result.damaged:
            click.echo(f"warning: {result.damaged}", err=True)
            self._damaged = True
        if self._picture is not None:
            self._picture.add(result)
        if self._as_json:
            return
        self._together.add(result.settled)
        from ..report.replay import concluded, print_replay

        if self._bags > MANY and not self._every:
            click.echo(f"{result.bag}: {concluded(result.settled)[0]}")
            return
        from rich.console import Console

        print_replay(Console(), result, self._every)
