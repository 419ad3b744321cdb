"""Every method of the report comes to what it stands for."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median

import pytest

from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.report.accuracy import impacts, touchdowns
from impact_predictor.report.accuracy.impacts import Aftermath, Struck
from impact_predictor.report.accuracy.measure import problems
from impact_predictor.report.accuracy.touchdowns import CRATE, FallingBody, PredictedTouchdown

PAPER = ("rod", "plate", "cylinder", "stiff")
COUNT = 12


def touchdown_error(fall: FallingBody, found: PredictedTouchdown | None) -> float:
    assert found is not None
    return max(touchdowns.errors_of(fall, found, touchdowns.reference_of(fall)))


@pytest.mark.parametrize("name", touchdowns.SCENES)
def test_the_methods_for_touchdowns_keep_to_their_tolerances(name: str) -> None:
    for fall in problems(touchdowns.SCENES, name, 4):
        assert touchdown_error(fall, touchdowns.own(fall)) < 1e-6
        if name != "balance":  # where an error grows a thousand times before the body moves
            assert touchdown_error(fall, touchdowns.integrated(fall, 1e-9)) < 1e-7
    assert problems(touchdowns.SCENES, name, 4) == problems(touchdowns.SCENES, name, 4)


def test_extrapolations_are_right_for_the_motion_that_they_suppose() -> None:
    near = CRATE.falling(1e-4, -0.5)
    assert touchdown_error(near, touchdowns.extrapolated(near, False)) < 1e-2
    assert touchdown_error(near, touchdowns.extrapolated(near, True)) < 1e-6
    rising = CRATE.falling(0.2, 0.6)
    assert touchdowns.extrapolated(rising, False) is None
    assert touchdowns.extrapolated(rising, True) is not None


def errors(name: str, solve: Callable[[Struck], Aftermath | None], count: int = COUNT) -> list[float]:
    found = []
    for strike in problems(impacts.SCENES, name, count):
        after = solve(strike)
        assert after is not None
        found.append(impacts.error_of_twist(strike, after, impacts.reference_of(strike)))
    return found


@pytest.mark.parametrize("name", PAPER)
@pytest.mark.parametrize("law", ["path", "total"])
def test_both_laws_are_the_closed_forms_on_the_bodies_of_the_paper(name: str, law: str) -> None:
    assert max(errors(name, lambda strike: impacts.law(strike, law))) < 1e-12
    for strike in problems(impacts.SCENES, name, COUNT):
        assert impacts.law(strike, law).mode is impacts.reference_of(strike).mode


def test_the_error_of_the_path_law_against_more_digits_is_rounding_and_that_of_the_total_law_is_not() -> None:
    assert max(errors("squat", lambda strike: impacts.law(strike, "path"))) < 1e-15
    assert max(errors("squat", lambda strike: impacts.law(strike, "total"))) > 1e-3


def test_no_slip_is_what_much_friction_gives_without_restitution() -> None:
    compared = 0
    for strike in problems(impacts.SCENES, "squat", COUNT):
        old, new = strike.body.old, strike.body.new
        assert old is not None
        rough = strike.body._replace(old=old._replace(friction=1e3), new=new._replace(friction=1e3, restitution=0.0))
        turning = strike.body.turning(strike.twist.omega)
        outcome = solve_impact(rough, turning)
        if outcome.mode is Mode.PIVOT:
            compared += 1
            assert impacts.no_slip(Struck(strike.body, turning)).twist == pytest.approx(outcome.twist, rel=1e-12)
    assert compared > 3


def test_slip_across_the_plane_settles_with_its_tolerance_and_is_the_path_law_without_any() -> None:
    for tolerance in (1e-2, 1e-4, 1e-6):
        assert median(errors("across", lambda strike, t=tolerance: impacts.across(strike, t))) < tolerance  # type: ignore[misc]
    for strike in problems(impacts.SCENES, "plate", 4):
        assert impacts.across(strike, 1e-1) == impacts.law(strike, "path")


def test_compliant_contacts_come_near_the_path_law() -> None:
    assert sorted(errors("plate", lambda strike: impacts.compliant(strike, 1e8), 4))[2] < 1e-2


@pytest.mark.extras
@pytest.mark.skipif(not impacts.has_mujoco(), reason="MuJoCo is missing: make test-extras installs it")
def test_mujoco_meets_the_law_where_nothing_slides() -> None:
    for strike in [*problems(impacts.SCENES, "rod", COUNT), *problems(impacts.SCENES, "plate", COUNT)]:
        right = impacts.reference_of(strike)
        if right.mode in (Mode.STOP, Mode.PIVOT):
            # Its impedance is 0.9999 at most.
            assert impacts.error_of_twist(strike, impacts.mujoco(strike, 1e-5)(), right) < 2e-3


def test_an_error_is_relative_to_the_twist_before() -> None:
    strike = problems(impacts.SCENES, "plate", 1)[0]
    doubled = Aftermath(Twist(*(2.0 * part for part in strike.twist)))
    assert impacts.error_of_twist(strike, doubled, Aftermath(strike.twist)) == pytest.approx(1.0)
