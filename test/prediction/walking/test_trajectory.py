"""The cubic through the frames of a foot, and where it comes down."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from impact_predictor.prediction.walking.cubic import Fit, GapNoise, PointFrame, factored, first_below, solved
from impact_predictor.prediction.walking.trajectory import FEWEST, DescentPrior, FootTrajectory

CLEAN = GapNoise(1e-7, 1e-6)


def course_of(gap: Callable[[float], float], times: np.ndarray, measured: bool = True) -> FootTrajectory:
    course = FootTrajectory()
    for time in times.tolist():
        rate = (gap(time + 1e-6) - gap(time - 1e-6)) / 2e-6
        velocity = (0.3, 0.0, rate) if measured else None
        frame = PointFrame(
            round(time * 1e9), gap(time), rate if measured else None, (0.3 * time, 1.0, gap(time)), velocity
        )
        course.add(frame)
        course.follow()
    return course


def fitted(course: FootTrajectory, noise: GapNoise = CLEAN) -> Fit:
    # The first fit of a falling point tells that it falls, and the second one of it where.
    fit = course.fit(noise, DescentPrior()) or course.fit(noise, DescentPrior())
    assert fit is not None
    return fit


@pytest.mark.parametrize("measured", [True, False])
def test_a_cubic_is_found_again_and_so_is_its_landing(measured: bool) -> None:
    course = course_of(lambda t: 0.1 - 0.2 * t - 8.0 * t**2 + 20.0 * t**3, np.arange(0.0, 0.04, 0.0025), measured)
    fit = fitted(course)
    root = min(x.real for x in Polynomial([0.1, -0.2, -8.0, 20.0]).roots() if x.real > 0.0)
    landing = fit.landing(0.0, 0.005, 0.25)
    assert landing is not None
    assert landing.sure
    # Two windows ahead 0.1 um is taken for noise, which at 1 m/s makes some us.
    assert landing.time + fit.stamp * 1e-9 == pytest.approx(root, abs=1e-5)
    place, velocity = course.motion(fit, landing.time)
    assert place == pytest.approx((0.3 * root, 1.0, 0.0), abs=1e-5)
    assert velocity == pytest.approx((0.3, 0.0, landing.rate), abs=1e-5)


@pytest.mark.parametrize("level", [-1e-9, 0.0, 1e-9, -0.004])
def test_a_foot_that_brakes_to_rest_on_the_ground_lands_where_it_rests(level: float) -> None:
    course = course_of(lambda t: 20.0 * (0.1 - t) ** 2, np.arange(0.0, 0.05, 0.0025))
    landing = fitted(course).landing(level, 0.005, 0.25)
    assert landing is not None
    assert landing.time == pytest.approx(0.1 - 0.0475, abs=1e-4)
    assert landing.rate == 0.0


def test_a_foot_that_turns_above_the_tolerance_does_not_land() -> None:
    course = course_of(lambda t: 0.01 + 20.0 * (0.1 - t) ** 2, np.arange(0.0, 0.05, 0.0025))
    assert fitted(course).landing(0.0, 0.005, 0.25) is None


def test_a_landing_beyond_the_horizon_is_none() -> None:
    course = course_of(lambda t: 1.0 - 2.0 * t, np.arange(0.0, 0.05, 0.0025))
    fit = fitted(course)
    assert fit.landing(0.0, 0.005, 0.25) is None
    assert fit.landing(0.0, 0.005, 1.0) is not None


def test_frames_from_before_a_change_of_course_are_left_out() -> None:
    def bends(time: float) -> float:
        return 0.2 - 0.5 * time if time < 0.05 else 0.175 - 0.5 * (time - 0.05) - 12.0 * (time - 0.05) ** 2

    course = course_of(bends, np.arange(0.0, 0.03, 0.0025))
    assert fitted(course).fits
    for time in np.arange(0.03, 0.08, 0.0025).tolist():
        gap = bends(time)
        rate = -0.5 if time < 0.05 else -0.5 - 24.0 * (time - 0.05)
        course.add(PointFrame(round(time * 1e9), gap, rate, (0.0, 0.0, gap), (0.0, 0.0, rate)))
        course.follow()
        course.fit(CLEAN, DescentPrior())
    landing = fitted(course).landing(0.0, 0.005, 0.5)
    assert landing is not None
    root = max(Polynomial([0.175, -0.5, -12.0]).roots())
    assert landing.time + 0.0775 == pytest.approx(root + 0.05, abs=1e-3)


def test_the_noise_that_is_predicted_is_that_of_many_fits() -> None:
    rng = np.random.default_rng(1)
    noise, times = GapNoise(1e-3, 0.02), np.arange(0.0, 0.1, 0.0025)
    found = []
    for _ in range(300):
        course = FootTrajectory()
        for time in times.tolist():
            gap, rate = 0.4 - 0.5 * time + rng.normal(0.0, noise.gap), -0.5 + rng.normal(0.0, noise.rate)
            course.add(PointFrame(round(time * 1e9), gap, rate, (0.0, 0.0, gap), (0.0, 0.0, rate)))
            course.follow()
        fit = course._fit_of(course._sums, noise, DescentPrior())  # type: ignore[arg-type]
        assert fit is not None
        a, b, c, d = fit.now()
        found.append((a + 0.05 * (b + 0.05 * (c + 0.05 * d)), b + 0.05 * (2.0 * c + 0.15 * d)))
    scatter = np.std(found, axis=0)
    # 300 draws tell a standard deviation to 4 %.
    assert scatter == pytest.approx([fit.deviation_of(0, 0.05), fit.deviation_of(1, 0.05)], rel=0.15)


def test_too_few_frames_and_rising_ones_are_no_descent() -> None:
    assert course_of(lambda t: -t, np.arange(FEWEST - 1) * 0.0025).fit(CLEAN, DescentPrior()) is None
    rising = course_of(lambda t: 0.5 * t, np.arange(0.0, 0.05, 0.0025))
    assert rising.fit(CLEAN, DescentPrior()) is None
    assert rising.fit(CLEAN, DescentPrior()) is None


def test_the_least_squares_are_those_of_numpy() -> None:
    rng = np.random.default_rng(0)
    design = rng.normal(size=(9, 4))
    matrix, right = design.T @ design, rng.normal(size=4)
    factor = factored(tuple(matrix[np.tril_indices(4)].tolist()))
    assert factor is not None
    assert solved(factor, tuple(right.tolist())) == pytest.approx(np.linalg.solve(matrix, right).tolist(), rel=1e-9)
    design[:, 3] = design[:, 2]
    assert factored(tuple((design.T @ design)[np.tril_indices(4)].tolist())) is None


def test_the_first_root_is_found_below_and_above() -> None:
    assert first_below(-0.1, -1.0, 0.0, 0.0, 1.0) == 0.0
    assert first_below(0.125, -1e-9, 0.0, -1.0, 1.0) == pytest.approx(0.5, abs=1e-8)
    assert first_below(0.3, -1.0, 0.0, 0.0, 1.0) == pytest.approx(0.3, abs=1e-8)
