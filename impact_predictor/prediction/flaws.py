"""What is wrong with a message that was refused, as far as more can be said of it than its status says."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite, sqrt
from typing import Any, Final

from ..wording import listed
from .checks import LARGEST, check_orientation
from .monitor import SPOILT, Monitor
from .predictor import Predictor
from .types import FeetStates, Geometry, Imu, Joints, Sample, Schedule, Status, Terrain, Transform, Wrench

_MOST_NAMED: Final = 4
_OR_TF: Final = ", or give tf.body_frame where /tf connects them"


def flaw_of(monitor: Monitor, body: str | None, status: Status, message: Any) -> str:
    """What is wrong with a message that a monitor has just refused, as far as more is known; else "".

    `body` is None where it is about the support, and `message` where its bytes are none of its type.
    """
    if status is Status.NO_TRANSFORM and monitor.tree is not None:
        return monitor.tree.flaw
    if status in SPOILT:
        # Transforms come several at a time.
        parts = message if type(message) is tuple else (message,)
        return next((said for one in parts if (said := _spoilt(status, one))), "")
    if status is Status.STAMP_REPEATED and getattr(message, "stamp", None) == 0:
        return "its stamp is 0, as the one before: fill in header.stamp of all messages"
    predictor = None if body is None else monitor.predictors.get(body)
    if predictor is None:
        return _other_support(monitor, message) if status is Status.WRONG_FRAME else ""
    contacts, walking = predictor.contacts, predictor.scene.walking
    if status is Status.WRONG_FRAME:
        return _wrong_frame(predictor, message)
    if status is Status.BELOW_GROUND and contacts.depth is not None:
        return (
            f"the lowest foot lies {contacts.depth:.3g} m below the ground: compare support.height, the units of the "
            "points (m), and the frames of body and points"
        )
    if status is Status.FEET_CHANGED and isinstance(message, Schedule):
        return "joint_names has a name that is none of feet.names"
    if status is Status.FEET_CHANGED and isinstance(message, FeetStates) and walking is not None:
        each, has = "once" if walking.points == 1 else "twice", listed(message.names, _MOST_NAMED) or "none"
        return f"joint_names must have each of {listed(walking.feet, _MOST_NAMED)} {each}, but has {has}"
    if status is Status.FEET_CHANGED and isinstance(message, Geometry) and walking is not None:
        number, wanted = len(message.points), len(walking.feet) * walking.points
        if number == wanted:
            return f"{len(message.velocities)} velocities came with {number} points: give one for each, or none"
        return (
            f"{number} points came, but feet.names ({len(walking.feet)}) x feet.points ({walking.points}) wants "
            f"{wanted}: correct these, or the message"
        )
    if status is Status.WRONG_JOINTS and isinstance(message, Joints):
        lacking = [name for name in contacts.joints if name not in message.names]
        if not lacking:
            return "a joint is there twice, or without its position: tell each joint once, with its position"
        unknown = [name for name in message.names if name not in contacts.joints]
        others = f", while robot.urdf does not know its {listed(unknown, _MOST_NAMED)}" if unknown else ""
        lacks = listed(lacking, _MOST_NAMED)
        return f"it lacks {lacks} of robot.urdf{others}: tell every joint of the model by its name there"
    return ""


def _spoilt(status: Status, message: Any) -> str:
    """Which field of a message is bad in itself; "" where it is another's."""
    whose = f"{message.child_frame_id!r} in {message.frame_id!r}: " if isinstance(message, Transform) else ""
    if status is Status.BAD_QUATERNION:
        told = message.orientation
        if told is None:
            return "orientation_covariance[0] is -1, so no orientation is measured, but this input needs one"
        shown = ", ".join([f"{number:g}" for number in told])
        is_bad = check_orientation(told) is status
        return f"{whose}orientation is ({shown}), not of unit length: look at its source" if is_bad else ""
    bad = [one for one in _numbers(message) if not abs(one[1]) < sqrt(LARGEST)]
    # Covariances may be as large as they like.
    name, number = min(bad, key=lambda one: isfinite(one[1]), default=("", 0.0))
    return f"{whose}{name} is {number:g}: look at its source" if bad else ""


def _numbers(told: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """The numbers of a message, each with the field and the place in which it stands, from 0."""
    if isinstance(told, float):
        yield name, told
    elif isinstance(told, tuple):
        fields = getattr(told, "_fields", None) or [f"{name}[{k}]" for k in range(len(told))]
        for field, value in zip(fields, told, strict=True):
            yield from _numbers(value, field)


def _other_support(monitor: Monitor, message: Any) -> str:
    if monitor.deck is None or not isinstance(message, Sample | Imu):
        return ""
    frame, child = monitor.deck.frames
    told = (message.frame_id, message.child_frame_id) if isinstance(message, Sample) else ("", message.frame_id)
    return f"it tells of {told[1]!r} in {told[0]!r}, but those before of {child!r} in {frame!r}: one source may tell"


def _wrong_frame(predictor: Predictor, message: Any) -> str:
    if isinstance(message, Wrench):
        return f"frame_id is {message.frame_id!r}, which is none of feet.names"
    if isinstance(message, Terrain):
        return f"frame_id is {message.frame_id!r}, but support.frame is {predictor.scene.frame!r}"
    if not isinstance(message, Sample):
        return ""
    frames = predictor.frames
    if frames and message.frame_id not in frames:
        named = " or ".join(map(repr, frames))
        return f"frame_id is {message.frame_id!r}, but {named} is wanted: correct it, or support.frame{_OR_TF}"
    child, points = message.child_frame_id, predictor.contacts.frame_id
    return f"child_frame_id is {child!r}, but the contact points are in {points!r}: let both be one{_OR_TF}"
