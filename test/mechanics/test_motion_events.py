"""Roots of the conditions of motion: parabolas and cubics with roots that are known beforehand."""

import math

import numpy as np
import pytest

from impact_predictor.mechanics.motion.events import dip, fall, may_fall, safe_step

NEWTON = 2e-5
"""What is left of a cubic's root after the steps that are taken; whoever asks polishes it on the condition itself."""


@pytest.mark.parametrize(
    ("value", "rate", "acceleration", "step"),
    [
        (4.0, -1.0, 1.0, 2.0),  # 4 - s - s^2/2
        (2.0, 0.5, 1.5, 2.0),  # 2 + s/2 - 3 s^2/4
        (8.0, 0.0, 1.0, 4.0),
        (3.0, -2.0, 0.0, 1.5),
        (3.0, 0.0, 0.0, math.inf),
        (3.0, 2.0, 0.0, math.inf),
        (0.0, 2.0, 1.0, 4.0),
    ],
)
def test_a_safe_step_ends_where_the_parabola_falls_to_zero(
    value: float, rate: float, acceleration: float, step: float
) -> None:
    assert safe_step(value, rate, acceleration) == pytest.approx(step, rel=1e-15)


@pytest.mark.parametrize("root", [1e-3, 0.25, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("others", [(2.0, 3.0), (-1.0, 1.5), (-0.5, -4.0), (-2.0, math.inf)])
def test_a_cubic_that_ends_below_zero_falls_through_it_at_its_root(root: float, others: tuple[float, float]) -> None:
    cubic = np.poly1d([one for one in (root, *others) if one < math.inf], r=True)
    cubic *= math.copysign(1.0, cubic(0.0))
    assert fall(cubic(0.0), cubic.deriv()(0.0), cubic(1.0), cubic.deriv()(1.0)) == pytest.approx(root, abs=NEWTON)


@pytest.mark.parametrize("root", [0.2, 0.75])
@pytest.mark.parametrize("other", [-3.0, 4.0])
def test_a_cubic_that_begins_at_zero_and_rises_falls_at_its_next_root(root: float, other: float) -> None:
    cubic = np.poly1d([0.0, root, other], r=True)
    cubic *= math.copysign(1.0, cubic(0.5 * root))
    slopes = cubic.deriv()
    assert fall(0.0, slopes(0.0), cubic(1.0), slopes(1.0)) == pytest.approx(root, rel=1e-14)


def test_a_condition_that_begins_at_zero_and_sinks_falls_at_once() -> None:
    assert fall(0.0, -1.0, -1.0, -1.0) == 0.0


def test_a_dip_between_two_rising_ends_is_where_their_tangents_meet_below_zero() -> None:
    # 1 - 4 s and 1 - 4 (1 - s) meet in the middle, at -1.
    assert dip(1.0, -4.0, 1.0, 4.0) == 0.5
    # 3 - 6 s and 1 - 2 (1 - s) meet at 1/2, at zero.
    assert dip(3.0, -6.0, 1.0, 2.0) == 0.5
    assert dip(1.0, -1.0, 1.0, 1.0) > 1.0  # they meet at 1/2, above zero
    assert dip(1.0, 1.0, 1.0, 4.0) > 1.0
    assert dip(0.0, -4.0, 1.0, 4.0) > 1.0


@pytest.mark.parametrize("lowest", [-0.01, 0.01])
def test_a_dip_below_tangents_that_meet_above_zero_is_where_its_cubic_is_lowest(lowest: float) -> None:
    # (s - 0.7)^2 (2 s + 1) bends down, then up; its tangents 0.49 - 0.42 s and 0.27 + 1.98 (s - 1) meet above zero.
    cubic = np.poly1d([0.7, 0.7], r=True) * np.poly1d([2.0, 1.0]) + lowest
    slopes = cubic.deriv()
    found = dip(cubic(0.0), slopes(0.0), cubic(1.0), slopes(1.0))
    assert found == pytest.approx(0.7) if lowest < 0.0 else found > 1.0


@pytest.mark.parametrize("slope", [-1e-300, -1e-20, -1e-12])
def test_a_dip_of_which_the_beginning_is_all_but_level_is_where_its_cubic_is_lowest(slope: float) -> None:
    # value - 6 s^2 + 6 s^3 is lowest at 2/3, 8/9 below its ends.
    assert dip(0.8, slope, 0.8, 6.0) == pytest.approx(2.0 / 3.0)
    assert dip(0.9, slope, 0.9, 6.0) > 1.0


def test_three_samples_may_hide_a_fall_where_their_parabola_has_one() -> None:
    # (s - 0.4)^2 - 0.01 at 0, 1/2 and 1 is positive at the ends alone; with 0.01 more everywhere, it touches zero.
    assert may_fall(0.15, 0.0, 0.35)
    assert may_fall(0.16, 0.01, 0.36)
    assert not may_fall(1.16, 1.01, 1.36)
    assert may_fall(0.1, -0.1, 0.1)
    assert not may_fall(1.0, 2.0, 1.0)
    assert not may_fall(1.0, 1.0, 1.0)
