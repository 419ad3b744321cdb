"""The rhythm in which a point lands."""

from __future__ import annotations

import pytest

from impact_predictor.prediction.walking.rhythm import LEAST, StrideRhythm

MS = 1_000_000


def rhythm(*strides: int) -> StrideRhythm:
    """Of a point that landed first at 1 s, and then after each of some strides in ms."""
    found, stamp = StrideRhythm(), 1000 * MS
    found.learn(stamp)
    for stride in strides:
        stamp += stride * MS
        found.learn(stamp)
    return found


def test_a_time_and_what_the_rhythm_says_of_it_are_weighed_by_their_variances() -> None:
    """As the product of two normal densities: 400 ms after the last landing the next is 100 ms ahead by the rhythm."""
    variance, own = 2e-5, 3e-3**2 + LEAST**2
    time, square = rhythm(500, 503, 500, 499).weighed(3402 * MS, 0.108, variance)
    assert time == pytest.approx((0.108 / variance + 0.1 / own) / (1.0 / variance + 1.0 / own))
    assert square == pytest.approx(1.0 / (1.0 / variance + 1.0 / own))


def test_a_rhythm_that_is_out_of_step_too_new_or_of_another_landing_says_nothing() -> None:
    for strides in ((500, 510, 500, 500), (500, 500, 500)):
        stamp = (1000 + sum(strides) + 400) * MS
        assert rhythm(*strides).weighed(stamp, 0.102, 1e-4) == (0.102, 1e-4)
    assert rhythm(500, 500, 500, 500).weighed(3400 * MS, 0.2, 1e-4) == (0.2, 1e-4)
