"""How a body stands on its support: the points it stands on, and the edges about which it can tip."""

from __future__ import annotations

from math import hypot, inf
from operator import itemgetter
from typing import NamedTuple

from ..scene import InertiaTensor, Scene
from ..types import Vector3
from ..vectors import Axes, add, any_across, axes_of, cross, dot, times, to_body, to_world, total, turned

STRETCH = 0.01  # of its length, by a lashing of unknown stiffness under its MSL: chains and wires
NARROW = 1e-6  # a support polygon narrower than this part of its length is a line: it has the extent of rounding


class Edge(NamedTuple):
    """An edge about which a body can tip, in the support's frame.

    `point` on it in m, `outward` the unit vector across it in the support, away from the body, and its `name` by the
    support's axes.
    """

    point: Vector3
    outward: Vector3
    name: str


class Holder(NamedTuple):
    """What can put a force along a unit vector on a body at a point (m), from `preload` up to `strength` (N).

    Of a lashing it grows by `stiffness` (N/m) as the body moves against it; of a chock, inf, at once.
    """

    point: Vector3
    direction: Vector3
    strength: float
    preload: float
    stiffness: float


class WindLoad(NamedTuple):
    """The forces (N) of winds along two axes in the support's frame, and where they act (m)."""

    forces: tuple[float, float]
    axes: tuple[Vector3, Vector3]
    center: Vector3

    def along(self, way: Vector3) -> float:
        """The force in N of a wind along a unit vector."""
        return total([force * abs(dot(axis, way)) for force, axis in zip(self.forces, self.axes, strict=True)])


class StandingBody(NamedTuple):
    """A body on its support, in the support's frame.

    `center` of mass in m, `inertia` about it in kg m^2 along the support's axes, `normal` of the support, the `edges`
    about which it can tip now; a cylinder of `radius` (m) lies on its two edges, in the place of feet. `holders` hold
    it besides friction, and the `wind` pushes it.
    """

    mass: float
    friction: float
    normal: Vector3
    center: Vector3
    inertia: InertiaTensor
    edges: tuple[Edge, ...]
    radius: float = 0.0
    holders: tuple[Holder, ...] = ()
    wind: WindLoad | None = None


class BodyPose(NamedTuple):
    """Where a body frame is in the support's frame: its origin in m, its axes."""

    position: Vector3
    axes: Axes

    def place(self, point: Vector3) -> Vector3:
        """A point of the body (m) in the support's frame."""
        return add(self.position, to_world(self.axes, point))

    def body(self, point: Vector3) -> Vector3:
        """A point of the support's frame in the body's."""
        return to_body(self.axes, add(point, self.position, -1.0))


def holders_of(scene: Scene, pose: BodyPose) -> tuple[Holder, ...]:
    """The lashings and the chocks of a body in a pose."""
    found = []
    for lashing in scene.lashings:
        point = pose.place(lashing.point)
        line = add(lashing.anchor, point, -1.0)
        length = hypot(*line) or 1.0
        stiffness = lashing.stiffness or lashing.msl / (STRETCH * length)
        found.append(Holder(point, times(line, 1.0 / length), lashing.msl, lashing.preload, stiffness))
    return (*found, *[Holder(chock.point, chock.normal, chock.strength, 0.0, inf) for chock in scene.chocks])


def wind_load(scene: Scene, pose: BodyPose) -> WindLoad | None:
    """The load of the wind on a body in a pose, if it knows of one."""
    if scene.wind is None:
        return None
    pressure, (along, across), center = scene.wind
    axes = to_world(pose.axes, (1.0, 0.0, 0.0)), to_world(pose.axes, (0.0, 1.0, 0.0))
    return WindLoad((pressure * along, pressure * across), axes, pose.place(center))


def placed(scene: Scene) -> BodyPose:
    """The pose in which the scene places the body."""
    return BodyPose(scene.place, axes_of(turned((0.0, 0.0, 0.0, 1.0), times(scene.normal, scene.yaw))))


def outline(points: list[Vector3], up: Vector3) -> list[Vector3]:
    """The corners of the convex hull of points across `up`, counter-clockwise; two where they lie on a line.

    The monotone chain: Andrew, Another efficient algorithm for convex hulls in two dimensions, Information Processing
    Letters 9 (1979) 216-219.
    """
    first = unit_across(up)
    second = cross(up, first)
    flat = sorted((dot(first, point), dot(second, point), point) for point in points)
    chain: list[tuple[float, float, Vector3]] = []
    for way in (flat, flat[::-1]):
        start = len(chain)
        for corner in way:
            while len(chain) > start + 1 and _area(chain[-2], chain[-1], corner) <= 0.0:
                chain.pop()
            chain.append(corner)
        chain.pop()
    corners = chain or flat[:1]
    lengths = [(hypot(p[0] - q[0], p[1] - q[1]), p, q) for p in corners for q in corners]
    length, one, other = max(lengths, key=itemgetter(0))
    if length == 0.0:
        return [one[2]]
    if max([abs(_area(one, other, corner)) for corner in corners]) <= NARROW * length * length:
        return [one[2], other[2]]
    return [corner[2] for corner in corners]


def edges_of(corners: list[Vector3], normal: Vector3) -> list[tuple[Edge, Vector3]]:
    """The edges between the corners of an outline (m, in the support's frame), each with the end of it.

    Of a line the ends are edges across it: what stands on it is judged in its plane alone.
    """
    if len(corners) < 2:
        return []
    found = []
    for i, point in enumerate(corners):
        following = corners[(i + 1) % len(corners)]
        along = add(following, point, -1.0)
        if len(corners) == 2:
            outward, end = add(times(along, -1.0), normal, dot(along, normal)), point
        else:
            outward, end = cross(along, normal), following
        length = hypot(*outward)
        if length > 0.0:
            outward = times(outward, 1.0 / length)
            found.append((Edge(point, outward, side(outward, normal)), end))
    return found


def side(outward: Vector3, normal: Vector3) -> str:
    """A direction in the support by the names of its axes: x is fore and y port (REP-103), or starboard where z points
    down.
    """
    x, y = outward[0], outward[1]
    if normal[2] < 0.0:
        y = -y
    if abs(normal[2]) < 0.5:  # the support's frame does not lie in the support: its own directions count
        first = unit_across(normal)
        x, y = dot(outward, first), dot(outward, cross(normal, first))
    along = "fore" if x > _DIAGONAL * abs(y) else "aft" if -x > _DIAGONAL * abs(y) else ""
    across = "port" if y > _DIAGONAL * abs(x) else "starboard" if -y > _DIAGONAL * abs(x) else ""
    return "-".join(name for name in (along, across) if name)


_DIAGONAL = 0.4142135623730951  # tan 22.5 degrees: the eight directions are 45 degrees wide

_Corner = tuple[float, float, Vector3]


def _area(a: _Corner, b: _Corner, c: _Corner) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def unit_across(u: Vector3) -> Vector3:
    """A unit vector at right angles to another vector."""
    across = cross(u, any_across(u))
    return times(across, 1.0 / hypot(*across))
