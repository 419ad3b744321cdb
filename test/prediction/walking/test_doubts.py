"""What is told where the ground of a scene does not fit the feet."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, Walking
from impact_predictor.prediction.types import Geometry, Sample, Status, Terrain

ZEROS = (0.0,) * 36
SCENE = Scene(20.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), 0.5, walking=Walking(("left", "right")))


def doubts(scene: Scene, gap: Callable[[int], float], terrain: Terrain | None = None) -> tuple[str, ...]:
    """Of a machine whose feet have gaps at 400 Hz, as `gap` tells by the number of the frame, for 2 s."""
    walker = Predictor(scene)
    if terrain is not None:
        assert walker.tell(terrain) is Status.ACCEPTED
    for k in range(800):
        stamp = 10**9 + 2_500_000 * k
        points = tuple((0.1, y, gap(k) - 0.5) for y in (0.1, -0.1))
        walker.tell(Geometry(stamp, "base", points))
        assert (
            walker.update(
                Sample(stamp, "world", "base", (0.0, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0), *[(0.0,) * 3] * 2, ZEROS, ZEROS)
            ).status
            is Status.ACCEPTED
        )
    return walker.contacts.doubts()


def test_feet_that_stand_leave_no_doubt() -> None:
    assert doubts(SCENE, lambda k: 0.0) == ()


def test_of_feet_that_stand_above_the_ground_the_height_and_the_radius_are_told() -> None:
    (found,) = doubts(SCENE, lambda k: 0.021)
    assert found.startswith(
        "feet stand 0.021 m above the ground: set support.height to 0.0210, or feet.radius to [0.021]"
    )
    balls = SCENE._replace(walking=Walking(("left", "right"), radius=(0.021,)))
    assert doubts(balls, lambda k: 0.021) == ()


def test_of_feet_that_stand_far_above_the_ground_no_ball_is_told_and_the_order_of_quaternions() -> None:
    (found,) = doubts(SCENE, lambda k: 0.6)
    assert found.startswith("feet stand 0.6 m above the ground: set support.height to 0.6000, or compare the units")
    assert found.endswith("the order of quaternions (x, y, z, w)")


def test_feet_that_never_stand_are_told_with_how_near_they_came() -> None:
    (found,) = doubts(SCENE, lambda k: 0.08 + 0.05 * np.sin(0.1 * k))
    assert found.startswith("no foot came nearer to the ground than 0.03 m: set support.height to 0.03")


def test_a_tolerance_below_the_noise_is_told_with_one_that_would_do() -> None:
    noise = np.random.default_rng(0).normal(0.0, 1e-3, 800)
    (found,) = doubts(SCENE._replace(tolerance=1e-3), lambda k: float(noise[k]))
    assert found.startswith(
        "the gaps of feet scatter by 0.001 m, too much for a contact.tolerance of 0.001: set that to 0.004"
    )


@pytest.mark.parametrize("stands", [True, False])
def test_feet_that_come_to_the_ground_and_never_rest_are_told(stands: bool) -> None:
    found = doubts(SCENE, lambda k: 0.0 if stands else 0.06 * abs(np.sin(0.05 * k)))
    assert len(found) == (not stands)
    assert all(one.startswith("no foot stood for ") for one in found)
