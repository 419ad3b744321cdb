"""A page: sections of sentences, tables and interactive charts, and how they become one HTML file.

A section is a function's answer: a title, words, and tables or charts. Jinja2 escapes all text, plotly draws.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from typing import Any, Final, NamedTuple

from ... import __version__
from ...wording import duration, percent
from ..table import Column, texts_of

GREY: Final = "#808a95"
"""What is no data: grids, lines that lead to something. It can be seen on white and on black."""


class Cell(NamedTuple):
    """A cell: its text, a smaller line below it, a class of its style (best, none), and where its text leads, or ""."""

    text: str
    below: str = ""
    css: str = ""
    to: str = ""


class PageTable(NamedTuple):
    """A table whose first `words` columns are text, the others numbers."""

    head: Sequence[str]
    rows: Sequence[Sequence[Cell | str]]
    caption: str = ""
    words: int = 1


class Chart(NamedTuple):
    """A plotly figure with a title and a caption; `wide` takes the whole width, `anchor` is where links lead, or "".

    Text of others must be escaped in it, as `safe` does it; the page adds its look to the layout.
    """

    title: str
    traces: Sequence[Mapping[str, Any]]
    layout: Mapping[str, Any]
    caption: str = ""
    wide: bool = True
    anchor: str = ""


class Section(NamedTuple):
    """A part of a page; links lead to its `anchor`."""

    anchor: str
    title: str
    words: Sequence[str]
    parts: Sequence[PageTable | Chart] = ()


class Headline(NamedTuple):
    """What is told, its number or name, and more on it."""

    question: str
    answer: str
    more: str


def page_table(columns: Sequence[Column], rows: Iterable[Any], caption: str = "") -> PageTable:
    """A table of columns as the terminal has them: those of words come first."""
    texts = texts_of(columns, list(rows))
    head = [" ".join(column.header.replace("-\n", "").split()) for column in texts]
    words = sum(column.left for column in texts)
    return PageTable(head, [*zip(*texts.values(), strict=True)], caption, words)


def marks(name: str, points: Iterable[tuple[float, float, str]], **look: Any) -> dict[str, Any]:
    """A trace of marks at points (x, y), each with the text that a reader sees who points at it; `look` overrides."""
    x, y, texts = zip(*points, strict=True)
    trace = {"type": "scatter", "mode": "markers", "name": safe(name), "x": x, "y": y}
    return {**trace, "hovertext": [safe(text) for text in texts], "hoverinfo": "text", **look}


def bars(name: str, spans: Sequence[tuple[float, float]], row: float, colour: str, **look: Any) -> dict[str, Any]:
    """A trace of level bars from a begin to an end (s) each, in a row."""
    points = [(end - begin, row, f"{name} from {begin:.3f} s to {end:.3f} s") for begin, end in spans]
    base = {"type": "bar", "orientation": "h", "base": [begin for begin, _ in spans], "marker": {"color": colour}}
    return marks(name, points, **base, **look)


def safe(text: str) -> str:
    """Text for a figure: plotly takes markup in names and hover texts; lines are broken as in the text."""
    return escape(text, quote=False).replace("\n", "<br>")


def page(title: str, lead: str, headlines: Sequence[Headline], sections: Sequence[Section], script: str) -> str:
    """A page as HTML; `script` is plotly's own, as `script_inside` gives it, or a reference to it."""
    from jinja2 import Environment

    template, style = (files(__package__).joinpath(name).read_text("utf-8") for name in ("page.html", "page.css"))
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    content = {"title": title, "lead": lead, "headlines": headlines, "sections": sections}
    return environment.from_string(template).render(content, version=__version__, style=style, script=script)


def script_inside() -> str:
    """Plotly's script for a page that needs no other file."""
    from plotly.offline import get_plotlyjs

    return f"<script>{get_plotlyjs()}</script>"


def part_words(part: float | None) -> str:
    """A part of 1 in percent, with the sign."""
    return "–" if part is None else "< 0.01 %" if 0.0 < part < 1e-4 else f"{percent(part)} %"


def time_words(seconds: float | None) -> str:
    """A time in s with the unit that suits it; what is less than a microsecond is not told apart from nothing."""
    if seconds is None:
        return "–"
    return "less than 1 us" if seconds < 1e-6 else f"{seconds:,.0f} s" if seconds >= 1e3 else duration(seconds)
