"""The terrain as a map tells it: heights between its cells, edges, unknown places, and feet that step on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Status, Terrain
from impact_predictor.prediction.walking.cubic import PointFrame
from impact_predictor.prediction.walking.ground import Ground
from impact_predictor.prediction.walking.terrain import TerrainMap

SCENE = Scene(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5)
"""Contact tolerance 5 mm."""
CELL = 0.02


def grid(height: Callable[[Any, Any], Any], end: float = 1.0) -> Terrain:
    x, y = (one.ravel() for one in np.meshgrid(np.arange(-end, end, CELL), np.arange(-end, end, CELL)))
    return Terrain(0, "world", np.stack([x, y, height(x, y)], axis=1).astype(np.float32))


def mapped(terrain: Terrain) -> TerrainMap:
    found = TerrainMap(CELL, SCENE.tolerance)
    assert found.set(terrain) is Status.ACCEPTED
    return found


def test_heights_are_interpolated_but_across_an_edge() -> None:
    ramp = mapped(grid(lambda x, y: 0.1 * x - 0.2 * y))
    height, edge = ramp.at((0.123, -0.457, 9.0)) or (math.nan, math.nan)
    assert height == pytest.approx(0.1 * 0.123 + 0.2 * 0.457, abs=1e-6)
    assert edge < 0.0025
    step = mapped(grid(lambda x, y: np.where(x > 0.001, 0.05, 0.0)))
    # The edge lies half way between the cells at 0 and at 2 cm.
    assert [(step.at((x, 0.3, 0.0)) or (math.nan,))[0] for x in (0.009, 0.011)] == pytest.approx([0.0, 0.05])
    assert (step.at((0.009, 0.3, 0.0)) or (0.0, 0.0))[1] > 0.01
    assert (step.at((0.05, 0.3, 0.0)) or (0.0, 1.0))[1] == 0.0


def test_where_heights_are_missing_or_not_finite_nothing_is_told_and_the_rest_is() -> None:
    holed = mapped(grid(lambda x, y: np.where(np.hypot(x, y) < 0.1, math.nan, 0.03)))
    assert holed.at((0.0, 0.0, 0.0)) is None
    assert holed.at((5.0, 0.0, 0.0)) is None
    assert holed.at((0.5, 0.0, 0.0)) == pytest.approx((0.03, 0.0))
    assert holed.set(grid(lambda x, y: np.full_like(x, math.nan))) is Status.NOT_FINITE
    assert holed.at((0.5, 0.0, 0.0)) == pytest.approx((0.03, 0.0))


def test_footholds_show_how_the_map_is_off_and_tell_the_level_where_it_tells_nothing() -> None:
    terrain = grid(lambda x, y: np.where(y > 0.2, math.nan, np.where(np.floor(x / 0.2) % 2 == 0, 0.02, 0.0)))
    ground = Ground(SCENE, mapped(terrain))

    def true(x: float) -> float:
        return 0.013 + (0.02 if math.floor(x / 0.2) % 2 == 0 else 0.0)

    for k in range(12):
        x, y = -0.9 + 0.08 * k, 0.3 if k % 4 == 0 else 0.0
        ground.begin([PointFrame(k * 10**8, true(x), None, (x, y, 0.0), None)])
    assert (ground.footholds, ground.unmapped) == (12, 3)
    for x in (0.1, 0.3, 0.5):
        level = ground.level_at((x, 0.0, 0.0))
        assert level.height == pytest.approx(true(x), abs=2e-3)
        assert level.deviation < 3e-3
    unknown = ground.level_at((0.1, 0.3, 0.0))
    assert unknown.height == pytest.approx(0.023, abs=2.0 * unknown.deviation)
    assert unknown.deviation > 5e-3


def test_a_map_in_another_frame_is_refused() -> None:
    walker = Predictor(SCENE._replace(frame="world", walking=Walking(("left", "right"), terrain=CELL)))
    flat = grid(lambda x, y: 0.0 * x)
    assert walker.tell(flat._replace(frame_id="map")) is Status.WRONG_FRAME
    assert walker.tell(flat) is Status.ACCEPTED
