"""Touchdowns in independent blocks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from boxes import touchdowns

from impact_predictor.calibration.fit import ENOUGH, blocks_of
from impact_predictor.calibration.touchdowns import ScoredTouchdown

ONE = touchdowns(number=1)[0]


def at(*seconds: float, body: str = "") -> list[ScoredTouchdown]:
    return [ONE._replace(body=body, stamp=round(time * 1e9)) for time in seconds]


@pytest.mark.parametrize(
    ("records", "blocks"),
    [
        ([at(*(20.0 * toss + bounce for toss in range(12) for bounce in (0.0, 0.4, 0.9)))], np.repeat(range(12), 3)),
        ([at(0.0, 0.1) + at(0.2, 0.3, body="b"), at(0.4, 0.5)] * 5, np.repeat(range(15), 2)),
        ([at(0.0, 0.1, 0.3, 0.6, 0.7)], range(5)),
        ([[], at(*range(0, 40, 2)), []], range(20)),
    ],
    ids=["a toss is one", "records and bodies never share one", "few are one each", "an empty record takes none"],
)
def test_touchdowns_near_each_other_are_one_block(records: list[list[ScoredTouchdown]], blocks: Any) -> None:
    assert blocks_of(records).tolist() == list(blocks)


def test_a_record_without_pauses_is_cut_at_its_longest_ones() -> None:
    blocks = blocks_of([at(*np.cumsum([0.3, 0.1, 0.1] * 20))])
    assert blocks.max() + 1 >= ENOUGH
    assert (blocks.reshape(-1, 3) == blocks[::3, None]).all()
