"""The next touchdown: bodies on their way to it, methods that tell it, and what they are held against.

The reference is the motion integrated to 13 digits by scipy, with equations of motion that share no code with the
program's own `next_touchdown`. It is right to about 1e-10; smaller errors are not told apart.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import atan2, cos, hypot, inf, pi, sin, sqrt
from random import Random
from typing import Any, Final, NamedTuple

from scipy.integrate import solve_ivp

from ...mechanics.motion import PlanarState, next_touchdown
from ...mechanics.types import Twist, Vector
from ...prediction.points import ACCURACY
from . import TOUCHDOWN, AccuracyScene, Methods

GRAVITY: Final = (0.0, -9.81)
HORIZON: Final = 20.0
"""s within which the touchdown is looked for."""


class FallingBody(NamedTuple):
    """What `next_touchdown` is asked: state, points and stance, rho^2 in m^2, friction, gravity in m/s^2."""

    state: PlanarState
    points: tuple[Vector, ...]
    stance: int | None
    rho_squared: float
    friction: float
    gravity: Vector = GRAVITY

    def others(self) -> list[Vector]:
        """The points that do not stand."""
        return [point for index, point in enumerate(self.points) if index != self.stance]


class PredictedTouchdown(NamedTuple):
    """A touchdown: the time until then in s, and the twist of the mass centre right before it strikes."""

    time: float
    twist: Twist


Shape = tuple[float, float, float]
"""A body at its touchdown: half the distance of A and B, height of the mass centre above them (m), rho^2 (m^2)."""


def falling(shape: Shape, angle: float, omega: float, slip: float = 0.0, friction: float = inf) -> FallingBody:
    """A body with B raised by `angle`, turning about A with `omega`, while A slips with `slip` (m/s)."""
    c, s, (half, height, rho_squared) = cos(angle), sin(angle), shape
    x, y = c * half - s * height, s * half + c * height  # of the mass centre from A
    state = PlanarState(x, y, angle, slip - omega * y, omega * x, omega)
    return FallingBody(state, ((-half, -height), (half, -height)), 0, rho_squared, friction)


def rectangle(length: float, height: float) -> Shape:
    """A homogeneous plate on its long or short side."""
    return 0.5 * length, 0.5 * height, (length * length + height * height) / 12.0


CRATE: Final = rectangle(1.0, 0.6)


def turning(shape: Shape, source: Random) -> FallingBody:
    """A fall about A: of a body that was at rest between a twentieth and nine tenths of the way to its balance."""
    half, height, rho_squared = shape
    balance, arm = atan2(half, height), hypot(half, height)
    stiffness = -GRAVITY[1] * arm / (rho_squared + arm * arm)
    rest = balance * source.uniform(0.05, 0.9)
    angle = rest * source.choice((1.0, source.uniform(0.1, 0.95), source.uniform(0.1, 0.95)))
    speed = sqrt(2.0 * stiffness * max(0.0, cos(balance - rest) - cos(balance - angle)))
    return falling(shape, angle, speed if source.random() < 0.1 else -speed)


def of_any_size(source: Random) -> FallingBody:
    """A fall of a plate."""
    length = 10.0 ** source.uniform(-3.0, 2.0)
    return turning(rectangle(length, length * 10.0 ** source.uniform(-3.0, 1.0)), source)


def leaving_balance(source: Random) -> FallingBody:
    """A crate at rest near its balance: most of its fall it hardly moves."""
    return falling(CRATE, atan2(*CRATE[:2]) - 10.0 ** source.uniform(-4.0, -1.0), 0.0)


def slipping(source: Random) -> FallingBody:
    """A crate whose standing edge slips forwards or back, all the way; one that sticks is held."""
    slip = source.choice((-1.0, 1.0)) * source.uniform(1.0, 2.0)
    return falling(CRATE, source.uniform(0.02, 0.2), -source.uniform(0.2, 1.5), slip, friction=0.2)


def thrown(source: Random) -> FallingBody:
    """A crate in the air; any of its corners can strike."""
    x, y, rho_squared = CRATE
    vx, vy, omega = source.uniform(-2.0, 2.0), source.uniform(-2.0, 2.0), source.uniform(-6.0, 6.0)
    state = PlanarState(0.0, source.uniform(0.7, 1.5), source.uniform(-pi, pi), vx, vy, omega)
    return FallingBody(state, ((-x, -y), (x, -y), (x, y), (-x, y)), None, rho_squared, 0.2)


SCENES: Final[dict[AccuracyScene, Callable[[Random], FallingBody]]] = {
    AccuracyScene(name, TOUCHDOWN, title, description, "the motion integrated by scipy to 13 digits"): draw
    for name, title, description, draw in (
        ("plate", "Crate on a floor", "A crate of 1 m by 0.6 m, tipped about an edge.", partial(turning, CRATE)),
        ("extreme", "Extreme plates", "1 mm to 100 m, 1000 times as long as high to 10 times as high.", of_any_size),
        ("balance", "Out of balance", "A crate is released 1e-4 to 0.1 rad from its balance.", leaving_balance),
        ("sliding", "Sliding stance", "The edge on which a crate stands slips, friction 0.2.", slipping),
        ("flight", "Flight", "A crate is thrown, turning; the first of its corners strikes.", thrown),
    )
}
"""What the methods are compared on, and what draws a body."""


def accelerations(fall: FallingBody, state: Any) -> tuple[float, float, float]:
    """Acceleration of the mass centre (m/s^2) and angular acceleration (rad/s^2) of a body in a state.

    A stance sticks where its friction is infinite, else it goes on slipping as it does at first.
    """
    if fall.stance is None:
        return (*fall.gravity, 0.0)
    _, _, angle, vx, _, omega = state
    (px, py), c, s, g = fall.points[fall.stance], cos(angle), sin(angle), fall.gravity[1]
    x, y, square = s * py - c * px, -s * px - c * py, omega * omega  # of the mass centre from the contact
    if fall.friction == inf:
        alpha = g * x / (fall.rho_squared + x * x + y * y)
        return -alpha * y - square * x, alpha * x - square * y, alpha
    drag = fall.friction if vx + omega * y > 0.0 else -fall.friction
    lever = x + drag * y
    alpha = (square * y + g) * lever / (fall.rho_squared + x * lever)
    up = alpha * x - square * y
    return -drag * (up - g), up, alpha


def integrated(fall: FallingBody, tolerance: float) -> PredictedTouchdown | None:
    """scipy's DOP853 up to the event that a point touches."""
    others = fall.others()

    def rates(_: float, state: Any) -> Any:
        return (*state[3:], *accelerations(fall, state))

    def gap(_: float, state: Any) -> float:
        c, s = cos(state[2]), sin(state[2])
        return float(state[1]) + min(s * x + c * y for x, y in others)

    gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]
    found = solve_ivp(rates, (0.0, HORIZON), fall.state, "DOP853", rtol=tolerance, atol=tolerance, events=gap)
    if not found.t_events[0].size:
        return None
    return PredictedTouchdown(float(found.t_events[0][0]), Twist(*found.y_events[0][0][3:].tolist()))


reference_of: Final[Callable[[FallingBody], Any]] = partial(integrated, tolerance=1e-13)
"""The touchdown to 13 digits."""


def extrapolated(fall: FallingBody, accelerated: bool) -> PredictedTouchdown | None:
    """The first root of the parabolas of the gaps, with their rates of now and, if so, their accelerations of now."""
    _, height, angle, vx, vy, omega = fall.state
    ax, ay, alpha = accelerations(fall, fall.state) if accelerated else (0.0, 0.0, 0.0)
    square, c, s, first = omega * omega if accelerated else 0.0, cos(angle), sin(angle), inf
    for px, py in fall.others():
        x, y = c * px - s * py, s * px + c * py
        rate = vy + omega * x
        discriminant = rate * rate - 2.0 * (height + y) * (ay + alpha * x - square * y)
        down = sqrt(max(0.0, discriminant)) - rate
        if discriminant >= 0.0 and down > 0.0:
            first = min(first, 2.0 * (height + y) / down)
    twist = Twist(vx + ax * first, vy + ay * first, omega + alpha * first)
    return PredictedTouchdown(first, twist) if first < inf else None


def own(fall: FallingBody) -> PredictedTouchdown | None:
    """The program's own predictor."""
    end = next_touchdown(*fall, HORIZON, ACCURACY)
    return PredictedTouchdown(end.time, Twist(end.state.vx, end.state.vy, end.state.omega)) if end.point >= 0 else None


def errors_of(fall: FallingBody, answer: PredictedTouchdown, right: PredictedTouchdown) -> dict[str, float]:
    """Error of the time, relative to it, and of the twist at the touchdown, relative to its size."""
    (vx, vy, omega), rho = right.twist, sqrt(fall.rho_squared)
    wx, wy, turning = answer.twist
    error = hypot(wx - vx, wy - vy, rho * (turning - omega)) / hypot(vx, vy, rho * omega)
    return {"time_error": abs(answer.time - right.time) / right.time, "twist_error": error}


USED: Final = ("next_touchdown", f"tolerance = {ACCURACY:g}")
METHODS: Final[Methods] = {
    ("constant twist", ""): partial(extrapolated, accelerated=False),
    ("constant acceleration", ""): partial(extrapolated, accelerated=True),
    **{("DOP853", f"rtol = {rtol:g}"): partial(integrated, tolerance=rtol) for rtol in (1e-3, 1e-6, 1e-9)},
    USED: own,
}
