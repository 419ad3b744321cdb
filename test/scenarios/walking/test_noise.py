"""Noise on base and feet: its deviations, where it is told, and its seed."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from impact_predictor.bags.adapters import of_world
from impact_predictor.prediction.types import Geometry, Sample
from impact_predictor.scenarios.walking.noise import POSITION, VELOCITY, noisy

TURN = Rotation.from_rotvec([0.3, -0.2, 1.0])
POSE = (1.0, 2.0, 0.6), tuple(TURN.as_quat().tolist())
TWIST = (0.5, 0.1, 0.0), (0.4, -0.8, 1.5)
FEET = ((1.3, 2.3, 0.0), (0.7, 1.7, 0.1))
RATES = ((0.0, 0.0, 0.0), (1.0, 0.0, -0.3))
SAMPLE, GEOMETRY = of_world(7, *POSE, *TWIST, FEET, RATES)
COUNT = 4000


def in_world(sample: Sample, geometry: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities of base and feet in the world (1 + n, 3)."""
    arms = np.vstack([np.zeros(3), geometry.points])
    moving = np.vstack([np.zeros(3), geometry.velocities]) + sample.linear + np.cross(sample.angular, arms)
    return TURN.apply(arms) + sample.position, TURN.apply(moving)


def drawn(seed: int, on_robot: bool) -> list[tuple[Sample, Geometry]]:
    rng = np.random.default_rng(seed)
    return [noisy(SAMPLE, GEOMETRY, rng, on_robot=on_robot) for _ in range(COUNT)]


def test_in_the_world_all_positions_and_velocities_have_their_deviation_and_are_independent() -> None:
    places, speeds = (np.array(part) for part in zip(*[in_world(*one) for one in drawn(1, False)], strict=True))
    true_places, true_speeds = in_world(SAMPLE, GEOMETRY)
    for values, true, deviation in ((places, true_places, POSITION), (speeds, true_speeds, VELOCITY)):
        # Four deviations of a mean, and of a deviation, of 4000 draws.
        assert np.abs(values.mean(axis=0) - true).max() < 4.0 * deviation / COUNT**0.5
        assert np.allclose(values.std(axis=0), deviation, rtol=4.0 / (2.0 * COUNT) ** 0.5, atol=0.0)
        apart = np.corrcoef(values.reshape(COUNT, -1).T) - np.eye(9)
        assert np.abs(apart).max() < 4.5 / COUNT**0.5


def test_on_the_robot_the_points_have_their_deviation_and_the_base_its_own_besides() -> None:
    made = drawn(2, True)
    points, rates = (np.array([getattr(one, name) for _, one in made]) for name in ("points", "velocities"))
    assert np.allclose(points.std(axis=0), POSITION, rtol=4.0 / (2.0 * COUNT) ** 0.5, atol=0.0)
    assert np.allclose(rates.std(axis=0), VELOCITY, rtol=4.0 / (2.0 * COUNT) ** 0.5, atol=0.0)
    places = np.array([in_world(*one)[0] for one in made])
    assert np.allclose(places[:, 1:].std(axis=0), 2.0**0.5 * POSITION, rtol=4.0 / (2.0 * COUNT) ** 0.5, atol=0.0)


@pytest.mark.parametrize("on_robot", [False, True])
def test_a_seed_gives_the_same_noise_and_leaves_the_rest_alone(on_robot: bool) -> None:
    (sample, geometry), again = (noisy(SAMPLE, GEOMETRY, np.random.default_rng(3), on_robot=on_robot) for _ in "12")
    assert (sample, geometry) == again
    kept = (sample.stamp, sample.orientation, sample.angular, geometry.stamp, geometry.frame_id)
    assert kept == (7, SAMPLE.orientation, SAMPLE.angular, 7, "base")
    assert all(isinstance(number, float) for point in (sample.position, *geometry.points) for number in point)
