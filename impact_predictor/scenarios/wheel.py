"""A rimless wheel on a slope: spokes without a rim, which it rolls over one after the other until it stops.

Two neighbouring spokes at a time are a body on two points (`rock`): from the impact on the second one to the touchdown
of a third. There the wheel looks as it did one spoke before (McGeer, "Passive dynamic walking", Int. J. Robotics
Research 9(2), 1990).
"""

from __future__ import annotations

from enum import IntEnum
from math import cos, degrees, inf, pi, sin
from typing import Any, Final, NamedTuple

import numpy as np

from ..errors import InputError
from ..mechanics.bodies import not_negative, positive, refuse
from ..mechanics.motion import End, PlanarState, RockingImpact, Trajectory, rock, standing
from ..mechanics.motion.support import FixedSupport, in_world
from ..mechanics.types import Contact, TwoPointBody, Vector

_MOST_EVENTS: Final = 10_000
_MOST_SPOKES: Final = 1000
_WHOLE: Final = 1e-9
"""How far a number of spokes may be from a whole one, relative to it: angles come in degrees, too."""


_BEYOND: Final = 1.0 + 1e-12
"""How far beyond being over a spoke it is over it, so that it is not over it at once."""


class Hub(NamedTuple):
    """A body on legs without mass, all of one length; SI units.

    `inertia` about the mass centre, where the legs meet; `slope` of the support in rad, positive downhill ahead.
    """

    mass: float = 1.0
    inertia: float = 0.01
    leg: float = 1.0
    friction: float = 1.0
    slope: float = 0.0
    gravity: float = 9.81

    @property
    def support(self) -> FixedSupport:
        """The slope, its x axis downhill."""
        return FixedSupport(-self.slope, self.gravity)

    def body(self, ahead: float) -> TwoPointBody:
        """The body on two feet, its legs `ahead` rad behind and ahead of the support's normal."""
        x, y = self.leg * sin(ahead), -self.leg * cos(ahead)
        return TwoPointBody(self.mass, self.inertia, Contact(-x, y, self.friction), Contact(x, y, self.friction))


class Wheel(NamedTuple):
    """A hub with equal spokes all around, `alpha` (rad) half the angle between two of them."""

    hub: Hub = Hub()
    alpha: float = pi / 8.0

    @property
    def spokes(self) -> int:
        return round(pi / self.alpha)

    @property
    def tips(self) -> tuple[Vector, ...]:
        """The spokes' ends from the mass centre (m), each ahead of the one before it; 0 and 1 are below at angle 0."""
        angles = [(2 * k - 1) * self.alpha for k in range(self.spokes)]
        return tuple((self.hub.leg * sin(angle), -self.hub.leg * cos(angle)) for angle in angles)

    @property
    def step(self) -> float:
        """Distance of two neighbouring tips in m."""
        return 2.0 * self.hub.leg * sin(self.alpha)


class RollEnd(IntEnum):
    """Why a wheel is followed no further."""

    STEPS_DONE = 0
    """It has made its steps, and stands over the last spoke."""
    RESTS = 1
    """At rest on two spokes, for ever."""
    BALANCED = 2
    """At rest on one spoke, for ever."""
    TIME_UP = 3
    """The duration is over."""
    TAKES_OFF = 4
    """No spoke is on the ground any more: it turns too fast to roll."""
    LOST = 5
    """Too many events, or an impact without an answer."""


class RollingPart(NamedTuple):
    """A part of a rolling motion, from `start` (s) on, over tips `first` and `first` + 1, which count on every turn."""

    first: int
    start: float
    run: Trajectory


class WheelStrike(NamedTuple):
    """An impact of tip `new` of a wheel that stood on tip `old`, or on none; `strike` is that of the `RollingPart`."""

    old: int | None
    new: int
    strike: RockingImpact


class Rolling:
    """How a wheel rolled, from 0 to `time` (s)."""

    def __init__(self, wheel: Wheel, parts: list[RollingPart], end: RollEnd, time: float) -> None:
        self.wheel, self.end, self.time = wheel, end, time
        self.parts = tuple(parts)
        self._starts = [part.start for part in parts]

    @property
    def impacts(self) -> tuple[WheelStrike, ...]:
        count = self.wheel.spokes
        return tuple(
            WheelStrike(
                None if strike.old is None else (part.first + strike.old) % count,
                (part.first + strike.new) % count,
                strike,
            )
            for part in self.parts
            for strike in part.run.impacts
            if strike.time <= self.time
        )

    @property
    def steps(self) -> int:
        """How many spokes farther ahead it stands than where it began; negative where it has rolled backwards."""
        last = self.parts[-1]
        return last.first + (1 if last.run.states(self.time)[0] == "O" else 0)

    @property
    def distance(self) -> float:
        """How far ahead along the slope its hub has come, in m."""
        return float(self.parts[-1].run.state(self.time).x - self.parts[0].run.state(0.0).x)

    def world(self, time: Any) -> PlanarState:
        """State of the hub at a time or an array of times (s): x level and forwards, y up, counter-clockwise positive.

        At an impact it is the state after it; before the start and after the end it is the state there.
        """
        if isinstance(time, (float, int)):
            return PlanarState(*np.array(self.world(np.array([time])))[:, 0].tolist())
        times = np.clip(time, 0.0, self.time)
        place = np.searchsorted(self._starts, times, side="right") - 1
        values = np.empty((6, len(times)))
        for k in np.unique(place):
            part, chosen = self.parts[k], place == k
            values[:, chosen] = np.array(part.run.state(times[chosen]))
            values[2, chosen] -= 2.0 * self.wheel.alpha * part.first
        return in_world(self.wheel.hub.support.motion(times), PlanarState(*values))


def roll(wheel: Wheel, rate: float = 0.0, steps: int | None = 20, duration: float = 60.0, law: str = "path") -> Rolling:
    """Let a wheel go with spoke 0 at right angles to the slope, turning ahead at `rate` (rad/s).

    It is followed for `duration` s, until it rests, or until it is over the spoke that `steps` of them lead to, ahead
    or backwards. `law` is that of `solve_impact`; the spokes slip where friction does not hold them, and do not bounce.
    InputError where a number is out of its range.
    """
    check_wheel(wheel)
    refuse({"rate": rate}, lambda value: abs(value) < 1e9, "a finite number")
    refuse({"duration": duration}, lambda value: 0.0 < value < 1e5, "a number of seconds between 0 and 1e5")
    refuse({"steps": 1 if steps is None else steps}, lambda value: value >= 1, "a number from 1 on")
    body, support, alpha = wheel.hub.body(wheel.alpha), wheel.hub.support, wheel.alpha
    # Every part but this one begins with the impact on the second of its spokes.
    first, time, state, parts = -1, 0.0, standing(body, -alpha, -rate, x=-wheel.step), []
    while True:
        # Contact 1 of a part is ahead, contact 0 behind: the last spoke of the steps is one of them, or neither.
        last = True if first + 1 == steps else False if -first == steps else None
        for limit in (2.0 * alpha,) if last is None else (_BEYOND * alpha, 2.0 * alpha):
            left = max(0.0, duration - time)
            run = rock(body, state, support, law, left, time, overturned=limit, max_events=_MOST_EVENTS)
            onwards = run.states(run.time)[0] == "O"
            if onwards is last or run.end is not End.OVERTURNED:
                break
        parts.append(RollingPart(first, time, run))
        flight = next((phase.start for phase in run.phases if phase.states == "OO" and phase.end > phase.start), inf)
        if flight < inf:
            return Rolling(wheel, parts, RollEnd.TAKES_OFF, flight)
        if run.end is not End.OVERTURNED:
            return Rolling(wheel, parts, _ENDS.get(run.end, RollEnd.LOST), run.time)
        if onwards is last:
            return Rolling(wheel, parts, RollEnd.STEPS_DONE, run.time)
        # The next spoke touches: as if the wheel had gone on by a step, and not turned.
        end, on = run.state(run.time), 1 if onwards else -1
        state, time, first = end._replace(angle=end.angle + on * 2.0 * alpha), run.time, first + on


def check_wheel(wheel: Wheel) -> None:
    """Refuse, by an InputError, a wheel of which a number is out of its range, or no whole number of spokes fits."""
    hub = wheel.hub
    positive(mass=hub.mass, inertia=hub.inertia, leg=hub.leg, gravity=hub.gravity)
    not_negative(friction=hub.friction)
    if not abs(hub.slope) < 0.5 * pi:
        raise InputError(f"slope is {degrees(hub.slope):g} degrees; give an angle between -90 and 90 degrees")
    spokes = pi / wheel.alpha if wheel.alpha > 0.0 else 0.0
    if not (3.0 - _WHOLE < spokes <= _MOST_SPOKES + 0.5 and abs(spokes - round(spokes)) < _WHOLE * spokes):
        raise InputError(
            f"alpha is {degrees(wheel.alpha):g} degrees, half the angle between two spokes; give 180 degrees divided "
            f"by a whole number of spokes, from 3 to {_MOST_SPOKES}"
        )


_ENDS: Final = {End.RESTS: RollEnd.RESTS, End.BALANCED: RollEnd.BALANCED, End.TIME_UP: RollEnd.TIME_UP}
