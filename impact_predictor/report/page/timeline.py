"""The timeline of a bag: a lane for what was predicted of each body or foot, above what came and how wrong it was."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from ...mechanics.types import Mode
from ...stamps import NANOSECONDS
from ...wording import words
from ..modes import EDGE, MODES
from ..summary import quantile
from .document import GREY, bars, marks, part_words, plot, safe, signed_ms, time_words, titled
from .found import BagAnswer, begin_of

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as PlotlyFigure

MISSED: Final = "missed"
"""The mark of a true touchdown that no prediction announced."""

FALSE: Final = "false alarm"
"""The mark of an announcement of a touchdown that never came."""

TRUTH: Final = "truth"
"""The lane of the stances that the record tells."""

RED: Final = "#d02a3d"
BLUE: Final = "#3d7fc4"

PAUSE: Final = 2 * NANOSECONDS
"""Pauses (ns) that are longer can be cut out."""

REST: Final = NANOSECONDS // 10
"""What stays of a pause (ns) after what came before it and, at least, before what comes after it."""

MOST: Final = 3000
"""Marks in a timeline above which not all of them are drawn."""

FEW: Final = 75
"""Cuts of which each has a line."""

LANE: Final = 28
"""Height of a lane in pixels."""


class TimelineMark(NamedTuple):
    """A mark at a stamp (ns): a mode, `MISSED` or `FALSE`; faint where it does not count.

    `since` is the stamp at which it was first announced, None where that is not shown; `said` is what a reader sees who
    points at it.
    """

    stamp: int
    mark: str
    said: str
    faint: bool = False
    since: int | None = None


class Lane(NamedTuple):
    """A line of a timeline: marks, stances as (begin, end) in ns, or errors as (stamp, part of 1)."""

    name: str
    marks: Sequence[TimelineMark] = ()
    stances: Sequence[tuple[int, int]] = ()
    errors: Sequence[tuple[int, float]] = ()


class ShownTime(NamedTuple):
    """The time that a timeline shows: the pieces of a record that are no long pauses, as (begin, end, place) in ns."""

    pieces: Sequence[tuple[int, int, int]]

    def at(self, stamp: int) -> float:
        """The place of a stamp in the time that is shown, in s; in a pause that of its cut."""
        piece = self.pieces[max(bisect_right(self.pieces, stamp, key=lambda one: one[0]) - 1, 0)]
        return (piece[2] + min(max(stamp, piece[0]), piece[1]) - piece[0]) / NANOSECONDS


def timeline(answer: BagAnswer) -> tuple[PlotlyFigure, list[str]]:
    """The timeline of a bag, and sentences on what of it is not drawn as it is."""
    lanes, begin = lanes_of(answer), begin_of(answer)
    time = shown_time(answer, lanes)
    pieces = [
        [(first - begin) / NANOSECONDS, (last - begin) / NANOSECONDS, place / NANOSECONDS]
        for first, last, place in time.pieces
    ]
    cuts, shown = [place for _, _, place in pieces[1:]], time.at(time.pieces[-1][1])
    said: list[str] = []
    traces: list[dict[str, Any]] = []
    for number, lane in enumerate(lanes):
        traces += [*_stances(lane, -number, time, begin), *_errors(lane, -number, time)]
    if sum(len(lane.marks) for lane in lanes) > MOST:
        lanes = [lane._replace(marks=[mark for mark in lane.marks if not mark.faint][:MOST]) for lane in lanes]
        said.append(f"There are too many marks: of each lane the first {MOST:,} are drawn, and no faint ones.")
    traces += _marks(lanes, time)
    dashed = cuts if len(cuts) <= FEW else []
    if cuts:
        each = ", each at a dotted line" if dashed else ""
        said.append(f"Pauses are cut out{each}: {time_words(shown)} of {time_words(pieces[-1][1])} are shown.")
    line = {"dash": "dot", "color": GREY, "width": 1}
    figure = plot(
        traces,
        height=120 + LANE * len(lanes),
        margin={"l": 16, "r": 16, "t": 40, "b": 48},
        xaxis=titled("time in the record, s", range=[-0.01 * shown, 1.01 * shown]),
        yaxis={
            "tickvals": [-number for number in range(len(lanes))],
            "ticktext": [
                safe(f"{lane.name} to {part_words(highest(lane))}" if lane.errors else lane.name) for lane in lanes
            ],
            "range": [0.6 - len(lanes), 0.6],
            "automargin": True,
            "fixedrange": True,
            "showgrid": False,
        },
        barmode="overlay",
        shapes=[{"type": "line", "x0": x, "x1": x, "yref": "paper", "y0": 0, "y1": 1, "line": line} for x in dashed],
        meta={"pieces": pieces} if cuts else None,
    )
    return figure, said


def look_of(mark: str) -> dict[str, Any]:
    """How a mark is drawn: a mode as everywhere, what is missed or false in red."""
    edge = {"color": EDGE, "width": 0.7}
    if mark not in Mode.__members__:
        return {"color": RED, "symbol": "star" if mark == MISSED else "x", "line": edge, "size": 12}
    look = MODES[Mode[mark]]
    return {"color": look.colour, "symbol": look.symbol, "line": edge, "size": 10}


def in_order(marks: Iterable[str]) -> list[str]:
    """Marks, each once: the modes in their order, then what was missed and what was false."""
    order = [*(mode.name for mode in MODES), MISSED, FALSE]
    return sorted(set(marks), key=order.index)


def highest(lane: Lane) -> float:
    """The error that is drawn in full height: a few greater ones do not press down the others."""
    values = [error for _, error in lane.errors]
    return min(max(values), 3.0 * quantile(values, 0.9)) or 1.0


def _marks(lanes: Sequence[Lane], time: ShownTime) -> list[dict[str, Any]]:
    """The marks, those of a mode at once, above the lines back to when each was first announced."""
    drawn = [(mark, -number) for number, lane in enumerate(lanes) for mark in lane.marks]
    back_x: list[float | None] = []
    back_y: list[float | None] = []
    for mark, y in drawn:
        if mark.since is not None:
            back_x += [time.at(mark.since), time.at(mark.stamp), None]
            back_y += [y, y, None]
    back = {"type": "scatter", "mode": "lines", "name": "announced until it came", "x": back_x, "y": back_y}
    traces = [back | {"line": {"color": GREY, "width": 1.5}, "hoverinfo": "skip"}] if back_x else []
    # What is faint lies below what counts.
    for name, faint in [(name, faint) for faint in (True, False) for name in in_order(mark.mark for mark, _ in drawn)]:
        points = [(time.at(mark.stamp), y, mark.said) for mark, y in drawn if mark.mark == name and mark.faint == faint]
        if points:
            # The opacity of a trace, not of its marks: faint ones on each other are no darker than one.
            label, opacity = (f"{name}, faint", 0.3) if faint else (name, 1.0)
            traces.append(marks(label, points, marker=look_of(name), opacity=opacity))
    return traces


def _stances(lane: Lane, y: int, time: ShownTime, begin: int) -> list[dict[str, Any]]:
    """Bars from when a foot comes to stand until it leaves."""
    if not lane.stances:
        return []
    points = [
        (time.at(last) - time.at(first), y, f"stands from {_moment(first, begin)} to {_moment(last, begin)}")
        for first, last in lane.stances
    ]
    base = [time.at(first) for first, _ in lane.stances]
    look = {"color": GREY if lane.name == TRUTH else BLUE}
    return [bars(points, orientation="h", base=base, width=0.5, marker=look)]


def _errors(lane: Lane, y: int, time: ShownTime) -> list[dict[str, Any]]:
    """A stem for each error, as high as it is."""
    if not lane.errors:
        return []
    heights = [0.8 * min(error / highest(lane), 1.0) for _, error in lane.errors]
    points = [
        (time.at(stamp), y - 0.4 + height, f"relative error {part_words(error)}")
        for (stamp, error), height in zip(lane.errors, heights, strict=True)
    ]
    stems = {"array": [0.0] * len(heights), "arrayminus": heights, "width": 0, "thickness": 2, "color": BLUE}
    return [marks(lane.name, points, error_y=stems, showlegend=False, marker={"color": BLUE, "size": 3})]


def shown_time(answer: BagAnswer, lanes: Iterable[Lane]) -> ShownTime:
    """From the first sample to the last one, and what lies beyond; without long pauses where they are most of it."""
    begin = begin_of(answer)
    moments = {begin, max(answer.get("end") or 0, begin + 1)}
    for lane in lanes:
        moments |= {stamp for mark in lane.marks for stamp in (mark.stamp, mark.since or mark.stamp)}
        moments |= {stamp for stance in lane.stances for stamp in stance}
    stamps = sorted(max(stamp, begin) for stamp in moments)
    pauses = [(one, other) for one, other in pairwise(stamps) if other - one > PAUSE]
    if 2 * sum(other - one for one, other in pauses) < stamps[-1] - begin:
        pauses = []
    # A piece begins at a whole tenth of a second, so that its time is told exactly.
    begins = [begin, *(begin + (other - begin - REST) // REST * REST for _, other in pauses)]
    ends = [*(one + REST for one, _ in pauses), stamps[-1]]
    pieces: list[tuple[int, int, int]] = []
    place = 0
    for first, last in zip(begins, ends, strict=True):
        pieces.append((first, last, place))
        place += last - first
    return ShownTime(pieces)


def lanes_of(answer: BagAnswer) -> list[Lane]:
    """The lanes of a bag: of the feet of machines that walk, then of the bodies that have touchdowns."""
    lanes = [lane for body in answer.get("gaits", {}) for lane in _feet(answer, body)]
    both = [*answer["touchdowns"], *answer.get("true_touchdowns", ())]
    bodies = dict.fromkeys(one["body"] for one in both if "foot" not in one)
    return lanes + [lane for body in bodies for lane in _body(answer, body)]


def _feet(answer: BagAnswer, body: str) -> Iterable[Lane]:
    """The feet of a machine: when each landing was predicted, and when the foot stands."""
    gait, several = answer["gaits"][body], len(answer["gaits"]) > 1
    landings = [one for one in answer["touchdowns"] if "foot" in one and (not several or one["body"] == body)]
    for number, foot in enumerate(gait["feet"]):
        name = f"{body}/{foot}" if several else foot
        yield Lane(f"{name} predicted", [_landing(one, begin_of(answer)) for one in landings if one["foot"] == foot])
        yield Lane("stands", stances=[(begin, end) for place, begin, end in gait["stances"] if place == number])
        if gait["true_stances"]:
            yield Lane(TRUTH, stances=[(begin, end) for place, begin, end in gait["true_stances"] if place == number])


def _moment(stamp: int, start: int) -> str:
    return f"{(stamp - start) / NANOSECONDS:.3f} s"


def _landing(one: BagAnswer, start: int) -> TimelineMark:
    """A landing where it was predicted last; one that was not announced where it came, as missed."""
    at = f"{one['foot']} lands at {_moment(one['stamp'], start)}"
    if one["time_error"] is None:
        return TimelineMark(one["stamp"], MISSED, f"{at}, not announced")
    lead = one["announced_lead_time"]
    said = f"{at}\nannounced {time_words(lead)} ahead\nthe last predicted time is {signed_ms(one['time_error'])} off"
    predicted = one["stamp"] + round(one["time_error"] * NANOSECONDS)
    mode = one["landing_mode"] or one["mode"]
    return TimelineMark(predicted, mode, f"{said}\n{mode}", since=one["stamp"] - round(lead * NANOSECONDS))


def _body(answer: BagAnswer, body: str) -> Iterable[Lane]:
    """A body: its predicted touchdowns, the true ones where they are known, and how wrong the velocities after were.

    That is against the true velocities, or where they are not known against those that the samples show.
    """
    start = begin_of(answer)
    true = [one for one in answer.get("true_touchdowns", ()) if one["body"] == body]
    mine = [one for one in answer["touchdowns"] if one["body"] == body and "foot" not in one]
    scored = [one for one in mine if one["scored"]]
    if true:
        yield Lane(f"{body} predicted", [_predicted(one, start) for one in true if one["predicted_stamp"] is not None])
        yield Lane("true", [_true(one, start) for one in true if one["stamp"] is not None])
    else:
        yield Lane(f"{body} predicted", [_touchdown(one, start) for one in scored])
    key = "velocity_error" if true else "relative_error"
    errors = [(one["stamp"], one[key]) for one in true or scored if one[key] is not None]
    if errors:
        yield Lane("error", errors=errors)
    if not true and len(scored) < len(mine):
        yield Lane("not compared", [_touchdown(one, start) for one in mine if not one["scored"]])


def _touchdown(one: BagAnswer, start: int) -> TimelineMark:
    """A touchdown that was predicted and came; faint where nothing measured can be compared with it."""
    lead = one["announced_lead_time"]
    said = f"{_moment(one['stamp'], start)}: {one['mode']}\nannounced {time_words(lead)} ahead"
    if one["scored"]:
        said += f"\nrelative error {part_words(one['relative_error'])}"
    else:
        said += f"\nnot compared: {', '.join(words(flag) for flag in one['flags'])}"
    since = one["stamp"] - round(lead * NANOSECONDS)
    return TimelineMark(one["stamp"], one["mode"], said, not one["scored"], since)


def _predicted(one: BagAnswer, start: int) -> TimelineMark:
    """What was announced: of a true touchdown, or in vain."""
    said = f"predicted for {_moment(one['predicted_stamp'], start)}: {one['predicted_mode']}"
    if one["stamp"] is None:
        return TimelineMark(one["predicted_stamp"], FALSE, f"{FALSE}, {said}", since=one["first_seen"])
    said += f"\nfirst announced {time_words((one['stamp'] - one['first_seen']) / NANOSECONDS)} ahead"
    error = (one["predicted_stamp"] - one["stamp"]) / NANOSECONDS
    said += f"\nthe last predicted time is {time_words(abs(error))} off"
    mode = one["predicted_mode"] or Mode.NO_IMPACT.name
    return TimelineMark(one["predicted_stamp"], mode, said, not one["shown"], one["first_seen"])


def _true(one: BagAnswer, start: int) -> TimelineMark:
    """What happened; faint what such a record cannot show."""
    said = f"{_moment(one['stamp'], start)}: {one['mode']}"
    missed = one["shown"] and one["predicted_stamp"] is None
    if not one["shown"]:
        said += "\nwhich cannot be seen at this rate of samples"
    elif missed:
        said += "\nmissed: no prediction announced it"
    return TimelineMark(one["stamp"], MISSED if missed else one["mode"] or Mode.NO_IMPACT.name, said, not one["shown"])
