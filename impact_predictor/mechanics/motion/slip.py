"""A body that turns over a stance contact which slips on a fixed support, up to the first event, in steps."""

from __future__ import annotations

import math
from typing import Final

from ..impact.contacts import MINUS, OPEN, PLUS
from ..types import Contact, TwoPointBody, Vector
from .equations import RockingBody, turned
from .events import End, Event
from .phases import MotionPhase, RockingProblem
from .pivot import Pivot
from .support import FixedSupport

_MAX_STEPS: Final = 1000
_STEP: Final = 0.01
"""Error allowed to a step, relative to the one aimed at: errors grow on the way."""
_FAR: Final = 1e6
_LONGEST: Final = 1e300
"""rad, s: how far and how long a body is followed that nothing else stops."""


class SlipPhase(MotionPhase):
    """A contact slips, with friction `drag` of its sign, until the body has turned as far as it can back or forth."""

    def __init__(self, problem: RockingProblem, drag: float, omega: float, slip: float, travel: Vector) -> None:
        slips = PLUS if math.copysign(1.0, drag) > 0.0 else MINUS
        # The nearer end is home: seen from there a tiny hop keeps its digits, whichever way it comes down.
        states = (slips, OPEN) if travel[0] <= travel[1] else (OPEN, slips)
        super().__init__(problem, states, 0.0, (0.0, omega, 0.0, slip))
        self.home = min(travel)
        # Near a balance small accelerations count: no part of them is taken for rounding.
        self.scale = self.scale[0], 0.0
        if not drag:
            self.slip = 0.0  # nothing changes where it stops


def slide(
    arm: Vector,
    omega: float,
    slip: float,
    drag: float,
    travel: Vector,
    rho_squared: float,
    gravity: Vector,
    horizon: float,
    tolerance: float,
) -> Pivot:
    """Follow a slipping stance until its first event: TOUCHES, STOPS, LIFTS, JAMS or NEVER.

    `arm` from the contact to the mass centre in m; `omega` in rad/s; `slip` velocity of the contact in m/s; `drag` the
    friction coefficient with the sign of the slip, which is its direction where `slip` is still 0; `travel` how far in
    rad the body can turn clockwise and counter-clockwise until another point touches (0: it rests on that point
    already); `rho_squared` in m^2; `gravity` in m/s^2; `horizon` in s; `tolerance` the error aimed at, relative to the
    time and the rate. A body that is pressed onto a point on which it rests ends with NEVER, and so does one that
    nothing happens to within the horizon.
    """
    still = Pivot(event=Event.LIFTS, time=0.0, turned=0.0, omega=omega, slip=slip, direction=1 if omega > 0.0 else -1)
    if omega * omega * arm[1] + gravity[1] >= 0.0:
        return still
    try:
        contact = Contact(-arm[0], -arm[1], abs(drag))
        body = RockingBody(TwoPointBody(1.0, rho_squared, contact, contact), (arm, arm), ((0.0, 0.0), (0.0, 0.0)))
        support = FixedSupport(math.atan2(-gravity[0], -gravity[1]), math.hypot(*gravity))
        ends = min(travel[0], _FAR), min(travel[1], _FAR)
        phase = SlipPhase(RockingProblem(body, support, max(ends), _STEP * tolerance), drag, omega, slip, ends)
        heading = omega or phase.instants[0].alpha
        if travel[heading > 0.0] <= 0.0 and not math.isnan(phase.instants[0].alpha) and heading:
            return still._replace(event=Event.TOUCHES if omega else Event.NEVER)
        event, _, end = phase.follow(min(horizon, _LONGEST), _MAX_STEPS)
        time, angle, rate = end.time, end.u, end.w
    except (ArithmeticError, ValueError):  # numbers overflow
        return still._replace(event=Event.JAMS)
    away = 1 if phase.side > 0.0 else -1  # from home
    direction = -away if event is Event.TOUCHES else away
    if event is Event.TOUCHES or event is End.OVERTURNED:
        event, angle = Event.TOUCHES, direction * travel[direction > 0]
    # The normal force drops out of the balance of x + drag y, whose rate grows by gx + drag gy per second.
    (x0, y0), (x, y), drive = arm, turned(arm, angle), gravity[0] + drag * gravity[1]
    start = slip + omega * (drag * x0 - y0)
    return Pivot(
        event=Event.NEVER if isinstance(event, End) else event,
        time=time,
        turned=angle,
        omega=rate,
        slip=start + drive * time - rate * (drag * x - y),
        moved=(start + 0.5 * drive * time) * time - drag * (y - y0) - (x - x0),
        direction=direction,
    )
