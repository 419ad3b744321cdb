"""The sections of the page: a section is a title, words, figures and tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from markupsafe import Markup


class Figure(NamedTuple):
    """A picture, drawn wide and narrow; `notes` stand below it, `data` is its numbers as a table.

    `anchor` is where links lead to, or "".
    """

    title: str
    caption: str
    drawings: Sequence[Markup]
    notes: Sequence[str] = ()
    data: Table | None = None
    anchor: str = ""


class Cell(NamedTuple):
    """A cell: its text, a smaller line below it, a class of its style, how many columns it takes, and their name.

    `to` is the anchor of what its text leads to, or "".
    """

    text: str
    below: str = ""
    css_class: str = ""
    span: int = 1
    head: str = ""
    to: str = ""


class Table(NamedTuple):
    """A table; the first cell of a row is its name.

    The first `words` columns are text, the others numbers. On a narrow page a row becomes a card where `cards`; a cell
    is named there by its `head`, or else that of its column. `accuracies` are those of the columns after the first.
    With words in `folded` it is folded away behind them.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    words: int = 1
    cards: bool = False
    accuracies: Sequence[float] = ()
    folded: str = ""


class Key(NamedTuple):
    """A line of the key to pictures: a marker, its name, what it stands for."""

    marker: Markup
    name: str
    says: str


class Section(NamedTuple):
    """A part of the page: words, the key, tables, figures, and the sections inside it.

    `summary` says the most of a section that is folded away until it is asked for.
    """

    anchor: str
    title: str
    words: Sequence[str] = ()
    key: Sequence[Key] = ()
    tables: Sequence[Table] = ()
    figures: Sequence[Figure] = ()
    sections: Sequence[Section] = ()
    summary: str = ""
