"""Tables and sentences on the terminal: columns are declared once, and no number is cut off at any width."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final, NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

_UNLIMITED: Final = 10_000
_DAY: Final = 10**17
"""Stamps above this many ns (the year 1973) are times of day."""


class Column(NamedTuple):
    """A column: its header, and what a row has in it.

    Where `header` is a tuple, `cell` gives as many cells, which stand side by side. In a table that is too wide for the
    terminal they stand above each other, in one column with the header `stacked`, or in turn in several. `left` is for
    words, `fold` (letters) for those that may be broken into lines of so many.
    """

    header: str | tuple[str, ...]
    cell: Callable[[Any], str | tuple[str, ...]]
    stacked: str | tuple[str, ...] = ""
    left: bool = False
    fold: int = 0


def table_of(
    columns: Sequence[Column], rows: Iterable[Any], width: int = _UNLIMITED, style: Callable[[Any], str] | None = None
) -> Table:
    """A table of rows for a terminal that is `width` characters wide."""
    rows = list(rows)
    beside = _table(columns, rows, style, stacked=False)
    too_wide = width < _UNLIMITED and least_width(beside) > width
    return _table(columns, rows, style, stacked=True) if too_wide else beside


def _table(columns: Sequence[Column], rows: Sequence[Any], style: Callable[[Any], str] | None, stacked: bool) -> Table:
    table = plain_table()
    # Headers end on one line.
    lines = max(header.count("\n") for column in columns for header in _headers(column, stacked))
    for column in columns:
        for header in _headers(column, stacked):
            table.add_column(
                "\n" * (lines - header.count("\n")) + header,
                justify="left" if column.left else "right",
                no_wrap=not column.fold,
                overflow="fold",
                # rich narrows columns of a table that is too wide below their words.
                min_width=column.fold or max(map(len, header.split("\n"))),
            )
    for row in rows:
        cells: list[str] = []
        for column in columns:
            cell = column.cell(row)
            if isinstance(cell, str):
                cells.append(cell)
            else:
                count = len(_headers(column, stacked))
                cells += ["\n".join(cell[k::count]) for k in range(count)]
        table.add_row(*cells, style="" if style is None else style(row))
    return table


def _headers(column: Column, stacked: bool) -> tuple[str, ...]:
    header = column.stacked if stacked and not isinstance(column.header, str) else column.header
    return (header,) if isinstance(header, str) else header


def plain_table() -> Table:
    """An empty table in the style of all of them."""
    return Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0), header_style="bold")


def least_width(table: Table) -> int:
    """How many characters a table needs."""
    return Console(width=_UNLIMITED).measure(table).minimum


def first_stamp(stamps: Iterable[int]) -> int:
    """The stamp in ns from which times are counted: the first one if it is a time of day, else 0."""
    first = next(iter(stamps), 0)
    return first if first > _DAY else 0


def show(console: Console, table: Table) -> None:
    """Print a table; the terminal breaks lines that are too long for it, and no number is cut off."""
    least = least_width(table)
    if least > console.width:
        table.width = least
    console.print(table, crop=False)


def say(console: Console, *sentences: str) -> None:
    """Print sentences, each on a line that the terminal breaks where it likes."""
    for sentence in sentences:
        console.print(sentence, markup=False, highlight=False, soft_wrap=True)
