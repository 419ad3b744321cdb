"""Planar supports that bodies stand on: a fixed floor or slope, or a moving one such as a ship's deck.

In the support's frame a body feels, at r from the frame's origin and moving with r' there, the acceleration
R^T (g - A) - dW/dt z x r + W^2 r - 2 W z x r' and the angular acceleration -dW/dt: R the rotation, W its rate, A the
acceleration of the origin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ...errors import InputError
from ..bodies import sine_and_cosine
from ..types import Vector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

FrameAcceleration = tuple[float, float, float, float]
"""Acceleration felt at rest at the origin, along the support's axes (m/s^2); rate (rad/s); angular acceleration."""

_NODES = 10
"""Values that a polynomial of a moving support goes through: with `_PART` they are exact to rounding."""
_PART = 1.0 / 24.0
"""Length of one polynomial, in shortest periods."""
_FIT = 1e-12
"""Where the last two terms of a polynomial are above this part of what is felt the motion is evaluated itself."""
_MAX_PARTS = 4096
"""Polynomials that are kept."""


class PlanarState(NamedTuple):
    """Place of the mass centre (m), angle (rad), its velocity (m/s) and angular velocity (rad/s), CCW positive."""

    x: float
    y: float
    angle: float
    vx: float
    vy: float
    omega: float


class FeltSupport(Protocol):
    """What motion between two impacts asks of a support; any object that answers it will do."""

    @property
    def period(self) -> float:
        """The shortest time in s in which its motion swings to and fro; inf where it does not swing."""

    @property
    def gravity(self) -> float:
        """Gravity in m/s^2."""

    def felt(self, time: float) -> FrameAcceleration:
        """What a body at rest at the frame's origin feels at a time in s."""


class SupportMotion(NamedTuple):
    """Motion of a support's frame in the world.

    Angle (rad, CCW), its rate and acceleration; place, velocity and acceleration of the origin (SI). The fields may be
    arrays over time.
    """

    angle: Any
    rate: Any
    acceleration: Any
    x: Any
    y: Any
    vx: Any
    vy: Any
    ax: Any
    ay: Any


class FixedSupport(NamedTuple):
    """A straight support at rest; `slope` in rad, CCW (its x axis rises), `gravity` in m/s^2 downwards."""

    slope: float = 0.0
    gravity: float = 9.81

    @property
    def period(self) -> float:
        return math.inf

    def felt(self, time: float) -> FrameAcceleration:
        """What a body feels at rest: gravity in the support's axes."""
        return -self.gravity * math.sin(self.slope), -self.gravity * math.cos(self.slope), 0.0, 0.0

    def motion(self, time: Any) -> SupportMotion:
        """Motion of the frame: none, for a time or an array of times."""
        rest = 0.0 * time
        return SupportMotion(self.slope + rest, *[rest] * 8)


class FeltPolynomials:
    """What is felt, from polynomials in time: a motion asks for it a hundred times, and a sum of waves takes long.

    Each has a `length` in s and goes through the values that `exactly` gives at `nodes` Chebyshev nodes of it. Where
    the last two terms of one are above `fit` of what is felt, `exactly` is asked itself.
    """

    period = math.inf

    def __init__(
        self,
        exactly: Callable[[list[float]], Sequence[Sequence[float]]],
        length: float,
        nodes: int,
        gravity: float = 9.81,
        fit: float = math.inf,
    ) -> None:
        self._exactly, self._length, self._nodes = exactly, length, _nodes(nodes)
        self.gravity, self._fit = gravity, fit
        self._parts: dict[int, list[tuple[float, Sequence[float]]]] = {}

    def felt(self, time: float) -> FrameAcceleration:
        """What a body feels at rest at the support's origin."""
        place = time / self._length
        number = math.floor(place)
        part = self._parts.get(number)
        if part is None:
            if len(self._parts) >= _MAX_PARTS:
                self._parts.clear()
            part = self._parts[number] = self._polynomials(number)
        if not part:
            x, y, w, a = self._exactly([time])[0]
            return x, y, w, a
        s = 2.0 * (place - number) - 1.0
        x = y = w = a = 0.0
        for node, (cx, cy, cw, ca) in part:
            s_node = s - node
            x = x * s_node + cx
            y = y * s_node + cy
            w = w * s_node + cw
            a = a * s_node + ca
        return x, y, w, a

    def _polynomials(self, number: int) -> list[tuple[float, Sequence[float]]]:
        """Nodes and divided differences of one part (Newton's form), the highest first; none where they do not fit."""
        nodes, length = self._nodes, self._length
        rows = list(self._exactly([(number + 0.5 + 0.5 * node) * length for node in nodes]))
        x, y, w, a = [max(map(abs, column)) for column in zip(*rows, strict=True)]
        sizes = max(x, y), max(x, y), w, max(a, w / length)
        for order in range(1, len(nodes)):
            for k in range(len(nodes) - 1, order - 1, -1):
                gap = nodes[k] - nodes[k - order]
                rows[k] = [(b - a) / gap for a, b in zip(rows[k - 1], rows[k], strict=True)]
        # As terms of Chebyshev's series: those of the powers are so many times as large.
        large = self._fit * 2.0 ** (len(nodes) - 3)
        fits = all(abs(end) <= large * size for row in rows[-2:] for end, size in zip(row, sizes, strict=True))
        return list(zip(nodes, rows, strict=True))[::-1] if fits else []


@cache
def _nodes(count: int) -> list[float]:
    """Chebyshev's nodes on -1..1, each as far from those before it as can be: Newton's form keeps its digits then."""
    left = [math.cos((k + 0.5) * math.pi / count) for k in range(count)]
    nodes: list[float] = []
    while left:
        nodes.append(max(left, key=lambda node: math.prod(abs(node - other) for other in nodes)))
        left.remove(nodes[-1])
    return nodes


class MovingSupport:
    """A straight support that moves as `function` of time tells, about the point of it where its frame has its origin.

    `function(time)` gives a SupportMotion with derivatives that belong together, for a time in s or, if it can, an
    array of times. `period` is the shortest time in s in which the motion swings to and fro: no shorter swing may be in
    it. `gravity` in m/s^2 downwards; `origin` (x, y) in m is where the frame's origin lies in the frame of `function`.
    `felt(time)` is what a body feels at rest at the origin. Not to be changed once it is made.

    Raises:
        InputError: the period is not a finite time above 0.
    """

    def __init__(
        self,
        function: Callable[[Any], SupportMotion],
        period: float,
        gravity: float = 9.81,
        origin: Vector = (0.0, 0.0),
    ) -> None:
        if not 0.0 < period < math.inf:
            raise InputError(f"period of the moving support is {period}; give a finite number of seconds above 0")
        self.function, self.period, self.gravity, self.origin = function, period, gravity, origin
        self.felt = FeltPolynomials(self._rows, _PART * period, _NODES, fit=_FIT).felt

    def at(self, x: float, y: float) -> MovingSupport:
        """The same support, its frame's origin moved by (x, y) in m along its axes: to where a body stands."""
        return MovingSupport(self.function, self.period, self.gravity, (self.origin[0] + x, self.origin[1] + y))

    def motion(self, time: Any) -> SupportMotion:
        """Motion of the frame at a time, or at an array of times."""
        angle, rate, acceleration, x, y, vx, vy, ax, ay = self.function(time)
        if self.origin != (0.0, 0.0):
            sine, cosine = sine_and_cosine(angle)
            px, py = self.origin
            arm_x, arm_y = cosine * px - sine * py, sine * px + cosine * py
            square = rate * rate
            x, y, vx, vy = x + arm_x, y + arm_y, vx - rate * arm_y, vy + rate * arm_x
            ax = ax - acceleration * arm_y - square * arm_x
            ay = ay + acceleration * arm_x - square * arm_y
        return SupportMotion(angle=angle, rate=rate, acceleration=acceleration, x=x, y=y, vx=vx, vy=vy, ax=ax, ay=ay)

    def felt_exactly(self, time: Any) -> tuple[Any, Any, Any, Any]:
        """As `felt`, from the motion itself, for a time or an array of times."""
        angle, rate, acceleration, _, _, _, _, ax, ay = self.motion(time)
        sine, cosine = sine_and_cosine(angle)
        down = self.gravity + ay
        return -cosine * ax - sine * down, sine * ax - cosine * down, rate, acceleration

    def felt_at(self, times: Any) -> NDArray[np.float64]:
        """As `felt_exactly` in the columns of an array (n, 4), also where the function takes one time only."""
        import numpy as np

        times = np.asarray(times, dtype=float)
        try:
            return np.stack([np.broadcast_to(part, times.shape) for part in self.felt_exactly(times)], axis=1)
        except (TypeError, ValueError):
            return np.array([self.felt_exactly(time) for time in times.tolist()], dtype=float).reshape(-1, 4)

    def _rows(self, times: list[float]) -> list[list[float]]:
        return self.felt_at(times).tolist()  # type: ignore[no-any-return]


Support = FixedSupport | MovingSupport


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


def sampled_support(times: Any, angle: Any, x: Any, y: Any, gravity: float = 9.81) -> MovingSupport:
    """A support measured at `times` (n,) in s: angle (n,) in rad, CCW, and origin x, y (n,) in m.

    Splines of degree 5 go through the samples, so that the accelerations are smooth; before the first sample and
    after the last one the support rests.

    Raises:
        InputError: fewer than 6 samples, or times that do not increase.
    """
    import numpy as np
    from scipy.interpolate import make_interp_spline

    times = np.asarray(times, dtype=float)
    values = np.column_stack([np.asarray(part, dtype=float) for part in (angle, x, y)])
    if len(times) < 6 or not (np.diff(times) > 0.0).all() or not np.isfinite(values).all():
        raise InputError("the samples of the support are too few or out of order; give 6 or more at increasing times")
    first = make_interp_spline(times, values, k=5)
    splines = first, first.derivative(), first.derivative(2)

    def motion(time: Any) -> SupportMotion:
        inside = np.clip(time, times[0], times[-1])
        moves = np.asarray(inside == time)[..., None]
        (a, px, py), (da, vx, vy), (dda, ax, ay) = (
            np.moveaxis(np.where(moves | (degree == 0), spline(inside), 0.0), -1, 0)
            for degree, spline in enumerate(splines)
        )
        return SupportMotion(angle=a, rate=da, acceleration=dda, x=px, y=py, vx=vx, vy=vy, ax=ax, ay=ay)

    return MovingSupport(motion, 4.0 * float(np.diff(times).min()), gravity)
