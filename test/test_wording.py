"""Numbers, units and counted things in words."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from impact_predictor.wording import counted, duration, fixed, percent, plain, words


@pytest.mark.parametrize(
    ("write", "said"),
    [
        (lambda number: counted(number, "bag"), {0: "0 bags", 1: "1 bag", 2: "2 bags", 1234: "1,234 bags"}),
        (words, {"PIVOT_SLIDE": "pivot slide"}),
        # What is found in damaged bytes is shown in one line, and not all of it.
        (plain, {"no\n header": "no header", "text '\x14s'": "text '?s'", 300 * "a": 200 * "a" + " ..."}),
        # Percents have a decimal, and small ones two digits.
        (percent, {None: "-", 0.0: "0.0", 0.1234: "12.3", 1.0: "100.0"}),
        (percent, {0.00996: "1.0", 0.0051234: "0.51", 1.23e-9: "1.2e-07"}),
        # What rounds to nothing has no sign.
        (partial(fixed, decimals=1, sign="+"), {2.04: "+2.0", -2.04: "-2.0", -1e-9: "0.0", 0.0: "0.0", None: "-"}),
        # A time has the unit that suits it.
        (duration, {None: "-", 1.5e-6: "1.5 us", 0.063: "63 ms", -0.0011: "-1.1 ms", 2.5: "2.5 s", 3e-8: "30 ns"}),
    ],
)
def test_a_number_or_name_is_said_in_words_that_fit_it(write: Callable[[Any], str], said: dict[Any, str]) -> None:
    assert {value: write(value) for value in said} == said
