"""The motion of a machine's base between and after its samples."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from operator import mul

from ...stamps import NANOSECONDS
from ..types import Sample, Vector3
from ..vectors import add, axes_of, times, to_body, to_world, total, turned

SPAN = 50_000_000
"""ns over which the acceleration of the base is taken to be constant."""

LEAST_SPAN = 10_000_000
"""ns from which on it can be told: noise of 0.02 m/s makes 1 m/s^2 of 50 ms, and 10 m/s^2 of 10 ms."""

FEWEST = 5
"""Samples from which it is told; of a slow source they reach further back."""

REMEMBERED = 64
"""Samples that are kept for feet that are told later, and for landings that are noticed later."""

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
        twists, axes = self._twists, axes_of(sample.orientation)
        twists.append((sample.stamp, to_world(axes, sample.linear) + to_world(axes, sample.angular)))
        while len(twists) > FEWEST and twists[0][0] < sample.stamp - SPAN:
            twists.popleft()
        self._line = None

    def begin(self, stamp: int) -> None:
        """Follow no twist from before a stamp in ns: an impact has changed it."""
        while self._twists and self._twists[0][0] <= stamp:
            self._twists.popleft()
        self._line = None

    def at(self, stamp: int) -> Sample:
        """The base at a stamp in ns, from the nearest of its last samples; the older of two that are equally near."""
        near = self.samples[-1]
        for sample in reversed(self.samples):
            if abs(sample.stamp - stamp) > abs(near.stamp - stamp):
                break
            near = sample
        return carried(near, (stamp - near.stamp) / NANOSECONDS)

    @property
    def line(self) -> TwistLine | None:
        """The line nearest to the last twists (least squares); None where these are too few.

        A base that turns about a foot gains speed until the next one lands, and a line averages the noise of twists.
        """
        twists = self._twists
        if self._line is None and len(twists) >= FEWEST and twists[-1][0] - twists[0][0] >= LEAST_SPAN:
            self._line = line_of(twists)
        return self._line


def extrapolated(sample: Sample, line: TwistLine | None, time: float) -> Sample:
    """A base `time` s after a sample, whose stamp it keeps; its twists lie on a line, or are those that it has."""
    if line is None:
        return carried(sample, time)._replace(stamp=sample.stamp)
    (x, y, z, u, v, w), (a, b, c, p, q, r) = line
    half = 0.5 * time
    glide: Vector3 = x + half * a, y + half * b, z + half * c
    axes = axes_of(sample.orientation)
    spin = to_body(axes, (u + half * p, v + half * q, w + half * r))
    orientation = turned(sample.orientation, times(spin, time))
    then = axes_of(orientation)
    return sample._replace(
        position=add(sample.position, glide, time),
        orientation=orientation,
        linear=to_body(then, (x + a * time, y + b * time, z + c * time)),
        angular=to_body(then, (u + p * time, v + q * time, w + r * time)),
    )


def line_of(twists: Sequence[tuple[int, tuple[float, ...]]]) -> TwistLine:
    """The line nearest to some twists (least squares), at the last of them."""
    last, count = twists[-1][0], len(twists)
    ages = [(stamp - last) / NANOSECONDS for stamp, _ in twists]
    middle = total(ages) / count
    arms = [age - middle for age in ages]
    spread = total(map(mul, arms, arms))
    columns = list(zip(*[twist for _, twist in twists], strict=True))
    rates = [total(map(mul, arms, column)) / spread for column in columns]
    now = [total(column) / count - middle * rate for column, rate in zip(columns, rates, strict=True)]
    return tuple(now), tuple(rates)


def carried(sample: Sample, time: float) -> Sample:
    """A sample `time` s later, at the velocities that it has."""
    if time == 0.0:
        return sample
    linear = to_world(axes_of(sample.orientation), sample.linear)
    orientation = turned(sample.orientation, times(sample.angular, time))
    return sample._replace(
        stamp=sample.stamp + round(time * NANOSECONDS),
        position=add(sample.position, linear, time),
        orientation=orientation,
        linear=to_body(axes_of(orientation), linear),
    )
