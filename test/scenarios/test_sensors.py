"""Poses of frames over planar motions and on frames that move, against rotations of scipy and differences in time."""

from __future__ import annotations

import numpy as np
import pytest

from impact_predictor.mechanics.motion.support import PlanarState
from impact_predictor.scenarios.sensors import (
    FORWARD,
    Mount,
    Odometer,
    Poses,
    SensorNoise,
    carried,
    poses,
    product,
    rotations,
)

Rotation = pytest.importorskip("scipy.spatial.transform", reason="the reference for rotations").Rotation

N = 20
EXACT = 1e-12
"""Rounding of numbers up to 10."""


def random_poses(rng: np.random.Generator) -> Poses:
    position, linear, angular = rng.uniform(-2.0, 2.0, (3, N, 3))
    return Poses(position, Rotation.random(N, random_state=rng).as_quat(), linear, angular)


def test_a_frame_moves_so_that_its_mass_centre_does_what_the_planar_motion_says() -> None:
    rng = np.random.default_rng(3)
    state = PlanarState(*rng.uniform(-2.0, 2.0, (6, N)))
    mount = Mount(beside=0.7, yaw=0.6, center=(0.3, -0.2, 0.5))
    seen = poses(state, FORWARD, mount)
    ahead, up, axis = map(np.array, FORWARD)
    turned = Rotation.from_rotvec(np.outer(state.angle, FORWARD.axis)) * Rotation.from_rotvec((0.0, 0.0, mount.yaw))
    center = turned.apply(mount.center)
    assert (Rotation.from_quat(seen.orientation).inv() * turned).magnitude().max() < 1e-7  # the square root of rounding
    assert np.abs(np.outer(state.x, ahead) + np.outer(state.y, up) + 0.7 * axis - seen.position - center).max() < EXACT
    assert np.abs(turned.apply(seen.angular) - np.outer(state.omega, axis)).max() < EXACT
    moved = turned.apply(seen.linear + np.cross(seen.angular, mount.center))
    assert np.abs(moved - np.outer(state.vx, ahead) - np.outer(state.vy, up)).max() < EXACT


def test_quaternions_turn_as_their_matrices_and_multiply_as_they_follow_each_other() -> None:
    rng = np.random.default_rng(4)
    first, second = Rotation.random(N, random_state=rng), Rotation.random(N, random_state=rng)
    assert np.abs(rotations(first.as_quat()) - first.as_matrix()).max() < EXACT
    made = rotations(product(first.as_quat(), second.as_quat()))
    assert np.abs(made - (first * second).as_matrix()).max() < EXACT


def test_what_is_seen_from_a_moving_frame_moves_in_the_world_as_the_difference_of_its_places() -> None:
    rng = np.random.default_rng(5)
    frame, seen = random_poses(rng), random_poses(rng)
    step = 1e-5

    def later(one: Poses, time: float) -> tuple[np.ndarray, Rotation]:
        turned = Rotation.from_quat(one.orientation)
        return one.position + time * turned.apply(one.linear), turned * Rotation.from_rotvec(time * one.angular)

    def placed(time: float) -> tuple[np.ndarray, Rotation]:
        (origin, deck), (place, own) = later(frame, time), later(seen, time)
        return origin + deck.apply(place), deck * own

    world = carried(frame, seen)
    (before, turned_before), (after, turned_after) = placed(-step), placed(step)
    place, turned = placed(0.0)
    assert np.abs(world.position - place).max() < EXACT
    assert np.abs(rotations(world.orientation) - turned.as_matrix()).max() < EXACT
    # Differences miss by the square of the step and by rounding over it.
    assert np.abs(turned.apply(world.linear) - (after - before) / (2.0 * step)).max() < 1e-8
    assert np.abs((turned_before.inv() * turned_after).as_rotvec() / (2.0 * step) - world.angular).max() < 1e-8


@pytest.mark.parametrize("noisy", ["position", "orientation", "velocity", "rate"])
def test_noise_of_one_kind_leaves_the_rest_of_a_sample_as_it_is(noisy: str) -> None:
    rng = np.random.default_rng(6)
    seen = random_poses(rng)
    odometer = Odometer("world", "crate", SensorNoise(**{noisy: 0.1}), rng)
    samples = list(odometer.samples(list(range(N)), seen))
    told = {"position": seen.position, "orientation": seen.orientation, "velocity": seen.linear, "rate": seen.angular}
    fields = {"position": "position", "orientation": "orientation", "velocity": "linear", "rate": "angular"}
    noises = {
        kind: np.abs(np.array([getattr(one, fields[kind]) for one in samples]) - told[kind]).max() for kind in told
    }
    assert {kind for kind, noise in noises.items() if noise > EXACT} == {noisy}
