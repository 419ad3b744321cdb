"""The motion of a moving support from what is known of it at one message: at other times, and what is felt there."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import atan2, sin, sqrt
from typing import NamedTuple

from ...mechanics.impact import new_tuple
from ...stamps import NANOSECONDS
from ..types import Felt, Moment, Quaternion, Vector3
from ..vectors import Axes, add, axes_of, combine, cross, dot, times, to_body, turned

NOWHERE: Vector3 = (0.0, 0.0, 0.0)
"""Place, velocity and acceleration of a support that nobody measures."""


class Seen(NamedTuple):
    """What a message tells of a moving support.

    `stamp` in ns; `position` in m and `velocity` in m/s of its origin in the world, 0 where nobody measures them;
    `orientation` in the world, or in some frame that does not turn, with the `axes` it makes; `angular` velocity in
    rad/s along these.
    """

    stamp: int
    position: Vector3
    orientation: Quaternion
    axes: Axes
    velocity: Vector3
    angular: Vector3


class Known(NamedTuple):
    """What is known of it with the messages before: as `Seen`, and the accelerations.

    `acceleration` of the origin in the world in m/s^2, 0 where nobody measures its velocity; the one that is `felt`
    there, gravity less its own, in the frame of the orientation; `turning`, the derivative of the angular velocity,
    along the support's axes.
    """

    stamp: int
    position: Vector3
    orientation: Quaternion
    axes: Axes
    velocity: Vector3
    angular: Vector3
    acceleration: Vector3
    felt: Vector3
    turning: Vector3


def ahead(gravity: Vector3, angular: Vector3, turning: Vector3, time: float) -> Felt:
    """What is felt `time` s later, in the axes of then.

    The acceleration in the world goes on as it is, and so does the angular acceleration along the support's axes:
    exact where the support turns about an axis that keeps its direction.
    """
    rotation = combine(time, angular, 0.5 * time * time, turning, 0.0, angular)
    return Felt(turned_back(gravity, rotation), add(angular, turning, time), turning)


def turned_back(vector: Vector3, rotation: Vector3) -> Vector3:
    """The vector in axes that are turned by a rotation vector (rad): Rodrigues' formula."""
    square = dot(rotation, rotation)
    if square == 0.0:
        return vector
    angle = sqrt(square)
    half = sin(0.5 * angle)
    aside = cross(vector, rotation)
    return add(add(vector, aside, sin(angle) / angle), cross(aside, rotation), 2.0 * half * half / square)


def rotation_between(first: Quaternion, second: Quaternion) -> Vector3:
    """The rotation vector, along the first one's axes, that leads from one orientation to another (rad)."""
    px, py, pz, pw = first
    qx, qy, qz, qw = second
    x = pw * qx - px * qw - py * qz + pz * qy
    y = pw * qy + px * qz - py * qw - pz * qx
    z = pw * qz - px * qy + py * qx - pz * qw
    w = pw * qw + px * qx + py * qy + pz * qz
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    length = sqrt(x * x + y * y + z * z)
    scale = 2.0 * atan2(length, w) / length if length > 0.0 else 2.0
    return scale * x, scale * y, scale * z


def later(known: Known, stamp: int) -> Known:
    """The support at another stamp, before or after, with constant acceleration and angular acceleration."""
    time = (stamp - known.stamp) / NANOSECONDS
    velocity, acceleration = known.velocity, known.acceleration
    rotation = times(add(known.angular, known.turning, 0.5 * time), time)
    orientation = turned(known.orientation, rotation)
    return Known(
        stamp,
        add(known.position, add(velocity, acceleration, 0.5 * time), time),
        orientation,
        axes_of(orientation),
        add(velocity, acceleration, time),
        add(known.angular, known.turning, time),
        acceleration,
        known.felt,
        known.turning,
    )


def between(first: Known, second: Known, stamp: int) -> Known:
    """The support at a stamp between those of two messages: both velocities are met, and what is felt blends over."""
    whole = (second.stamp - first.stamp) / NANOSECONDS
    course = first._replace(
        acceleration=times(add(second.velocity, first.velocity, -1.0), 1.0 / whole),
        turning=times(add(second.angular, first.angular, -1.0), 1.0 / whole),
    )
    part = (stamp - first.stamp) / NANOSECONDS / whole
    return later(course, stamp)._replace(
        acceleration=blend(first.acceleration, second.acceleration, part),
        felt=blend(first.felt, second.felt, part),
        turning=blend(first.turning, second.turning, part),
    )


def blend(first: Vector3, second: Vector3, part: float) -> Vector3:
    return add(first, add(second, first, -1.0), part)


def moment_of(
    known: Known,
    frame_id: str,
    child_frame_id: str,
    gravity: Vector3,
    extrapolate: Callable[[Known], Callable[[float], Felt]] | None = None,
) -> Moment:
    """What the users of a support are told of it; `extrapolate` gives another `ahead` than constant accelerations."""
    axes, angular, turning = known.axes, known.angular, known.turning
    felt = to_body(axes, known.felt)
    now = new_tuple(Felt, (felt, angular, turning))
    on = partial(ahead, felt, angular, turning) if extrapolate is None else extrapolate(known)
    linear = to_body(axes, known.velocity)
    return new_tuple(
        Moment,
        (known.stamp, frame_id, child_frame_id, known.position, known.orientation, linear, now, on, gravity),
    )
