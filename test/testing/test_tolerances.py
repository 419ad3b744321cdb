"""Tolerances come as texts, from the command line or an ini-file; wrong ones are refused in one sentence."""

from __future__ import annotations

import pytest

from impact_predictor.errors import InputError
from impact_predictor.testing.plugin import TOLERANCES
from impact_predictor.testing.tolerances import Range, Tolerances, read_tolerances

DEFAULTS = {name: default for name, (default, _) in TOLERANCES.items()}


def test_every_tolerance_has_an_option_with_a_default() -> None:
    assert set(TOLERANCES) == set(Tolerances._fields)
    assert read_tolerances(DEFAULTS) == Tolerances(0.5, 0.2, 0.02, 0.9, 0, 0, Range(1, None))


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [("12", [12], [11, 13]), ("10..12", [10, 12], [9, 13]), ("10..", [10, 10**6], [9]), ("0", [0], [1])],
)
def test_a_range_of_touchdowns_is_one_number_two_or_open(text: str, inside: list[int], outside: list[int]) -> None:
    wanted = read_tolerances(DEFAULTS | {"touchdowns": text}).touchdowns
    assert str(wanted) == text
    assert [wanted.has(number) for number in inside + outside] == [True] * len(inside) + [False] * len(outside)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        *[("error", text) for text in ("", "much", "-0.1", "nan")],
        *[("missed", text) for text in ("", "-1", "0.5", "one")],
        *[("touchdowns", text) for text in ("", "..", "..5", "5..3", "5-6", "-1", "1.5", "1...3")],
    ],
)
def test_what_is_no_such_number_is_refused_by_its_name(name: str, text: str) -> None:
    with pytest.raises(InputError, match=f"^impact_{name} is '{text}'; give "):
        read_tolerances(DEFAULTS | {name: text})
