"""The sections of the page of a replay: each function gives a heading, sentences, and tables or charts."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from heapq import nlargest
from math import hypot, log10
from statistics import median
from typing import TYPE_CHECKING, Any, Final

from ...mechanics.types import Mode
from ...prediction.features import features_of
from ...prediction.remedies import REMEDIES
from ...prediction.types import Status
from ...stamps import NANOSECONDS
from ...wording import counted, words
from ..modes import MODES, PALETTE
from ..spread import LEAST, PER_DECADE
from ..summary import WHY, quantile, without_bag
from .answers import (
    NOTHING,
    Answer,
    SpanErrors,
    announced,
    begin_of,
    confusion,
    costs,
    errors_ahead,
    found_of,
    landings_of,
    measured_and_true,
    names_of,
    refused,
    scored_of,
    time_error,
    touchdowns_of,
    true_touchdowns_of,
    uncompared,
    used,
    velocity_errors,
    worst_of,
)
from .document import (
    GREY,
    Cell,
    Chart,
    PageTable,
    Section,
    part_words,
    plot,
    safe,
    signed_ms,
    time_words,
    within_words,
)
from .timeline import in_order, lanes_of, look_of, timeline

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as PlotlyFigure

LISTED: Final = 30
"""Bags that are listed; of more the worst."""

DRAWN: Final = 8
"""Bags of which a timeline is drawn; of more the worst."""

ROWS: Final = 100
"""Touchdowns, landings or remarks in a table."""

MANY: Final = 500
"""Touchdowns above which squares count them."""


def bags(answers: Sequence[Answer], links: Mapping[int, str]) -> Section | None:
    """A row for each of several bags, and how their errors are spread; None where there is only one."""
    if len(answers) < 2:
        return None
    names, said = names_of(answers), []
    if len(answers) > LISTED:
        worst = "first those that could not be used, then by what was missed or announced in vain, then by the error"
        said = [f"The worst {LISTED} of {len(answers):,} bags: {worst}."]
    rows = []
    for place in worst_of(answers, range(len(answers)), LISTED):
        answer = answers[place]
        remark = (
            "could not be read" if "error" in answer else "nothing predicted" if answer.get("unpredictable") else ""
        )
        name = Cell(names[place], remark or ("damaged" if "damaged" in answer else ""), to=links.get(place, ""))
        rows.append([name, *(_of_bag(answer) if "error" not in answer else [""] * 6)])
    head = ["bag", "touchdowns", "found", "velocity error", "time error", "first ahead", "a sample"]
    kept = [k for k in range(len(head)) if any(row[k] not in ("", "–") for row in rows)]
    table = PageTable([head[k] for k in kept], [[row[k] for k in kept] for row in rows])
    return Section("bags", "The bags", said, [table, *_spread_over_bags(answers)])


def _of_bag(answer: Answer) -> list[Cell | str]:
    there, errors, times = found_of([answer]), velocity_errors([answer]), announced([answer])
    cost = costs([answer]).p50
    found, below = ("–", "") if there is None else (f"{there.found:,} of {there.there:,}", "")
    if there is not None and there.false:
        below = counted(there.false, "false alarm")
    compared = f"90 % below {part_words(errors.p90)}, {errors.number:,} compared" if errors.number else ""
    return [
        f"{len(answer['touchdowns']):,}",
        Cell(found, below) if below else found,
        Cell(part_words(errors.median), compared) if compared else "–",
        time_words(time_error(answer)),
        time_words(median(times) if times else None),
        time_words(None if cost is None else 1e-6 * cost),
    ]


def _spread_over_bags(answers: Sequence[Answer]) -> list[Chart]:
    """The median errors of many bags, from the best to the worst; nothing where they are few."""
    errors = [median for answer in used(answers) if (median := velocity_errors([answer]).median) is not None]
    axis, values = "median relative error of a bag, %", [100.0 * error for error in errors]
    if not errors:
        times = (time_error(answer) for answer in used(answers))
        axis, values = "median error of the time of a bag, ms", [1e3 * time for time in times if time is not None]
    if len(values) <= LISTED:
        return []
    shares = [0.5 * k for k in range(201)]
    line = {"type": "scatter", "x": shares, "y": [quantile(values, 0.01 * share) for share in shares], "name": axis}
    hover = {"hovertemplate": "%{x} % of the bags are below %{y:.3g}<extra></extra>", "line": {"color": PALETTE[0]}}
    layout = {"xaxis": {"title": {"text": "bags with a smaller error, %"}}, "yaxis": {"title": {"text": axis}}}
    return [Chart("Errors of the bags", plot([line | hover], 300, **layout), "From the best bag to the worst.")]


MEASURED: Final = (
    "The record does not tell when contacts closed, so a touchdown stands where it was predicted last; a line before "
    "it leads back to when it was first announced. Below it is how wrong its velocities were against those that the "
    "samples after it show. In the last lane are those that cannot be compared: point at one for the reason."
)
TRUE: Final = (
    "The predicted touchdowns stand above the true ones, which the record tells; a line before a mark leads back to "
    "when it was first announced. A red star is a touchdown that was missed, a red cross one that never came. Faint is "
    "what such a record cannot show: too slow to be told from rest, or too soon after another. Below them is how wrong "
    "the velocities were that were predicted last, against the true ones."
)
FEET: Final = (
    "A mark is the landing of a foot where it was predicted last, and the line before it leads back to when it was "
    "first announced; its mode is that of an impact with the foot's speed in its last sample in the air. A red star is "
    "a landing that nothing announced. Below them is when the foot stands, as its motion shows and, where it does, as "
    "the record tells."
)


def when(answers: Sequence[Answer], places: Sequence[int]) -> Section | None:
    """The timelines of some bags, with the numbers of each; None where nothing was predicted."""
    if not places:
        return None
    names, said = names_of(answers), list[str]()
    parts: list[PageTable | Chart] = []
    marks: set[str] = set()
    for place in places:
        answer = answers[place]
        feet, true = "gaits" in answer, "true_touchdowns" in answer
        said.append(FEET if feet else TRUE if true else MEASURED)
        figure, notes = timeline(answer)
        marks |= {mark.mark for lane in lanes_of(answer) for mark in lane.marks}
        parts += [Chart(names[place], figure, " ".join(notes), anchor=f"bag-{place + 1}"), *_numbers(answer)]
    if len(places) == DRAWN < len(answers):
        said.insert(0, f"The timelines of the worst {DRAWN} of {len(answers):,} bags.")
    zoom = "Drag over a part of the time to magnify it, double-click to see all of it again; point at a mark for more."
    return Section("when", "When the touchdowns came", [*dict.fromkeys(said), zoom, meanings(marks)], parts)


def meanings(marks: Iterable[str]) -> str:
    """What follows in each mode."""
    known = [name for name in in_order(marks) if name in Mode.__members__]
    return "Modes: " + "; ".join(f"{name}, {MODES[Mode[name]].meaning}" for name in known) + "."


def _numbers(answer: Answer) -> list[PageTable]:
    """The landings of feet, or what was missed and announced in vain, as a table."""
    start = begin_of(answer)
    if landings := list(landings_of([answer])):
        rows = [_landing_cells(one, start) for one in landings[:ROWS]]
        head = ["time", "foot", "first ahead", "last predicted time", "speed", "impulse", "after the plan"]
        more = f"The first {ROWS} of {len(landings):,} landings." if len(landings) > ROWS else ""
        return [PageTable(head, rows, more, 2, "Landing by landing")]
    wrong = [
        one
        for one in true_touchdowns_of([answer])
        if one["stamp"] is None or (one["shown"] and one["predicted_stamp"] is None)
    ]
    rows = [
        [
            f"{((one['stamp'] or one['predicted_stamp']) - start) / NANOSECONDS:.3f} s",
            one["body"],
            "missed" if one["stamp"] else "false alarm",
            one["mode"] or one["predicted_mode"] or "",
        ]
        for one in wrong[:ROWS]
    ]
    return [PageTable(["time", "body", "", "mode"], rows, "", 4, "What was missed, and false alarms")] if rows else []


def _landing_cells(one: Answer, start: int) -> list[Cell | str]:
    impulse, others = one["impulse"], one.get("others_impulse")
    below = f"{_size(others):.2f} N s at other feet" if others else ""
    return [
        Cell(f"{(one['stamp'] - start) / NANOSECONDS:.3f} s", one["point"] or ""),
        one["foot"],
        time_words(one["announced_lead_time"]) if one["time_error"] is not None else "not announced",
        signed_ms(one["time_error"]),
        "–" if one["landing_speed"] is None else f"{one['landing_speed']:.3f} m/s",
        "–" if impulse is None else Cell(f"{_size(impulse):.2f} N s", below),
        signed_ms(one["late"]),
    ]


def _size(vector: Sequence[float]) -> float:
    return hypot(*vector)


def velocities(answers: Sequence[Answer]) -> Section | None:
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
    if (known := measured_and_true(answers)) is not None:
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


def _compared(answers: Sequence[Answer]) -> Iterable[tuple[str, Answer]]:
    """Every touchdown that is compared, with what it is called."""
    names = names_of(answers)
    several = len({one["body"] for one in scored_of(answers)}) > 1
    for name, answer in zip(names, answers, strict=True):
        for one in scored_of([answer]):
            where = [name] if len(names) > 1 else []
            where += [one["body"]] if several else []
            yield ", ".join([*where, f"{(one['stamp'] - begin_of(answer)) / NANOSECONDS:.3f} s"]), one


def _against(title: str, pairs: Sequence[tuple[float, float]], rows: Sequence[tuple[str, Answer]]) -> Chart:
    """Pairs of a measured and a predicted velocity in m/s: a point each, or squares that count them where many."""
    values = [value for pair in pairs for value in pair]
    # Of many points the last few may lie beyond, not to press the others together.
    out = 0.0 if len(pairs) <= MANY else 0.002
    low, high = quantile(values, out), quantile(values, 1.0 - out)
    low, high = low - 0.06 * (high - low) - 1e-9, high + 0.06 * (high - low) + 1e-9
    line = {
        "type": "scatter",
        "mode": "lines",
        "x": [low, high],
        "y": [low, high],
        "line": {"color": GREY, "width": 1.2},
    }
    traces: list[dict[str, Any]] = [line | {"name": "equal", "hoverinfo": "skip", "showlegend": False}]
    if len(pairs) > MANY:
        traces.append(
            {
                "type": "histogram2d",
                "x": [round(one, 4) for one, _ in pairs],
                "y": [round(other, 4) for _, other in pairs],
                "autobinx": False,
                "autobiny": False,
                "xbins": {"start": low, "end": high, "size": (high - low) / 36},
                "ybins": {"start": low, "end": high, "size": (high - low) / 36},
                "colorscale": [[0.0, "rgba(11,108,196,0)"], [0.001, "rgba(11,108,196,0.25)"], [1.0, "rgb(8,60,110)"]],
                "colorbar": {"title": {"text": "touchdowns"}},
                "hovertemplate": "%{z} touchdowns<extra></extra>",
            }
        )
    else:
        for mode in in_order(one["mode"] for _, one in rows):
            mine = [k for k, (_, one) in enumerate(rows) if one["mode"] == mode]
            traces.append(
                {
                    "type": "scatter",
                    "mode": "markers",
                    "name": f"{mode} ({len(mine):,})",
                    "x": [pairs[k][0] for k in mine],
                    "y": [pairs[k][1] for k in mine],
                    "text": [
                        safe(f"{rows[k][0]}\nrelative error {part_words(rows[k][1]['relative_error'])}") for k in mine
                    ],
                    "hovertemplate": "%{text}<br>predicted %{y:.3f} m/s, measured %{x:.3f} m/s<extra></extra>",
                    "marker": look_of(mode) | {"opacity": 0.75, "size": 8},
                }
            )
    axes = {"range": [low, high], "constrain": "domain"}
    figure = plot(
        traces,
        height=460,
        margin={"l": 64, "r": 16, "t": 40, "b": 48},
        xaxis={"title": {"text": "measured, m/s"}, **axes},
        yaxis={"title": {"text": "predicted, m/s"}, "scaleanchor": "x", **axes},
    )
    wrong = [abs(predicted - measured) for measured, predicted in pairs]
    half, most = (max(quantile(wrong, part), 0.001) for part in (0.5, 0.9))
    many = " There are too many touchdowns for a point each: a square counts all that fall into it."
    caption = f"Half of the points are within {half:.3f} m/s of the line, 90 % within {most:.3f} m/s."
    return Chart(title, figure, caption + (many if len(pairs) > MANY else ""), wide=False)


def _worst(rows: Sequence[tuple[str, Answer]]) -> PageTable:
    """The numbers of the touchdowns that are compared, those of the largest errors first."""
    worst = nlargest(ROWS, rows, key=lambda row: row[1]["relative_error"])
    cells: list[list[Cell | str]] = []
    for name, one in worst:
        mine: list[Cell | str] = [Cell(name, ", ".join(words(flag) for flag in one["flags"])), one["mode"]]
        for told, measured in zip(one["predicted_twist"], one["measured_twist"], strict=True):
            mine.append(Cell(f"{told:.3f}", f"{measured:.3f} measured"))
        cells.append([*mine, part_words(one["relative_error"])])
    head = ["touchdown", "mode", "vx, m/s", "vy, m/s", "ω, rad/s", "error"]
    more = f"The {len(worst)} of the largest errors, of {len(rows):,}." if len(worst) < len(rows) else ""
    return PageTable(head, cells, more, 2, "Touchdown by touchdown")


def modes(answers: Sequence[Answer]) -> Section | None:
    """The modes that were predicted against the true ones, or what can be told of them without a truth."""
    predicted = Counter(one["mode"] for one in touchdowns_of(answers))
    if not predicted:
        return None
    counts = confusion(answers)
    landings = list(landings_of(answers))
    if counts:
        return Section("modes", "Predicted against true modes", [_right_modes(counts)], [_confusion(counts)])
    if landings:
        said = ", ".join(f"{count:,} {mode}" for mode, count in Counter(one["mode"] for one in landings).items())
        feet = (
            "The record tells when feet stand, not what their impacts do: the modes of landings are predictions alone. "
            "In the table they are of an impact with the speed of the foot in its last sample in the air."
        )
        told = f"As they were predicted, with the speed that was expected at the ground: {said}."
        return Section("modes", "Modes of the landings", [feet, told], [_landing_modes(landings)])
    untold = (
        "The record does not tell in which modes the bodies truly went on, and its velocities do not either: whether a "
        "contact lifts shows in the vertical velocity, in which an impact is lost among what gravity and other contacts"
        " do before the next samples. What can be checked is how well the velocities agree that each mode comes with."
    )
    errors: dict[str, list[float]] = defaultdict(list)
    for one in scored_of(answers):
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
    found = {pair: count for pair, count in counts.items() if NOTHING not in pair}
    right = sum(count for (true, told), count in found.items() if true == told)
    missed = sum(count for (_, told), count in counts.items() if told == NOTHING)
    false = sum(count for (true, _), count in counts.items() if true == NOTHING)
    said = f"The mode is right in {right:,} of the {counted(sum(found.values()), 'true touchdown')} that were found."
    rest = [f"{missed:,} missed" if missed else "", counted(false, "false alarm") if false else ""]
    return f"{said} Besides: {', '.join(filter(None, rest))}." if any(rest) else said


def _confusion(counts: Counter[tuple[str, str]]) -> PageTable:
    """A row for each true mode, a column for each predicted one; what is right is marked."""
    order = [*(mode.name for mode in MODES), NOTHING]
    true = [mode for mode in order if any(pair[0] == mode for pair in counts)]
    told = [mode for mode in order if any(pair[1] == mode for pair in counts)]

    def cell(row: str, column: str) -> Cell:
        number = counts[row, column]
        return Cell(f"{number:,}" if number else "–", css="best" if row == column else "" if number else "none")

    rows: list[list[Cell | str]]
    rows = [["false alarm" if row == NOTHING else row, *(cell(row, column) for column in told)] for row in true]
    caption = "How many touchdowns of each true mode (a row) were predicted in which mode (a column)."
    return PageTable(["true mode", *("missed" if mode == NOTHING else mode for mode in told)], rows, caption)


def _landing_modes(landings: Sequence[Answer]) -> PageTable:
    """How many landings of each foot were predicted in which mode."""
    counts = Counter((one["foot"], one["landing_mode"]) for one in landings if one["landing_mode"])
    told = in_order(mode for _, mode in counts)
    rows = [[foot, *(f"{counts[foot, mode]:,}" for mode in told)] for foot in dict.fromkeys(foot for foot, _ in counts)]
    return PageTable(["foot", *told], rows, "Landings of each foot by the mode that its impact is predicted to have.")


def ahead(answers: Sequence[Answer]) -> Section | None:
    """Errors over the time ahead at which a prediction is made; None where there are none."""
    charts = []
    said = ["Every sample before a touchdown makes a prediction of it. Does one that is made earlier do as well?"]
    for key, title, axis, factor in (
        ("relative_errors_ahead", "Velocities after the impact", "relative error, %", 100.0),
        ("time_errors_ahead", "Time of the touchdown", "error of the time, ms", 1e3),
    ):
        spans = [one for one in errors_ahead(answers, key) if one.errors.number]
        if spans:
            number = sum(one.errors.number for one in spans)
            caption = f"All {counted(number, 'prediction')}, by how long before the touchdown they were made."
            charts.append(Chart(title, _over_lead_time(spans, axis, factor), caption, wide=False))
            if factor == 100.0 and measured_and_true(answers) is not None:
                said.append("The errors of the velocities are against the measured ones, which are not the true ones.")
    return Section("ahead", "Error against the time ahead", said, charts) if charts else None


def _over_lead_time(spans: Sequence[SpanErrors], axis: str, factor: float) -> PlotlyFigure:
    traces = []
    for number, (name, part) in enumerate((("median", "p50"), ("90 % below", "p90"))):
        traces.append(
            {
                "type": "scatter",
                "mode": "lines+markers",
                "name": name,
                "x": [500.0 * (one.begin + one.end) for one in spans],
                "y": [factor * getattr(one.errors, part) for one in spans],
                "text": [f"{1e3 * one.begin:.0f} to {1e3 * one.end:.0f} ms ahead<br>{name}" for one in spans],
                "customdata": [one.errors.number for one in spans],
                "hovertemplate": f"%{{text}}: %{{y:.3g}} ({axis})<br>%{{customdata:,}} predictions<extra></extra>",
                "line": {"color": PALETTE[number]},
                "marker": {"symbol": ("circle", "square")[number], "size": 8},
            }
        )
    return plot(
        traces,
        height=320,
        margin={"l": 64, "r": 16, "t": 40, "b": 48},
        xaxis={"title": {"text": "made before the touchdown, ms"}, "range": [0.0, 1e3 * spans[-1].end]},
        yaxis={"title": {"text": axis}, "rangemode": "tozero"},
    )


def cost(answers: Sequence[Answer]) -> Section | None:
    """What the answer to a sample costs; None where nothing is known of it."""
    spread = costs(answers)
    if spread.p50 is None:
        return None
    said = (
        "The time from a sample to its prediction, as this machine took it: without reading the bag and writing "
        "messages, which a node does besides. A sample that shows no touchdown ahead takes the least."
    )
    known = {"median": spread.p50, "90 % below": spread.p90, "99 % below": spread.p99, "longest": spread.most}
    cells = [time_words(None if one is None else 1e-6 * one) for one in known.values()]
    table = PageTable(["", *known], [[counted(spread.number, "sample"), *cells]])
    # Ten bars for each factor of ten.
    width = PER_DECADE // 10
    bars: Counter[int] = Counter()
    for place, count in spread.bins.items():
        bars[place // width] += count
    trace = {
        "type": "bar",
        "x": [0.1 * (place + 0.5) for place in sorted(bars)],
        "y": [bars[place] for place in sorted(bars)],
        "width": 0.09,
        "text": [
            f"{time_words(10.0 ** (0.1 * place - 6))} to {time_words(10.0 ** (0.1 * place - 5.9))}"
            for place in sorted(bars)
        ],
        "textposition": "none",
        "hovertemplate": "%{text}: %{y:,} samples<extra></extra>",
        "marker": {"color": PALETTE[0]},
    }
    marks = [(log10(max(value or 0.0, LEAST)), name) for name, value in known.items() if name != "longest"]
    decades = range(min(bars) // 10, max(bars) // 10 + 2)
    figure = plot(
        [trace],
        height=300,
        margin={"l": 64, "r": 16, "t": 64, "b": 48},
        xaxis={
            "title": {"text": "time for a sample"},
            "tickvals": list(decades),
            "ticktext": [time_words(10.0 ** (decade - 6)) for decade in decades],
        },
        yaxis={"title": {"text": "samples"}},
        shapes=[
            {"type": "line", "x0": x, "x1": x, "yref": "paper", "y0": 0, "y1": 1 + 0.08 * k, "line": {"color": GREY}}
            for k, (x, _) in enumerate(marks)
        ],
        annotations=[
            {
                "x": x,
                "yref": "paper",
                "y": 1 + 0.08 * k,
                "text": name,
                "showarrow": False,
                "xanchor": "left",
                "yanchor": "bottom",
            }
            for k, (x, name) in enumerate(marks)
        ],
    )
    chart = Chart("Time for a sample", figure, "How many samples took how long.")
    return Section("cost", "What a sample costs", [said], [table, chart])


KINDS: Final = {"error": "unreadable", "unpredictable": "nothing predicted", "damaged": "damaged", "notes": "note"}
"""The kinds of remarks, by their keys in the answers; the gravest first."""


def unused(answers: Sequence[Answer]) -> Section:
    """What could not be used: refused messages, touchdowns that are not compared, damage, failures and notes."""
    lost, reasons = refused(answers), uncompared(answers)
    samples = sum(answer["samples"] for answer in used(answers))
    said = f"Of {counted(samples, 'sample')} none was refused, nor any other message."
    if lost:
        said = f"{counted(sum(one.number for one in lost), 'message')} could not be used."
    if damaged := sum("damaged" in answer for answer in answers):
        said += f" {counted(damaged, 'bag')} could be read in part only: what was lost stands below."
    else:
        said += " No bag was damaged." if len(answers) > 1 else " The bag was not damaged."
    tables = []
    if lost:
        rows: list[list[Cell | str]] = [
            [
                Cell(one.input, words(one.status)),
                REMEDIES[Status[one.status]] if one.status in Status.__members__ else "",
                Cell(f"{one.number:,}", f"of {one.all:,}, {part_words(one.number / one.all)}"),
            ]
            for one in lost
        ]
        caption = "Messages that were refused, by input and reason."
        tables.append(PageTable(["input", "what is wrong", "messages"], rows, caption, 2))
    if reasons:
        several = "; some have several reasons" if len(reasons) > 1 else ""
        caption = f"Why touchdowns are not compared with what was measured{several}."
        rows = [[WHY[flag], f"{number:,}"] for flag, number in reasons.most_common()]
        tables.append(PageTable(["reason", "touchdowns"], rows, caption))
    return Section("unused", "What could not be used", [said], [*tables, *_remarks(answers)])


def _remarks(answers: Sequence[Answer]) -> list[PageTable]:
    """Damage, failures and notes, each with the bags that it was said of."""
    of: dict[tuple[str, str], list[str]] = {}
    for name, answer in zip(names_of(answers), answers, strict=True):
        for kind in ("error", "unpredictable", "damaged"):
            if answer.get(kind):
                of.setdefault((kind, answer[kind]), []).append(name)
        for note in answer.get("notes", ()):
            of.setdefault(("notes", without_bag(note, answer["bag"])), []).append(name)
    ordered = sorted(of.items(), key=lambda one: (list(KINDS).index(one[0][0]), -len(one[1])))
    rows: list[list[Cell | str]] = []
    for (kind, said), names in ordered[:ROWS]:
        more = f" and {counted(len(names) - 1, 'more bag')}" if len(names) > 1 else ""
        rows.append([Cell(names[0] + more, KINDS[kind]), said])
    caption = f"What was said of the bags, the first {ROWS} of {len(ordered):,}." if len(ordered) > ROWS else ""
    return [PageTable(["bag", "remark"], rows, caption or "What was said of the bags.", 2)] if rows else []


def scene(values: Mapping[str, Any] | None) -> Section | None:
    """What the scene has and leaves out, from all its parameters; None where these are not known."""
    if values is None:
        return None
    # The events executor is the node's.
    features = [feature for feature in features_of(values) if feature.name != "events executor"]
    rows: list[list[Cell | str]] = []
    for one in sorted(features, key=lambda feature: not feature.on):
        css = "" if one.on else "none"
        rows.append([Cell(one.name, "" if one.on else "left out", css), Cell(one.why, css=css)])
    left_out = sum(not feature.on for feature in features)
    said = (
        f"The predictor took in {len(features) - left_out} of its parts for this scene and left out {left_out}, in "
        "grey. What is left out costs nothing; where a body needs it, the parameter that is named switches it on."
    )
    return Section("scene", "What the scene left out", [said], [PageTable(["part", "why"], rows, "", 2)])
