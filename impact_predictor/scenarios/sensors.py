"""What sensors of a body tell of a planar motion: samples and inertial measurements at a rate, with noise."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, sin
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanics.motion import PlanarState
from ..prediction.types import Imu, Sample, Vector3
from ..stamps import NANOSECONDS

AT_ONCE: Final = 256
"""Samples that are computed together."""

_NONE: Final = (0.0,) * 36


class MotionPlane(NamedTuple):
    """The plane of a motion: unit vectors along planar x (`ahead`) and y (`up`), and ahead x up (`axis`)."""

    ahead: Vector3
    up: Vector3
    axis: Vector3

    def vector(self, ahead: float, up: float) -> Vector3:
        """A vector of the plane in space."""
        (ax, ay, az), (ux, uy, uz), _ = self
        return ahead * ax + up * ux, ahead * ay + up * uy, ahead * az + up * uz

    def spin(self, omega: float) -> Vector3:
        """A rate of turning (rad/s) in space."""
        x, y, z = self.axis
        return omega * x, omega * y, omega * z


FORWARD: Final = MotionPlane((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
"""x and z of the frame (REP-103): counter-clockwise in it is negative about y."""

ACROSS: Final = MotionPlane((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
"""y and z of the frame: counter-clockwise in it is positive about x, as a ship rolls."""


class Mount(NamedTuple):
    """How the frame of a body moves with it.

    `beside` is the place of the mass centre along the plane's axis in m, `yaw` the turn in rad of the frame about `up`
    where the body's angle is 0, and `center` the mass centre in the frame in m.
    """

    beside: float = 0.0
    yaw: float = 0.0
    center: Vector3 = (0.0, 0.0, 0.0)


class Poses(NamedTuple):
    """Of a body's frame over time: position (n, 3) in m and orientation (n, 4) as x, y, z, w in the world; along its
    own axes the linear velocity (n, 3) in m/s of its origin and the angular one (n, 3) in rad/s.
    """

    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    linear: NDArray[np.float64]
    angular: NDArray[np.float64]


class SensorNoise(NamedTuple):
    """Standard deviations of the white noise of each sample and axis.

    Of odometry: `position` (m), `orientation` (rad), `velocity` (m/s) and `rate` (rad/s); of inertial sensors:
    `orientation`, `gyro` (rad/s) and `accelerometer` (m/s^2).
    """

    position: float = 0.0
    orientation: float = 0.0
    velocity: float = 0.0
    rate: float = 0.0
    accelerometer: float = 0.0
    gyro: float = 0.0


NO_NOISE: Final = SensorNoise()


def poses(state: PlanarState, plane: MotionPlane, mount: Mount) -> Poses:
    """The frame of a body whose mass centre moves as `state` (arrays (n,)) tells, in the world's axes."""
    x, y, angle, vx, vy, omega = state
    ahead, up, axis = (np.array(part) for part in plane)
    to_ahead, to_up, along = _center(plane, mount)
    c, s = np.cos(angle), np.sin(angle)
    dx, dy = c * to_ahead - s * to_up, s * to_ahead + c * to_up
    position = np.outer(x - dx, ahead) + np.outer(y - dy, up) + (mount.beside - along) * axis
    half_c, half_s = np.cos(0.5 * angle), np.sin(0.5 * angle)
    yaw_c, yaw_s = cos(0.5 * mount.yaw), sin(0.5 * mount.yaw)
    qx, qy, qz = (half_s * part for part in plane.axis)
    orientation = np.stack(
        [qx * yaw_c + qy * yaw_s, qy * yaw_c - qx * yaw_s, half_c * yaw_s + qz * yaw_c, half_c * yaw_c - qz * yaw_s], 1
    )
    ahead_speed, up_speed = vx + omega * dy, vy - omega * dx
    turned_back = np.outer(c * ahead_speed + s * up_speed, ahead) + np.outer(c * up_speed - s * ahead_speed, up)
    linear = _unyawed(turned_back, mount.yaw)
    return Poses(position, orientation, linear, np.outer(omega, _unyawed(np.array(plane.axis), mount.yaw)))


def rotations(orientation: NDArray[np.float64]) -> NDArray[np.float64]:
    """The matrices (n, 3, 3) that turn vectors of a frame into the world's, for unit quaternions (n, 4)."""
    x, y, z, w = orientation.T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def rotated(matrices: NDArray[np.float64], vectors: NDArray[np.float64], back: bool = False) -> NDArray[np.float64]:
    """Vectors (n, 3), each by the matrix of its own (n, 3, 3), or by the transposed one."""
    found: NDArray[np.float64] = np.einsum("nji,nj->ni" if back else "nij,nj->ni", matrices, vectors)
    return found


def product(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quaternions (n, 4) that turn as the second ones and then as the first ones do."""
    (x, y, z, w), (a, b, c, d) = first.T, second.T
    return np.stack(
        [
            w * a + x * d + y * c - z * b,
            w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d,
            w * d - x * a - y * b - z * c,
        ],
        axis=1,
    )


def carried(frame: Poses, seen: Poses) -> Poses:
    """In the world, the poses of a body that are `seen` from a frame that moves."""
    deck, own = rotations(frame.orientation), rotations(seen.orientation)
    drift = rotated(own, seen.linear) + frame.linear + np.cross(frame.angular, seen.position)
    return Poses(
        position=frame.position + rotated(deck, seen.position),
        orientation=product(frame.orientation, seen.orientation),
        linear=rotated(own, drift, back=True),
        angular=seen.angular + rotated(own, frame.angular, back=True),
    )


def stamps_of(start: float, end: float, rate: float, last: bool) -> list[int]:
    """The stamps in ns of the samples from `start` (s) on and before `end`, with `last` also at the end."""
    first = int(np.ceil(start * rate - 1e-9))
    after = int(np.floor(end * rate + 1e-9)) + 1 if last else int(np.ceil(end * rate - 1e-9))
    return [round(k * NANOSECONDS / rate) for k in range(first, after)]


class Odometer:
    """Makes samples of a body's frame from its poses."""

    def __init__(
        self, frame: str, child_frame: str, noise: SensorNoise = NO_NOISE, rng: np.random.Generator | None = None
    ) -> None:
        self.frames, self.noise = (frame, child_frame), noise
        self._rng = rng if any((noise.position, noise.orientation, noise.velocity, noise.rate)) else None
        self._of_pose = covariance(noise.position, noise.orientation)
        self._of_twist = covariance(noise.velocity, noise.rate)

    def samples(self, stamps: list[int], seen: Poses) -> Iterator[Sample]:
        """The samples at stamps (ns) from the poses then."""
        noise, rng = self.noise, self._rng
        if rng is not None:
            seen = Poses(
                position=_blurred(seen.position, noise.position, rng),
                orientation=_misaligned(seen.orientation, noise.orientation, rng),
                linear=_blurred(seen.linear, noise.velocity, rng),
                angular=_blurred(seen.angular, noise.rate, rng),
            )
        rows = zip(stamps, *(part.tolist() for part in seen), strict=True)
        for stamp, position, orientation, linear, angular in rows:
            yield Sample(
                stamp,
                *self.frames,
                position=tuple(position),
                orientation=tuple(orientation),
                linear=tuple(linear),
                angular=tuple(angular),
                pose_covariance=self._of_pose,
                twist_covariance=self._of_twist,
            )


class InertialSensor:
    """Makes measurements of an inertial sensor at the origin of a body's frame, with its axes.

    The specific force is the mean over the time of one sample, half of it before and half after the stamp: an impact
    is a peak in it, and the sum of its samples is the change of the velocity.
    """

    def __init__(self, frame: str, noise: SensorNoise = NO_NOISE, rng: np.random.Generator | None = None) -> None:
        self.frame, self.noise = frame, noise
        self._rng = rng if any((noise.orientation, noise.gyro, noise.accelerometer)) else None

    def measurements(self, stamps: list[int], seen: Poses, force: NDArray[np.float64]) -> Iterator[Imu]:
        """The measurements at stamps (ns) from the poses then, and the specific force (n, 3) along the body's axes."""
        noise, rng = self.noise, self._rng
        orientation, angular = seen.orientation, seen.angular
        if rng is not None:
            orientation = _misaligned(orientation, noise.orientation, rng)
            angular = _blurred(angular, noise.gyro, rng)
            force = _blurred(force, noise.accelerometer, rng)
        rows = zip(stamps, orientation.tolist(), angular.tolist(), force.tolist(), strict=True)
        for stamp, quaternion, rates, felt in rows:
            yield Imu(stamp, self.frame, tuple(quaternion), tuple(rates), tuple(felt))


def _center(plane: MotionPlane, mount: Mount) -> tuple[float, float, float]:
    """The mass centre seen from the frame's origin where the body's angle is 0: ahead, up and along the axis."""
    x, y, z = mount.center
    c, s = cos(mount.yaw), sin(mount.yaw)
    arm = np.array((c * x - s * y, s * x + c * y, z))
    ahead, up, axis = (float(arm @ np.array(part)) for part in plane)
    return ahead, up, axis


def _unyawed(vectors: NDArray[np.float64], yaw: float) -> NDArray[np.float64]:
    """Vectors (..., 3) along axes that are turned by `yaw` about z."""
    c, s = cos(yaw), sin(yaw)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([c * x + s * y, c * y - s * x, z], axis=-1)


def _blurred(values: NDArray[np.float64], deviation: float, rng: np.random.Generator) -> NDArray[np.float64]:
    return values + rng.normal(0.0, deviation, values.shape)


def _misaligned(orientation: NDArray[np.float64], deviation: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Unit quaternions (n, 4) after small random turns about every axis of the body, in rad."""
    half = 0.5 * rng.normal(0.0, deviation, (len(orientation), 3))
    turned = orientation + product(orientation, np.pad(half, ((0, 0), (0, 1))))
    unit: NDArray[np.float64] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
    return unit


def covariance(first: float, second: float) -> tuple[float, ...]:
    """A covariance of two triples, each with one deviation."""
    if not (first or second):
        return _NONE
    squares = [first * first] * 3 + [second * second] * 3
    return tuple(squares[row] if row == column else 0.0 for row in range(6) for column in range(6))
