"""A body aboard a moving support: its samples seen from there, and whether it is where a body can be."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING

from ..planar import Posture, edge_of
from ..scene import Scene
from ..types import Moment, Sample, Status, Vector3
from .approach import center_of
from .relative import seen_from

if TYPE_CHECKING:
    from ..drum import Drum
    from .tracker import Deck

HIGH = 1.0
"""A body is off its support when all of it is farther above than this part of its size. No impact throws it there: for
a body of 1 m that takes 4.4 m/s, and one that topples keeps a contact, or one near it."""

DEEP = 0.05
"""A body is below its support when it reaches deeper than this part of its size ..."""

DEEP_TOLERANCES = 4.0
"""... and so many contact tolerances. A tolerance is about three standard deviations of the gap of a point that rests,
and an orientation that is wrong by 3 degrees (0.05 rad) moves a point by 0.05 of the body's size."""


class Aboard:
    """The moving support of a scene, as its body needs it; without a `deck` nothing is known of it."""

    def __init__(self, scene: Scene, deck: Deck | None, drum: Drum | None) -> None:
        self.scene, self._deck, self._drum = scene, deck, drum
        self._extent = scene.deck.extent if scene.deck is not None else ()
        self._points: tuple[Vector3, ...] = ()
        self._highest = self._deepest = 0.0

    def seen(self, sample: Sample) -> tuple[Moment, Sample] | Status:
        """The support at the sample's stamp, and the sample in its frame; or why there is none."""
        if self._deck is None:
            return Status.NO_SUPPORT
        moment = self._deck.at(sample.stamp)
        if isinstance(moment, Status):
            return moment
        relative = seen_from(moment, self.scene.frame, sample)
        return Status.WRONG_FRAME if relative is None else (moment, relative)

    def place_of(self, sample: Sample, posture: Posture, points: tuple[Vector3, ...]) -> Status:
        """Whether a body can be where it is seen."""
        if points is not self._points:
            self._points = points
            size = self._drum.size if self._drum is not None else hypot(*edge_of(list(points)))
            self._highest = HIGH * size
            self._deepest = -(DEEP * size + DEEP_TOLERANCES * self.scene.tolerance)
        lowest = min(posture.gaps)
        if lowest < self._deepest:
            return Status.BELOW_SUPPORT
        if lowest > self._highest:
            return Status.OFF_SUPPORT
        if self._extent or self._drum is not None:
            center = center_of(self.scene, sample, posture)
            if self._drum is not None and self._drum.has_left(center):
                return Status.OFF_SUPPORT
            if self._extent:
                back, front, right, left = self._extent
                if not (back <= center[0] <= front and right <= center[1] <= left):
                    return Status.OFF_SUPPORT
        return Status.ACCEPTED
