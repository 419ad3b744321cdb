"""Coefficients from made touchdowns whose own are known."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from impact_predictor.calibration.fit import KNOWN, NEEDED, Calibration, calibrate
from impact_predictor.calibration.solver import Solver
from impact_predictor.calibration.touchdowns import (
    Coefficients,
    ScoredTouchdown,
    scaled,
    with_coefficients,
)
from impact_predictor.errors import InputError
from impact_predictor.mechanics.bodies import plate
from impact_predictor.mechanics.impact import solve_impact
from impact_predictor.mechanics.types import Twist, TwoPointBody
from impact_predictor.prediction.impact import Collision, LateralMotion
from impact_predictor.prediction.planar import ActiveContacts, ImpactPlane
from impact_predictor.prediction.scene import Scene, inertia_matrix

LENGTH, HEIGHT, MASS = 1.0, 0.4, 1.0
PLANE = ImpactPlane(
    (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), None, (0.0, 0.0), Twist(0.0, 0.0, 0.0), (0.0,) * 3, 0.0, 0.0, 0.0
)


def collision(body: TwoPointBody, before: Twist, spread: float = 0.0) -> Collision:
    """An impact of a body whose edge takes some time to close."""
    lateral = LateralMotion(0.0, 0.0, 0.0)
    contacts = ActiveContacts((0,), (1,))
    return Collision(contacts, PLANE, body, before, lateral, (0.0, 0.0), spread, 0.0, 1.0, 1.0)


def touchdowns(
    truth: Coefficients,
    number: int = 24,
    noise: float = 0.0,
    given: tuple[float, float] = (0.4, 0.0),
    slip: float = 0.5,
    seed: int = 0,
    height: float = HEIGHT,
) -> list[ScoredTouchdown]:
    """Plates with the mass centre at several places that land turning and slipping, as a record tells them.

    `noise` is the standard deviation of the measured vx and omega s, relative to the speed before.
    """
    rng = np.random.default_rng(seed)
    inertia = MASS * (LENGTH**2 + height**2) / 12.0
    scene = Scene(MASS, inertia_matrix([inertia]), friction=given[0], restitution=given[1])
    made = []
    for k in range(number):
        ahead = rng.uniform(0.3, 0.7)
        body = plate(length=LENGTH, height=height, mass=MASS, friction=0.0, a=1.0 - ahead, b=ahead, inertia=inertia)
        before = body.turning(omega=-rng.uniform(1.0, 3.0))
        before = before._replace(vx=before.vx + slip * rng.uniform(-1.0, 1.0))
        one = ScoredTouchdown("", k * 10**10, scene, collision(body, before), before, 0.5 * LENGTH)
        after = Twist(*Solver([one]).after(truth)[0])
        error = rng.normal(0.0, noise * one.speed, 2) if noise else (0.0, 0.0)
        made.append(
            one._replace(measured=Twist(after.vx + error[0], after.vy, after.omega + error[1] / (0.5 * LENGTH)))
        )
    return made


def within(calibration: Calibration, truth: Coefficients) -> list[bool]:
    """Whether the intervals of friction and restitution hold the truth."""
    return [
        (one.low or 0.0) <= value <= (np.inf if one.high is None else one.high)
        for one, value in ((calibration.friction, truth.friction), (calibration.restitution, truth.restitution))
    ]


@pytest.mark.parametrize("friction", [0.08, 0.2, 0.35])
def test_friction_and_restitution_of_exact_touchdowns_come_back(friction: float) -> None:
    truth = Coefficients(friction, 0.2)
    fitted = calibrate([touchdowns(truth)])
    assert within(fitted, truth) == [True, True]
    # A thousandth is where the tables stop to zoom in.
    assert fitted.friction.value == pytest.approx(friction, abs=2e-3)
    assert fitted.restitution.value == pytest.approx(0.2, abs=2e-3)
    assert fitted.held_out.max() < 0.01 < np.median(fitted.given_errors)


@pytest.mark.slow
def test_the_intervals_hold_the_truth_about_as_often_as_they_say() -> None:
    truth = Coefficients(0.2, 0.15)
    held = [within(calibrate([touchdowns(truth, noise=0.05, seed=seed)]), truth) for seed in range(8)]
    # Of 16 intervals with 95 % at most 3 miss in 99 % of all cases.
    assert np.sum(held) >= 13


def test_the_held_out_error_is_that_of_the_noise() -> None:
    fitted = calibrate([touchdowns(Coefficients(0.2, 0.15), number=80, noise=0.05)])
    # The mean length of two normal errors is 1.25 deviations; 80 of them scatter by 6 %, and a fit costs a little.
    assert fitted.held_out.mean() == pytest.approx(1.25 * 0.05, rel=0.2)


@pytest.mark.parametrize("given", [0.9, 0.05])
def test_where_nothing_slips_only_a_lower_bound_of_the_friction_is_told_to_which_it_is_raised(given: float) -> None:
    fitted = calibrate([touchdowns(Coefficients(5.0, 0.1), slip=0.0, given=(given, 0.3))])
    least = fitted.friction.low or 0.0
    assert (fitted.friction.high, fitted.friction.known) == (None, False)
    assert 0.1 < least < 0.9
    assert fitted.friction.value == max(given, least)
    assert fitted.restitution.value == pytest.approx(0.1, abs=2e-3)


def test_an_inertia_that_the_touchdowns_tell_is_fitted() -> None:
    """Tall bodies turn about the new contact in many ways, which no friction and no restitution stand in for."""
    truth = Coefficients(0.3, 0.1, 1.3)
    fitted = calibrate([touchdowns(truth, height=1.6)])
    inertia = fitted.inertia
    assert inertia.known
    assert inertia.low is not None
    assert inertia.high is not None
    assert inertia.low <= 1.3 <= inertia.high <= KNOWN * inertia.low
    # The nearest factor that was looked at is within the interval, 5 % or so; friction makes up for it.
    assert fitted.friction.value == pytest.approx(0.3, abs=0.02)


def test_low_plates_do_not_tell_their_inertia_even_without_noise() -> None:
    fitted = calibrate([touchdowns(Coefficients(0.2, 0.15, 1.3))])
    assert not fitted.inertia.known
    assert fitted.inertia.value == 1.0
    assert np.median(fitted.held_out) < 1e-3


def test_an_inertia_is_not_told_by_touchdowns_of_one_kind() -> None:
    """All bodies alike, all turning about one edge at rest: two numbers cannot tell three."""
    alike = touchdowns(Coefficients(0.1, 0.15), number=1, slip=0.0) * 20
    alike = [one._replace(stamp=k * 10**10) for k, one in enumerate(alike)]
    fitted = calibrate([alike])
    assert not fitted.inertia.known
    assert fitted.inertia.value == 1.0


def test_outliers_hardly_move_the_fit() -> None:
    truth = Coefficients(0.2, 0.15)
    some = touchdowns(truth, noise=0.01)
    wrong = [one._replace(measured=Twist(2.0, 0.0, 2.0)) if k % 10 == 0 else one for k, one in enumerate(some)]
    fitted = calibrate([wrong])
    assert fitted.friction.value == pytest.approx(0.2, abs=0.02)
    assert fitted.restitution.value == pytest.approx(0.15, abs=0.02)


def test_what_is_left_out_was_not_fitted_to() -> None:
    """Two kinds of touchdowns in two records: in equal parts, so that each is wrong about the other."""
    slippery, rough = touchdowns(Coefficients(0.05, 0.1), number=20), touchdowns(Coefficients(0.35, 0.1), number=20)
    fitted = calibrate([slippery, rough])
    alone = calibrate([slippery])
    assert np.median(alone.held_out) < 1e-3 < np.median(fitted.held_out)


def test_the_same_seed_gives_the_same_answer() -> None:
    some = touchdowns(Coefficients(0.2, 0.15), number=20, noise=0.05)
    one, other = calibrate([some], seed=3), calibrate([some], seed=3)
    assert one[2:5] == other[2:5]
    assert np.array_equal(one.held_out, other.held_out)


@pytest.mark.parametrize(
    ("number", "said"), [(0, "no touchdowns can"), (1, "1 touchdown can"), (9, "9 touchdowns can")]
)
def test_too_few_touchdowns_are_refused_with_both_numbers(number: int, said: str) -> None:
    with pytest.raises(InputError, match=f"^{said}.*{NEEDED} are needed"):
        calibrate([touchdowns(Coefficients(0.2, 0.1), number=number)])


def test_bodies_with_frictions_of_their_own_are_refused() -> None:
    one = touchdowns(Coefficients(0.2, 0.1), number=10)
    other = [each._replace(body="b", scene=each.scene._replace(friction=0.7)) for each in one]
    with pytest.raises(InputError, match="frictions or restitutions of their own"):
        calibrate([one, other])


@pytest.mark.parametrize(("bend", "spoilt"), [(0.2, 3), (inf, 20)], ids=["another impact", "mostly slow"])
def test_touchdowns_that_hold_something_else_are_left_out(bend: float, spoilt: int) -> None:
    some = touchdowns(Coefficients(0.2, 0.15), number=spoilt + 17)
    wrong = [
        one._replace(bend=bend, measured=Twist(9.0, 0.0, 9.0)) if k < spoilt else one for k, one in enumerate(some)
    ]
    fitted = calibrate([wrong])
    assert fitted.left_out == spoilt
    assert fitted.held_out.max() < 0.01


def of_all_kinds() -> list[ScoredTouchdown]:
    """Plates by both laws, with and without a contact that stands."""
    rng = np.random.default_rng(1)
    made = []
    for k in range(24):
        body = plate(length=1.0, height=rng.uniform(0.2, 1.5), mass=rng.uniform(0.5, 2.0), friction=0.3)
        if k % 3 == 0:
            body = body._replace(old=None)
        before = plate(length=1.0, height=0.4, mass=1.0, friction=0.3).turning(omega=-rng.uniform(1.0, 3.0))
        law = "total" if k % 5 == 0 else "path"
        scene = Scene(1.0, inertia_matrix([0.1]), friction=0.3, restitution=0.1, law=law)
        impact = collision(body, before, 0.1)
        made.append(ScoredTouchdown("", k, scene, impact, Twist(0.1 * k, 0.0, -0.2), rng.uniform(0.3, 0.6)))
    return made


def after(one: ScoredTouchdown, coefficients: Coefficients) -> Twist:
    """The twist after one touchdown, solved by itself."""
    body = with_coefficients(one.impact.body, coefficients)
    return solve_impact(body, one.impact.before, one.scene.law, one.scene.validity).twist


@pytest.mark.parametrize(
    "coefficients", [Coefficients(0.3, 0.1), Coefficients(0.0, 0.5, 1.3), Coefficients(100.0, 1.0, 0.5)]
)
def test_all_at_once_is_each_by_itself(coefficients: Coefficients) -> None:
    some = of_all_kinds()
    solver = Solver(some)
    alone = [after(one, coefficients) for one in some]
    assert solver.after(coefficients).tolist() == [list(one) for one in alone]
    missed = solver.misses(coefficients)
    for one, twist, (along, turning) in zip(some, alone, missed.tolist(), strict=True):
        assert along == (twist.vx - one.measured.vx) / one.speed
        assert turning == (twist.omega - one.measured.omega) * one.half_distance / one.speed


def test_another_inertia_is_that_of_a_body_that_has_it() -> None:
    for one in of_all_kinds():
        body = one.impact.body
        heavy = one._replace(
            scene=one.scene._replace(inertia=scaled(one.scene.inertia, 1.3)),
            impact=one.impact._replace(body=body._replace(inertia=1.3 * body.inertia)),
        )
        assert after(heavy, Coefficients(0.3, 0.1)) == after(one, Coefficients(0.3, 0.1, 1.3))
