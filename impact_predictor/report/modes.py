"""The contact modes as tables, maps, figures and pages show them: one meaning, colour and marker for each."""

from __future__ import annotations

from typing import Final, NamedTuple

from ..mechanics.types import Mode


class ModeLook(NamedTuple):
    """What an impact of two contacts of a mode means, and how the mode is drawn.

    `colour` is one of seven from dark to light in even steps, so that they differ for every colour vision and in grey;
    the light ones need an `EDGE`. `symbol` is a marker of plotly.
    """

    meaning: str
    colour: str
    symbol: str

    @property
    def is_dark(self) -> bool:
        """Whether letters on the colour have to be white."""
        return int(self.colour[1:3], 16) + 2 * int(self.colour[3:5], 16) < 0x1A0


MODES: Final = {
    Mode.NO_IMPACT: ModeLook("the new contact is not approached", "#ffffff", "diamond"),
    Mode.STOP: ModeLook("both contacts hold, neither slips: the body stops", "#0b3c6f", "square"),
    Mode.SLIDE: ModeLook("both contacts hold and slip", "#56b4e9", "triangle-right"),
    Mode.PIVOT_SLIDE: ModeLook("the old contact lifts, the new one slips", "#f7e57a", "cross"),
    Mode.PIVOT: ModeLook("the old contact lifts, the new one sticks", "#d55e00", "circle"),
    Mode.BACK_PIVOT: ModeLook("the new contact lifts again, the old one holds", "#7f4a8c", "triangle-left"),
    Mode.FLIGHT: ModeLook("both contacts lift", "#e3b5c9", "triangle-up"),
}
ONE_CONTACT: Final = {
    Mode.NO_IMPACT: "the contact is not approached",
    Mode.PIVOT_SLIDE: "the contact holds and slips",
    Mode.PIVOT: "the contact holds and sticks: the body turns about it",
    Mode.FLIGHT: "the contact lifts again",
}
"""What an impact of one contact means."""
EDGE: Final = "#1a1a1a"
"""Colour of the outline of a marker."""
PALETTE: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
"""Colours of what is no mode, in turn: those of Okabe and Ito, which people of any colour vision tell apart."""
LEVELS: Final = {"OK": "#b7d9c0", "WARN": "#f2a91a", "ERROR": "#d62728", "STALE": "#9aa3ad"}
"""Colours of the levels of a watch."""
