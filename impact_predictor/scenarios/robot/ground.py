"""What robots walk on: level or inclined ground, blocks and stairs."""

from __future__ import annotations

from math import cos, sin
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...prediction.types import Vector3

TILE: Final = 0.2
"""Length of a block in m, and how far apart they lie."""

TREAD: Final = 0.4
"""Depth of a stair in m."""

AHEAD, ASIDE, BEHIND = 12.0, 2.0, 1.0
"""How far in m blocks and stairs reach."""

CLEAR: Final = 0.5
"""Half the side in m of the square without blocks on which a robot begins; the first stair is as far ahead."""


class Box(NamedTuple):
    """A block that stands on the floor: its middle, its extents, and how high its top is, in m."""

    x: float
    y: float
    length: float
    width: float
    top: float


class SimulatedGround(NamedTuple):
    """Where a robot begins at the origin: the ground rises ahead by `slope` (rad), or has `boxes` on a `floor` at a
    height in m, the highest `obstacle` m above what is beside it.
    """

    slope: float = 0.0
    boxes: tuple[Box, ...] = ()
    floor: float = 0.0
    obstacle: float = 0.0

    @property
    def normal(self) -> Vector3:
        return 0.0 - sin(self.slope), 0.0, cos(self.slope)

    def heights(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """How high it is, in m, at places (n,) of the world."""
        found: NDArray[np.float64] = self.floor + np.tan(self.slope) * x
        for box in self.boxes:
            on = (np.abs(x - box.x) <= 0.5 * box.length) & (np.abs(y - box.y) <= 0.5 * box.width)
            found = np.where(on, np.maximum(found, box.top), found)
        return found


def blocks(height: float, seed: int) -> SimulatedGround:
    """Blocks of a height in m on half of the ground, none where a robot begins."""
    rng, boxes = np.random.default_rng(seed), []
    for i in range(-round(BEHIND / TILE), round(AHEAD / TILE)):
        for j in range(-round(ASIDE / TILE), round(ASIDE / TILE) + 1):
            x, y = TILE * i, TILE * j
            if rng.random() < 0.5 and max(abs(x), abs(y)) > CLEAR:
                boxes.append(Box(x, y, TILE, TILE, height))
    return SimulatedGround(boxes=tuple(boxes), obstacle=height)


def stairs(rise: float) -> SimulatedGround:
    """Stairs that go up by a `rise` in m each, or down where it is negative."""
    count = round(AHEAD / TREAD)
    boxes = [Box(0.5 * (CLEAR - BEHIND), 0.0, CLEAR + BEHIND, 2.0 * ASIDE, 0.0)] if rise < 0.0 else []
    boxes += [Box(CLEAR + (k - 0.5) * TREAD, 0.0, TREAD, 2.0 * ASIDE, k * rise) for k in range(1, count)]
    return SimulatedGround(boxes=tuple(boxes), floor=min(0.0, count * rise), obstacle=abs(rise))
