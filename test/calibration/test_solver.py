"""Impacts of touchdowns solved at once: the same, to the last bit, as each by itself."""

from __future__ import annotations

import numpy as np
import pytest

from impact_predictor.calibration.solver import Solver
from impact_predictor.calibration.touchdowns import (
    Coefficients,
    ScoredTouchdown,
    scaled,
    solve_across,
    with_coefficients,
)
from impact_predictor.mechanics.bodies import plate
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Twist
from impact_predictor.prediction.impact import Collision, LateralMotion
from impact_predictor.prediction.planar import ActiveContacts, ImpactPlane
from impact_predictor.prediction.scene import Scene, inertia_matrix

PLANE = ImpactPlane(
    (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), None, (0.0, 0.0), Twist(0.0, 0.0, 0.0), (0.0,) * 3, 0.0, 0.0, 0.0
)
SCENE = Scene(1.0, inertia_matrix([0.1]), friction=0.3, restitution=0.1)


def touchdowns() -> list[ScoredTouchdown]:
    """Plates by both laws, with and without a contact that stands, some of which slip across their planes too."""
    rng = np.random.default_rng(1)
    made = []
    for k in range(24):
        body = plate(length=1.0, height=rng.uniform(0.2, 1.5), mass=rng.uniform(0.5, 2.0), friction=0.3)
        if k % 3 == 0:
            body = body._replace(old=None)
        before = plate(length=1.0, height=0.4, mass=1.0, friction=0.3).turning(omega=-rng.uniform(1.0, 3.0))
        across = LateralMotion(rng.uniform(0.2, 0.5) if k % 2 else 0.0, 0.0, 0.0)
        scene = SCENE._replace(law="total" if k % 5 == 0 else "path", transverse_slip=k % 7 != 0)
        impact = Collision(
            ActiveContacts((0,), (1,)), PLANE, body, before, across, (0.0, 0.0), 0.1, 0.0, True, 1.0, 1.0
        )
        made.append(ScoredTouchdown("", k, scene, impact, Twist(0.1 * k, 0.0, -0.2), rng.uniform(0.3, 0.6)))
    return made


def after(one: ScoredTouchdown, coefficients: Coefficients) -> Twist:
    """The twist after one touchdown, solved by itself."""
    body = with_coefficients(one.impact.body, coefficients)
    twist = solve_impact(body, one.impact.before, one.scene.law, one.scene.validity).twist
    return solve_across(one.scene, one.impact, coefficients) or twist


@pytest.mark.parametrize(
    "coefficients", [Coefficients(0.3, 0.1), Coefficients(0.0, 0.5, 1.3), Coefficients(100.0, 1.0, 0.5)]
)
def test_all_at_once_is_each_by_itself(coefficients: Coefficients) -> None:
    some = touchdowns()
    solver = Solver(some)
    alone = [after(one, coefficients) for one in some]
    assert solver.after(coefficients).tolist() == [list(one) for one in alone]
    plane = [after(one._replace(scene=one.scene._replace(transverse_slip=False)), coefficients) for one in some]
    # Without friction nothing that happens across the plane matters.
    assert sum(one != other for one, other in zip(alone, plane, strict=True)) == (8 if coefficients.friction else 0)
    missed = solver.misses(coefficients)
    for one, twist, (along, turning) in zip(some, alone, missed.tolist(), strict=True):
        assert along == (twist.vx - one.measured.vx) / one.speed
        assert turning == (twist.omega - one.measured.omega) * one.half_distance / one.speed


def test_another_inertia_is_that_of_a_body_that_has_it_in_its_plane_and_across_it() -> None:
    for one in touchdowns():
        body = one.impact.body
        heavy = one._replace(
            scene=one.scene._replace(inertia=scaled(one.scene.inertia, 1.3)),
            impact=one.impact._replace(body=body._replace(inertia=1.3 * body.inertia)),
        )
        assert after(heavy, Coefficients(0.3, 0.1)) == after(one, Coefficients(0.3, 0.1, 1.3))
