"""Every method for impacts comes to the law that it stands for."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median

import exact
import pytest
from mpmath import mp

from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Mode
from impact_predictor.report.accuracy import compliant_peer, impact_methods, mujoco_peer, stepping
from impact_predictor.report.accuracy.impact_errors import is_wrong, mode_seen, twist_error
from impact_predictor.report.accuracy.impact_reference import Reference, reference_of
from impact_predictor.report.accuracy.impact_scenes import SCENES, After, Strike, strikes
from impact_predictor.report.accuracy.methods import Method

PAPER = ("rod", "plate", "cylinder")
COUNT = 12


def reference(strike: Strike) -> Reference:
    found = reference_of(strike)
    assert found is not None
    return found


def errors(name: str, solve: Callable[[Strike], After | None], count: int = COUNT) -> list[float]:
    found = []
    for strike in strikes(name, count):
        after = solve(strike)
        assert after is not None
        found.append(twist_error(strike, after, reference(strike)))
    return found


@pytest.mark.parametrize("name", [name for name in SCENES if name != "across"])
def test_the_reference_is_what_exact_arithmetic_decides(name: str) -> None:
    compared = 0
    for strike in strikes(name, 6):
        found = reference_of(strike)
        problem = exact.problem_of(strike.body, strike.twist)
        if found is None or strike.body.old is None or (problem.velocities[exact.NB] or 0) >= 0:
            continue
        try:
            answer = exact.path(problem)
        except exact.Undecided:
            continue
        with mp.workdps(60):
            change = [after - mp.mpf(before) for after, before in zip(found.twist, strike.twist, strict=True)]
            apart = [v - mp.mpf(w.numerator) / w.denominator for v, w in zip(change, answer.change, strict=True)]
            rho = mp.sqrt(mp.mpf(strike.body.inertia) / strike.body.mass)
            error, size = (mp.norm([vx, vy, rho * omega]) for vx, vy, omega in (apart, map(mp.mpf, strike.twist)))
            # Both count a speed that is rounding as zero, each in its way; a stiff problem multiplies that.
            assert error < (1e-7 if name == "stiff" else 1e-15) * size
        compared += 1
    assert compared >= 3


@pytest.mark.parametrize("name", PAPER)
@pytest.mark.parametrize(
    "solve",
    [
        impact_methods.closed_form,
        lambda strike: impact_methods.law(strike, "path"),
        lambda strike: impact_methods.law(strike, "total"),
        impact_methods.by_contact_space,
        lambda strike: impact_methods.gauss_seidel(strike, 2000),
    ],
    ids=["closed form", "path", "total", "contact space", "Gauss-Seidel"],
)
def test_all_laws_agree_on_the_bodies_of_the_paper(name: str, solve: Callable[[Strike], After]) -> None:
    assert max(errors(name, solve)) < 1e-12
    assert not any(is_wrong(strike, solve(strike), reference(strike)) for strike in strikes(name, COUNT))


@pytest.mark.parametrize("method", [each for each in impact_methods.METHODS if each.answers_of], ids=lambda m: m.name)
def test_a_batch_answers_what_one_after_the_other_answers(method: Method) -> None:
    problems = strikes("plate", COUNT)
    one = next(each for each in impact_methods.METHODS if each.name == method.name and not each.answers_of)
    assert method.answers_of is not None
    found = method.answers_of(method.prepare(problems)())
    assert found == [one.prepare(problem)() for problem in problems]


def test_gauss_seidel_converges_with_its_sweeps() -> None:
    found = [max(errors("plate", lambda strike, n=n: impact_methods.gauss_seidel(strike, n))) for n in (1, 4, 16)]  # type: ignore[misc]
    assert found[1] < 0.2 * found[0]
    assert found[2] < 1e-4 * found[1]


@pytest.mark.parametrize("name", [*PAPER, "slender"])
def test_time_stepping_through_an_impact_has_the_order_one(name: str) -> None:
    # The scheme has the total law in it: what it tends to is not the path law where these differ.
    same = [
        strike
        for strike in strikes(name, COUNT)
        if twist_error(strike, impact_methods.law(strike, "total"), reference(strike)) < 1e-12
    ]
    coarse, fine = (
        [twist_error(strike, stepping.impact(strike, h), reference(strike)) for strike in same] for h in (1e-4, 1e-5)
    )
    assert sum(coarse) / sum(fine) == pytest.approx(10.0, rel=0.05)


def test_no_slip_is_what_much_friction_gives_without_restitution() -> None:
    for strike in strikes("squat", COUNT):
        old, new = strike.body.old, strike.body.new
        assert old is not None
        rough = strike.body._replace(old=old._replace(friction=1e3), new=new._replace(friction=1e3, restitution=0.0))
        outcome = solve_impact(rough, strike.body.turning(strike.twist.omega))
        after = impact_methods.no_slip(strike._replace(twist=strike.body.turning(strike.twist.omega)))
        if outcome.mode is Mode.PIVOT:
            assert after.twist == pytest.approx(outcome.twist, rel=1e-12)


def test_slip_across_the_plane_settles_with_its_tolerance() -> None:
    def typical(tolerance: float) -> float:
        return median(errors("across", lambda strike: impact_methods.across(strike, tolerance)))

    for tolerance in (1e-2, 1e-4, 1e-6):
        assert typical(tolerance) < tolerance


def test_without_slip_across_the_tolerance_does_not_matter() -> None:
    for strike in strikes("plate", 4):
        assert impact_methods.across(strike, 1e-1) == impact_methods.law(strike, "path")


def test_compliant_contacts_come_near_the_path_law() -> None:
    assert sorted(errors("plate", lambda strike: compliant_peer.impact(strike, 1e8), 4))[2] < 1e-2


def test_the_mode_is_read_from_the_velocities_where_a_method_tells_none() -> None:
    for name in (*PAPER, "squat"):
        for strike in strikes(name, COUNT):
            outcome = solve_impact(strike.body, strike.twist)
            # A contact that moves slower than 1 % is taken to rest.
            assert mode_seen(strike, outcome.twist) in (outcome.mode, *near(outcome.mode))


def near(mode: Mode) -> tuple[Mode, ...]:
    """Modes that one is taken for where a contact moves slowly."""
    slow = {Mode.PIVOT_SLIDE: (Mode.PIVOT, Mode.SLIDE), Mode.PIVOT: (Mode.STOP,), Mode.FLIGHT: (Mode.PIVOT_SLIDE,)}
    return slow.get(mode, ())


@pytest.mark.extras
@pytest.mark.skipif(not mujoco_peer.is_installed(), reason="MuJoCo is missing: make test-extras installs it")
def test_mujoco_meets_the_law_where_nothing_slides() -> None:
    for name in ("rod", "plate"):
        for strike in strikes(name, COUNT):
            found = reference(strike)
            if found.mode in (Mode.STOP, Mode.PIVOT):
                after = mujoco_peer.prepare(1e-5)(strike)()
                # Its impedance is 0.9999 at most.
                assert twist_error(strike, after, found) < 2e-3
