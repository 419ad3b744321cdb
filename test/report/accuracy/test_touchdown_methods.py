"""Every method for touchdowns comes to the reference, at the order that it is known for."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from math import inf, log2
from pathlib import Path

import pytest
from mpmath import mp

from impact_predictor.mechanics.motion import next_touchdown
from impact_predictor.report.accuracy import compliant_peer, integrators, stepping
from impact_predictor.report.accuracy.touchdown_methods import (
    NODES,
    ballistic,
    constant_acceleration,
    constant_twist,
    exact,
    quadrature,
    regular_quadrature,
)
from impact_predictor.report.accuracy.touchdown_problems import falls
from impact_predictor.report.accuracy.touchdown_reference import distance, reference_of, size_of, time_error
from impact_predictor.report.accuracy.touchdown_scenes import (
    CRATE,
    SCENES,
    STICKS,
    Falling,
    Figure,
    Landing,
    standing,
)

GOLDEN = Path(__file__).parents[2] / "mechanics" / "golden" / "motion.json"
TILTED = Falling(standing(CRATE, 0.4, -0.5), CRATE.points, 0, CRATE.rho_squared, STICKS)
RELEASED = Falling(standing(CRATE, 0.4, 0.0), CRATE.points, 0, CRATE.rho_squared, STICKS)
RISING = Falling(standing(CRATE, 0.2, 0.6), CRATE.points, 0, CRATE.rho_squared, STICKS)
SLIPPING = falls("sliding", 1)[0]
THROWN = falls("flight", 1)[0]


reference = cache(reference_of)


def errors(fall: Falling, solve: Callable[[Falling], Landing | None]) -> tuple[float, float]:
    """Of time and twist."""
    right, landing = reference(fall), solve(fall)
    assert landing is not None
    apart = distance(landing.twist, right.twist, fall.rho_squared)
    return time_error(landing, right), apart / size_of(right.twist, fall.rho_squared)


@pytest.mark.parametrize("fall", json.loads(GOLDEN.read_text())["falls"][:6])
def test_the_reference_meets_the_golden_falls(fall: dict[str, str]) -> None:
    a, h, rho_squared, angle, omega = (float(fall[key]) for key in ("a", "h", "rho2", "phi0", "omega0"))
    figure = Figure(a, a, h, rho_squared)
    found = reference_of(Falling(standing(figure, angle, omega), figure.points, 0, rho_squared, inf))
    # The golden numbers belong to the decimal inputs, which the floats are only near to.
    assert float(found.time) == pytest.approx(float(fall["touchdown_time"]), rel=1e-14)
    assert float(found.twist[2]) == pytest.approx(float(fall["touchdown_omega"]), rel=1e-14)


@pytest.mark.parametrize("fall", [SLIPPING, THROWN], ids=["slipping", "thrown"])
def test_the_references_of_other_motions_meet_an_integration(fall: Falling) -> None:
    assert max(errors(fall, lambda problem: integrators.dop853(problem, 1e-13))) < 1e-11


def test_the_extrapolation_of_the_reference_keeps_forty_digits() -> None:
    fine = reference(SLIPPING)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("impact_predictor.report.accuracy.touchdown_reference.STEPS", 5)
        finer = reference_of(SLIPPING)
    with mp.workdps(60):
        assert abs(fine.time - finer.time) < mp.mpf(10) ** -38


@pytest.mark.parametrize("name", SCENES)
def test_the_problems_of_a_scene_end_in_the_touchdown_that_it_is_about(name: str) -> None:
    for fall in falls(name, 2):
        end = next_touchdown(*fall)
        assert end.motion is SCENES[name][4]
        assert max(errors(fall, exact)) < 1e-11
    assert falls(name, 4) == falls(name, 4)


@pytest.mark.parametrize("fall", [TILTED, RELEASED, RISING], ids=["falling", "at rest", "rising"])
def test_the_regular_quadrature_settles_within_sixteen_nodes(fall: Falling) -> None:
    found = [errors(fall, lambda problem, n=n: regular_quadrature(problem, n)) for n in NODES]  # type: ignore[misc]
    assert [time for time, _ in found[3:]] < [1e-13] * 3
    assert found[1][0] < 1e-2 * found[0][0]
    assert max(twist for _, twist in found) < 1e-14


def test_the_plain_quadrature_is_slow_only_where_the_body_rests() -> None:
    moving, resting = (
        [errors(fall, lambda f, n=n: quadrature(f, n))[0] for n in (8, 16, 32)]  # type: ignore[misc]
        for fall in (TILTED, RELEASED)
    )
    assert moving[-1] < 1e-12
    # The singular end leaves an error of the order 1 / n.
    for coarse, fine in pairwise(resting):
        assert log2(coarse / fine) == pytest.approx(1.0, abs=0.1)


def test_the_fixed_step_method_has_the_order_four() -> None:
    for fall in (TILTED, SLIPPING):
        coarse, fine = (errors(fall, lambda f, n=n: integrators.rk4(f, n)) for n in (16, 32))  # type: ignore[misc]
        assert log2(coarse[0] / fine[0]) == pytest.approx(4.0, abs=0.3)
        assert log2(coarse[1] / fine[1]) == pytest.approx(4.0, abs=0.3)


def test_the_adaptive_method_keeps_to_its_tolerance() -> None:
    for tolerance in (1e-6, 1e-9, 1e-12):
        assert max(errors(TILTED, lambda f, t=tolerance: integrators.dop853(f, t))) < 20 * tolerance  # type: ignore[misc]


@pytest.mark.parametrize("fall", [TILTED, SLIPPING, THROWN], ids=["turning", "slipping", "thrown"])
def test_time_stepping_has_the_order_one(fall: Falling) -> None:
    coarse, fine = (errors(fall, lambda f, h=h: stepping.touchdown(f, h)) for h in (1e-2, 1e-4))  # type: ignore[misc]
    # A hundredth of the step leaves about a hundredth of the error: where its grid meets the touchdown differs.
    assert max(coarse) < 0.1
    assert fine[0] < 0.04 * coarse[0]
    assert fine[1] < 0.04 * coarse[1]


def test_stiffer_contacts_come_nearer() -> None:
    soft, stiff = (errors(SLIPPING, lambda f, k=k: compliant_peer.touchdown(f, k)) for k in (1e4, 1e7))  # type: ignore[misc]
    assert stiff[0] < 0.01 * soft[0]
    assert stiff[1] < 0.01 * soft[1]


def test_extrapolations_are_right_for_the_motion_that_they_suppose() -> None:
    near = Falling(standing(CRATE, 1e-4, -0.5), CRATE.points, 0, CRATE.rho_squared, STICKS)
    for solve, order in ((constant_twist, 1e-2), (constant_acceleration, 1e-6)):
        assert errors(near, solve)[0] < order
    straight = THROWN._replace(state=THROWN.state._replace(omega=0.0))
    assert max(errors(straight, ballistic)) < 1e-14


def test_a_body_that_rises_has_no_touchdown_at_constant_twist() -> None:
    assert constant_twist(RISING) is None
    assert constant_acceleration(RISING) is not None
