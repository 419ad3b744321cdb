"""The motion of a support: what is known of it at one message, at other times, and what is felt on it."""

from __future__ import annotations

from collections import deque
from functools import partial
from itertools import repeat
from math import sin, sqrt
from operator import mul, sub
from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..types import Felt, Moment, Quaternion, Vector3
from ..vectors import Axes, add, axes_of, combine, cross, dot, lines, times, to_body, total, turned

NOWHERE: Vector3 = (0.0, 0.0, 0.0)
"""Place, velocity and acceleration of a support that nobody measures."""

LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)

AVERAGED = 60.0  # s over which means are taken, about ten waves
FIRST_MEAN = 5.0
"""s for which the support counts as level and slow before its first message: a mean does not begin with a wave."""

SLOW = 1e-6, 1e-6
"""Mean squares of the angular velocity (rad/s) and of its derivative then: waves of 6 s, too low to be seen."""

QUARTER = 1.4  # rad after which a wave is no longer like what it was: nearly a quarter of it

FLAT = 1e-6
"""Of the determinant of evenly spread samples: with less their stamps lie in two clumps, which tell no curvature."""


class SupportState(NamedTuple):
    """What a message tells of a moving support, and, with the messages before, its accelerations.

    `stamp` in ns; `position` in m and `velocity` in m/s of its origin in the world, 0 where nobody measures them;
    `orientation` in the world, or in some frame that does not turn, with the `axes` it makes; `angular` velocity in
    rad/s along these. `acceleration` of the origin in the world in m/s^2, 0 where nobody measures its velocity; the one
    that is `felt` there, gravity less its own, in the frame of the orientation; `turning`, the derivative of the
    angular velocity, along the support's axes.
    """

    stamp: int
    orientation: Quaternion
    axes: Axes
    angular: Vector3
    position: Vector3 = NOWHERE
    velocity: Vector3 = NOWHERE
    acceleration: Vector3 = NOWHERE
    felt: Vector3 = NOWHERE
    turning: Vector3 = NOWHERE


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
    time = (stamp - state.stamp) / NANOSECONDS
    velocity, acceleration = state.velocity, state.acceleration
    rotation = times(add(state.angular, state.turning, 0.5 * time), time)
    orientation = turned(state.orientation, rotation)
    return state._replace(
        stamp=stamp,
        position=add(state.position, add(velocity, acceleration, 0.5 * time), time),
        orientation=orientation,
        axes=axes_of(orientation),
        velocity=add(velocity, acceleration, time),
        angular=add(state.angular, state.turning, time),
    )


def between(first: SupportState, second: SupportState, stamp: int) -> SupportState:
    """The support at a stamp between those of two messages: both velocities are met, and what is felt blends over."""
    whole = (second.stamp - first.stamp) / NANOSECONDS
    acceleration = times(add(second.velocity, first.velocity, -1.0), 1.0 / whole)
    turning = times(add(second.angular, first.angular, -1.0), 1.0 / whole)
    part = (stamp - first.stamp) / NANOSECONDS / whole
    return later(first._replace(acceleration=acceleration, turning=turning), stamp)._replace(
        acceleration=blend(first.acceleration, second.acceleration, part),
        felt=blend(first.felt, second.felt, part),
        turning=blend(first.turning, second.turning, part),
    )


def blend(first: Vector3, second: Vector3, part: float) -> Vector3:
    return add(first, add(second, first, -1.0), part)


class MotionWindow:
    """The samples of several channels over the last `span` s, with one more so that they reach over all of it.

    A parabola through them has its slope at the last sample: exact for a derivative that changes linearly, so its lag
    is of the second order. With n samples over T s of noise s the slope has the standard deviation 13.9 s/(T sqrt(n)),
    four times that of a straight line, whose slope however is T/2 old; for a derivative of frequency w rad/s it is
    0.1 (w T)^2 of it off.
    """

    def __init__(self, span: float, channels: int) -> None:
        self._span = round(span * NANOSECONDS)
        self._stamps: deque[int] = deque()
        self._channels: tuple[deque[float], ...] = tuple([deque() for _ in range(channels)])

    def clear(self) -> None:
        self._stamps.clear()
        for channel in self._channels:
            channel.clear()

    def add(self, stamp: int, values: tuple[float, ...]) -> bool:
        """Take a sample later than the last, stamp in ns; tells whether there are enough for a slope.

        These are three, which span the window.
        """
        stamps = self._stamps
        stamps.append(stamp)
        for channel, value in zip(self._channels, values, strict=True):
            channel.append(value)
        begin = stamp - self._span
        while len(stamps) > 3 and stamps[1] <= begin:
            stamps.popleft()
            for channel in self._channels:
                channel.popleft()
        return len(stamps) > 2 and stamps[0] <= begin

    def slopes(self) -> list[float]:
        """The derivatives of the channels at the last sample, per s."""
        first, last = self._stamps[0], self._stamps[-1]
        scale = 2.0 / (last - first)
        weights = slope_weights([1.0 + scale * (stamp - last) for stamp in self._stamps])
        scale *= NANOSECONDS
        # Less its last value: a large constant would leave its rounding in the slope.
        return [scale * total(map(mul, weights, map(sub, channel, repeat(channel[-1])))) for channel in self._channels]

    def ends(self) -> list[float]:
        """The values of the channels at the last sample, on the straight lines through them.

        Exact for a value that changes linearly. The noise is 2/sqrt(n) of a sample's.
        """
        last = self._stamps[-1]
        return [end for end, _ in lines([(stamp - last) / NANOSECONDS for stamp in self._stamps], self._channels)]


def slope_weights(x: list[float]) -> list[float]:
    """What the values at x count in the slope, at 1, of their least-squares parabola.

    x lies within -1 .. 1 and has both ends of it.
    """
    squares = [each * each for each in x]
    count = len(x)
    s1, s2, s3, s4 = total(x), total(squares), total(map(mul, x, squares)), total(map(mul, squares, squares))
    # The normal equations, by minors: the weights c0 + c1 x + c2 x^2 have the moments 0, 1, 2.
    m0, m1, m2 = s1 * s4 - s2 * s3, s1 * s3 - s2 * s2, count * s3 - s1 * s2
    determinant = count * (s2 * s4 - s3 * s3) - s1 * m0 + s2 * m1
    if determinant < FLAT * count * count * count:
        part = 1.0 / (count * s2 - s1 * s1)
        return [part * (count * each - s1) for each in x]
    part = 1.0 / determinant
    c0 = part * (2.0 * m1 - m0)
    c1 = part * (count * s4 - s2 * s2 - 2.0 * m2)
    c2 = part * (2.0 * (count * s2 - s1 * s1) - m2)
    return [c0 + c1 * each + c2 * square for each, square in zip(x, squares, strict=True)]
