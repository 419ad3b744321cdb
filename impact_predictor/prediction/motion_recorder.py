"""Contact points of a body that only keep its motions, in the order of time."""

from __future__ import annotations

from .points import PointContacts
from .scene import Scene
from .types import Moment, Sample, Status, Vector3


class MotionRecorder(PointContacts):
    """Keeps the samples between two changes of the contact points, with these, and announces nothing."""

    is_spatial = False

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.motions: list[tuple[tuple[Vector3, ...], list[Sample]]] = []

    def take(self, sample: Sample, moment: Moment | None) -> Status:
        if self.stamp is None or self.motions[-1][0] != self.points:
            self.motions.append((self.points, []))
        self.motions[-1][1].append(sample)
        self.stamp = sample.stamp
        return Status.ACCEPTED

    def touchdown(self) -> None:
        return None
