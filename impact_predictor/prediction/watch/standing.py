"""What a measured body does on its support: it stands, rocks, slides or lifts; and how it stands for its margins."""

from __future__ import annotations

from enum import Enum
from math import acos, dist, hypot, sqrt
from typing import Final

from ..planar import edge_of
from ..scene import Scene
from ..types import Quaternion, Sample, Vector3
from ..vectors import add, axes_of, cross, dot, tensor_to_world, times, to_body, to_world, total
from .stance import BodyPose, StandingBody, edges_of, holders_of, outline, placed, side, wind_load

COARSE: Final = 5e-4
"""Part of a body's size below which no gap counts, however fine the contact tolerance: neither cargo nor decks are so
flat, and no pose is measured so well."""

CLEAR: Final = 2.0
"""A point farther from the support than so many times what counts as touching has left it: noise stays below one."""

CONFIRMED: Final = 3
"""Samples in a row that must show a body off its feet, or moved: noise of one passes any bound now and then."""

LEANS: Final = 0.02  # rad: a tilt that two inertial sensors show, and more than they are mounted askew
SLID: Final = 4.0
"""As CLEAR, of a foot along the support from where it stood on the mean: there the tilt's noise counts more."""

SETTLES: Final = 1e-10
"""1/ns, in 10 s: poses drift slowly, and a body stands where it was seen on the mean of about so long."""


class BodyMotion(Enum):
    """What a body does, in words."""

    UNKNOWN = "is not measured"
    STANDS = "stands"
    ROCKS = "rocks"
    LIFTS = "is off the deck"


class Standing:
    """One body on its support, seen from there.

    `stance` is how it stands for its margins, without edges while it has no two points to stand on; `motion` what it
    does; `tilt` in rad, None where nothing tells it; `toppled` whether it lies on another side; `slid` how it slid
    since the sample before, in words, "" where it did not; `kinetic` the energy in J of its motion relative to the
    support while it rocks.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.stance: StandingBody
        self.motion = BodyMotion.UNKNOWN
        self.tilt: float | None = None
        self.toppled = False
        self.slid = ""
        self.kinetic = 0.0
        self._seen = False
        size = 2.0 * scene.radius or hypot(*edge_of(list(scene.points)))
        self._fine = self._touch = max(scene.tolerance, COARSE * size)
        self._clear = CLEAR * self._touch
        self._axis = (0.0, 0.0, 0.0)
        self._feet: list[Vector3] = []
        self._anchor: list[Vector3] = []
        self._last = self._off = self._moved = self._seen_standing = 0
        self._drawn: tuple[bool, list[Vector3]] = False, []
        self._rest(placed(scene))

    @property
    def unseen(self) -> float:
        """How far in m it may slide before that is seen."""
        return SLID * self._touch

    @property
    def solid(self) -> bool:
        return len(self._feet) > 1

    def edge_name(self, number: int) -> str:
        """The name of an edge about which it can tip, by its number; "" where there is none."""
        return self.stance.edges[number].name if 0 <= number < len(self.stance.edges) else ""

    def update(self, sample: Sample, slack: float = 0.0) -> bool:
        """Take a sample relative to the support, gaps up to `slack` m being none; whether the stance has changed."""
        self._touch = max(self._fine, slack)
        self._clear = CLEAR * self._touch
        pose = BodyPose(sample.position, axes_of(sample.orientation))
        feet, gaps = self._gaps(pose)
        if not self._scene.radius and (not self._seen or max(gaps) - min(gaps) > self._clear):
            if self._lies_otherwise(pose):
                feet, gaps = self._gaps(pose)
        lowest, highest = min(gaps), max(gaps)
        self._seen = True
        self.tilt = self._tilt_of(pose)
        self.slid, self.kinetic = "", 0.0
        self._off = self._off + 1 if highest - lowest > self._clear or lowest > self._clear else 0
        self.motion = BodyMotion.STANDS
        if self._off >= CONFIRMED:
            self.motion = BodyMotion.LIFTS if lowest > self._clear else BodyMotion.ROCKS
        if self.motion is BodyMotion.ROCKS:
            scene, spin = self._scene, sample.angular
            velocity = add(sample.linear, cross(spin, scene.center_of_mass))
            momentum = [dot(row, spin) for row in scene.inertia]
            turning = total([p * w for p, w in zip(momentum, spin, strict=True)])
            self.kinetic = 0.5 * (scene.mass * dot(velocity, velocity) + turning)
        if self.motion is not BodyMotion.STANDS:
            self._anchor = []
        elif self._off == 0:
            self._slide(sample.stamp, pose, feet)
        return self._draw(pose, feet, gaps)

    def lean(self, orientation: Quaternion) -> bool:
        """Take an orientation relative to the support alone; whether the stance has changed."""
        nominal = placed(self._scene)
        axes = axes_of(orientation)
        # It turns about the foot that is lowest then.
        heights = [dot(self._scene.normal, to_world(axes, foot)) for foot in self._feet]
        foot = self._feet[heights.index(min(heights))] if heights else (0.0, 0.0, 0.0)
        pose = BodyPose(add(nominal.place(foot), to_world(axes, foot), -1.0), axes)
        self.tilt = self._tilt_of(pose)
        gaps = [height - min(heights) for height in heights]
        leans = self.tilt > LEANS and (not gaps or max(gaps) > self._clear)
        self.motion = BodyMotion.ROCKS if leans else BodyMotion.STANDS
        return self._draw(pose, [pose.place(foot) for foot in self._feet], gaps)

    def _rest(self, pose: BodyPose) -> None:
        """Let it stand on what touches the support in a pose."""
        scene = self._scene
        self._up = to_body(pose.axes, scene.normal)
        if scene.radius:
            pose = self._on_edges(pose)
            self._feet = [pose.body(self._at_center(edge, pose)) for edge in scene.edges]
        else:
            self._feet = outline(self._standing_points(pose), self._up) if scene.points else []
        self._own = self._feet
        self._draw(pose, [pose.place(foot) for foot in self._feet], [0.0] * len(self._feet))

    def _lies_otherwise(self, pose: BodyPose) -> bool:
        """Whether it stands on another side than before, which is then the one it stands on."""
        scene = self._scene
        up = to_body(pose.axes, scene.normal)
        needed, low = min(3, max(2, len(self._feet))), self._standing_points(pose)
        feet = outline(low, up) if len(low) >= needed else []
        if len(feet) < needed or set(feet) <= set(self._feet):
            return False
        if min(dot(scene.normal, pose.place(foot)) for foot in feet) > scene.height + self._clear:
            return False
        self._feet = feet
        self._anchor, self._drawn = [], (False, [])
        if not self._seen:
            self._own, self._up = feet, up
        self.toppled = not set(feet) <= set(self._own)
        return True

    def _standing_points(self, pose: BodyPose) -> list[Vector3]:
        """The points (body frame) that are as low as the lowest one."""
        up, points = to_body(pose.axes, self._scene.normal), self._scene.points
        heights = [dot(up, point) for point in points]
        highest = min(heights) + self._touch
        return [point for point, height in zip(points, heights, strict=True) if height <= highest]

    def _gaps(self, pose: BodyPose) -> tuple[list[Vector3], list[float]]:
        """The feet, and how far they are from the support, or a cylinder from its edges, in m."""
        scene, feet = self._scene, [pose.place(foot) for foot in self._feet]
        if not scene.radius:
            return feet, [dot(scene.normal, foot) - scene.height for foot in feet] or [0.0]
        center = pose.place(scene.center_of_mass)
        return feet, [dist(center, self._at_center(edge, pose)) - scene.radius for edge in scene.edges]

    def _tilt_of(self, pose: BodyPose) -> float:
        cosine = dot(self._up, to_body(pose.axes, self._scene.normal))
        return acos(max(-1.0, min(1.0, cosine)))

    def _slide(self, stamp: int, pose: BodyPose, feet: list[Vector3]) -> None:
        """Compare where the feet are with where they stood; a cylinder's are where it then lay on its edges."""
        scene, since = self._scene, stamp - self._last
        self._last = stamp
        if not self._anchor or since < 0:
            self._settle(pose, feet)
            return
        if _within(feet, self._anchor, SLID * self._touch):
            self._moved = 0
            self._seen_standing += 1
            share = max(1.0 / self._seen_standing, min(1.0, since * SETTLES))
            self._anchor = [
                add(times(stood, 1.0 - share), foot, share) for stood, foot in zip(self._anchor, feet, strict=True)
            ]
            return
        self._moved += 1
        if self._moved < CONFIRMED:
            return
        moves = [add(foot, stood, -1.0) for foot, stood in zip(feet, self._anchor, strict=True)]
        rises = [dot(scene.normal, move) for move in moves]
        along = [add(move, scene.normal, -rise) for move, rise in zip(moves, rises, strict=True)]
        ways = moves if scene.radius else along
        squares = [dot(way, way) for way in ways]
        farthest = ways[squares.index(max(squares))]
        distance, rise = hypot(*farthest), max(rises, key=abs)
        if scene.radius:
            verb = "spins on its edges"
        elif abs(rise) > distance:
            verb, distance = "rises from where it stood" if rise > 0.0 else "sinks into the deck", abs(rise)
        else:
            verb = f"slides to {side(times(farthest, 1.0 / distance), scene.normal)}"
        self.slid = f"{verb}, by {distance:.3f} m"
        self._settle(pose, feet)

    def _settle(self, pose: BodyPose, feet: list[Vector3]) -> None:
        self._anchor, self._moved, self._seen_standing = feet, 0, 1
        if self._scene.radius:
            self._anchor = [self._at_center(edge, pose) for edge in self._scene.edges]
            self._feet = [pose.body(foot) for foot in self._anchor]

    def _draw(self, pose: BodyPose, feet: list[Vector3], gaps: list[float]) -> bool:
        """Make the stance anew if the body has moved since the last one; whether it did."""
        scene, normal = self._scene, self._scene.normal
        center = pose.place(scene.center_of_mass)
        if scene.radius:
            feet = [center]
        rocks, (rocked, drawn) = self.motion is BodyMotion.ROCKS, self._drawn
        if drawn and rocks == rocked and _within(feet, drawn, self._touch):
            return False
        self._drawn = rocks, feet
        found = edges_of([self._at_center(edge, pose) for edge in scene.edges] if scene.radius else feet, normal)
        if found and rocks and scene.radius:
            found = [found[gaps.index(min(gaps))]]
        elif found and rocks:
            heights = [dot(normal, edge.point) + dot(normal, end) for edge, end in found]
            found = [found[heights.index(min(heights))]]
        self.stance = StandingBody(
            mass=scene.mass,
            friction=scene.friction,
            normal=normal,
            center=center,
            inertia=tensor_to_world(pose.axes, scene.inertia),
            edges=tuple([edge for edge, _ in found]),
            radius=scene.radius,
            holders=holders_of(scene, pose),
            wind=wind_load(scene, pose),
        )
        return True

    def _at_center(self, edge: Vector3, pose: BodyPose) -> Vector3:
        """The point of an edge of the support that is nearest to a cylinder's mass centre."""
        return add(edge, self._axis, dot(self._axis, add(pose.place(self._scene.center_of_mass), edge, -1.0)))

    def _on_edges(self, pose: BodyPose) -> BodyPose:
        scene = self._scene
        first, second = scene.edges[:2]
        line = add(second, first, -1.0)
        across = cross(scene.normal, line)
        self._axis = times(across, 1.0 / (hypot(*across) or 1.0))
        up = cross(line, self._axis)
        length = hypot(*line)
        high = sqrt(max(0.0, scene.radius**2 - 0.25 * length * length)) / (hypot(*up) or 1.0)
        middle = times(add(first, second), 0.5)
        aside = dot(self._axis, add(pose.place(scene.center_of_mass), middle, -1.0))
        center = add(add(middle, up, high), self._axis, aside)
        return BodyPose(add(center, to_world(pose.axes, scene.center_of_mass), -1.0), pose.axes)


def _within(points: list[Vector3], others: list[Vector3], distance: float) -> bool:
    return all(dist(point, other) <= distance for point, other in zip(points, others, strict=True))
