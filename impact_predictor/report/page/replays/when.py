"""The timelines of the bags: of all where they are few, else of the worst."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot
from typing import Final

from ..looks import marker_svg
from ..sections import Cell, Figure, Key, Section, Table
from ..words import time_words
from .answers import Answer, badness, landings_of, names_of
from .extent import Extent, extent_of
from .lanes import Row, begin_of, rows_of
from .timeline import MOST, marks, several_of, timeline
from .words import MODES, SAYS, seconds_words, signed_ms

SHOWN: Final = 8
"""Bags of which a timeline is shown; of more the worst."""
LISTED: Final = 200
"""Landings of a bag whose numbers are listed."""

TRUTH: Final = (
    "Each row has the predicted touchdowns above the true ones, which the record tells; a line before a mark leads "
    "back to when it was first announced. A star is a touchdown that was missed, a red cross one that never came. "
    "Faint is what such a record cannot show: too slow to be told from rest, or too soon after another. Below them is "
    "how wrong the velocities were that were told last, against the true ones."
)
MEASURED: Final = (
    "The record does not tell when contacts closed, so a touchdown stands where it was predicted last; a line before "
    "it leads back to when it was first announced. Below it is how wrong its velocities were against those that the "
    "samples after it show. In the last lane are those that cannot be compared: point at one for the reason."
)
FEET: Final = (
    "Each row is a foot. A mark is a landing where it was predicted last, and the line before it leads back to when it "
    "was first announced; its shape is the mode of an impact with the foot's speed in its last sample in the air. A "
    "star is a landing that nothing announced. Below them is when the foot stands, as its motion shows"
)
COUNTED: Final = (
    f"There are more than {MOST:,} marks, too many for one each: the higher a column is, the more of them fall into "
    "its part of the time; point at it for the number."
)


def anchors_of(answers: Sequence[Answer]) -> dict[int, str]:
    """Where the timelines of bags stand on the page, by the places of the bags."""
    places = [
        place for place, answer in enumerate(answers) if answer.get("touchdowns") or answer.get("true_touchdowns")
    ]
    if len(places) > SHOWN:
        places = sorted(places, key=lambda place: badness(answers[place]), reverse=True)[:SHOWN]
    return {place: f"bag-{place + 1}" for place in sorted(places)}


def when(answers: Sequence[Answer], anchors: Mapping[int, str]) -> Section | None:
    """The section of timelines; None where nothing was predicted."""
    if not anchors:
        return None
    names = names_of(answers)
    shown = [answers[place] for place in anchors]
    words = list(dict.fromkeys(says(answer) for answer in shown))
    if len(anchors) == SHOWN < len(answers):
        words.insert(0, f"The timelines of the worst {SHOWN} of {len(answers):,} bags.")
    rows = [rows_of(answer) for answer in shown]
    single = [row for mine in rows if not several_of(mine) for row in mine]
    drawn = {spot.mark for row in single for lane in row.lanes for spot in lane.spots}
    key = [Key(marker_svg(looks), mode, SAYS[mode]) for mode, looks in MODES.items() if mode in drawn]
    figures = [
        figure_of(answer, mine, names[place], anchor)
        for answer, mine, (place, anchor) in zip(shown, rows, anchors.items(), strict=True)
    ]
    figures[0] = figures[0]._replace(drawings=[marks(), *figures[0].drawings])
    return Section("when", "When the touchdowns came", words, key, figures=figures)


def figure_of(answer: Answer, rows: Sequence[Row], name: str, anchor: str) -> Figure:
    """The timeline of a bag, and numbers of it."""
    extent = extent_of(answer, rows)
    said = " ".join(one for one in (COUNTED if several_of(rows) else "", cut_words(extent)) if one)
    return Figure(name, said, [timeline(rows, extent, name, anchor)], (), numbers(answer), anchor)


def cut_words(extent: Extent) -> str:
    """What is cut out of a timeline."""
    if not extent.cut:
        return ""
    when = "" if extent.is_cut_at(1) else " where the timeline is magnified"
    shown, all_time = (time_words(1e-3 * length) for length in (extent.length, extent.length + extent.cut))
    return f"Pauses are cut out: {shown} of {all_time} are shown. A dashed line stands for each{when}."


def says(answer: Answer) -> str:
    """How a timeline is read."""
    if "gaits" in answer:
        truth = any(gait["true_stances"] for gait in answer["gaits"].values())
        return f"{FEET}, and as the record tells." if truth else f"{FEET}."
    return TRUTH if "true_touchdowns" in answer else MEASURED


def numbers(answer: Answer) -> Table | None:
    """The landings of feet, or what was missed and announced in vain, as a table."""
    start = begin_of(answer)
    if landings := landings_of([answer]):
        return landings_table(landings, start)
    wrong = [
        one
        for one in answer.get("true_touchdowns", ())
        if one["stamp"] is None or (one["shown"] and one["predicted_stamp"] is None)
    ]
    rows = [
        [
            Cell(f"{((one['stamp'] or one['predicted_stamp']) - start) * 1e-9:.3f} s"),
            Cell(one["body"]),
            Cell("missed" if one["stamp"] else "false alarm"),
            Cell(one["mode"] or one["predicted_mode"]),
        ]
        for one in wrong[:LISTED]
    ]
    return (
        Table("Touchdowns that were missed, and false alarms.", ["time", "body", "", "mode"], rows, 4) if rows else None
    )


def landings_table(landings: Sequence[Answer], start: int) -> Table:
    """The landings of feet, in their order."""
    rows = [
        [
            Cell(f"{(one['stamp'] - start) * 1e-9:.3f} s", one["point"] or ""),
            Cell(one["foot"]),
            Cell(seconds_words(one["announced_lead_time"]) if one["time_error"] is not None else "not announced"),
            Cell(signed_ms(one["time_error"])),
            Cell("–" if one["landing_speed"] is None else f"{one['landing_speed']:.3f} m/s"),
            impulse_cell(one),
            *([Cell(signed_ms(one["late"]))] if any(each["late"] is not None for each in landings) else []),
        ]
        for one in landings[:LISTED]
    ]
    head = ["time", "foot", "announced ahead", "last told time", "speed", "impulse"]
    head += ["after the plan"] if any(one["late"] is not None for one in landings) else []
    caption = f"The first {LISTED} of {len(landings):,} landings." if len(landings) > LISTED else ""
    return Table(caption, head, rows, words=2, cards=True)


def impulse_cell(one: Answer) -> Cell:
    """The impulse at a foot that lands, and that at the others."""
    if one["impulse"] is None:
        return Cell("–")
    # Answers of older versions do not tell it.
    others = one.get("others_impulse")
    return Cell(f"{hypot(*one['impulse']):.2f} N s", f"{hypot(*others):.2f} N s at other feet" if others else "")
