"""What an adapter makes of a message."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

from ...prediction.types import Geometry, Joints, Quaternion, Sample, Schedule, Vector3, Wrench
from ...prediction.vectors import add, axes_of, cross, to_body

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

    Raises:
        ValueError: the orientation is zero, or there are velocities of another number of points.
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
