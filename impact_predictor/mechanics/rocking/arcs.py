"""The smooth stretches of a rocking motion and what ends them; dense output of each."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from ..motion import PlanarState
from ..pair import OPEN
from ..support import FeltSupport, FixedSupport
from .shape import Shape
from .step import GROWTH, Instant, Piece, Rate, pieces, step, values_at

_SMALLEST = 1e-10
"""The smallest step of dense output, relative to the stretch."""
_FINER = 0.01
"""Tolerance of a stretch whose end is known exactly, relative to that of others: its steps must meet the end."""


class Happening(IntEnum):
    """What ends a stretch. The number of the contact that it happens to goes with it."""

    TOUCHES = 0
    """The open contact reaches the support."""
    OVERTURNS = 1
    STOPS = 2
    """The slip is zero."""
    LIFTS = 3
    """The support would have to pull at a contact."""
    SLIPS = 4
    """A contact that stuck begins to slip along +t."""
    SLIPS_BACK = 5
    YIELDS = 6
    """A body that rested on both contacts begins to move."""
    JAMS = 7
    BALANCES = 8
    """At rest on one contact for ever."""
    RESTS = 9
    """At rest on both contacts for ever."""
    TIME_IS_UP = 10
    TAKES_TOO_LONG = 11
    """As many steps as are allowed came first."""


class Arc:
    """A stretch of motion over closed contacts; `a` and `b` are the states of contacts 0 and 1."""

    def __init__(
        self,
        shape: Shape,
        support: FeltSupport,
        a: int,
        b: int,
        start: float,
        first: Instant,
        tolerance: float,
        swings: bool,
    ) -> None:
        self.shape, self.support, self.a, self.b, self.start = shape, support, a, b, start
        self.contact = 0 if a != OPEN else 1
        self.instants = [first]
        """The ends of the steps; their times count from `start`, so that the shortest hops keep their digits."""
        self.tolerance = tolerance
        felt = support.felt(start)
        self.scale = shape.length, max(abs(support.gravity), abs(felt[0]) + abs(felt[1]))
        self.swings = swings
        """Whether it moves at all."""
        self._pieces: list[Piece] = []

    @property
    def end(self) -> float:
        return self.start + self.instants[-1].time

    def rate(self) -> Rate:
        return rate_of(self.shape, self.support, self.a, self.b, self.start)

    def dense(self) -> list[Piece]:
        """The polynomials of the arc, made when they are first asked for."""
        if not self._pieces:
            if self.swings:
                rate = self.rate()
                for now, end in zip(self.instants, self.instants[1:], strict=False):
                    for then in self.steps(now, end.time):
                        # The last step ends where the arc does, to the last bit.
                        then = end if then.time == end.time else then
                        self._pieces += pieces(rate, now, then, self.scale, self.tolerance)
                        now = then
            if not self._pieces:
                now = self.instants[0]
                self._pieces = [Piece(0.0, self.instants[-1].time, (now.u,), (now.z,))]
        return self._pieces

    def close(self, end: Instant) -> None:
        """End the arc at an instant that the summed impacts lead to, uniformly."""
        now = self.instants[0]
        self.instants.append(end)
        u, z = (0.5 * (end.u - now.u), 0.5 * (end.u + now.u)), (0.5 * (end.z - now.z), 0.5 * (end.z + now.z))
        self._pieces = [Piece(now.time, end.time, u, z)]

    def steps(self, now: Instant, until: float) -> list[Instant]:
        """Ends of steps from an instant to a time, which may be far, without a look at events."""
        rate, found = self.rate(), []
        h = until - now.time
        smallest = _SMALLEST * h
        while now.time < until:
            left = until - now.time
            h = min(h, left)
            then, rows = step(rate, now, h, self.scale, _FINER * self.tolerance)
            if not rows and h > smallest:
                h *= GROWTH[0]
                continue
            now = then._replace(time=until) if h == left else then
            found.append(now)
            h *= 2.0
        return found

    def at(self, time: Any) -> PlanarState:
        """State at a time or an array of times within the arc."""
        return self.shape.state(self.contact, *values_at(self.dense(), time - self.start))


def rate_of(shape: Shape, support: FeltSupport, a: int, b: int, start: float) -> Rate:
    """Accelerations of turning and of slip in given states of the contacts, of the time from `start` on."""
    felt_at = support.felt
    if a != OPEN and b != OPEN:
        both = shape.forces_of_both

        def slide(time: float, u: float, w: float, z: float, s: float) -> tuple[float, float]:
            return 0.0, both(a, felt_at(start + time), z, s)[0]

        return slide
    contact, state, forces = (0, a, shape.forces) if a != OPEN else (1, b, shape.forces)
    if isinstance(support, FixedSupport):
        felt = support.felt(0.0)

        def turn(time: float, u: float, w: float, z: float, s: float) -> tuple[float, float]:
            return forces(contact, state, felt, u, w, z, s)[:2]

        return turn

    def turn_on_moving(time: float, u: float, w: float, z: float, s: float) -> tuple[float, float]:
        alpha, beta, _, _, _ = forces(contact, state, felt_at(start + time), u, w, z, s)
        return alpha, beta

    return turn_on_moving
