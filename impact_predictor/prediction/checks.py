"""Whether a message can be taken: its numbers, its stamp, the points that it tells."""

from __future__ import annotations

from math import isfinite

from .types import Sample, Status, Vector3
from .vectors import dot

PAUSE = 250_000_000
"""ns without a message, or by which a clock goes back, after which a stream begins anew."""

LARGEST = 1e24
"""Sum of the squares of position, velocity and angular velocity beyond which no body is and products overflow."""

UNIT = 1e-3
"""How far the square of a quaternion's length may be from 1; float32 sources stay below 1e-6."""

COINCIDENT = 1e-9
"""Points closer than this part of the largest coordinate are one."""


def check_numbers(sample: Sample) -> Status:
    """Whether the numbers of a sample are those of a body."""
    position, linear, angular = sample.position, sample.linear, sample.angular
    size = dot(position, position) + dot(linear, linear) + dot(angular, angular)
    # False for NaN as well. A sum of finite covariances may overflow: drivers fill in the largest double.
    if not size < LARGEST or not (
        isfinite(sum(sample.pose_covariance) + sum(sample.twist_covariance))
        or all(map(isfinite, sample.pose_covariance + sample.twist_covariance))
    ):
        return Status.NOT_FINITE
    x, y, z, w = sample.orientation
    if not -UNIT < x * x + y * y + z * z + w * w - 1.0 < UNIT:
        return Status.BAD_QUATERNION if all(map(isfinite, sample.orientation)) else Status.NOT_FINITE
    return Status.ACCEPTED


def order_of(stamp: int, last: int | None) -> Status:
    """Whether a stamp follows the last one of its stream."""
    if last is None or stamp > last:
        return Status.ACCEPTED
    return Status.STAMP_REPEATED if stamp == last else Status.STAMP_WENT_BACK


def check_points(points: tuple[Vector3, ...]) -> Status:
    """Whether points can be contact points: at least two, finite, and no two of them one."""
    if not sum([dot(point, point) for point in points]) < LARGEST:
        return Status.NOT_FINITE
    if len(points) < 2:
        return Status.TOO_FEW_POINTS
    least = COINCIDENT * max([max(abs(x), abs(y), abs(z)) for x, y, z in points])
    for i, (x, y, z) in enumerate(points):
        for u, v, w in points[:i]:
            if abs(x - u) <= least and abs(y - v) <= least and abs(z - w) <= least:
                return Status.COINCIDENT_POINTS
    return Status.ACCEPTED
