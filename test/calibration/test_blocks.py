"""Touchdowns in independent blocks."""

from __future__ import annotations

from typing import Any

from impact_predictor.calibration.table import ENOUGH, MOST, blocks_of
from impact_predictor.calibration.touchdowns import ScoredTouchdown


def at(*seconds: float, body: str = "") -> list[ScoredTouchdown]:
    nothing: Any = None
    return [ScoredTouchdown(body, round(time * 1e9), nothing, nothing, nothing, 1.0) for time in seconds]


def test_touchdowns_of_one_toss_are_one_block() -> None:
    tosses = [20.0 * toss + bounce for toss in range(12) for bounce in (0.0, 0.4, 0.9)]
    assert blocks_of([at(*tosses)]).tolist() == [toss for toss in range(12) for _ in range(3)]


def test_records_and_bodies_never_share_a_block() -> None:
    records = [at(0.0, 0.1) + at(0.2, 0.3, body="b"), at(0.4, 0.5)] * 5
    blocks = blocks_of(records)
    assert blocks.tolist() == [k // 2 for k in range(30)]


def test_a_record_without_pauses_is_cut_at_its_longest_ones() -> None:
    pauses = [0.1, 0.1, 0.3] * 20
    times = [sum(pauses[:k]) for k in range(len(pauses))]
    blocks = blocks_of([at(*times)])
    assert blocks.max() + 1 >= ENOUGH
    assert all(a == b == c for a, b, c in zip(blocks[0::3], blocks[1::3], blocks[2::3], strict=True))


def test_few_touchdowns_are_each_a_block() -> None:
    assert blocks_of([at(0.0, 0.1, 0.3, 0.6, 0.7)]).tolist() == [0, 1, 2, 3, 4]


def test_an_empty_record_takes_no_block() -> None:
    assert blocks_of([[], at(*range(0, 40, 2)), []]).tolist() == list(range(20))


def test_a_very_long_record_has_no_more_than_so_many_blocks() -> None:
    blocks = blocks_of([at(*(5.0 * k for k in range(3 * MOST)))])
    assert blocks.max() + 1 == MOST
    assert (blocks[1:] >= blocks[:-1]).all()
