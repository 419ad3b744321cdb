"""What the messages about contact points show to be wrong with them, or with the scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import dist, inf
from statistics import median
from typing import TYPE_CHECKING, Final

from ..prediction.checks import REMEDIES
from ..prediction.scene import Scene
from ..prediction.types import Geometry, Joints, Prediction, Sample, Status, Vector3
from ..prediction.vectors import add, axes_of, dot, to_world
from ..stamps import NANOSECONDS

if TYPE_CHECKING:
    from ..prediction.contacts import Contacts

MOVED: Final = 0.01
"""Contact points that are further than so many m from where they were first have moved."""

NEAR: Final = 4.0
"""Feet that never come nearer to the ground than so many contact tolerances never reach it."""

_MOST_NAMED: Final = 4


class Points:
    """What was told about the contact points of one body, and what became of it."""

    def __init__(self, scene: Scene, contacts: Contacts) -> None:
        self._scene, self._contacts = scene, contacts
        self._left_out: tuple[str, ...] = ()
        self._first: Geometry | None = None
        self._last: Geometry | None = None
        self._messages = self._moved = self._refused = 0
        self._flaws: Counter[str] = Counter()
        self._depths: list[float] = []
        self._nearest = self._nearest_in_world = inf
        self._sample: Sample | None = None

    def take_geometry(self, geometry: Geometry, status: Status) -> None:
        """Take a message of contact_geometry, or the points that follow from joints, and what became of it."""
        self._refused += status is not Status.ACCEPTED
        if status is Status.FEET_CHANGED:
            self._flaws[self._wrong_number(geometry)] += 1
        elif status in (Status.ACCEPTED, Status.BELOW_GROUND):
            first = self._first = self._first or geometry
            self._last, self._messages = geometry, self._messages + 1
            self._moved += any(dist(*pair) > MOVED for pair in zip(first.points, geometry.points, strict=False))
            self._nearest_in_world = min([self._nearest_in_world, *map(abs, map(self._gap, geometry.points))])
        if status is Status.BELOW_GROUND:
            self._measure_depth()

    def take_joints(self, joints: Joints, status: Status) -> None:
        """Take a message of joint_states, and what became of it."""
        if status is Status.WRONG_JOINTS:
            self._refused += 1
            self._flaws[_wrong_joints(joints, self._contacts.joints)] += 1
        elif self._contacts.geometry is not None:
            self._left_out = self._contacts.unknown_joints
            self.take_geometry(self._contacts.geometry, status)

    def take(self, prediction: Prediction) -> None:
        """Take the answer to a sample."""
        self._sample = prediction.sample
        if prediction.status is Status.BELOW_GROUND:
            self._measure_depth()
        self._nearest = min([self._nearest, *[abs(foot.gap) for foot in prediction.feet]])

    def words(self, status: Status) -> str:
        """What is wrong where messages are refused for a reason, and what to do."""
        if status in (Status.FEET_CHANGED, Status.WRONG_JOINTS) and self._flaws:
            return self._flaws.most_common(1)[0][0]
        if status is Status.BELOW_GROUND and self._depths:
            return (
                f"the lowest foot lies {median(self._depths):.3g} m below the ground: compare support.height, the "
                "units of the points (m), and the frames of body and points"
            )
        walking = self._scene.walking
        if status is Status.GEOMETRY_STALE and walking is not None:
            if self._refused:
                return "no message about the feet could be used for longer than feet.timeout"
            if self._interval > walking.timeout:
                return (
                    f"the feet are told of every {self._interval:.2g} s, but feet.timeout is {walking.timeout:g} s: "
                    "tell of them with each sample"
                )
        return REMEDIES.get(status, "")

    def doubts(self) -> list[str]:
        """What is left out of the messages, and what speaks against the scene although they fit it."""
        said = []
        if self._left_out:
            said.append(f"robot.urdf does not know {some(self._left_out)}, so what is told of these joints is left out")
        near = NEAR * self._scene.tolerance
        if near < self._nearest < inf:
            said.append(f"no foot came nearer to the ground than {self._nearest:.3g} m")
            said[-1] += (
                ", while the points reach it as if they were places in the world: tell them in the frame of the body"
                if self._nearest_in_world < near
                else ": compare support.height, the units of the points (m), and the frames of body and points"
            )
        return said

    def moving(self) -> str:
        """What is said of points that move against a body whose scene names no feet; "" where they do not."""
        if self._scene.walking is not None or 2 * self._moved <= self._messages:
            return ""
        return (
            f"the contact points are elsewhere than at first in {self._moved:,} of {self._messages:,} messages; "
            "if they are the feet of a machine that walks, give the names of these as feet.names"
        )

    @property
    def _interval(self) -> float:
        """The mean time in s from one message to the next."""
        if self._first is None or self._last is None or self._messages < 2:
            return 0.0
        return (self._last.stamp - self._first.stamp) / NANOSECONDS / (self._messages - 1)

    def _gap(self, place: Vector3) -> float:
        return dot(self._scene.normal, place) - self._scene.height

    def _measure_depth(self) -> None:
        sample, geometry = self._sample, self._last
        if sample is not None and geometry is not None:
            axes = axes_of(sample.orientation)
            places = [add(sample.position, to_world(axes, point)) for point in geometry.points]
            self._depths.append(-min(map(self._gap, places)))

    def _wrong_number(self, geometry: Geometry) -> str:
        walking, number = self._scene.walking, len(geometry.points)
        assert walking is not None
        wanted = len(walking.feet) * walking.points
        if number == wanted:
            return f"{len(geometry.velocities)} velocities came with {number} points: give one for each, or none"
        return (
            f"{number} points came, but feet.names ({len(walking.feet)}) x feet.points ({walking.points}) wants "
            f"{wanted}: correct these, or the message"
        )


def _wrong_joints(joints: Joints, known: Sequence[str]) -> str:
    lacking = [name for name in known if name not in joints.names]
    if not lacking:
        sizes = f"{len(joints.names)} names, {len(joints.positions)} positions and {len(joints.velocities)} velocities"
        return f"it has {sizes}, or a joint twice: tell each joint once, with its position"
    unknown = [name for name in joints.names if name not in known]
    others = f", while robot.urdf does not know its {some(unknown)}" if unknown else ""
    return f"it lacks {some(lacking)} of robot.urdf{others}: tell every joint of the model by its name there"


def some(names: Sequence[str]) -> str:
    """Some names as a part of a sentence."""
    more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
    return ", ".join(names[:_MOST_NAMED]) + more
