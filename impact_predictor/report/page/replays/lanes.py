"""What a timeline shows of one bag: a row for each body or foot, with lanes of what was predicted and what came."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from ....stamps import NANOSECONDS
from .answers import Answer
from .words import mode_words, percent, seconds_words, signed_ms

MISSED: Final = "MISSED"
"""The mark of a true touchdown that no prediction announced."""

FALSE: Final = "FALSE"
"""The mark of an announcement of a touchdown that never came."""


class Spot(NamedTuple):
    """A mark at a stamp (ns): a mode, `MISSED` or `FALSE`; faint where it does not count. `since` is when it was first
    announced, as a stamp, None where that is not shown.
    """

    stamp: int
    mark: str
    told: str
    faint: bool = False
    since: int | None = None


class Bar(NamedTuple):
    """What lasts from a stamp to another (ns)."""

    begin: int
    end: int
    told: str


class Stem(NamedTuple):
    """A value at a stamp (ns)."""

    stamp: int
    value: float
    told: str


class Lane(NamedTuple):
    """A line of a row, with marks, bars or stems; `css_class` of its bars."""

    name: str
    spots: Sequence[Spot] = ()
    bars: Sequence[Bar] = ()
    stems: Sequence[Stem] = ()
    css_class: str = ""


class Row(NamedTuple):
    """A body, or a foot of one."""

    name: str
    lanes: Sequence[Lane]


def begin_of(answer: Answer) -> int:
    """The stamp (ns) from which the times of a record are counted: that of its first sample."""
    begin = answer.get("begin")
    return int(min((one["stamp"] for one in answer["touchdowns"]), default=0) if begin is None else begin)


def rows_of(answer: Answer) -> list[Row]:
    """The rows of a bag: the feet of machines that walk, then the bodies that have touchdowns."""
    rows = [row for body in answer.get("gaits", {}) for row in feet_of(answer, body)]
    bodies = dict.fromkeys(
        one["body"] for one in [*answer["touchdowns"], *answer.get("true_touchdowns", ())] if "foot" not in one
    )
    return rows + [body_row(answer, body) for body in bodies]


def feet_of(answer: Answer, body: str) -> list[Row]:
    """The feet of a machine: when each landing was predicted, and when the foot stands."""
    gait, several = answer["gaits"][body], len(answer["gaits"]) > 1
    start = begin_of(answer)
    landings = [one for one in answer["touchdowns"] if "foot" in one and (not several or one["body"] == body)]
    rows = []
    for number, foot in enumerate(gait["feet"]):
        spots = [landing_spot(one, start) for one in landings if one["foot"] == foot]
        lanes = [
            Lane("predicted", spots),
            Lane("stands", bars=stances(gait["stances"], number, start), css_class="stands"),
        ]
        if gait["true_stances"]:
            lanes.append(Lane("truth", bars=stances(gait["true_stances"], number, start), css_class="truth"))
        rows.append(Row(f"{body}/{foot}" if several else foot, lanes))
    return rows


def landing_spot(one: Answer, start: int) -> Spot:
    """A landing where it was predicted last; one that was not announced where it came, as missed."""
    at = f"{(one['stamp'] - start) / NANOSECONDS:.3f} s"
    if one["time_error"] is None:
        return Spot(one["stamp"], MISSED, f"{one['foot']} lands at {at}, not announced")
    told = one["stamp"] + round(one["time_error"] * NANOSECONDS)
    since = one["stamp"] - round(one["announced_lead_time"] * NANOSECONDS)
    words = (
        f"{one['foot']} lands at {at}\nannounced {seconds_words(one['announced_lead_time'])} ahead\n"
        f"last told time is {signed_ms(one['time_error'])} off"
    )
    return Spot(told, one["landing_mode"] or one["mode"], words, since=since)


def stances(known: Iterable[Sequence[int]], number: int, start: int) -> list[Bar]:
    """The stances of a foot, by its number."""
    return [
        Bar(begin, end, f"stands from {(begin - start) / NANOSECONDS:.3f} to {(end - start) / NANOSECONDS:.3f} s")
        for foot, begin, end in known
        if foot == number
    ]


def body_row(answer: Answer, body: str) -> Row:
    """A body: its predicted touchdowns, the true ones where they are known, and how wrong the velocities after were.

    That is against the true velocities, or where they are not known against those that the samples show.
    """
    start = begin_of(answer)
    mine = [one for one in answer["touchdowns"] if one["body"] == body and "foot" not in one]
    true = [one for one in answer.get("true_touchdowns", ()) if one["body"] == body]
    others: list[Spot] = []
    if true:
        lanes = [Lane("predicted", told_spots(true, start)), Lane("true", true_spots(true, start))]
    else:
        others = [touchdown_spot(one, start) for one in mine if not one["scored"]]
        lanes = [Lane("predicted", [touchdown_spot(one, start) for one in mine if one["scored"]])]
    wrong = (
        [(one["stamp"], one["velocity_error"]) for one in true]
        if true
        else [(one["stamp"], one["relative_error"]) for one in mine if one["scored"]]
    )
    stems = [Stem(stamp, error, f"relative error {percent(error)}") for stamp, error in wrong if error is not None]
    lanes += [Lane("error", stems=stems)] if stems else []
    lanes += [Lane("not compared", others)] if others else []
    return Row(body, lanes)


def touchdown_spot(one: Answer, start: int) -> Spot:
    """A touchdown that was predicted and came; faint where nothing measured can be compared with it."""
    at = f"{(one['stamp'] - start) / NANOSECONDS:.3f} s: {one['mode']}"
    words = f"{at}\nannounced {seconds_words(one['announced_lead_time'])} ahead"
    if one["relative_error"] is not None and one["scored"]:
        words += f"\nrelative error {percent(one['relative_error'])}"
    else:
        words += f"\nnot compared: {', '.join(mode_words(flag) for flag in one['flags'])}"
    since = one["stamp"] - round(one["announced_lead_time"] * NANOSECONDS)
    return Spot(one["stamp"], one["mode"], words, not one["scored"], since)


def told_spots(true: Sequence[Answer], start: int) -> list[Spot]:
    """What was announced: of true touchdowns, and in vain."""
    spots = []
    for one in true:
        if one["predicted_stamp"] is not None:
            at = f"told for {(one['predicted_stamp'] - start) / NANOSECONDS:.3f} s: {one['predicted_mode']}"
            if one["stamp"] is None:
                spots.append(Spot(one["predicted_stamp"], FALSE, f"false alarm, {at}", since=one["first_seen"]))
            else:
                error = (one["predicted_stamp"] - one["stamp"]) / NANOSECONDS
                words = f"{at}\nfirst {seconds_words((one['stamp'] - one['first_seen']) / NANOSECONDS)} ahead"
                words += f"\nlast told time is {seconds_words(abs(error))} off"
                spot = Spot(one["predicted_stamp"], one["predicted_mode"], words, not one["shown"], one["first_seen"])
                spots.append(spot)
    return spots


def true_spots(true: Sequence[Answer], start: int) -> list[Spot]:
    """What happened; faint what such a record cannot show."""
    spots = []
    for one in (one for one in true if one["stamp"] is not None):
        words = f"{(one['stamp'] - start) / NANOSECONDS:.3f} s: {one['mode']}"
        if not one["shown"]:
            words += "\nwhich cannot be seen at this rate of samples"
        elif one["predicted_stamp"] is None:
            words += "\nmissed: no prediction announced it"
        missed = one["shown"] and one["predicted_stamp"] is None
        spots.append(Spot(one["stamp"], MISSED if missed else one["mode"], words, not one["shown"]))
    return spots
