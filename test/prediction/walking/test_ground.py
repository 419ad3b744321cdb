"""The ground between footholds."""

from __future__ import annotations

from math import exp, isfinite

import pytest

from impact_predictor.prediction.walking.ground import NEIGHBOUR, Foothold, Relief


@pytest.mark.parametrize("apart", [0.3, 0.7, 1.2])
def test_beside_a_foothold_the_ground_comes_back_to_the_plane_as_kriging_with_a_gaussian_variogram_says(
    apart: float,
) -> None:
    relief = Relief(tolerance=0.01)
    for k, (u, level) in enumerate([(-10.0, 0.0), (0.0, 0.02), (10.0, 0.0)]):
        relief.add(Foothold(u, 0.0, level, 1, k * 10**9), 0.0, first=True)
    # Where no foothold is near there is the plane, a line along this one.
    low, high = relief.at(-5.0, 0.0).height, relief.at(5.0, 0.0).height

    def above(u: float) -> float:
        return relief.at(u, 0.0).height - (0.5 * (low + high) + 0.1 * u * (high - low))

    # Of a single neighbour that is so much like the place nothing but this part counts, however surely it is known.
    assert above(0.0) > 0.005
    assert above(apart * NEIGHBOUR) / above(0.0) == pytest.approx(exp(-apart * apart), rel=1e-9)


def test_under_a_foothold_lies_its_level_however_far_levels_scatter() -> None:
    relief = Relief(tolerance=1e-6)
    for u, level in ((0.0, 0.0), (1.0, 1e12)):
        relief.add(Foothold(u, 0.0, level, 1, 0), 0.0, first=True)
    found = relief.at(0.0, 0.0)
    assert found.height == pytest.approx(0.0, abs=1.0)  # a rounding of 1e12
    assert isfinite(found.deviation)
