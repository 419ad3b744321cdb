"""The words of the page: numbers, names and tooltips."""

from __future__ import annotations

import re
from collections.abc import Iterable
from math import floor, log10
from typing import Final

from .data import ROUNDING, Entry, Point

_SUPERSCRIPTS: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

_UNITS: Final = ((1e6, "s"), (1e3, "ms"), (1.0, "µs"), (1e-3, "ns"))


def power(exponent: int) -> str:
    """A power of ten, such as 10⁻⁶."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def error_words(error: float | None) -> str:
    """A relative error with two digits; what is not known or not finite is a dash."""
    if error is None:
        return "–"
    if error < ROUNDING:
        return "below rounding"
    if error >= 1e-3:
        return f"{error:.2g}" if error < 100.0 else f"{error:.0f}"
    exponent = floor(log10(error))
    digits = f"{error / 10.0**exponent:.1f}"
    if digits == "10.0":
        digits, exponent = "1.0", exponent + 1
    return power(exponent) if digits == "1.0" else f"{digits}·{power(exponent)}"


def time_words(us: float | None) -> str:
    """A time in microseconds with the unit that suits it, two or three digits."""
    if us is None:
        return "–"
    size, unit = next((one for one in _UNITS if us >= 0.9995 * one[0]), _UNITS[-1])
    number = us / size
    words = f"{number:.0f}" if abs(number - round(number)) < 1e-9 else digits(number)
    return f"{words}\N{NO-BREAK SPACE}{unit}"


def digits(number: float) -> str:
    """A number of two digits, or of all before the point."""
    return f"{number:.0f}" if abs(number) >= 9.95 else f"{number:.1f}" if abs(number) >= 0.995 else f"{number:.2g}"


def share(part: float | None) -> str:
    """A part of 1 in percent."""
    if part is None:
        return "–"
    return "0" if part == 0.0 else "< 0.1 %" if part < 1e-3 else f"{digits(100.0 * part)} %"


def neat(text: str) -> str:
    """A text of the report with powers of ten and microseconds as the page writes them."""
    text = re.sub(r"\b(\d(?:\.\d+)?)e([+-]?\d+)", _neat_number, text)
    text = re.sub(r"\b0\.0(0+)1\b", lambda zeros: power(-2 - len(zeros[1])), text)
    text = re.sub(r"\b1(0{4,})\b", lambda zeros: power(len(zeros[1])), text)
    return re.sub(r"(?<=\d) us\b", " µs", text)


def _neat_number(number: re.Match[str]) -> str:
    factor, exponent = number.groups()
    return power(int(exponent)) if float(factor) == 1.0 else f"{factor}·{power(int(exponent))}"


def name_of(method: str | None, setting: str | None) -> str:
    """A method with its setting."""
    return "none" if method is None else f"{method}, {neat(setting)}" if setting else method


def tooltip(point: Point, worst_scene: str = "") -> str:
    """What a point says of itself, line by line; `worst_scene` names the scene of its error where it is of several."""
    row = point.row
    lines = [name_of(point.method, point.setting), f"{time_words(point.us)} per prediction"]
    if not worst_scene and row["us_90"] is not None:
        lines[-1] += f" (90 % below {time_words(row['us_90'])})"
    for key, name in (("time_error", "error of the time"), ("twist_error", "error of the twist")):
        if row[key] is not None:
            median, most, worst = (error_words(row[f"{key}{end}"]) for end in ("", "_90", "_worst"))
            lines.append(f"{name}: median {median}, 90 % below {most}, worst {worst}")
    if worst_scene:
        lines.append(f"errors of its worst scene: {worst_scene}")
    if row["wrong_modes"] is not None:
        lines.append(f"wrong mode: {share(row['wrong_modes'])}")
    if row["failed"]:
        lines.append(f"no answer: {row['failed']} of {row['count']}")
    return "\n".join(lines)


def unanswered(rows: Iterable[Entry]) -> str:
    """Which methods gave no answer how often, over their settings, in a sentence; empty where all answered."""
    counts: dict[str, tuple[int, int]] = {}
    for row in rows:
        failed, count = counts.get(row["method"], (0, 0))
        counts[row["method"]] = failed + row["failed"], count + row["count"]
    said = [f"{method} {failed:,} of {count:,}" for method, (failed, count) in counts.items() if failed]
    return f"No answer: {'; '.join(said)}." if said else ""


def accuracy_words(accuracy: float) -> str:
    """A wanted accuracy, a power of ten."""
    return error_words(accuracy) if accuracy < 1e-3 else power(round(log10(accuracy)))


def percent(part: float | None) -> str:
    """A part of 1 in percent with two digits."""
    return "–" if part is None else f"{digits(100.0 * part)} %"
