"""visualization_msgs/MarkerArray as bytes, for RViz 2 and Foxglove; the layout of ROS 2 Jazzy."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from math import dist
from struct import Struct
from typing import Final, NamedTuple

from ...prediction.types import Quaternion, Vector3
from ..cdr import LITTLE_ENDIAN, LITTLE_ENDIAN_HEADER, stamp, string

Colour = tuple[float, float, float, float]
"""Red, green, blue and opacity, each 0 to 1."""

ARROW, CUBE, SPHERE, CYLINDER = 0, 1, 2, 3
LINE_LIST, CUBE_LIST, SPHERE_LIST, TEXT = 5, 6, 7, 9
"""Types of a Marker."""
ADD, DELETE, DELETE_ALL = 0, 2, 3
"""Actions of a Marker."""

NOWHERE: Final[Vector3] = (0.0, 0.0, 0.0)
UNTURNED: Final[Quaternion] = (0.0, 0.0, 0.0, 1.0)

LIFETIME: Final = 2
"""Seconds after which a viewer drops a marker that was not sent again, so that no picture outlives its source."""


_SLATE: Final = (0.85, 0.88, 0.91, 1.0)
_WHITE: Final = (1.0, 1.0, 1.0, 1.0)
_BLUE: Final = (0.20, 0.45, 1.0, 1.0)
_MAGENTA: Final = (0.93, 0.25, 0.80, 1.0)
_AMBER: Final = (1.0, 0.72, 0.30, 1.0)

LOOKS: Final[dict[str, tuple[int, Colour]]] = {
    "support": (CUBE, (0.62, 0.66, 0.70, 1.0)),
    "support/grid": (LINE_LIST, _SLATE),
    "support/normal": (LINE_LIST, _SLATE),
    "support/plumb": (ARROW, (0.98, 0.85, 0.30, 1.0)),
    "support/text": (TEXT, _WHITE),
    "units/text": (TEXT, _WHITE),
    "contacts/standing": (CUBE_LIST, _BLUE),
    "contacts/striking": (SPHERE_LIST, _MAGENTA),
    "contacts/open": (SPHERE_LIST, (0.95, 0.95, 0.95, 1.0)),
    "touchdown/body": (LINE_LIST, _WHITE),
    "touchdown/impulse": (ARROW, _MAGENTA),
    "touchdown/velocity": (ARROW, (0.15, 0.80, 0.90, 1.0)),
    "feet/text": (TEXT, _WHITE),
    "feet/path": (LINE_LIST, _AMBER),
    "feet/landing": (SPHERE_LIST, _AMBER),
}
"""Type and colour of the markers of each namespace; those of "units" follow from the body and its level."""


NO_LOOK: Final[tuple[int, Colour]] = (CUBE, (0.0, 0.0, 0.0, 0.0))


class Marker(NamedTuple):
    """One visualization_msgs/Marker, known by its `namespace` and `number`; SI units.

    `size` is the width of a line or shaft, or the height of a letter, unless all of a `scale` is given; an arrow goes
    from the first point to the second. `points` are in the marker's own frame, which `position` and `orientation` place
    in that of the message. Where no `look`, type and colour, is given it is that of the namespace.
    """

    namespace: str
    number: int
    size: float = 0.0
    points: tuple[Vector3, ...] = ()
    position: Vector3 = NOWHERE
    orientation: Quaternion = UNTURNED
    text: str = ""
    scale: Vector3 | None = None
    look: tuple[int, Colour] | None = None
    action: int = ADD


def _scale(shape: int, size: float, points: tuple[Vector3, ...]) -> Vector3:
    if shape == LINE_LIST:
        return size, 0.0, 0.0
    if shape == TEXT:
        return 0.0, 0.0, size
    if shape == ARROW:  # diameters of shaft and head, and the length of the head, at most half of all
        return size, 2.2 * size, min(3.0 * size, 0.5 * dist(*points))
    return size, size, size


_HEAD: Final = Struct("<3i")
_BODY: Final = Struct("<10d4fiI?3xI")
"""Pose, scale, colour, lifetime, frame_locked and the number of points."""
_POINT: Final = Struct("<3d")
_EMPTY: Final = string("")
_NONE: Final = bytes(4)
# Colours, texture_resource, texture (header, format and data) and uv_coordinates.
_BEFORE_TEXT: Final = b"".join((_NONE, _EMPTY, bytes(8), _EMPTY, _EMPTY, _NONE, _NONE))
# mesh_resource, mesh_file and mesh_use_embedded_materials, padded to the next marker, or as DDS pads the whole.
_AFTER_TEXT: Final = b"".join((_EMPTY, _EMPTY, _NONE, _NONE))
_WITHOUT_TEXT: Final = _BEFORE_TEXT + _EMPTY + _AFTER_TEXT
_string = lru_cache(maxsize=64)(string)


def encode_markers(markers: Iterable[Marker], nanoseconds: int, frame_id: str) -> bytes:
    """A visualization_msgs/MarkerArray, all in one frame and of one stamp in ns.

    They move with their frame (frame_locked) and last `LIFETIME` seconds.
    """
    header = stamp(nanoseconds) + string(frame_id)
    chunks: list[bytes] = []
    count, size = 0, 4
    for namespace, number, width, points, position, orientation, text, given, look, action in markers:
        shape, colour = look or LOOKS[namespace]
        scale = given or _scale(shape, width, points)
        head = header + _string(namespace) + _HEAD.pack(number, shape, action)
        if (size + len(head)) & 7:
            head += _NONE
        body = _BODY.pack(*position, *orientation, *scale, *colour, LIFETIME, 0, True, len(points))
        # Points are doubles again: what lies before them, from double to double, is a multiple of eight.
        rest = _BEFORE_TEXT + string(text) + _AFTER_TEXT if text else _WITHOUT_TEXT
        chunks += (head, body, _packed(points), rest) if points else (head, body, rest)
        size += len(head) + len(body) + _POINT.size * len(points) + len(rest)
        count += 1
    return b"".join((LITTLE_ENDIAN_HEADER, LITTLE_ENDIAN.length.pack(count), *chunks))


@lru_cache(maxsize=1024)
def _packed(points: tuple[Vector3, ...]) -> bytes:
    return b"".join([_POINT.pack(*point) for point in points])
