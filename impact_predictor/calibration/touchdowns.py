"""Touchdowns whose twist after the impact a record shows, as problems that can be solved anew."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..prediction.course import between
from ..prediction.scene import Scene
from ..prediction.spatial_score import SpatialScore
from ..prediction.types import Score, SpatialTwist
from ..prediction.vectors import axes_of, cross, times
from .motions import SAME, Reals

if TYPE_CHECKING:
    from ..bags.run import Settled


class ScoredTouchdown(NamedTuple):
    """A touchdown as it was predicted last, and the twist that the record shows after it.

    `body` is its name, `stamp` (ns) when it struck, `kind` what stood and what struck. The axes are those of the
    support: `twist` (6,) of the mass centre right before it; `inertia` (3, 3); of each of the n points the way `arms`
    (n, 3) from the mass centre, the `normals` (n, 3), the `gaps` (n,) in m then, and whether it `stood` (n,). `size`
    (m) makes speeds of angular velocities. `measured` (6,) is the twist that the `score` has, some frames after the
    impact; without a score it is that right after it.
    """

    body: str
    stamp: int
    kind: str
    scene: Scene
    twist: Reals
    inertia: Reals
    arms: Reals
    normals: Reals
    gaps: Reals
    stood: NDArray[np.bool_]
    size: float
    measured: Reals
    score: SpatialScore | None = None

    @property
    def scales(self) -> Reals:
        """What makes the parts of a twist speeds (6,)."""
        return np.array([1.0] * 3 + [self.size] * 3)

    @property
    def speed(self) -> float:
        """What errors are relative to: the length of the twist before the impact, in m/s."""
        return float(np.linalg.norm(self.twist * self.scales))

    def continued(self, twist: Reals, friction: float, inertia: float = 1.0) -> Reals:
        """What a twist right after the impact has become where it is measured (6,); `inertia` is a factor."""
        if self.score is None:
            return twist
        score, scene, (vx, vy, vz, wx, wy, wz) = self.score, self.scene, twist.tolist()
        x, y, z = [times(row, inertia) for row in scene.inertia]
        course = score.course._replace(scene=scene._replace(friction=friction, inertia=(x, y, z)))
        _, second, third = course.poses(SpatialTwist((vx, vy, vz), (wx, wy, wz)), score.moments)
        seen = between(second, third, score.step)
        return np.array([*seen.linear, *seen.angular])


def touchdowns_of(settled: Iterable[Settled], scenes: Mapping[str, Scene]) -> list[ScoredTouchdown]:
    """The touchdowns of a replay that the record can score, those of one body after those of another.

    A motion that is another one, turned about the normal of the support, tells nothing new and counts once.
    """
    found: dict[bytes, ScoredTouchdown] = {}
    for body, score, _ in sorted(settled, key=lambda one: (one.body, one.score.stamp)):
        scene = scenes.get(body) or scenes.get("")
        if scene is not None and scene.radius and score.scored:
            found[f"{body} {score.stamp}".encode()] = _on_edges(body, scene, score)
        elif score.spatial is not None and not score.leftover_6d:
            found.setdefault(_heights(score.spatial), _on_points(body, score.spatial))
    return list(found.values())


def _on_points(body: str, score: SpatialScore) -> ScoredTouchdown:
    course, told = score.course, score.told
    scene, normal = course.scene, np.array(course.scene.normal)
    points, turn = np.array(course.points), np.array(axes_of(told.orientation)).T
    arms = (points - scene.center_of_mass) @ turn.T
    heights = arms @ normal + np.dot(course.start.center, normal) - scene.height
    return ScoredTouchdown(
        body=body,
        stamp=score.stamp,
        kind=score.kind,
        scene=scene,
        twist=np.array([*told.before_6d.linear, *told.before_6d.angular]),
        inertia=turn @ np.array(scene.inertia) @ turn.T,
        arms=arms,
        normals=np.broadcast_to(normal, arms.shape),
        gaps=np.maximum(heights, 0.0),
        stood=np.isin(np.arange(len(points)), told.old),
        size=score.size,
        measured=np.array([*score.measured.linear, *score.measured.angular]),
        score=score,
    )


def _on_edges(body: str, scene: Scene, score: Score) -> ScoredTouchdown:
    """A cylinder that rolls from one edge to the other, in its plane."""
    told, measured = score.touchdown, score.measured
    assert measured is not None
    along, turn = np.array(told.axis), np.array(axes_of(told.orientation)).T
    plane = np.array([cross(told.axis, scene.normal), scene.normal])
    arms = np.array(scene.edges) - told.position - turn @ scene.center_of_mass
    arms -= np.outer(arms @ along, along)
    before, after = (np.array([*(one[:2] @ plane), *(-one.omega * along)]) for one in (told.before, measured))
    return ScoredTouchdown(
        body=body,
        stamp=score.stamp,
        kind=told.kind,
        scene=scene,
        twist=before,
        inertia=turn @ np.array(scene.inertia) @ turn.T,
        arms=arms,
        normals=-arms / np.linalg.norm(arms, axis=1, keepdims=True),
        gaps=np.zeros(len(arms)),
        stood=np.isin(np.arange(len(arms)), told.old),
        size=told.half_distance,
        measured=after,
    )


def _heights(score: SpatialScore) -> bytes:
    """What a motion that is turned about the normal of the support has in common with the one that it was."""
    course = score.course
    arms = np.array(course.points) - course.scene.center_of_mass
    upright = [np.array(axes_of(pose.orientation)) @ course.scene.normal for pose in score.seen]
    heights = [
        np.dot(pose.center, course.scene.normal) + arms @ up for pose, up in zip(score.seen, upright, strict=True)
    ]
    return (np.round(np.sort(heights) / SAME) + 0.0).tobytes()
