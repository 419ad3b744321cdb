"""The typed message about a support and the units that are watched on it, made of the values of their reports."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import nan
from operator import itemgetter
from typing import TYPE_CHECKING, Final

from ...prediction.deck.forecast import LEADS, ForecastStatus
from ...prediction.types import Status
from ...prediction.watch.levels import UNKNOWN, Level
from .kinds import CHOICE, HEADER, TEXT, Field, Kind, field
from .message import Message, MessageSection

if TYPE_CHECKING:
    from ...prediction.watch.watch import Report


def _numbers(texts: Sequence[str]) -> list[float]:
    return [float(one) for words in texts for one in words.split()]


def _said(keys: Sequence[str], report: Report) -> list[str] | None:
    """The texts of a report by their keys; None where one is not known."""
    found = [report.values.get(key, UNKNOWN) for key in keys]
    return None if UNKNOWN in found else found


def _text(key: str, report: Report) -> str:
    return report.values.get(key, UNKNOWN)


def _number(key: str, unit: str, meaning: str) -> Field:
    return field(key, _told("float64", 1), unit, meaning, partial(_said, [key]))


def _ahead(key: str, unit: str, meaning: str) -> Field:
    """Numbers for each of the `LEADS`."""
    keys = [f"{key}.{lead:g}_s" for lead in LEADS]
    return field(key, _PER_LEAD, unit, f"{meaning}, each of leads ahead", partial(_said, keys))


def _vectors_ahead(key: str, unit: str, meaning: str) -> Field:
    return _ahead(key, unit, f"{meaning}, along the axes of the support")._replace(kind=_VECTOR_PER_LEAD)


def _told(type_name: str, count: int) -> Kind:
    return Kind(type_name, "d" * count, (nan,) * count, _numbers)


_PER_LEAD: Final = _told(f"float64[{len(LEADS)}]", len(LEADS))
_VECTOR_PER_LEAD: Final = _told(f"geometry_msgs/Vector3[{len(LEADS)}]", 3 * len(LEADS))


def _status(report: Report) -> Status:
    return Status[report.values["status"]]


def _forecast(report: Report) -> int | None:
    name = report.values.get("forecast")
    return None if name is None else [one.name for one in ForecastStatus].index(name) + 1


def _named(*fields: Field) -> dict[str, Field]:
    return {one.key.replace(".", "_"): one for one in fields}


UNIT_STATE: Final = Message(
    "UnitState",
    "A body under watch on a support: how near it is to sliding and tipping.\n\n"
    "A number that nobody knows is NaN. A part of a margin that is used up is 1 at the onset.",
    MessageSection(
        "",
        0,
        _named(
            field("body", TEXT, "", "name of the body"),
            field("level", CHOICE, "", "LEVEL_*"),
            field("status", CHOICE, "", "what became of its last sample: STATUS_* of Prediction", _status),
            _number("slide_ratio", "1", "part of the margin against sliding that is used up"),
            _number("tip_ratio", "1", "part of the margin against tipping that is used up"),
            _number("time_to_tip", "s", "until tipping is likely, inf where it does not become so"),
            _number("time_to_slide", "s", "until sliding is likely, inf where it does not become so"),
            _number("onset_probability", "1", "of either within the horizon of the watch"),
            _number("tip_probability_30_s", "1", "of tipping within 30 s"),
            _number("tip_probability_hour", "1", "of tipping within an hour"),
            _number("tip_maximum_hour", "1", "highest tip_ratio to be expected in an hour"),
            _number("slide_probability_30_s", "1", "of sliding within 30 s"),
            _number("slide_probability_hour", "1", "of sliding within an hour"),
            _number("slide_maximum_hour", "1", "highest slide_ratio to be expected in an hour"),
            _number("energy_to_topple", "J", "that it takes to topple it over the nearest edge"),
            _number("tilt", "rad", "of the body on the support"),
            _number("slides_per_hour", "1/h", "onsets of sliding"),
            _number("tips_per_hour", "1/h", "onsets of tipping"),
            _number("impacts_per_hour", "1/h", "touchdowns"),
            _vectors_ahead("felt", "m/s^2", "acceleration that the body is likely to feel, in the mean"),
            _vectors_ahead("felt.deviation", "m/s^2", "standard deviation of felt"),
            field("edge", TEXT, "", "edge over which it tips first, or none", partial(_text, "edge")),
            field("message", TEXT, "", "the reasons of the level, in words"),
        ),
    ),
    constants={"LEVEL": Level},
)


def _header(told: tuple[Sequence[Report], Report | None]) -> tuple[int, str]:
    reports, deck = told
    return max(report.stamp for report in reports), "" if deck is None else deck.body


DECK_STATE: Final = Message(
    "DeckState",
    "A support and the units under watch on it, once a second and when a level changes.\n\n"
    "A number that nobody knows is NaN, so all of a support that does not move.",
    MessageSection(
        "",
        0,
        {
            "header": field("header", HEADER, "", "newest stamp, and the frame of the support", _header),
            "leads": field("leads", _PER_LEAD._replace(numbers=tuple), "s", "ahead", lambda _: LEADS),
        },
    ),
    MessageSection(
        "How it moves",
        1,
        _named(
            _number("window.linear", "s", "over which linear accelerations are found"),
            _number("window.angular", "s", "over which angular accelerations are found"),
            field("forecast", CHOICE, "", "whether it is trusted: FORECAST_*, 0 without one", _forecast),
            _ahead("roll", "rad", "mean of the roll with port up"),
            _ahead("roll.deviation", "rad", "standard deviation of the roll"),
            _ahead("pitch", "rad", "mean of the pitch with the bow down"),
            _ahead("pitch.deviation", "rad", "standard deviation of the pitch"),
            _ahead("skill", "1", "part of the better simple answer's mean square error of felt gravity that it spares"),
            _ahead("skill.roll", "1", "the same of the roll"),
            _ahead("skill.pitch", "1", "the same of the pitch"),
            _ahead("error.forecast", "m/s^2", "root mean square error of felt gravity"),
            _ahead("error.roll.forecast", "rad", "the same of the roll"),
            _ahead("error.pitch.forecast", "rad", "the same of the pitch"),
        ),
    ),
    MessageSection("", 0, {"units": field("units", UNIT_STATE.elements, "", "under watch", itemgetter(0))}),
    constants={"FORECAST": ForecastStatus},
)


def encode_deck_state(reports: Sequence[Report], deck: Report | None) -> bytes:
    """An impact_predictor_msgs/DeckState of reports that are due, one of them on the support if it moves."""
    return DECK_STATE.encode((reports, deck), deck)
