"""How bodies and supports are drawn by markers: boxes, cylinders, lines and slabs."""

from __future__ import annotations

from math import cos, floor, hypot, log10, pi, sin, sqrt
from typing import Final, NamedTuple

from ...prediction.scene import Scene
from ...prediction.types import Quaternion, Vector3
from ...prediction.vectors import Axes, add, axes_of, combine, cross, dot, times, to_body, to_world
from .message import CUBE, CYLINDER, LINE_LIST, NOWHERE, UNTURNED

AT_CORNER: Final = 0.02
"""Points this near to the corners of their box, as a part of its size, are its corners."""

_ROUND: Final = 24
"""Sides of a drawn circle."""


class BodyShape(NamedTuple):
    """A body's marker in the body frame: its type, pose, scale and lines; its `outline` as lines; `size` in m is that
    of its middle side, `reach` in m how far it goes from the mass centre.
    """

    shape: int
    scale: Vector3
    outline: tuple[Vector3, ...]
    size: float
    reach: float
    position: Vector3 = NOWHERE
    orientation: Quaternion = UNTURNED
    lines: tuple[Vector3, ...] = ()


class Slab(NamedTuple):
    """A part of the support in its frame: the middle of its surface, half its sides in m, and its axes, which are
    x, y and the normal.
    """

    middle: Vector3
    half_x: float
    half_y: float
    axes: Axes


def shape_of(scene: Scene, points: tuple[Vector3, ...]) -> BodyShape | None:
    """How a body looks that is known by its contact points and its mass centre, or None where it has no points yet.

    A box where the points are corners of one, which reaches beyond the mass centre as far as they lie before it; a
    cylinder as long as wide where it has a radius; else lines from the mass centre to the points, as are legs to feet.
    """
    if scene.radius > 0.0:
        return _cylinder(scene)
    if not points:
        return None
    center = scene.center_of_mass
    reach = max([hypot(*add(point, center, -1.0)) for point in points])
    low, high = box_of(points, center)
    sides = add(high, low, -1.0)
    near = AT_CORNER * max(sides)
    if scene.walking is None and min(sides) > near and all(_at_corner(point, low, high, near) for point in points):
        edges = _edges(low, high)
        return BodyShape(
            shape=CUBE,
            position=times(add(low, high), 0.5),
            scale=sides,
            outline=edges,
            size=sorted(sides)[1],
            reach=reach,
        )
    lines = tuple(end for point in points for end in (center, point))
    if len(points) == 2:
        lines += points
    return BodyShape(
        shape=LINE_LIST, scale=(0.05 * reach, 0.0, 0.0), lines=lines, outline=lines, size=reach, reach=reach
    )


def box_of(points: tuple[Vector3, ...], center: Vector3) -> tuple[Vector3, Vector3]:
    """The least and the greatest corner of the points' box along the body's axes; where the mass centre lies outside
    it along one, the box reaches as far beyond.
    """
    low, high = [], []
    for k in range(3):
        places = [point[k] for point in points]
        least, most = min(places), max(places)
        low.append(min(least, 2.0 * center[k] - most) if center[k] < least else least)
        high.append(max(most, 2.0 * center[k] - least) if center[k] > most else most)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _at_corner(point: Vector3, low: Vector3, high: Vector3, near: float) -> bool:
    return all(min(abs(p - a), abs(p - b)) <= near for p, a, b in zip(point, low, high, strict=True))


def _edges(low: Vector3, high: Vector3) -> tuple[Vector3, ...]:
    """The ends of the twelve edges of a box."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    ends: list[Vector3] = []
    for i, p in enumerate(corners):
        # Corners that differ in one number are the ends of an edge.
        ends += [end for q in corners[:i] if sum([a != b for a, b in zip(p, q, strict=True)]) == 1 for end in (p, q)]
    return tuple(ends)


def _cylinder(scene: Scene) -> BodyShape:
    radius, center = scene.radius, scene.center_of_mass
    along = to_body(axes_of(about(scene.normal, scene.yaw)), drum_axis(scene))
    upright = turn_to(along)
    axes = axes_of(upright)
    rim = [(radius * cos(2.0 * pi * k / _ROUND), radius * sin(2.0 * pi * k / _ROUND)) for k in range(_ROUND)]
    outline: list[Vector3] = []
    for end in (-radius, radius):
        for k, (x, y) in enumerate(rim):
            outline += [(*rim[k - 1], end), (x, y, end)]
        # A diameter shows how far it has turned.
        outline += [(-radius, 0.0, end), (radius, 0.0, end)]
    placed_outline = tuple(add(center, to_world(axes, point)) for point in outline)
    width = 2.0 * radius
    return BodyShape(
        shape=CYLINDER,
        position=center,
        orientation=upright,
        scale=(width, width, width),
        outline=placed_outline,
        size=width,
        reach=sqrt(2.0) * radius,
    )


def drum_axis(scene: Scene) -> Vector3:
    """The direction in the support along which a cylinder between edges lies."""
    line = cross(add(scene.edges[1], scene.edges[0], -1.0), scene.normal)
    return times(line, 1.0 / hypot(*line))


def about(axis: Vector3, angle: float) -> Quaternion:
    """The rotation about a unit vector by an angle in rad."""
    x, y, z = times(axis, sin(0.5 * angle))
    return x, y, z, cos(0.5 * angle)


def turn_to(direction: Vector3) -> Quaternion:
    """A rotation that turns z to a unit vector."""
    x, y, z = direction
    if z < -0.999999:
        return 1.0, 0.0, 0.0, 0.0
    # Half way between both: their cross product and 1 + their scalar product, made a unit.
    unit = 1.0 / sqrt(2.0 + 2.0 * z)
    return -y * unit, x * unit, 0.0, (1.0 + z) * unit


def deck_of(scene: Scene) -> Slab | None:
    """The whole support, or None where it has no end."""
    if scene.deck is None or not scene.deck.extent:
        return None
    x0, x1, y0, y1 = scene.deck.extent
    return _slab(scene, (0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0), 0.5 * (x1 - x0), 0.5 * (y1 - y0))


def patch_of(scene: Scene, places: list[Vector3], size: float) -> Slab:
    """A part of the support with room of at least `size` around places; it moves and grows in steps."""
    axes = axes_of(turn_to(scene.normal))
    step = 2.0 * size
    bounds = []
    for k in range(2):
        along = [dot(axes[k], place) for place in places]
        bounds.append((floor(min(along) / step - 0.5), floor(max(along) / step + 1.5)))
    (x0, x1), (y0, y1) = bounds
    middle = combine(0.5 * step * (x0 + x1), axes[0], 0.5 * step * (y0 + y1), axes[1], 0.0, axes[2])
    return _slab(scene, middle, 0.5 * step * (x1 - x0), 0.5 * step * (y1 - y0))


def _slab(scene: Scene, middle: Vector3, half_x: float, half_y: float) -> Slab:
    on_plane = add(middle, scene.normal, scene.height - dot(scene.normal, middle))
    return Slab(on_plane, half_x, half_y, axes_of(turn_to(scene.normal)))


def grid_of(slab: Slab) -> tuple[float, tuple[Vector3, ...]]:
    """The spacing in m, a 1, 2 or 5 with zeros, of about ten lines on a slab, and their ends seen from its middle."""
    longest = 2.0 * max(slab.half_x, slab.half_y)
    decade = 10.0 ** floor(log10(longest / 10.0))
    spacing = next(step * decade for step in (1.0, 2.0, 5.0, 10.0) if longest <= 12.0 * step * decade)
    ends: list[Vector3] = []
    for half, across, along_x in ((slab.half_x, slab.half_y, True), (slab.half_y, slab.half_x, False)):
        count = floor(half / spacing)
        inside = [k * spacing for k in range(-count, count + 1) if half - abs(k * spacing) > 0.3 * spacing]
        for place in (-half, *inside, half):
            ends += [(place, end, 0.0) if along_x else (end, place, 0.0) for end in (-across, across)]
    return spacing, tuple(ends)
