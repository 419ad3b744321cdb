"""The largest accelerations that units feel where they are placed on a moving support."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot

from .deck.frame import pull_at
from .monitor import Monitor
from .planar import ORIGIN
from .scene import Scene
from .types import Status, Vector3
from .watch.stance import placed


class FeltMonitor(Monitor):
    """A monitor that keeps the `largest` accelerations (m/s^2) of each unit along x, y and, gravity left out, z."""

    def __init__(self, scenes: Mapping[str, Scene]) -> None:
        super().__init__(scenes)
        self._centers = {name: placed(scene).place(scene.center_of_mass) for name, scene in scenes.items()}
        self.largest: dict[str, Vector3] = {}

    def _moved(self, status: Status, stamp: int) -> Status:
        moment = None if self.deck is None else self.deck.last
        if status is Status.ACCEPTED and moment is not None:
            rest = hypot(*moment.gravity)
            for name, center in self._centers.items():
                x, y, z = pull_at(moment.felt, center, ORIGIN)
                a, b, c = self.largest.get(name, (0.0, 0.0, 0.0))
                self.largest[name] = max(a, abs(x)), max(b, abs(y)), max(c, abs(z + rest))
        return super()._moved(status, stamp)
