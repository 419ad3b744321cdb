"""True landings of feet, and the messages in which a bag carries them: like impacts, they are never an input."""

from __future__ import annotations

from itertools import chain
from typing import Final, NamedTuple

from ..prediction.types import Vector3
from ..prediction.vectors import dot
from ..ros.cdr import OK, diagnostic_array, diagnostic_status, pairs_of
from .truth import truths_of

LANDING_TOPIC: Final = "/truth/landings"


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
    them that were `standing`; `normal` of the ground under the foot; the machine just `before`, and `after` it. The
    last state is that of the first peak of the normal force on the foot.
    """

    stamp: int
    body: str
    foot: str
    feet: tuple[str, ...]
    standing: tuple[str, ...]
    normal: Vector3
    before: LandingState
    after: tuple[LandingState, ...]

    @property
    def speed(self) -> float:
        """How fast the foot came down, in m/s."""
        return -dot(self.before.velocities[self.feet.index(self.foot)], self.normal)

    def impulse(self, state: LandingState) -> float:
        """What the ground has given to the foot until a state, along the normal, in N s."""
        return dot(state.impulses[self.feet.index(self.foot)], self.normal)


def encode_true_landing(landing: TrueLanding, frame_id: str) -> bytes:
    """A diagnostic_msgs/DiagnosticArray stamped with the landing; every number reads back as the same double."""
    named = {"stamp": str(landing.stamp), "body": landing.body, "foot": landing.foot}
    named |= {"feet": " ".join(landing.feet), "standing": " ".join(landing.standing), "normal": _row(landing.normal)}
    for k, state in enumerate((landing.before, *landing.after)):
        named |= {f"{k}.{name}": _row(values) for name, values in _numbers_of(state).items()}
    status = diagnostic_status(OK, "truth/landing", landing.foot, landing.body, pairs_of(named))
    return diagnostic_array(landing.stamp, frame_id, [status])


def decode_true_landings(data: bytes) -> list[TrueLanding]:
    """The landings in the bytes of a diagnostic_msgs/DiagnosticArray.

    Raises:
        MalformedMessage: the bytes are no such message, or tell no landings.
    """
    return truths_of(data, "landing", _landing)


def _landing(values: dict[str, str]) -> TrueLanding:
    count = sum(key.endswith(".time") for key in values)
    before, *after = [_state(values, f"{k}.") for k in range(count)]
    return TrueLanding(
        stamp=int(values["stamp"]),
        body=values["body"],
        foot=values["foot"],
        feet=tuple(values["feet"].split()),
        standing=tuple(values["standing"].split()),
        normal=_vectors(values["normal"])[0],
        before=before,
        after=tuple(after),
    )


def _state(values: dict[str, str], key: str) -> LandingState:
    return LandingState(
        time=float(values[key + "time"]),
        twist=_numbers(values[key + "twist"]),
        rates=_numbers(values[key + "rates"]),
        velocities=_vectors(values[key + "velocities"]),
        impulses=_vectors(values[key + "impulses"]),
    )


def _numbers_of(state: LandingState) -> dict[str, tuple[float, ...]]:
    return {
        "time": (state.time,),
        "twist": state.twist,
        "rates": state.rates,
        "velocities": tuple(chain.from_iterable(state.velocities)),
        "impulses": tuple(chain.from_iterable(state.impulses)),
    }


def _row(values: tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(map(float, text.split()))


def _vectors(text: str) -> tuple[Vector3, ...]:
    numbers = iter(_numbers(text))
    return tuple(zip(numbers, numbers, numbers, strict=True))
