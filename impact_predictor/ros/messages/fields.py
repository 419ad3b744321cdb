"""What `~/prediction` and `~/score` tell: a table for each record, which makes the messages and their documentation.

A field is added by a line in its table, at its place in the message; docs/prediction.md has the same lines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar

from ...mechanics.types import Flag, Mode
from ...prediction.types import (
    Bound,
    Covariance,
    Foot,
    Landing,
    Leftover,
    Prediction,
    Score,
    SpatialTwist,
    Status,
    Touchdown,
    Uncertainty,
    Vector3,
    impulse_at,
)
from ...prediction.vectors import add
from ..cdr import LENGTHS, PADDING, add_pair, string

if TYPE_CHECKING:
    from ...mechanics.margins import Margin, Margins
    from ...prediction.types import PointOutcome

Source = TypeVar("Source")


@dataclass(frozen=True, slots=True)
class Field(Generic[Source]):
    """A value of a message: its key, its unit ("" for a text) and meaning, and how a record tells it.

    A field whose value is None is left out of the message.
    """

    key: str
    unit: str
    meaning: str
    get: Callable[[Source], object]


@lru_cache(maxsize=256, typed=True)
def names(flags: Flag | Leftover) -> str:
    """The names of flags, or NONE."""
    return "|".join(flag.name or "" for flag in type(flags) if flag & flags) or "NONE"


_TEXTS: Final[dict[type, Callable[[Any], str]]] = {
    **dict.fromkeys((str, int), str),
    bool: lambda value: "true" if value else "false",
    tuple: lambda items: " ".join(map(str, items)),
    # What an enumeration makes of `name` takes ten times as long.
    **dict.fromkeys((Covariance, Mode, Status), attrgetter("_name_")),
    **dict.fromkeys((Flag, Leftover), names),
}


def text(value: object) -> str:
    """A value as a message has it: flags separated by "|", items of a tuple by spaces; every number reads back."""
    known = _TEXTS.get(type(value))
    # What else there is are numbers, perhaps those of NumPy.
    return repr(float(value)) if known is None else known(value)  # type: ignore[arg-type]


class Table(Generic[Source]):
    """The fields of a record, in the order of the message."""

    def __init__(self, *fields: Field[Source]) -> None:
        self.fields = fields
        self._prepared = [(string(field.key), field.get) for field in fields]

    def add_to(self, pairs: list[bytes], record: Source) -> None:
        """Append the keys and values of a record to those of a status (see `add_pair`)."""
        for key, get in self._prepared:
            value = get(record)
            if type(value) is float:
                # `add_pair` written out, for most values are numbers: it makes a message a tenth cheaper.
                raw = repr(value).encode()
                size = len(raw)
                pairs += (key, LENGTHS[size], raw, PADDING[size & 3])
            elif value is not None:
                add_pair(pairs, key, text(value))


PREDICTION: Final = Table[Prediction](
    Field("status", "", "what became of the sample", lambda it: it.status),
    Field("stamp", "ns", "of the sample", lambda it: it.sample.stamp),
    Field(
        "mode",
        "",
        "of the impact; NO_IMPACT where no touchdown lies within the horizon",
        lambda it: Mode.NO_IMPACT if it.touchdown is None else it.touchdown.mode,
    ),
)
"""Of each sample; without a touchdown there is no more."""


def _each(touchdown: Touchdown, get: Callable[[PointOutcome], object]) -> tuple[object, ...] | None:
    return tuple(map(get, touchdown.contacts)) or None


def _state(contact: PointOutcome) -> str:
    return contact.state.name


def _impulses(touchdown: Touchdown) -> tuple[float, ...] | None:
    return tuple([part for one in touchdown.contacts for part in one.impulse]) or None


def _lifts(touchdown: Touchdown) -> tuple[object, ...] | None:
    chances = _each(touchdown, lambda one: one.lift_probability)
    return None if chances is None or None in chances else chances


def _twist_6d(prefix: str, meaning: str, get: Callable[[Source], SpatialTwist | None]) -> Iterator[Field[Source]]:
    """The fields of a whole twist."""
    for part, unit in enumerate(("m/s", "rad/s")):
        for k, axis in enumerate("xyz"):

            def value(record: Source, part: int = part, k: int = k) -> object:
                twist = get(record)
                return twist and float(twist[part][k])

            yield Field(f"{prefix}.{'vw'[part]}{axis}", unit, f"{meaning}: {axis}", value)


BOUNDS: Final = ", ".join(bound.value for bound in Bound)


def _bound(record: Touchdown | Foot) -> str | None:
    return record.bound and record.bound.value


def _of_drives(touchdown: Touchdown) -> float | None:
    return touchdown.drives * touchdown.impulses[1][0] if touchdown.drives else None


def _change(touchdown: Touchdown) -> SpatialTwist | None:
    (before, spun), (after, spins) = touchdown.before_6d, touchdown.after_6d
    return touchdown.bound and SpatialTwist(add(after, before, -1.0), add(spins, spun, -1.0))


def _vector(key: str, unit: str, meaning: str, get: Callable[[Source], Vector3 | None]) -> Iterator[Field[Source]]:
    """The fields of a vector, left out where there is none."""
    for k, axis in enumerate("xyz"):

        def value(record: Source, k: int = k) -> object:
            vector = get(record)
            return vector and vector[k]

        yield Field(f"{key}.{axis}", unit, f"{meaning}: {axis}" if k == 0 else f"its {axis}", value)


TOUCHDOWN: Final = Table[Touchdown](
    Field("law", "", "path or total", lambda it: it.law),
    Field("unique", "", "whether the law has one answer", lambda it: it.unique),
    Field("flags", "", "what is odd about the impact, or NONE", lambda it: it.flags),
    Field("leftover", "", "why the touchdown is no planar two-point impact, or NONE", lambda it: it.leftover),
    Field("segments", "", "contact states along the impulse, old contact first", lambda it: it.segments),
    Field("old", "", "indices of the points that stand", lambda it: it.old),
    Field("new", "", "indices of the points that strike", lambda it: it.new),
    Field("lead_time", "s", "from the stamp of the sample to the touchdown", lambda it: it.lead_time),
    Field("before.vx", "m/s", "mass centre right before the impact, along the support", lambda it: it.before.vx),
    Field("before.vy", "m/s", "the same along the normal", lambda it: it.before.vy),
    Field("before.omega", "rad/s", "angular velocity before, minus that about the axis", lambda it: it.before.omega),
    Field("after.vx", "m/s", "mass centre right after the impact, along the support", lambda it: it.after.vx),
    Field("after.vy", "m/s", "the same along the normal", lambda it: it.after.vy),
    Field("after.omega", "rad/s", "angular velocity after, minus that about the axis", lambda it: it.after.omega),
    Field("energy_lost", "J", "energy lost in the impact", lambda it: it.energy_lost),
    Field("impulse.old.normal", "N s", "on the old contact", lambda it: it.impulses[0][0]),
    Field("impulse.old.tangent", "N s", "on the old contact", lambda it: it.impulses[0][1]),
    Field("impulse.new.normal", "N s", "on the new contact", lambda it: it.impulses[1][0]),
    Field("impulse.new.tangent", "N s", "on the new contact", lambda it: it.impulses[1][1]),
    Field("axis.x", "1", "unit vector about which the body turns, in the world: its x", lambda it: it.axis[0]),
    Field("axis.y", "1", "its y", lambda it: it.axis[1]),
    Field("axis.z", "1", "its z", lambda it: it.axis[2]),
    Field("half_distance", "m", "half the distance of the two contacts", lambda it: it.half_distance),
    Field("off_axis", "1", "part of the angular velocity off the axis, 0 to 1", lambda it: it.off_axis),
    Field("lateral", "m/s", "velocity along the axis", lambda it: it.lateral),
    Field(
        "closing_spread", "s", "between the closing of the two ends of the striking edge", lambda it: it.closing_spread
    ),
    Field("offset", "m", "of the contacts from the plane of the mass centre", lambda it: it.offset),
    Field("kind", "", "what stands and what strikes", lambda it: it.kind),
    Field("contacts", "", "indices of the points that take part", lambda it: _each(it, lambda one: one.point)),
    Field("states", "", "what each of them does: LEAVES, SLIPS, STICKS or NEARS", lambda it: _each(it, _state)),
    Field("impulses", "N s", "on each of them: x y z in the world", _impulses),
    Field("lifts", "1", "probability that each of them leaves, with uncertainty.samples", _lifts),
    *_twist_6d("before_6d", "whole twist right before, in the support's frame", lambda it: it.before_6d),
    *_twist_6d("after_6d", "whole twist right after, in the support's frame", lambda it: it.after_6d),
    Field("bound", "", f"what the impulses of feet are: {BOUNDS}", _bound),
    Field("impulse.drives", "N s", "part of impulse.new.normal that the drives' gains make", _of_drives),
    *_twist_6d("trunk", "what the impact changes of the twist of a machine with feet", _change),
    Field("joints", "", "names of the joints of robot.urdf", lambda it: it.joints or None),
    Field("joint_jumps", "rad/s", "changes of their velocities in the impact", lambda it: it.jumps or None),
)
"""Of the touchdown ahead."""


def _probability(mode: Mode) -> Field[Uncertainty]:
    return Field(f"probability.{mode.name}", "1", "of this mode", lambda it: it.probabilities[mode])


UNCERTAINTY: Final = Table[Uncertainty](
    Field("covariance", "", "that of the sample's twist was USED or REFUSED", lambda it: it.given),
    *map(_probability, sorted(Mode)),
    Field("mean.vx", "m/s", "mean of after.vx", lambda it: it.mean.vx),
    Field("mean.vy", "m/s", "mean of after.vy", lambda it: it.mean.vy),
    Field("mean.omega", "rad/s", "mean of after.omega", lambda it: it.mean.omega),
    Field("deviation.vx", "m/s", "standard deviation of after.vx", lambda it: it.deviation.vx),
    Field("deviation.vy", "m/s", "standard deviation of after.vy", lambda it: it.deviation.vy),
    Field("deviation.omega", "rad/s", "standard deviation of after.omega", lambda it: it.deviation.omega),
)
"""How sure the impact is, where the scene has `uncertainty.samples`."""


def _margin(
    name: str, unit: str, change: str, get: Callable[[Margins], Margin]
) -> tuple[Field[Margins], Field[Margins]]:
    """The nearest change that changes the mode, and the mode beyond."""

    def beyond(margins: Margins) -> object:
        mode = get(margins).mode
        return "NONE" if mode is None else mode

    nearest = f"nearest {change} that changes the mode, up or down, or inf"
    return (
        Field(f"margin.{name}", unit, nearest, lambda it: get(it).change),
        Field(f"margin.{name}.mode", "", "the mode beyond, or NONE", beyond),
    )


MARGINS: Final = Table["Margins"](
    *_margin("friction", "1", "change of the friction of both contacts", lambda it: it.friction),
    *_margin("center", "m", "shift of the mass centre along the line of the contacts", lambda it: it.center),
    *_margin("height", "m", "shift of the mass centre across that line", lambda it: it.height),
    *_margin("reach", "m", "shift of the new contact along the support", lambda it: it.reach),
    *_margin("slip", "m/s", "change of the velocity of the old contact along the support", lambda it: it.slip),
)
"""How far the impact is from another mode, where the scene has `margins: true`."""

FOOT: Final = Table[Foot](
    Field("name", "", "of the foot", lambda it: it.name),
    Field("stands", "", "whether it stands, as its motion shows", lambda it: it.stands),
    Field("since", "ns", "stamp from which it does, 0 from the beginning", lambda it: it.since),
    Field("gap", "m", "of its lowest point above the ground", lambda it: it.gap),
    Field("approach", "m/s", "speed at which that point nears the ground", lambda it: it.approach),
    Field(
        "lead_time", "s", "until it lands; left out where no landing lies within the horizon", lambda it: it.lead_time
    ),
    Field("landing_speed", "m/s", "speed at which it lands", lambda it: it.landing_speed),
    Field("landing_deviation", "s", "standard deviation of lead_time", lambda it: it.landing_deviation),
    Field("lands", "", "probability that it lands within the horizon", lambda it: it.lands),
    Field("strikes", "", "probability that it strikes, and does not brake to rest", lambda it: it.strikes),
    Field("late", "s", "after the planned landing; left out without a plan", lambda it: it.late),
    Field("confirmed", "", "whether its force sensor agrees; left out without one", lambda it: it.confirmed),
    *_vector("place", "m", "where it lands, in the frame of the sample", lambda it: it.place),
    *_vector("impulse", "N s", "what it gets in the touchdown ahead, in that frame", lambda it: it.impulse),
    Field("bound", "", f"what this impulse is: {BOUNDS}", _bound),
)
"""Of each foot of a walking machine, in a status of its own."""


def _of_touchdown(*keys: str, new: tuple[str, ...] = ()) -> tuple[Field[Score], ...]:
    """Fields of the touchdown that is scored, perhaps by new keys."""
    fields = {field.key: field for field in TOUCHDOWN.fields}
    return tuple(map(_of_score, [fields[key] for key in keys], new or keys))


def _of_score(field: Field[Touchdown], key: str) -> Field[Score]:
    return Field(key, field.unit, field.meaning, lambda score: field.get(score.touchdown))


def _lift(which: int, name: str) -> Iterator[Field[Score]]:
    """The fields of whether a contact lifts."""
    for key, meaning in (
        ("told", "whether it was predicted to lift"),
        ("measured", "whether it has lifted"),
        ("probability", "that it lifts, as predicted"),
    ):

        def value(score: Score, key: str = key) -> object:
            lift = score.spatial and score.spatial.lifts[which]
            return lift and getattr(lift, key)

        yield Field(
            f"lift.{name}.{key}", "1" if key == "probability" else "", f"of the {name} contact: {meaning}", value
        )


SCORE: Final = Table[Score](
    Field("stamp", "ns", "of the predicted touchdown; of a foot, when it came to stand", lambda it: it.stamp),
    Field("mode", "", "that was predicted", lambda it: it.touchdown.mode),
    Field("scored", "", "whether the record can tell", lambda it: it.scored),
    Field("leftover", "", "why it cannot, or NONE", lambda it: it.leftover),
    *_of_touchdown("flags", "law", "old", "new"),
    Field("announced", "s", "lead time of the first prediction", lambda it: it.announced),
    *_of_touchdown("lead_time", "half_distance", "off_axis", "lateral", "closing_spread", "offset"),
    *_of_touchdown("before.vx", "before.vy", "before.omega"),
    *_of_touchdown(*("after.vx", "after.vy", "after.omega"), new=("predicted.vx", "predicted.vy", "predicted.omega")),
    Field(
        "measured.vx", "m/s", "what the samples after it show, as after.vx", lambda it: it.measured and it.measured.vx
    ),
    Field("measured.vy", "m/s", "as after.vy", lambda it: it.measured and it.measured.vy),
    Field("measured.omega", "rad/s", "as after.omega", lambda it: it.measured and it.measured.omega),
    Field(
        "relative_error",
        "1",
        "of the predicted twist; left out where there is nothing to compare",
        lambda it: it.relative_error,
    ),
    Field("kind", "", "what stood and what struck", lambda it: it.kind),
    Field("leftover_6d", "", "why the whole twist is not scored, or NONE", lambda it: it.leftover_6d),
    Field(
        "time_error", "s", "by which the touchdown was predicted too late", lambda it: getattr(it.spatial, "late", None)
    ),
    *_twist_6d("before_6d", "the whole twist before, in the support's frame", lambda it: it.before_6d),
    *_twist_6d(
        "predicted_6d",
        "as predicted, when it is measured",
        lambda it: getattr(it.spatial, "predicted", None),
    ),
    *_twist_6d(
        "measured_6d", "between the second and the third frame after", lambda it: getattr(it.spatial, "measured", None)
    ),
    Field("relative_error_6d", "1", "of the whole predicted twist", lambda it: getattr(it.spatial, "error", None)),
    *_lift(0, "old"),
    *_lift(1, "new"),
)
"""Of a touchdown that has happened; first in the impact plane."""


def _of_landing(landing: Landing) -> Vector3 | None:
    return landing.impact and impulse_at(landing.impact, landing.impact.new)


LANDING: Final = Table[Landing](
    Field("foot", "", "that has landed", lambda it: it.foot),
    Field("late", "s", "after the plan; left out without one", lambda it: it.late),
    Field("confirmed", "", "whether its force sensor agrees; left out without one", lambda it: it.confirmed),
    Field("speed", "m/s", "of the foot in its last frame in the air", lambda it: it.speed),
    Field("point", "", "heel or toe; left out for all of a foot", lambda it: it.point),
    Field("time_error", "s", "of the last announcement", lambda it: float(it.history[-1][1]) if it.history else None),
    *_vector("impulse", "N s", "at the foot, of the impact with that speed, in the frame of the sample", _of_landing),
    Field("bound", "", f"what this impulse is: {BOUNDS}", lambda it: it.impact and _bound(it.impact)),
)
"""Of a foot that has landed, besides its impact."""
