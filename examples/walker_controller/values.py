"""What machine and controllers share: the machine's numbers, its ground, what it is told and what it measures."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Machine(NamedTuple):
    """What the machine is; SI units."""

    mass: float = 20.0
    inertia: float = 1.2
    """About the hub, where the mass centre is, with what it carries there."""
    leg: float = 1.0
    swing_rate: float = 8.0
    """The fastest that the leg turns against the hub while it swings, rad/s."""
    trim_rate: float = 8.0
    """The same once it is stretched."""
    shortening: float = 0.1
    """Part of its length by which the leg is shortened while it swings."""
    stretch_time: float = 0.06
    """Time in s to shorten it, and to stretch it again."""
    largest_push: float = 20.0
    """N s."""
    least_angle: float = 0.3
    largest_angle: float = 1.0
    """Between the legs, rad."""


class Gust(NamedTuple):
    """A push along the ground: `force` in N from `start` to `end` in s."""

    start: float
    end: float
    force: float


class Ground(NamedTuple):
    """A slope (rad, positive downhill ahead) paved with slabs, each with its own friction and height (m)."""

    slope: float
    frictions: tuple[float, ...]
    heights: tuple[float, ...]
    slab: float = 0.25
    gravity: float = 9.81

    def slab_at(self, x: float) -> int:
        """The number of the slab at a place; the first and the last have no end."""
        return min(max(int(x / self.slab), 0), len(self.heights) - 1)


class Command(NamedTuple):
    """What the machine is told at each tick: the angle between the legs to set (rad), and the push-off (N s)."""

    angle: float
    push: float


class Seen(NamedTuple):
    """What the machine measures of itself, by encoders and gyroscope.

    `stamp` in ns; `steps` made so far; `lean` (rad) of the leg that stands and its `rate` (rad/s); `angle` (rad) from
    it to the one that swings; `ready` once that is stretched and may land; `slips` while the foot that stands does.
    """

    stamp: int
    steps: int
    lean: float
    rate: float
    angle: float
    ready: bool
    slips: bool


class Failure(Enum):
    """Why a walk ended."""

    SLIP = "slip"
    """A foot slipped too far, or both feet slid apart on the ground."""
    STOP = "stop"
    """It did not get over its leg, or came to stand on both."""
    FALL = "fall"
    """The next leg was not there in time, or the machine left the ground."""
