"""What machine and controllers share: the machine's numbers, what it is told and what it measures."""

from __future__ import annotations

from typing import NamedTuple


class Machine(NamedTuple):
    """What the machine is; SI units."""

    mass: float = 20.0
    inertia: float = 1.2
    """About the hub, where the mass centre is."""
    leg: float = 1.0
    swing_rate: float = 10.0
    """The fastest that the leg turns against the hub while it swings, rad/s."""
    shortening: float = 0.1
    """Part of its length by which the leg is shortened while it swings."""
    stretch_time: float = 0.05
    """Time in s to shorten it, and to stretch it again."""
    largest_push: float = 20.0
    """N s, of the spring in a leg that is wound up while the leg stands, and let go as the next one lands."""
    push_rate: float = 150.0
    """N s for each second: how fast the spring is wound up or down."""
    least_angle: float = 0.2
    largest_angle: float = 1.0
    """Between the legs, rad."""

    @property
    def foot_inertia(self) -> float:
        """Moment of inertia about the foot that stands."""
        return self.inertia + self.mass * self.leg**2


class Estimate(NamedTuple):
    """What the robot takes the ground for: `slope` in rad, positive downhill ahead, and its friction coefficient."""

    slope: float
    friction: float
    gravity: float = 9.81


class Command(NamedTuple):
    """What the machine is told at each tick: the angle between the legs to set (rad), and the push to wind up (N s)."""

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


class Announcement(NamedTuple):
    """The touchdown that the predictor announces: its stamp (ns), its mode, and the rate (rad/s) right after it."""

    stamp: int
    mode: int
    rate: float
