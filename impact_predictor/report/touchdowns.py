"""Touchdowns that have happened, landings of feet among them: their record, and the fields that files have of it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from operator import sub
from typing import TYPE_CHECKING, Annotated, Any, Final, NamedTuple, get_type_hints

from ..mechanics.types import Mode, Twist, Vector
from ..prediction.skill import SIMPLE
from ..prediction.spatial_score import Lift
from ..prediction.types import Landing, Leftover, PointOutcome, Score
from ..scenarios.comparison import LEAD_TIMES

if TYPE_CHECKING:
    from ..bags.body import Settled


Numbers = tuple[float, ...]


class TouchdownField(NamedTuple):
    """A field of a touchdown in files: its type and its unit.

    Types are those of Arrow, and mode, twist (vx, vy, omega), twist_6d (vx, vy, vz, wx, wy, wz), impulse (normal,
    tangential), lift (told, measured, probability), simple (the errors of `SIMPLE` answers), and json, which only the
    JSON has. `message` is its key in `~/score` where that is another one; `of_foot` is for landings alone.
    """

    type: str
    unit: str = ""
    message: str = ""
    of_foot: bool = False


class TouchdownRow(NamedTuple):
    """One settled touchdown, which is a landing where it has a `foot`; docs/replay.md explains what files have of it.

    Times in s but `stamp` in ns, lengths in m, twists of the mass centre in the impact plane (m/s, rad/s), impulses
    (normal, tangential) in N s; None is what is not known. `old` and `new` are the points that stood and that struck;
    `flags` say what a reader should know and, where it is not `scored`, why. `time_errors` of a landing are those of
    the predictions made `LEAD_TIMES` before it, `simple_time_error` that of the gap over its speed
    at the first of these, and `cost` is that of the last prediction. Whole twists, in the support's frame, are scored
    unless `not_scored_6d` says why not.
    """

    body: Annotated[str, TouchdownField("string")]
    stamp: Annotated[int, TouchdownField("int64", "ns")]
    announced_lead_time: Annotated[float, TouchdownField("float64", "s", message="announced")]
    lead_time: Annotated[float, TouchdownField("float64", "s")]
    mode: Annotated[Mode, TouchdownField("mode")]
    before_twist: Annotated[Twist, TouchdownField("twist", message="before")]
    predicted_twist: Annotated[Twist, TouchdownField("twist", message="predicted")]
    half_distance: Annotated[float, TouchdownField("float64", "m")]
    out_of_plane: Annotated[float, TouchdownField("float64", "1", message="off_axis")]
    scored: Annotated[bool, TouchdownField("bool")]
    flags: Annotated[tuple[str, ...], TouchdownField("list<string>")]
    old: Annotated[tuple[int, ...], TouchdownField("list<int32>")]
    new: Annotated[tuple[int, ...], TouchdownField("list<int32>")]
    measured_twist: Annotated[Twist | None, TouchdownField("twist", message="measured")] = None
    relative_error: Annotated[float | None, TouchdownField("float64", "1")] = None
    kind: Annotated[str, TouchdownField("string")] = ""
    before_twist_6d: Annotated[Numbers | None, TouchdownField("twist_6d", message="before_6d")] = None
    predicted_twist_6d: Annotated[Numbers | None, TouchdownField("twist_6d", message="predicted_6d")] = None
    measured_twist_6d: Annotated[Numbers | None, TouchdownField("twist_6d", message="measured_6d")] = None
    relative_error_6d: Annotated[float | None, TouchdownField("float64", "1")] = None
    not_scored_6d: Annotated[tuple[str, ...], TouchdownField("list<string>", message="leftover_6d")] = (
        "MOVING_CONTACTS",
    )
    simple_errors_6d: Annotated[Numbers | None, TouchdownField("simple", "1")] = None
    lift_old: Annotated[tuple[Any, ...] | None, TouchdownField("lift", message="lift.old")] = None
    lift_new: Annotated[tuple[Any, ...] | None, TouchdownField("lift", message="lift.new")] = None
    contacts: Annotated[tuple[dict[str, Any], ...], TouchdownField("json")] = ()
    mode_probabilities: Annotated[dict[str, float] | None, TouchdownField("json")] = None
    time_error: Annotated[float | None, TouchdownField("float64", "s")] = None
    foot: Annotated[str, TouchdownField("string", of_foot=True)] = ""
    point: Annotated[str | None, TouchdownField("string", of_foot=True)] = None
    late: Annotated[float | None, TouchdownField("float64", "s", of_foot=True)] = None
    confirmed: Annotated[bool | None, TouchdownField("bool", of_foot=True)] = None
    landing_speed: Annotated[float | None, TouchdownField("float64", "m/s", message="speed", of_foot=True)] = None
    landing_mode: Annotated[Mode | None, TouchdownField("mode", of_foot=True)] = None
    impulse: Annotated[Vector | None, TouchdownField("impulse", "N s", of_foot=True)] = None
    others_impulse: Annotated[Vector | None, TouchdownField("impulse", "N s", of_foot=True)] = None
    bound: Annotated[str | None, TouchdownField("string", of_foot=True)] = None
    velocity_change: Annotated[Twist | None, TouchdownField("twist", of_foot=True)] = None
    time_errors: tuple[float | None, ...] = ()
    simple_time_error: float | None = None
    cost: float | None = None

    @property
    def error(self) -> float | None:
        """The relative error of what is scored in the impact plane."""
        return self.relative_error if self.scored else None

    @property
    def error_6d(self) -> float | None:
        """The relative error of what is scored as a whole twist."""
        return None if self.not_scored_6d else self.relative_error_6d

    @property
    def best_error(self) -> float | None:
        """That of the whole twist, or else in the impact plane; None where neither is scored."""
        return self.error if self.error_6d is None else self.error_6d

    @property
    def is_scored(self) -> bool:
        """Whether the record tells how right it was."""
        return self.best_error is not None

    @property
    def is_on_points(self) -> bool:
        """Whether it is one that may be scored as a whole twist."""
        return not self.foot and "MOVING_CONTACTS" not in self.not_scored_6d

    @property
    def why_not_scored(self) -> tuple[str, ...]:
        """Why it is not scored, as a whole twist where it may be; the names of `Leftover`."""
        if self.is_on_points:
            return self.not_scored_6d
        return () if self.scored else tuple([flag for flag in self.flags if flag in Leftover.__members__])

    @property
    def ahead(self) -> float | None:
        """How long before it in s the first prediction was made; None of a landing that none announced."""
        return None if self.foot and self.time_error is None else self.announced_lead_time

    @property
    def is_second(self) -> bool:
        """Whether another part of the foot stood already."""
        return self.point is not None and any(one // 2 == self.new[0] // 2 for one in self.old)


FIELDS: Final[dict[str, TouchdownField]] = {
    name: hint.__metadata__[0]
    for name, hint in get_type_hints(TouchdownRow, include_extras=True).items()
    if hasattr(hint, "__metadata__")
}
"""Those of a row that files have, by their keys in the JSON."""
PARTS: Final[dict[str, tuple[str, ...]]] = {
    "twist": Twist._fields,
    "twist_6d": ("vx", "vy", "vz", "wx", "wy", "wz"),
    "impulse": ("normal", "tangential"),
    "lift": Lift._fields,
    "simple": tuple(SIMPLE),
}
"""What the JSON has as a list: what each element is, by the type of the field."""
_NO_LANDING: Final = Landing("", 0, None, None, ())


def row_of(body: str, score: Score, cost: float | None = None) -> TouchdownRow:
    """The row of a score; `cost` in s."""
    touchdown, landing = score.touchdown, score.landing or _NO_LANDING
    impact = landing.impact
    flags = [flag for flags in (score.leftover, touchdown.flags) for flag in type(flags) if flag & flags]
    spatial, sure = score.spatial, touchdown.uncertainty
    before, predicted, measured = [
        None if twist is None else (*twist.linear, *twist.angular)
        for twist in (score.before_6d, getattr(spatial, "predicted", None), getattr(spatial, "measured", None))
    ]
    lifts = (None, None) if spatial is None else spatial.lifts
    return TouchdownRow(
        body=body,
        stamp=score.stamp,
        announced_lead_time=score.announced,
        lead_time=touchdown.lead_time,
        mode=touchdown.mode,
        before_twist=touchdown.before,
        predicted_twist=touchdown.after,
        measured_twist=score.measured,
        half_distance=touchdown.half_distance,
        relative_error=score.relative_error,
        out_of_plane=touchdown.off_axis,
        scored=score.scored,
        flags=tuple(flag.name or "" for flag in flags),
        old=tuple(touchdown.old),
        new=tuple(touchdown.new),
        cost=cost,
        foot=landing.foot,
        point=landing.point,
        kind=score.kind,
        before_twist_6d=before,
        predicted_twist_6d=predicted,
        measured_twist_6d=measured,
        relative_error_6d=getattr(spatial, "error", None),
        not_scored_6d=tuple(flag.name or "" for flag in Leftover if flag & score.leftover_6d),
        simple_errors_6d=spatial.simple_errors if spatial and not score.leftover_6d else None,
        lift_old=lifts[0] and tuple(lifts[0]),
        lift_new=lifts[1] and tuple(lifts[1]),
        contacts=tuple(map(_contact, touchdown.contacts)),
        mode_probabilities=sure and {mode.name: sure.probabilities[mode] for mode in Mode if sure.probabilities[mode]},
        time_error=landing.history[-1][1] if landing.history else getattr(spatial, "late", None),
        late=landing.late,
        confirmed=landing.confirmed,
        landing_speed=landing.speed,
        time_errors=tuple(error_ahead(landing.history, lead_time) for lead_time in LEAD_TIMES) if score.landing else (),
        simple_time_error=error_ahead(landing.gap_over_speed, LEAD_TIMES[0]),
        landing_mode=impact and impact.mode,
        impulse=impact and impact.impulses[1],
        others_impulse=impact.impulses[0] if impact and impact.old else None,
        bound=impact and impact.bound and impact.bound.value,
        velocity_change=impact and Twist(*map(sub, impact.after, impact.before)),
    )


def _contact(point: PointOutcome) -> dict[str, Any]:
    return {
        "point": point.point,
        "role": "new" if point.is_new else "old",
        "impulse": [*map(float, point.impulse)],
        "state": point.state.name,
        "lift_probability": point.lift_probability,
    }


def error_ahead(history: Iterable[tuple[float, float]], lead_time: float) -> float | None:
    """Error in s of the time predicted a lead time (s) before a landing, or last before that; None if none was."""
    made = [error for ahead, error in history if ahead >= lead_time]
    return made[-1] if made else None


def rows_of(settled: Iterable[Settled]) -> list[TouchdownRow]:
    """The rows of touchdowns in the order of their stamps."""
    return sorted((row_of(*one) for one in settled), key=lambda row: row.stamp)


def row_as_json(row: TouchdownRow) -> dict[str, Any]:
    """A row as the JSON of a replay has it; that of a landing has errors of its times, too, which no message tells."""
    values = {key: getattr(row, key) for key, field in FIELDS.items() if row.foot or not field.of_foot}
    values |= {key: getattr(row, key) for key in ("time_errors", "simple_time_error") if row.foot}
    return {key: value.name if isinstance(value, Mode) else value for key, value in values.items()}


def row_of_json(entry: Mapping[str, Any]) -> TouchdownRow:
    """The row that `row_as_json` wrote; KeyError or TypeError where it is none."""
    values: dict[str, Any] = {}
    for key, field in FIELDS.items():
        if (value := entry.get(key)) is not None:
            if field.type == "mode":
                value = Mode[value]
            elif isinstance(value, list):
                value = Twist(*value) if field.type == "twist" else tuple(value)
            values[key] = value
    return TouchdownRow(**values)


def row_of_message(body: str, values: Mapping[str, str], cost: float | None = None) -> TouchdownRow:
    """The row of the values of a message on `~/score`, as `decode_diagnostic_array` reads them; `cost` in s. KeyError,
    TypeError or ValueError where it is none.
    """
    entry: dict[str, Any] = {"body": body}
    for key, field in FIELDS.items():
        sent, parts = field.message or key, PARTS.get(field.type, ())
        if parts and f"{sent}.{parts[0]}" in values:
            entry[key] = [json.loads(values.get(f"{sent}.{part}", "null")) for part in parts]
        elif sent in values:
            is_number = field.type in ("int64", "float64", "bool")
            entry[key] = json.loads(values[sent]) if is_number else values[sent]
    for key in ("old", "new"):
        entry[key] = [*map(int, values[key].split())]
    entry["flags"] = [flag for key in ("leftover", "flags") for flag in values[key].split("|") if flag != "NONE"]
    whole = values.get("leftover_6d", "MOVING_CONTACTS")
    entry["not_scored_6d"] = [flag for flag in whole.split("|") if flag != "NONE"]
    return row_of_json(entry)._replace(cost=cost)
