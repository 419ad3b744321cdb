"""The next strike of a body on two contacts over a support: its motion up to the first impact, and nothing after it."""

from __future__ import annotations

import math

from ..motion import Fall, Motion, PlanarState
from ..pair import STICK
from ..support import FeltSupport
from ..types import TwoPointBody
from .arcs import Arc
from .course import Course
from .follow import Event

_OVERTURNED = 0.5 * math.pi
"""A body turned farther than this is not carried by its two contacts any more."""
_MOST_EVENTS = 100
"""More changes of stick, slip and flight before an impact come only from rounding."""
_MOST_STEPS = 1000
_SLIP_ROUNDING = 1e-12
"""A slip this small, relative to the speeds it is the difference of, is none: states come through conversions."""


def next_strike(
    body: TwoPointBody,
    state: PlanarState,
    old: int | None,
    support: FeltSupport,
    duration: float,
    tolerance: float = 1e-9,
) -> Fall | None:
    """When, where and with which velocities a measured body strikes next over a fixed or moving support.

    `body` is as in `rock`, and so are its motions up to the first impact. `state`, in the support's frame at its time
    0, may be a measured one: contact `old` (0 is `body.old`, 1 `body.new`) is taken to stand, its gap and its normal
    velocity are dropped and its slip is kept. None is flight. A contact that is on the support or below it strikes at
    time 0 when it moves down, and after it has risen otherwise. `duration` in s; `tolerance` is the error allowed to a
    step, relative to what happens in it.

    The touchdown is told just before its impact: its time in s, the contact that strikes (0 or 1), the state in the
    support's frame. None where nothing strikes within the duration: the body rests on both contacts, balances,
    overturns, or takes longer. Numbers that are not finite, too, give None.

    Raises:
        InputError: the body is neither of the two shapes.
    """
    course = _ToStrike(body, support, duration, tolerance)
    if not math.isfinite(sum(state)):
        return None
    try:
        course.follow(state, old)
    except ArithmeticError:  # numbers so large or so small that their products are none
        return None
    return course.fall


class _ToStrike(Course):
    """The motion of a measured body to its first impact."""

    def __init__(self, body: TwoPointBody, support: FeltSupport, duration: float, tolerance: float) -> None:
        super().__init__(body, support, 0.0, duration, _OVERTURNED, _MOST_STEPS, tolerance)
        self.fall: Fall | None = None
        self.shift = 0.0

    def follow(self, state: PlanarState, old: int | None) -> None:
        """Go from event to event until a contact strikes or nothing more can."""
        shape = self.shape
        angle = shape.own_angle(state.angle)
        self.shift = state.angle - angle
        state = state._replace(angle=angle)
        if old is None:
            self._let_fly(state)
        else:
            u, w, z, s = shape.seen_from(old, state)
            if abs(u) >= self.limit:
                return
            small = _SLIP_ROUNDING * (abs(state.vx) + abs(state.vy) + abs(state.omega) * shape.length)
            self._stand(old, u, w, z, 0.0 if abs(s) <= small else s)
        for _ in range(_MOST_EVENTS):
            if self.fall is not None or self.end is not None:
                return
            self._go_on()

    def _let_fly(self, state: PlanarState) -> None:
        """No contact stands; one that is below the support is on it."""
        gaps = [max(0.0, self.shape.gap(i, state.x, state.y, state.angle)) for i in (0, 1)]
        rates = [self.shape.gap_rate(i, state) for i in (0, 1)]
        falling = [i for i in (0, 1) if gaps[i] == 0.0 and rates[i] < 0.0]
        if falling:
            self._strike([min(falling, key=lambda i: rates[i])], state, 0.0)
        else:
            self._fly(state, (gaps[0], gaps[1]))

    def _rest(self, arc: Arc) -> Event | None:
        return None

    def _strike(self, touching: list[int], state: PlanarState, u: float) -> None:
        self._ends_with(touching[-1], state, Motion.FLIGHT)

    def _strike_other(self, old: int, w: float, z: float, s: float) -> None:
        one = self.next
        slides = STICK not in (one.a, one.b) if isinstance(one, Arc) else s != 0.0
        state = self.shape.state(old, 0.0, w, z, s)
        self._ends_with(1 - old, state, Motion.SLIDING if slides else Motion.TURNING)

    def _ends_with(self, new: int, state: PlanarState, motion: Motion) -> None:
        self.fall = Fall(self.time, new, state._replace(angle=state.angle + self.shift), motion)
