"""When a point that comes down lands: its filter, and what is learnt of landings."""

from __future__ import annotations

import numpy as np
import pytest

from impact_predictor.prediction.walking.cubic import GapNoise, PointFrame
from impact_predictor.prediction.walking.descent import MEMORY, STRIKE, Descent, DescentEstimator, LandingPrior
from impact_predictor.prediction.walking.ground import GroundLevel
from impact_predictor.prediction.walking.point_filter import PointFilter
from impact_predictor.prediction.walking.trajectory import FootTrajectory

MS = 1_000_000
EXACT, NOISE = GapNoise(1e-5, 2e-4), GapNoise(2e-4, 5e-3)
LEVEL = GroundLevel(0.0, 1e-5)


def frame(time: float, coefficients: tuple[float, ...], noise: float = 0.0, land: int = 10**9) -> PointFrame:
    """A frame of a gap that is a polynomial of the time (s) after the landing, which has the stamp `land` (ns)."""
    gap = sum(c * time**k for k, c in enumerate(coefficients)) + noise
    rate = sum(k * c * time ** (k - 1) for k, c in enumerate(coefficients) if k)
    return PointFrame(land + round(time * 1e9), gap, rate, (0.0, 0.0, gap), (0.0, 0.0, rate))


def test_the_filter_follows_a_cubic_exactly() -> None:
    course = (0.0, -0.5, 10.0, -80.0)
    filtered = PointFilter(frame(-0.15, course), EXACT)
    for k in range(1, 50):
        filtered.add(frame(-0.15 + 2.5e-3 * k, course), EXACT)
    time = -0.15 + 2.5e-3 * 49
    expected = (frame(time, course).gap, frame(time, course).rate, 20.0 - 480.0 * time, -480.0)
    assert filtered.rows[0] == pytest.approx(expected, rel=0.01)
    assert not filtered.broke
    position, velocity = filtered.motion(-time)
    assert position == pytest.approx((0.0, 0.0, 0.0), abs=1e-4)
    assert velocity[2] == pytest.approx(-0.5, abs=0.01)


def test_a_gap_that_is_far_off_is_taken_as_one_that_is_off_by_three_deviations() -> None:
    filtered, off = PointFilter(frame(-0.15, (0.1,)), EXACT), 1e-4
    for k in range(1, 30):
        filtered.add(frame(-0.15 + 2.5e-3 * k, (0.1,)), EXACT)
    (expected, *_), *_ = filtered.rows
    filtered.add(PointFrame(10**9 - 75 * MS, expected + off, None, (0.0, 0.0, 0.1), None), EXACT)
    assert filtered.broke
    # With a deviation of off / 3 in all, the part of the noise in it is what is not taken.
    assert filtered.rows[0][0] == pytest.approx(expected + off - 9.0 * EXACT.gap**2 / off, abs=1e-12)


def test_the_part_of_announced_landings_that_came_begins_at_nine_in_ten_and_becomes_what_was_seen() -> None:
    prior = LandingPrior()
    assert prior.came_true == 0.9
    prior.announced, prior.came = 1000.0, 250.0
    assert prior.came_true == pytest.approx(0.25, abs=1e-3)


def walked(
    speeds: np.ndarray,
    braking: float = 5.0,
    uneven: float = 0.1,
    noise: GapNoise = NOISE,
    prior: LandingPrior | None = None,
) -> list[list[tuple[float, Descent]]]:
    """What is told of landings with speeds, after strides that are `uneven` (s): (s until the landing, the descent)."""
    prior, estimator, rng, told = prior or LandingPrior(), DescentEstimator(), np.random.default_rng(0), []
    lands = np.cumsum(0.5 + np.random.default_rng(2).uniform(-uneven, uneven, len(speeds)))
    for speed, land in zip(speeds.tolist(), (1e9 * lands).astype(int).tolist(), strict=True):
        course = (0.0, -speed, braking, 0.0 if speed else -60.0)
        own, filtered = [], PointFilter(frame(-0.1, course, land=land), noise)
        for k in range(1, 40):
            time = -0.1 + 2.5e-3 * k
            one = frame(time, course, rng.normal(0.0, noise.gap), land)
            one.rate = (one.rate or 0.0) + rng.normal(0.0, noise.rate)
            filtered.add(one, noise)
            found = estimator.estimate(filtered, LEVEL, prior)
            if found is not None:
                found.deviation = prior.deviations.told(found.time, found.deviation)
                own.append((-time, found))
        estimator.learn(land, round(land - 2.5 * MS), LEVEL, prior)
        estimator.rest()
        told.append(own)
    return told


def test_strikes_that_repeat_are_told_to_strike_and_earlier_each_time() -> None:
    told = walked(np.full(12, 0.6))
    assert all(one.strikes > 0.9 for own in told[2:] for left, one in own if left < 0.05)
    ahead = [min(one.deviation for left, one in own if left > 0.04) for own in told]
    assert ahead[-1] < ahead[0]


def test_a_foot_that_brakes_to_rest_is_told_to_do_so() -> None:
    told = walked(np.zeros(8), braking=20.0)
    assert all(one.strikes < 0.5 and one.rate == 0.0 for own in told[2:] for left, one in own if 0.01 < left < 0.03)


def test_what_is_learnt_of_landings_is_how_fast_they_are_and_how_much_that_varies() -> None:
    prior, speeds = LandingPrior(), np.random.default_rng(1).normal(0.6, 0.1, 40)
    walked(speeds, noise=EXACT, prior=prior)
    strikes, lately = prior.kinds[STRIKE], speeds[-round(MEMORY) :]
    assert -strikes.mean[1] == pytest.approx(lately.mean(), abs=0.02)
    assert np.sqrt(strikes.variance[1]) == pytest.approx(lately.std(), rel=0.2)


def test_the_deviation_is_true() -> None:
    told = walked(np.random.default_rng(1).normal(0.6, 0.05, 60))
    off = [(one.time - left) / one.deviation for own in told[3:] for left, one in own if left < 0.03]
    assert np.mean(np.abs(off) < 1.0) > 0.68
    assert np.mean(np.abs(off) < 2.0) > 0.95


def test_a_rhythm_makes_landings_surer_where_there_is_one() -> None:
    speeds, noise = np.random.default_rng(1).normal(0.6, 0.05, 40), GapNoise(4e-3, 0.1)
    off, deviations = [], []
    for uneven in (0.1, 1e-3):
        told = [one for own in walked(speeds, uneven=uneven, noise=noise)[8:] for one in own if 0.03 < one[0] < 0.06]
        off.append(float(np.median([abs(one.time - left) for left, one in told])))
        deviations.append(float(np.median([one.deviation for _, one in told])))
    assert off[1] < 0.5 * off[0]
    assert deviations[1] < 0.5 * deviations[0]


@pytest.mark.parametrize("jump", [10, 200, 10**3, 10**6, 10**12])
def test_after_a_clock_that_jumps_no_variance_is_negative(jump: int) -> None:
    trajectory, estimator, noise = FootTrajectory(), DescentEstimator(), GapNoise(1.2e-3, 0.02)
    for k, stamp in enumerate((510, *range(515 + jump, 640 + jump, 10))):
        gap = 0.042 - 0.0031 * k
        trajectory.frames.append(PointFrame(stamp * MS, gap, None, (-0.35, 0.35, gap), None))
        trajectory.follow(noise, near=False)
        assert trajectory.filter is not None
        assert all(trajectory.filter.covariance[i] >= 0.0 for i in (0, 2, 5, 9))
        found = estimator.estimate(trajectory.filter, LEVEL, LandingPrior())
        assert found is None or found.deviation >= 0.0
