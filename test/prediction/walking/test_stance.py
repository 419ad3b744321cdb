"""Which points stand, and what standing ones tell of the ground."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.walking.cubic import PointFrame
from impact_predictor.prediction.walking.ground import Ground
from impact_predictor.prediction.walking.stance import FootPoint

MS = 1_000_000
DEAD_TIME = 20 * MS
SCENE = Scene(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5)
"""Contact tolerance 5 mm."""


def frame(milliseconds: float, gap: float, rate: float | None = 0.0) -> PointFrame:
    velocity = None if rate is None else (0.0, 0.0, rate)
    return PointFrame(round(milliseconds * MS), gap, rate, (0.0, 0.0, gap), velocity)


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
    # A hundred frames: their mean is good to 0.1 mm, their deviations to 10 %.
    assert ground.level == pytest.approx(0.002, abs=3e-4)
    assert ground.noise.gap == pytest.approx(1e-3, rel=0.3)
    assert ground.noise.rate == pytest.approx(0.03, rel=0.3)


@pytest.mark.parametrize("drift", [-0.003, 0.003])
def test_the_level_follows_a_base_whose_height_drifts(drift: float) -> None:
    ground = Ground(SCENE)
    step = 5_000_000
    frames = [PointFrame(k * step, drift * k * 5e-3, None, (0.0, 0.0, 0.0), None) for k in range(4000)]
    for before, frame in pairwise(frames):
        ground.add(before, frame)
    # 20 s, and 100 frames over which is averaged.
    assert ground.level == pytest.approx(drift * 20.0, abs=abs(drift))
