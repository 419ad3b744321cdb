"""visualization_msgs/MarkerArray as bytes, for RViz 2 and Foxglove; the layout of ROS 2 Jazzy."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
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


class Marker(NamedTuple):
    """One visualization_msgs/Marker, known by its `namespace` and `number`; SI units.

    `points` are in the marker's own frame, which `position` and `orientation` place in that of the message; what
    `scale` and `points` mean depends on the `shape` (ARROW from the first point to the second: diameters of shaft and
    head, length of the head; lists: size of each; TEXT: the height of a letter in the last number).
    """

    namespace: str
    number: int
    shape: int = CUBE
    position: Vector3 = NOWHERE
    orientation: Quaternion = UNTURNED
    scale: Vector3 = NOWHERE
    colour: Colour = (0.0, 0.0, 0.0, 0.0)
    points: tuple[Vector3, ...] = ()
    text: str = ""
    action: int = ADD


_HEAD: Final = Struct("<3i")
_BODY: Final = Struct("<10d4fiI?3xI")
"""Pose, scale, colour, lifetime, frame_locked and the number of points."""
_POINT: Final = Struct("<3d")
_EMPTY: Final = string("")
_NONE: Final = bytes(4)
_BEFORE_TEXT: Final = b"".join(
    (
        _NONE,  # colors
        _EMPTY,  # texture_resource
        *(bytes(8), _EMPTY, _EMPTY, _NONE),  # texture: header, format and data
        _NONE,  # uv_coordinates
    )
)
_AFTER_TEXT: Final = b"".join(
    (
        _EMPTY,  # mesh_resource
        *(_EMPTY, _NONE),  # mesh_file
        _NONE,  # mesh_use_embedded_materials, padded to the marker that follows, or as DDS pads the whole
    )
)


@lru_cache(maxsize=64)
def _string(text: str) -> bytes:
    return string(text)


def encode_markers(markers: Iterable[Marker], nanoseconds: int, frame_id: str) -> bytes:
    """A visualization_msgs/MarkerArray, all in one frame and of one stamp in ns.

    They move with their frame (frame_locked) and last `LIFETIME` seconds.
    """
    header = stamp(nanoseconds) + string(frame_id)
    chunks: list[bytes] = []
    append = chunks.append
    count, size = 0, 4
    for marker in markers:
        namespace, number, shape, position, orientation, scale, colour, points, text, action = marker
        head = header + _string(namespace) + _HEAD.pack(number, shape, action)
        append(head)
        size += len(head)
        if size & 7:
            append(_NONE)
            size += 4
        append(_BODY.pack(*position, *orientation, *scale, *colour, LIFETIME, 0, True, len(points)))
        size += _BODY.size
        if points:  # doubles again: what lies before them, from double to double, is a multiple of eight
            packed = _packed(points)
            append(packed)
            size += len(packed)
        rest = _BEFORE_TEXT + (string(text) if text else _EMPTY) + _AFTER_TEXT
        append(rest)
        size += len(rest)
        count += 1
    return b"".join((LITTLE_ENDIAN_HEADER, LITTLE_ENDIAN.length.pack(count), *chunks))


@lru_cache(maxsize=1024)
def _packed(points: tuple[Vector3, ...]) -> bytes:
    return b"".join([_POINT.pack(*point) for point in points])
