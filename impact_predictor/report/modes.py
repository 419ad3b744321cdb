"""The contact modes as tables, maps, figures and pages show them: one meaning, colour and marker for each."""

from __future__ import annotations

from typing import Final, NamedTuple

from ..mechanics.types import Mode


class ModeLook(NamedTuple):
    """What a mode means, and how it is drawn.

    `meaning` is that of an impact of two contacts, `one_point` that of one contact. `colour` is one of seven from dark
    to light in even steps, so that they differ for every colour vision and in grey; the light ones need an `EDGE`.
    `symbol` is a marker of plotly.
    """

    meaning: str
    colour: str
    symbol: str
    one_point: str = ""

    @property
    def is_dark(self) -> bool:
        """Whether letters on the colour have to be white."""
        return int(self.colour[1:3], 16) + 2 * int(self.colour[3:5], 16) < 0x1A0


MODES: Final = {
    Mode.NO_IMPACT: ModeLook(
        meaning="the new contact is not approached",
        one_point="the contact is not approached",
        colour="#ffffff",
        symbol="diamond",
    ),
    Mode.STOP: ModeLook(
        meaning="both contacts hold, neither slips: the body stops",
        colour="#0b3c6f",
        symbol="square",
    ),
    Mode.SLIDE: ModeLook(
        meaning="both contacts hold and slip",
        colour="#56b4e9",
        symbol="triangle-right",
    ),
    Mode.PIVOT_SLIDE: ModeLook(
        meaning="the old contact lifts, the new one slips",
        one_point="the contact holds and slips",
        colour="#f7e57a",
        symbol="cross",
    ),
    Mode.PIVOT: ModeLook(
        meaning="the old contact lifts, the new one sticks",
        one_point="the contact holds and sticks: the body turns about it",
        colour="#d55e00",
        symbol="circle",
    ),
    Mode.BACK_PIVOT: ModeLook(
        meaning="the new contact lifts again, the old one holds",
        colour="#7f4a8c",
        symbol="triangle-left",
    ),
    Mode.FLIGHT: ModeLook(
        meaning="both contacts lift",
        one_point="the contact lifts again",
        colour="#e3b5c9",
        symbol="triangle-up",
    ),
}
EDGE: Final = "#1a1a1a"
"""Colour of the outline of a marker."""
PALETTE: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
"""Colours of what is no mode, in turn: those of Okabe and Ito, which people of any colour vision tell apart."""
