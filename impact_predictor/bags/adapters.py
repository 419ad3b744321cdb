"""Messages of robots' own types as what the predictor takes; docs/adapters.md tells how to add a robot.

Only the name of a type is taken from a bag, and looked up among the adapters that are built in or installed: no bag
decides which code runs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Final, NamedTuple

from ..errors import InputError
from ..prediction.types import Geometry, Joints, Quaternion, Sample, Schedule, Vector3, Wrench
from ..prediction.vectors import add, axes_of, cross, to_body
from ..ros.messages import MalformedMessage
from .read import Bag, UnusableMessage

GROUP: Final = "impact_predictor.adapters"
"""Entry points of this group are adapters, named by the types of their messages."""

BUILT_IN: Final = (EntryPoint("xpp_msgs/msg/RobotStateCartesian", "impact_predictor.bags.adapters:of_xpp", GROUP),)

_UNKNOWN: Final = (0.0,) * 36


class Adapted(NamedTuple):
    """What one message tells; None or () where it does not.

    `stands` says for each foot, in the order of feet.names, whether it truly stands. It is the truth that predictions
    are compared with, and never an input of one.
    """

    sample: Sample | None = None
    geometry: Geometry | None = None
    joints: Joints | None = None
    wrenches: tuple[Wrench, ...] = ()
    schedule: Schedule | None = None
    stands: tuple[bool, ...] = ()


Adapter = Callable[[Any], Adapted]
"""Takes a message with the fields of its definition in the bag; raises ValueError for one that cannot be used."""


def of_world(
    stamp: int,
    position: Vector3,
    orientation: Quaternion,
    linear: Vector3,
    angular: Vector3,
    points: Sequence[Vector3],
    velocities: Sequence[Vector3] = (),
    frame_id: str = "world",
    child_frame_id: str = "base",
) -> tuple[Sample, Geometry]:
    """A body and its contact points, both told in the world, as the sample and the geometry of that stamp (ns).

    The body by the position of its origin in m, its orientation as (x, y, z, w), its linear and angular velocity in m/s
    and rad/s along the axes of the world; the points in m and their velocities in m/s, () where they are not measured.
    ValueError where the orientation is zero, or there are velocities of another number of points.
    """
    if not any(orientation):
        raise ValueError("the orientation is a zero quaternion")
    axes = axes_of(orientation)
    arms = [add(point, position, -1.0) for point in points]
    moving = [
        to_body(axes, add(add(velocity, linear, -1.0), cross(angular, arm), -1.0))
        for arm, velocity in zip(arms, velocities, strict=bool(velocities))
    ]
    twist = to_body(axes, linear), to_body(axes, angular)
    return (
        Sample(stamp, frame_id, child_frame_id, position, orientation, *twist, _UNKNOWN, _UNKNOWN),
        Geometry(stamp, child_frame_id, tuple(to_body(axes, arm) for arm in arms), tuple(moving)),
    )


class AdapterReader(NamedTuple):
    """Reads a message in CDR, through an adapter that is `named` in sentences."""

    named: str
    decode: Callable[[bytes], Any]
    adapt: Adapter

    def __call__(self, data: bytes) -> Adapted:
        """What a message tells; MalformedMessage where its bytes are none of its type, as UnusableMessage where the
        adapter refuses it, and InputError where the adapter fails.
        """
        try:
            message = self.decode(data)
        # The decoder of damaged bytes may raise anything from its depths.
        except Exception as error:
            raise MalformedMessage(_reason(error)) from None
        try:
            adapted = self.adapt(message)
        except ValueError as error:
            raise UnusableMessage(f"the adapter {self.named} refuses it: {_reason(error)}") from None
        # Anything else is no fault of this one message.
        except Exception as error:
            raise InputError(
                f"the adapter {self.named} fails with {type(error).__name__} ({_reason(error)}); "
                "compare it with the definition of the message in the bag"
            ) from error
        if not isinstance(adapted, Adapted):
            raise InputError(f"the adapter {self.named} returns {adapted!r:.80}, not an Adapted")
        return adapted

    def check_stands(self, adapted: Adapted, feet: tuple[str, ...]) -> None:
        """Whether a message that tells which feet stand does so for each of them; InputError where it does not."""
        if len(adapted.stands) not in (0, len(feet)):
            raise InputError(
                f"the adapter {self.named} tells in `stands` of {len(adapted.stands)} feet, but feet.names has "
                f"{len(feet)}; give a flag for each of them in that order, or none"
            )


def known() -> dict[str, EntryPoint]:
    """The adapters by the types of their messages; an installed one goes before one that is built in."""
    return {one.name: one for one in (*BUILT_IN, *entry_points(group=GROUP))}


def readers(bag: Bag, types: Mapping[str, str]) -> dict[str, AdapterReader]:
    """What reads the messages of some topics of a bag, by their types, which have adapters; InputError where an adapter
    cannot be imported, or the bag holds no definition of a type, and while reading where an adapter fails.
    """
    adapters, found = known(), {}
    for topic, decode in bag.decoders(types).items():
        named = f"{adapters[types[topic]].value} of {types[topic]}"
        try:
            found[topic] = AdapterReader(named, decode, adapters[types[topic]].load())
        # A module that is imported may raise anything.
        except Exception as error:
            said = f"the adapter {named} cannot be imported ({_reason(error)}); install its package again, or remove it"
            raise InputError(said) from error
    return found


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()).rstrip(".") or type(error).__name__


def of_xpp(message: Any) -> Adapted:
    """xpp_msgs/RobotStateCartesian: the plan of a legged robot in bags of xpp and TOWR (github.com/leggedrobotics).

    | field | becomes |
    | --- | --- |
    | `time_from_start` | the stamp: the message has no header |
    | `base.pose` | pose of the body in the world |
    | `base.twist`, both parts along the axes of the world | twist, along the axes of the body |
    | `ee_motion[].pos`, `.vel`, in the world | contact points and their velocities, seen from the body |
    | `ee_contact[]`, the plan's own flags | the truth: whether each foot stands |

    The accelerations and the forces of the plan are not read: no sensor of a robot would tell them.
    """
    pose, twist = message.base.pose, message.base.twist
    turn = pose.orientation
    sample, geometry = of_world(
        message.time_from_start.sec * 10**9 + message.time_from_start.nanosec,
        _vector(pose.position),
        (turn.x, turn.y, turn.z, turn.w),
        _vector(twist.linear),
        _vector(twist.angular),
        [_vector(foot.pos) for foot in message.ee_motion],
        [_vector(foot.vel) for foot in message.ee_motion],
    )
    return Adapted(sample, geometry, stands=tuple(map(bool, message.ee_contact)))


def _vector(message: Any) -> Vector3:
    return message.x, message.y, message.z
