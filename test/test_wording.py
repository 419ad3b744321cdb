"""Numbers, units and counted things in words."""

from __future__ import annotations

import pytest

from impact_predictor.wording import counted, duration, fixed, percent, words


def test_a_number_of_things_has_words_that_fit_it() -> None:
    assert [counted(number, "bag") for number in (0, 1, 2, 1234)] == ["0 bags", "1 bag", "2 bags", "1,234 bags"]


def test_a_name_is_told_in_small_letters() -> None:
    assert words("PIVOT_SLIDE") == "pivot slide"


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (None, "-"),
        (0.0, "0.0"),
        (0.1234, "12.3"),
        (1.0, "100.0"),
        (0.00996, "1.0"),
        (0.0051234, "0.51"),
        (1.23e-9, "1.2e-07"),
    ],
)
def test_percents_have_a_decimal_and_small_ones_two_digits(part: float | None, said: str) -> None:
    assert percent(part) == said


def test_what_rounds_to_nothing_has_no_sign() -> None:
    assert [fixed(value, 1, "+") for value in (2.04, -2.04, -1e-9, 0.0)] == ["+2.0", "-2.0", "0.0", "0.0"]
    assert fixed(None, 2) == "-"


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(None, "-"), (1.5e-6, "1.5 us"), (0.063, "63 ms"), (-0.0011, "-1.1 ms"), (2.5, "2.5 s"), (3e-8, "30 ns")],
)
def test_a_time_has_the_unit_that_suits_it(seconds: float | None, said: str) -> None:
    assert duration(seconds) == said
