"""Peaks of margins: in Gaussian seas they tell the rate and the maximum of the closed forms, else by another law."""

from __future__ import annotations

from math import exp, log, pi, sqrt

import numpy as np
import pytest

from impact_predictor.prediction.watch.peaks import ANEW, BULK, ENOUGH, HOUR, KEPT, TAIL, MarginPeaks, PeakLaw, law_of

STEP = 0.25


def sea(seconds: float, width: float, seed: int) -> tuple[np.ndarray, float]:
    """A Gaussian process of deviation 1 with frequencies about 0.9 rad/s, and its rate of up-crossings in Hz."""
    rng, times = np.random.default_rng(seed), np.arange(0.0, seconds, STEP)
    omega = 0.9 * (1.0 + width * rng.normal(size=300))
    waves = np.cos(np.outer(times, omega) + rng.uniform(0.0, 2.0 * pi, 300))
    motion = sqrt(2.0 / 300) * waves.sum(axis=1)
    return motion, float(np.sqrt(np.mean(omega * omega))) / (2.0 * pi)


@pytest.mark.parametrize("width", [0.1, 0.25])
def test_the_peaks_of_a_gaussian_sea_tell_rices_rate_and_the_likeliest_maximum(width: float) -> None:
    ratios, maxima = [], []
    for seed in range(6):
        motion, frequency = sea(2400.0, width, seed)
        peaks = MarginPeaks(1)
        for one in np.abs(motion / 3.5).tolist():
            peaks.update(np.array([one]), STEP)
        law = peaks.law(0)
        # Rice: up-crossings of 3.5 deviations, on both sides.
        ratios.append(law.passing(1.0) / (2.0 * frequency * exp(-0.5 * 3.5**2)))
        maxima.append(law.maximum * 3.5 / sqrt(2.0 * log(2.0 * frequency * HOUR)))
        assert law.name == "rayleigh"
    assert 0.6 < np.exp(np.mean(np.log(ratios))) < 2.5
    assert np.mean(maxima) == pytest.approx(1.0, abs=0.05)


def test_peaks_that_are_not_rayleighs_are_told_by_pareto() -> None:
    rng = np.random.default_rng(0)
    peaks = 0.2 + 0.05 * rng.pareto(3.0, 400)
    law = law_of(peaks, HOUR)
    assert law.name == "pareto"
    # Beyond 1 there are 400 (0.05 / 0.85)^3 an hour.
    assert law.passing(1.0) * HOUR == pytest.approx(400 * (0.05 / 0.85) ** 3, rel=2.0)
    assert 0.5 < law.maximum < 1.5
    assert 0.0 < law.probability(30.0) < law.probability(HOUR) < 0.5


def test_too_few_peaks_tell_nothing_and_no_more_are_kept_than_a_bounded_number() -> None:
    peaks = MarginPeaks(2)
    for k in range(ENOUGH - 2):
        for used in (0.1, 0.1 + 0.001 * k):
            peaks.update(np.array([used, 0.0]), 2.0)
    assert peaks.law(0) == PeakLaw()
    assert PeakLaw().probability(HOUR) == 0.0
    rng = np.random.default_rng(1)
    for _ in range(3 * KEPT):
        for used in (0.0, float(rng.rayleigh(0.2))):
            peaks.update(np.array([used, 0.0]), 2.0)
    law = peaks.law(0)
    assert law.rate == pytest.approx(0.25 / 2.0, rel=0.4)
    assert law.passing(0.6) == pytest.approx(0.25 * exp(-0.5 * 3.0**2), rel=0.9)
    assert peaks.law(1) == PeakLaw()


def test_a_law_counts_the_peaks_beyond_its_threshold_and_is_found_anew_after_some_more() -> None:
    rng = np.random.default_rng(0)
    for name, beyond, ones in (("rayleigh", BULK, rng.rayleigh(0.2, 200)), ("pareto", TAIL, rng.pareto(3.0, 200))):
        law = law_of(ones, 100.0)
        assert law.name == name
        assert law.rate == pytest.approx((ones > np.sort(ones)[int(beyond * 200)]).sum() / 100.0)
        assert law.passing(law.threshold) == pytest.approx(law.rate)
    peaks, laws, found = MarginPeaks(1), [PeakLaw()], []
    for k in range(ENOUGH + 3 * ANEW):
        for used in (0.0, rng.uniform(0.5, 1.0)):
            peaks.update(np.array([used]), 2.0)
        if peaks.law(0) != laws[-1]:
            laws.append(peaks.law(0))
            found.append(k)
    assert np.diff(found).tolist() == [ANEW, ANEW]


def test_a_tail_of_seven_peaks_is_enough_for_a_law_and_one_of_six_is_not() -> None:
    for number, name in ((6, "unknown"), (7, "pareto")):
        # Many that are alike and some beyond them, as Rayleigh's law does not have them.
        peaks = np.concatenate([np.linspace(0.1, 0.4, 36), np.full(24, 1.0), np.linspace(1.5, 2.0, number)])
        assert law_of(peaks, 100.0).name == name
