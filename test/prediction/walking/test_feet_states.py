"""Feet that are told by their names, with velocities and forces where these are measured."""

from __future__ import annotations

from math import nan

import pytest

from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import FeetStates, Geometry, Sample, Status, Vector3

ZEROS = (0.0,) * 36
LEFT: tuple[Vector3, ...] = ((0.1, 0.2, -0.5), (0.3, 0.2, -0.5))
RIGHT: tuple[Vector3, ...] = ((0.1, -0.2, -0.4), (0.3, -0.2, -0.4))
ARM: Vector3 = (0.5, 0.0, 0.3)
MOVING: tuple[Vector3, ...] = tuple((0.1 * k, 0.0, -0.2) for k in range(4))
NAMES = ("right", "left", "arm", "right", "left")
TOLD = FeetStates(
    stamp=10**9,
    frame_id="base",
    names=NAMES,
    positions=(RIGHT[0], LEFT[0], ARM, RIGHT[1], LEFT[1]),
    velocities=(MOVING[2], MOVING[0], ARM, MOVING[3], MOVING[1]),
)


@pytest.fixture
def machine() -> Predictor:
    inertia = ((0.5, 0.0, 0.0), (0.0, 0.6, 0.0), (0.0, 0.0, 0.7))
    return Predictor(Scene(20.0, inertia, 0.6, walking=Walking(("left", "right"), points=2, force=50.0)))


def sample(stamp: int) -> Sample:
    still = (0.0, 0.0, 0.0)
    return Sample(stamp, "", "base", (0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0), still, still, ZEROS, ZEROS)


def test_points_come_in_the_order_of_the_scene_whatever_the_order_of_the_message(machine: Predictor) -> None:
    assert machine.tell(TOLD) is Status.ACCEPTED
    assert machine.contacts.geometry == Geometry(10**9, "base", LEFT + RIGHT, MOVING)


def test_velocities_may_be_left_out_or_not_be_measured(machine: Predictor) -> None:
    for velocities in ((), ((nan, nan, nan),) * 5):
        assert machine.tell(TOLD._replace(stamp=10**9 + len(velocities), velocities=velocities)) is Status.ACCEPTED
        assert machine.contacts.geometry is not None
        assert machine.contacts.geometry.velocities == ()


def test_points_that_are_told_by_order_too_count_only_while_none_are_told_by_name(machine: Predictor) -> None:
    plain = Geometry(10**9 + 1, "base", RIGHT + LEFT)
    machine.tell(TOLD)
    assert machine.tell(plain) is Status.ACCEPTED
    assert machine.contacts.geometry == Geometry(10**9, "base", LEFT + RIGHT, MOVING)
    later = plain._replace(stamp=2 * 10**9)
    assert machine.tell(later) is Status.ACCEPTED
    assert machine.contacts.geometry == later


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"names": ("right", "left", "arm", "right", "toe")}, Status.FEET_CHANGED),
        ({"names": ("right", "left", "left", "right", "left")}, Status.FEET_CHANGED),
        ({"names": ()}, Status.FEET_CHANGED),
        ({"positions": TOLD.positions[:4]}, Status.MALFORMED),
        ({"velocities": TOLD.velocities[:4]}, Status.MALFORMED),
        ({"forces": TOLD.velocities[:1]}, Status.MALFORMED),
        ({"positions": ((nan, 0.0, 0.0), *TOLD.positions[1:])}, Status.NOT_FINITE),
        ({"stamp": 10**9}, Status.STAMP_REPEATED),
    ],
)
def test_what_does_not_fit_the_feet_is_refused_and_leaves_the_last(machine: Predictor, change, status) -> None:
    machine.tell(TOLD)
    before = machine.contacts.geometry
    assert machine.tell(TOLD._replace(**{"stamp": 10**9 + 1, **change})) is status
    assert machine.contacts.geometry == before


def test_the_forces_on_the_points_of_a_foot_together_confirm_that_it_stands(machine: Predictor) -> None:
    # 60 N on the two points of the left foot, of which each alone is below the 50 N of the scene; none on the right.
    pressed, free = (0.0, 0.0, 30.0), (0.0, 0.0, 0.0)
    for k in range(20):
        stamp = 10**9 + k * 2_500_000
        machine.tell(TOLD._replace(stamp=stamp, velocities=(), forces=(free, pressed, ARM, free, pressed)))
        answer = machine.update(sample(stamp))
    assert [(foot.stands, foot.confirmed) for foot in answer.feet] == [(True, True), (False, True)]
