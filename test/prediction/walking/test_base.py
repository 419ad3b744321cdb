"""The base between, at and after its samples."""

from __future__ import annotations

from math import cos, sin

import pytest

from impact_predictor.prediction.types import Sample
from impact_predictor.prediction.vectors import axes_of, to_body, to_world
from impact_predictor.prediction.walking.base import FEWEST, BaseMotion, extrapolated

PERIOD = 2_500_000
ZEROS = (0.0,) * 36
RAMP = ((0.4, -0.2, 0.1), (3.0, 1.0, -2.0))
"""A velocity in m/s and its acceleration in m/s^2, along the world's axes."""


def sample(stamp: int, yaw: float = 0.7, shift: float = 0.0) -> Sample:
    """A base that moves as `RAMP` tells, faster by a `shift`, and spins about z at 2 + 5 t rad/s."""
    time = stamp * 1e-9
    (x, y, z), (a, b, c) = RAMP
    angle = yaw + 2.0 * time + 2.5 * time * time
    orientation = (0.0, 0.0, sin(0.5 * angle), cos(0.5 * angle))
    linear = to_body(axes_of(orientation), (x + a * time + shift, y + b * time, z + c * time))
    half = 0.5 * time * time
    position = (x * time + a * half, y * time + b * half, z * time + c * half)
    return Sample(stamp, "world", "base", position, orientation, linear, (0.0, 0.0, 2.0 + 5.0 * time), ZEROS, ZEROS)


def motion_of(samples: list[Sample]) -> BaseMotion:
    motion = BaseMotion()
    for one in samples:
        motion.add(one)
    return motion


@pytest.mark.parametrize(
    ("lead_time", "period", "count"),
    [(0.0, PERIOD, 41), (0.1, PERIOD, 41), (0.1, PERIOD, FEWEST), (0.1, 20_000_000, 2 * FEWEST)],
)
def test_a_base_goes_on_at_the_acceleration_that_its_twists_show(lead_time: float, period: int, count: int) -> None:
    samples = [sample(k * period) for k in range(count)]
    then = extrapolated(samples[-1], motion_of(samples).line, lead_time)
    true = sample(samples[-1].stamp + round(lead_time * 1e9))
    assert then.stamp == samples[-1].stamp
    # Motion of constant acceleration is followed exactly, up to rounding of 1 m and 4 rad/s.
    assert then.position == pytest.approx(true.position, abs=1e-12)
    assert then.orientation == pytest.approx(true.orientation, abs=1e-12)
    assert then.linear == pytest.approx(true.linear, abs=1e-12)
    assert then.angular == pytest.approx(true.angular, abs=1e-12)


def test_the_line_of_an_earlier_moment_knows_nothing_of_later_samples() -> None:
    samples = [sample(k * PERIOD) for k in range(20)]
    line = motion_of(samples[:12] + [sample(one.stamp, shift=1.0) for one in samples[12:]]).line_until(
        samples[11].stamp
    )
    assert line is not None
    assert line[1] == pytest.approx((*RAMP[1], 0.0, 0.0, 5.0), abs=1e-9)
    assert motion_of(samples).line_until(samples[FEWEST - 2].stamp) is None


@pytest.mark.parametrize(("period", "count"), [(PERIOD, FEWEST - 1), (100_000, 2 * FEWEST)])
def test_from_few_samples_or_ones_that_come_at_once_the_twist_of_now_is_kept(period: int, count: int) -> None:
    samples = [sample(k * period) for k in range(count)]
    last = samples[-1]
    then = extrapolated(last, motion_of(samples).line, 0.1)
    kept = to_world(axes_of(then.orientation), then.linear)
    assert kept == pytest.approx(to_world(axes_of(last.orientation), last.linear), abs=1e-15)
    assert then.angular == pytest.approx(last.angular, abs=1e-15)


@pytest.mark.parametrize("offset", [0, -1_000_000, -1_250_000, -2_000_000, -PERIOD])
def test_between_samples_a_base_moves_at_a_constant_acceleration(offset: int) -> None:
    samples = [sample(k * PERIOD) for k in range(5)]
    found, true = motion_of(samples).at(samples[-1].stamp + offset), sample(samples[-1].stamp + offset)
    assert found.stamp == true.stamp
    assert found.position == pytest.approx(true.position, abs=1e-12)
    assert found.orientation == pytest.approx(true.orientation, abs=1e-12)
    # Along the axes of the base, which turn, the velocity is no line: 2 rad/s turn 3 m/s^2 by 4e-5 m/s meanwhile.
    assert found.linear == pytest.approx(true.linear, abs=4e-5)
    assert found.angular == pytest.approx(true.angular, abs=1e-12)


@pytest.mark.parametrize(("offset", "end"), [(-4 * PERIOD - 1_000_000, 0), (1_000_000, 4)])
def test_beyond_its_samples_the_nearest_one_is_carried_on(offset: int, end: int) -> None:
    samples = [sample(k * PERIOD) for k in range(5)]
    stamp = samples[-1].stamp + offset
    found = motion_of(samples).at(stamp)
    assert found.stamp == stamp
    age = (stamp - samples[end].stamp) * 1e-9
    velocity = to_world(axes_of(samples[end].orientation), samples[end].linear)
    expected = [p + v * age for p, v in zip(samples[end].position, velocity, strict=True)]
    assert found.position == pytest.approx(expected, abs=1e-15)
