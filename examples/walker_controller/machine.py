"""A simple biped in simulation: a hub on two legs without mass, the one that swings set ahead by a motor.

It is a rimless wheel with two spokes: the leg that stands is locked to the hub and turns with it over its foot; the
other one is shortened, swung ahead to a commanded angle, stretched, and may still be trimmed until it lands. A spring
in the leg that stands is wound up meanwhile and let go right before the next foot lands: a push-off there takes less
than one after the impact. Both legs are rigid while an impact lasts. Contacts are rigid and rub after Coulomb; impacts
follow the impulse path (`impact_predictor.solve_impact`); a foot that slips is followed until it sticks again.

The plane of the walk: x down the slope, z out of the ground; a leg leans forwards by a positive angle from the ground's
normal. Nothing here knows of the controller, and the controllers know nothing of this but `Seen`.

On even ground with its leg at one angle a step is that of a rimless wheel (`impact_predictor.scenarios.wheel`); here
gusts come, slabs differ and the leg moves until it lands, so that the step is followed tick by tick. A test compares
the two.
"""

from __future__ import annotations

from enum import Enum
from math import cos, inf, sin, tan
from typing import Final, NamedTuple

from values import Command, Machine, Seen

from impact_predictor import Contact, Mode, Twist, TwoPointBody, solve_impact

RATE: Final = 500
"""Ticks of simulation and controller in a second."""

PERIOD: Final = 1.0 / RATE

LARGEST_SLIP: Final = 0.05
"""m that a foot may slip before the walk has failed."""

FIRST_LEAN: Final = 0.15
"""rad that both legs lean at the beginning; more would slip at once where friction is low."""

LARGEST_LEAN: Final = 0.8
"""rad from which on nothing catches the machine any more."""

UNLOADS: Final = 0.95
"""Part of the approach of the foot ahead that the push-off may take away: the load on that foot lets it go on."""


class Gust(NamedTuple):
    """A push along the ground: `force` in N from `start` to `end` in s."""

    start: float
    end: float
    force: float


class Ground(NamedTuple):
    """A slope (rad, positive downhill ahead) of one friction, paved with slabs of different heights (m)."""

    slope: float
    friction: float
    heights: tuple[float, ...]
    slab: float = 0.25
    gravity: float = 9.81

    def height_at(self, x: float) -> float:
        """The height at a place; the first slab and the last have no end."""
        return self.heights[min(max(int(x / self.slab), 0), len(self.heights) - 1)]


class Failure(Enum):
    """Why a walk ended."""

    SLIP = "slip"
    """A foot slipped too far, or both feet slid apart on the ground."""
    STOP = "stop"
    """It did not get over its leg, or came to stand on both."""
    FALL = "fall"
    """The next leg was not there in time, or the machine left the ground."""


class Walk:
    """A machine that walks over a ground, tick by tick; it begins as if its left foot had just landed."""

    def __init__(self, machine: Machine, ground: Ground, gusts: tuple[Gust, ...] = (), rate: float = 1.3) -> None:
        self.machine, self.ground = machine, ground
        self.failure: Failure | None = None
        self.ticks = self.steps = 0
        self.lean, self.rate, self.pitch = -FIRST_LEAN, rate, 0.0
        self.foot_x, self.slip, self.slipped = 1.5 * ground.slab, 0.0, 0.0
        self.foot_z = ground.height_at(self.foot_x)
        self.angle, self.length = -2.0 * FIRST_LEAN, machine.leg
        self.modes: list[Mode] = []
        self.work = 0.0
        """J, of all push-offs."""
        self._gusts = gusts
        self._down = ground.gravity * sin(ground.slope)
        self._into = ground.gravity * cos(ground.slope)
        self._begin_swing()

    @property
    def x(self) -> float:
        """How far the hub has come, m."""
        return self.foot_x + self.machine.leg * sin(self.lean)

    @property
    def stamp(self) -> int:
        """Time in ns; it begins at a second, because 0 is no time in ROS."""
        return (self.ticks + RATE) * (1_000_000_000 // RATE)

    @property
    def seen(self) -> Seen:
        return Seen(self.stamp, self.steps, self.lean, self.rate, self.angle, self._stretching >= 1.0, self.slip != 0.0)

    def tick(self, command: Command) -> None:
        """Go on for one period under a command, unless the walk has failed."""
        if self.failure is not None:
            return
        machine = self.machine
        before = self.angle, self.length
        self._swing(command.angle)
        wanted, most = min(max(command.push, 0.0), machine.largest_push), machine.push_rate * PERIOD
        self.push += min(max(wanted - self.push, -most), most)
        state = self.lean, self.rate, self.foot_x, self.slip, self.slipped
        self._advance(PERIOD)
        if self.failure is None and self.angle > 0.0 and self._gap() <= 0.0:
            # The leg moves on evenly in the tick; the moment is found by halving.
            low, high = 0.0, PERIOD
            after = self.angle, self.length
            for _ in range(30):
                middle = 0.5 * (low + high)
                part = middle / PERIOD
                self.angle = before[0] + part * (after[0] - before[0])
                self.length = before[1] + part * (after[1] - before[1])
                self._restore(state)
                self._advance(middle)
                low, high = (low, middle) if self._gap() <= 0.0 else (middle, high)
            self._land()
            if self.failure is None:
                self._advance(PERIOD - high)
        self.ticks += 1

    def _restore(self, state: tuple[float, float, float, float, float]) -> None:
        self.pitch += state[0] - self.lean
        self.lean, self.rate, self.foot_x, self.slip, self.slipped = state

    def _begin_swing(self) -> None:
        self._shortening = self._stretching = self.push = 0.0
        self._swung = False

    def _swing(self, target: float) -> None:
        """Move the leg without load: shorten it, swing it to its target, stretch it, trim it."""
        machine = self.machine
        pace = PERIOD / machine.stretch_time
        target = min(max(target, machine.least_angle), machine.largest_angle)
        if self._shortening < 1.0:
            self._shortening = min(1.0, self._shortening + pace)
            self.length = machine.leg * (1.0 - machine.shortening * smooth(self._shortening))
            return
        most = machine.swing_rate * PERIOD
        self.angle += min(max(target - self.angle, -most), most)
        self._swung = self._swung or abs(target - self.angle) < 1e-9
        if self._swung and self._stretching < 1.0:
            self._stretching = min(1.0, self._stretching + pace)
            self.length = machine.leg * (1.0 - machine.shortening * smooth(1.0 - self._stretching))

    def _gap(self) -> float:
        """Height of the foot that swings over the ground below it, m."""
        lean = self.lean - self.angle
        hub = self.machine.leg * cos(self.lean)
        x = self.foot_x + self.machine.leg * sin(self.lean) - self.length * sin(lean)
        return self.foot_z + hub - self.length * cos(lean) - self.ground.height_at(x)

    def _land(self) -> None:
        """The impact of the foot that swings, right before which the spring of the one that stands is let go."""
        machine, ground = self.machine, self.ground
        leg, lean, ahead = machine.leg, self.lean, self.lean - self.angle
        if self._stretching < 1.0 or ahead >= 0.0:
            self.failure = Failure.FALL
            return
        x = self.foot_x + leg * (sin(lean) - sin(ahead))
        vx, vz = self.slip + leg * self.rate * cos(lean), -leg * self.rate * sin(lean)
        if tan(lean) <= ground.friction and self.slip == 0.0:
            # A leg without mass pushes along itself: outside the friction cone its foot would slip away.
            approach = self.rate * leg * (sin(lean) - sin(ahead))
            kick = min(self.push / machine.mass, UNLOADS * approach / cos(lean))
            vx, vz = vx + kick * sin(lean), vz + kick * cos(lean)
            self.work += 0.5 * machine.mass * kick * kick
        body = TwoPointBody(
            machine.mass,
            machine.inertia,
            Contact(-leg * sin(lean), -leg * cos(lean), ground.friction),
            Contact(-leg * sin(ahead), -leg * cos(ahead), ground.friction),
        )
        outcome = solve_impact(body, Twist(vx, vz, -self.rate))
        self.modes.append(outcome.mode)
        if outcome.mode not in (Mode.PIVOT, Mode.PIVOT_SLIDE):
            self.failure = AFTER.get(outcome.mode, Failure.FALL)
            return
        self.steps += 1
        self.rate = -outcome.twist.omega
        self.foot_x, self.foot_z = x, ground.height_at(x)
        self.slip = outcome.twist.vx - leg * self.rate * cos(ahead) if outcome.mode is Mode.PIVOT_SLIDE else 0.0
        self.slipped = 0.0
        self.lean, self.angle = ahead, -self.angle
        self._begin_swing()

    def _advance(self, duration: float) -> None:
        """The stance for a time, in which the foot sticks or slips (Runge-Kutta's midpoint rule where it slips)."""
        machine, ground = self.machine, self.ground
        now = self.ticks * PERIOD
        wind = sum(gust.force for gust in self._gusts if gust.start <= now < gust.end) / machine.mass
        down, into, leg = self._down + wind, self._into, machine.leg
        friction = ground.friction
        inertia = machine.inertia / machine.mass
        gain = leg / (inertia + leg * leg)
        if self.slip == 0.0:
            s, c = sin(self.lean), cos(self.lean)
            turning = gain * (down * c + into * s)
            grip = leg * (turning * c - self.rate * self.rate * s) - down
            load = into - leg * (turning * s + self.rate * self.rate * c)
            if load <= 0.0:
                self.failure = Failure.FALL
                return
            if abs(grip) <= friction * load:
                self._turn(duration, gain, down, into)
                self._judge()
                return
            # The ground's force is short of what holds the foot, which so slips against it.
            direction = -1.0 if grip > 0.0 else 1.0
        else:
            direction = 1.0 if self.slip > 0.0 else -1.0
        rub = friction * direction
        lean, rate, slip = self.lean, self.rate, self.slip
        start = self._slipping(lean, rate, rub, down, into)
        if start is None:
            self.failure = Failure.FALL
            return
        half = 0.5 * duration
        middle = self._slipping(lean + half * rate, rate + half * start[0], rub, down, into) or start
        self.lean = lean + duration * (rate + half * start[0])
        self.rate = rate + duration * middle[0]
        after = slip + duration * middle[1]
        if after * direction <= 0.0:
            after = 0.0
        way = 0.5 * (slip + after) * duration
        self.slip = after
        self.foot_x += way
        self.slipped += abs(way)
        self.pitch += self.lean - lean
        if self.slipped > LARGEST_SLIP:
            self.failure = Failure.SLIP
        else:
            self._judge()

    def _turn(self, duration: float, gain: float, down: float, into: float) -> None:
        """The leg turns over its foot, which sticks (Runge-Kutta of order 4)."""
        lean, rate = self.lean, self.rate
        half = 0.5 * duration
        a = gain * (down * cos(lean) + into * sin(lean))
        second, rate2 = lean + half * rate, rate + half * a
        b = gain * (down * cos(second) + into * sin(second))
        third, rate3 = lean + half * rate2, rate + half * b
        c = gain * (down * cos(third) + into * sin(third))
        fourth, rate4 = lean + duration * rate3, rate + duration * c
        d = gain * (down * cos(fourth) + into * sin(fourth))
        turned = duration / 6.0 * (rate + 2.0 * (rate2 + rate3) + rate4)
        self.lean = lean + turned
        self.rate = rate + duration / 6.0 * (a + 2.0 * (b + c) + d)
        self.pitch += turned

    def _slipping(self, lean: float, rate: float, rub: float, down: float, into: float) -> tuple[float, float] | None:
        """Angular acceleration and that of a foot which slips; None where it leaves the ground."""
        leg, inertia = self.machine.leg, self.machine.inertia / self.machine.mass
        s, c = sin(lean), cos(lean)
        lever = leg * (s + rub * c) / inertia
        share = 1.0 + leg * s * lever
        load = (into - leg * rate * rate * c) / share if share > 0.0 else inf
        if not 0.0 < load < inf:
            return None
        turning = load * lever
        return turning, down - rub * load - leg * (turning * c - rate * rate * s)

    def _judge(self) -> None:
        if self.rate <= 0.0:
            self.failure = Failure.STOP
        elif self.lean > LARGEST_LEAN:
            self.failure = Failure.FALL


AFTER: Final = {Mode.STOP: Failure.STOP, Mode.BACK_PIVOT: Failure.STOP, Mode.SLIDE: Failure.SLIP}
"""How a walk fails by an impact after which it does not turn about the new foot."""


def smooth(part: float) -> float:
    """A way from 0 to 1 that begins and ends at rest."""
    return part * part * (3.0 - 2.0 * part)
