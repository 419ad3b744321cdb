"""The tilt of a body on its support, from an inertial sensor on it.

Its axes are those of the body frame. Only which way is up counts of its orientation and of the support's: headings of
inertial sensors drift apart, and steel turns magnetic ones. So a body keeps the heading at which it was placed.
"""

from __future__ import annotations

from math import atan2, hypot, isfinite

from ..checks import UNIT, order_of
from ..predictor import PAUSE
from ..scene import Scene
from ..types import Imu, Moment, Quaternion, Status, Vector3
from ..vectors import any_across, axes_of, cross, dot, times, to_body, turned


class Tilt:
    """Checks the measurements of one body, and tells how it stands."""

    def __init__(self, scene: Scene) -> None:
        self._up = times(scene.gravity, -1.0 / (hypot(*scene.gravity) or 1.0))
        self._placed = turned((0.0, 0.0, 0.0, 1.0), times(scene.normal, scene.yaw))
        self._last: int | None = None

    def check(self, imu: Imu) -> Status:
        """What becomes of a measurement; one without an orientation tells no tilt."""
        numbers = (*imu.angular, *imu.specific_force, *(imu.orientation or ()))
        if not all(map(isfinite, numbers)):
            return Status.NOT_FINITE
        if imu.orientation is None or not abs(sum(part * part for part in imu.orientation) - 1.0) < UNIT:
            return Status.BAD_QUATERNION
        last = self._last
        status = order_of(imu.stamp, last)
        if status is Status.ACCEPTED:
            self._last = imu.stamp
        elif last is not None and last - imu.stamp > PAUSE:
            self._last = None
        return status

    def on(self, support: Moment | None, orientation: Quaternion) -> Quaternion:
        """The orientation relative to the support, moving or (None) fixed, of a body with one in the world."""
        up = self._up if support is None else to_body(axes_of(support.orientation), self._up)
        return turned(self._placed, rotation(to_body(axes_of(orientation), self._up), self._placed_up(up)))

    def _placed_up(self, up: Vector3) -> Vector3:
        """Which way is up for the body as it was placed."""
        return to_body(axes_of(self._placed), up)


def rotation(first: Vector3, second: Vector3) -> Vector3:
    """The smallest rotation (vector, rad) of axes in which the direction `first` becomes `second`."""
    across = cross(first, second)
    sine = hypot(*across)
    if sine == 0.0:
        across = cross(first, any_across(first))
    return times(across, atan2(sine, dot(first, second)) / hypot(*across))
