"""Wave spectra against closed forms, published values and another library; the waves drawn from them."""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
import pytest

from impact_predictor.scenarios.deck.sea import RANGE, SeaState, Waves, density, waves_of

HEIGHT, PERIOD = 3.0, 9.0
PEAK = 2.0 * pi / PERIOD
G = 9.81
FINE = PEAK * np.geomspace(0.3, 300.0, 200_001)
"""Below lies e-60 of the energy, above a part in 1e10."""


def moment(state: SeaState, order: int) -> float:
    values = density(state, FINE) * FINE**order
    return float((0.5 * (values[1:] + values[:-1]) * np.diff(FINE)).sum())


def surface(waves: Waves, times: Any) -> Any:
    return np.cos(np.multiply.outer(times, waves.frequencies) + waves.phases) @ waves.amplitudes


def test_the_moments_of_pierson_and_moskowitz_are_its_closed_forms() -> None:
    # m0 = Hs^2 / 16; by a gamma function m2 = Hs^2 / 16 * sqrt(1.25 pi) * peak^2.
    state = SeaState(HEIGHT, PERIOD, gamma=1.0)
    m0 = HEIGHT**2 / 16.0
    # The trapezes of the fine grid, and what lies beyond it: 1e-5 of m2, which falls as frequency^-2.
    assert moment(state, 0) == pytest.approx(m0, rel=1e-7)
    assert moment(state, 2) == pytest.approx(m0 * sqrt(1.25 * pi) * PEAK**2, rel=2e-5)


@pytest.mark.parametrize("gamma", [1.0, 2.0, 3.3, 5.0])
def test_the_periods_of_jonswap_are_the_published_ones(gamma: float) -> None:
    # DNV-RP-C205, 3.5.5.4: polynomials in gamma, fitted to 1 <= gamma < 7.
    state = SeaState(HEIGHT, PERIOD, gamma=gamma)
    m0, m1, m2 = (moment(state, order) for order in (0, 1, 2))
    mean = 0.7303 + 0.04936 * gamma - 0.006556 * gamma**2 + 0.0003610 * gamma**3
    crossing = 0.6673 + 0.05037 * gamma - 0.006230 * gamma**2 + 0.0003341 * gamma**3
    # Four printed digits, and a fit.
    assert 2.0 * pi * m0 / m1 / PERIOD == pytest.approx(mean, abs=2e-3)
    assert 2.0 * pi * sqrt(m0 / m2) / PERIOD == pytest.approx(crossing, abs=2e-3)
    # The norm 1 - 0.287 ln(gamma) is a fit, too.
    assert 4.0 * sqrt(m0) == pytest.approx(HEIGHT, rel=5e-3)


@pytest.mark.parametrize("gamma", [3.3, 1.0])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_waves_have_the_significant_height_to_rounding(gamma: float, seed: int) -> None:
    amplitudes = waves_of(SeaState(HEIGHT, PERIOD, gamma), seed).amplitudes
    assert 4.0 * sqrt(0.5 * amplitudes @ amplitudes) == pytest.approx(HEIGHT, rel=1e-13)


def test_each_band_of_the_waves_has_the_energy_of_the_spectrum() -> None:
    waves = waves_of(SeaState(HEIGHT, PERIOD, gamma=1.0), 3)
    energy = np.cumsum(0.5 * waves.amplitudes**2)
    # The integral of the spectrum up to a frequency is Hs^2 / 16 exp(-1.25 (peak / w)^4), of which a part is left out.
    count = len(energy)
    edges = PEAK * (RANGE[0] + (RANGE[1] - RANGE[0]) * np.arange(1, count + 1) / count)
    whole = HEIGHT**2 / 16.0 * np.exp(-1.25 * (PEAK / edges) ** 4.0)
    # Eight samples in a band, and the half percent left out above is spread over all.
    assert energy == pytest.approx(whole / whole[-1] * energy[-1], abs=2e-5 * energy[-1])
    assert (waves.frequencies > edges - (RANGE[1] - RANGE[0]) * PEAK / count).all()
    assert (waves.frequencies < edges).all()


def test_the_sea_does_not_repeat_itself_within_hours() -> None:
    waves = waves_of(SeaState(HEIGHT, PERIOD), 1)
    # The correlation of the surface with itself after a while is the sum of its waves' cosines.
    lags = np.arange(300.0, 4 * 3600.0, 1.0)
    correlation = np.cos(np.multiply.outer(lags, waves.frequencies)) @ (0.5 * waves.amplitudes**2)
    assert np.abs(correlation).max() < 0.6 * HEIGHT**2 / 16.0


@pytest.mark.extras
@pytest.mark.parametrize("name", ["jonswap", "pm"])
def test_the_spectra_are_those_of_wavespectra(name: str) -> None:
    construct = pytest.importorskip("wavespectra.construct.frequency", reason="needs the extra spectra")
    frequencies = PEAK * np.linspace(0.4, 10.0, 4001)
    hertz = frequencies / (2.0 * pi)
    theirs = (
        construct.jonswap(hertz, fp=1.0 / PERIOD, hs=HEIGHT, gamma=3.3)
        if name == "jonswap"
        else construct.pierson_moskowitz(hertz, fp=1.0 / PERIOD, hs=HEIGHT)
    )
    state = SeaState(HEIGHT, PERIOD, gamma=3.3 if name == "jonswap" else 1.0)
    ours = density(state, frequencies) * 2.0 * pi
    # They scale to the height on the grid, we by the printed norm, whose fit is good to half a percent.
    assert ours == pytest.approx(np.asarray(theirs), rel=5e-3)
    shape = ours / ours.max() - np.asarray(theirs) / float(theirs.max())
    assert np.abs(shape).max() < 1e-12


def test_it_is_the_spectrum_of_the_paper_at_its_wind_speed() -> None:
    # Pierson and Moskowitz (1964): alpha g^2 / w^5 exp(-0.74 (g / (U w))^4), alpha = 8.1e-3.
    wind, alpha = 20.0, 8.1e-3
    peak = (0.8 * 0.74) ** 0.25 * G / wind
    height = 2.0 * sqrt(alpha / 0.74) * wind**2 / G
    frequencies = np.linspace(0.3, 2.0, 50)
    printed = alpha * G**2 * frequencies**-5.0 * np.exp(-0.74 * (G / (wind * frequencies)) ** 4.0)
    assert density(SeaState(height, 2.0 * pi / peak, gamma=1.0), frequencies) == pytest.approx(printed, rel=1e-12)
