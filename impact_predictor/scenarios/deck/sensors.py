"""What sensors of a body tell of a planar motion: samples and inertial measurements at a rate, with noise."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from ...mechanics.motion import PlanarState
from ...prediction.types import Imu, Sample
from ...stamps import NANOSECONDS
from ..space import Mount, Plane, Poses, in_frame, origin_velocity, poses
from .sea import Array

AT_ONCE: Final = 256
"""Samples that are computed together."""

_NONE: Final = (0.0,) * 36


class Noise(NamedTuple):
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


NO_NOISE: Final = Noise()


def stamps_of(start: float, end: float, rate: float, last: bool) -> list[int]:
    """The stamps in ns of the samples from `start` (s) on and before `end`, with `last` also at the end."""
    first = int(np.ceil(start * rate - 1e-9))
    after = int(np.floor(end * rate + 1e-9)) + 1 if last else int(np.ceil(end * rate - 1e-9))
    return [round(k * NANOSECONDS / rate) for k in range(first, after)]


class Odometer:
    """Makes samples of a body's frame from its planar states in the world."""

    def __init__(
        self,
        frame: str,
        child_frame: str,
        plane: Plane,
        mount: Mount,
        noise: Noise = NO_NOISE,
        rng: np.random.Generator | None = None,
    ) -> None:
        self.frames = frame, child_frame
        self.plane, self.mount, self.noise, self._rng = plane, mount, noise, rng
        of_pose, of_twist = (noise.position, noise.orientation), (noise.velocity, noise.rate)
        self._covariances = _covariance(*of_pose), _covariance(*of_twist)

    def samples(self, stamps: list[int], state: PlanarState) -> Iterator[Sample]:
        """The samples at stamps (ns) from the states then, arrays (n,)."""
        seen = self._blurred(poses(state, self.plane, self.mount))
        of_pose, of_twist = self._covariances
        rows = zip(stamps, *(part.tolist() for part in seen), strict=True)
        for stamp, position, orientation, linear, angular in rows:
            yield Sample(
                stamp,
                *self.frames,
                tuple(position),
                tuple(orientation),
                tuple(linear),
                tuple(angular),
                of_pose,
                of_twist,
            )

    def _blurred(self, true: Poses) -> Poses:
        noise, rng = self.noise, self._rng
        if rng is None or not any((noise.position, noise.orientation, noise.velocity, noise.rate)):
            return true
        return Poses(
            true.position + rng.normal(0.0, noise.position, true.position.shape),
            blurred(true.orientation, noise.orientation, rng),
            true.linear + rng.normal(0.0, noise.velocity, true.linear.shape),
            true.angular + rng.normal(0.0, noise.rate, true.angular.shape),
        )


class InertialSensor:
    """Makes measurements of an inertial sensor at the origin of a body's frame, with its axes.

    The specific force is the mean over the time of one sample, half of it before and half after the stamp: an impact
    is a peak in it, and the sum of its samples is the change of the velocity.
    """

    def __init__(
        self,
        frame: str,
        plane: Plane,
        mount: Mount,
        gravity: float,
        noise: Noise = NO_NOISE,
        rng: np.random.Generator | None = None,
    ) -> None:
        self.frame, self.plane, self.mount, self.gravity = frame, plane, mount, gravity
        self.noise, self._rng = noise, rng

    def measurements(
        self, stamps: list[int], state: PlanarState, before: PlanarState, after: PlanarState, span: Array
    ) -> Iterator[Imu]:
        """The measurements at stamps (ns) from the states then, and before and after then, `span` s apart (arrays)."""
        ahead, up = (
            (late - early) / span
            for early, late in zip(
                origin_velocity(before, self.plane, self.mount),
                origin_velocity(after, self.plane, self.mount),
                strict=True,
            )
        )
        return self.told(stamps, state, ahead, up + self.gravity)

    def told(self, stamps: list[int], state: PlanarState, ahead: Array, up: Array) -> Iterator[Imu]:
        """The measurements from the specific force of the origin, along the world's axes in the plane."""
        seen = poses(state, self.plane, self.mount)
        force = in_frame(self.plane, self.mount, state.angle, ahead, up)
        orientation, angular = seen.orientation, seen.angular
        noise, rng = self.noise, self._rng
        if rng is not None and any((noise.orientation, noise.gyro, noise.accelerometer)):
            orientation = blurred(orientation, noise.orientation, rng)
            angular = angular + rng.normal(0.0, noise.gyro, angular.shape)
            force = force + rng.normal(0.0, noise.accelerometer, force.shape)
        rows = zip(stamps, orientation.tolist(), angular.tolist(), force.tolist(), strict=True)
        for stamp, turn, rate, push in rows:
            yield Imu(stamp, self.frame, tuple(turn), tuple(rate), tuple(push))


def blurred(orientation: Array, deviation: float, rng: np.random.Generator) -> Array:
    """Unit quaternions (n, 4) after small random turns about every axis of the body, in rad."""
    half = 0.5 * rng.normal(0.0, deviation, (len(orientation), 3))
    (x, y, z, w), (a, b, c) = orientation.T, half.T
    turned = orientation + np.stack(
        [w * a + y * c - z * b, w * b - x * c + z * a, w * c + x * b - y * a, -x * a - y * b - z * c], axis=1
    )
    unit: Array = turned / np.linalg.norm(turned, axis=1, keepdims=True)
    return unit


def _covariance(first: float, second: float) -> tuple[float, ...]:
    """A covariance of two triples, each with one deviation."""
    if not (first or second):
        return _NONE
    squares = [first * first] * 3 + [second * second] * 3
    return tuple(squares[row] if row == column else 0.0 for row in range(6) for column in range(6))
