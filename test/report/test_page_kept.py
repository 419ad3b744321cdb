"""Answers of many bags in a file: the page of them is the same, and memory holds none of them."""

from __future__ import annotations

import tracemalloc

import pytest
from replay_answers import TOSSES, UNREADABLE, answer, touchdown

from impact_predictor.errors import InputError
from impact_predictor.report.page.replay import page_of_replay
from impact_predictor.report.page.replays import kept as module
from impact_predictor.report.page.replays.answers import scored_of, used
from impact_predictor.report.page.replays.kept import Kept


def test_answers_in_a_file_make_the_same_page_and_take_no_memory() -> None:
    kept = Kept()
    for one in (TOSSES, UNREADABLE):
        kept.append(one)
    assert page_of_replay(kept) == page_of_replay([TOSSES, UNREADABLE])
    tracemalloc.start()
    try:
        for k in range(200):
            kept.append(answer(f"{k}.mcap", touchdowns=[touchdown(100 + j) for j in range(50)]))
        assert len(scored_of(used(kept))) == 200 * 50 + 2
        # 10 kB or more of each answer would be 2 MB.
        assert tracemalloc.get_traced_memory()[0] < 200_000
    finally:
        tracemalloc.stop()
    assert kept[-1]["bag"] == "199.mcap"
    assert [one["bag"] for one in kept[:2]] == [TOSSES["bag"], UNREADABLE["bag"]]


def test_a_disk_that_is_full_is_told_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(module.marshal, "dumps", full)
    with pytest.raises(InputError, match="No space left on device; give another one in TMPDIR"):
        Kept().append(TOSSES)
