"""The markers of a support, of a body on it, and of the touchdown ahead of it."""

from __future__ import annotations

from functools import lru_cache
from math import acos, degrees, hypot, sqrt
from typing import Final, NamedTuple

from ...mechanics.types import Mode
from ...prediction.scene import Scene
from ...prediction.types import Foot, Moment, Quaternion, Touchdown, Vector3
from ...prediction.vectors import Axes, add, axes_of, combine, composed, cross, dot, mean, times, to_world
from ...stamps import NANOSECONDS
from .message import ARROW, CUBE, CUBE_LIST, LINE_LIST, NOWHERE, SPHERE_LIST, TEXT, UNTURNED, Colour, Marker
from .shapes import BodyShape, Slab, drum_axis, grid_of, turn_to

LEVELS: Final = ("OK", "WARN", "ERROR", "STALE")
LEVEL_COLOURS: Final[tuple[Colour, ...]] = (
    (0.16, 0.60, 0.36, 0.7),
    (0.95, 0.66, 0.10, 0.7),
    (0.84, 0.15, 0.16, 0.7),
    (0.55, 0.55, 0.55, 0.7),
)
"""Green, amber, red and grey, in the order of `LEVELS`."""
UNWATCHED: Final[Colour] = (0.33, 0.55, 0.83, 0.7)
"""A body without a level."""

LANDING: Final[Colour] = (1.0, 0.72, 0.30, 1.0)
_STANDING: Final[Colour] = (0.20, 0.45, 1.0, 1.0)
_STRIKING: Final[Colour] = (0.93, 0.25, 0.80, 1.0)
_OPEN: Final[Colour] = (0.95, 0.95, 0.95, 1.0)
_VELOCITY: Final[Colour] = (0.15, 0.80, 0.90, 1.0)
_GHOST: Final[Colour] = (1.0, 1.0, 1.0, 1.0)
_LETTERS: Final[Colour] = (1.0, 1.0, 1.0, 1.0)
_SURFACE: Final[Colour] = (0.62, 0.66, 0.70, 1.0)
_LINES: Final[Colour] = (0.85, 0.88, 0.91, 1.0)
_PLUMB: Final[Colour] = (0.98, 0.85, 0.30, 1.0)

_FLAT: Final = 0.05
"""Size of the mark where a foot lands, in that of the machine."""

_CONTACTS: Final = (
    ("standing", CUBE_LIST, 1.0, _STANDING),
    ("striking", SPHERE_LIST, 1.5, _STRIKING),
    ("open", SPHERE_LIST, 0.7, _OPEN),
)
"""Kinds of contacts: their form, how large it is, and its colour."""


class SeenPose(NamedTuple):
    """A body where it was last seen; `stamp` in ns."""

    stamp: int
    position: Vector3
    orientation: Quaternion


class ShownTouchdown(NamedTuple):
    """A touchdown and its stamp in ns; one that has `happened` with its relative error where it has one."""

    stamp: int
    touchdown: Touchdown
    happened: bool = False
    error: float | None = None


class BodyView(NamedTuple):
    """A body to be drawn: its number among all, its scene, its points and its looks, and what is known of it now;
    `level` is None where nobody watches it. `points` of a machine with `feet` are theirs, one of each.
    """

    number: int
    name: str
    scene: Scene
    points: tuple[Vector3, ...]
    shape: BodyShape
    seen: SeenPose
    ahead: ShownTouchdown | None
    level: int | None
    message: str
    feet: tuple[Foot, ...] = ()


def draw_support(slab: Slab, scene: Scene, moment: Moment | None, letter: float) -> list[Marker]:
    """The support with a grid; over a moving one also a plumb line beside the normal, which shows what is felt.

    A `letter` of the words is so many m high.
    """
    normal, longest = slab.axes[2], 2.0 * max(slab.half_x, slab.half_y)
    turned, thickness = turn_to(normal), 0.01 * longest
    spacing, grid = _grid(slab)
    below, above = add(slab.middle, normal, -0.5 * thickness), add(slab.middle, normal, 5e-4 * longest)
    sides = 2.0 * slab.half_x, 2.0 * slab.half_y, thickness
    width = 0.002 * longest, 0.0, 0.0
    drawn = [
        Marker("support", 0, CUBE, position=below, orientation=turned, scale=sides, colour=_SURFACE),
        Marker(
            "support/grid", 0, LINE_LIST, position=above, orientation=turned, scale=width, colour=_LINES, points=grid
        ),
    ]
    corner = combine(-slab.half_x, slab.axes[0], slab.half_y, slab.axes[1], 1.0, slab.middle)
    words = f"grid {spacing:g} m"
    if moment is not None:
        gravity = moment.felt.gravity
        size = hypot(*gravity)
        away = degrees(acos(max(-1.0, min(1.0, -dot(gravity, normal) / size)))) if size > 0.0 else 0.0
        words = f"felt gravity {size:.2f} m/s², {away:.1f}° off the normal\n{words}"
        high = 0.15 * longest
        top = add(corner, normal, high)
        plumb = _arrow("support/plumb", 0, top, add(top, gravity, high / hypot(*scene.gravity)), 0.006 * longest)
        drawn += [
            plumb._replace(colour=_PLUMB),
            Marker("support/normal", 0, LINE_LIST, scale=width, colour=_LINES, points=(corner, top)),
        ]
        corner = top
    drawn.append(label("support/text", 0, add(corner, normal, 2.0 * letter), letter, words))
    return drawn


@lru_cache(maxsize=8)
def _grid(slab: Slab) -> tuple[float, tuple[Vector3, ...]]:
    return grid_of(slab)


def draw_unit(unit: BodyView, stamp: int, letter: float) -> list[Marker]:
    """A body at a stamp in ns: its looks, its contacts, the touchdown ahead of it, and all of that in words, of which a
    `letter` is so many m high.
    """
    shape, seen, level = unit.shape, unit.seen, unit.level
    colour = UNWATCHED if level is None else LEVEL_COLOURS[level]
    axes = axes_of(seen.orientation)
    place = add(seen.position, to_world(axes, shape.position))
    turned = seen.orientation if shape.orientation == UNTURNED else composed(seen.orientation, shape.orientation)
    drawn = [
        Marker(
            "units",
            unit.number,
            shape.shape,
            position=place,
            orientation=turned,
            scale=shape.scale,
            colour=colour,
            points=shape.lines,
        )
    ]
    drawn += _points(unit, axes) if unit.scene.radius == 0.0 else _edges(unit)
    if unit.feet:
        drawn += _draw_landings(unit, letter)
    words = [unit.name if level is None else f"{unit.name} {LEVELS[level]}".lstrip()]
    if level and unit.message:
        words += unit.message.split("\n")
    if unit.ahead is not None:
        drawn += _draw_touchdown(unit, unit.ahead.touchdown)
        words += _touchdown_in_words(unit, unit.ahead, stamp)
    high = [abs(dot(axis, unit.scene.normal)) * side for axis, side in zip(axes, shape.scale, strict=True)]
    top = 0.5 * sum(high) if shape.shape == CUBE else shape.reach
    above = add(place, unit.scene.normal, top + (0.6 * len(words) + 0.4) * letter)
    drawn.append(label("units/text", unit.number, above, letter, "\n".join(words)))
    return drawn


def _points(unit: BodyView, axes: Axes) -> list[Marker]:
    """The contact points: cubes stand, large spheres strike next, small ones are open."""
    scene, seen = unit.scene, unit.seen
    old, new = _contacts_ahead(unit)
    height = dot(scene.normal, seen.position) - scene.height
    nx, ny, nz = [dot(axis, scene.normal) for axis in axes]
    kinds: tuple[list[Vector3], ...] = [], [], []
    for i, point in enumerate(unit.points):
        if unit.feet:
            lands = unit.feet[i].lead_time is not None and not unit.feet[i].stands
            kinds[1 if lands else 0 if unit.feet[i].stands else 2].append(point)
            continue
        stands = i in old or height + nx * point[0] + ny * point[1] + nz * point[2] <= scene.tolerance
        kinds[1 if i in new else 0 if stands else 2].append(point)
    width = 0.09 * unit.shape.size
    drawn = []
    for (kind, form, factor, colour), points in zip(_CONTACTS, kinds, strict=True):
        if points:
            scale = (factor * width,) * 3
            drawn.append(
                Marker(
                    f"contacts/{kind}",
                    unit.number,
                    form,
                    position=seen.position,
                    orientation=seen.orientation,
                    scale=scale,
                    colour=colour,
                    points=tuple(points),
                )
            )
    return drawn


def _edges(unit: BodyView) -> list[Marker]:
    """The edges of the support on which a cylinder lies, by their kinds."""
    scene = unit.scene
    half = times(drum_axis(scene), scene.radius)
    _, new = _contacts_ahead(unit)
    drawn = []
    for (kind, _, factor, colour), strikes in zip(_CONTACTS, (False, True), strict=False):
        edges = [edge for i, edge in enumerate(scene.edges) if (i in new) == strikes]
        if edges:
            ends = tuple(end for edge in edges for end in (add(edge, half, -1.0), add(edge, half)))
            scale = (0.1 * factor * scene.radius, 0.0, 0.0)
            drawn.append(Marker(f"contacts/{kind}", unit.number, LINE_LIST, scale=scale, colour=colour, points=ends))
    return drawn


def _contacts_ahead(unit: BodyView) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The contacts that stand and that strike next."""
    ahead = unit.ahead
    return ((), ()) if ahead is None or ahead.happened else (ahead.touchdown.old, ahead.touchdown.new)


def _length_of_speed(unit: BodyView) -> float:
    """How long the arrow of 1 m/s is, or of as much impulse on each kg: that of a fall from its own height is as long
    as the body.
    """
    return sqrt(unit.shape.size / hypot(*unit.scene.gravity))


def _draw_touchdown(unit: BodyView, touchdown: Touchdown) -> list[Marker]:
    """The body's outline at the touchdown, the impulses at its contacts, and the velocity of its mass centre after."""
    scene, shape, number = unit.scene, unit.shape, unit.number
    position, orientation = touchdown.position, touchdown.orientation
    axes, length, width = axes_of(orientation), _length_of_speed(unit), 0.04 * unit.shape.size
    thin = 0.6 * width, 0.0, 0.0
    drawn = [
        Marker(
            "touchdown/body",
            number,
            LINE_LIST,
            position=position,
            orientation=orientation,
            scale=thin,
            colour=_GHOST,
            points=shape.outline,
        )
    ]
    if unit.feet:  # legs do not keep their form
        drawn = []
    center = add(position, to_world(axes, scene.center_of_mass))
    for k, (indices, impulse) in enumerate(zip((touchdown.old, touchdown.new), touchdown.impulses, strict=True)):
        if not indices or max(indices) >= contacts_of(unit):
            continue
        if unit.feet:
            place, normal = _place_of(unit, indices), scene.normal
        elif scene.radius > 0.0:
            place = mean([scene.edges[i] for i in indices])
            arm = add(center, place, -1.0)
            arm = add(arm, touchdown.axis, -dot(arm, touchdown.axis))
            normal = times(arm, 1.0 / hypot(*arm))
        else:
            place = add(position, to_world(axes, mean([unit.points[i] for i in indices])))
            normal = scene.normal
        tangent = cross(touchdown.axis, normal)
        push = combine(impulse[0], normal, impulse[1], tangent, 0.0, tangent)
        if push != NOWHERE:
            drawn.append(
                _arrow("touchdown/impulse", 2 * number + k, place, add(place, push, length / scene.mass), width)
            )
    velocity = to_world(axes, add(touchdown.linear, cross(touchdown.angular, scene.center_of_mass)))
    if velocity != NOWHERE:
        arrow = _arrow("touchdown/velocity", number, center, add(center, velocity, length), width)
        drawn.append(arrow._replace(colour=_VELOCITY))
    return drawn


def contacts_of(unit: BodyView) -> int:
    """How many contacts there are to which indices may point."""
    scene = unit.scene
    if scene.walking is not None:
        return len(unit.feet) * scene.walking.points
    return len(scene.edges if scene.radius > 0.0 else unit.points)


def _touchdown_in_words(unit: BodyView, ahead: ShownTouchdown, stamp: int) -> list[str]:
    """Mode and time, the impulses with the scale of their arrows, the velocities after."""
    touchdown = ahead.touchdown
    away = (ahead.stamp - stamp) / NANOSECONDS
    mode = touchdown.mode.name.replace("_", " ")
    if ahead.happened:
        when = f"{mode} was predicted" + ("" if ahead.error is None else f", error {100.0 * ahead.error:.0f} %")
    else:
        when = f"{mode} in {1e3 * away:.0f} ms" if away >= 0.0 else f"{mode} was due {-away:.1f} s ago"
    sizes = [_short(hypot(*impulse)) for impulse in touchdown.impulses[0 if touchdown.old else 1 :]]
    scale = _short(unit.scene.mass / _length_of_speed(unit))
    speed, rate = hypot(touchdown.after.vx, touchdown.after.vy), abs(touchdown.after.omega)
    after = "then at rest" if touchdown.mode is Mode.STOP else f"then {_short(speed)} m/s, {_short(rate)} rad/s"
    return [when, f"impulses {' and '.join(sizes)} N s (1 m: {scale})", after]


def _short(number: float) -> str:
    """Two digits of a number, without an exponent."""
    return f"{float(f'{number:.1e}'):.10g}" if number >= 1e-4 else "0"


def _arrow(namespace: str, number: int, start: Vector3, tip: Vector3, width: float) -> Marker:
    """An arrow from one place to another, in the colour of impulses; its head is never longer than itself."""
    head = min(3.0 * width, 0.5 * hypot(*add(tip, start, -1.0)))
    scale = width, 2.2 * width, head
    return Marker(namespace, number, ARROW, scale=scale, colour=_STRIKING, points=(start, tip))


def label(namespace: str, number: int, place: Vector3, letter: float, words: str) -> Marker:
    """Words at a place, so high that a `letter` is so many m high."""
    return Marker(namespace, number, TEXT, position=place, scale=(0.0, 0.0, letter), colour=_LETTERS, text=words)


def _draw_landings(unit: BodyView, letter: float) -> list[Marker]:
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
        size = _FLAT * unit.shape.size
        thin = (0.3 * size, 0.0, 0.0)
        drawn.append(Marker("feet/path", unit.number, LINE_LIST, scale=thin, colour=LANDING, points=tuple(lines)))
        drawn.append(
            Marker(
                "feet/landing", unit.number, SPHERE_LIST, scale=(size, size, size), colour=LANDING, points=tuple(places)
            )
        )
    return drawn


def _place_of(unit: BodyView, indices: tuple[int, ...]) -> Vector3:
    """The middle of the feet to which points of some indices belong: where they land, or else where they are."""
    each = 1 if unit.scene.walking is None else unit.scene.walking.points
    feet = [unit.feet[number] for number in sorted({i // each for i in indices})]
    return mean([foot.place or foot.position or NOWHERE for foot in feet])
