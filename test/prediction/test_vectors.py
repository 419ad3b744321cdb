"""Vectors of three floats, and sums that every Python rounds alike."""

from __future__ import annotations

import pytest

from impact_predictor.prediction.vectors import total


def test_no_values_give_a_float() -> None:
    assert repr(total([])) == "0.0"


def test_each_step_of_a_sum_is_rounded() -> None:
    # A compensated sum gives 2.0.
    assert total([1.0, 1e100, 1.0, -1e100]) == 0.0


@pytest.mark.parametrize("values", [(1.0, 2.0), iter((1.0, 2.0))])
def test_any_iterable_is_summed(values: tuple[float, ...]) -> None:
    assert total(values) == 3.0
