"""Flight between impacts: the mass centre is thrown and the body turns at a constant rate in the world."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from ..bodies import sine_and_cosine
from ..motion import PlanarState
from ..pair import OPEN
from ..support import FeltSupport, FixedSupport, MovingSupport, SupportMotion
from ..types import Vector
from .arcs import Happening
from .shape import Shape
from .step import GROWTH, NEAR, Instant, Piece, Value, nudged, pieces, root, step, values_at

_STEP = 0.25
"""Steps of the search, in times that a gap needs to change."""
_PART_OF_PERIOD = 0.0625
"""The longest step, in shortest periods of the support."""
_SMALLEST = 1e-9
"""The smallest step of the search, relative to the longest."""
_BEYOND = 1.1
"""A step goes as much farther than where a gap would close."""
_DOUBT = 0.05
"""Gaps that close within this part of a step after each other are both looked at."""
_ROUNDING = 1e-14
"""A gap below this part of what the body moved is rounding."""
_SPEED_ROUNDING = 1e-15
"""Part of a body's speeds that is rounding in the rate of a gap."""
_GAUSS = tuple(
    (0.5 + 0.5 * node, 0.5 * weight)
    for node, weight in (
        (-0.9061798459386640, 0.2369268850561891),
        (-0.5384693101056831, 0.4786286704993665),
        (0.0, 0.5688888888888889),
        (0.5384693101056831, 0.4786286704993665),
        (0.9061798459386640, 0.2369268850561891),
    )
)
"""Gauss' quadrature of order 10 on 0..1: nodes and weights."""


class Landing(NamedTuple):
    """What ends a flight, at which contact, after how long (s), with which state and gaps of the contacts (m)."""

    happening: Happening
    contact: int
    time: float
    state: PlanarState
    gaps: Vector
    together: bool
    """Whether the other contact reaches the support at the same time, up to rounding."""


class Flight:
    """A stretch of flight from `state`, in which the gaps of the contacts are known to their last digits.

    Displacements count from the start, so that the gap of a contact that has just left keeps its digits, too.
    """

    a = b = OPEN

    def __init__(
        self, shape: Shape, support: FeltSupport, start: float, state: PlanarState, gaps: Vector, tolerance: float
    ) -> None:
        self.shape, self.support, self.start, self.state, self.gaps = shape, support, start, state, gaps
        self.tolerance = tolerance
        self.felt = support.felt(start)
        self.scale = 1.0, max(abs(support.gravity), abs(self.felt[0]) + abs(self.felt[1]))
        self.weight = math.hypot(self.felt[0], self.felt[1])
        self.moves = not isinstance(support, FixedSupport)
        self.instants = [Instant(0.0, 0.0, state.vx, 0.0, state.vy, *self._rate(0.0, 0.0, state.vx, 0.0, state.vy))]
        self._pieces: list[Piece] = []

    @property
    def end(self) -> float:
        return self.start + self.instants[-1].time

    def _rate(self, time: float, x: float, vx: float, y: float, vy: float) -> Vector:
        """Acceleration of the mass centre, from its displacement and its velocity."""
        felt = self.support.felt(self.start + time)
        return self.shape.felt_at(felt, self.state.x + x, self.state.y + y, vx, vy)

    def _step(self, now: Instant, h: float) -> tuple[Instant, int]:
        if self.moves:
            return step(self._rate, now, h, self.scale, self.tolerance)
        gx, gy = now.alpha, now.beta
        x, y = now.u + (now.w + 0.5 * gx * h) * h, now.z + (now.s + 0.5 * gy * h) * h
        return Instant(now.time + h, x, now.w + gx * h, y, now.s + gy * h, gx, gy), 2

    def _turned(self, time: float, turned: float, h: float) -> tuple[float, float]:
        """The angle turned since the start after a step from `time` on, and the rate there."""
        omega = self.state.omega
        if not self.moves:
            return turned + omega * h, omega
        felt, rate = self.support.felt, self.felt[2]
        for node, weight in _GAUSS:
            turned += weight * h * (omega + rate - felt(self.start + time + node * h)[2])
        return turned, omega + rate - felt(self.start + time + h)[2]

    def at(self, time: Any) -> PlanarState:
        """State at a time or an array of times."""
        first, state = self.instants[0], self.state
        t = time - self.start
        if not self.moves:
            x, y = (first.w + 0.5 * first.alpha * t) * t, (first.s + 0.5 * first.beta * t) * t
            vx, vy, angle, omega = first.w + first.alpha * t, first.s + first.beta * t, state.omega * t, state.omega
        else:
            if not self._pieces:
                for now, then in zip(self.instants, self.instants[1:], strict=False):
                    self._pieces += pieces(self._rate, now, then, self.scale, self.tolerance)
            x, vx, y, vy = values_at(self._pieces, t) if self._pieces else (0.0, state.vx, 0.0, state.vy)
            assert isinstance(self.support, MovingSupport)
            begin, now_moves = self.support.motion(self.start), self.support.motion(time)
            omega = state.omega + begin.rate - now_moves.rate
            angle = (state.omega + begin.rate) * t - (now_moves.angle - begin.angle)
        return PlanarState(state.x + x, state.y + y, state.angle + angle, vx, vy, omega + 0.0 * t)

    def follow(self, last: float, most: int) -> Landing:
        """Fly until a contact reaches the support, or for `last` s, in at most `most` steps."""
        now, turned = self.instants[0], 0.0
        before = self._watch(now, 0.0, self.state.omega)
        # A contact that is leaving just now does not begin with a fall, whatever rounding says.
        _, _, _, vx, vy, omega = self.state
        rounding = _SPEED_ROUNDING * (abs(vx) + abs(vy) + abs(omega) * self.shape.length)
        before = [(gap, rate if rate > rounding else 0.0) if gap <= 0.0 else (gap, rate) for gap, rate in before]
        pace = abs(self.state.omega) + math.sqrt(self.weight / self.shape.length)
        longest = min(_STEP / pace if pace > 0.0 else math.inf, _PART_OF_PERIOD * self.support.period, last)
        h = min(longest, *(self._reach(*one) for one in before))
        smallest = _SMALLEST * longest
        while now.time < last and len(self.instants) <= most:
            h = min(h, longest)
            left = last - now.time
            h = left if h > left * (1.0 - 1e-9) else h
            then, rows = self._step(now, h)
            if not rows and h > smallest:
                h *= GROWTH[0]
                continue
            then_turned, omega = self._turned(now.time, turned, h)
            after = self._watch(then, then_turned, omega)
            if h > smallest and any(_may_dip(*pair, h) for pair in zip(before, after, strict=True)):
                h *= 0.25
                continue
            crossed = [k for k, (gap, _) in enumerate(after) if gap < 0.0]
            # What neither was open nor opens is a contact that rounding holds: not before it is seen to open.
            late = [k for k in crossed if before[k][0] <= 0.0 and before[k][1] <= 0.0]
            if late and h > smallest:
                h *= 0.25
                continue
            if crossed:
                if late:
                    k, end, end_turned = late[0], then, then_turned
                else:
                    k, end, end_turned, omega = self._first_closing(now, then, then_turned, before, after, crossed)
                self.instants.append(end)
                gaps = self._watch(end, end_turned, omega)
                x, y, angle, _, _, _ = self.state
                state = PlanarState(x + end.u, y + end.z, angle + end_turned, end.w, end.s, omega)
                contact = min(k, 1)
                other = max(0.0, gaps[1 - contact][0])
                moved = self.gaps[1 - contact] + abs(end.u) + abs(end.z) + self.shape.length * abs(end_turned)
                happening = Happening.OVERTURNS if k == 2 else Happening.TOUCHES
                pair = (0.0, other) if contact == 0 else (other, 0.0)
                return Landing(happening, contact, end.time, state, pair, other <= _ROUNDING * moved)
            self.instants.append(then)
            now, turned, before = then, then_turned, after
            h = max(0.4 * h, min(4.0 * h, *(self._reach(*one) for one in before)))
        happening = Happening.TIME_IS_UP if now.time >= last else Happening.TAKES_TOO_LONG
        return Landing(happening, 0, now.time, self.state, self.gaps, False)

    def _reach(self, gap: float, rate: float) -> float:
        """A little more than the time in which a gap closes under the weight at the start."""
        gap = max(0.0, gap)
        root_of = math.sqrt(rate * rate + 2.0 * self.weight * gap)
        if rate > 0.0:
            return _BEYOND * (rate + root_of) / self.weight if self.weight > 0.0 else math.inf
        return 2.0 * _BEYOND * gap / (root_of - rate) if root_of > 0.0 and gap > 0.0 else math.inf

    def _first_closing(
        self,
        now: Instant,
        then: Instant,
        then_turned: float,
        before: list[Value],
        after: list[Value],
        crossed: list[int],
    ) -> tuple[int, Instant, float, float]:
        """Which gap closes first within a step, the instant, the angle turned until then and the rate."""
        h = then.time - now.time
        near = {k: root(_cubic(h, before[k], after[k]), h, 0.5 * h) for k in crossed}
        first = min(near.values())
        found = []
        for k, guess in near.items():
            if guess > first + _DOUBT * h:
                continue
            here, turned, omega, here_at = then, then_turned, 0.0, h

            def gap(at: float, k: int = k) -> Value:
                # From the last place: the nearer it is, the less the step costs.
                nonlocal here, turned, omega, here_at
                span = at - here_at
                turned, omega = self._turned(here.time, turned, span)
                here = nudged(self._rate, here, span) if abs(span) <= NEAR * h else self._step(here, span)[0]
                here, here_at = here._replace(time=now.time + at), at
                return self._watch(here, turned, omega)[k]

            gap(root(gap, h, guess))
            found.append((here_at, k, here, turned, omega))
        return min(found)[1:]

    def _watch(self, now: Instant, turned: float, omega: float) -> list[Value]:
        """Gaps of the contacts and their rates; for a disc the height above the edges, too."""
        shape, (x, y, angle, _, _, _) = self.shape, self.state
        state = PlanarState(x + now.u, y + now.z, angle + turned, now.w, now.s, omega)
        gaps = [
            (self.gaps[i] + shape.gap_change(i, self.state, now.u, now.z, turned), shape.gap_rate(i, state))
            for i in (0, 1)
        ]
        if shape.rolls:
            ex, ey = shape.edges[1]
            size = math.hypot(ex, ey)
            gaps.append(((ex * state.y - ey * state.x) / size, (ex * state.vy - ey * state.vx) / size))
        return gaps


def in_world(motion: SupportMotion, state: PlanarState) -> PlanarState:
    """A state in a support's frame as one in the world's axes."""
    x, y, angle, vx, vy, omega = state
    sine, cosine = sine_and_cosine(motion.angle)
    px, py = cosine * x - sine * y, sine * x + cosine * y
    return PlanarState(
        motion.x + px,
        motion.y + py,
        motion.angle + angle,
        motion.vx - motion.rate * py + cosine * vx - sine * vy,
        motion.vy + motion.rate * px + sine * vx + cosine * vy,
        motion.rate + omega,
    )


def from_world(motion: SupportMotion, state: PlanarState) -> PlanarState:
    """A state in the world's axes as one in a support's frame."""
    x, y, angle, vx, vy, omega = state
    sine, cosine = sine_and_cosine(motion.angle)
    px, py = x - motion.x, y - motion.y
    ux, uy = vx - motion.vx + motion.rate * py, vy - motion.vy - motion.rate * px
    return PlanarState(
        cosine * px + sine * py,
        cosine * py - sine * px,
        angle - motion.angle,
        cosine * ux + sine * uy,
        cosine * uy - sine * ux,
        omega - motion.rate,
    )


def _cubic(h: float, before: Value, after: Value) -> Callable[[float], Value]:
    """A gap and its rate within a step of length h, from those at both ends."""
    gap, rise, end_gap, end_rise = before[0], h * before[1], after[0], h * after[1]
    c3, c2 = 2.0 * (gap - end_gap) + rise + end_rise, 3.0 * (end_gap - gap) - 2.0 * rise - end_rise

    def near(at: float) -> Value:
        part = at / h
        return gap + part * (rise + part * (c2 + part * c3)), (rise + part * (2.0 * c2 + 3.0 * part * c3)) / h

    return near


def _may_dip(start: Value, end: Value, span: float) -> bool:
    """Whether a gap that is open at both ends of a step may close between them: its tangents meet below the dip."""
    (gap, rate), (end_gap, end_rate) = start, end
    if gap <= 0.0 or end_gap <= 0.0 or not rate < 0.0 < end_rate:
        return False
    return gap + rate * (end_gap - gap - end_rate * span) / (rate - end_rate) <= 0.0
