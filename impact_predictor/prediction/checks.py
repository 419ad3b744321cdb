"""Whether a message can be taken: its numbers, its stamp, its points; and what to do where it cannot."""

from __future__ import annotations

from itertools import islice
from math import isfinite
from operator import index
from typing import Any, Final

from ..errors import InputError
from .types import Quaternion, Sample, Status, Vector3
from .vectors import dot

PAUSE: Final = 250_000_000  # ns without a message, or by which a clock goes back, after which a stream begins anew
LARGEST: Final = 1e24
"""Sum of the squares of position, velocity and angular velocity beyond which no body is and products overflow."""

UNIT: Final = 1e-3  # how far the square of a quaternion's length may be from 1; float32 sources stay below 1e-6
COUNTS: Final = {
    "position": 3, "orientation": 4, "linear": 3, "angular": 3, "pose_covariance": 36, "twist_covariance": 36
}  # fmt: skip
"""How many numbers the fields of a sample have."""
COINCIDENT: Final = 1e-9  # points closer than this part of the largest coordinate are one


def check_numbers(sample: Sample) -> Status:
    """Whether the numbers of a sample are those of a body.

    Raises:
        TypeError, ValueError, IndexError: they are not told as those of a `Sample` are; `in_floats` tells them so.
    """
    if not isinstance(sample.stamp, int):
        raise TypeError("the stamp is no int")
    position, linear, angular = sample.position, sample.linear, sample.angular
    size = dot(position, position) + dot(linear, linear) + dot(angular, angular)
    # False for NaN as well. A sum of finite covariances may overflow: drivers fill in the largest double.
    if not size < LARGEST or not (
        isfinite(sum(sample.pose_covariance, 0.0) + sum(sample.twist_covariance, 0.0))
        or all(map(isfinite, sample.pose_covariance + sample.twist_covariance))
    ):
        return Status.NOT_FINITE
    return check_orientation(sample.orientation)


def with_motion(
    sample: Sample,
    stamp: int,
    frame_id: str,
    position: Vector3,
    orientation: Quaternion,
    linear: Vector3,
    angular: Vector3,
) -> Sample:
    """A sample with another motion. `_replace` takes thrice as long, which is a tenth of a sample over a deck."""
    covariances = sample.pose_covariance, sample.twist_covariance
    return Sample(stamp, frame_id, sample.child_frame_id, position, orientation, linear, angular, *covariances)


def in_floats(sample: Any) -> Sample:
    """A sample in floats, whose numbers are told in lists or in arrays.

    Raises:
        InputError: a field is nothing of the kind.
    """
    told: dict[str, Any] = {}
    for name, count in COUNTS.items():
        value = getattr(sample, name)
        try:
            told[name] = tuple([float(number) for number in value])
        except (TypeError, ValueError):
            told[name] = ()
        if len(told[name]) != count:
            raise InputError(f"{name} of a sample is {value!r}; give {count} numbers")
    try:
        stamp = index(sample.stamp)
    except TypeError:
        raise InputError(f"the stamp of a sample is {sample.stamp!r}; give whole nanoseconds") from None
    return Sample(stamp=stamp, frame_id=sample.frame_id, child_frame_id=sample.child_frame_id, **told)


def check_orientation(orientation: Quaternion) -> Status:
    """Whether a quaternion is one of a rotation."""
    x, y, z, w = orientation
    if -UNIT < x * x + y * y + z * z + w * w - 1.0 < UNIT:
        return Status.ACCEPTED
    return Status.BAD_QUATERNION if all(map(isfinite, orientation)) else Status.NOT_FINITE


def order_of(stamp: int, last: int | None) -> Status:
    """Whether a stamp follows the last one of its stream."""
    if last is None or stamp > last:
        return Status.ACCEPTED
    return Status.STAMP_REPEATED if stamp == last else Status.STAMP_WENT_BACK


def followed(stamp: int, last: int | None) -> tuple[Status, int | None]:
    """As `order_of`, and the last stamp of the stream then: None where it begins anew after its clock went back."""
    status = order_of(stamp, last)
    if status is Status.ACCEPTED:
        return status, stamp
    return status, None if last is not None and last - stamp > PAUSE else last


def check_points(points: tuple[Vector3, ...], most: int) -> Status:
    """Whether points can be contact points: at least two and at `most` so many, finite, and no two of them one."""
    if len(points) > most:
        return Status.TOO_MANY_POINTS
    if not sum([dot(point, point) for point in points], 0.0) < LARGEST:
        return Status.NOT_FINITE
    if len(points) < 2:
        return Status.TOO_FEW_POINTS
    least = COINCIDENT * max([max(abs(x), abs(y), abs(z)) for x, y, z in points])
    ordered = sorted(points)
    for i, (x, y, z) in enumerate(ordered, 1):
        for u, v, w in islice(ordered, i, None):
            if u - x > least:
                break
            if abs(y - v) <= least and abs(z - w) <= least:
                return Status.COINCIDENT_POINTS
    return Status.ACCEPTED


REMEDIES: Final[dict[Status, str]] = {
    Status.NOT_FINITE: "a field is NaN or infinite; look at its source",
    Status.BAD_QUATERNION: "the orientation is missing, zero or not of unit length; look at its source",
    Status.STAMP_REPEATED: "the stamp is that of the message before; let a single source publish, with its own stamps",
    Status.STAMP_WENT_BACK: "the stamp is older than the one before; let a single source publish, in order",
    Status.WRONG_FRAME: "its frame is not that of the scene; compare frame_id with support.frame, and child_frame_id "
    "with the frame of the contact points",
    Status.NO_GEOMETRY: "no contact points are known; publish them on contact_geometry or give body.contact_points, or "
    "where robot.urdf is given publish joint_states",
    Status.TOO_FEW_POINTS: "a body needs at least two contact points",
    Status.COINCIDENT_POINTS: "two of its points coincide",
    Status.TOO_MANY_POINTS: "it has more points than contact.most_points; publish those that can touch the ground, or "
    "raise it",
    Status.NO_TRANSFORM: "no transform leads from its frames to support.frame and tf.body_frame; look at /tf and "
    "/tf_static, and at their stamps",
    Status.MALFORMED: "its bytes are not a message of the topic's type; look at who else publishes there",
    Status.NO_SUPPORT: "nothing is known of the support's motion yet; look whether its source publishes",
    Status.SUPPORT_STALE: "the support's last message is too old; look whether its source still publishes",
    Status.CLOCKS_APART: "the stamps of body and support are too far apart; let both sources stamp by one clock",
    Status.SUPPORT_JUMPED: "the support's pose or twist does not follow from those before; look at its source, which "
    "is trusted again when new messages agree",
    Status.GRAVITY_WRONG: "what lies on the support would fall off it, or feels far more or less than gravity; compare "
    "the axes and the sign of the support's source with gravity and support.normal",
    Status.OFF_SUPPORT: "the body is beyond the support's edges or far above it; if it is not, compare its frame and "
    "support.extent",
    Status.BELOW_SUPPORT: "the body lies deeper in the support than noise puts it; compare its frame, its contact "
    "points and support.height",
    Status.BODY_STALE: "no message of the body's source, or none any more; look whether it still publishes",
    Status.GEOMETRY_STALE: "the last contact points are too old, or were never told; look whether their source still "
    "publishes, and by the same clock",
    Status.FEET_CHANGED: "the message has another number of points than feet.names x feet.points; correct these, or "
    "the message",
    Status.BELOW_GROUND: "a foot lies deeper in the ground than noise puts it; compare support.height, the units of "
    "the points (m), and the frames of body and points",
    Status.WRONG_JOINTS: "a joint of robot.urdf is missing, or is there twice; compare the names",
    Status.SINGULAR_INERTIA: "the robot's inertia matrix has no inverse; look for links without mass in robot.urdf",
}
"""What to say of each status but ACCEPTED."""
