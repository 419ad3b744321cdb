"""What the plan of HyQ tells, by signs and frames: its derivatives against its velocities."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from impact_predictor.bags.adapters import Adapted, readers
from impact_predictor.bags.read import Bag, read_messages

BAG = Path(__file__).parents[3] / "examples/hyq/hyq.bag"
TOPIC = "/xpp/state_des"
TYPE = "xpp_msgs/msg/RobotStateCartesian"
PERIOD = 0.0025


@pytest.fixture(scope="module")
def plan() -> list[Adapted]:
    with Bag(BAG) as bag:
        read = readers(bag, {TOPIC: TYPE})[TOPIC]
    return [read(message.data) for message in read_messages(BAG, {TOPIC: TYPE})]


@pytest.fixture(scope="module")
def turned(plan: list[Adapted]) -> Rotation:
    return Rotation.from_quat([one.sample.orientation for one in plan])


def rate(values: np.ndarray) -> np.ndarray:
    """Central differences in the middle of the record."""
    return (values[2:] - values[:-2]) / (2.0 * PERIOD)


def test_stamps_are_the_plans_own_at_400_hz(plan: list[Adapted]) -> None:
    stamps = [one.sample.stamp for one in plan]
    assert stamps == [one.geometry.stamp for one in plan]
    # Most of the plan's times are rounded down by 1 ns.
    assert np.allclose(stamps, 2_500_000 * np.arange(3601), rtol=0.0, atol=2.0)


def test_the_linear_twist_is_the_derivative_of_the_position_in_the_axes_of_the_body(
    plan: list[Adapted], turned: Rotation
) -> None:
    measured = rate(np.array([one.sample.position for one in plan]))
    told = turned.apply([one.sample.linear for one in plan])[1:-1]
    # Central differences of a spline whose acceleration jumps at its knots: 1.5e-3 there.
    assert np.abs(measured - told).max() < 2e-3
    assert np.abs(told).max() > 1.9


def test_the_angular_twist_is_that_of_the_orientation_in_the_axes_of_the_body(
    plan: list[Adapted], turned: Rotation
) -> None:
    in_body = (turned[:-2].inv() * turned[2:]).as_rotvec() / (2.0 * PERIOD)
    told = np.array([one.sample.angular for one in plan])[1:-1]
    # As above: 9e-4 at the knots. The orientation turns out of the world's axes, so the other frame is wrong by 0.3.
    assert np.abs(in_body - told).max() < 5e-3
    in_world = (turned[2:] * turned[:-2].inv()).as_rotvec() / (2.0 * PERIOD)
    assert np.abs(in_world - told).max() > 0.25


def test_the_velocities_of_the_feet_are_the_derivatives_of_their_points_in_the_body(plan: list[Adapted]) -> None:
    points = np.array([one.geometry.points for one in plan])
    told = np.array([one.geometry.velocities for one in plan])[1:-1]
    wrong = np.abs(rate(points) - told)
    # Feet stop within a period when they land: a central difference then sees half of their speed, up to 0.26 m/s.
    assert wrong.max() < 0.13
    assert np.quantile(wrong, 0.9) < 2e-3


def test_feet_that_stand_lie_still_on_the_ground(plan: list[Adapted], turned: Rotation) -> None:
    position = np.array([one.sample.position for one in plan])
    linear = turned.apply([one.sample.linear for one in plan])
    angular = turned.apply([one.sample.angular for one in plan])
    stands = np.array([one.stands for one in plan])
    for foot in range(4):
        arm = turned.apply([one.geometry.points[foot] for one in plan])
        moving = turned.apply([one.geometry.velocities[foot] for one in plan])
        # The plan's own numerical tolerance is 1e-10.
        assert np.abs((position + arm)[stands[:, foot], 2]).max() < 1e-9
        assert np.abs((linear + np.cross(angular, arm) + moving)[stands[:, foot]]).max() < 1e-9


def test_the_flags_have_49_touchdowns(plan: list[Adapted]) -> None:
    stands = np.array([one.stands for one in plan])
    assert (stands[1:] & ~stands[:-1]).sum(axis=0).tolist() == [12, 13, 12, 12]


def test_the_feet_are_left_right_front_and_hind(plan: list[Adapted]) -> None:
    left_front, right_front, left_hind, right_hind = np.sign(plan[0].geometry.points)[:, :2].tolist()
    assert [left_front, right_front, left_hind, right_hind] == [[1, 1], [1, -1], [-1, 1], [-1, -1]]
