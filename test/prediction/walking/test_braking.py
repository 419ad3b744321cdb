"""How soft ground brakes a point."""

from __future__ import annotations

import numpy as np
import pytest

from impact_predictor.prediction.walking.braking import BOW, RateLine, braked_course
from impact_predictor.prediction.walking.cubic import GapNoise, PointFrame


def test_the_line_of_rates_is_that_of_least_squares_with_its_doubt() -> None:
    rng = np.random.default_rng(0)
    times = 0.3 + np.sort(rng.uniform(0.0, 0.1, 9))
    rates = -0.5 + 4.0 * times + rng.normal(0.0, 0.02, 9)
    line = RateLine([*zip(times.tolist(), rates.tolist(), strict=True)])
    factors, covariance = np.polyfit(times, rates, 1, cov="unscaled")
    assert line.slope == pytest.approx(factors[0])
    assert line.left == pytest.approx(np.sum((rates - np.polyval(factors, times)) ** 2))
    for time in (0.25, 0.35, 0.5):
        row = np.array([time, 1.0])
        assert line.rate(time) == pytest.approx(row @ factors)
        assert line.doubt(time) == pytest.approx(row @ covariance @ row)


@pytest.mark.parametrize("lasts", [0.0085, 0.01, 0.0125, 0.02])
@pytest.mark.parametrize("begins", [0.0, 1.1e-3])
def test_ground_that_brakes_evenly_to_rest_is_met_where_it_begins_to(lasts: float, begins: float) -> None:
    frames, speed = [], 0.5
    for k in range(52):
        since = 2.5e-3 * (k - 32) - begins
        braked = min(max(since, 0.0), lasts)
        gap, rate = 0.5 * speed / lasts * braked * braked - speed * min(since, lasts), speed * (braked / lasts - 1.0)
        frames.append(PointFrame(10**9 + 2_500_000 * k, gap, rate, (0.0, 0.0, gap), (0.0, 0.0, rate)))
    course = braked_course(frames, 20, GapNoise(1e-5, 2e-3), 1e-3)
    assert course is not None
    assert course.speed == pytest.approx(speed)
    met = 1e-9 * (course.stamp - 10**9) - 2.5e-3 * 32 - begins
    # As of springs, which brake ever more at first.
    assert met == pytest.approx(BOW * lasts, abs=1e-6)


def test_ground_that_brakes_ever_less_is_met_where_its_first_braking_begins() -> None:
    frames, gap = [], 0.1
    rates = [-0.5] * 30 + [-0.5 * part for part in (0.65, 0.25, 0.2, 0.1, 0.05, 0.02)] + [0.0] * 15
    for k, rate in enumerate(rates):
        gap += 2.5e-3 * rate
        frames.append(PointFrame(2_500_000 * k, gap, rate, (0.0, 0.0, gap), (0.0, 0.0, rate)))
    course = braked_course(frames, 18, GapNoise(1e-5, 2e-3), 1e-3)
    assert course is not None
    # The line through the first two of them has the speed of before so many frames earlier.
    assert course.stamp / 2.5e6 == pytest.approx(30.0 - 0.35 / 0.4 + BOW / 0.4)
