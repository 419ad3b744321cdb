"""The cubic through the frames of a foot, and where it comes down."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from impact_predictor.prediction.walking.cubic import Fit, GapNoise, PointFrame, slope_of, value_of
from impact_predictor.prediction.walking.trajectory import DescentPrior, FootTrajectory

CLEAN = GapNoise(1e-7, 1e-6)


def course_of(gap: Callable[[float], float], times: np.ndarray, measured: bool = True) -> FootTrajectory:
    course = FootTrajectory()
    for time in times.tolist():
        rate = (gap(time + 1e-6) - gap(time - 1e-6)) / 2e-6
        velocity = (0.3, 0.0, rate) if measured else None
        frame = PointFrame(
            round(time * 1e9), gap(time), rate if measured else None, (0.3 * time, 1.0, gap(time)), velocity
        )
        course.frames.append(frame)
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


def test_the_noise_that_is_predicted_is_that_of_many_fits() -> None:
    rng = np.random.default_rng(1)
    noise, times = GapNoise(1e-3, 0.02), np.arange(0.0, 0.1, 0.0025)
    found = []
    for _ in range(300):
        course = FootTrajectory()
        for time in times.tolist():
            gap, rate = 0.4 - 0.5 * time + rng.normal(0.0, noise.gap), -0.5 + rng.normal(0.0, noise.rate)
            course.frames.append(PointFrame(round(time * 1e9), gap, rate, (0.0, 0.0, gap), (0.0, 0.0, rate)))
            course.follow()
        fit = course._fit_of(course._sums, noise, DescentPrior())  # type: ignore[arg-type]
        assert fit is not None
        found.append((value_of(fit.gap, 0.05), slope_of(fit.gap, 0.05)))
    scatter = np.std(found, axis=0)
    # 300 draws tell a standard deviation to 4 %.
    assert scatter == pytest.approx([fit.deviation_of(0, 0.05), fit.deviation_of(1, 0.05)], rel=0.15)
