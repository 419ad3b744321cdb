"""The sections of the page of a replay: each function gives a heading, sentences, and tables or charts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from math import hypot
from statistics import median
from typing import TYPE_CHECKING, Any, Final

from ...mechanics.types import Mode
from ...prediction.checks import REMEDIES
from ...prediction.features import features_of
from ...prediction.types import Status
from ...stamps import NANOSECONDS
from ...wording import counted, words
from ..modes import MODES, PALETTE
from ..summary import PER_DECADE, WHY, SpanErrors, without_bag
from . import found
from .document import (
    Cell,
    Chart,
    PageTable,
    Section,
    bars,
    marks,
    part_words,
    plot,
    signed_ms,
    time_words,
    titled,
)
from .found import BagAnswer
from .timeline import in_order, lanes_of, timeline

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as PlotlyFigure

LISTED: Final = 30
"""Bags that are listed; of more the worst."""

DRAWN: Final = 8
"""Bags of which a timeline is drawn; of more the worst."""

ROWS: Final = 100
"""Landings or remarks in a table."""


def bags(answers: Sequence[BagAnswer], links: Mapping[int, str]) -> Section | None:
    """A row for each of several bags, and how their errors are spread; None where there is only one."""
    if len(answers) < 2:
        return None
    names, said = found.names_of(answers), []
    if len(answers) > LISTED:
        worst = "first those that could not be used, then by what was missed or announced in vain, then by the error"
        said = [f"The worst {LISTED} of {len(answers):,} bags: {worst}."]
    rows = []
    for place in found.worst_of(answers, range(len(answers)), LISTED):
        answer = answers[place]
        remark = (
            "could not be read" if "error" in answer else "nothing predicted" if answer.get("unpredictable") else ""
        )
        name = Cell(names[place], remark or ("damaged" if "damaged" in answer else ""), to=links.get(place, ""))
        rows.append([name, *(_of_bag(answer) if "error" not in answer else [""] * 6)])
    head = ["bag", "touchdowns", "found", "velocity error", "time error", "first ahead", "a sample"]
    kept = [k for k in range(len(head)) if any(row[k] not in ("", "–") for row in rows)]
    table = PageTable([head[k] for k in kept], [[row[k] for k in kept] for row in rows])
    return Section("bags", "The bags", said, [table])


def _of_bag(answer: BagAnswer) -> list[Cell | str]:
    there, errors, times = found.found_of([answer]), found.velocity_errors([answer]), found.announced([answer])
    cost = found.costs([answer]).p50
    compared = f"90 % below {part_words(errors.p90)}, {errors.number:,} compared" if errors.number else ""
    alarms = counted(there.false, "false alarm") if there is not None and there.false else ""
    return [
        f"{len(answer['touchdowns']):,}",
        "–" if there is None else Cell(f"{there.found:,} of {there.there:,}", alarms),
        Cell(part_words(errors.p50), compared) if compared else "–",
        time_words(found.time_error(answer)),
        time_words(median(times) if times else None),
        time_words(None if cost is None else 1e-6 * cost),
    ]


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


def when(answers: Sequence[BagAnswer], places: Sequence[int]) -> Section | None:
    """The timelines of some bags, with the numbers of each; None where nothing was predicted."""
    if not places:
        return None
    names, said = found.names_of(answers), list[str]()
    parts: list[PageTable | Chart] = []
    drawn: set[str] = set()
    for place in places:
        answer = answers[place]
        feet, true = "gaits" in answer, "true_touchdowns" in answer
        said.append(FEET if feet else TRUE if true else MEASURED)
        figure, notes = timeline(answer)
        drawn |= {mark.mark for lane in lanes_of(answer) for mark in lane.marks}
        parts += [Chart(names[place], figure, " ".join(notes), anchor=f"bag-{place + 1}"), *_numbers(answer)]
    if len(places) == DRAWN < len(answers):
        said.insert(0, f"The timelines of the worst {DRAWN} of {len(answers):,} bags.")
    zoom = "Drag over a part of the time to magnify it, double-click to see all of it again; point at a mark for more."
    return Section("when", "When the touchdowns came", [*dict.fromkeys(said), zoom, meanings(drawn)], parts)


def meanings(marks: Iterable[str]) -> str:
    """What follows in each mode."""
    known = [name for name in in_order(marks) if name in Mode.__members__]
    return "Modes: " + "; ".join(f"{name}, {MODES[Mode[name]].meaning}" for name in known) + "."


def _numbers(answer: BagAnswer) -> list[PageTable]:
    """The landings of feet, or what was missed and announced in vain, as a table."""
    start = found.begin_of(answer)
    if landings := list(found.landings_of([answer])):
        rows = [_landing_cells(one, start) for one in landings[:ROWS]]
        head = ["time", "foot", "first ahead", "last predicted time", "speed", "impulse", "mode", "after the plan"]
        more = f"The first {ROWS} of {len(landings):,} landings." if len(landings) > ROWS else ""
        return [PageTable(head, rows, more, 2, "Landing by landing")]
    wrong = [
        one
        for one in found.true_touchdowns_of([answer])
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


def _landing_cells(one: BagAnswer, start: int) -> list[Cell | str]:
    impulse, others = one["impulse"], one.get("others_impulse")
    below = f"{hypot(*others):.2f} N s at other feet" if others else ""
    return [
        Cell(f"{(one['stamp'] - start) / NANOSECONDS:.3f} s", one["point"] or ""),
        one["foot"],
        time_words(one["announced_lead_time"]) if one["time_error"] is not None else "not announced",
        signed_ms(one["time_error"]),
        "–" if one["landing_speed"] is None else f"{one['landing_speed']:.3f} m/s",
        "–" if impulse is None else Cell(f"{hypot(*impulse):.2f} N s", below),
        one["landing_mode"] or "–",
        signed_ms(one["late"]),
    ]


def lead_times(answers: Sequence[BagAnswer]) -> Section | None:
    """Errors over the time ahead at which a prediction is made; None where there are none."""
    charts = []
    said = ["Every sample before a touchdown makes a prediction of it. Does one that is made earlier do as well?"]
    for key, title, axis, factor in (
        ("relative_errors_ahead", "Velocities after the impact", "relative error, %", 100.0),
        ("time_errors_ahead", "Time of the touchdown", "error of the time, ms", 1e3),
    ):
        spans = [one for one in found.errors_ahead(answers, key) if one.errors.number]
        if spans:
            number = sum(one.errors.number for one in spans)
            caption = f"All {counted(number, 'prediction')}, by how long before the touchdown they were made."
            charts.append(Chart(title, _over_lead_time(spans, axis, factor), caption, wide=False))
            if factor == 100.0 and found.measured_and_true(answers) is not None:
                said.append("The errors of the velocities are against the measured ones, which are not the true ones.")
    return Section("ahead", "Error against the time ahead", said, charts) if charts else None


def _over_lead_time(spans: Sequence[SpanErrors], axis: str, factor: float) -> PlotlyFigure:
    traces = []
    for number, (name, part) in enumerate((("median", "p50"), ("90 % below", "p90"))):
        points = []
        for one in spans:
            error = factor * getattr(one.errors, part)
            made = f"{1e3 * one.begin:.0f} to {1e3 * one.end:.0f} ms ahead, {counted(one.errors.number, 'prediction')}"
            points.append((500.0 * (one.begin + one.end), error, f"{made}\n{name} {error:.3g} ({axis})"))
        look = {"color": PALETTE[number], "symbol": ("circle", "square")[number], "size": 8}
        traces.append(marks(name, points, mode="lines+markers", marker=look, line={"color": PALETTE[number]}))
    across = titled("made before the touchdown, ms", range=[0.0, 1e3 * spans[-1].end])
    return plot(traces, 320, xaxis=across, yaxis=titled(axis, rangemode="tozero"))


def cost(answers: Sequence[BagAnswer]) -> Section | None:
    """What the answer to a sample costs; None where nothing is known of it."""
    spread = found.costs(answers)
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
    counts: Counter[int] = Counter()
    for place, count in spread.bins.items():
        counts[10 * place // PER_DECADE] += count
    spans = [(10.0 ** (0.1 * place), 10.0 ** (0.1 * (place + 1)), count) for place, count in sorted(counts.items())]
    points = [
        (0.5 * (begin + end), n, f"{time_words(1e-6 * begin)} to {time_words(1e-6 * end)}: {counted(n, 'sample')}")
        for begin, end, n in spans
    ]
    look = {"width": [0.9 * (end - begin) for begin, end, _ in spans], "marker": {"color": PALETTE[0]}}
    across = titled("time for a sample, us", type="log", dtick=1)
    figure = plot([bars(points, **look)], 300, xaxis=across, yaxis=titled("samples"))
    chart = Chart("Time for a sample", figure, "How many samples took how long.")
    return Section("cost", "What a sample costs", [said], [table, chart])


KINDS: Final = {"error": "unreadable", "unpredictable": "nothing predicted", "damaged": "damaged", "notes": "note"}
"""The kinds of remarks, by their keys in the answers; the gravest first."""


def unused(answers: Sequence[BagAnswer]) -> Section:
    """What could not be used: refused messages, touchdowns that are not compared, damage, failures and notes."""
    lost, reasons = found.refused(answers), found.uncompared(answers)
    samples = sum(answer["samples"] for answer in found.used(answers))
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


def _remarks(answers: Sequence[BagAnswer]) -> list[PageTable]:
    """Damage, failures and notes, each with the bags that it was said of."""
    of: dict[tuple[str, str], list[str]] = {}
    for name, answer in zip(found.names_of(answers), answers, strict=True):
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
