"""How the biped is driven: where its next foot comes down, and how hard the rear one pushes off; no ROS in here.

Two controllers with the same actuators and measurements. `Feedback` answers what it measures with tuned gains.
`Predictive` besides listens to the predictor, and changes the step that is about to end by what its impact will do.
Both know the machine with its load, and are told the same estimates of the ground: its slope and its friction.
"""

from __future__ import annotations

from math import atan, cos, sin, sqrt
from typing import Final, NamedTuple, Protocol

from values import Command, Machine, Seen

from impact_predictor import Mode

STILL: Final = 14
"""Ticks that the leg is held before a prediction of its landing is believed.

No less than the predictor's window, its dead time, for which an announcement is kept, and the tick that it takes to
arrive: 28 ms.
"""

USUAL_RATE: Final = 1.2
"""rad/s."""

SLIPS: Final = (Mode.SLIDE, Mode.PIVOT_SLIDE)


class Estimate(NamedTuple):
    """What the robot takes the ground for: `slope` in rad, positive downhill ahead, and its friction coefficient."""

    slope: float
    friction: float
    gravity: float = 9.81


class Announcement(NamedTuple):
    """The touchdown that the predictor announces: its stamp (ns), its mode, and the rate (rad/s) right after it."""

    stamp: int
    mode: int
    rate: float


class Controller(Protocol):
    """Anything that drives the machine."""

    def command(self, seen: Seen, ahead: Announcement | None) -> Command:
        """The command of a tick, from what is measured, and from the touchdown that is announced, if there is one."""
        ...


class FeedbackGains(NamedTuple):
    """Gains of `Feedback`; angles are half the angle between the legs, rates are against 1.2 rad/s.

    The first seven need nothing but what is measured. The others use what the robot is told: the slope, the friction,
    and its inertia about the hub as a part of mass times leg squared.
    """

    angle: float = 0.24
    angle_by_rate: float = 0.06
    angle_by_past: float = 0.014
    retract: float = 0.01
    """By how much all further steps are shorter once the foot has slipped, rad."""
    push: float = 10.5
    push_by_rate: float = 28.0
    push_by_past: float = 3.0
    angle_by_slope: float = 0.0
    push_by_slope: float = 0.0
    grip: float = 1e6
    """Part of the estimated friction that the legs may lean by."""
    grip_by_inertia: float = 0.0


class Feedback:
    """Steps and pushes off by the rate that is measured, and by the sum of those of the steps before."""

    def __init__(self, machine: Machine, estimate: Estimate, gains: FeedbackGains) -> None:
        self._gains = gains
        inertia = machine.inertia / (machine.mass * machine.leg**2)
        self._angle = gains.angle + gains.angle_by_slope * estimate.slope
        self._longest = atan((gains.grip + gains.grip_by_inertia * inertia) * estimate.friction)
        self._push = gains.push - gains.push_by_slope * estimate.slope
        self._steps, self._slipped, self._past, self._last = 0, False, 0.0, USUAL_RATE

    def command(self, seen: Seen, ahead: Announcement | None = None) -> Command:
        gains, fast = self._gains, seen.rate - USUAL_RATE
        if seen.steps != self._steps:
            self._past += self._last - USUAL_RATE
            self._steps, self._slipped = seen.steps, False
        if seen.slips and not self._slipped:
            self._longest -= gains.retract
            self._slipped = True
        self._last = seen.rate
        angle = self._angle + gains.angle_by_rate * fast + gains.angle_by_past * self._past
        push = self._push - gains.push_by_rate * fast - gains.push_by_past * self._past
        return Command(2.0 * min(angle, self._longest), push)


class PredictiveGains(NamedTuple):
    """Gains of `Predictive`; angles are half the angle between the legs."""

    angle: float = 0.3
    """With which the first step begins, and the smallest as long as the push-off is strong enough."""
    trust: float = 0.85
    """Part of the estimated friction that the scene of the predictor is given."""
    rate: float = 1.0
    """The rate that the machine is to have over its next leg, rad/s."""
    retract: float = 0.015
    """By how much a step is shortened at a time while a slip is announced, rad."""
    extend: float = 0.2
    """By how much it is lengthened for each rad/s by which the machine would be too fast."""
    lead_time: float = 0.1
    """From how long before the touchdown on, in s, the announced rate changes the step."""


class Predictive:
    """Changes the step that is about to end by what the predictor announces of its impact.

    It retracts the foot while a slip is announced; it puts it further ahead where the machine would go on too fast,
    nearer where too slowly; and it pushes off by what is missing to carry the machine over its next leg.
    """

    def __init__(self, machine: Machine, estimate: Estimate, gains: PredictiveGains) -> None:
        self._machine, self._estimate, self._gains = machine, estimate, gains
        self._angle, self._longest = gains.angle, 0.5 * machine.largest_angle
        self._push = 0.0
        self._still, self._last = 0, 0.0

    def command(self, seen: Seen, ahead: Announcement | None) -> Command:
        self._still = self._still + 1 if seen.ready and abs(seen.angle - self._last) < 1e-6 else 0
        self._last = seen.angle
        if ahead is not None and self._still > STILL:
            self._answer(ahead, 1e-9 * (ahead.stamp - seen.stamp))
        return Command(2.0 * self._angle, self._push)

    def _answer(self, ahead: Announcement, lead_time: float) -> None:
        gains, machine, angle = self._gains, self._machine, self._angle
        inertia = machine.inertia + machine.mass * machine.leg**2
        excess = ahead.rate - self._rate_to_arrive(gains.rate)
        # A push along the leg behind has this lever about the foot ahead.
        self._push = -excess * inertia / (machine.leg * sin(2.0 * angle))
        if ahead.mode in SLIPS:
            angle -= gains.retract
            self._longest = angle
        elif lead_time < gains.lead_time:
            # A short step costs least, but it brakes least too.
            shortest = min(gains.angle, angle) if self._push < machine.largest_push else 0.0
            angle = min(max(angle + gains.extend * excess, shortest), self._longest)
        self._angle = max(angle, 0.5 * machine.least_angle)

    def _rate_to_arrive(self, rate: float) -> float:
        """The rate after the impact with which the machine comes over its leg at `rate`: energy is kept on the way."""
        machine, ground = self._machine, self._estimate
        inertia = machine.inertia + machine.mass * machine.leg**2
        # It is highest where the leg is upright, which is `slope` before the ground's normal.
        climb = ground.gravity * machine.leg * (1.0 - cos(self._angle - ground.slope))
        return sqrt(rate * rate + 2.0 * machine.mass * climb / inertia)
