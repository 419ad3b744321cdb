"""Impacts, onsets and landings as a scenario knows them, and the messages in which a bag carries such events.

They travel on topics of their own, as diagnostic_msgs/DiagnosticArray, and are never an input of a prediction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import chain
from math import cos, hypot, inf, sin
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar, get_args, get_type_hints

from ..mechanics.impact import approach
from ..mechanics.types import Mode, Outcome, TwoPointBody
from ..prediction.types import Vector3
from ..prediction.vectors import dot
from ..ros.cdr import OK, MalformedMessage, decode_diagnostic_array, diagnostic_array, diagnostic_status, pairs_of
from ..stamps import NANOSECONDS

if TYPE_CHECKING:
    from ..mechanics.motion import RockingImpact
    from .sensors import MotionPlane

TRUTH_TOPIC: Final = "/truth/impacts"
ONSET_TOPIC: Final = "/truth/onsets"
LANDING_TOPIC: Final = "/truth/landings"

Happened = TypeVar("Happened")


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

    @property
    def said(self) -> str:
        """Its mode, in words."""
        return self.mode.name


class TrueOnset(NamedTuple):
    """The moment at which a body that stood still on its support begins to slide on it, to lift a contact, or both.

    `stamp` in ns; `body` its frame.
    """

    stamp: int
    body: str
    slides: bool
    lifts: bool

    @property
    def said(self) -> str:
        """What the body begins to do, in words."""
        return " and ".join(word for word, holds in (("slides", self.slides), ("lifts", self.lifts)) if holds)


class LandingState(NamedTuple):
    """A machine `time` s after a foot has touched the ground, 0 for the last moment before.

    `twist` of the trunk along its axes, linear of its origin in m/s and angular in rad/s; `rates` of the joints in
    rad/s or m/s, in the order of joint_states; of each foot in the order of the scene its velocity in m/s and the
    impulse in N s that the ground has given to it since, in the axes of the world.
    """

    time: float
    twist: tuple[float, ...]
    rates: tuple[float, ...]
    velocities: tuple[Vector3, ...]
    impulses: tuple[Vector3, ...]


class TrueLanding(NamedTuple):
    """A foot that came to the ground and stayed.

    `stamp` in ns of the first contact; `body` its trunk's frame; `foot` its name; `feet` the names of all, and those of
    them that were `standing`; `normal` of the ground under the foot; the `states` of the machine just before and after
    it. The last one is that of the first peak of the normal force on the foot.
    """

    stamp: int
    body: str
    foot: str
    feet: tuple[str, ...]
    standing: tuple[str, ...]
    normal: Vector3
    states: tuple[LandingState, ...]

    @property
    def said(self) -> str:
        """Its foot."""
        return self.foot

    @property
    def before(self) -> LandingState:
        """The machine just before it."""
        return self.states[0]

    @property
    def after(self) -> tuple[LandingState, ...]:
        """The machine after it."""
        return self.states[1:]

    @property
    def speed(self) -> float:
        """How fast the foot came down, in m/s."""
        return -dot(self.before.velocities[self.feet.index(self.foot)], self.normal)

    def impulse(self, state: LandingState) -> float:
        """What the ground has given to the foot until a state, along the normal, in N s."""
        return dot(state.impulses[self.feet.index(self.foot)], self.normal)


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


def encode_truth(event: TrueImpact | TrueOnset | TrueLanding, frame_id: str) -> bytes:
    """A diagnostic_msgs/DiagnosticArray stamped with the event; every number reads back as the same double."""
    name = type(event).__name__.removeprefix("True").lower()
    status = diagnostic_status(OK, f"truth/{name}", event.said, event.body, pairs_of(dict(_texts(event))))
    return diagnostic_array(event.stamp, frame_id, [status])


def decode_truths(kind: type[Happened], data: bytes) -> list[Happened]:
    """The events of a kind in the bytes of a diagnostic_msgs/DiagnosticArray; MalformedMessage where the bytes are no
    such message, or do not tell what they should.
    """
    try:
        return [_event(kind, status.values) for status in decode_diagnostic_array(data)]
    except (KeyError, ValueError) as error:
        raise MalformedMessage(f"not a {kind.__name__}: {error}") from None


def _row(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(map(float, text.split()))


def _vectors(text: str) -> tuple[Vector3, ...]:
    numbers = iter(_numbers(text))
    return tuple(zip(numbers, numbers, numbers, strict=True))


_TEXTS: Final[dict[Any, tuple[Callable[[Any], str], Callable[[str], Any]]]] = {
    int: (str, int),
    str: (str, str),
    float: (lambda value: repr(float(value)), float),
    bool: (lambda value: "true" if value else "false", "true".__eq__),
    Mode: (lambda mode: str(mode.name), Mode.__getitem__),
    tuple[int, ...]: (lambda row: " ".join(map(str, row)), lambda text: tuple(map(int, text.split()))),
    tuple[str, ...]: (" ".join, lambda text: tuple(text.split())),
    tuple[float, ...]: (_row, _numbers),
    tuple[Vector3, ...]: (lambda rows: _row(chain.from_iterable(rows)), _vectors),
}
"""How the fields of an event are written and read, by their types. A vector has a key for each axis, and the records in
a tuple have keys that begin with their places.
"""

_hints: Final[Callable[[Any], dict[str, Any]]] = cache(get_type_hints)


def _texts(told: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    for name, hint in _hints(type(told)).items():
        key, value = prefix + name, getattr(told, name)
        if hint == Vector3:
            yield from ((f"{key}.{axis}", repr(float(part))) for axis, part in zip("xyz", value, strict=True))
        elif hint in _TEXTS:
            yield key, _TEXTS[hint][0](value)
        else:
            for k, part in enumerate(value):
                yield from _texts(part, f"{k}.")


def _event(kind: Any, values: Mapping[str, str], prefix: str = "") -> Any:
    found: dict[str, Any] = {}
    for name, hint in _hints(kind).items():
        key = prefix + name
        if key in values:
            found[name] = _vectors(values[key])[0] if hint == Vector3 else _TEXTS[hint][1](values[key])
        elif hint == Vector3:
            found[name] = tuple(float(values[f"{key}.{axis}"]) for axis in "xyz")
        elif hint not in _TEXTS:
            part, known = get_args(hint)[0], {other.partition(".")[0] for other in values}
            count = next(k for k in range(len(known) + 1) if str(k) not in known)
            found[name] = tuple(_event(part, values, f"{k}.") for k in range(max(1, count)))
        elif name not in kind._field_defaults:  # bags of older versions have no border
            raise KeyError(key)
    return kind(**found)
