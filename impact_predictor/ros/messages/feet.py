"""What `~/prediction` and `~/score` tell of the feet of a walking machine, as keys and values."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import Final

from ...prediction.types import Foot, Landing
from ..cdr import OK, WARN, DiagnosticForm, StatusBytes


def statuses_of(feet: Iterable[Foot]) -> list[StatusBytes]:
    """A diagnostic_msgs/DiagnosticStatus for each foot: its keys are the fields of `Foot`, but those that are None.

    Of its positions only the `place` where it lands is told, as `place.x`, `place.y` and `place.z`. The hardware is
    the foot; the level is WARN where a force sensor does not agree that it stands, or swings.
    """
    statuses = []
    for foot in feet:
        values = _texts(foot._replace(position=None, place=None))
        if foot.place is not None:
            values |= zip(_PLACE_KEYS, map(repr, foot.place), strict=True)
        level = WARN if foot.confirmed is False else OK
        statuses.append(_form(*values).status(level, _message(foot), foot.name, list(values.values())))
    return statuses


_PLACE_KEYS: Final = ("place.x", "place.y", "place.z")


@lru_cache(maxsize=64)
def _form(*keys: str) -> DiagnosticForm:
    return DiagnosticForm("impact_predictor/foot", *keys)


def _message(foot: Foot) -> str:
    words = "stands" if foot.stands else "swings"
    if not foot.stands and foot.lead_time is not None:
        words += f", lands in {foot.lead_time * 1e3:.1f} ms"
    return words if foot.confirmed is not False else f"{words}, but its force sensor does not agree"


def landing_values(landing: Landing) -> dict[str, str]:
    """What `~/score` tells of a landing besides its impact.

    `foot`; `late` in s after the plan; `confirmed` by a force sensor; `time_error` in s of the last announcement. What
    nobody knows is left out.
    """
    values = _texts(landing._replace(history=(), impact=None))
    del values["stamp"], values["history"]
    if landing.history:
        values["time_error"] = repr(float(landing.history[-1][1]))
    return values


def landing_in_words(landing: Landing) -> str:
    """Which foot has landed, and how well that was foretold."""
    name = f"{landing.foot} {landing.point or ''}".rstrip()
    if not landing.history:
        return f"{name} has landed, which was not announced"
    return f"{name} has landed, time error {landing.history[-1][1] * 1e3:.1f} ms"


def _texts(fields: Foot | Landing) -> dict[str, str]:
    """The fields that are not None, by their names; every number reads back as the same one."""
    return {name: _text(value) for name, value in fields._asdict().items() if value is not None}


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(float(value)) if isinstance(value, float) else str(value)
