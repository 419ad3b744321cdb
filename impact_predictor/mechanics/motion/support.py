"""Planar supports that bodies stand on: a fixed floor or slope, or a moving one such as a ship's deck.

In the support's frame a body feels, at r from the frame's origin and moving with r' there, the acceleration
R^T (g - A) - dW/dt z x r + W^2 r - 2 W z x r' and the angular acceleration -dW/dt: R the rotation, W its rate, A the
acceleration of the origin.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from ...errors import InputError
from ..bodies import sine_and_cosine
from ..types import Vector
from .felt import FeltPolynomials, FrameAcceleration

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_NODES = 10
"""Values that a polynomial of a moving support goes through: with `_PART` they are exact to rounding."""
_PART = 1.0 / 24.0
"""Length of one polynomial, in shortest periods."""
_FIT = 1e-12
"""Where the last two terms of a polynomial are above this part of what is felt the motion is evaluated itself."""


class PlanarState(NamedTuple):
    """Place of the mass centre (m), angle (rad), its velocity (m/s) and angular velocity (rad/s), CCW positive."""

    x: float
    y: float
    angle: float
    vx: float
    vy: float
    omega: float


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

FeltSupport = Support | FeltPolynomials
"""What motion between two impacts asks of a support: `felt` by a body that rests at its origin, `gravity` in m/s^2, and
the `period` in s in which its motion swings to and fro, inf where it does not."""


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
