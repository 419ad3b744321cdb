"""Tables and sentences on the terminal: columns are declared once, and no number is cut off at any width."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final, NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ..wording import NONE, counted

MOST_ROWS: Final = 20
"""Rows that are listed unless all are asked for."""
_DAY: Final = 10**17
"""Stamps above this many ns (the year 1973) are times of day."""


class Column(NamedTuple):
    """A column: its header, and the text of a row in it; `left` is for words, which may break into lines of `fold`.

    An `optional` one is left out where it says nothing of any row.
    """

    header: str
    cell: Callable[[Any], str]
    left: bool = False
    fold: int = 0
    optional: bool = False


def table_of(columns: Sequence[Column], rows: Iterable[Any], style: Callable[[Any], str] | None = None) -> Table:
    """A table of rows, each perhaps in a style of rich."""
    table, rows = plain_table(), list(rows)
    texts = texts_of(columns, rows)
    # Headers end on one line.
    lines = max(column.header.count("\n") for column in texts)
    for column, cells in texts.items():
        table.add_column(
            "\n" * (lines - column.header.count("\n")) + column.header,
            justify="left" if column.left else "right",
            no_wrap=not column.fold,
            overflow="fold",
            # rich narrows columns of a table that is too wide below their words.
            min_width=column.fold or max(len(line) for text in (column.header, *cells) for line in text.split("\n")),
        )
    for row, *cells in zip(rows, *texts.values(), strict=True):
        table.add_row(*cells, style="" if style is None else style(row))
    return table


def texts_of(columns: Sequence[Column], rows: Sequence[Any]) -> dict[Column, list[str]]:
    """The cells of each column that is not left out."""
    texts = {column: [column.cell(row) for row in rows] for column in columns}
    return {column: cells for column, cells in texts.items() if not column.optional or {*cells} - {"", NONE}}


def plain_table() -> Table:
    """An empty table in the style of all of them."""
    return Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0), header_style="bold")


def first_stamp(stamps: Iterable[int]) -> int:
    """The stamp in ns from which times are counted: the first one if it is a time of day, else 0."""
    first = next(iter(stamps), 0)
    return first if first > _DAY else 0


def show(console: Console, table: Table) -> None:
    """Print a table; the terminal breaks lines that are too long for it, and no number is cut off."""
    least = Console(width=10_000).measure(table).minimum
    if least > console.width:
        table.width = least
    console.print(table, crop=False)


def say(console: Console, *sentences: str) -> None:
    """Print sentences, each on a line that the terminal breaks where it likes."""
    for sentence in sentences:
        console.print(sentence, markup=False, highlight=False, soft_wrap=True)


def more(number: int, noun: str, how: str = "list them with --all, or read them with --json") -> list[str]:
    """A sentence about rows that are not listed, if there are any."""
    return [f"{counted(number, f'more {noun}')}: {how}."] if number > 0 else []
