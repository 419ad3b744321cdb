"""The topic of markers: nothing is drawn, nor loaded, while nobody looks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rclpy.node import Node

from ...prediction.scene import Scene
from ...prediction.types import Geometry
from ..endpoints import publisher
from ..messages import MARKER_ARRAY

if TYPE_CHECKING:
    from .scene import MarkerScene


class MarkerTopic:
    """Publishes what a drawing of the scenes shows; `drawing` is there while somebody looks."""

    def __init__(self, node: Node, scenes: Mapping[str, Scene]) -> None:
        self.publisher = publisher(node, "~/markers", MARKER_ARRAY)
        self.drawing: MarkerScene | None = None
        self._scenes = scenes
        self._geometries: dict[str, Geometry] = {}

    def set_geometry(self, body: str, geometry: Geometry) -> None:
        """Take the contact points of a body that are no parameters, for now or later."""
        self._geometries[body] = geometry
        if self.drawing is not None:
            self.drawing.set_geometry(body, geometry)

    def begin_anew(self) -> None:
        """Draw from now on what the scenes have become."""
        self.drawing = None
        self.look_for_viewers()

    def look_for_viewers(self) -> None:
        """Begin to draw when somebody looks, and end when nobody does any more."""
        if not self.publisher.get_subscription_count():
            self.drawing = None
        elif self.drawing is None:
            from .scene import MarkerScene

            self.drawing = MarkerScene(self._scenes)
            for body, geometry in self._geometries.items():
                self.drawing.set_geometry(body, geometry)

    def show(self, stamp: int) -> None:
        """Publish the drawing if the time for it has come."""
        if self.drawing is not None:
            data = self.drawing.due(stamp)
            if data is not None:
                self.publisher.publish(data)
