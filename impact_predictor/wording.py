"""Numbers, units and counted things in words, for whoever tells something: bags, reports, pages, commands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

NONE: Final = "-"
"""What stands where there is no number."""


def counted(number: int, noun: str) -> str:
    """A number of things, in words that fit one of them and many."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


def listed(names: Sequence[str], most: int = 20, last: str = "") -> str:
    """Some names as a part of a sentence, at most so many of them; `last` stands before the last one, as "and"."""
    if len(names) > most:
        return f"{', '.join(names[:most])} and {len(names) - most:,} more"
    return ", ".join(names) if not last or len(names) < 2 else f"{', '.join(names[:-1])} {last} {names[-1]}"


def plain(text: str, most: int = 200) -> str:
    """The beginning of what a library says of damaged bytes, in one line that can be printed."""
    line = "".join([one if one.isprintable() else "?" for one in " ".join(text.split())])
    return line if len(line) <= most else f"{line[:most]} ..."


def words(name: str) -> str:
    """The name of an enum's member as text."""
    return name.lower().replace("_", " ")


def fixed(value: float | None, decimals: int, sign: str = "") -> str:
    """A number with so many decimals; `sign` is "+" where it shall always have one. What rounds to 0 has none."""
    if value is None:
        return NONE
    text = f"{value:{sign}.{decimals}f}"
    return text if float(text) else f"{0.0:.{decimals}f}"


def percent(part: float | None) -> str:
    """A part of 1 in percent without the sign: one decimal, or two digits below 1 %."""
    if part is None:
        return NONE
    number = 100.0 * part
    return f"{number:.2g}" if 0.0 < abs(number) < 0.995 else f"{number:.1f}"


def duration(seconds: float | None) -> str:
    """A time in s with three digits and the unit that suits it, s, ms, us or ns."""
    if seconds is None:
        return NONE
    size, unit = next((one for one in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us")) if abs(seconds) >= one[0]), (1e-9, "ns"))
    return f"{seconds / size:.3g} {unit}"
