"""The timeline of a bag: a lane for what was predicted of each body or foot, above what came."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot
from typing import Any, Final, NamedTuple

from ...mechanics.types import Mode
from ...stamps import NANOSECONDS
from ...wording import words
from ..modes import EDGE, MODES
from ..touchdowns import TouchdownRow, row_of_json
from . import GREY, Chart, bars, marks, part_words, safe, time_words
from .facts import BagAnswer

MISSED: Final = "missed"
"""The mark of a true touchdown that no prediction announced."""

FALSE: Final = "false alarm"
"""The mark of an announcement of a touchdown that never came."""

ORDER: Final = [*(mode.name for mode in MODES), MISSED, FALSE]
"""The marks in the order in which they are drawn and listed."""

RED: Final = "#d02a3d"
BLUE: Final = "#3d7fc4"

MANY: Final = 1000
"""Points above which the graphics card draws them; a browser draws few without one."""


class TimelineMark(NamedTuple):
    """A mark at a stamp (ns): a mode, `MISSED` or `FALSE`; faint where it does not count.

    `said` is what a reader sees who points at it, after the time; a line leads back to the announcement, `ahead` s.
    """

    stamp: int
    mark: str
    said: str
    ahead: float = 0.0
    faint: bool = False


class Lane(NamedTuple):
    """A line of a timeline: marks, or stances as (begin, end) in ns."""

    name: str
    marks: Sequence[TimelineMark] = ()
    stances: Sequence[tuple[int, int]] = ()
    colour: str = BLUE


def timeline(title: str, answer: BagAnswer, anchor: str) -> Chart:
    lanes = [lane for body in answer.get("gaits", {}) for lane in _feet(answer, body)]
    both = [*answer["touchdowns"], *answer.get("true_touchdowns", ())]
    for body in dict.fromkeys(one["body"] for one in both if "foot" not in one):
        lanes += _body(answer, body)
    begin, traces = answer["begin"], list[dict[str, Any]]()
    # What is faint lies below what counts; the opacity is that of a trace: faint marks on each other are no darker.
    drawn: dict[tuple[bool, int], list[tuple[int, TimelineMark]]] = {}
    for row, lane in enumerate(lanes):
        for mark in lane.marks:
            drawn.setdefault((not mark.faint, ORDER.index(mark.mark)), []).append((-row, mark))
        if lane.stances:
            spans = [((first - begin) / NANOSECONDS, (last - begin) / NANOSECONDS) for first, last in lane.stances]
            traces.append(bars(lane.name, spans, -row, lane.colour, width=0.5, showlegend=False))
    kind = "scattergl" if sum(map(len, drawn.values())) > MANY else "scatter"
    for (counts, place), there in sorted(drawn.items()):
        name, x = ORDER[place], [(mark.stamp - begin) / NANOSECONDS for _, mark in there]
        points = [(at, row, f"{at:.3f} s: {mark.said}") for at, (row, mark) in zip(x, there, strict=True)]
        look = {"type": kind, "marker": look_of(name), "opacity": 1.0 if counts else 0.3}
        ahead = {"type": "data", "symmetric": False, "array": [0.0], "arrayminus": [mark.ahead for _, mark in there]}
        look["error_x"] = {**ahead, "width": 0, "thickness": 1.5, "color": GREY}
        traces.append(marks(name if counts else f"{name}, faint", points, **look))
    end = (answer["end"] - begin) / NANOSECONDS
    lane_axis = {"tickvals": [-row for row in range(len(lanes))], "ticktext": [safe(lane.name) for lane in lanes]}
    lane_axis |= {"range": [0.6 - len(lanes), 0.6], "automargin": True, "fixedrange": True, "showgrid": False}
    layout = {
        "height": 120 + 28 * len(lanes),
        "margin": {"l": 16, "r": 16, "t": 40, "b": 48},
        "xaxis": {"title": "time in the record, s", "range": [-0.01 * end, 1.01 * end]},
        "yaxis": lane_axis,
        "barmode": "overlay",
        "showlegend": True,
    }
    return Chart(title, traces, layout, anchor=anchor)


def look_of(mark: str) -> dict[str, Any]:
    """How a mark is drawn: a mode as everywhere, what is missed or false in red."""
    edge = {"color": EDGE, "width": 0.7}
    if mark not in Mode.__members__:
        return {"color": RED, "symbol": "star" if mark == MISSED else "x", "line": edge, "size": 12}
    look = MODES[Mode[mark]]
    return {"color": look.colour, "symbol": look.symbol, "line": edge, "size": 10}


def _feet(answer: BagAnswer, body: str) -> Iterable[Lane]:
    """The feet of a machine: when each landing was predicted, and when the foot stands."""
    gait, several = answer["gaits"][body], len(answer["gaits"]) > 1
    landings = [one for one in answer["touchdowns"] if "foot" in one and (not several or one["body"] == body)]
    for number, foot in enumerate(gait["feet"]):
        name = f"{body}/{foot}" if several else foot
        yield Lane(f"{name} predicted", [_landing(one) for one in landings if one["foot"] == foot])
        for kind, key, colour in (("stands", "stances", BLUE), ("truth", "true_stances", GREY)):
            if stances := gait[key]:
                mine = [(begin, end) for place, begin, end in stances if place == number]
                yield Lane(kind, stances=mine, colour=colour)


def _landing(one: BagAnswer) -> TimelineMark:
    """A landing where it was predicted last; one that was not announced where it came, as missed."""
    said = ", ".join(filter(None, (one["foot"], one["point"])))
    if one["landing_speed"] is not None:
        said += f" lands with {one['landing_speed']:.3f} m/s"
    bound = f" ({one['bound']})" if one.get("bound") else ""
    for key, where in (("impulse", ""), ("others_impulse", " at other feet")):
        if one.get(key):
            said += f"\nimpulse {hypot(*one[key]):.2f} N s{where}{bound}"
    if one["late"] is not None:
        said += f"\n{1e3 * one['late']:+.1f} ms after the plan"
    if one["time_error"] is None:
        return TimelineMark(one["stamp"], MISSED, f"{said}\nnot announced")
    mode, ahead, error = one["landing_mode"] or one["mode"], one["announced_lead_time"], one["time_error"]
    said += f"\n{mode}\n{_announced(ahead, error)}"
    return TimelineMark(one["stamp"] + round(error * NANOSECONDS), mode, said, ahead + error)


def _announced(ahead: float, error: float) -> str:
    return f"announced {time_words(ahead)} ahead, the last predicted time {1e3 * error:+.1f} ms off"


def _body(answer: BagAnswer, body: str) -> Iterable[Lane]:
    """A body: its predicted touchdowns, and the true ones where they are known, or those that cannot be compared."""
    true = [one for one in answer.get("true_touchdowns", ()) if one["body"] == body]
    mine = [one for one in answer["touchdowns"] if one["body"] == body and "foot" not in one]
    if true:
        yield Lane(f"{body} predicted", [_predicted(one) for one in true if one["predicted_stamp"] is not None])
        yield Lane("true", [_true(one) for one in true if one["stamp"] is not None])
        return
    rows = [*map(row_of_json, mine)]
    yield Lane(f"{body} predicted", [_touchdown(row) for row in rows if row.is_scored])
    if not all(row.is_scored for row in rows):
        yield Lane("not compared", [_touchdown(row) for row in rows if not row.is_scored])


def _touchdown(row: TouchdownRow) -> TimelineMark:
    """A touchdown that was predicted and came; faint where nothing measured can be compared with it."""
    ahead, compared = row.announced_lead_time, f"relative error {part_words(row.best_error)}"
    if not row.is_scored:
        compared = f"not compared: {', '.join(map(words, row.why_not_scored))}"
    said = f"{row.mode.name}\nannounced {time_words(ahead)} ahead\n{compared}"
    return TimelineMark(row.stamp, row.mode.name, said, ahead, not row.is_scored)


def _predicted(one: BagAnswer) -> TimelineMark:
    """What was announced: of a true touchdown, or in vain."""
    mode, stamp = one["predicted_mode"] or Mode.NO_IMPACT.name, one["predicted_stamp"]
    shown = (stamp - one["first_seen"]) / NANOSECONDS
    if one["stamp"] is None:
        return TimelineMark(stamp, FALSE, f"{FALSE}, {mode} was predicted", shown)
    said = _announced((one["stamp"] - one["first_seen"]) / NANOSECONDS, (stamp - one["stamp"]) / NANOSECONDS)
    if one["velocity_error"] is not None:
        said += f"\nrelative error {part_words(one['velocity_error'])}"
    return TimelineMark(stamp, mode, f"{mode}\n{said}", shown, not one["shown"])


def _true(one: BagAnswer) -> TimelineMark:
    """What happened; faint what such a record cannot show."""
    mode = one["mode"] or Mode.NO_IMPACT.name
    if one["shown"] and one["predicted_stamp"] is None:
        return TimelineMark(one["stamp"], MISSED, f"{mode}\nmissed: no prediction announced it")
    said = mode if one["shown"] else f"{mode}\nwhich cannot be seen at this rate of samples"
    return TimelineMark(one["stamp"], mode, said, faint=not one["shown"])
