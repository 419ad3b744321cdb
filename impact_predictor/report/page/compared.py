"""Sections of the page of a replay on what was predicted: velocities against measured ones, modes against true ones."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from heapq import nlargest
from statistics import median
from typing import Any, Final

from ...stamps import NANOSECONDS
from ...wording import counted, words
from ..modes import MODES
from ..summary import quantile
from . import found
from .document import GREY, Cell, Chart, PageTable, Section, marks, part_words, plot, titled, within_words
from .found import BagAnswer
from .timeline import in_order, look_of

ROWS: Final = 100
"""Touchdowns in a table."""

MANY: Final = 500
"""Touchdowns above which squares count them."""


def velocities(answers: Sequence[BagAnswer]) -> Section | None:
    """Predicted against measured velocities right after the touchdowns; None where none were measured."""
    rows = list(_compared(answers))
    if not rows:
        return None
    what = (
        "Each point is a touchdown: to the right the velocity that the samples after it show, upwards the one that was "
        "predicted last before it. On the line both are the same. The relative error of a touchdown is the distance of "
        "both its points from the line, over its velocities before the impact."
    )
    said = [what]
    if (known := found.measured_and_true(answers)) is not None:
        measured, true = map(within_words, known)
        said.append(
            f"The true velocities are known too: 90 % of the predictions are within {true} of them, but within "
            f"{measured} of the measured ones. These are of the samples 2 to 4 after a touchdown; by then gravity, "
            "further impacts and a moving support have changed what the impact left. A record without the truth has "
            "nothing better."
        )
    along = [(one["measured_twist"][0], one["predicted_twist"][0]) for _, one in rows]
    arms = [one["half_distance"] for _, one in rows]
    turning = [
        (arm * one["measured_twist"][2], arm * one["predicted_twist"][2])
        for arm, (_, one) in zip(arms, rows, strict=True)
    ]
    charts = [
        _against("Along the support: vx", along, rows),
        _against("From turning: ω times half the contacts' distance", turning, rows),
    ]
    return Section("velocities", "Predicted against measured velocities", said, [*charts, _worst(rows)])


def _compared(answers: Sequence[BagAnswer]) -> Iterable[tuple[str, BagAnswer]]:
    """Every touchdown that is compared, with what it is called."""
    names = found.names_of(answers)
    several = len({one["body"] for one in found.scored_of(answers)}) > 1
    for name, answer in zip(names, answers, strict=True):
        for one in found.scored_of([answer]):
            where = [name] if len(names) > 1 else []
            where += [one["body"]] if several else []
            yield ", ".join([*where, f"{(one['stamp'] - found.begin_of(answer)) / NANOSECONDS:.3f} s"]), one


def _against(title: str, pairs: Sequence[tuple[float, float]], rows: Sequence[tuple[str, BagAnswer]]) -> Chart:
    """Pairs of a measured and a predicted velocity in m/s: a point each, or squares that count them where many."""
    values = [value for pair in pairs for value in pair]
    # Of many points the last few may lie beyond, not to press the others together.
    out = 0.0 if len(pairs) <= MANY else 0.002
    ends = [quantile(values, out), quantile(values, 1.0 - out) + 1e-9]
    line = {"type": "scatter", "mode": "lines", "x": ends, "y": ends, "line": {"color": GREY}}
    traces: list[dict[str, Any]] = [line | {"hoverinfo": "skip", "showlegend": False}]
    if len(pairs) > MANY:
        x, y = ([round(value, 4) for value in column] for column in zip(*pairs, strict=True))
        clear = [[0.0, "rgba(0,114,178,0)"], [0.001, "rgba(0,114,178,0.25)"], [1.0, "rgb(0,50,90)"]]
        bins = {"start": ends[0], "end": ends[1], "size": (ends[1] - ends[0]) / 36}
        squares = {"type": "histogram2d", "x": x, "y": y, "xbins": bins, "ybins": bins}
        traces.append(squares | {"colorscale": clear, "colorbar": titled("touchdowns")})
    else:
        for mode in in_order(one["mode"] for _, one in rows):
            points = [
                (*pair, f"{name}\nmeasured {pair[0]:.3f}, predicted {pair[1]:.3f} m/s\n{_error_of(one)}")
                for pair, (name, one) in zip(pairs, rows, strict=True)
                if one["mode"] == mode
            ]
            look = look_of(mode) | {"opacity": 0.75, "size": 8}
            traces.append(marks(f"{mode} ({len(points):,})", points, marker=look))
    axes = {"xaxis": titled("measured, m/s"), "yaxis": titled("predicted, m/s", scaleanchor="x")}
    wrong = [abs(predicted - measured) for measured, predicted in pairs]
    half, most = (max(quantile(wrong, part), 0.001) for part in (0.5, 0.9))
    many = " There are too many touchdowns for a point each: a square counts all that fall into it."
    caption = f"Half of the points are within {half:.3f} m/s of the line, 90 % within {most:.3f} m/s."
    return Chart(title, plot(traces, 460, **axes), caption + (many if len(pairs) > MANY else ""), wide=False)


def _error_of(one: BagAnswer) -> str:
    return f"relative error {part_words(one['relative_error'])}"


def _worst(rows: Sequence[tuple[str, BagAnswer]]) -> PageTable:
    """The numbers of the touchdowns that are compared, those of the largest errors first."""
    worst = nlargest(ROWS, rows, key=lambda row: row[1]["relative_error"])
    cells: list[list[Cell | str]] = []
    for name, one in worst:
        mine: list[Cell | str] = [Cell(name, ", ".join(words(flag) for flag in one["flags"])), one["mode"]]
        for predicted, measured in zip(one["predicted_twist"], one["measured_twist"], strict=True):
            mine.append(Cell(f"{predicted:.3f}", f"{measured:.3f} measured"))
        cells.append([*mine, part_words(one["relative_error"])])
    head = ["touchdown", "mode", "vx, m/s", "vy, m/s", "ω, rad/s", "error"]
    more = f"The {len(worst)} of the largest errors, of {len(rows):,}." if len(worst) < len(rows) else ""
    return PageTable(head, cells, more, 2, "Touchdown by touchdown")


def modes(answers: Sequence[BagAnswer]) -> Section | None:
    """The modes that were predicted against the true ones, or what can be told of them without a truth."""
    # Of a landing it is the mode of an impact with the speed of the foot in its last sample in the air.
    predicted = Counter(one.get("landing_mode") or one["mode"] for one in found.touchdowns_of(answers))
    if not predicted:
        return None
    counts = found.confusion(answers)
    if counts:
        return Section("modes", "Predicted against true modes", [_right_modes(counts)], [_confusion(counts)])
    untold = (
        "The record does not tell in which modes the bodies truly went on, and its velocities do not either: whether a "
        "contact lifts shows in the vertical velocity, in which an impact is lost among what gravity and other contacts"
        " do before the next samples. What can be checked is how well the velocities agree that each mode comes with."
    )
    errors: dict[str, list[float]] = defaultdict(list)
    for one in found.scored_of(answers):
        errors[one["mode"]].append(one["relative_error"])
    rows = [
        [
            mode,
            f"{predicted[mode]:,}",
            f"{len(errors[mode]):,}",
            part_words(median(errors[mode]) if errors[mode] else None),
            part_words(quantile(errors[mode], 0.9) if errors[mode] else None),
        ]
        for mode in in_order(predicted)
    ]
    head = ["predicted mode", "touchdowns", "compared", "median error", "90 % below"]
    return Section("modes", "Predicted modes", [untold], [PageTable(head, rows)])


def _right_modes(counts: Counter[tuple[str, str]]) -> str:
    both = {pair: count for pair, count in counts.items() if found.NOTHING not in pair}
    right = sum(count for (true, predicted), count in both.items() if true == predicted)
    missed = sum(count for (_, predicted), count in counts.items() if predicted == found.NOTHING)
    false = sum(count for (true, _), count in counts.items() if true == found.NOTHING)
    said = f"The mode is right in {right:,} of the {counted(sum(both.values()), 'true touchdown')} that were found."
    rest = [f"{missed:,} missed" if missed else "", counted(false, "false alarm") if false else ""]
    return f"{said} Besides: {', '.join(filter(None, rest))}." if any(rest) else said


def _confusion(counts: Counter[tuple[str, str]]) -> PageTable:
    """A row for each true mode, a column for each predicted one; what is right is marked."""
    order = [*(mode.name for mode in MODES), found.NOTHING]
    true = [mode for mode in order if any(pair[0] == mode for pair in counts)]
    predicted = [mode for mode in order if any(pair[1] == mode for pair in counts)]

    def cell(row: str, column: str) -> Cell:
        number = counts[row, column]
        return Cell(f"{number:,}" if number else "–", css="best" if row == column else "" if number else "none")

    rows: list[list[Cell | str]]
    rows = [
        ["false alarm" if row == found.NOTHING else row, *(cell(row, column) for column in predicted)] for row in true
    ]
    caption = "How many touchdowns of each true mode (a row) were predicted in which mode (a column)."
    return PageTable(["true mode", *("missed" if mode == found.NOTHING else mode for mode in predicted)], rows, caption)
