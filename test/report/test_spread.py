"""Spreads of numbers: exact for one bag, and right to 1 % for several together."""

import json

import numpy as np
import pytest

from impact_predictor.report.summary import EMPTY, PER_DECADE, from_json, spread_of, to_json, together


def test_the_spread_of_some_numbers_has_their_own_percentiles_and_counts_each_in_its_bin() -> None:
    spread = spread_of([1.0, 1.01, 100.0, 0.0])
    assert (spread.number, spread.p50, spread.most) == (4, 1.005, 100.0)
    # 1.01 is less than 10**(1 / 100); 0 lies with the least number.
    assert spread.bins == {0: 2, 2 * PER_DECADE: 1, -12 * PER_DECADE: 1}


def test_a_spread_comes_back_from_its_json() -> None:
    spread = spread_of([3.0, 0.02, 5e-5])
    assert from_json(json.loads(json.dumps(to_json(spread)))) == spread
    assert from_json(None) == EMPTY == spread_of([])
    assert to_json(EMPTY) == {"count": 0, "p50": None, "p90": None, "p99": None, "max": None, "bins": []}


def test_one_spread_among_empty_ones_stays_exact() -> None:
    spread = spread_of([1.0, 2.0, 4.0])
    assert together([EMPTY, spread, EMPTY]) is spread
    assert together([]) == EMPTY


def test_spreads_together_are_those_of_all_numbers() -> None:
    numbers = np.random.default_rng(5).lognormal(size=3000)
    parts = [spread_of([float(number) for number in part]) for part in np.split(numbers, [10, 700])]
    spread = together(parts)
    assert (spread.number, spread.most) == (3000, max(numbers))
    for part, value in ((0.5, spread.p50), (0.9, spread.p90), (0.99, spread.p99)):
        # Half the width of a bin, 1.2 %.
        assert value == pytest.approx(float(np.quantile(numbers, part)), rel=0.012)
