"""How the base of a machine on feet moves: its last samples, and its twist as it goes on from them."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Final

from ...stamps import NANOSECONDS
from ..checks import with_motion
from ..types import Sample
from ..vectors import add, axes_of, lines, rotation_between, times, to_body, to_world, turned

NOTHING = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

SPAN: Final = 50_000_000  # ns over which the acceleration of the base is taken to be constant
LEAST_SPAN: Final = 10_000_000  # ns from which it is told: noise of 0.02 m/s makes 1 m/s^2 of 50 ms, 10 m/s^2 of 10 ms
FEWEST: Final = 5  # samples from which it is told; of a slow source they reach further back
REMEMBERED: Final = 64  # samples that are kept for feet that are told later, and for landings that are noticed later

TwistLine = tuple[tuple[float, ...], tuple[float, ...]]
"""Twist of now and its rate."""


class BaseMotion:
    """The last samples of the base, and how its twist goes on from them."""

    def __init__(self) -> None:
        self.samples: deque[Sample] = deque(maxlen=REMEMBERED)
        self._twists: deque[tuple[int, tuple[float, ...]]] = deque()
        self._line: TwistLine | None = None

    def add(self, sample: Sample) -> None:
        """Take the next sample, in the order of their stamps."""
        self.samples.append(sample)
        twists = self._twists
        twists.append((sample.stamp, twist_of(sample)))
        while len(twists) > FEWEST and twists[0][0] < sample.stamp - SPAN:
            twists.popleft()
        self._line = None

    def begin(self, stamp: int) -> None:
        """Follow no twist from before a stamp in ns: an impact has changed it."""
        while self._twists and self._twists[0][0] <= stamp:
            self._twists.popleft()
        self._line = None

    def at(self, stamp: int) -> Sample:
        """The base at a stamp in ns, between its last samples or beyond them."""
        after = self.samples[-1]
        for before in reversed(self.samples):
            if before.stamp == stamp:
                return before
            if before.stamp < stamp:
                if after.stamp > stamp:
                    return between(before, after, stamp)
                break
            after = before
        return extrapolated(after, None, (stamp - after.stamp) / NANOSECONDS)._replace(stamp=stamp)

    @property
    def line(self) -> TwistLine | None:
        """The line nearest to the last twists (least squares), at the last of them; None where these are too few.

        A base that turns about a foot gains speed until the next one lands, and a line averages the noise of twists.
        """
        if self._line is None:
            self._line = _line(self._twists)
        return self._line

    def line_until(self, stamp: int) -> TwistLine | None:
        """The line of the twists up to a stamp in ns, at the last of them."""
        return _line([twist for twist in self._twists if twist[0] <= stamp])


def _line(twists: Sequence[tuple[int, tuple[float, ...]]]) -> TwistLine | None:
    if len(twists) < FEWEST or twists[-1][0] - twists[0][0] < LEAST_SPAN:
        return None
    last = twists[-1][0]
    ages = [(stamp - last) / NANOSECONDS for stamp, twist in twists]
    each = lines(ages, zip(*[twist for stamp, twist in twists], strict=True))
    return tuple([now for now, rate in each]), tuple([rate for now, rate in each])


def twist_of(sample: Sample) -> tuple[float, ...]:
    """Linear and angular velocity of a base along the axes of the world."""
    axes = axes_of(sample.orientation)
    return to_world(axes, sample.linear) + to_world(axes, sample.angular)


def extrapolated(sample: Sample, line: TwistLine | None, time: float) -> Sample:
    """A base `time` s after a sample, whose stamp it keeps; its twists lie on a line, or are those that it has."""
    if time == 0.0:
        return sample
    (x, y, z, u, v, w), (a, b, c, p, q, r) = line or (twist_of(sample), NOTHING)
    half = 0.5 * time
    spin = to_body(axes_of(sample.orientation), (u + half * p, v + half * q, w + half * r))
    orientation = turned(sample.orientation, times(spin, time))
    then = axes_of(orientation)
    position = add(sample.position, (x + half * a, y + half * b, z + half * c), time)
    linear = to_body(then, (x + a * time, y + b * time, z + c * time))
    angular = to_body(then, (u + p * time, v + q * time, w + r * time))
    return with_motion(sample, sample.stamp, sample.frame_id, position, orientation, linear, angular)


def between(before: Sample, after: Sample, stamp: int) -> Sample:
    """A base at a stamp in ns between two samples: twists lie on a line, and the pose turns and bends with them."""
    span = (after.stamp - before.stamp) / NANOSECONDS
    part = (stamp - before.stamp) / (after.stamp - before.stamp)
    bend = 0.5 * part * (1.0 - part) * span
    axes = axes_of(before.orientation)
    gain = add(to_world(axes_of(after.orientation), after.linear), to_world(axes, before.linear), -1.0)
    spin = add(after.angular, before.angular, -1.0)
    place = add(before.position, add(after.position, before.position, -1.0), part)
    rotation = add(times(rotation_between(before.orientation, after.orientation), part), spin, -bend)
    position, orientation = add(place, gain, -bend), turned(before.orientation, rotation)
    linear = add(before.linear, add(after.linear, before.linear, -1.0), part)
    return with_motion(before, stamp, before.frame_id, position, orientation, linear, add(before.angular, spin, part))
