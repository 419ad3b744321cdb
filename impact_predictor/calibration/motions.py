"""Recorded motions of a body on contact points: poses without a pause, each motion once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ..errors import InputError
from ..prediction.monitor import Monitor
from ..prediction.motion_recorder import MotionRecorder
from ..prediction.scene import Scene
from ..stamps import NANOSECONDS
from .search import Reals as Reals

SAME: Final = 1e-6
"""m: motions whose heights agree to this are one, turned about the normal of the support."""


class RecordedMotion(NamedTuple):
    """Poses of a body: `stamps` (n,) in ns; `positions` (n, 3) of the body frame's origin in m; `rotations` (n, 3, 3)
    whose columns are its axes in the world; and the `points` (m, 3) in it that can touch the support.
    """

    stamps: NDArray[np.int64]
    positions: Reals
    rotations: Reals
    points: Reals

    @property
    def times(self) -> Reals:
        """Seconds since the first pose (n,)."""
        times: Reals = (self.stamps - self.stamps[0]) / NANOSECONDS
        return times

    def gaps(self, scene: Scene) -> Reals:
        """The heights of the points above the scene's support (n, m) in m."""
        normal = np.array(scene.normal)
        heights = self.positions @ normal - scene.height
        gaps: Reals = heights[:, None] + np.einsum("i,tij,mj->tm", normal, self.rotations, self.points)
        return gaps

    def every(self, stride: int) -> RecordedMotion:
        """The motion with one of so many poses."""
        stamps, positions, rotations, points = self
        return RecordedMotion(stamps[::stride], positions[::stride], rotations[::stride], points)


class RecordingMonitor(Monitor):
    """A monitor that predicts nothing and keeps the motions of the only body of its scenes; InputError where there are
    several, or it is no body on contact points over a fixed support.
    """

    def __init__(self, scenes: Mapping[str, Scene]) -> None:
        scene = next(iter(scenes.values()))
        if len(scenes) > 1 or scene.deck or scene.walking or scene.radius or scene.watching or scene.source != "odom":
            raise InputError(
                "the scene must be that of one body on contact points over a fixed support; give such a one"
            )
        super().__init__(scenes)
        self._recorder = MotionRecorder(scene)
        for predictor in self.predictors.values():
            predictor.contacts = self._recorder

    @property
    def motions(self) -> list[RecordedMotion]:
        return [
            RecordedMotion(
                stamps=np.array([sample.stamp for sample in samples]),
                positions=np.array([sample.position for sample in samples]),
                rotations=Rotation.from_quat([sample.orientation for sample in samples]).as_matrix(),
                points=np.array(points),
            )
            for points, samples in self._recorder.motions
        ]


def distinct(scene: Scene, motions: Sequence[RecordedMotion]) -> list[RecordedMotion]:
    """The motions, each once: one that was turned about the normal of the support tells nothing new."""
    first: dict[bytes, RecordedMotion] = {}
    for motion in motions:
        # The points may be in another order; adding 0 makes -0 and 0 the same bytes.
        first.setdefault((np.round(np.sort(motion.gaps(scene)) / SAME) + 0.0).tobytes(), motion)
    return list(first.values())
