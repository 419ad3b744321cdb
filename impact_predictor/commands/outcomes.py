"""What `impact-predictor replay` makes of bags: words of each and of all, a page, and tables."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import click

from ..errors import need
from ..files import named
from ..report.summary import Tally, without_bag
from ..wording import counted

if TYPE_CHECKING:
    from ..bags.replay import Result
    from ..fleet.job import BagOutcome
    from ..report.tables import RowTable

FAILED: Final = 2
DAMAGED: Final = 3
"""Exit status where the readable part of a bag was used."""

MANY: Final = 20
"""Bags above which each has one line on standard output, not its tables, and one kind of note is said once."""


class Wanted(NamedTuple):
    """What is asked for of the replays: files, or None; every touchdown in words; JSON."""

    report: str | None
    table: str | None
    series: str | None
    every: bool
    as_json: bool

    @property
    def answers(self) -> bool:
        """Whether the JSON of each bag is needed."""
        return self.as_json or bool(self.report or self.table)

    @property
    def logs(self) -> bool:
        """Whether the log of each watch is needed."""
        return not self.as_json or self.series is not None


class ReplayReport:
    """Takes what became of each bag, says it, and hands it on to what is made of all of them; it keeps none."""

    def __init__(self, bags: Sequence[str], wanted: Wanted, stack: ExitStack) -> None:
        """Begin, so that what cannot be made is refused before a bag is read; the stack ends the table. InputError
        where something cannot be written.
        """
        self.number = 0
        self.replayed = 0
        self._bags, self._wanted = len(bags), wanted
        self._statuses: set[int] = set()
        # What is said of many bags is said once.
        self._notes: Counter[str] = Counter()
        self._together = Tally()
        self._answers: list[dict[str, Any]] = []
        self._tables: list[tuple[RowTable, Callable[[BagOutcome], Iterable[dict[str, Any]]]]] = []
        if wanted.report is not None:
            need("plotly", "jinja2")
            named(wanted.report, "page", (".html",) if Path(wanted.report).suffix else ("",))
        if wanted.table is not None:
            from ..report.tables import TOUCHDOWNS, table_file, touchdown_rows

            table = stack.enter_context(table_file(wanted.table, TOUCHDOWNS))
            self._tables.append((table, lambda outcome: touchdown_rows(outcome.answer)))
        if wanted.series is not None:
            from ..report.tables import table_file
            from ..report.watch import SERIES

            self._tables.append((stack.enter_context(table_file(wanted.series, SERIES)), watched_rows))

    def take(self, outcome: BagOutcome, output: Path | None) -> None:
        """Say what became of a bag; InputError where what is made of the bags cannot be written."""
        result, answer = outcome.result, outcome.answer
        if result is None:
            click.echo(f"error: {outcome.error}", err=True)
            self._statuses.add(FAILED)
        else:
            self._say(result)
            self.replayed += 1
            if output is not None and self._bags <= MANY:
                self._say_file("Predictions", output)
        if self._wanted.as_json:
            # A list is printed as it grows, so that thousands of bags need no memory.
            before = ("[" if not self.number else ", ") if self._bags > 1 else ""
            click.echo(f"{before}{json.dumps(answer, allow_nan=False)}", nl=False)
        for table, rows_of_bag in self._tables:
            table.add(rows_of_bag(outcome))
        if self._wanted.report is not None:
            self._answers.append(answer)
        self.number += 1

    def finish(self) -> None:
        """Say what all bags say together, and write the page."""
        for note, count in self._notes.items():
            click.echo(f"note: of {counted(count, 'bag')}: {note}", err=True)
        if self._wanted.as_json:
            click.echo("]" if self._bags > 1 else "")
        elif self.replayed > 1:
            click.echo(f"\n{self.replayed:,} bags together")
            for sentence in self._together.sentences():
                click.echo(sentence)
        if (page := self._wanted.report) is not None:
            from ..report.page.replay import write_replay_page

            write_replay_page(page, self._answers)
            self._say_file("Page", page)

    def say_table(self) -> None:
        """Say where the tables are, when the stack has ended them."""
        for file in (self._wanted.table, self._wanted.series):
            if file is not None:
                self._say_file("Table", file)

    @property
    def status(self) -> int:
        return next((one for one in (FAILED, DAMAGED) if one in self._statuses), 0)

    def _say_file(self, what: str, path: str | Path) -> None:
        """Say where something was written."""
        if not self._wanted.as_json:
            click.echo(f"{what}: {path}")

    def _say(self, result: Result) -> None:
        """Say what was chosen or is wrong on standard error, and on standard output what was found."""
        for note in result.notes:
            if self._bags <= MANY:
                click.echo(f"note: {note}", err=True)
            else:
                self._notes[without_bag(note, result.bag)] += 1
        if result.unpredictable:
            click.echo(f"error: {result.bag}: {result.unpredictable}", err=True)
            self._statuses.add(FAILED)
        if result.damaged:
            click.echo(f"warning: {result.damaged}", err=True)
            self._statuses.add(DAMAGED)
        if self._wanted.as_json:
            return
        from ..report.replay import print_replay
        from ..report.touchdowns import rows_of

        rows = rows_of(result.settled)
        self._together.add(rows)
        if self._bags > MANY and not self._wanted.every:
            click.echo(f"{result.bag}: {Tally(rows).sentences()[0]}")
            return
        from rich.console import Console

        print_replay(Console(), result, self._wanted.every)


def watched_rows(outcome: BagOutcome) -> Iterator[dict[str, Any]]:
    """The rows of `--series`: what the watch over a deck saw in a bag, if there was one."""
    from ..report.watch import series_of

    result = outcome.result
    return iter(()) if result is None or result.watch is None else series_of(result.bag, result.watch)
