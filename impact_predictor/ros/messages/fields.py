"""What `~/prediction` and `~/score` tell: a table for each record, which makes messages of both forms and their docs.

A field is added by a line in its table, at its place in the diagnostic array, and by its name in a message of `typed`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final

from ...mechanics.types import Mode
from ...prediction.foot import impulse_at
from ...prediction.skill import SIMPLE
from ...prediction.types import Bound, Landing, Prediction, Score, SpatialTwist, Touchdown, Vector3
from ...prediction.vectors import add
from ..cdr import LENGTHS, PADDING, add_pair, string
from .kinds import (
    ANSWER,
    BOUND,
    CHOICE,
    FLAGS,
    IMPULSES,
    INDICES,
    LIFT,
    MARGIN,
    NUMBER,
    NUMBERS,
    PLANAR_TWIST,
    POINT,
    PROBABILITIES,
    SIMPLE_ERRORS,
    STAMP,
    TEXT,
    TEXTS,
    TRUTH,
    TWIST,
    VECTOR,
    Field,
    Kind,
    field,
    text,
)

if TYPE_CHECKING:
    from ...prediction.spatial_score import Lift


def add_value(pairs: list[bytes], key: bytes, value: object) -> None:
    """Append a value to the pairs of a status (see `add_pair`); of None nothing is told."""
    if isinstance(value, float):
        # `add_pair` written out, for most values are numbers: it makes a message a tenth cheaper.
        raw = repr(float(value)).encode()
        size = len(raw)
        pairs.append(key)
        pairs.append(LENGTHS[size])
        pairs.append(raw)
        pairs.append(PADDING[size & 3])
    elif value is not None:
        add_pair(pairs, key, text(value))


class Table:
    """The fields of a record, in the order of the diagnostic array."""

    def __init__(self, title: str, *fields: Field) -> None:
        self.title, self.fields = title, {field.key: field for field in fields}
        self._prepared = [([string(one.key + end) for end in one.kind.ends], one.get, one.kind.told) for one in fields]

    def add_to(self, pairs: list[bytes], record: Any) -> None:
        """Append the keys and values of a record to those of a status (see `add_pair`)."""
        for keys, get, told in self._prepared:
            found = get(record)
            if found is None:
                continue
            if told is None:
                add_value(pairs, keys[0], found)
            else:
                for k, value in enumerate(told(found)):
                    add_value(pairs, keys[k], value)


def _mode(prediction: Prediction) -> Mode:
    return Mode.NO_IMPACT if prediction.touchdown is None else prediction.touchdown.mode


PREDICTION: Final = Table(
    "of each sample",
    field("status", CHOICE, "", "what became of the sample"),
    field("stamp", STAMP, "ns", "of the sample", "sample.stamp"),
    field("mode", CHOICE, "", "of the impact; NO_IMPACT where no touchdown lies within the horizon", _mode),
)
"""Of each sample; without a touchdown there is no more."""


def _of_each(get: Callable[[Any], object], touchdown: Touchdown) -> tuple[object, ...] | None:
    """What is got of each contact; None where there are no contacts, or nobody knows it of one."""
    each = tuple([get(one) for one in touchdown.contacts])
    return None if None in each else each or None


def _unless_empty(get: Callable[[Any], Any], touchdown: Touchdown) -> Any:
    return get(touchdown) or None


def _impulses(touchdown: Touchdown) -> tuple[float, ...] | None:
    return tuple([part for one in touchdown.contacts for part in one.impulse]) or None


def _of_drives(touchdown: Touchdown) -> float | None:
    return touchdown.drives * touchdown.impulses[1][0] if touchdown.drives else None


def _change(touchdown: Touchdown) -> SpatialTwist | None:
    (before, spun), (after, spins) = touchdown.before_6d, touchdown.after_6d
    return touchdown.bound and SpatialTwist(add(after, before, -1.0), add(spins, spun, -1.0))


_BOUNDS: Final = ", ".join([bound.value for bound in Bound])
_IN_PLANE: Final = "along the support, along its normal, and angular velocity, minus that about the axis"

TOUCHDOWN: Final = Table(
    "with a touchdown within the horizon",
    field("law", TEXT, "", "path or total"),
    field("unique", TRUTH, "", "whether the law has one answer"),
    field("flags", FLAGS, "", "what is odd about the impact, or NONE"),
    field("leftover", FLAGS, "", "why the touchdown is no planar two-point impact, or NONE"),
    field("segments", TEXTS, "", "contact states along the impulse, old contact first"),
    field("old", INDICES, "", "indices of the points that stand"),
    field("new", INDICES, "", "indices of the points that strike"),
    field("lead_time", NUMBER, "s", "from the stamp of the sample to the touchdown"),
    field("before", PLANAR_TWIST, "m/s, rad/s", f"mass centre right before the impact: {_IN_PLANE}"),
    field("after", PLANAR_TWIST, "m/s, rad/s", f"mass centre right after the impact: {_IN_PLANE}"),
    field("energy_lost", NUMBER, "J", "energy lost in the impact"),
    field("impulse", IMPULSES, "N s", "on the old contact along normal and tangent, then on the new one", "impulses"),
    field("axis", VECTOR, "1", "unit vector about which the body turns, in the world"),
    field("half_distance", NUMBER, "m", "half the distance of the two contacts"),
    field("off_axis", NUMBER, "1", "part of the angular velocity off the axis, 0 to 1"),
    field("lateral", NUMBER, "m/s", "velocity along the axis"),
    field("closing_spread", NUMBER, "s", "between the closing of the two ends of the striking edge"),
    field("offset", NUMBER, "m", "of the contacts from the plane of the mass centre"),
    field("kind", TEXT, "", "what stands and what strikes"),
    field("contacts", INDICES, "", "indices of the points that take part", partial(_of_each, attrgetter("point"))),
    field(
        "states",
        TEXTS,
        "",
        "what each of them does: LEAVES, SLIPS, STICKS or NEARS",
        partial(_of_each, attrgetter("state.name")),
    ),
    field("impulses", NUMBERS, "N s", "on each of them: x y z in the world", _impulses),
    field(
        "lifts",
        NUMBERS,
        "1",
        "probability that each of them leaves, with uncertainty.samples",
        partial(_of_each, attrgetter("lift_probability")),
    ),
    field("before_6d", TWIST, "m/s, rad/s", "twist of the mass centre right before, in the support's frame"),
    field("after_6d", TWIST, "m/s, rad/s", "twist of the mass centre right after, in the support's frame"),
    field("bound", BOUND, "", f"what the impulses of feet are: {_BOUNDS}"),
    field(
        "impulse.drives",
        NUMBER,
        "N s",
        "part of the normal impulse on the new contact that the drives' gains make",
        _of_drives,
    ),
    field("trunk", TWIST, "m/s, rad/s", "what the impact changes of the twist of a machine with feet", _change),
    field("joints", TEXTS, "", "names of the joints of robot.urdf", partial(_unless_empty, attrgetter("joints"))),
    field(
        "joint_jumps",
        NUMBERS,
        "rad/s",
        "changes of their velocities in the impact",
        partial(_unless_empty, attrgetter("jumps")),
    ),
)
"""Of the touchdown ahead."""

UNCERTAINTY: Final = Table(
    "with `uncertainty.samples`",
    field("covariance", CHOICE, "", "that of the sample's twist was USED or REFUSED", "given"),
    field("probability", PROBABILITIES, "1", "of each mode, by its number", "probabilities"),
    field("mean", PLANAR_TWIST, "m/s, rad/s", "mean of after"),
    field("deviation", PLANAR_TWIST, "m/s, rad/s", "standard deviation of after"),
)
"""How sure the impact is, where the scene has `uncertainty.samples`."""


def _margin(name: str, unit: str, change: str) -> Field:
    """The nearest change that changes the mode, and the mode beyond."""
    nearest = f"nearest {change} that changes the mode, up or down, or inf; and the mode beyond, or NONE"
    return field(f"margin.{name}", MARGIN, unit, nearest, name)


MARGINS: Final = Table(
    "with `margins: true`",
    _margin("friction", "1", "change of the friction of both contacts"),
    _margin("center", "m", "shift of the mass centre along the line of the contacts"),
    _margin("height", "m", "shift of the mass centre across that line"),
    _margin("reach", "m", "shift of the new contact along the support"),
    _margin("slip", "m/s", "change of the velocity of the old contact along the support"),
)
"""How far the impact is from another mode, where the scene has `margins: true`."""

FOOT: Final = Table(
    "of each foot of a walking machine, in a status of its own",
    field("name", TEXT, "", "of the foot"),
    field("stands", TRUTH, "", "whether it stands, as its motion shows"),
    field("since", STAMP, "ns", "stamp from which it does, 0 from the beginning"),
    field("gap", NUMBER, "m", "of its lowest point above the ground"),
    field("approach", NUMBER, "m/s", "speed at which that point nears the ground"),
    field("lead_time", NUMBER, "s", "until it lands; not known where no landing lies within the horizon"),
    field("landing_speed", NUMBER, "m/s", "speed at which it lands"),
    field("landing_deviation", NUMBER, "s", "standard deviation of lead_time"),
    field("lands", NUMBER, "1", "probability that it lands within the horizon"),
    field("strikes", NUMBER, "1", "probability that it strikes, and does not brake to rest"),
    field("late", NUMBER, "s", "after the planned landing; not known without a plan"),
    field("confirmed", ANSWER, "", "whether its force sensor agrees; not known without one"),
    field("place", POINT, "m", "where it lands, in the frame of the sample"),
    field("impulse", VECTOR, "N s", "what it gets in the touchdown ahead, in that frame"),
    field("bound", BOUND, "", f"what this impulse is: {_BOUNDS}"),
)
"""Of each foot of a walking machine, in a status of its own."""


def _scored(key: str) -> Field:
    """A field of the touchdown that is scored."""
    one = TOUCHDOWN.fields[key]
    return one._replace(get=attrgetter(f"touchdown.{key}"))


def _of_spatial(name: str, score: Score) -> Any:
    return getattr(score.spatial, name, None)


def _spatial(key: str, kind: Kind, unit: str, meaning: str, name: str) -> Field:
    """A field of the score of the whole twist, where there is one."""
    return field(key, kind, unit, meaning, partial(_of_spatial, name))


def _lift(which: int, score: Score) -> Lift | None:
    return None if score.spatial is None else score.spatial.lifts[which]


_LIFTS: Final = "whether it was predicted to lift, whether it has lifted, and the probability that was predicted"


def _simple(score: Score) -> tuple[float, ...] | None:
    return score.spatial.simple_errors if score.spatial and not score.leftover_6d else None


_ANSWERS: Final = ", ".join(SIMPLE.values())


SCORE: Final = Table(
    "of each touchdown that has happened",
    field("stamp", STAMP, "ns", "of the predicted touchdown; of a foot, when it came to stand"),
    field("mode", CHOICE, "", "that was predicted", "touchdown.mode"),
    field("scored", TRUTH, "", "whether the record can tell"),
    field("leftover", FLAGS, "", "why it cannot, or NONE"),
    *map(_scored, ("flags", "law", "old", "new")),
    field("announced", NUMBER, "s", "lead time of the first prediction"),
    *map(_scored, ("lead_time", "half_distance", "off_axis", "lateral", "closing_spread", "offset", "before")),
    _scored("after")._replace(key="predicted"),
    field("measured", PLANAR_TWIST, "m/s, rad/s", "what the samples after it show, as predicted"),
    field("relative_error", NUMBER, "1", "of the predicted twist; not known where there is nothing to compare"),
    field("kind", TEXT, "", "what stood and what struck"),
    field("leftover_6d", FLAGS, "", "why the whole twist is not scored, or NONE"),
    _spatial("time_error", NUMBER, "s", "by which the touchdown was predicted too late", "late"),
    field("before_6d", TWIST, "m/s, rad/s", "twist of the mass centre before, in the support's frame"),
    _spatial("predicted_6d", TWIST, "m/s, rad/s", "as predicted, when it is measured", "predicted"),
    _spatial("measured_6d", TWIST, "m/s, rad/s", "between the second and the third frame after", "measured"),
    _spatial("relative_error_6d", NUMBER, "1", "of the whole predicted twist", "error"),
    field("simple_errors_6d", SIMPLE_ERRORS, "1", f"those of simple answers, where it is scored: {_ANSWERS}", _simple),
    field("lift.old", LIFT, "1", f"of the old contact: {_LIFTS}", partial(_lift, 0)),
    field("lift.new", LIFT, "1", f"of the new contact: {_LIFTS}", partial(_lift, 1)),
)
"""Of a touchdown that has happened; first in the impact plane."""


def _last_error(landing: Landing) -> float | None:
    return float(landing.history[-1][1]) if landing.history else None


def _impulse_of_landing(landing: Landing) -> Vector3 | None:
    return landing.impact and impulse_at(landing.impact, landing.impact.new)


def _bound_of_landing(landing: Landing) -> Bound | None:
    return landing.impact and landing.impact.bound


LANDING: Final = Table(
    "of a foot that has landed",
    field("foot", TEXT, "", "that has landed"),
    field("late", NUMBER, "s", "after the plan; not known without one"),
    field("confirmed", ANSWER, "", "whether its force sensor agrees; not known without one"),
    field("speed", NUMBER, "m/s", "of the foot in its last frame in the air"),
    field("point", TEXT, "", "heel or toe; not told for all of a foot"),
    field("time_error", NUMBER, "s", "of the last announcement", _last_error),
    field(
        "impulse",
        VECTOR,
        "N s",
        "at the foot, of the impact with that speed, in the frame of the sample",
        _impulse_of_landing,
    ),
    field("bound", BOUND, "", f"what this impulse is: {_BOUNDS}", _bound_of_landing),
)
"""Of a foot that has landed, besides its impact."""

TABLES: Final = {
    "~/prediction": (PREDICTION, TOUCHDOWN, UNCERTAINTY, MARGINS, FOOT),
    "~/score": (SCORE, LANDING),
}
"""What each of both topics tells."""
