"""Words that fit one thing and many."""

from __future__ import annotations

from impact_predictor.wording import counted


def test_a_number_of_things_has_words_that_fit_it() -> None:
    assert [counted(number, "bag") for number in (0, 1, 2, 1234)] == ["0 bags", "1 bag", "2 bags", "1,234 bags"]
