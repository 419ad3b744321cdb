"""Who stands, who strikes, in which plane, and what is left over."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.types import Contact, Twist, TwoPointBody
from impact_predictor.prediction.impact import Collision, in_space, lateral_motion
from impact_predictor.prediction.planar import (
    ActiveContacts,
    Posture,
    contacts_of,
    edge_of,
    inertia_about,
    plane_of,
    posture_of,
)
from impact_predictor.prediction.scene import InertiaTensor, Scene
from impact_predictor.prediction.types import Sample, Vector3

ROUNDING = 1e-13
"""Some hundred roundings of numbers of size one."""

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
FLOOR = Scene(1.0, AXES, 0.5, tolerance=0.005, contact_time=0.005)
SLOW = 0.005 * 9.81
"""What gravity gives within the contact time, in m/s."""

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def over_floor(gaps: list[float], rates: list[float]) -> Posture:
    return Posture(AXES, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), gaps, rates)


def who(gaps: list[float], rates: list[float], scene: Scene = FLOOR) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
    contacts = contacts_of(scene, over_floor(gaps, rates))
    return None if contacts is None else (contacts.old, contacts.new)


def triple(array: Array | list[float]) -> Vector3:
    x, y, z = (float(part) for part in array)
    return x, y, z


def sample_of(
    position: Array, orientation: Rotation, velocity: Array, spin: Array, center: Vector3 = (0.0, 0.0, 0.0)
) -> Sample:
    """A sample whose mass centre (not the origin) has a place and a velocity, in the world frame."""
    x, y, z, w = (float(part) for part in orientation.as_quat())
    arm = orientation.apply(center)
    return Sample(
        0,
        "",
        "",
        triple(position - arm),
        (x, y, z, w),
        triple(orientation.inv().apply(velocity - np.cross(spin, arm))),
        triple(orientation.inv().apply(spin)),
        (),
        (),
    )


def test_a_body_on_an_edge_strikes_with_the_edge_that_closes_next() -> None:
    assert who([0.0, 0.001, 0.05, 0.05, 0.3], [0.0, 0.01, -0.5, -0.5, -0.2]) == ((0, 1), (2, 3))


def test_a_body_on_a_corner_strikes_with_the_point_that_closes_first() -> None:
    assert who([0.0, 0.02, 0.05], [0.0, -0.5, -0.9]) == ((0,), (1,))


def test_in_flight_no_point_stands() -> None:
    assert who([0.1, 0.2], [-1.0, -1.0]) == ((), (0,))


def test_a_point_that_rushes_through_the_tolerance_does_not_stand() -> None:
    assert who([0.004, 0.2], [-1.0, -1.0]) == ((), (0,))


@pytest.mark.parametrize(("rate", "stands"), [(-0.19, True), (-0.21, False), (0.19, True), (0.21, False)])
def test_a_point_stands_up_to_a_fifth_of_the_fastest_points_speed(rate: float, stands: bool) -> None:
    contacts = who([0.0, 0.05], [rate, -1.0])
    assert contacts is not None
    assert (0 in contacts[0]) is stands


@pytest.mark.parametrize(("gap", "stands"), [(0.0049, True), (0.0051, False), (-0.1, True)])
def test_a_point_stands_up_to_the_tolerance_above_the_support(gap: float, stands: bool) -> None:
    contacts = who([gap, 0.05], [0.0, -1.0])
    assert contacts is not None
    assert (0 in contacts[0]) is stands


def test_a_body_that_lifts_off_has_no_touchdown_ahead() -> None:
    assert who([0.0, 0.0], [0.3, 0.3]) is None


def test_a_body_at_rest_on_a_face_has_no_touchdown_ahead() -> None:
    assert who([0.0, 0.0, 0.0, 0.0], [0.001, -0.001, 0.0, 0.001]) is None


def test_the_approach_must_beat_gravity_within_the_contact_time() -> None:
    assert who([0.0, 0.01], [0.0, -0.99 * SLOW]) is None
    assert who([0.0, 0.01], [0.0, -1.01 * SLOW]) == ((0,), (1,))


def test_while_the_point_that_comes_first_hardly_moves_no_later_one_is_taken_for_it() -> None:
    # A body at the top of its rocking on point 0: point 1 is 3 mm up, and point 2, further out, closes a little faster.
    low, far = 1.2 * FLOOR.tolerance, 100.0 * FLOOR.tolerance
    assert who([0.0, low, far], [0.0, -0.9 * SLOW, -1.5 * SLOW]) is None
    assert who([0.0, low, far], [0.0, -1.1 * SLOW, -1.8 * SLOW]) == ((0,), (1,))
    # One that comes later than the fast one does not matter.
    assert who([0.0, far, low], [0.0, -0.9 * SLOW, -1.5 * SLOW]) == ((0,), (2,))


def test_points_that_close_within_the_contact_time_strike_together() -> None:
    assert who([0.100, 0.104, 0.106], [-1.0, -1.0, -1.0]) == ((), (0, 1))


def test_closing_is_seen_from_the_standing_points() -> None:
    # The floor is 4 mm higher than the scene says: of the two that are left, the second closes 6 ms later.
    assert who([0.004, 0.005, 0.013], [0.0, -0.5, -1.0]) == ((0,), (1,))
    assert who([0.0, 0.005, 0.013], [0.0, -0.5, -1.0]) == ((0,), (1, 2))


def test_a_point_below_the_support_that_moves_down_closes_at_once() -> None:
    assert who([0.0, -0.01, 0.02], [0.0, -0.5, -0.5]) == ((0,), (1,))
    assert who([0.0, -0.01, 0.002], [0.0, -0.5, -0.5]) == ((0,), (1, 2))


def test_when_all_that_approach_stand_there_is_no_touchdown() -> None:
    assert who([0.0, 0.1], [-0.1, 1.0]) is None


@pytest.mark.parametrize("seed", range(5))
def test_gaps_and_rates_are_those_of_the_points_in_space(seed: int) -> None:
    rng = np.random.default_rng(seed)
    normal = Rotation.random(random_state=rng).apply([0.0, 0.0, 1.0])
    center = triple(rng.normal(size=3))
    scene = FLOOR._replace(normal=triple(normal), height=0.3, center_of_mass=center)
    points = tuple(triple(row) for row in rng.normal(size=(4, 3)))
    position, velocity, spin = rng.normal(size=(3, 3))
    orientation = Rotation.random(random_state=rng)
    posture = posture_of(scene, points, sample_of(position, orientation, velocity, spin, center))
    arms = orientation.apply(np.array(points) - center)
    assert posture.gaps == pytest.approx((position + arms) @ normal - 0.3, abs=ROUNDING)
    assert posture.rates == pytest.approx((velocity + np.cross(spin, arms)) @ normal, abs=ROUNDING)
    assert posture.velocity == pytest.approx(orientation.inv().apply(velocity), abs=ROUNDING)
    assert posture.normal == pytest.approx(orientation.inv().apply(normal), abs=ROUNDING)


BOX = tuple(triple([x, y, z]) for x, y, z in product((-0.5, 0.5), (-0.4, 0.4), (-0.3, 0.3)))
BACK, FRONT = (0, 2), (4, 6)
"""The lower edges along y."""


def on_back_edge(spin: Array, velocity: Array, center: Vector3 = (0.0, 0.0, 0.0)) -> tuple[Scene, Sample, Posture]:
    """A box, level and just above the floor, that moves anyhow."""
    scene = FLOOR._replace(center_of_mass=center)
    sample = sample_of(np.array([0.0, 0.0, 0.3]) + center, Rotation.identity(), velocity, spin, center)
    return scene, sample, posture_of(scene, BOX, sample)


def test_a_body_on_an_edge_turns_about_the_edge_however_it_spins() -> None:
    scene, sample, posture = on_back_edge(np.array([0.3, 1.0, 0.4]), np.array([0.1, 0.2, -0.5]))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts(BACK, FRONT, 0.0))
    assert plane.axis == pytest.approx((0.0, 1.0, 0.0), abs=ROUNDING)
    assert plane.ahead == pytest.approx((1.0, 0.0, 0.0), abs=ROUNDING)
    assert plane.old == pytest.approx((-0.5, -0.3), abs=ROUNDING)
    assert plane.new == pytest.approx((0.5, -0.3), abs=ROUNDING)
    assert plane.twist == pytest.approx((0.1, -0.5, -1.0), abs=ROUNDING)
    assert plane.gravity == pytest.approx((0.0, -9.81, 0.0), abs=ROUNDING)


def test_the_part_of_the_spin_off_the_axis_is_reported() -> None:
    scene, sample, posture = on_back_edge(np.array([0.3, 1.0, 0.4]), np.zeros(3))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts(BACK, FRONT, 0.0))
    assert plane.off_axis == pytest.approx(0.5 / math.sqrt(1.25), abs=ROUNDING)


def test_the_velocity_of_the_standing_contact_along_the_edge_is_reported() -> None:
    spin, velocity = np.array([0.3, 1.0, 0.4]), np.array([0.1, 0.2, -0.5])
    scene, sample, posture = on_back_edge(spin, velocity)
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts(BACK, FRONT, 0.0))
    assert plane.lateral == pytest.approx((velocity + np.cross(spin, [-0.5, 0.0, -0.3]))[1], abs=ROUNDING)


def test_contacts_beside_the_mass_centre_are_reported() -> None:
    scene, sample, posture = on_back_edge(np.array([0.0, 1.0, 0.0]), np.zeros(3), center=(0.0, 0.1, 0.0))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts(BACK, FRONT, 0.0))
    assert plane.offset == pytest.approx(0.1, abs=ROUNDING)
    for old, new, offset in ((BACK, (4,), 0.5), ((2,), FRONT, 0.3)):
        one_side = plane_of(scene, BOX, sample, posture, ActiveContacts(old, new, 0.0))
        assert one_side.offset == pytest.approx(offset, abs=ROUNDING)


def test_a_body_on_a_corner_turns_about_the_part_of_its_spin_in_the_support() -> None:
    scene, sample, posture = on_back_edge(np.array([0.6, 0.8, 5.0]), np.zeros(3))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts((2,), (4,), 0.0))
    assert plane.axis == pytest.approx((0.6, 0.8, 0.0), abs=ROUNDING)
    assert plane.off_axis == pytest.approx(5.0 / math.sqrt(26.0), abs=ROUNDING)


def test_two_standing_points_above_one_another_are_no_edge() -> None:
    scene, sample, posture = on_back_edge(np.array([0.6, 0.8, 0.0]), np.zeros(3))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts((0, 1), (4,), 0.0))
    assert plane.axis == pytest.approx((0.6, 0.8, 0.0), abs=ROUNDING)


def test_a_body_that_hardly_turns_is_turned_towards_its_new_contact() -> None:
    # Noise of a few mrad/s, which would point the plane anywhere.
    noise = np.array([0.003, -0.002, 0.001])
    scene, sample, posture = on_back_edge(noise, np.array([0.0, 0.0, -1.0]))
    stood = plane_of(scene, BOX, sample, posture, ActiveContacts((0,), (4,), 0.0))
    assert stood.ahead == pytest.approx((1.0, 0.0, 0.0), abs=ROUNDING)
    flown = plane_of(scene, BOX, sample, posture, ActiveContacts((), (6,), 0.0))
    across = np.array([0.5, 0.4, 0.0]) / math.hypot(0.5, 0.4)
    assert flown.ahead == pytest.approx(across, abs=ROUNDING)
    assert flown.new == pytest.approx((math.hypot(0.5, 0.4), -0.3), abs=ROUNDING)
    assert flown.offset == pytest.approx(0.0, abs=ROUNDING)


def test_a_body_that_drops_flat_without_turning_is_turned_against_its_sliding() -> None:
    scene, sample, posture = on_back_edge(np.zeros(3), np.array([-0.6, 0.8, -1.0]))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts((), (0, 2, 4, 6), 0.0))
    assert plane.ahead == pytest.approx((-0.6, 0.8, 0.0), abs=ROUNDING)
    assert plane.off_axis == 0.0


def test_a_body_that_drops_flat_and_plumb_has_a_plane_too() -> None:
    scene, sample, posture = on_back_edge(np.zeros(3), np.array([0.0, 0.0, -1.0]))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts((), (0, 2, 4, 6), 0.0))
    assert math.hypot(*plane.axis) == pytest.approx(1.0, abs=ROUNDING)
    assert plane.axis[2] == pytest.approx(0.0, abs=ROUNDING)


def test_the_edge_of_standing_points_joins_the_two_furthest_apart() -> None:
    points = [(0.0, 0.1, 0.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.9, 0.0)]
    assert np.abs(edge_of(points)) == pytest.approx((0.0, 1.0, 0.0), abs=ROUNDING)


def box_inertia(length: float, width: float, height: float) -> InertiaTensor:
    """Of a homogeneous box of mass 1."""
    x, y, z = length * length / 12.0, width * width / 12.0, height * height / 12.0
    return (y + z, 0.0, 0.0), (0.0, x + z, 0.0), (0.0, 0.0, x + y)


def test_a_box_resists_turning_about_its_diagonal_less_when_nothing_guides_it() -> None:
    scene = FLOOR._replace(inertia=box_inertia(1.0, 0.5, 0.3))
    diagonal = (math.sqrt(0.5), math.sqrt(0.5), 0.0)
    guided, free = (inertia_about(scene, diagonal, blocked) for blocked in (True, False))
    assert guided == pytest.approx((0.34 + 1.09) / 24.0, rel=ROUNDING)
    assert guided / free == pytest.approx(1.38, abs=0.005)


@pytest.mark.parametrize("seed", range(5))
def test_inertia_about_any_axis_is_that_of_the_whole_tensor(seed: int) -> None:
    rng = np.random.default_rng(seed)
    half = rng.normal(size=(3, 3))
    tensor = half @ half.T + 0.1 * np.eye(3)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    scene = FLOOR._replace(inertia=(triple(tensor[0]), triple(tensor[1]), triple(tensor[2])))
    assert inertia_about(scene, triple(axis), blocked=True) == pytest.approx(axis @ tensor @ axis, rel=1e-12)
    free = 1.0 / (axis @ np.linalg.inv(tensor) @ axis)
    assert inertia_about(scene, triple(axis), blocked=False) == pytest.approx(free, rel=1e-10)


def test_what_the_plane_leaves_over_goes_on_as_it_was() -> None:
    """A body that glides along the axis and spins about the normal, while it turns in the plane."""
    spin, velocity, time = np.array([0.0, 1.0, 0.3]), np.array([0.2, 0.7, -0.4]), 0.05
    scene, sample, posture = on_back_edge(spin, velocity, center=(0.1, 0.0, -0.1))
    contacts = ActiveContacts(BACK, FRONT, 0.0)
    plane = plane_of(scene, BOX, sample, posture, contacts)
    body = TwoPointBody(1.0, 1.0, None, Contact(0.0, -1.0, 0.5))
    collision = Collision(
        contacts, plane, body, Twist(0.2, -0.4, -1.0), (0.01, -0.02), -1.0 * time, time, True, 0.4, 0.4
    )
    lateral = lateral_motion(sample, posture, plane, time)
    assert lateral == pytest.approx((0.7, 0.0, 0.3), abs=ROUNDING)
    position, orientation, linear, angular = in_space(
        scene, sample, posture, collision, (0.0, 1.0, 0.0), lateral, Twist(0.3, 0.1, -0.5), lateral
    )
    turned = Rotation.from_rotvec(spin * time)
    center = np.array([0.1 + 0.01, 0.7 * time, 0.2 - 0.02])
    arm = turned.apply(scene.center_of_mass)
    new_spin, new_velocity = np.array([0.0, 0.5, 0.3]), np.array([0.3, 0.7, 0.1])
    assert (turned.inv() * Rotation.from_quat(orientation)).magnitude() < ROUNDING
    assert position == pytest.approx(center - arm, abs=ROUNDING)
    assert turned.apply(angular) == pytest.approx(new_spin, abs=ROUNDING)
    assert turned.apply(linear) == pytest.approx(new_velocity - np.cross(new_spin, arm), abs=ROUNDING)
