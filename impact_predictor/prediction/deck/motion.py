"""The motion of a support: what is known of it at one message, at other times, and what is felt on it."""

from __future__ import annotations

from functools import partial
from math import sin, sqrt
from typing import Final

from ...stamps import NANOSECONDS
from ..types import Felt, Moment, Quaternion, Vector3
from ..vectors import Axes, add, axes_of, combine, cross, dot, times, to_body, turned

NOWHERE: Vector3 = (0.0, 0.0, 0.0)
"""Place, velocity and acceleration of a support that nobody measures."""

LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)

AVERAGED: Final = 60.0  # s over which means are taken, about ten waves
FIRST_MEAN: Final = 5.0
"""s for which the support counts as level and slow before its first message: a mean does not begin with a wave."""

SLOW = 1e-6, 1e-6
"""Mean squares of the angular velocity (rad/s) and of its derivative then: waves of 6 s, too low to be seen."""

QUARTER: Final = 1.4  # rad after which a wave is no longer like what it was: nearly a quarter of it


class SupportState:
    """What a message tells of a moving support, and, with the messages before, its accelerations.

    `stamp` in ns; `position` in m and `velocity` in m/s of its origin in the world, 0 where nobody measures them;
    `orientation` in the world, or in some frame that does not turn, with the `axes` it makes; `angular` velocity in
    rad/s along these. `acceleration` of the origin in the world in m/s^2, 0 where nobody measures its velocity; the one
    that is `felt` there, gravity less its own, in the frame of the orientation; `turning`, the derivative of the
    angular velocity, along the support's axes.
    """

    def __init__(
        self,
        stamp: int,
        orientation: Quaternion,
        axes: Axes,
        angular: Vector3,
        position: Vector3 = NOWHERE,
        velocity: Vector3 = NOWHERE,
        acceleration: Vector3 = NOWHERE,
        felt: Vector3 = NOWHERE,
        turning: Vector3 = NOWHERE,
    ) -> None:
        self.stamp, self.orientation, self.axes, self.angular = stamp, orientation, axes, angular
        self.position, self.velocity, self.acceleration, self.felt = position, velocity, acceleration, felt
        self.turning = turning


class MeanMotion:
    """The mean `gravity` that is felt, along the support's axes, and the mean frequency with which it turns."""

    def __init__(self, still: Vector3) -> None:
        self.gravity = still
        self._time = FIRST_MEAN
        self._angular, self._turning = SLOW

    @property
    def quarter(self) -> float:
        """The time in s after which what is felt now says nothing. Noise of the accelerations makes it shorter."""
        return QUARTER * sqrt(self._angular / self._turning)

    def add(self, state: SupportState, time: float) -> None:
        """Take a state that was known for a time in s."""
        self._time = min(self._time + time, AVERAGED)
        part = min(time / self._time, 1.0)
        self.gravity = blend(self.gravity, to_body(state.axes, state.felt), part)
        self._angular += part * (dot(state.angular, state.angular) - self._angular)
        self._turning += part * (dot(state.turning, state.turning) - self._turning)


def resting(gravity: Vector3) -> Moment:
    """A support at rest, in its own frame: gravity (m/s^2) and nothing else is felt, now and later."""
    felt = Felt(gravity, NOWHERE, NOWHERE)
    return Moment(
        stamp=0,
        frame_id="",
        child_frame_id="",
        position=NOWHERE,
        orientation=LEVEL,
        linear=NOWHERE,
        felt=felt,
        ahead=partial(ahead, *felt),
        gravity=gravity,
    )


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


def later(state: SupportState, stamp: int) -> SupportState:
    """The support at another stamp, before or after, with constant acceleration and angular acceleration."""
    found = moved(state, stamp, state.acceleration, state.turning)
    found.acceleration, found.felt, found.turning = state.acceleration, state.felt, state.turning
    return found


def between(first: SupportState, second: SupportState, stamp: int) -> SupportState:
    """The support at a stamp between those of two messages: both velocities are met, and what is felt blends over."""
    whole = (second.stamp - first.stamp) / NANOSECONDS
    acceleration = times(add(second.velocity, first.velocity, -1.0), 1.0 / whole)
    turning = times(add(second.angular, first.angular, -1.0), 1.0 / whole)
    part = (stamp - first.stamp) / NANOSECONDS / whole
    found = moved(first, stamp, acceleration, turning)
    found.acceleration = blend(first.acceleration, second.acceleration, part)
    found.felt = blend(first.felt, second.felt, part)
    found.turning = blend(first.turning, second.turning, part)
    return found


def moved(state: SupportState, stamp: int, acceleration: Vector3, turning: Vector3) -> SupportState:
    """Where the support is at another stamp, and how fast it moves, under accelerations that do not change."""
    time = (stamp - state.stamp) / NANOSECONDS
    orientation = turned(state.orientation, times(add(state.angular, turning, 0.5 * time), time))
    return SupportState(
        stamp=stamp,
        orientation=orientation,
        axes=axes_of(orientation),
        angular=add(state.angular, turning, time),
        position=add(state.position, add(state.velocity, acceleration, 0.5 * time), time),
        velocity=add(state.velocity, acceleration, time),
    )


def blend(first: Vector3, second: Vector3, part: float) -> Vector3:
    return add(first, add(second, first, -1.0), part)
