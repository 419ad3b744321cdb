"""Vectors and rotations against numpy and scipy."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from impact_predictor.prediction.types import Quaternion, Vector3
from impact_predictor.prediction.vectors import (
    add,
    any_across,
    axes_of,
    combine,
    cross,
    dot,
    mean,
    times,
    to_body,
    to_world,
    turned,
)

ROUNDING = 1e-14
"""Some tens of roundings of numbers of size one."""


def vector(rng: random.Random) -> Vector3:
    return rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)


def quaternion(rng: random.Random) -> Quaternion:
    x, y, z, w = Rotation.random(random_state=rng.randrange(2**31)).as_quat()
    return float(x), float(y), float(z), float(w)


@pytest.mark.parametrize("seed", range(10))
def test_products_sums_and_means_are_those_of_numpy(seed: int) -> None:
    rng = random.Random(seed)
    u, v, w = vector(rng), vector(rng), vector(rng)
    a, b, c = vector(rng)
    assert dot(u, v) == pytest.approx(np.dot(u, v), abs=ROUNDING)
    assert cross(u, v) == pytest.approx(np.cross(u, v), abs=ROUNDING)
    assert add(u, v, a) == pytest.approx(np.add(u, np.multiply(a, v)), abs=ROUNDING)
    assert times(u, a) == pytest.approx(np.multiply(a, u), abs=ROUNDING)
    assert combine(a, u, b, v, c, w) == pytest.approx(np.array([a, b, c]) @ np.array([u, v, w]), abs=ROUNDING)
    assert mean([u, v, w]) == pytest.approx(np.mean([u, v, w], axis=0), abs=ROUNDING)


@pytest.mark.parametrize("seed", range(10))
def test_vectors_go_between_body_and_world_as_the_orientation_says(seed: int) -> None:
    rng = random.Random(seed)
    orientation, u = quaternion(rng), vector(rng)
    axes = axes_of(orientation)
    assert to_world(axes, u) == pytest.approx(Rotation.from_quat(orientation).apply(u), abs=ROUNDING)
    assert to_body(axes, u) == pytest.approx(Rotation.from_quat(orientation).inv().apply(u), abs=ROUNDING)


@pytest.mark.parametrize("length", [0.9995, 1.0005])
def test_axes_of_a_quaternion_that_is_not_quite_unit_are_orthonormal(length: float) -> None:
    x, y, z, w = quaternion(random.Random(1))
    axes = np.array(axes_of((length * x, length * y, length * z, length * w)))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=ROUNDING)


@pytest.mark.parametrize("seed", range(10))
def test_a_body_turns_about_a_vector_of_its_own_frame(seed: int) -> None:
    rng = random.Random(seed)
    orientation, rotation = quaternion(rng), vector(rng)
    expected = Rotation.from_quat(orientation) * Rotation.from_rotvec(rotation)
    answer = Rotation.from_quat(turned(orientation, rotation))
    assert (answer.inv() * expected).magnitude() < ROUNDING


def test_a_turned_orientation_is_unit_whatever_the_length_before() -> None:
    orientation: Quaternion = (0.6003, 0.0, 0.0, 0.8004)
    assert math.hypot(*turned(orientation, (0.1, 0.2, 0.3))) == pytest.approx(1.0, abs=ROUNDING)
    assert turned(orientation, (0.0, 0.0, 0.0)) == pytest.approx((0.6, 0.0, 0.0, 0.8), abs=ROUNDING)


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.0, -0.8)])
def test_across_any_direction_there_is_a_coordinate_axis(direction: Vector3) -> None:
    assert abs(dot(any_across(direction), direction)) < 0.6
