"""Who stands, who strikes, in which plane, and what is left over."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from impact_predictor.prediction.planar import (
    ActiveContacts,
    Posture,
    contacts_of,
    inertia_about,
    plane_of,
    posture_of,
)
from impact_predictor.prediction.scene import InertiaTensor, Scene, triple
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


LOW, FAR = 1.2 * FLOOR.tolerance, 100.0 * FLOOR.tolerance


@pytest.mark.parametrize(
    ("gaps", "rates", "expected"),
    [
        # The edge, or the point, that closes next strikes.
        ([0.0, 0.001, 0.05, 0.05, 0.3], [0.0, 0.01, -0.5, -0.5, -0.2], ((0, 1), (2, 3))),
        ([0.0, 0.02, 0.05], [0.0, -0.5, -0.9], ((0,), (1,))),
        ([0.1, 0.2], [-1.0, -1.0], ((), (0,))),
        # A point that rushes through the tolerance does not stand: a fifth of the fastest one's speed is the limit.
        ([0.004, 0.2], [-1.0, -1.0], ((), (0,))),
        ([0.0, 0.05], [-0.19, -1.0], ((0,), (1,))),
        ([0.0, 0.05], [-0.21, -1.0], ((), (0,))),
        ([0.0, 0.05], [0.19, -1.0], ((0,), (1,))),
        ([0.0, 0.05], [0.21, -1.0], ((), (1,))),
        # It stands up to the tolerance above the support.
        ([0.0049, 0.05], [0.0, -1.0], ((0,), (1,))),
        ([0.0051, 0.05], [0.0, -1.0], ((), (1,))),
        ([-0.1, 0.05], [0.0, -1.0], ((0,), (1,))),
        # A body that lifts off, that rests on a face, or of which only what stands approaches.
        ([0.0, 0.0], [0.3, 0.3], None),
        ([0.0, 0.0, 0.0, 0.0], [0.001, -0.001, 0.0, 0.001], None),
        ([0.0, 0.1], [-0.1, 1.0], None),
        # The approach must beat gravity within the contact time.
        ([0.0, 0.01], [0.0, -0.99 * SLOW], None),
        ([0.0, 0.01], [0.0, -1.01 * SLOW], ((0,), (1,))),
        # At the top of its rocking on point 0 point 1 is near, and point 2, further out, closes a little faster:
        # while the one that comes first hardly moves no later one is taken for it.
        ([0.0, LOW, FAR], [0.0, -0.9 * SLOW, -1.5 * SLOW], None),
        ([0.0, LOW, FAR], [0.0, -1.1 * SLOW, -1.8 * SLOW], ((0,), (1,))),
        ([0.0, FAR, LOW], [0.0, -0.9 * SLOW, -1.5 * SLOW], ((0,), (2,))),
        # What closes within the contact time strikes together, as seen from the standing points: these are 4 mm up.
        ([0.100, 0.104, 0.106], [-1.0, -1.0, -1.0], ((), (0, 1))),
        ([0.004, 0.005, 0.013], [0.0, -0.5, -1.0], ((0,), (1,))),
        ([0.0, 0.005, 0.013], [0.0, -0.5, -1.0], ((0,), (1, 2))),
        # A point below the support that moves down closes at once.
        ([0.0, -0.01, 0.02], [0.0, -0.5, -0.5], ((0,), (1,))),
        ([0.0, -0.01, 0.002], [0.0, -0.5, -0.5], ((0,), (1, 2))),
    ],
)
def test_which_points_stand_and_which_strike_next(
    gaps: list[float], rates: list[float], expected: tuple[tuple[int, ...], tuple[int, ...]] | None
) -> None:
    contacts = contacts_of(FLOOR, over_floor(gaps, rates))
    assert (None if contacts is None else (contacts.old, contacts.new)) == expected


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


BOX = tuple(triple([x, y, z]) for x, y, z in product((-0.5, 0.5), (-0.4, 0.4), (-0.3, 0.3)))
BACK, FRONT = (0, 2), (4, 6)
"""The lower edges along y."""


def on_back_edge(spin: Array, velocity: Array, center: Vector3 = (0.0, 0.0, 0.0)) -> tuple[Scene, Sample, Posture]:
    """A box, level and just above the floor, that moves anyhow."""
    scene = FLOOR._replace(center_of_mass=center)
    sample = sample_of(np.array([0.0, 0.0, 0.3]) + center, Rotation.identity(), velocity, spin, center)
    return scene, sample, posture_of(scene, BOX, sample)


def test_a_body_on_a_corner_turns_about_the_part_of_its_spin_in_the_support() -> None:
    scene, sample, posture = on_back_edge(np.array([0.6, 0.8, 5.0]), np.zeros(3))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts((2,), (4,)))
    assert plane.axis == pytest.approx((0.6, 0.8, 0.0), abs=ROUNDING)
    assert plane.off_axis == pytest.approx(5.0 / math.sqrt(26.0), abs=ROUNDING)


def test_a_body_that_hardly_turns_is_turned_towards_its_new_contact() -> None:
    # Noise of a few mrad/s, which would point the plane anywhere.
    noise = np.array([0.003, -0.002, 0.001])
    scene, sample, posture = on_back_edge(noise, np.array([0.0, 0.0, -1.0]))
    stood = plane_of(scene, BOX, sample, posture, ActiveContacts((0,), (4,)))
    assert stood.ahead == pytest.approx((1.0, 0.0, 0.0), abs=ROUNDING)
    flown = plane_of(scene, BOX, sample, posture, ActiveContacts((), (6,)))
    across = np.array([0.5, 0.4, 0.0]) / math.hypot(0.5, 0.4)
    assert flown.ahead == pytest.approx(across, abs=ROUNDING)
    assert flown.new == pytest.approx((math.hypot(0.5, 0.4), -0.3), abs=ROUNDING)
    assert flown.offset == pytest.approx(0.0, abs=ROUNDING)


def test_a_body_that_drops_flat_without_turning_is_turned_against_its_sliding() -> None:
    scene, sample, posture = on_back_edge(np.zeros(3), np.array([-0.6, 0.8, -1.0]))
    plane = plane_of(scene, BOX, sample, posture, ActiveContacts((), (0, 2, 4, 6)))
    assert plane.ahead == pytest.approx((-0.6, 0.8, 0.0), abs=ROUNDING)
    assert plane.off_axis == 0.0


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
