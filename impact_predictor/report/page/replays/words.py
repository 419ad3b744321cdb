"""The words of the page of a replay: numbers with their units, and the modes."""

from __future__ import annotations

from typing import Final

from ..looks import Looks
from ..svg import family_colour
from ..words import digits, time_words

MODES: Final = {
    "STOP": Looks(family_colour(0), "s"),
    "SLIDE": Looks(family_colour(1), ">"),
    "PIVOT_SLIDE": Looks(family_colour(2), "P"),
    "PIVOT": Looks(family_colour(3), "o"),
    "BACK_PIVOT": Looks(family_colour(5), "<"),
    "FLIGHT": Looks(family_colour(4), "^"),
    "NO_IMPACT": Looks(family_colour(7), "D"),
}
"""How each mode is drawn, in every chart alike; in the order in which they are listed."""

LEAST: Final = 0.01
"""Percent; smaller errors are not told apart."""

SAYS: Final = {
    "STOP": "both contacts stay and stick",
    "SLIDE": "both contacts stay, one of them slips",
    "PIVOT_SLIDE": "the old contact lifts, the new one slips",
    "PIVOT": "the old contact lifts, the new one sticks",
    "BACK_PIVOT": "the new contact lifts again, the old one stays",
    "FLIGHT": "both contacts lift",
    "NO_IMPACT": "the foot brakes to rest as it reaches the ground",
}
"""What follows in each mode."""


def mode_words(mode: str) -> str:
    """A mode as text."""
    return mode.lower().replace("_", " ")


def percent(part: float | None) -> str:
    """A part of 1 in percent, as the tables of the terminal have it; with two digits where it is small."""
    if part is None:
        return "–"
    number = 100.0 * part
    if 0.0 < number < LEAST:
        return f"< {LEAST:g}\N{NO-BREAK SPACE}%"
    words = "0" if number == 0.0 else digits(number) if number < 0.995 else f"{number:.1f}"
    return f"{words}\N{NO-BREAK SPACE}%"


def within(part: float | None) -> str:
    """What a part of 1 is within, in percent."""
    return percent(None if part is None else max(part, 0.01 * LEAST))


def seconds_words(seconds: float | None) -> str:
    """A time in s with the unit that suits it; what is less than a microsecond is not told apart from nothing."""
    if seconds is None:
        return "–"
    return "less than 1\N{NO-BREAK SPACE}µs" if seconds < 1e-6 else time_words(1e6 * seconds)


def signed_ms(seconds: float | None) -> str:
    """A time in s, early or late, in ms."""
    return "–" if seconds is None else f"{1e3 * seconds:+.1f}\N{NO-BREAK SPACE}ms"


def velocity_words(velocity: float) -> str:
    """A velocity in m/s."""
    return f"{velocity:.3f}\N{NO-BREAK SPACE}m/s"
