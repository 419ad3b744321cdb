"""The markers of a walking machine's feet: where each lands, and when."""

from __future__ import annotations

from typing import Final

from ...prediction.types import Vector3
from ...prediction.vectors import add, mean
from .drawing import LANDING, Unit, label
from .message import LINE_LIST, NOWHERE, SPHERE_LIST, UNTURNED, Marker

FLAT: Final = 0.05
"""Size of the mark where a foot lands, in that of the machine."""


def draw_landings(unit: Unit, letter: float) -> list[Marker]:
    """A mark where each swinging foot lands, a line to it from the foot, and the foot's name with the time until then.

    A `letter` is so many m high.
    """
    drawn: list[Marker] = []
    lines: list[Vector3] = []
    places: list[Vector3] = []
    for k, foot in enumerate(unit.feet):
        if foot.place is None or foot.position is None or foot.lead_time is None:
            continue
        places.append(foot.place)
        lines += [foot.position, foot.place]
        words = f"{foot.name} {1e3 * foot.lead_time:.0f} ms"
        above = add(foot.place, unit.scene.normal, letter)
        drawn.append(label("feet/text", len(unit.feet) * unit.number + k, above, 0.6 * letter, words))
    if places:
        size = FLAT * unit.shape.size
        where = unit.number, LINE_LIST, NOWHERE, UNTURNED, (0.3 * size, 0.0, 0.0), LANDING
        drawn.append(Marker("feet/path", *where, tuple(lines)))
        marks = unit.number, SPHERE_LIST, NOWHERE, UNTURNED, (size, size, size), LANDING
        drawn.append(Marker("feet/landing", *marks, tuple(places)))
    return drawn


def place_of(unit: Unit, indices: tuple[int, ...]) -> Vector3:
    """The middle of the feet to which points of some indices belong: where they land, or else where they are."""
    each = 1 if unit.scene.walking is None else unit.scene.walking.points
    feet = [unit.feet[number] for number in sorted({i // each for i in indices})]
    return mean([foot.place or foot.position or NOWHERE for foot in feet])
