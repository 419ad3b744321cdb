"""Every method of the report comes to what it stands for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from itertools import combinations
from random import Random
from statistics import median

import bench_peers
import numpy as np
import pytest

from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Mode, Twist
from impact_predictor.report.accuracy import impacts, problems, spatial, touchdowns
from impact_predictor.report.accuracy.impacts import Aftermath, Struck
from impact_predictor.report.accuracy.spatial import SpatialAftermath, StruckBox
from impact_predictor.report.accuracy.touchdowns import CRATE, FallingBody, PredictedTouchdown, falling

COUNT = 36
FALLS = {scene.name: draw for scene, draw in touchdowns.SCENES.items()}
STRIKES = {scene.name: draw for scene, draw in impacts.SCENES.items()}


def touchdown_error(fall: FallingBody, found: PredictedTouchdown | None) -> float:
    assert found is not None
    return max(touchdowns.errors_of(fall, found, touchdowns.reference_of(fall)).values())


@pytest.mark.parametrize("name", FALLS)
def test_the_methods_for_touchdowns_keep_to_their_tolerances(name: str) -> None:
    for fall in problems(FALLS[name], name, 4):
        assert touchdown_error(fall, touchdowns.own(fall)) < 1e-6
        if name != "balance":  # where an error grows a thousand times before the body moves
            assert touchdown_error(fall, touchdowns.integrated(fall, 1e-9)) < 1e-7
    assert problems(FALLS[name], name, 4) == problems(FALLS[name], name, 4)


def test_extrapolations_are_right_for_the_motion_that_they_suppose() -> None:
    near = falling(CRATE, 1e-4, -0.5)
    assert touchdown_error(near, touchdowns.extrapolated(near, False)) < 1e-2
    assert touchdown_error(near, touchdowns.extrapolated(near, True)) < 1e-6
    rising = falling(CRATE, 0.2, 0.6)
    assert touchdowns.extrapolated(rising, False) is None
    assert touchdowns.extrapolated(rising, True) is not None


def errors(name: str, solve: Callable[[Struck], Aftermath | None], strikes: list[Struck] | None = None) -> list[float]:
    """The errors of a method on the problems of a scene, or on others, in ascending order."""
    found = []
    for strike in strikes or problems(STRIKES[name], name, COUNT):
        after = solve(strike)
        assert after is not None
        found.append(impacts.errors_of(strike, after, impacts.reference_of(strike))["twist_error"])
    return sorted(found)


@pytest.mark.parametrize("law", ["path", "total"])
def test_both_laws_are_the_closed_forms_on_the_bodies_of_the_paper_also_stiff_ones(law: str) -> None:
    assert max(errors("paper", lambda strike: impacts.law(strike, law))) < 1e-12
    for strike in problems(STRIKES["paper"], "paper", COUNT):
        assert impacts.law(strike, law).mode is impacts.reference_of(strike).mode


def test_the_error_of_the_path_law_against_more_digits_is_rounding_and_that_of_the_total_law_is_not() -> None:
    assert max(errors("floor", lambda strike: impacts.law(strike, "path"))) < 1e-15
    assert max(errors("floor", lambda strike: impacts.law(strike, "total"))) > 1e-3


def test_no_slip_is_what_much_friction_gives_without_restitution() -> None:
    compared = 0
    for strike in problems(STRIKES["floor"], "floor", COUNT):
        old, new = strike.body.old, strike.body.new
        assert old is not None
        rough = strike.body._replace(old=old._replace(friction=1e3), new=new._replace(friction=1e3, restitution=0.0))
        turning = strike.body.turning(strike.twist.omega)
        outcome = solve_impact(rough, turning)
        if outcome.mode is Mode.PIVOT:
            compared += 1
            assert impacts.no_slip(Struck(strike.body, turning)).twist == pytest.approx(outcome.twist, rel=1e-12)
    assert compared > 3


def spatial_errors(name: str, solve: Callable[[StruckBox], SpatialAftermath]) -> list[float]:
    """The errors of a method on boxes that strike as they are called, in ascending order."""
    boxes = problems({scene.name: draw for scene, draw in spatial.SCENES.items()}[name], name, 12)
    return sorted(spatial.errors_of(one, solve(one), spatial.reference_of(one))["twist_error"] for one in boxes)


@pytest.mark.parametrize(("tilt", "strike"), [(1, 2), (0, 4)])
def test_the_corners_with_which_a_box_strikes_are_as_far_apart_as_its_inertia_says(tilt: int, strike: int) -> None:
    for one in problems(partial(spatial.box, tilt=tilt, stand=0, strike=strike, bounces=False), "box", 4):
        moments = np.linalg.eigvalsh(one.body.inertia)
        sides = np.sqrt(6.0 / one.body.mass * (moments.sum() - 2.0 * moments))
        apart = [float(np.linalg.norm(a - b)) for a, b in combinations(np.asarray(one.contacts.positions), 2)]
        lengths = [*sides, *(float(np.hypot(*two)) for two in combinations(sides, 2))]
        assert all(min(abs(length - one) for length in lengths) < 1e-9 for one in apart)
        assert len(np.unique(np.round(apart, 9))) == (1 if strike == 2 else 3)


@pytest.mark.parametrize("name", [scene.name for scene in spatial.SCENES])
def test_more_steps_of_the_law_in_three_dimensions_err_less_and_newtons_complementarity_errs_more(name: str) -> None:
    few, more, many = (spatial_errors(name, partial(spatial.solved, steps=steps)) for steps in (4, 16, 64))
    assert many[6] < more[6] < few[6] < spatial_errors(name, partial(spatial.solved, law="total"))[6]
    assert many[-1] < 5e-3


@pytest.mark.parametrize("stand", [0, 2])
def test_draws_over_gaps_come_to_the_mean_and_one_solution_does_not(stand: int) -> None:
    boxes = problems(partial(spatial.box, tilt=0, stand=stand, strike=4 - stand, bounces=True), "gaps", 8)
    right = [bench_peers.over_gaps(one, bench_peers.ALL) for one in boxes]
    for key in ("twist_error", "wrong_modes"):
        found = [
            median(spatial.errors_of(one, solve(one), mean)[key] for one, mean in zip(boxes, right, strict=True))
            for solve in (spatial.solved, *(partial(bench_peers.over_gaps, draws=draws) for draws in (16, 256)))
        ]
        assert found[2] < found[1] < 0.5 * found[0], key


@pytest.mark.extras
@pytest.mark.skipif(not find_spec("mujoco"), reason="MuJoCo is missing: make test-extras installs it")
@pytest.mark.parametrize("name", [scene.name for scene in spatial.SCENES])
def test_mujoco_meets_newtons_complementarity_without_friction_and_restitution(name: str) -> None:
    for one in problems({scene.name: draw for scene, draw in spatial.SCENES.items()}[name], name, 6):
        smooth = replace(one, contacts=one.contacts._replace(friction=0.0, restitution=0.0))
        total = spatial.solved(smooth, law="total")
        assert spatial.errors_of(smooth, bench_peers.mujoco_of_box(smooth, 1e-4), total)["twist_error"] < 1e-3


def test_an_error_is_relative_to_the_twist_before() -> None:
    strike = problems(STRIKES["paper"], "paper", 1)[0]
    doubled = Aftermath(Twist(*(2.0 * part for part in strike.twist)))
    assert impacts.errors_of(strike, doubled, Aftermath(strike.twist)) == {"twist_error": pytest.approx(1.0)}


def test_modes_are_compared_where_both_tell_them() -> None:
    strike = spatial.SCENES[next(iter(spatial.SCENES))](Random(1))
    told = SpatialAftermath(strike.twist, np.array([1.0, 0.0, 0.0, 0.0]))
    other, untold = told._replace(leaves=np.array([0.5, 0.0, 0.0, 1.0])), told._replace(leaves=None)
    assert spatial.errors_of(strike, other, told) == {"twist_error": 0.0, "wrong_modes": 1.5 / 4}
    assert spatial.errors_of(strike, untold, told) == spatial.errors_of(strike, told, untold) == {"twist_error": 0.0}


def test_compliant_contacts_come_near_the_path_law() -> None:
    strikes = problems(partial(bench_peers.ordinary, shape="plate"), "plate", 4)
    assert errors("plate", lambda strike: bench_peers.compliant(strike, 1e8), strikes)[2] < 1e-2


@pytest.mark.extras
@pytest.mark.skipif(not find_spec("mujoco"), reason="MuJoCo is missing: make test-extras installs it")
def test_mujoco_meets_the_law_where_nothing_slides() -> None:
    drawn = problems(partial(bench_peers.ordinary, shape="plate"), "plate", 24)
    strikes = [one for one in drawn if impacts.reference_of(one).mode in (Mode.STOP, Mode.PIVOT)]
    # Its impedance is 0.9999 at most.
    assert errors("ordinary", lambda strike: bench_peers.mujoco(strike, 1e-5), strikes)[-1] < 2e-3
