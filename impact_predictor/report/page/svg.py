"""A figure of matplotlib as SVG inside a page: with the page's colours, text that is text, and marks that speak."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any, Final, NamedTuple
from xml.etree import ElementTree

import matplotlib
from markupsafe import Markup
from matplotlib.figure import Figure

# Colours that stand for variables of the page's style, which differ between light and dark.
INK, MUTED, GRID, PAPER, BAND, FRONT = (f"#0000{number:02x}" for number in range(1, 7))
_VARIABLES: Final = {INK: "ink", MUTED: "muted", GRID: "grid", PAPER: "paper", BAND: "band", FRONT: "front"}
_FIRST_FAMILY: Final = 0x10
COLOURS: Final = 10
"""Colours of families that the page's style has."""

FONT: Final = 12.0
"""Height of all letters, in pixels of a drawing that is not shrunk."""
STYLE: Final[dict[Any, Any]] = {
    "figure.dpi": 72,  # one unit of the SVG is a pixel of the page
    "font.family": "DejaVu Sans",
    "font.size": FONT,
    "text.color": INK,
    "axes.edgecolor": MUTED,
    "axes.facecolor": "none",
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "figure.facecolor": "none",
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "svg.fonttype": "none",
}
"""DejaVu Sans is wider than the fonts of browsers: what fits in it fits in them."""

_DRAWING: Final = {"d", "x", "y", "transform", "points", "style"}
"""Attributes whose numbers are pixels, of which two decimals are seen."""
_LINK: Final = "{http://www.w3.org/1999/xlink}href"


class Mark(NamedTuple):
    """What a drawn point tells: its tooltip, and attributes that the page's script reads.

    Of points that are drawn at once `titles` has the tooltip of each.
    """

    title: str
    attributes: Mapping[str, str]
    titles: Sequence[str] = ()


def family_colour(number: int) -> str:
    """The colour that stands for the family of this number."""
    return f"#0000{_FIRST_FAMILY + number % COLOURS:02x}"


def svg_of(figure: Figure, name: str, label: str, marks: Mapping[str, Mark], css_class: str = "") -> Markup:
    """The figure as an element of a page.

    Args:
        figure: drawn in `STYLE`; artists whose gid is a key of `marks` become its points.
        name: of the figure, another for each of a page.
        label: what the picture shows, for those who do not see it.
        marks: what each of its points tells.
        css_class: the class of the element.
    """
    file = BytesIO()
    # Identifiers come from the salt and the content: two figures of a page share none.
    with matplotlib.rc_context({"svg.hashsalt": name}):
        figure.savefig(file, format="svg", metadata=dict.fromkeys(("Creator", "Date", "Format", "Type")))
    root = ElementTree.fromstring(file.getvalue())
    for element in list(root.iter()):
        # A page knows these names without their namespaces.
        element.tag = element.tag.rpartition("}")[2]
        if (target := element.attrib.pop(_LINK, None)) is not None:
            element.set("href", target)
        for name in _DRAWING & element.attrib.keys():
            element.set(name, " ".join(re.sub(r"(?<=\d\.)(\d\d)\d+", r"\1", element.attrib[name]).split()))
        for child in list(element):
            if child.tag.endswith(("}metadata", "}style")):
                element.remove(child)
    for element in list(root.iter()):
        if mark := marks.get(element.get("id", "")):
            _tell(element, mark)
    _drop_identifiers(root)
    for attribute in ("width", "height", "version"):
        root.attrib.pop(attribute, None)
    root.attrib.update({"class": css_class, "role": "img", "aria-label": label})
    return Markup(tidy(ElementTree.tostring(root, encoding="unicode")))


def _tell(element: ElementTree.Element, mark: Mark) -> None:
    """Give a mark its attributes, and where it has a tooltip that and a ring around it that a finger meets."""
    for key, value in mark.attributes.items():
        element.set(f"data-{key}", value)
    if mark.titles:
        _tell_each(element, mark.titles)
    if not mark.title:
        return
    element.set("class", "point")
    element.insert(0, _title(mark.title))
    drawn = element.find(".//use")
    if drawn is not None:
        ring = {"class": "ring", "cx": drawn.get("x", "0"), "cy": drawn.get("y", "0"), "r": "9"}
        ElementTree.SubElement(element, "circle", ring)


def _tell_each(element: ElementTree.Element, titles: Sequence[str]) -> None:
    """Give each point of a crowd its tooltip."""
    points = [(parent, one) for parent in element.iter() for one in parent if one.tag == "use"]
    for (parent, drawn), title in zip(points, titles, strict=True):
        group = ElementTree.Element("g", {"class": "point"})
        group.extend((_title(title), drawn))
        parent[list(parent).index(drawn)] = group


def _title(text: str) -> ElementTree.Element:
    title = ElementTree.Element("title")
    title.text = text
    return title


def _drop_identifiers(root: ElementTree.Element) -> None:
    """Keep the identifiers that are referred to; those of groups repeat from figure to figure."""
    references = set(re.findall(r"#([\w-]+)", " ".join(value for one in root.iter() for value in one.attrib.values())))
    for element in root.iter():
        if element.get("id") not in references:
            element.attrib.pop("id", None)


def tidy(svg: str) -> str:
    """No fonts but the page's, no indents, and variables in the place of colours."""
    svg = re.sub(r"font-family: [^;\"]*;? ?", "", svg)
    svg = re.sub(r" transform=\"rotate\(-?0[ .][^)]*\)\"", "", svg)
    svg = re.sub(r"(?<=>)\s+(?=<)", "", svg)
    return re.sub(r"#0000[0-9a-f]{2}", _variable, svg)


def _variable(colour: re.Match[str]) -> str:
    number = int(colour[0][-2:], 16)
    return f"var(--{_VARIABLES.get(colour[0], f'family-{number - _FIRST_FAMILY}')})"
