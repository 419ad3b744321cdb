"""What is known of a body, and its markers: its looks, its contacts, and the touchdown ahead of it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import cos, hypot, pi, sin, sqrt
from typing import Final, NamedTuple

from ...mechanics.types import Mode
from ...prediction.scene import Scene
from ...prediction.types import Foot, Geometry, Prediction, Quaternion, Touchdown, Vector3
from ...prediction.vectors import (
    Axes,
    add,
    axes_of,
    combine,
    composed,
    cross,
    dot,
    mean,
    times,
    to_body,
    to_world,
    turn_to,
)
from ...stamps import NANOSECONDS
from .message import CUBE, CYLINDER, LINE_LIST, LOOKS, NOWHERE, UNTURNED, Colour, Marker

LEVELS: Final[tuple[tuple[str, Colour], ...]] = (
    ("OK", (0.16, 0.60, 0.36, 0.7)),
    ("WARN", (0.95, 0.66, 0.10, 0.7)),
    ("ERROR", (0.84, 0.15, 0.16, 0.7)),
    ("STALE", (0.55, 0.55, 0.55, 0.7)),
)
"""Words and colours of the levels: green, amber, red and grey."""
_STALE: Final = 3
_UNWATCHED: Final[Colour] = (0.33, 0.55, 0.83, 0.7)

PAUSE: Final = 1_000_000_000
"""ns without news after which a body counts as stale; a clock that goes back by more has started anew."""
AFTERWARDS: Final = 1_000_000_000
"""ns for which a touchdown that has happened is still shown, where no other one is ahead."""
AT_CORNER: Final = 0.02
"""Points this near to the corners of their box, as a part of its size, are its corners."""
_ROUND: Final = 24
"""Sides of a drawn circle."""
_SIZES: Final = {"standing": 1.0, "striking": 1.5, "open": 0.7}
"""How large the marks of contacts are, by their kinds."""


class BodyShape(NamedTuple):
    """A body's marker in the body frame: its type, pose and scale; its `outline` as lines; `size` in m is that
    of its middle side, `reach` in m how far it goes from the mass centre.
    """

    shape: int
    scale: Vector3
    outline: tuple[Vector3, ...]
    size: float
    reach: float
    position: Vector3 = NOWHERE
    orientation: Quaternion = UNTURNED


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
    at_corners = [min(abs(p - a), abs(p - b)) <= near for one in points for p, a, b in zip(one, low, high, strict=True)]
    if scene.walking is None and min(sides) > near and all(at_corners):
        return BodyShape(
            shape=CUBE,
            position=times(add(low, high), 0.5),
            scale=sides,
            outline=_edges_of_box(low, high),
            size=sorted(sides)[1],
            reach=reach,
        )
    lines = tuple(end for point in points for end in (center, point)) + (points if len(points) == 2 else ())
    return BodyShape(shape=LINE_LIST, scale=(0.05 * reach, 0.0, 0.0), outline=lines, size=reach, reach=reach)


def box_of(points: tuple[Vector3, ...], center: Vector3) -> tuple[Vector3, Vector3]:
    """The least and the greatest corner of the points' box along the body's axes; where the mass centre lies outside
    it along one, the box reaches as far beyond.
    """
    low, high = [], []
    for places, middle in zip(zip(*points, strict=True), center, strict=True):
        least, most = min(places), max(places)
        low.append(min(least, 2.0 * middle - most) if middle < least else least)
        high.append(max(most, 2.0 * middle - least) if middle > most else most)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _edges_of_box(low: Vector3, high: Vector3) -> tuple[Vector3, ...]:
    """The ends of the twelve edges: of corners that differ in one number."""
    corners = list(product(*zip(low, high, strict=True)))
    pairs = [(p, q) for i, p in enumerate(corners) for q in corners[:i]]
    return tuple(end for pair in pairs if sum(map(float.__ne__, *pair)) == 1 for end in pair)  # type: ignore[misc]


def _cylinder(scene: Scene) -> BodyShape:
    radius, center, width = scene.radius, scene.center_of_mass, 2.0 * scene.radius
    upright = turn_to(to_body(axes_of(about(scene.normal, scene.yaw)), drum_axis(scene)))
    axes = axes_of(upright)
    rim = [(radius * cos(2.0 * pi * k / _ROUND), radius * sin(2.0 * pi * k / _ROUND)) for k in range(_ROUND)]
    outline: list[Vector3] = []
    for end in (-radius, radius):
        for k, (x, y) in enumerate(rim):
            outline += [(*rim[k - 1], end), (x, y, end)]
        # A diameter shows how far it has turned.
        outline += [(-radius, 0.0, end), (radius, 0.0, end)]
    return BodyShape(
        shape=CYLINDER,
        position=center,
        orientation=upright,
        scale=(width, width, width),
        outline=tuple(add(center, to_world(axes, point)) for point in outline),
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


class BodyMarkers:
    """What is known of one body, the `number`th of all; `level` is None where nobody watches it."""

    def __init__(self, number: int, name: str, scene: Scene) -> None:
        self.scene = scene
        self.level: int | None = None
        self.message = ""
        self._number = number
        self._name = name
        self._seen: SeenPose | None = None
        self._points = scene.points
        self._shape = shape_of(scene, scene.points)
        self._ahead: ShownTouchdown | None = None
        self._feet: tuple[Foot, ...] = ()

    def set_points(self, geometry: Geometry) -> None:
        # Feet are drawn where the answers say that they are.
        if self.scene.walking is None and geometry.points != self._points:
            self._points = geometry.points
            self._shape = shape_of(self.scene, geometry.points)

    def take(self, prediction: Prediction) -> bool:
        """Note an answer; whether it says where the body is."""
        sample = prediction.sample if self.scene.deck is None else prediction.relative
        if sample is None:
            return False
        self._seen = SeenPose(sample.stamp, sample.position, sample.orientation)
        self._name = self._name or sample.child_frame_id
        self._feet = prediction.feet
        touchdown, score = prediction.touchdown, prediction.score
        if touchdown is not None:
            self._ahead = ShownTouchdown(sample.stamp + round(touchdown.lead_time * NANOSECONDS), touchdown)
        elif score is not None:
            self._ahead = ShownTouchdown(score.stamp, score.touchdown, happened=True, error=score.relative_error)
        elif self._ahead is not None and not self._ahead.happened:
            self._ahead = None
        return True

    def lean(self, stamp: int, orientation: Quaternion) -> None:
        """Stand with an orientation at the scene's place, on the lowest point."""
        scene, axes = self.scene, axes_of(orientation)
        position = scene.place
        if scene.radius == 0.0 and self._points:
            heights = [dot(scene.normal, add(position, to_world(axes, point))) for point in self._points]
            position = add(position, scene.normal, scene.height - min(heights))
        self._seen = SeenPose(stamp, position, orientation)

    def forget_after(self, stamp: int) -> None:
        """Forget what is later than a stamp in ns."""
        if self._seen is not None and self._seen.stamp > stamp:
            self._seen = self._ahead = None

    def at(self, stamp: int) -> tuple[SeenPose, BodyShape] | None:
        """Where it is at a stamp in ns and how it looks, or None where that is unknown."""
        scene, seen = self.scene, self._seen
        if seen is not None and self._feet:
            axes = axes_of(seen.orientation)
            places = [add(foot.position, seen.position, -1.0) for foot in self._feet if foot.position is not None]
            self._points = tuple(to_body(axes, place) for place in places)
            self._shape = shape_of(scene, self._points)
        if seen is None and scene.deck is not None and scene.source != "odom":
            seen = SeenPose(stamp, scene.place, about(scene.normal, scene.yaw))
        if self._ahead is not None and stamp - self._ahead.stamp > AFTERWARDS:
            self._ahead = None
        return None if seen is None or self._shape is None else (seen, self._shape)

    def draw(self, seen: SeenPose, shape: BodyShape, stamp: int, letter: float) -> list[Marker]:
        """Its markers at a stamp in ns, in words too, of which a `letter` is so many m high."""
        scene, ahead, level = self.scene, self._ahead, self.level
        if scene.watching is None and stamp - seen.stamp > PAUSE:
            level = _STALE
        name, colour = (self._name, _UNWATCHED) if level is None else LEVELS[level]
        words = [name if level is None else f"{self._name} {name}".lstrip()]
        if level and self.message:
            words += self.message.split("\n")
        axes = axes_of(seen.orientation)
        place = add(seen.position, to_world(axes, shape.position))
        turned = seen.orientation if shape.orientation == UNTURNED else composed(seen.orientation, shape.orientation)
        body = Marker(
            namespace="units",
            number=self._number,
            position=place,
            orientation=turned,
            points=shape.outline if shape.shape == LINE_LIST else (),
            scale=shape.scale,
            look=(shape.shape, colour),
        )
        drawn = [body, *self._contacts(seen, axes, shape), *(self._landings(shape, letter) if self._feet else ())]
        if ahead is not None:
            # How long the arrow of 1 m/s is, or of as much impulse on each kg: that of a fall from its own height is
            # as long as the body.
            length = sqrt(shape.size / hypot(*scene.gravity))
            drawn += self._touchdown(ahead.touchdown, shape, length)
            words += _in_words(ahead, stamp, scene.mass / length)
        high = [abs(dot(axis, scene.normal)) * side for axis, side in zip(axes, shape.scale, strict=True)]
        top = 0.5 * sum(high) if shape.shape == CUBE else shape.reach
        above = add(place, scene.normal, top + (0.6 * len(words) + 0.4) * letter)
        return [*drawn, Marker("units/text", self._number, letter, position=above, text="\n".join(words))]

    def _contacts(self, seen: SeenPose, axes: Axes, shape: BodyShape) -> list[Marker]:
        """The contact points: cubes stand, large spheres strike next, small ones are open; of a cylinder the edges."""
        scene, ahead, is_drum = self.scene, self._ahead, self.scene.radius > 0.0
        old, new = ((), ()) if ahead is None or ahead.happened else (ahead.touchdown.old, ahead.touchdown.new)
        places: dict[str, list[Vector3]] = {kind: [] for kind in _SIZES}
        if is_drum:
            half = times(drum_axis(scene), scene.radius)
            for i, edge in enumerate(scene.edges):
                places["striking" if i in new else "standing"] += (add(edge, half, -1.0), add(edge, half))
        elif self._feet:
            for foot, point in zip(self._feet, self._points, strict=False):
                places["standing" if foot.stands else "open" if foot.lead_time is None else "striking"].append(point)
        else:
            height, normal = dot(scene.normal, seen.position) - scene.height, to_body(axes, scene.normal)
            for i, point in enumerate(self._points):
                stands = i in old or height + dot(normal, point) <= scene.tolerance
                places["striking" if i in new else "standing" if stands else "open"].append(point)
        drawn, pose = [], (NOWHERE, UNTURNED) if is_drum else (seen.position, seen.orientation)
        for kind, points in places.items():
            if points:
                name, factor = f"contacts/{kind}", _SIZES[kind]
                size = 0.1 * factor * scene.radius if is_drum else factor * (0.09 * shape.size)
                look = (LINE_LIST, LOOKS[name][1]) if is_drum else None
                drawn.append(Marker(name, self._number, size, tuple(points), *pose, look=look))
        return drawn

    def _landings(self, shape: BodyShape, letter: float) -> list[Marker]:
        """A mark where each swinging foot lands, a line to it from the foot, and its name with the time until then."""
        drawn: list[Marker] = []
        lines: list[Vector3] = []
        places: list[Vector3] = []
        for k, foot in enumerate(self._feet):
            if foot.place is None or foot.position is None or foot.lead_time is None:
                continue
            places.append(foot.place)
            lines += [foot.position, foot.place]
            words, number = f"{foot.name} {1e3 * foot.lead_time:.0f} ms", len(self._feet) * self._number + k
            above = add(foot.place, self.scene.normal, letter)
            drawn.append(Marker("feet/text", number, 0.6 * letter, position=above, text=words))
        if places:
            size = 0.05 * shape.size
            drawn.append(Marker("feet/path", self._number, 0.3 * size, tuple(lines)))
            drawn.append(Marker("feet/landing", self._number, size, tuple(places)))
        return drawn

    def _touchdown(self, touchdown: Touchdown, shape: BodyShape, length: float) -> list[Marker]:
        """The outline at the touchdown, the impulses at the contacts, and the velocity of the mass centre after it;
        an arrow of 1 m/s is of a `length` in m.
        """
        scene, number, pose = self.scene, self._number, (touchdown.position, touchdown.orientation)
        axes, width = axes_of(touchdown.orientation), 0.04 * shape.size
        drawn: list[Marker] = []
        if not self._feet:  # legs do not keep their form
            drawn.append(Marker("touchdown/body", number, 0.6 * width, shape.outline, *pose))
        center = add(touchdown.position, to_world(axes, scene.center_of_mass))
        for k, (indices, impulse) in enumerate(zip((touchdown.old, touchdown.new), touchdown.impulses, strict=True)):
            place = self._place_of(indices, touchdown.position, axes)
            if place is None:
                continue
            normal = scene.normal
            if scene.radius > 0.0:
                arm = add(center, place, -1.0)
                arm = add(arm, touchdown.axis, -dot(arm, touchdown.axis))
                normal = times(arm, 1.0 / hypot(*arm))
            tangent = cross(touchdown.axis, normal)
            push = combine(impulse[0], normal, impulse[1], tangent, 0.0, tangent)
            if push != NOWHERE:
                ends = place, add(place, push, length / scene.mass)
                drawn.append(Marker("touchdown/impulse", 2 * number + k, width, ends))
        velocity = to_world(axes, add(touchdown.linear, cross(touchdown.angular, scene.center_of_mass)))
        if velocity != NOWHERE:
            drawn.append(Marker("touchdown/velocity", number, width, (center, add(center, velocity, length))))
        return drawn

    def _place_of(self, indices: tuple[int, ...], position: Vector3, axes: Axes) -> Vector3 | None:
        """The middle of contacts of a body at a pose, None where there are none of these indices.

        Feet are where they land, or else where they are.
        """
        walking = self.scene.walking
        places: Sequence[Vector3] = self.scene.edges if self.scene.radius > 0.0 else self._points
        if walking is not None:
            places = [foot.place or foot.position or NOWHERE for foot in self._feet]
            indices = tuple(sorted({i // walking.points for i in indices}))
        if not indices or max(indices) >= len(places):
            return None
        middle = mean([places[i] for i in indices])
        is_fixed = walking is not None or self.scene.radius > 0.0
        return middle if is_fixed else add(position, to_world(axes, middle))


def _in_words(ahead: ShownTouchdown, stamp: int, scale: float) -> list[str]:
    """Mode and time, the impulses with the `scale` of their arrows in N s/m, the velocities after."""
    touchdown = ahead.touchdown
    away = (ahead.stamp - stamp) / NANOSECONDS
    mode = touchdown.mode.name.replace("_", " ")
    if ahead.happened:
        when = f"{mode} was predicted" + ("" if ahead.error is None else f", error {100.0 * ahead.error:.0f} %")
    else:
        when = f"{mode} in {1e3 * away:.0f} ms" if away >= 0.0 else f"{mode} was due {-away:.1f} s ago"
    sizes = [_short(hypot(*impulse)) for impulse in touchdown.impulses[0 if touchdown.old else 1 :]]
    speed, rate = hypot(touchdown.after.vx, touchdown.after.vy), abs(touchdown.after.omega)
    after = "then at rest" if touchdown.mode is Mode.STOP else f"then {_short(speed)} m/s, {_short(rate)} rad/s"
    bound = f", {touchdown.bound.value}" if touchdown.bound else ""
    return [when, f"impulses {' and '.join(sizes)} N s{bound} (1 m: {_short(scale)})", after]


def _short(number: float) -> str:
    """Two digits of a number, without an exponent."""
    return f"{float(f'{number:.1e}'):.10g}" if number >= 1e-4 else "0"
