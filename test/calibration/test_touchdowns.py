"""Touchdowns of replays: solved anew they are what was predicted."""

from __future__ import annotations

from math import radians
from pathlib import Path

import numpy as np
import pytest
from boxes import touchdowns as boxes
from touchdowns import SCORE, TOUCHDOWN

from impact_predictor import read_scenes
from impact_predictor.bags.body import Settled
from impact_predictor.bags.replay import replay
from impact_predictor.calibration.solver import Coefficients, Solver, lengths
from impact_predictor.calibration.touchdowns import touchdowns_of
from impact_predictor.mechanics.bodies import cylinder
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, solve_spatial_impact
from impact_predictor.mechanics.types import Twist
from impact_predictor.prediction.planar import hardly
from impact_predictor.prediction.scene import Scene, inertia_matrix
from impact_predictor.resources import find
from impact_predictor.scenarios.record import rocking_actor, write_record
from impact_predictor.scenarios.rocking import release, rocking_plate


@pytest.mark.slow
def test_a_touchdown_solved_with_the_coefficients_of_the_scene_is_the_predicted_one() -> None:
    scenes = read_scenes(str(find("config/cube_tosses.yaml")))
    scene = scenes[""]._replace(samples=0)
    settled = replay(find("examples/cube_tosses"), scene).settled
    found = touchdowns_of(settled, scenes)
    scored = sum(one.score.spatial is not None and not one.score.leftover_6d for one in settled)
    # Six motions were recorded twice, turned about the vertical.
    assert 1000 < len(found) < scored
    missed = lengths(Solver(found).misses(Coefficients(scene.friction, scene.restitution, scene.merge)))
    assert missed == pytest.approx([one.score.error for one in found if one.score], abs=1e-9)


def test_a_plate_that_rocks_is_solved_as_it_was_simulated(tmp_path: Path) -> None:
    """By a law in three dimensions, with energetic restitution; the simulation knows the plane and Poisson's."""
    rocker = rocking_plate(1.0, 0.4, None, None, 1.0, 0.15, None, 0.1)
    write_record(tmp_path / "plate.mcap", [rocking_actor("plate", release(rocker, radians(25.0)).run)], 1000.0)
    scene = Scene(1.0, inertia_matrix([1.16 / 12.0]), 0.15, 0.1, tolerance=1e-3, contact_time=1e-3)
    found = touchdowns_of(replay(tmp_path / "plate.mcap", scene).settled, {"": scene})
    assert found
    solver = Solver(found)
    # What a few frames of 4 ms are not sharp enough for.
    assert lengths(solver.misses(Coefficients(0.15, 0.1, 1.5e-3))).max() < 0.02
    assert lengths(solver.misses(Coefficients(0.4, 0.1, 1.5e-3))).max() > 0.05


def test_a_cylinder_between_two_edges_is_solved_in_its_plane() -> None:
    body = cylinder(radius=0.3, gamma=0.5, mass=2.0, friction=0.4)
    before = body.turning(omega=-2.0)
    after = solve_impact(body, before).twist
    assert body.old is not None
    edges = ((body.old.x, 0.0, 0.0), (body.new.x, 0.0, 0.0))
    scene = Scene(2.0, inertia_matrix([float(body.inertia)]), 0.4, radius=0.3, edges=edges)
    touchdown = TOUCHDOWN._replace(
        before=before, old=(0,), new=(1,), axis=(0.0, 1.0, 0.0), position=(0.0, 0.0, -body.new.y), half_distance=0.1
    )
    score = SCORE._replace(touchdown=touchdown._replace(orientation=(0.0, 0.0, 0.0, 1.0)), measured=after, scored=True)
    (found,) = touchdowns_of([Settled("drum", score, None)], {"": scene})
    missed = Solver([found]).misses(Coefficients(0.4, 0.0, 1.5e-3))
    # The law in three dimensions goes in steps.
    assert np.abs(missed).max() < 5e-3
    vx, vy, omega = Twist(*after)
    assert found.measured == pytest.approx([vx, 0.0, vy, 0.0, -omega, 0.0])


@pytest.mark.parametrize(
    "coefficients", [Coefficients(0.3, 0.1, 2e-3), Coefficients(0.0, 0.5, 1e-3, 1.3), Coefficients(100.0, 1.0, 8e-3)]
)
def test_all_at_once_is_each_by_itself(coefficients: Coefficients) -> None:
    some = boxes(number=12)
    friction, restitution, merge, factor = coefficients
    for one, after in zip(some, Solver(some).after(coefficients), strict=True):
        rates = one.twist[2] + np.cross(one.twist[3:], one.arms)[:, 2]
        struck = int(np.argmin(np.where(rates < 0.0, -one.gaps / rates, np.inf)))
        due = np.where(rates < 0.0, -one.gaps / rates, np.inf) + one.gaps[struck] / rates[struck]
        new = np.flatnonzero(due <= 2.0 * merge)
        contacts = ContactPoints(one.arms[new], friction, restitution, gaps=-due[new] * rates[new])
        body = Body(one.scene.mass, factor * one.inertia)
        alone = solve_spatial_impact(body, contacts, one.twist, "path", merge, hardly(one.scene))
        assert alone.twist == pytest.approx(after, abs=1e-9)
