"""The looks of the modes: each has one, and they differ for every eye."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from impact_predictor import Mode
from impact_predictor.report.modes import MODES


def lightness(colour: str) -> float:
    """CIE L* of an sRGB colour, 0 to 100."""
    channels = (int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)
    return float(116.0 * np.cbrt(0.2126 * red + 0.7152 * green + 0.0722 * blue) - 16.0)


def test_the_colours_of_the_modes_differ_in_grey_too() -> None:
    assert set(MODES) == set(Mode)
    # Eyes tell two large fields apart that lie side by side and differ by a few units.
    pairs = combinations([lightness(look.colour) for look in MODES.values()], 2)
    assert all(abs(one - other) > 8.0 for one, other in pairs)
    assert all(look.is_dark == (lightness(look.colour) < 60.0) for look in MODES.values())


def test_markers_differ() -> None:
    for field in ("symbol", "meaning"):
        assert len({getattr(look, field) for look in MODES.values()}) == len(Mode)
