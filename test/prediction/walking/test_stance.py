"""Which points stand, and what standing ones tell of the ground."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Sample
from impact_predictor.prediction.walking.cubic import PointFrame
from impact_predictor.prediction.walking.ground import Ground, GroundLevel
from impact_predictor.prediction.walking.stance import FootPoint

MS = 1_000_000
DEAD_TIME = 20 * MS
SCENE = Scene(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5)
"""Contact tolerance 5 mm."""


def frame(milliseconds: float, gap: float, rate: float | None = 0.0, x: float = 0.0) -> PointFrame:
    velocity = None if rate is None else (0.0, 0.0, rate)
    return PointFrame(round(milliseconds * MS), gap, rate, (x, 0.0, gap), velocity)


def changes(
    gap: Callable[[float], float], rate: Callable[[float], float | None], end: float
) -> list[tuple[float, bool]]:
    """When a point is seen to stand or to swing (ms), at 400 Hz."""
    point, ground = FootPoint(SCENE, DEAD_TIME), Ground(SCENE)
    found, stood = [], gap(0.0) == 0.0
    for time in np.arange(0.0, end, 2.5).tolist():
        point.add(frame(time, gap(time), rate(time)), ground)
        if point.stands is not stood:
            stood = point.stands
            found.append((time, stood))
    return found


@pytest.mark.parametrize("measured", [True, False])
def test_a_stance_is_believed_after_the_dead_time_and_not_before(measured: bool) -> None:
    def rate(_: float) -> float | None:
        return 0.0 if measured else None

    assert changes(lambda t: 0.05 if t < 50 else 0.0, rate, 100) == [(70.0, True)]
    assert changes(lambda t: 0.0 if t < 50 else 0.05, rate, 100) == [(70.0, False)]
    assert changes(lambda t: 0.0 if t % 10 else 0.05, rate, 200) == []


def test_standing_feet_tell_the_level_and_the_noise() -> None:
    rng = np.random.default_rng(0)
    point, ground = FootPoint(SCENE, DEAD_TIME), Ground(SCENE)
    for k in range(600):
        gap, rate = rng.normal(0.002, 1e-3), rng.normal(0.0, 0.03)
        point.add(frame(2.5 * k, gap, rate), ground)
    # Some thirty frames: their mean is good to 0.2 mm, the deviations of a hundred to 10 %.
    assert ground.level_at((0.0, 0.0, 0.0)).height == pytest.approx(0.002, abs=6e-4)
    assert ground.noise.gap == pytest.approx(1e-3, rel=0.3)
    assert ground.noise.rate == pytest.approx(0.03, rel=0.3)


@pytest.mark.parametrize("drift", [-0.003, 0.003])
def test_the_level_follows_a_base_whose_height_drifts(drift: float) -> None:
    point, ground = FootPoint(SCENE, DEAD_TIME), Ground(SCENE)
    for k in range(4000):
        point.add(frame(5.0 * k, drift * k * 5e-3, drift), ground)
    assert point.stands
    # 20 s; frames count 60 ms later, and the thirty of them over which is averaged take 0.15 s.
    assert ground.level_at((0.0, 0.0, 0.0)).height == pytest.approx(drift * 20.0, abs=0.3 * abs(drift))


def strike(height: float, speed: float) -> Callable[[float], float]:
    """A foot that comes down from 6 cm at a speed (m/s), and meets ground of a height (m) after 0.2 s."""
    return lambda time: max(height, height + speed * (0.2 - 1e-3 * time))


@pytest.mark.parametrize("measured", [True, False])
@pytest.mark.parametrize("height", [-0.02, 0.02])
def test_a_foot_that_strikes_ground_where_nobody_expected_it_is_noticed_within_10_ms(
    height: float, measured: bool
) -> None:
    gap = strike(height, 0.5)
    point, ground = FootPoint(SCENE, DEAD_TIME), Ground(SCENE)
    other = FootPoint(SCENE, DEAD_TIME)
    for k in range(100):
        other.add(frame(2.5 * k, 0.0, 0.0 if measured else None, x=1.0), ground)
    closed = stands = None
    for time in np.arange(1.3, 300.0, 2.5).tolist():
        rate = (0.0 if time >= 200.0 else -0.5) if measured else None
        point.add(frame(time, gap(time), rate), ground)
        closed = time if closed is None and point.closed else closed
        stands = time if stands is None and point.stands else stands
    assert closed is not None
    assert closed <= 210.0
    assert stands is not None
    assert stands <= 225.0
    assert point.since == pytest.approx(200 * MS, abs=MS)
    assert ground.level_at((0.0, 0.0, 0.0)).height == pytest.approx(height, abs=1e-3)


def test_blocks_are_no_drift() -> None:
    ground = Ground(SCENE)
    places = [(0.2 * k, 0.3 * (k % 2)) for k in range(30)]
    for k, (x, y) in enumerate(places):
        gap = 0.02 if k % 3 == 0 else 0.0
        ground.begin([PointFrame(100 * k * MS, gap, None, (x, y, gap), None)])
    known = [ground.level_at((x, y, 0.0)) for x, y in places[-6:]]
    heights = [0.02 if k % 3 == 0 else 0.0 for k in range(24, 30)]
    assert [one.height for one in known] == pytest.approx(heights, abs=2e-3)
    # Elsewhere a third of them is 2 cm high: the mean is 7 mm, and the standard deviation 9 mm.
    unknown = ground.level_at((5.5, -0.2, 0.0))
    assert unknown.height == pytest.approx(0.007, abs=2.0 * unknown.deviation)
    assert 0.009 < unknown.deviation < 0.018


def test_a_slope_that_nobody_told_of_is_learnt() -> None:
    ground = Ground(SCENE)
    for k in range(24):
        x, y = 0.1 * k, 0.3 * (k % 2)
        ground.begin([PointFrame(100 * k * MS, 0.1 * x - 0.05 * y, None, (x, y, 0.0), None)])
    ahead = ground.level_at((2.6, 0.0, 0.0))
    assert ahead.height == pytest.approx(0.26, abs=2.0 * ahead.deviation)
    assert ahead.deviation < 0.01


def test_a_level_through_which_a_foot_has_come_lies_deeper() -> None:
    level = GroundLevel(0.0, 0.01)
    same = level.below(0.05, 1e-3)
    assert (same.height, same.deviation) == pytest.approx((0.0, 0.01), abs=1e-5)
    # The mean of the lower half of a normal deviate, and what it scatters about that.
    half = level.below(0.0, 1e-9)
    assert half.height == pytest.approx(-0.01 * math.sqrt(2.0 / math.pi))
    assert half.deviation == pytest.approx(0.01 * math.sqrt(1.0 - 2.0 / math.pi))
    deep = level.below(-0.1, 1e-3)
    assert deep.height == pytest.approx(-0.1, abs=2e-3)
    assert 0.0 <= deep.deviation < 2e-3


@pytest.mark.parametrize("held", [True, False])
def test_a_foot_that_is_held_up_goes_on_with_its_base_and_does_not_stand(held: bool) -> None:
    """It comes down from 10 to 4 cm and brakes to rest there, on a step, or with a base that walks on at 0.3 m/s."""
    scene = SCENE._replace(frame="world")
    point, other, ground = FootPoint(scene, DEAD_TIME), FootPoint(scene, DEAD_TIME), Ground(scene)
    for k in range(160):
        time = 2.5e-3 * k
        s = min(1.0, time / 0.2)
        gap, ahead = 0.04 + 0.06 * (1.0 - s * s * (3.0 - 2.0 * s)), 0.3 * max(0.0, time - 0.2)
        stamp, place = round(1e9 * time), (ahead if held else 0.0, 0.2, gap)
        base = Sample(
            stamp, "world", "base", (0.3 * time, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0), (0.3, 0.0, 0.0), *[(0.0,) * 3] * 3
        )
        other.add(PointFrame(stamp, 0.0, None, (0.0, 0.0, 0.0), None), ground, base)
        point.add(PointFrame(stamp, gap, None, place, None), ground, base)
    assert other.stands
    assert point.stands is not held
    if not held:
        assert point.since == pytest.approx(200 * MS, abs=25 * MS)
