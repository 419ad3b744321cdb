"""What a recorded run is tested against."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..errors import InputError


class Range(NamedTuple):
    """A range of whole numbers, both ends included; without a last one it has no end."""

    first: int
    last: int | None

    def __str__(self) -> str:
        if self.last == self.first:
            return str(self.first)
        return f"{self.first}.." if self.last is None else f"{self.first}..{self.last}"

    def has(self, number: int) -> bool:
        """Whether a number lies in it."""
        return self.first <= number and (self.last is None or number <= self.last)


class Tolerances(NamedTuple):
    """What is still right. Errors are fractions of 1 of the velocity before an impact, times are in s."""

    error: float
    median_error: float
    time_error: float
    mode_accuracy: float
    missed: int
    false: int
    touchdowns: Range


def read_tolerances(texts: Mapping[str, str]) -> Tolerances:
    """The tolerances that are given as texts by their names.

    Raises:
        InputError: a text is not a number that this tolerance can be.
    """
    return Tolerances(
        error=_fraction("error", texts),
        median_error=_fraction("median_error", texts),
        time_error=_fraction("time_error", texts),
        mode_accuracy=_fraction("mode_accuracy", texts),
        missed=_count("missed", texts),
        false=_count("false", texts),
        touchdowns=_range("touchdowns", texts),
    )


def _fraction(name: str, texts: Mapping[str, str]) -> float:
    try:
        value = float(texts[name])
    except ValueError:
        value = -1.0
    # What is not a number is not at least zero either.
    if not value >= 0.0:
        raise InputError(f"impact_{name} is {texts[name]!r}; give a number that is not negative, as in 0.5")
    return value


def _count(name: str, texts: Mapping[str, str]) -> int:
    if not texts[name].isdecimal():
        raise InputError(f"impact_{name} is {texts[name]!r}; give a whole number, as in 0")
    return int(texts[name])


def _range(name: str, texts: Mapping[str, str]) -> Range:
    first, dots, last = texts[name].partition("..")
    if first.isdecimal() and (last.isdecimal() or not last):
        found = Range(int(first), int(last) if last else None if dots else int(first))
        if found.last is None or found.first <= found.last:
            return found
    raise InputError(f"impact_{name} is {texts[name]!r}; give 12, 10..14, or 10.. for at least 10")
