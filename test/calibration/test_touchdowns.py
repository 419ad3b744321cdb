"""Touchdowns with their impacts: solved anew they are what was predicted."""

from __future__ import annotations

from math import inf, radians
from pathlib import Path

import numpy as np
import pytest

from impact_predictor.bags.replay import replay
from impact_predictor.calibration.solver import Solver
from impact_predictor.calibration.touchdowns import Coefficients, ObservingMonitor, ScoredTouchdown
from impact_predictor.commands.replay import read_scenes
from impact_predictor.prediction.scene import Scene, inertia_matrix
from impact_predictor.resources import find
from impact_predictor.scenarios.record import rocking_actor, write_record
from impact_predictor.scenarios.rocking import release, rocking_plate

FRICTION, RESTITUTION = 0.15, 0.1
SCENE = Scene(
    1.0,
    inertia_matrix([1.16 / 12.0]),
    FRICTION,
    RESTITUTION,
    tolerance=1e-3,
    contact_time=1e-3,
)


def observed(path: Path, scene: Scene) -> list[ScoredTouchdown]:
    monitor = ObservingMonitor({"": scene})
    replay(path, scene, monitor=monitor)
    return monitor.touchdowns


def cube_scene() -> Scene:
    return read_scenes(str(find("config/cube_tosses.yaml")))[""]


@pytest.mark.slow
def test_a_touchdown_solved_with_the_coefficients_of_the_scene_is_the_predicted_one() -> None:
    scene = cube_scene()
    monitor = ObservingMonitor({"": scene})
    scores = [one.score for one in replay(find("examples/cube_tosses"), scene, monitor=monitor).settled]
    predicted = {score.stamp: score for score in scores if score.scored}
    given = Coefficients(scene.friction, scene.restitution)
    assert len(monitor.touchdowns) == len(predicted) > 100
    solver = Solver(monitor.touchdowns)
    errors = np.hypot(*solver.misses(given).T)
    for one, error, after in zip(monitor.touchdowns, errors, solver.after(given).tolist(), strict=True):
        score = predicted[one.stamp]
        assert after == list(score.touchdown.after)
        assert one.measured == score.measured
        assert error == pytest.approx(score.relative_error)
        # The approach, begun anew from the sample, is the same to the last bit.
        assert one.approached(given).impact == one.impact


def record(path: Path, degrees: float) -> Path:
    """A bag of a plate that is released at an angle."""
    rocker = rocking_plate(1.0, 0.4, None, None, 1.0, FRICTION, None, RESTITUTION)
    write_record(path, [rocking_actor("plate", release(rocker, radians(degrees)).run)], 1000.0)
    return path


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("bags") / "plate.mcap", 25.0)


def test_what_gravity_adds_after_a_touchdown_is_taken_off(plate: Path) -> None:
    one = observed(plate, SCENE)[0]
    # Of a simulation without noise, the truth to the curvature of its motion within 4 ms.
    assert np.hypot(*Solver([one]).misses(Coefficients(FRICTION, RESTITUTION))[0]) < 1e-4
    assert one.bend < 1e-4


def test_a_wrong_friction_before_the_touchdown_is_put_right(plate: Path) -> None:
    truth = Coefficients(FRICTION, RESTITUTION)
    (wrong, *_), (right, *_) = observed(plate, SCENE._replace(friction=0.5)), observed(plate, SCENE)
    assert wrong.impact.before != right.impact.before
    assert wrong.approached(truth).impact.before == right.impact.before


def test_twists_that_hold_another_impact_are_bent(tmp_path: Path) -> None:
    first, second = observed(record(tmp_path / "low.mcap", 3.0), SCENE)[:2]
    assert first.bend < 1e-3
    # The second bounce of so low a plate is over within the four samples.
    assert second.bend > 0.02


def test_an_approach_no_faster_than_gravity_makes_it_in_four_samples_counts_as_bent(tmp_path: Path) -> None:
    low = record(tmp_path / "low.mcap", 3.0)
    slow = observed(low, SCENE._replace(contact_time=1e-5, tolerance=1e-6))[-1]
    _, vy, omega = slow.impact.before
    # The fourth sample is at least 3 ms after it.
    assert -(vy + omega * slow.impact.body.new.x) < 9.81 * 3e-3
    assert slow.bend == inf


def test_an_averaged_twist_is_taken_as_it_is_scored(plate: Path) -> None:
    assert all(one.bend == 0.0 for one in observed(plate, SCENE._replace(twist_window=1e-3)))
