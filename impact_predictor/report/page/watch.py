"""What a page says of the watch over a deck: motion and forecast, margins and levels, warnings and statistics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import degrees
from statistics import median
from typing import Any, Final

from ...bags.watched import FORECAST
from ...prediction.deck.forecast import ANGLES, ForecastStatus
from ...stamps import NANOSECONDS
from ...wording import NONE, counted, fixed, words
from ..modes import EDGE, LEVELS, PALETTE
from ..watch import under_warning
from . import Cell, Chart, PageTable, Section, bars, marks, part_words, safe
from .facts import BagAnswer

SHOWN: Final = 6
"""Units whose margins are drawn; of more those that came nearest to an onset."""
LEAD: Final = 5.0
"""Seconds ahead of the forecast that is shown unless another one is asked for."""
HIGH: Final = 1.5
"""Parts of the margin up to which it is drawn."""

READING: Final = (
    "Above stand the angles of the deck and what is felt on it; the band, of the angle that changes more, is where "
    "nine tenths of what came should lie, as forecast so long before. Below, for each unit, a ribbon of its levels, "
    "and the part that is used of its "
    "margins: at 1 it slides or tips. A triangle is an event, with how long a warning had stood, a stroke below "
    "it a predicted touchdown. Click the name of a forecast to see it, drag over a part of the time to magnify it, "
    "double-click to see all of it."
)
TRUE: Final = "An event is a slide, lift or impact after 5 s without one, as the bag tells it."
SEEN: Final = "The bag tells of no events: one is taken where a margin is used up after 5 s in which none was."
NEAR: Final = "How near each unit came to an onset, and how long in s a warning, and ERROR, had stood at its events."
VAIN: Final = (
    "A warning, WARN or ERROR, is vain if no event begins in it. Of events at any time a warning would meet the part "
    "of the time that it stands: a warning that always stands meets all."
)
ERRS: Final = (
    "Root mean squares of the errors of the forecasts of the deck, angles in degrees and what is felt in m/s², beside "
    "those of what was so when it was forecast and of the mean of the record."
)
LAST: Final = "Statistics, as the watch reported them last; an hour is one in which the sea stays as it is."
ACROSS: Final = 8
"""Units that stand beside each other in a table."""
OF_NOW: Final = frozenset(
    (
        "slide_ratio",
        "tip_ratio",
        "time_to_tip",
        "time_to_slide",
        "onset_probability",
        "energy_to_topple",
        "tilt",
        "edge",
        "status",
    )
)
"""What a report says of its moment alone."""
RIBBON: Final = {"showticklabels": False, "showgrid": False, "fixedrange": True, "range": [-0.5, 0.5]}
SAID: Final = {"roll": "roll, port up", "pitch": "pitch, bow down"}
FELT: Final = FORECAST[len(ANGLES) :]


def watched(names: Sequence[str], answers: Sequence[BagAnswer], most: int) -> Section:
    """The watch of each bag that has one, the charts of `most` of them."""
    known = [(name, answer) for name, answer in zip(names, answers, strict=True) if answer.get("watch")]
    charts = [chart_of(f"The watch over {name}", answer) for name, answer in known[:most] if answer["watch"]["stamps"]]
    truths = {answer["watch"]["knows_events"] for _, answer in known}
    said = [READING, *(text for truth, text in ((True, TRUE), (False, SEEN)) if truth in truths), VAIN]
    rows = [
        unit_row(f"{bag}, {unit}" if len(known) > 1 else unit or "the unit", one)
        for bag, answer in known
        for unit, one in answer["watch"]["units"].items()
    ]
    head = ["unit", "most used: slide", "tip", "events", "warned of", "warning stood, s", "ERROR stood, s"]
    tables = [PageTable([*head, "warnings", "vain", "time under warning"], rows, NEAR)]
    tables += statistics(known)
    tables += [skill_table(answer["watch"]["skill"], name if len(known) > 1 else "") for name, answer in known[:most]]
    return Section("watch", "The watch over the deck", said, [*charts, *[one for one in tables if one.rows]])


def unit_row(name: str, unit: Mapping[str, Any]) -> list[Cell | str]:
    """How near a unit came to an onset, and how it was warned of."""
    events, warnings = unit["events"], unit["warnings"]
    leads = [[one[key] for one in events if one[key] is not None] for key in ("warned_ahead", "error_ahead")]
    stood = [Cell(fixed(median(of), 1), f"at least {min(of):.1f}") if of else NONE for of in leads]
    used = [f"{most:.2f}" if most < 10.0 else "above 10" for most in unit["most"].values()]
    numbers = [f"{number:,}" for number in (len(warnings), sum(one["vain"] for one in warnings))]
    return [name, *used, f"{len(events):,}", f"{len(leads[0]):,}", *stood, *numbers, part_words(under_warning([unit]))]


def statistics(known: Sequence[tuple[str, BagAnswer]]) -> list[PageTable]:
    """What the watch reported last of each unit, as numbers: a column for each, as statistics are more than units."""
    units = [(bag, *one) for bag, answer in known for one in answer["watch"]["units"].items()]
    told = dict.fromkeys(key for *_, unit in units for key in unit["reported"])
    keys = [key for key in told if key not in OF_NOW and not key.startswith("felt")]
    tables = []
    for some in (units[place : place + ACROSS] for place in range(0, len(units) if keys else 0, ACROSS)):
        head = [f"{bag}, {name}" if len(known) > 1 else name or "the unit" for bag, name, _ in some]
        rows = [[words(key), *(_told(unit["reported"].get(key)) for *_, unit in some)] for key in keys]
        tables.append(PageTable(["of", *head], rows, LAST))
    return tables


def _told(value: float | str | None) -> str:
    return NONE if value is None else value if isinstance(value, str) else f"{value:.3g}"


def skill_table(skill: Iterable[Mapping[str, Any]], name: str) -> PageTable:
    """The errors of forecasts beside those of simple answers; only what the deck feels at all."""
    rows = [
        [
            f"{one['of']}, {one['lead']:g} s ahead",
            *(f"{_scale(one['of']) * one[key]:.3f}" for key in ("forecast", "now", "mean")),
            part_words(one["within"]),
            f"{one['count']:,}",
        ]
        for one in skill
        if _scale(one["of"]) * one["mean"] > 1e-3
    ]
    head = ["of", "forecast", "as when forecast", "the mean", "within the band of 90 %", "forecasts"]
    return PageTable(head, rows, f"{name}: {ERRS}" if name else ERRS)


def _scale(name: str) -> float:
    return degrees(1.0) if name in ANGLES else 1.0


def chart_of(title: str, answer: BagAnswer) -> Chart:
    """The deck, its forecast, and the levels and margins of its units over time, on one axis of time."""
    watch, traces = answer["watch"], list[dict[str, Any]]()
    stamps, units, deck = watch["stamps"], watch["units"], watch["deck"]
    start = stamps[0] if answer.get("begin") is None else min(stamps[0], answer["begin"])
    times = [(stamp - start) / NANOSECONDS for stamp in stamps]
    shown = sorted(units, key=lambda name: (-len(units[name]["events"]), -max(units[name]["most"].values())))[:SHOWN]
    felt = [name for name in FELT if _swing(deck[name]) > 0.1 * max(_swing(deck[of]) for of in FELT)]
    # Panels from above: the title of each, its height, and what else its axis has.
    panels: list[tuple[str, float, dict[str, Any]]] = [("angle, °", 1.2, {})]
    traces += _forecasts(watch["forecasts"], max(ANGLES, key=lambda name: _swing(deck[name])), start, 1)
    for (name, said), colour in zip(SAID.items(), PALETTE[1:], strict=False):
        turned = [None if one is None else degrees(one) for one in deck[name]]
        traces.append(_line(said, times, turned, 1, colour))
    for name in felt:
        panels.append((f"felt {name}, m/s²", 1.6, {}))
        traces += _forecasts(watch["forecasts"], name, start, len(panels))
        traces.append(_line(f"felt {name}", times, deck[name], len(panels), EDGE))
    for name in shown:
        panels += [("", 0.16, RIBBON), (safe(name) or "margin used", 1.2, {"range": [0.0, HIGH], "fixedrange": True})]
        traces += _unit_traces(units[name], times, start, len(panels))
        struck = [one for one in answer["touchdowns"] if one["body"] == name or not name]
        points = [((one["stamp"] - start) / NANOSECONDS, 0.07, f"touchdown, {one['mode']}") for one in struck]
        if points:
            look = {"symbol": "line-ns-open", "size": 9, "color": EDGE}
            traces.append(marks("touchdown", points, marker=look, yaxis=f"y{len(panels)}"))
    # Each name stands in the legend once.
    met = set[str]()
    for trace in traces:
        trace["showlegend"] = trace.get("showlegend", True) and trace["name"] not in met
        met.add(trace["name"])
    gaps = [0.02 if text else 0.005 for text, _, _ in panels]
    heights = [high for _, high, _ in panels]
    top, unit = 1.0, (1.0 - sum(gaps[:-1])) / sum(heights)
    across = {"title": "time in the record, s", "range": [0.0, max(1.0, times[-1])], "anchor": f"y{len(panels)}"}
    layout = {"height": round(150 + 105 * sum(heights)), "barmode": "overlay", "showlegend": True, "xaxis": across}
    for place, ((text, high, more), gap) in enumerate(zip(panels, gaps, strict=True), 1):
        domain = [max(0.0, top - high * unit), top]
        layout[f"yaxis{place if place > 1 else ''}"] = {"title": text, "domain": domain, **more}
        top -= high * unit + gap
    left, tracked = len(units) - len(shown), watch["tracked"]
    caption = f"Of {counted(left, 'more unit')}, which came less near to an onset, the table tells. " if left else ""
    if "forecast" in tracked:
        caption += f"The forecast at the end: {ForecastStatus[tracked['forecast']].value}. "
    if "window.linear" in tracked:
        spans = f"{tracked['window.linear']:g} s and {tracked['window.angular']:g} s"
        caption += f"Linear and angular accelerations are found over {spans}."
    return Chart(title, traces, layout, caption)


def _unit_traces(unit: Mapping[str, Any], times: Sequence[float], start: int, place: int) -> list[dict[str, Any]]:
    """The ribbon of the levels of a unit above its margins, with its events."""
    traces: list[dict[str, Any]] = []
    for level, colour in LEVELS.items():
        spans = [
            ((one - start) / NANOSECONDS, (other - start) / NANOSECONDS)
            for of, one, other in unit["levels"]
            if of == level
        ]
        if spans:
            traces.append(bars(level, spans, 0.0, colour, width=1.0, yaxis=f"y{place - 1}"))
    full = _line("", [times[0], times[-1]], [1.0, 1.0], place, LEVELS["ERROR"], hoverinfo="skip", showlegend=False)
    filled = {"fill": "tozeroy", "fillcolor": f"{PALETTE[1]}40"}
    traces += [
        _line("margin used against tipping", times, unit["tip"], place, PALETTE[1], **filled),
        _line("margin used against sliding", times, unit["slide"], place, PALETTE[0]),
        _line("probability of an onset", times, unit["probability"], place, PALETTE[2], dash="dot"),
        full,
    ]
    events = []
    for one in unit["events"]:
        at, ahead = (one["stamp"] - start) / NANOSECONDS, one["warned_ahead"]
        said = "not warned of" if ahead is None else f"a warning had stood {ahead:.1f} s"
        events.append((at, 1.0, f"{at:.1f} s: {one['what']}\n{said}"))
    look = {"symbol": "triangle-down", "size": 11, "color": EDGE}
    return [*traces, marks("event", events, marker=look, yaxis=f"y{place}")] if events else traces


def _forecasts(told: Mapping[str, Any], name: str, start: int, place: int) -> list[dict[str, Any]]:
    """The bands of the forecasts of a number of the deck, drawn at the times for which they were made."""
    traces = []
    for lead, courses in zip(told["leads"], told[name], strict=True):
        low, middle, high = ([_scale(name) * one for one in each] for each in courses)
        at = [(made - start) / NANOSECONDS + lead for made in told["made"]]
        said = f"forecast {lead:g} s before"
        group = {"legendgroup": said, "visible": True if lead == LEAD else "legendonly"}
        edge: dict[str, Any] = {**group, "hoverinfo": "skip", "showlegend": False, "line": {"width": 0}}
        traces += [
            _line("", at, low, place, "", **edge),
            _line("", at, high, place, "", **edge, fill="tonexty", fillcolor=f"{PALETTE[4]}50"),
            _line(said, at, middle, place, PALETTE[0], dash="dash", **group),
        ]
    return traces


def _line(
    name: str,
    times: Sequence[float],
    values: Sequence[float | None],
    place: int,
    colour: str,
    dash: str = "solid",
    **look: Any,
) -> dict[str, Any]:
    line = {"type": "scatter", "mode": "lines", "name": name, "x": times, "y": values, "yaxis": f"y{place}"}
    drawn = {"line": {"color": colour, "width": 1.3, "dash": dash}, "hovertemplate": "%{x:.1f} s: %{y:.3g}"}
    return line | drawn | look


def _swing(values: Iterable[float | None]) -> float:
    known = [one for one in values if one is not None]
    return max(known, default=0.0) - min(known, default=0.0)
