"""Impacts as a scenario knows them, and the messages in which a bag carries them.

They travel on topics of their own, as diagnostic_msgs/DiagnosticArray, and are never an input of a prediction.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, hypot, inf, sin
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar

from ..mechanics.impact import approach
from ..mechanics.types import Mode, Outcome, TwoPointBody
from ..prediction.types import Vector3
from ..ros.cdr import OK, MalformedMessage, decode_diagnostic_array, diagnostic_array, diagnostic_status, pairs_of
from ..stamps import NANOSECONDS

if TYPE_CHECKING:
    from ..mechanics.motion import RockingImpact
    from .sensors import MotionPlane

TRUTH_TOPIC: Final = "/truth/impacts"
ONSET_TOPIC: Final = "/truth/onsets"

Happened = TypeVar("Happened")

_VECTORS: Final = ("linear_before", "angular_before", "linear_after", "angular_after")
_NUMBERS: Final = ("approach", "half_distance", "energy_lost", "border")


class TrueImpact(NamedTuple):
    """An impact that happened.

    `stamp` in ns; `body` its frame; `old` and `new` the indices of the contact points that stood and that struck;
    `approach` how fast the new contact came down, in m/s; `half_distance` between both contacts in m, for one contact
    its distance from the mass centre; `energy_lost` in J; linear velocities of the mass centre in m/s and angular
    velocities in rad/s, relative to the support: in the frame of odom, over a moving support in its axes. `border` is
    the smallest relative change of friction or of geometry with which the mode would be another, see `border_of`.
    """

    stamp: int
    body: str
    mode: Mode
    old: tuple[int, ...]
    new: tuple[int, ...]
    approach: float
    half_distance: float
    energy_lost: float
    linear_before: Vector3
    angular_before: Vector3
    linear_after: Vector3
    angular_after: Vector3
    border: float = inf


class TrueOnset(NamedTuple):
    """The moment at which a body that stood still on its support begins to slide on it, to lift a contact, or both.

    `stamp` in ns; `body` its frame.
    """

    stamp: int
    body: str
    slides: bool
    lifts: bool


def true_impact(
    strike: RockingImpact,
    name: str,
    plane: MotionPlane,
    tilt: float = 0.0,
    contacts: Sequence[tuple[int, ...]] = ((0,), (1,)),
    border: float = inf,
    since: float = 0.0,
) -> TrueImpact:
    """An impact of a motion as the truth of a record.

    Its velocities are along axes that are turned by -`tilt` (rad) from the support's; `contacts` are the indices of the
    points, in the scene, that the two contacts stand for; the times of the motion count from `since` (s).
    """
    body, before = strike.outcome.body, strike.outcome.before
    assert body is not None
    assert before is not None
    after = strike.outcome.twist
    c, s = cos(tilt), sin(tilt)
    return TrueImpact(
        stamp=round((since + strike.time) * NANOSECONDS),
        body=name,
        mode=strike.outcome.mode,
        old=() if strike.old is None else contacts[strike.old],
        new=contacts[strike.new],
        approach=-approach(body.new, before)[0],
        half_distance=half_distance(body),
        energy_lost=strike.outcome.energy_lost,
        linear_before=plane.vector(c * before.vx - s * before.vy, s * before.vx + c * before.vy),
        angular_before=plane.spin(before.omega),
        linear_after=plane.vector(c * after.vx - s * after.vy, s * after.vx + c * after.vy),
        angular_after=plane.spin(after.omega),
        border=border,
    )


def half_distance(body: TwoPointBody) -> float:
    """Half the distance of the contacts in m, for one contact its distance from the mass centre."""
    new, old = body.new, body.old
    return hypot(new.x, new.y) if old is None else 0.5 * hypot(new.x - old.x, new.y - old.y)


def border_of(outcome: Outcome) -> float:
    """The smallest relative change with which an impact would have another mode; inf where none was found.

    A change of the friction of both contacts counts against the larger one, a shift of the mass centre or of the new
    contact against the half distance of the contacts (see `mechanics.margins`).
    """
    body = outcome.body
    if body is None:
        return inf
    friction = max(contact.friction for contact in (body.old, body.new) if contact is not None)
    found, size = outcome.margins, half_distance(body)
    least = abs(found.friction.change) / friction if friction > 0.0 else inf
    return min(least, *[abs(one.change) / size for one in (found.center, found.height, found.reach)])


def encode_true_impact(impact: TrueImpact, frame_id: str) -> bytes:
    """A diagnostic_msgs/DiagnosticArray stamped with the impact; every number reads back as the same double."""
    named = {"stamp": str(impact.stamp), "body": impact.body, "mode": impact.mode.name}
    named |= {name: " ".join(map(str, getattr(impact, name))) for name in ("old", "new")}
    named |= {name: repr(float(getattr(impact, name))) for name in _NUMBERS}
    for name in _VECTORS:
        named |= {f"{name}.{axis}": repr(float(part)) for axis, part in zip("xyz", getattr(impact, name), strict=True)}
    status = diagnostic_status(OK, "truth/impact", impact.mode.name, impact.body, pairs_of(named))
    return diagnostic_array(impact.stamp, frame_id, [status])


def decode_true_impacts(data: bytes) -> list[TrueImpact]:
    """The impacts in the bytes of a diagnostic_msgs/DiagnosticArray.

    Raises:
        MalformedMessage: the bytes are no such message, or tell no impacts.
    """
    return truths_of(data, "impact", _impact)


def truths_of(data: bytes, what: str, read: Callable[[dict[str, str]], Happened]) -> list[Happened]:
    """What is read of the values of each status in the bytes of a diagnostic_msgs/DiagnosticArray.

    Raises:
        MalformedMessage: the bytes are no such message, or do not tell `what` they should.
    """
    try:
        return [read(status.values) for status in decode_diagnostic_array(data)]
    except (KeyError, ValueError) as error:
        raise MalformedMessage(f"not a true {what}: {error}") from None


def _impact(values: dict[str, str]) -> TrueImpact:
    contacts = {name: tuple(map(int, values[name].split())) for name in ("old", "new")}
    # Bags of older versions have no border.
    numbers = {name: float({"border": "inf", **values}[name]) for name in _NUMBERS}
    vectors = {name: tuple(float(values[f"{name}.{axis}"]) for axis in "xyz") for name in _VECTORS}
    told: Any = {**contacts, **numbers, **vectors}
    return TrueImpact(stamp=int(values["stamp"]), body=values["body"], mode=Mode[values["mode"]], **told)


def said_of(onset: TrueOnset) -> str:
    """What a body begins to do, in words."""
    return " and ".join(word for word, holds in (("slides", onset.slides), ("lifts", onset.lifts)) if holds)


def encode_true_onset(onset: TrueOnset, frame_id: str) -> bytes:
    """A diagnostic_msgs/DiagnosticArray stamped with the onset."""
    values = {
        "stamp": str(onset.stamp),
        "body": onset.body,
        "slides": "true" if onset.slides else "false",
        "lifts": "true" if onset.lifts else "false",
    }
    status = diagnostic_status(OK, "truth/onset", said_of(onset), onset.body, pairs_of(values))
    return diagnostic_array(onset.stamp, frame_id, [status])


def decode_true_onsets(data: bytes) -> list[TrueOnset]:
    """The onsets in the bytes of a diagnostic_msgs/DiagnosticArray.

    Raises:
        MalformedMessage: the bytes are no such message, or tell no onsets.
    """
    return truths_of(data, "onset", _onset)


def _onset(values: dict[str, str]) -> TrueOnset:
    return TrueOnset(int(values["stamp"]), values["body"], values["slides"] == "true", values["lifts"] == "true")
