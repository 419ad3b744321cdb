"""Errors over the time ahead at which a prediction is made, and what the answer to a sample costs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from math import ceil, floor, log10
from typing import Final, NamedTuple

import matplotlib
import numpy as np
from markupsafe import Markup
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from ....wording import counted
from ...spread import LEAST, PER_DECADE, Spread
from ..chart import Shape
from ..labels import Line, write_names
from ..sections import Cell, Figure, Section, Table
from ..svg import FONT, INK, STYLE, Mark, family_colour, svg_of
from ..words import share, time_words
from .answers import Ahead, Answer, ahead, besides_truth, costs
from .words import percent, seconds_words

NARROW: Final = Shape("narrow", 345.0, 280.0, (54.0, 14.0, 46.0, 30.0))
BESIDE: Final = (Shape("wide", 460.0, 300.0, (58.0, 18.0, 48.0, 30.0)), NARROW)
"""Of two pictures beside each other."""
ALONE: Final = (Shape("wide", 680.0, 320.0, (58.0, 18.0, 48.0, 30.0)), NARROW)


class Quantity(NamedTuple):
    """An error: its key in the answers, its name, the words of a value, and what it is multiplied by in its picture."""

    key: str
    title: str
    words: Callable[[float | None], str]
    factor: float
    axis: str
    says: str


QUANTITIES: Final = (
    Quantity(
        "relative_errors_ahead",
        "Velocities after the impact",
        percent,
        100.0,
        "relative error, %",
        "of the touchdowns whose velocities are compared",
    ),
    Quantity(
        "time_errors_ahead",
        "Time of the touchdown",
        seconds_words,
        1e3,
        "error of the time, ms",
        "of the touchdowns whose time the record tells",
    ),
)


AGAINST_MEASURED: Final = (
    "Errors are against the measured velocities; what was said above of how far these are from the true ones holds "
    "here too."
)


def early(answers: Sequence[Answer]) -> Section | None:
    """The section of errors ahead of touchdowns; None where there are none."""
    known = [(quantity, spans) for quantity in QUANTITIES if (spans := ahead(answers, quantity.key))]
    shapes, measured = BESIDE if len(known) > 1 else ALONE, QUANTITIES[0]
    figures = [
        figure_of(spans, quantity, shapes)._replace(
            notes=[AGAINST_MEASURED] if quantity is measured and besides_truth(answers) else ()
        )
        for quantity, spans in known
    ]
    if not figures:
        return None
    words = "Every sample before a touchdown makes a prediction of it. Does one that is made earlier do as well?"
    return Section("ahead", "Error against the time ahead", [words], figures=figures)


def figure_of(spans: Sequence[Ahead], quantity: Quantity, shapes: Sequence[Shape]) -> Figure:
    """The picture of one error, and its numbers."""
    number = sum(one.errors.number for one in spans)
    caption = f"All {counted(number, 'prediction')} {quantity.says}, by how long before the touchdown they were made."
    table = table_of(spans, quantity)
    said = "; ".join(f"{row[0].text}: median {row[2].text}, 90 % below {row[3].text}" for row in table.rows)
    drawings = [
        draw_ahead(spans, quantity, shape, f"{quantity.title} against the time ahead. {said}") for shape in shapes
    ]
    return Figure(quantity.title, caption, drawings, (), table)


def table_of(spans: Sequence[Ahead], quantity: Quantity) -> Table:
    """The numbers of a picture."""
    rows = [
        [
            Cell(span_words(one)),
            Cell(f"{one.errors.number:,}"),
            Cell(quantity.words(one.errors.p50)),
            Cell(quantity.words(one.errors.p90)),
        ]
        for one in spans
    ]
    return Table("", ["made ahead", "predictions", "median", "90 % below"], rows)


def span_words(one: Ahead) -> str:
    """From when to when predictions were made before their touchdowns."""
    return f"{1e3 * one.begin:.0f} to {1e3 * one.end:.0f} ms"


def draw_ahead(spans: Sequence[Ahead], quantity: Quantity, shape: Shape, label: str) -> Markup:
    """Median and 90 % of each span of lead time as SVG."""
    known = [one for one in spans if one.errors.number]
    with matplotlib.rc_context(STYLE):
        figure, axes = shape.picture("made before the touchdown, ms", quantity.axis)
        most = quantity.factor * max(one.errors.p90 or 0.0 for one in known)
        axes.set(xlim=(0.0, 1e3 * spans[-1].end), ylim=(0.0, 1.15 * most or 1.0))
        axes.xaxis.set_major_locator(FixedLocator([1e3 * one.begin for one in spans] + [1e3 * spans[-1].end]))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.grid(axis="y")
        marks: dict[str, Mark] = {}
        lines = []
        for name, part, number in (("median", "p50", 0), ("90 % below", "p90", 1)):
            colour = family_colour(number)
            x = [500.0 * (one.begin + one.end) for one in known]
            y = [quantity.factor * getattr(one.errors, part) for one in known]
            axes.plot(x, y, color=colour, linewidth=1.8, zorder=3)
            for one, *place in zip(known, x, y, strict=True):
                gid = f"{part}-{len(marks)}"
                axes.plot(*place, "os"[number], color=colour, markersize=8.0, gid=gid, clip_on=False, zorder=4)
                told = f"{span_words(one)} ahead, {counted(one.errors.number, 'prediction')}"
                half, ends = quantity.words(one.errors.p50), quantity.words(one.errors.p90)
                marks[gid] = Mark(f"{told}\nmedian {half}\n90 % below {ends}", {})
            lines.append(Line(name, colour, np.array([x, y]).T))
        write_names(axes, lines, FONT)
        return svg_of(figure, f"{quantity.key}-{shape.name}", label, marks, shape.name)


COST_SHAPES: Final = (
    Shape("wide", 680.0, 260.0, (20.0, 20.0, 48.0, 66.0)),
    Shape("narrow", 345.0, 260.0, (14.0, 14.0, 46.0, 66.0)),
)
BARS: Final = 10
"""Bars for each factor of ten."""
NAME: Final = 135.0
"""Width of the name of a line, in pixels."""
PARTS: Final = {"p50": "median", "p90": "90 % below", "p99": "99 % below"}


def cost_section(answers: Sequence[Answer]) -> Section | None:
    """The section of costs; None where nothing is known of them."""
    spread = costs(answers)
    if spread.p50 is None:
        return None
    words = (
        "The time from a sample to its prediction, as this machine took it: without reading the bag and writing "
        "messages, which a node does besides. A sample that shows no touchdown ahead takes the least."
    )
    numbers = [Cell(time_words(one)) for one in (spread.p50, spread.p90, spread.p99, spread.most)]
    row = [Cell(counted(spread.number, "sample")), *numbers]
    table = Table("", ["", "median", "90 % below", "99 % below", "longest"], [row], cards=True)
    said = ", ".join(f"{name} {time_words(getattr(spread, part))}" for part, name in PARTS.items())
    caption = "How many samples took how long; each bar is a quarter longer than the one before."
    label = f"Time for a sample: {said}, longest {time_words(spread.most)}."
    figure = Figure("Time for a sample", caption, [draw_costs(spread, shape, label) for shape in COST_SHAPES])
    return Section("cost", "What a sample costs", [words], tables=[table], figures=[figure])


def bars_of(bins: Mapping[int, int]) -> dict[int, int]:
    """How many lie in each bar k, which goes from 10**(k / BARS) to 10**((k + 1) / BARS)."""
    bars: Counter[int] = Counter()
    for place, count in bins.items():
        bars[place * BARS // PER_DECADE] += count
    return dict(bars)


def place_of(us: float | None) -> float:
    """Where a time in microseconds lies, in bars."""
    return BARS * log10(max(us or 0.0, LEAST))


def draw_costs(spread: Spread, shape: Shape, label: str) -> Markup:
    """Bars over the logarithm of the time, as SVG."""
    bars = bars_of(spread.bins)
    first, width = min(bars), (shape.width - shape.margins[0] - shape.margins[1]) - NAME
    # The axis has room for the name of the last line.
    last: float = max(max(bars) + 1, first + 3, first + (place_of(spread.p99) - first) * (width + NAME) / width)
    with matplotlib.rc_context(STYLE):
        figure, axes = shape.picture("time for a sample")
        _, _, bottom, top = shape.margins
        axes.set(xlim=(first, last), ylim=(0.0, 1.05 * max(bars.values())))
        axes.set_yticks([])
        axes.spines["left"].set_visible(False)
        decades = range(ceil(first / BARS), floor(last / BARS) + 1)
        axes.xaxis.set_major_locator(FixedLocator([BARS * decade for decade in decades]))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: time_words(10.0 ** (value / BARS))))
        axes.xaxis.set_minor_locator(NullLocator())
        marks = {}
        for place, count in sorted(bars.items()):
            gid = f"bar-{place - first}"
            axes.bar(place + 0.5, count, 0.9, color=family_colour(0), alpha=0.75)
            axes.patches[-1].set_gid(gid)
            ends = (time_words(10.0 ** ((place + end) / BARS)) for end in (0, 1))
            marks[gid] = Mark(f"{' to '.join(ends)}: {counted(count, 'sample')}, {share(count / spread.number)}", {})
        for number, (part, name) in enumerate(PARTS.items()):
            # Each name stands right of its line, above the lines that come after it.
            at = place_of(getattr(spread, part))
            y = (shape.height - 4.0 - 18.0 * number - bottom) / (shape.height - bottom - top)
            axes.plot([at, at], [0.0, y], transform=axes.get_xaxis_transform(), color=INK, clip_on=False)
            axes.annotate(
                f"{name} {time_words(getattr(spread, part))}",
                (at, y),
                (4.0, 0.0),
                xycoords=axes.get_xaxis_transform(),
                textcoords="offset pixels",
                va="top",
                annotation_clip=False,
            )
        return svg_of(figure, f"cost-{shape.name}", label, marks, shape.name)
