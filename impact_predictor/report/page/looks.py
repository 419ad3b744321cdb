"""How the page draws each family of methods: a colour and a marker."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final, NamedTuple

from markupsafe import Markup
from matplotlib.markers import MarkerStyle

from .svg import family_colour, tidy

MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X", "<", "p", ">", "h", "d", "*")
"""More than there are colours, so that families of one colour differ by their marker."""


class Looks(NamedTuple):
    """How a family is drawn."""

    colour: str
    marker: str


def looks_of(families: Iterable[str]) -> dict[str, Looks]:
    """One colour and one marker for each family, in their order; both come again after the last."""
    return {
        family: Looks(family_colour(number), MARKERS[number % len(MARKERS)])
        for number, family in enumerate(dict.fromkeys(families))
    }


def marker_svg(looks: Looks) -> Markup:
    """The marker of a family, for a line of text."""
    drawing = (
        f'<polygon points="{outline_of(looks.marker)}" fill="{looks.colour}" transform="translate(8 8) scale(11)"/>'
    )
    return Markup(tidy(f'<svg class="marker" viewBox="0 0 16 16" aria-hidden="true">{drawing}</svg>'))


def outline_of(marker: str) -> str:
    """The corners of a marker of about unit size, as SVG has them."""
    style = MarkerStyle(marker)
    polygons: Any = style.get_path().transformed(style.get_transform()).to_polygons()
    return " ".join(f"{x:.2f},{-y:.2f}" for x, y in polygons[0])
