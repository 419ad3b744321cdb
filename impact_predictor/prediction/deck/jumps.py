"""Whether what is measured of a moving support goes on from what was measured before."""

from __future__ import annotations

from typing import NamedTuple

from ...stamps import NANOSECONDS
from ..types import Vector3
from ..vectors import add, dot
from .motion import Seen, rotation_between


class Step(NamedTuple):
    """How far one quantity may be from where the message before leads it, in its unit.

    `least` and `most` bound what is allowed to noise, which is learnt; `course` is what a slam of 30 m/s^2 or
    10 rad/s^2 makes of it in 1 s, and grows with that power of the time between two messages.
    """

    least: float
    most: float
    course: float
    power: int


STEPS = (Step(0.05, 0.5, 3.75, 2), Step(0.01, 0.1, 1.25, 2), Step(0.1, 1.0, 30.0, 1), Step(0.05, 0.5, 10.0, 1))
"""Of position, orientation, velocity and angular velocity."""

FACTOR = 6.0
"""Allowed to noise, in root mean squares of the steps; for three normal parts these are ten standard deviations."""

MEMORY = 1.0 / 32.0
"""Of the mean square, the part of the newest step."""


class Following:
    """Tells messages that follow from those before from jumps.

    Pose after pose is led on by the mean of both twists; a twist is expected to stay. What noise and the usual motion
    make of that is learnt from every step, so that a rough source is trusted too, up to the `most` of each quantity.
    """

    def __init__(self) -> None:
        self._squares = [(step.least / FACTOR) ** 2 for step in STEPS]

    def follows(self, before: Seen, now: Seen) -> bool:
        time = (now.stamp - before.stamp) / NANOSECONDS
        half = 0.5 * time
        moved = add(add(now.position, before.position, -1.0), add(now.velocity, before.velocity), -half)
        rotated = rotation_between(before.orientation, now.orientation)
        turned = add(rotated, add(now.angular, before.angular), -half)
        errors: tuple[Vector3, ...] = (
            moved,
            turned,
            add(now.velocity, before.velocity, -1.0),
            add(now.angular, before.angular, -1.0),
        )
        squares, follows = self._squares, True
        for i, ((least, most, course, power), error) in enumerate(zip(STEPS, errors, strict=True)):
            square = dot(error, error)
            noise = min(max(FACTOR * squares[i] ** 0.5, least), most)
            if square > (noise + course * time**power) ** 2:
                follows = False
            squares[i] += MEMORY * (min(square, most * most) - squares[i])
        return follows
