"""Predicted against measured velocities right after the touchdowns: points, or squares where they are many."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from heapq import nlargest
from math import floor, log
from operator import itemgetter
from typing import Final, NamedTuple

import matplotlib
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ....stamps import NANOSECONDS
from ....wording import counted
from ...summary import quantile
from ..chart import Shape
from ..looks import marker_svg
from ..sections import Cell, Figure, Key, Section, Table
from ..svg import MUTED, STYLE, Mark, svg_of
from .answers import Answer, besides_truth, names_of, scored_of
from .lanes import begin_of
from .words import MODES, SAYS, mode_words, percent, velocity_words

SHAPES: Final = (
    Shape("wide", 460.0, 440.0, (58.0, 14.0, 48.0, 26.0)),
    Shape("narrow", 345.0, 345.0, (54.0, 12.0, 46.0, 26.0)),
)
MANY: Final = 500
"""Touchdowns above which squares are drawn, each for those in it."""
SQUARES: Final = 36
"""Squares along each axis."""
LEAST_PART: Final = 0.1
"""Of the longer axes, that the shorter ones have at least: what hardly moves is not magnified to scatter."""
LISTED: Final = 100
"""Touchdowns whose numbers are listed, those of the largest errors."""

QUANTITIES: Final[Mapping[str, tuple[str, Callable[[Sequence[float], float], float]]]] = {
    "vx": ("Along the support: vx", lambda twist, arm: twist[0]),
    "turning": ("From turning: ω times half the contacts' distance", lambda twist, arm: twist[2] * arm),
}
"""What is compared: its name, and its value in m/s from a twist and half the distance of the contacts."""


class Pair(NamedTuple):
    """A velocity after a touchdown in m/s, predicted and measured, and what is told of it: "" where they are many."""

    measured: float
    predicted: float
    mode: str
    told: str


def velocities(answers: Sequence[Answer]) -> Section | None:
    """The section of predicted against measured velocities; None where none were measured."""
    scored = scored_of(answers)
    if not scored:
        return None
    words = (
        "Each point is a touchdown: to the right the velocity that the samples after it show, upwards the one that was "
        "predicted last before it. On the line both are the same. The relative error of a touchdown is the distance of "
        "both its points from the line, over its velocities before the impact."
    )
    said = [words, *besides_truth(answers)]
    modes = Counter(one["mode"] for one in scored)
    key = [
        Key(marker_svg(looks), mode, f"{SAYS[mode]} ({modes[mode]:,})") for mode, looks in MODES.items() if modes[mode]
    ]
    pairs = pairs_of(answers)
    widest = max(high - low for low, high in map(limits_of, pairs.values()))
    figures = [figure_of(mine, name, LEAST_PART * widest) for name, mine in pairs.items()]
    listed = [worst_table(answers)]
    return Section("velocities", "Predicted against measured velocities", said, key, listed, figures)


def pairs_of(answers: Sequence[Answer]) -> dict[str, list[Pair]]:
    """The velocities of every touchdown that is compared, by their quantities, in the order of the bags."""
    pairs: dict[str, list[Pair]] = {quantity: [] for quantity in QUANTITIES}
    names, told_each = names_of(answers), len(scored_of(answers)) <= MANY
    for name, answer in zip(names, answers, strict=True):
        for one in scored_of([answer]):
            for quantity, (_, of) in QUANTITIES.items():
                arm = one["half_distance"]
                told, measured = of(one["predicted_twist"], arm), of(one["measured_twist"], arm)
                title = ""
                if told_each:
                    first = f"{name}, " if len(names) > 1 else ""
                    title = (
                        f"{first}{since(answer, one['stamp']):.3f} s, {one['mode']}\npredicted {velocity_words(told)}, "
                        f"measured {velocity_words(measured)}\nrelative error {percent(one['relative_error'])}"
                    )
                pairs[quantity].append(Pair(measured, told, one["mode"], title))
    return pairs


def since(answer: Answer, stamp: int) -> float:
    """Seconds from the first sample of a record to a stamp in ns."""
    return (stamp - begin_of(answer)) / NANOSECONDS


def figure_of(pairs: Sequence[Pair], quantity: str, least: float) -> Figure:
    """The picture of one velocity, over at least so many m/s."""
    title, _ = QUANTITIES[quantity]
    wrong = sorted(abs(pair.predicted - pair.measured) for pair in pairs)
    half, most = quantile(wrong, 0.5), quantile(wrong, 0.9)
    half_words, most_words = (velocity_words(max(one, 0.001)) for one in (half, most))
    caption = f"Half of the points are within {half_words} of the line, 90 % within {most_words}."
    label = f"{title}, predicted against measured, of {counted(len(pairs), 'touchdown')}. {caption}"
    return Figure(title, caption, [draw(pairs, shape, quantity, label, least) for shape in SHAPES], notes_of(pairs))


def notes_of(pairs: Sequence[Pair]) -> list[str]:
    """How to read squares, where there are any."""
    if len(pairs) <= MANY:
        return []
    many = "There are too many touchdowns for a point each: a square stands for all that fall into it"
    return [f"{many}, the stronger the more they are, in the colour of their commonest mode."]


def draw(pairs: Sequence[Pair], shape: Shape, name: str, label: str, least: float) -> Markup:
    """The picture as SVG."""
    with matplotlib.rc_context(STYLE):
        figure, axes = shape.picture("measured, m/s", "predicted, m/s")
        limits = limits_of(pairs, least)
        axes.set(xlim=limits, ylim=limits)
        axes.xaxis.set_major_locator(MaxNLocator(6))
        axes.yaxis.set_major_locator(MaxNLocator(6))
        axes.grid()
        axes.tick_params(axis="x", pad=9.0)
        axes.plot(limits, limits, color=MUTED, linewidth=1.2, zorder=2)
        marks = draw_points(axes, pairs) if len(pairs) <= MANY else draw_squares(axes, pairs, limits)
        return svg_of(figure, f"{name}-{shape.name}", label, marks, shape.name)


def limits_of(pairs: Sequence[Pair], least: float = 0.0) -> tuple[float, float]:
    """The ends of both axes in m/s, at least so far apart.

    Of many points the last few may lie beyond, not to press the others together.
    """
    values = [value for pair in pairs for value in pair[:2]]
    out = 0.0 if len(pairs) <= MANY else 0.002
    low, high = quantile(values, out), quantile(values, 1.0 - out)
    room = max(0.06 * (high - low), 0.5 * (least - high + low)) or 0.5
    return low - room, high + room


def draw_points(axes: Axes, pairs: Sequence[Pair]) -> dict[str, Mark]:
    """A point for each touchdown, those of a mode at once."""
    marks = {}
    of_mode: dict[str, list[Pair]] = defaultdict(list)
    for pair in pairs:
        of_mode[pair.mode].append(pair)
    for mode, mine in of_mode.items():
        looks, gid = MODES[mode], f"velocities-{mode}"
        x, y = [pair.measured for pair in mine], [pair.predicted for pair in mine]
        axes.plot(
            *(x, y, looks.marker),
            color=looks.colour,
            markersize=7.0,
            markeredgewidth=0.0,
            alpha=0.65,
            gid=gid,
            zorder=3,
        )
        marks[gid] = Mark("", {}, [pair.told for pair in mine])
    return marks


def draw_squares(axes: Axes, pairs: Sequence[Pair], limits: tuple[float, float]) -> dict[str, Mark]:
    """A square for all touchdowns in it."""
    squares = squares_of(pairs, limits)
    low, size, marks = limits[0], (limits[1] - limits[0]) / SQUARES, {}
    most = max(sum(modes.values()) for modes in squares.values())
    for (column, row), modes in squares.items():
        (mode, _), count = modes.most_common(1)[0], sum(modes.values())
        strength = 0.25 + 0.75 * (log(count) / log(most) if most > 1 else 1.0)
        place, gid = (low + column * size, low + row * size), f"square-{column}-{row}"
        # Not add_patch, which would look after limits that are set already, at ten times the time.
        axes.add_artist(Rectangle(place, size, size, facecolor=MODES[mode].colour, alpha=strength, gid=gid, zorder=3))
        said = ", ".join(f"{number:,} {mode}" for mode, number in modes.most_common())
        marks[gid] = Mark(f"{counted(count, 'touchdown')}: {said}", {})
    return marks


def squares_of(pairs: Sequence[Pair], limits: tuple[float, float]) -> dict[tuple[int, int], Counter[str]]:
    """How many touchdowns of which modes fall into each square, by its column and row; those beyond at the edge."""
    low, high = limits
    squares: dict[tuple[int, int], Counter[str]] = defaultdict(Counter)
    for pair in pairs:
        places = (floor((value - low) / (high - low) * SQUARES) for value in pair[:2])
        column, row = (min(max(place, 0), SQUARES - 1) for place in places)
        squares[column, row][pair.mode] += 1
    return dict(squares)


def worst_table(answers: Sequence[Answer]) -> Table:
    """The numbers of the touchdowns that are compared, those of the largest errors first."""
    names = names_of(answers)
    several, named = len(names) > 1, len({one["body"] for one in scored_of(answers)}) > 1
    found = (
        (one["relative_error"], name, since(answer, one["stamp"]), one)
        for name, answer in zip(names, answers, strict=True)
        for one in scored_of([answer])
    )
    worst = nlargest(LISTED, found, key=itemgetter(0))
    rows = []
    for error, name, time, one in worst:
        of = "".join([f"{name}, " if several else "", f"{one['body']}, " if named else ""])
        cells = [Cell(f"{of}{time:.3f} s", ", ".join(mode_words(flag) for flag in one["flags"])), Cell(one["mode"])]
        for told, measured in zip(one["predicted_twist"], one["measured_twist"], strict=True):
            cells.append(Cell(f"{told:.3f}", f"{measured:.3f} measured"))
        rows.append([*cells, Cell(percent(error))])
    all_scored = len(scored_of(answers))
    number = f"The {len(rows)} of the largest errors, of {all_scored:,}." if len(rows) < all_scored else ""
    head = ["touchdown", "mode", "vx, m/s", "vy, m/s", "ω, rad/s", "error"]
    return Table(number, head, rows, words=2, cards=True, folded="Touchdown by touchdown")
