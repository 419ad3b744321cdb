"""Irregular seas: wave spectra, and waves drawn from them.

JONSWAP after Hasselmann et al. (1973), "Measurements of wind-wave growth and swell decay during the Joint North Sea
Wave Project", Deutsche Hydrographische Zeitschrift A8(12); Pierson and Moskowitz (1964), "A proposed spectral form for
fully developed wind seas", J. Geophys. Res. 69(24). Both as DNV-RP-C205, section 3.5.5, writes them: by significant
wave height and peak period. Angular frequencies in rad/s, one-sided densities in m^2 s/rad, of deep water.
"""

from __future__ import annotations

from math import log, pi
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError

RANGE: Final = 0.5, 4.0
"""Least and greatest frequency of the waves over that of the peak: outside lies half a percent of the energy."""

WAVES: Final = 200

_PARTS: Final = 8
"""Samples of the density in the band of one wave."""


class SeaState(NamedTuple):
    """Significant wave height in m and peak period in s of an irregular sea.

    `gamma` is the peak enhancement of JONSWAP: 1 is Pierson and Moskowitz' spectrum, 3.3 the mean of the North Sea.
    """

    height: float
    period: float
    gamma: float = 3.3


class Waves(NamedTuple):
    """Regular waves that make up a sea; arrays (n,): frequencies (rad/s), amplitudes (m) and phases (rad).

    The surface at the origin is the sum of amplitude * cos(frequency * t + phase).
    """

    frequencies: NDArray[np.float64]
    amplitudes: NDArray[np.float64]
    phases: NDArray[np.float64]


def density(state: SeaState, frequencies: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spectral density in m^2 s/rad at frequencies above 0 in rad/s (DNV-RP-C205, 3.5.5.1 and 3.5.5.2); InputError
    where a number of the sea state is out of its range.
    """
    height, period, gamma = checked(state)
    peak = 2.0 * pi / period
    ratio = frequencies / peak
    moskowitz: NDArray[np.float64] = 0.3125 * height * height / peak * ratio**-5.0 * np.exp(-1.25 * ratio**-4.0)
    width = np.where(ratio <= 1.0, 0.07, 0.09)
    enhanced: NDArray[np.float64] = (
        (1.0 - 0.287 * log(gamma)) * moskowitz * gamma ** np.exp(-0.5 * ((ratio - 1.0) / width) ** 2)
    )
    return enhanced


def waves_of(state: SeaState, seed: int, count: int = WAVES) -> Waves:
    """Waves whose significant height is that of the sea state to rounding.

    Each has the energy of one of `count` equal bands of `RANGE`, a random phase and a random frequency in its band: no
    two are multiples of a common one, so the sea does not repeat itself. The same seed makes the same sea. InputError
    where a number of the sea state is out of its range.
    """
    peak = 2.0 * pi / checked(state).period
    band = (RANGE[1] - RANGE[0]) * peak / count
    places = RANGE[0] * peak + band * (np.arange(count * _PARTS) + 0.5) / _PARTS
    energies = density(state, places).reshape(count, _PARTS).sum(axis=1)
    energies *= state.height**2 / 16.0 / energies.sum()
    rng = np.random.default_rng(seed)
    frequencies = RANGE[0] * peak + band * (np.arange(count) + rng.random(count))
    return Waves(frequencies, np.sqrt(2.0 * energies), rng.uniform(0.0, 2.0 * pi, count))


def directions(waves: Waves, mean: float, spread: float, seed: int) -> NDArray[np.float64]:
    """The directions (n,) of waves about a mean one, normally distributed, in degrees: each wave has its own;
    InputError where the mean is no angle, or the spread is out of its range.
    """
    if not -360.0 <= mean <= 360.0 or not 0.0 <= spread <= 60.0:
        raise InputError(
            f"the waves head {mean:g} degrees with a spread of {spread:g}; give angles, and 0 to 60 of spread"
        )
    found: NDArray[np.float64] = np.random.default_rng((seed, 1)).normal(mean, spread, len(waves.frequencies))
    return found


def checked(state: SeaState) -> SeaState:
    """The sea state, if its numbers make sense; InputError where one does not."""
    height, period, gamma = state
    if not 0.0 < height <= 40.0:
        raise InputError(f"the significant wave height is {height}; give metres above 0, up to 40")
    if not 0.5 <= period <= 60.0:
        raise InputError(f"the peak period is {period}; give seconds from 0.5 to 60")
    if not 1.0 <= gamma <= 10.0:
        raise InputError(f"the peak enhancement is {gamma}; give a number from 1 to 10")
    return state
