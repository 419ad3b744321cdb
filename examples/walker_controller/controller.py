"""How the biped is driven: where its next foot comes down, and how hard the rear one pushes off; no ROS in here.

Two controllers with the same actuators and measurements. `Feedback` answers what it measures with tuned gains.
`Predictive` besides listens to the predictor, and changes the step that is about to end by what its impact will do.
Angles of a step are half of that between the legs: both lean by it when the foot lands.
"""

from __future__ import annotations

from math import atan, cos, sin, sqrt
from typing import Final, NamedTuple, Protocol

from values import Announcement, Command, Estimate, Machine, Seen

from impact_predictor import Mode

STILL: Final = 14
"""Ticks that the leg is held before a prediction of its landing is believed, 28 ms.

So long the predictor's fit may still follow the leg's last move. Its dead time, for which an announcement is kept, and
the tick that it takes to arrive are in it.
"""

LEAST_TRIM: Final = 0.005
"""rad by which a step is changed at least; for less the leg is held, and the announcements go on."""

USUAL_RATE: Final = 0.9
"""rad/s over the upright leg, against which feedback is told the rate."""

LARGEST_PAST: Final = 3.0
"""rad/s that the sum of the rates of the steps before may come to."""

LEAST_RATE: Final = 0.3
"""rad/s over the next leg, below which the machine is taken to stop."""

SLIPS: Final = (Mode.SLIDE, Mode.PIVOT_SLIDE)


class Controller(Protocol):
    """Anything that drives the machine."""

    def command(self, seen: Seen, ahead: Announcement | None) -> Command:
        """The command of a tick, from what is measured, and from the touchdown that is announced, if there is one."""
        ...


class Reach:
    """The longest step to make: shorter by `retract` (rad) than any that slips."""

    def __init__(self, longest: float, retract: float) -> None:
        self.longest = longest
        self._retract = retract
        self._steps, self._angle, self._slipped = 0, 0.0, False

    def watch(self, seen: Seen) -> None:
        """Learn from the foot that stands, which is felt to slip once it has landed."""
        if seen.steps != self._steps:
            self._steps, self._slipped = seen.steps, False
            self._angle = -seen.lean
        if seen.slips and seen.steps and not self._slipped:
            self._slipped = True
            self.shorten(self._angle)

    def shorten(self, angle: float) -> None:
        """A step of this angle slips."""
        self.longest = min(self.longest, angle - self._retract)


class FeedbackGains(NamedTuple):
    """Gains of `Feedback`; rates are against 0.9 rad/s.

    The first seven need nothing but what is measured; the last three use what the robot is told of the ground.
    """

    angle: float = 0.2
    angle_by_rate: float = 0.12
    angle_by_past: float = 0.0
    retract: float = 0.02
    """By how much steps are shorter, once a foot has slipped, than the one that slipped."""
    push: float = 14.0
    push_by_rate: float = 20.0
    push_by_past: float = 1.0
    angle_by_slope: float = 0.0
    push_by_slope: float = 0.0
    grip: float = 1e6
    """Part of the estimated friction that the legs may lean by."""


class Feedback:
    """Steps and pushes off by the rate that is measured, and by the sum of those of the steps before.

    The rate is taken as what it would be over the upright leg on level ground, by the energy that is kept: it tells as
    much early in a step as late.
    """

    def __init__(self, machine: Machine, estimate: Estimate, gains: FeedbackGains) -> None:
        self._gains, self._machine, self._gravity = gains, machine, estimate.gravity
        self._angle = gains.angle + gains.angle_by_slope * estimate.slope
        self._push = gains.push - gains.push_by_slope * estimate.slope
        self._reach = Reach(min(0.5 * machine.largest_angle, atan(gains.grip * estimate.friction)), gains.retract)
        self._steps, self._past, self._last = 0, 0.0, 0.0

    def command(self, seen: Seen, ahead: Announcement | None = None) -> Command:
        gains = self._gains
        self._reach.watch(seen)
        if seen.steps != self._steps:
            self._steps = seen.steps
            self._past = min(max(self._past + self._last, -LARGEST_PAST), LARGEST_PAST)
        fast = self._last = self._upright(seen) - USUAL_RATE
        angle = self._angle + gains.angle_by_rate * fast + gains.angle_by_past * self._past
        push = self._push - gains.push_by_rate * fast - gains.push_by_past * self._past
        return Command(2.0 * min(angle, self._reach.longest), push)

    def _upright(self, seen: Seen) -> float:
        machine = self._machine
        climb = machine.mass * self._gravity * machine.leg * (1.0 - cos(seen.lean))
        return sqrt(max(0.0, seen.rate**2 - 2.0 * climb / machine.foot_inertia))


class PredictiveGains(NamedTuple):
    """Gains of `Predictive`."""

    angle: float = 0.3
    """With which the first step begins, and the smallest as long as the push-off is strong enough, rad."""
    trust: float = 0.9
    """Part of the estimated friction that the scene of the predictor is given."""
    rate: float = 0.9
    """The rate that the machine is to have over its next leg on level ground, rad/s ..."""
    rate_by_slope: float = 10.0
    """... and by how much more for each rad uphill, where speed is what carries it."""
    retract: float = 0.02
    """By how much a step is shortened at a time while a slip is announced, rad."""
    extend: float = 0.2
    """By how much it is lengthened for each rad/s by which the machine would be too fast."""


class Predictive:
    """Changes the step that is about to end by what the predictor announces of its impact.

    It retracts the foot while a slip is announced; it puts it further ahead where the machine would go on too fast,
    nearer where too slowly; and it winds up what is missing to carry the machine over its next leg.
    """

    def __init__(self, machine: Machine, estimate: Estimate, gains: PredictiveGains) -> None:
        self._machine, self._estimate, self._gains = machine, estimate, gains
        self._angle, self._push = gains.angle, 0.0
        self._rate = gains.rate + gains.rate_by_slope * max(0.0, -estimate.slope)
        # To begin with, the longest step that a point mass could make; with inertia, and after a slip, it is another.
        self._reach = Reach(min(0.5 * machine.largest_angle, atan(estimate.friction)), gains.retract)
        self._still, self._last = 0, 0.0

    def command(self, seen: Seen, ahead: Announcement | None) -> Command:
        self._still = self._still + 1 if seen.ready and abs(seen.angle - self._last) < 1e-6 else 0
        self._last = seen.angle
        if ahead is not None and self._still > STILL:
            self._answer(ahead)
        return Command(2.0 * min(self._angle, self._reach.longest), self._push)

    def _answer(self, ahead: Announcement) -> None:
        gains, machine, angle = self._gains, self._machine, 0.5 * self._last
        # A push along the leg behind has this lever about the foot ahead.
        lever = machine.leg * sin(2.0 * angle) / machine.foot_inertia
        excess = ahead.rate - self._rate_to_arrive(angle, self._rate)
        self._push = -excess / lever
        if ahead.mode in SLIPS:
            self._reach.shorten(angle)
        else:
            stops = ahead.rate + machine.largest_push * lever < self._rate_to_arrive(angle, LEAST_RATE)
            # A short step costs least, but it brakes least too.
            shortest = 0.0 if stops else min(gains.angle, angle)
            wanted = min(max(angle + gains.extend * excess, shortest), self._reach.longest)
            self._angle = wanted if abs(wanted - angle) > LEAST_TRIM else angle
        self._angle = max(self._angle, 0.5 * machine.least_angle)

    def _rate_to_arrive(self, angle: float, rate: float) -> float:
        """The rate after the impact with which the machine comes over its leg at `rate`: energy is kept on the way."""
        machine, ground = self._machine, self._estimate
        # It is highest where the leg is upright, which is `slope` before the ground's normal.
        climb = machine.mass * ground.gravity * machine.leg * (1.0 - cos(angle - ground.slope))
        return sqrt(rate * rate + 2.0 * climb / machine.foot_inertia)
