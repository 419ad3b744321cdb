"""A page: sections of sentences, tables and interactive charts, and how they become one HTML file.

A section is a function's answer: a title, words, and tables or charts. All text is escaped here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ... import __version__
from ...wording import duration, percent
from ..files import make_folder, whole

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as PlotlyFigure

SHARED: Final = "plotly.min.js"
"""The file of plotly's script, beside pages that share it."""

GREY: Final = "#808a95"
"""What is no data: grids, lines that lead to something. It can be seen on white and on black."""

LEAST: Final = 1e-4
"""A part of 1; smaller errors are not told apart."""


class Cell(NamedTuple):
    """A cell: its text, a smaller line below it, a class of its style (best, none), and where its text leads, or ""."""

    text: str
    below: str = ""
    css: str = ""
    to: str = ""


class PageTable(NamedTuple):
    """A table whose first `words` columns are text, the others numbers; folded away behind the words in `folded`."""

    head: Sequence[str]
    rows: Sequence[Sequence[Cell | str]]
    caption: str = ""
    words: int = 1
    folded: str = ""


class Chart(NamedTuple):
    """A plotly figure with a title and a caption; `wide` takes the whole width, `anchor` is where links lead, or ""."""

    title: str
    figure: PlotlyFigure
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
    """A question, its answer in a few words, and more on it."""

    question: str
    answer: str
    more: str


def plot(traces: Iterable[Mapping[str, Any]], height: int = 380, **layout: Any) -> PlotlyFigure:
    """A figure of traces, each a dictionary as plotly has it; text of others must be escaped, as `safe` does it."""
    import plotly.graph_objects as go

    look = {
        "template": "none",
        "height": height,
        "margin": {"l": 64, "r": 16, "t": 40, "b": 48},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "font": {"size": 13, "family": "system-ui, sans-serif"},
        "hoverlabel": {"align": "left", "bgcolor": "white", "font": {"color": "black"}},
        "legend": {"orientation": "h", "yanchor": "bottom", "y": 1.0},
        "hovermode": "closest",
        "dragmode": "zoom",
    }
    figure = go.Figure([dict(trace) for trace in traces], {**look, **layout})
    figure.update_xaxes(gridcolor=f"{GREY}40", zeroline=False, title_standoff=8)
    figure.update_yaxes(gridcolor=f"{GREY}40", zeroline=False, title_standoff=8)
    return figure


def marks(name: str, points: Iterable[tuple[float, float, str]], **look: Any) -> dict[str, Any]:
    """A trace of marks: the place of each, and the text that a reader sees who points at it; lines with `mode`."""
    return {"type": "scatter", "mode": "markers", "name": safe(name), **_points(points), **look}


def bars(points: Iterable[tuple[float, float, str]], **look: Any) -> dict[str, Any]:
    """A trace of bars, as `marks`."""
    return {"type": "bar", "textposition": "none", "showlegend": False, **_points(points), **look}


def _points(points: Iterable[tuple[float, float, str]]) -> dict[str, Any]:
    x, y, texts = zip(*points, strict=True)
    return {"x": list(x), "y": list(y), "text": [safe(text) for text in texts], "hoverinfo": "text"}


def titled(title: str, **axis: Any) -> dict[str, Any]:
    """An axis with its title, quantity and unit."""
    return {"title": {"text": title}, **axis}


def safe(text: str) -> str:
    """Text for a figure: plotly takes markup in names and hover texts; lines are broken as in the text."""
    return escape(text, quote=False).replace("\n", "<br>")


def page(
    title: str, lead: Sequence[str], headlines: Sequence[Headline], sections: Sequence[Section], script: str
) -> str:
    """A page as HTML; `script` is plotly's own as `script_inside` or `script_beside` give it."""
    here = files(__package__)
    charts = [part for section in sections for part in section.parts if isinstance(part, Chart)]
    names = {id(chart): f"chart-{number}" for number, chart in enumerate(charts, start=1)}
    tiles = "".join(
        f"<div><dt>{escape(one.question)}</dt><dd><strong>{escape(one.answer)}</strong> {escape(one.more)}</dd></div>"
        for one in headlines
    )
    links = "".join(f'<li><a href="#{escape(one.anchor)}">{escape(one.title)}</a></li>' for one in sections)
    body = "\n".join(
        [
            f'<header>\n<p class="from">impact_predictor {escape(__version__)}</p>\n<h1>{escape(title)}</h1>',
            *(f'<p class="lead">{escape(sentence)}</p>' for sentence in lead),
            f'<dl class="headlines">{tiles}</dl>\n<nav aria-label="Contents"><ul>{links}</ul></nav>\n</header>\n<main>',
            *(_section(section, names) for section in sections),
            "</main>",
        ]
    )
    drawn = f"{script}\n<script>\n{here.joinpath('page.js').read_text('utf-8')}</script>" if charts else ""
    style = here.joinpath("page.css").read_text("utf-8")
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>impact_predictor: {escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        f"{body}\n{drawn}\n</body>\n</html>\n"
    )


def _section(section: Section, names: Mapping[int, str]) -> str:
    parts = [f'<section id="{escape(section.anchor)}">\n<h2>{escape(section.title)}</h2>']
    parts += [f"<p>{escape(sentence)}</p>" for sentence in section.words]
    charts = False
    for part in section.parts:
        if isinstance(part, Chart) != charts:
            parts.append("</div>" if charts else '<div class="charts">')
            charts = not charts
        parts.append(_chart(part, names[id(part)]) if isinstance(part, Chart) else _table(part, section.title))
    return "\n".join([*parts, "</div>" if charts else "", "</section>"])


def _chart(chart: Chart, name: str) -> str:
    anchor = f' id="{escape(chart.anchor)}"' if chart.anchor else ""
    # Plotly writes < and > of its texts as \u003c and \u003e, so that none of them ends the script.
    return (
        f'<figure{anchor} class="{"wide" if chart.wide else "half"}">\n<h3>{escape(chart.title)}</h3>\n'
        f'<div class="chart" id="{name}" role="img" aria-label="{escape(chart.title)}"></div>\n'
        f'<script type="application/json" data-for="{name}">{chart.figure.to_json()}</script>\n'
        f"<figcaption>{escape(chart.caption)}</figcaption>\n</figure>"
    )


def _table(table: PageTable, title: str) -> str:
    head = "".join(
        f'<th scope="col"{_css("", number >= table.words)}>{escape(name)}</th>'
        for number, name in enumerate(table.head)
    )
    rows = "".join(f"<tr>{''.join(_cells(row, table.words))}</tr>\n" for row in table.rows)
    caption = f"<caption>{escape(table.caption)}</caption>" if table.caption else ""
    text = (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(table.folded or title)}"><table>{caption}'
        f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>"
    )
    return f"<details><summary>{escape(table.folded)}</summary>\n{text}</details>" if table.folded else text


def _cells(row: Iterable[Cell | str], words: int) -> Iterable[str]:
    for number, given in enumerate(row):
        cell = Cell(given) if isinstance(given, str) else given
        text = f'<a href="{escape(cell.to)}">{escape(cell.text)}</a>' if cell.to else escape(cell.text)
        below = f" <small>{escape(cell.below)}</small>" if cell.below else ""
        tag = 'th scope="row"' if number == 0 else "td"
        yield f"<{tag}{_css(cell.css, number >= words)}>{text}{below}</{tag[:2]}>"


def _css(name: str, number: bool) -> str:
    names = f"{name} number" if number else name
    return f' class="{names.strip()}"' if names else ""


def script_inside() -> str:
    """Plotly's script for a page that needs no other file."""
    text = files("plotly").joinpath("package_data", SHARED).read_text("utf-8")
    return f"<script>{text}</script>"


def script_beside(folder: Path) -> str:
    """A reference to plotly's script, which is written once into the folder of the pages that share it.

    Raises:
        InputError: it cannot be written.
    """
    make_folder(folder)
    with whole(folder / SHARED) as partial:
        partial.write_bytes(files("plotly").joinpath("package_data", SHARED).read_bytes())
    return f'<script src="{SHARED}"></script>'


def write_html(file: Path, text: str) -> None:
    """Write a page; an older one stays until it is whole.

    Raises:
        InputError: the file cannot be written.
    """
    with whole(file) as partial:
        partial.write_text(text, encoding="utf-8")


def part_words(part: float | None) -> str:
    """A part of 1 in percent, with the sign."""
    return "–" if part is None else f"< {100.0 * LEAST:g} %" if 0.0 < part < LEAST else f"{percent(part)} %"


def within_words(part: float | None) -> str:
    """What a part of 1 is within, in percent."""
    return part_words(None if part is None else max(part, LEAST))


def time_words(seconds: float | None) -> str:
    """A time in s with the unit that suits it; what is less than a microsecond is not told apart from nothing."""
    if seconds is None:
        return "–"
    return "less than 1 us" if seconds < 1e-6 else f"{seconds:,.0f} s" if seconds >= 1e3 else duration(seconds)


def signed_ms(seconds: float | None) -> str:
    """A time in s, early or late, in ms."""
    return "–" if seconds is None else f"{1e3 * seconds:+.1f} ms"
