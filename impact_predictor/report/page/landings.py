"""The landings of machines that walk: how wrong their times were announced, how fast feet came down, how hard."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Any, Final

from ...scenarios.matching import LEAD_TIMES
from ...stamps import NANOSECONDS
from ..modes import PALETTE
from ..touchdowns import TouchdownRow, row_of_json
from . import Chart, marks
from .facts import BagAnswer

AHEAD: Final = LEAD_TIMES[-1]
"""Seconds before a landing at which the prediction is made that is shown."""

PANELS: Final = ("y", "y2", "y3")


def landings(name: str, answer: BagAnswer) -> list[Chart]:
    """A chart for each machine of a bag."""
    rows = [
        row_of_json(one)._replace(time_errors=tuple(one.get("time_errors", ())))
        for one in answer.get("touchdowns", ())
        if one.get("foot")
    ]
    # What follows of a foot that stands already is no landing of its own.
    rows = [row for row in rows if not row.is_second]
    found = []
    for body in answer.get("gaits", {}):
        mine = [row for row in rows if row.body == (body or row.body)]
        if mine:
            of = f" of {f'{name} {body}'.strip()}" if name or body else ""
            found.append(landings_chart(f"The landings{of}", answer, body, mine))
    return found


def landings_chart(title: str, answer: BagAnswer, body: str, rows: Sequence[TouchdownRow]) -> Chart:
    """The errors of the times, the speeds of the feet and their impulses, one panel below the other."""
    gait, start = answer["gaits"][body], answer["begin"]
    traces: list[dict[str, Any]] = []
    for number, foot in enumerate(gait["feet"]):
        begun = [begin for place, begin, _ in gait["true_stances"] if place == number and begin > start]
        told: tuple[list[tuple[float, float, str]], ...] = [], [], []
        for row in rows:
            if row.foot != foot:
                continue
            at = (row.stamp - start) / NANOSECONDS
            if row.time_errors and (error := row.time_errors[-1]) is not None:
                predicted = row.stamp + round(error * NANOSECONDS)
                late = (predicted - min(begun, key=lambda one: abs(one - predicted), default=row.stamp)) / NANOSECONDS
                told[0].append((at, 1e3 * late, f"{foot}, {at:.3f} s: {1e3 * late:+.1f} ms"))
            if row.landing_speed is not None:
                told[1].append((at, row.landing_speed, f"{foot}, {at:.3f} s: {row.landing_speed:.3f} m/s"))
            if row.impulse:
                told[2].append((at, hypot(*row.impulse), f"{foot}, {at:.3f} s: {hypot(*row.impulse):.2f} N s"))
        for panel, points in zip(PANELS, told, strict=True):
            if points:
                shown = foot not in {trace["name"] for trace in traces}
                look = {"legendgroup": foot, "showlegend": shown, "yaxis": panel}
                traces.append(stems(foot, points, PALETTE[number % len(PALETTE)], **look))
    what = "true" if gait["true_stances"] else "inferred"
    bounds = ", ".join(sorted({row.bound for row in rows if row.bound}))
    titles = f"time, {1e3 * AHEAD:.0f} ms<br>ahead, ms", "speed, m/s", "impulse, N s"
    layout: dict[str, Any] = {"height": 460, "showlegend": True}
    end = (answer["end"] - start) / NANOSECONDS
    layout["xaxis"] = {"title": "time in the record, s", "anchor": "y3", "range": [-0.01 * end, 1.01 * end]}
    for panel, text, low in zip(PANELS, titles, (0.7, 0.35, 0.0), strict=True):
        layout[panel.replace("y", "yaxis")] = {"title": text, "domain": [low, low + 0.3]}
    caption = (
        f"The predicted less the {what} time of each landing, as predicted {1e3 * AHEAD:.0f} ms before; the speed of "
        "the foot in its last sample in the air; and the impulse that it gets where it lands with that speed"
    )
    return Chart(title, traces, layout, f"{caption} ({bounds})." if bounds else f"{caption}.")


def stems(name: str, points: Sequence[tuple[float, float, str]], colour: str, **look: Any) -> dict[str, Any]:
    """Marks, each on a line from 0."""
    down = {"array": [0.0] * len(points), "arrayminus": [value for _, value, _ in points], "symmetric": False}
    line = {"type": "data", "color": colour, "thickness": 1.0, "width": 0}
    return marks(name, points, marker={"color": colour, "size": 7}, error_y=down | line, **look)
