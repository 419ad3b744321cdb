"""One stride of a hub on legs without mass: how it turns over the standing leg, and the impact of the next one.

The standing leg is fixed to the hub. The next one is put at an angle of its own while it swings: without mass this
takes nothing, and both legs are rigid while the impact lasts. With one angle for all legs this is the rimless wheel
(McGeer, "Passive dynamic walking", Int. J. Robotics Research 9(2), 1990).
"""

from __future__ import annotations

from enum import IntEnum
from math import cos, degrees, hypot, inf, nextafter, pi, sin
from typing import Any, Final, NamedTuple

from ...errors import InputError
from ...mechanics.bodies import not_negative, positive, refuse
from ...mechanics.motion import PlanarState
from ...mechanics.rocking import End, Run, rock, standing
from ...mechanics.rocking.bodies import shape_of
from ...mechanics.support import FixedSupport
from ...mechanics.types import Contact, Outcome, TwoPointBody

_BEYOND: Final = 1.0 + 1e-12
"""How far beyond the pose in which a stride may begin the leg behind touches, so that it does not touch at once."""

_SLIP_ROUNDING: Final = 1e-12
"""A slip this small, relative to the speeds it is the difference of, is none."""

_MOST_EVENTS: Final = 10_000


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

    def body(self, ahead: float, grip: float | None = None) -> TwoPointBody:
        """The body on two feet, its legs `ahead` rad behind and ahead of the support's normal.

        `grip` is the friction coefficient under the foot ahead, the hub's unless given.
        """
        x, y = self.leg * sin(ahead), -self.leg * cos(ahead)
        old, new = Contact(-x, y, self.friction), Contact(x, y, self.friction if grip is None else grip)
        return TwoPointBody(self.mass, self.inertia, old, new)


class Stance(NamedTuple):
    """A hub on one leg, which leans forwards by `angle` (rad) from the support's normal and turns at `rate` (rad/s).

    Its foot stands at `foot` (m) down the slope and slips down it at `slip` (m/s).
    """

    angle: float
    rate: float
    slip: float = 0.0
    foot: float = 0.0


class StrideEnd(IntEnum):
    """What becomes of a stride."""

    LANDS = 0
    """The next foot strikes; what its impact leaves is told by the outcome."""
    FALLS_BACK = 1
    """The standing leg turns back, until the leg behind touches."""
    BALANCES = 2
    """It stands still on one leg, for ever."""
    TAKES_OFF = 3
    """The standing foot leaves the ground before the next one strikes."""
    TIME_UP = 4
    """Nothing of this within the duration."""
    LOST = 5
    """The impact law has no answer, or the numbers are out of their range."""


class Stride(NamedTuple):
    """A stride and its end, `time` s after its beginning.

    Where the next foot lands: the stance on the old leg right `before` and on the new one right `after`, and the
    `outcome` of the impact between them; else None. Both feet stand on the support after the modes STOP and SLIDE.
    """

    end: StrideEnd
    time: float
    before: Stance | None
    after: Stance | None
    outcome: Outcome | None
    run: Run

    def world(self, time: Any) -> PlanarState:
        """State of the mass centre at a time, or an array of times (s), up to the end, before the impact.

        x is level and forwards, y up, from where `Stance.foot` counts; the angle counts counter-clockwise from the pose
        in which the next foot touches on level ground.
        """
        import numpy as np  # a controller that only asks for the end does without

        last = nextafter(self.time, 0.0)
        return self.run.world(min(time, last) if isinstance(time, (float, int)) else np.minimum(time, last))


def stride(
    hub: Hub,
    start: Stance,
    ahead: float,
    behind: float = 0.5 * pi,
    grip: float | None = None,
    duration: float = 10.0,
    law: str = "path",
) -> Stride:
    """Follow a hub from a stance, right after an impact or on the way, to the impact of the next leg.

    The next foot touches when both legs lean `ahead` rad from the support's normal, the standing one forwards;
    `behind` is the same for the foot behind, on which it falls back (level with the ground unless given). `grip` is the
    friction coefficient where the next foot comes down, the hub's unless given. The standing foot slips where friction
    does not hold it. `duration` in s; `law` is that of `solve_impact`.

    Raises:
        InputError: a number is out of its range, or the next foot begins below the support.
    """
    check(hub)
    not_negative(grip=hub.friction if grip is None else grip)
    refuse({"ahead": ahead, "behind": behind}, lambda value: 0.0 < value <= 0.5 * pi, "an angle between 0 and pi / 2")
    refuse({"duration": duration}, lambda value: 0.0 <= value < inf, "a finite number of seconds")
    if not -behind <= start.angle <= ahead:
        raise InputError(
            f"the standing leg leans by {start.angle} rad, a foot would be below the support; let it lean between "
            f"-behind ({-behind}) and ahead ({ahead})"
        )
    body = hub.body(ahead, grip)
    state = standing(body, ahead - start.angle, -start.rate, start.slip, start.foot)
    run = rock(body, state, hub.support, law, duration, overturned=_BEYOND * (ahead + behind), max_events=_MOST_EVENTS)
    strike = run.impacts[0] if run.impacts else None
    flight = next((phase.start for phase in run.phases if phase.states == "OO" and phase.end > phase.start), inf)
    if flight < (inf if strike is None else strike.time):
        return Stride(StrideEnd.TAKES_OFF, flight, None, None, None, run)
    if strike is None:
        return Stride(_ENDS.get(run.end, StrideEnd.LOST), run.time, None, None, None, run)
    before = stance_of(body, 0, ahead, strike.before)
    after = stance_of(body, 1, -ahead, strike.after)
    return Stride(StrideEnd.LANDS, strike.time, before, after, strike.outcome, run)


def check(hub: Hub) -> None:
    """Refuse a hub that cannot be.

    Raises:
        InputError: a number is out of its range.
    """
    positive(mass=hub.mass, inertia=hub.inertia, leg=hub.leg, gravity=hub.gravity)
    not_negative(friction=hub.friction)
    if not abs(hub.slope) < 0.5 * pi:
        raise InputError(f"slope is {degrees(hub.slope):g} degrees; give an angle between -90 and 90 degrees")


def stance_of(body: TwoPointBody, contact: int, angle: float, state: PlanarState) -> Stance:
    """The stance on one of two feet that are both on the support, its leg at `angle`."""
    shape = shape_of(body)
    _, omega, z, slip = shape.seen_from(contact, state)
    rounding = _SLIP_ROUNDING * (hypot(state.vx, state.vy) + abs(omega) * shape.length)
    return Stance(angle, -omega, slip if abs(slip) > rounding else 0.0, shape.foot(contact, z)[0])


_ENDS: Final = {
    End.OVERTURNED: StrideEnd.FALLS_BACK,
    End.BALANCED: StrideEnd.BALANCES,
    End.TIME_UP: StrideEnd.TIME_UP,
}
