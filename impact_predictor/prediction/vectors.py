"""Vectors of three floats, and rotations of them."""

from __future__ import annotations

import operator
import sys
from collections.abc import Iterable, Sequence
from functools import lru_cache, reduce
from math import atan2, cos, sin, sqrt

from .types import Quaternion, Vector3

Axes = tuple[Vector3, Vector3, Vector3]
"""A body's axes in the world frame."""


if sys.version_info >= (3, 12):

    def total(values: Iterable[float]) -> float:
        """The sum from the first to the last, rounded at each step, so that every Python gives the same bits.

        From Python 3.12 on `sum` compensates its rounding, before that it does not. No values give the float 0.0.
        """
        return reduce(operator.add, values, 0.0)

else:

    def total(values: Iterable[float]) -> float:
        return sum(values, 0.0)


def lines(times: Sequence[float], columns: Iterable[Sequence[float]]) -> list[tuple[float, float]]:
    """The straight line nearest to the values of each column at some times (least squares): its value at time zero, and
    its slope.
    """
    count = len(times)
    middle = total(times) / count
    arms = [time - middle for time in times]
    spread = 0.0
    for arm in arms:
        spread += arm * arm
    found = []
    for column in columns:
        whole = turning = 0.0
        # Machine code makes a loop of numbers of a list, and calls Python for a zip that is strict.
        values = list(column)
        for k in range(count):
            value = values[k]
            whole += value
            turning += arms[k] * value
        slope = turning / spread
        found.append((whole / count - middle * slope, slope))
    return found


def dot(u: Vector3, v: Vector3) -> float:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u: Vector3, v: Vector3) -> Vector3:
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def add(u: Vector3, v: Vector3, scale: float = 1.0) -> Vector3:
    """u + scale v."""
    return u[0] + scale * v[0], u[1] + scale * v[1], u[2] + scale * v[2]


def combine(a: float, u: Vector3, b: float, v: Vector3, c: float, w: Vector3) -> Vector3:
    """a u + b v + c w."""
    return (
        a * u[0] + b * v[0] + c * w[0],
        a * u[1] + b * v[1] + c * w[1],
        a * u[2] + b * v[2] + c * w[2],
    )


def mean(vectors: list[Vector3]) -> Vector3:
    count = len(vectors)
    if count == 1:
        return vectors[0]
    return (
        total([v[0] for v in vectors]) / count,
        total([v[1] for v in vectors]) / count,
        total([v[2] for v in vectors]) / count,
    )


def times(u: Vector3, scale: float) -> Vector3:
    return u[0] * scale, u[1] * scale, u[2] * scale


def any_across(u: Vector3) -> Vector3:
    """The coordinate axis that lies most across u."""
    x, y, z = abs(u[0]), abs(u[1]), abs(u[2])
    if x <= y and x <= z:
        return 1.0, 0.0, 0.0
    return (0.0, 1.0, 0.0) if y <= z else (0.0, 0.0, 1.0)


def axes_of(orientation: Quaternion) -> Axes:
    """The body's axes in the world frame, from the quaternion (x, y, z, w)."""
    x, y, z, w = orientation
    double = 2.0 / (x * x + y * y + z * z + w * w)
    dx, dy, dz = double * x, double * y, double * z
    xx, yy, zz = dx * x, dy * y, dz * z
    xy, xz, yz = dx * y, dx * z, dy * z
    wx, wy, wz = dx * w, dy * w, dz * w
    return (
        (1.0 - yy - zz, xy + wz, xz - wy),
        (xy - wz, 1.0 - xx - zz, yz + wx),
        (xz + wy, yz - wx, 1.0 - xx - yy),
    )


def to_world(axes: Axes, vector: Vector3) -> Vector3:
    """A vector of the body frame in the world frame."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = axes
    u, v, w = vector
    return u * ax + v * bx + w * cx, u * ay + v * by + w * cy, u * az + v * bz + w * cz


def applied(rows: Axes, vector: Vector3) -> Vector3:
    """A matrix, row by row, times a vector."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    x, y, z = vector
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def to_body(axes: Axes, vector: Vector3) -> Vector3:
    """A vector of the world frame in the body frame."""
    # Another name for `applied` would do, but machine code calls it as Python does, with each number an object.
    return applied(axes, vector)


@lru_cache(maxsize=16)
def inverse(matrix: Axes) -> Axes:
    """The inverse of a symmetric matrix."""
    a, b, c = matrix
    columns = cross(b, c), cross(c, a), cross(a, b)
    scale = 1.0 / dot(a, columns[0])
    return times(columns[0], scale), times(columns[1], scale), times(columns[2], scale)


def tensor_to_world(axes: Axes, tensor: Axes) -> Axes:
    """A tensor of the body frame, row by row, in the world frame: R I R^T."""
    columns = [to_world(axes, row) for row in tensor]
    rows = [to_world(axes, (columns[0][i], columns[1][i], columns[2][i])) for i in range(3)]
    return rows[0], rows[1], rows[2]


def six_numbers(tensor: Axes) -> tuple[float, float, float, float, float, float]:
    """The numbers xx, yy, zz, xy, xz, yz of a symmetric tensor."""
    x, y, z = tensor
    return x[0], y[1], z[2], x[1], x[2], y[2]


def turned(orientation: Quaternion, rotation: Vector3) -> Quaternion:
    """The unit quaternion after a rotation about a vector of the body frame, by its length in rad."""
    angle = sqrt(dot(rotation, rotation))
    scale = sin(0.5 * angle) / angle if angle > 0.0 else 0.5
    qx, qy, qz = times(rotation, scale)
    qw = cos(0.5 * angle)
    x, y, z, w = composed(orientation, (qx, qy, qz, qw))
    unit = 1.0 / sqrt(x * x + y * y + z * z + w * w)
    return x * unit, y * unit, z * unit, w * unit


def turn_to(direction: Vector3) -> Quaternion:
    """The shortest rotation that turns z to a unit vector."""
    x, y, z = direction
    if z < -1.0 + 1e-12:
        return 1.0, 0.0, 0.0, 0.0
    # Half way between both: their cross product and 1 + their scalar product, made a unit.
    unit = 1.0 / sqrt(2.0 * (1.0 + z))
    return -y * unit, x * unit, 0.0, (1.0 + z) * unit


def rotation_between(first: Quaternion, second: Quaternion, rate: float = 1.0) -> Vector3:
    """The rotation vector in rad, along the first one's axes, that leads from one orientation to another, times a rate.

    Both signs of a quaternion are one orientation: the shorter turn is meant.
    """
    x, y, z, w = composed(conjugate(first), second)
    length = sqrt(x * x + y * y + z * z)
    scale = (2.0 * atan2(length, abs(w)) / length if length > 0.0 else 2.0) * (rate if w >= 0.0 else -rate)
    return x * scale, y * scale, z * scale


def composed(first: Quaternion, second: Quaternion) -> Quaternion:
    """The product of two quaternions: the orientation in the world of what is turned by `second` in a frame that is
    turned by `first`.
    """
    px, py, pz, pw = first
    qx, qy, qz, qw = second
    return (
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
        pw * qw - px * qx - py * qy - pz * qz,
    )


def conjugate(rotation: Quaternion) -> Quaternion:
    """The rotation back."""
    x, y, z, w = rotation
    return -x, -y, -z, w
