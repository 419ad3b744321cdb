"""Inertial sensors: one on a moving support that alone tells of its motion, and one on a body that tells its tilt."""

from __future__ import annotations

from math import atan2, exp, hypot, isfinite, sqrt

from ...stamps import NANOSECONDS
from ..checks import check_orientation, followed
from ..scene import Scene
from ..types import Imu, Moment, Quaternion, Status, Vector3
from ..vectors import add, any_across, axes_of, cross, dot, times, to_body, turned
from .motion import LEVEL, SupportState

AVERAGED = 10.0
"""s over which what the sensor feels is averaged, with exponential weights, before it is compared with gravity."""

SPEED = 10.0
"""m/s: no support moves faster along its normal for long, so that the mean acceleration is at most 2 SPEED / AVERAGED.
The deck of a ship heaves with up to 5 m/s, a fast boat's bow with up to 8."""

SHARE = 0.5  # of gravity, by which the mean along the normal may differ from it: a list of 60 degrees is the limit
FIRST = 1.0  # s of averaging before the sensor is trusted


class DeckImu:
    """Turns measurements of an inertial sensor into what is seen of the support, and judges its gravity.

    The sensor lies at `place` (m) in the support's frame, with its axes. `gravity` is its magnitude in m/s^2.
    """

    def __init__(self, place: Vector3, gravity: Vector3, normal: Vector3) -> None:
        self._place, self._normal = place, normal
        self._gravity = sqrt(dot(gravity, gravity))
        self._up = times(gravity, -1.0 / self._gravity) if self._gravity > 0.0 else normal
        self._oriented = False
        self.clear()

    def clear(self) -> None:
        self._sum = self._weight = self._righting = 0.0
        self._stamp: int | None = None
        self._verdict = Status.NO_SUPPORT

    def oriented_anew(self, imu: Imu) -> bool:
        """Whether the sensor begins to give its orientation, or ceases to: the frame is another one then."""
        oriented, self._oriented = self._oriented, imu.orientation is not None
        return oriented is not self._oriented

    def seen(self, imu: Imu, before: SupportState | None) -> SupportState:
        """What a measurement shows; without an orientation its tilt is followed, and its heading counts from 0."""
        orientation = imu.orientation
        if orientation is None:
            orientation, time = LEVEL, 0.0
            if before is not None:
                time = (imu.stamp - before.stamp) / NANOSECONDS
                orientation = turned(before.orientation, times(add(before.angular, imu.angular), 0.5 * time))
            orientation = self._righted(orientation, imu.specific_force, time)
        return SupportState(stamp=imu.stamp, orientation=orientation, axes=axes_of(orientation), angular=imu.angular)

    def _righted(self, orientation: Quaternion, force: Vector3, time: float) -> Quaternion:
        """The orientation turned a little towards the one in which the force of now would point up.

        Its mean does, so the drift of the angular velocity has no time to add up. The first force counts as the mean.
        """
        self._righting = min(self._righting + time, AVERAGED)
        part = time / self._righting if self._righting > 0.0 else 1.0
        up = to_body(axes_of(orientation), self._up)
        across = cross(force, up)
        sine = sqrt(dot(across, across))
        if sine == 0.0:
            return orientation
        return turned(orientation, times(across, part * atan2(sine, dot(force, up)) / sine))

    def felt(self, imu: Imu) -> Vector3:
        """What is felt at the frame's origin, along the support's axes, while the angular velocity stays."""
        outwards = cross(imu.angular, cross(imu.angular, self._place))
        return add(outwards, imu.specific_force, -1.0)

    def euler(self, turning: Vector3) -> Vector3:
        """What the origin feels more than the sensor does when the angular velocity changes."""
        return cross(turning, self._place)

    def judge(self, imu: Imu) -> Status:
        """ACCEPTED once the mean of what is felt along the normal is gravity's, NO_SUPPORT while that is open.

        A single measurement tells nothing: a slam, or the top of a heave, may feel like 0 or like several times
        gravity. The mean acceleration over T seconds is at most 2 v/T for a speed that stays below v, so the mean
        over T may differ from gravity by that much more before the sensor is wrong.
        """
        if self._stamp is not None:
            keep = exp((self._stamp - imu.stamp) / (AVERAGED * NANOSECONDS))
            self._sum = keep * self._sum + (1.0 - keep) * dot(self._normal, imu.specific_force)
            self._weight = keep * self._weight + 1.0 - keep
        self._stamp = imu.stamp
        time = AVERAGED * self._weight
        if time > 0.0:
            difference = abs(self._sum / self._weight - self._gravity)
            if difference > SHARE * self._gravity + 2.0 * SPEED / time:
                self._verdict = Status.GRAVITY_WRONG
            elif time > FIRST and difference <= SHARE * self._gravity:
                self._verdict = Status.ACCEPTED
        return self._verdict


class Tilt:
    """The tilt of a body on its support, from an inertial sensor on it with the axes of the body frame.

    Only which way is up counts of its orientation and of the support's: headings of inertial sensors drift apart, and
    steel turns magnetic ones. So a body keeps the heading at which it was placed.
    """

    def __init__(self, scene: Scene) -> None:
        self._up = times(scene.gravity, -1.0 / (hypot(*scene.gravity) or 1.0))
        self._placed = turned(LEVEL, times(scene.normal, scene.yaw))
        self._last: int | None = None

    def check(self, imu: Imu) -> Status:
        """What becomes of a measurement; one without an orientation tells no tilt."""
        if not all(map(isfinite, (*imu.angular, *imu.specific_force))):
            return Status.NOT_FINITE
        status = Status.BAD_QUATERNION if imu.orientation is None else check_orientation(imu.orientation)
        if status is Status.ACCEPTED:
            status, self._last = followed(imu.stamp, self._last)
        return status

    def on(self, support: Moment | None, orientation: Quaternion) -> Quaternion:
        """The orientation relative to the support, moving or (None) fixed, of a body with one in the world."""
        up = self._up if support is None else to_body(axes_of(support.orientation), self._up)
        placed_up = to_body(axes_of(self._placed), up)
        return turned(self._placed, rotation(to_body(axes_of(orientation), self._up), placed_up))


def rotation(first: Vector3, second: Vector3) -> Vector3:
    """The smallest rotation (vector, rad) of axes in which the direction `first` becomes `second`."""
    across = cross(first, second)
    sine = hypot(*across)
    if sine == 0.0:
        across = cross(first, any_across(first))
    return times(across, atan2(sine, dot(first, second)) / hypot(*across))
