"""Coefficients from made touchdowns whose own are known."""

from __future__ import annotations

import numpy as np
import pytest
from boxes import TRUTH, touchdowns

from impact_predictor.calibration.fit import NEEDED, Calibration, calibrate
from impact_predictor.calibration.solver import Coefficients
from impact_predictor.errors import InputError


def holds(calibration: Calibration, truth: Coefficients) -> list[bool]:
    """Whether each interval holds the truth."""
    return [
        (one.low or 0.0) <= getattr(truth, name) <= (np.inf if one.high is None else one.high)
        for name, one in calibration.estimates.items()
    ]


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_the_coefficients_of_exact_touchdowns_come_back(friction: float) -> None:
    truth = TRUTH._replace(friction=friction)
    fitted = calibrate([touchdowns(truth)])
    assert list(fitted.estimates) == ["friction", "restitution", "merge"]
    assert all(one.known for one in fitted.estimates.values())
    assert all(holds(fitted, truth))
    # Half a step of the merge times, which are a third of an octave apart, changes them a little.
    assert fitted.fitted.friction == pytest.approx(friction, abs=5e-3)
    assert fitted.fitted.restitution == pytest.approx(0.3, abs=5e-3)
    assert np.median(fitted.held_out) < 0.01 < np.median(fitted.given)


def test_an_inertia_that_is_asked_for_comes_back_too() -> None:
    truth = TRUTH._replace(inertia=1.3)
    fitted = calibrate([touchdowns(truth)], inertia=True)
    one = fitted.estimates["inertia"]
    assert one.known
    assert one.value == pytest.approx(1.3, abs=0.08)
    assert all(holds(fitted, truth))


@pytest.mark.slow
def test_the_intervals_hold_the_truth_about_as_often_as_they_say() -> None:
    held = [holds(calibrate([touchdowns(noise=0.03, seed=seed)]), TRUTH) for seed in range(4)]
    # Of 12 intervals with 95 % at most 3 miss in 99 % of all cases.
    assert np.sum(held) >= 9


def test_the_held_out_error_is_that_of_the_noise() -> None:
    fitted = calibrate([touchdowns(number=100, noise=0.03)])
    # The mean length of six normal errors is 2.35 deviations; a fit costs a little.
    assert fitted.held_out.mean() == pytest.approx(2.35 * 0.03, rel=0.15)


def test_where_nothing_slips_only_a_lower_bound_of_the_friction_is_told() -> None:
    """Boxes that fall flat on their faces without turning."""
    flat = touchdowns(TRUTH._replace(friction=100.0), slips=False)[1::2]
    friction = calibrate([flat]).estimates["friction"]
    assert not friction.known
    assert friction.high is None
    assert friction.low is not None
    assert friction.low < 1.0
    assert friction.value == max(0.4, friction.low)


def test_a_merge_time_that_does_nothing_stays_as_given() -> None:
    single = touchdowns()[::2]
    alone = [one._replace(gaps=np.where(one.gaps == 0.0, 0.0, 1.0)) for one in single]
    merge = calibrate([alone]).estimates["merge"]
    assert not merge.known
    assert (merge.value, merge.low, merge.high) == (5e-4, None, None)


def test_gaps_that_count_as_exact_stay_so() -> None:
    fitted = calibrate([touchdowns(TRUTH._replace(merge=0.0), given=(0.4, 0.0, 0.0))])
    assert fitted.fitted.merge == 0.0
    assert fitted.fitted.friction == pytest.approx(0.2, abs=2e-3)


def test_outliers_hardly_move_the_fit() -> None:
    some = touchdowns(noise=0.01)
    wrong = [one._replace(measured=np.ones(6)) if k % 10 == 0 else one for k, one in enumerate(some)]
    fitted = calibrate([wrong])
    assert fitted.fitted.friction == pytest.approx(0.2, abs=0.02)
    assert fitted.fitted.restitution == pytest.approx(0.3, abs=0.02)


def test_what_is_left_out_was_not_fitted_to() -> None:
    """Two kinds of touchdowns in two records: in equal parts, so that each is wrong about the other."""
    slippery, rough = (touchdowns(TRUTH._replace(friction=friction), number=20) for friction in (0.05, 0.35))
    fitted, alone = calibrate([slippery, rough]), calibrate([slippery])
    assert np.median(alone.held_out) < 0.01 < np.median(fitted.held_out)


def test_the_same_seed_gives_the_same_answer() -> None:
    some = touchdowns(number=20, noise=0.03)
    one, other = calibrate([some], seed=3), calibrate([some], seed=3)
    assert one.estimates == other.estimates
    assert np.array_equal(one.held_out, other.held_out)


@pytest.mark.parametrize(
    ("number", "said"), [(0, "no touchdowns can"), (1, "1 touchdown can"), (9, "9 touchdowns can")]
)
def test_too_few_touchdowns_are_refused_with_both_numbers(number: int, said: str) -> None:
    with pytest.raises(InputError, match=f"^{said}.*{NEEDED} are needed"):
        calibrate([touchdowns(number=10)[:number]])


def test_bodies_with_frictions_of_their_own_are_refused() -> None:
    one = touchdowns(number=10)
    other = [each._replace(body="b", scene=each.scene._replace(friction=0.7)) for each in one]
    with pytest.raises(InputError, match="merge times of their own"):
        calibrate([one, other])
