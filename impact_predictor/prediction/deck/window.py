"""The last messages of a moving support: the slopes of its signals, and whether each message follows from the last."""

from __future__ import annotations

from collections import deque
from itertools import repeat
from operator import mul, sub

from ...stamps import NANOSECONDS
from ..vectors import add, dot, total
from .motion import SupportState, rotation_between

FLAT = 1e-6
"""Of the determinant of evenly spread samples: with less their stamps lie in two clumps, which tell no curvature."""


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
        """Forget all samples."""
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
        scale, x = self._places()
        weights = slope_weights(x)
        scale *= NANOSECONDS
        # Less its last value: a large constant would leave its rounding in the slope.
        return [scale * total(map(mul, weights, map(sub, channel, repeat(channel[-1])))) for channel in self._channels]

    def ends(self) -> list[float]:
        """The values of the channels at the last sample, on the straight lines through them.

        Exact for a value that changes linearly. The noise is 2/sqrt(n) of a sample's.
        """
        _, x = self._places()
        count = len(x)
        s1, s2 = total(x), total(map(mul, x, x))
        part = 1.0 / (count * s2 - s1 * s1)
        c0, c1 = part * (s2 - s1), part * (count - s1)
        weights = [c0 + c1 * each for each in x]
        return [total(map(mul, weights, channel)) for channel in self._channels]

    def _places(self) -> tuple[float, list[float]]:
        """The stamps on -1 .. 1, and how much of that a nanosecond is."""
        first, last = self._stamps[0], self._stamps[-1]
        scale = 2.0 / (last - first)
        return scale, [1.0 + scale * (stamp - last) for stamp in self._stamps]


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


BOUNDS = (
    (0.05, 0.5, 3.75, 2),  # position
    (0.01, 0.1, 1.25, 2),  # orientation
    (0.1, 1.0, 30.0, 1),  # velocity
    (0.05, 0.5, 10.0, 1),  # angular velocity
)
"""How far each quantity may be from where the message before leads it, in its unit: the least and the most that is
allowed to noise, which is learnt; and what a slam of 30 m/s^2 or 10 rad/s^2 makes of it in 1 s, with the power of the
time between two messages that this grows with."""

FACTOR = 6.0
"""Allowed to noise, in root mean squares of the steps; for three normal parts these are ten standard deviations."""

MEMORY = 1.0 / 32.0  # of the mean square, the part of the newest step


class JumpDetector:
    """Tells messages that follow from those before from jumps.

    Pose after pose is led on by the mean of both twists; a twist is expected to stay. What noise and the support's
    motion make of that is learnt from every step, so that a rough source is trusted too, up to the `most` of each
    quantity.
    """

    def __init__(self) -> None:
        self._squares = [(least / FACTOR) ** 2 for least, _, _, _ in BOUNDS]

    def follows(self, before: SupportState, now: SupportState) -> bool:
        """Whether a message follows from the one before; it is learnt from in any case."""
        time = (now.stamp - before.stamp) / NANOSECONDS
        half = 0.5 * time
        moved = add(add(now.position, before.position, -1.0), add(now.velocity, before.velocity), -half)
        rotated = rotation_between(before.orientation, now.orientation)
        turned = add(rotated, add(now.angular, before.angular), -half)
        accelerated, spun = add(now.velocity, before.velocity, -1.0), add(now.angular, before.angular, -1.0)
        squares, follows = self._squares, True
        errors = moved, turned, accelerated, spun
        for i, ((least, most, slam, power), error) in enumerate(zip(BOUNDS, errors, strict=True)):
            square = dot(error, error)
            noise = min(max(FACTOR * squares[i] ** 0.5, least), most)
            if square > (noise + slam * time**power) ** 2:
                follows = False
            squares[i] += MEMORY * (min(square, most * most) - squares[i])
        return follows
