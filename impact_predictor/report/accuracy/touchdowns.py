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
from .measure import Method

GRAVITY: Final = (0.0, -9.81)
SLIPS: Final = 0.2
"""Friction of a stance that slips all the way; one that sticks is held."""

HORIZON: Final = 20.0
"""s within which the touchdown is looked for."""

FINEST: Final = 1e-13
"""Relative tolerance of the reference."""


class FallingBody(NamedTuple):
    """What `next_touchdown` is asked: state, points and stance, rho^2 in m^2, friction, gravity in m/s^2."""

    state: PlanarState
    points: tuple[Vector, ...]
    stance: int | None
    rho_squared: float
    friction: float
    gravity: Vector = GRAVITY


class PredictedTouchdown(NamedTuple):
    """A touchdown: the time until then in s, and the twist of the mass centre right before it strikes."""

    time: float
    twist: Twist


class FallingShape(NamedTuple):
    """A body seen at its touchdown: A lies `a` behind, B `b` ahead of and both `height` below the mass centre (m)."""

    a: float
    b: float
    height: float
    rho_squared: float

    def falling(self, angle: float, omega: float, slip: float = 0.0, friction: float = inf) -> FallingBody:
        """The body with B raised by `angle`, turning about A with `omega`, while A slips with `slip` (m/s)."""
        c, s = cos(angle), sin(angle)
        x, y = c * self.a - s * self.height, s * self.a + c * self.height  # of the mass centre from A
        state = PlanarState(x, y, angle, slip - omega * y, omega * x, omega)
        return FallingBody(state, ((-self.a, -self.height), (self.b, -self.height)), 0, self.rho_squared, friction)


def rectangle(length: float, height: float) -> FallingShape:
    """A homogeneous plate on its long or short side."""
    return FallingShape(0.5 * length, 0.5 * length, 0.5 * height, (length * length + height * height) / 12.0)


CRATE: Final = rectangle(1.0, 0.6)
CYLINDER: Final = FallingShape(0.1 * sin(0.7), 0.1 * sin(0.7), 0.1 * cos(0.7), 0.5 * 0.1**2)


def turning(shape: FallingShape, source: Random) -> FallingBody:
    """A fall about A: of a body that was at rest between a twentieth and nine tenths of the way to its balance."""
    balance = atan2(shape.a, shape.height)
    arm = hypot(shape.a, shape.height)
    stiffness = -GRAVITY[1] * arm / (shape.rho_squared + arm * arm)
    rest = balance * source.uniform(0.05, 0.9)
    angle = rest * source.choice((1.0, source.uniform(0.1, 0.95), source.uniform(0.1, 0.95)))
    speed = sqrt(2.0 * stiffness * max(0.0, cos(balance - rest) - cos(balance - angle)))
    return shape.falling(angle, speed if source.random() < 0.1 else -speed)


def of_any_size(source: Random) -> FallingBody:
    """A fall of a plate of 1 mm to 100 m, up to a thousand times as long as high or ten times as high as long."""
    length = 10.0 ** source.uniform(-3.0, 2.0)
    return turning(rectangle(length, length * 10.0 ** source.uniform(-3.0, 1.0)), source)


def leaving_balance(source: Random) -> FallingBody:
    """A crate at rest, leaning from its balance by 1e-4 to 0.1 rad: most of its fall it hardly moves."""
    return CRATE.falling(atan2(CRATE.a, CRATE.height) - 10.0 ** source.uniform(-4.0, -1.0), 0.0)


def slipping(source: Random) -> FallingBody:
    """A crate whose standing edge slips forwards or back."""
    slip = source.choice((-1.0, 1.0)) * source.uniform(1.0, 2.0)
    return CRATE.falling(source.uniform(0.02, 0.2), -source.uniform(0.2, 1.5), slip, SLIPS)


def thrown(source: Random) -> FallingBody:
    """A crate in the air; any of its corners can strike."""
    x, y = CRATE.b, CRATE.height
    vx, vy, omega = source.uniform(-2.0, 2.0), source.uniform(-2.0, 2.0), source.uniform(-6.0, 6.0)
    state = PlanarState(0.0, source.uniform(0.7, 1.5), source.uniform(-pi, pi), vx, vy, omega)
    return FallingBody(state, ((-x, -y), (x, -y), (x, y), (-x, y)), None, CRATE.rho_squared, SLIPS)


REFERENCE: Final = "the motion integrated by scipy to 13 digits"

SCENES: Final[dict[str, tuple[str, str, str, Callable[[Random], FallingBody]]]] = {
    "plate": (
        "Crate on a floor",
        "A crate of 1 m by 0.6 m has been tipped about an edge and falls back.",
        REFERENCE,
        partial(turning, CRATE),
    ),
    "cylinder": (
        "Cylinder between edges",
        "A cylinder of 0.1 m radius rolls over an edge onto the next one, 80 degrees apart.",
        REFERENCE,
        partial(turning, CYLINDER),
    ),
    "extreme": (
        "Extreme plates",
        "Plates of 1 mm to 100 m, from a thousand times as long as high to ten times as high as long.",
        REFERENCE,
        of_any_size,
    ),
    "balance": ("Out of balance", "A crate is released 1e-4 to 0.1 rad from its balance.", REFERENCE, leaving_balance),
    "sliding": (
        "Sliding stance",
        "The edge on which a crate stands slips while the crate falls, friction 0.2.",
        REFERENCE,
        slipping,
    ),
    "flight": ("Flight", "A crate is thrown, turning; the first of its corners strikes.", REFERENCE, thrown),
}
"""Title, description, reference, and what draws a body."""


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
        alpha, slide = g * x / (fall.rho_squared + x * x + y * y), 0.0
    else:
        drag = fall.friction if vx + omega * y > 0.0 else -fall.friction
        lever = x + drag * y
        alpha = (square * y + g) * lever / (fall.rho_squared + x * lever)
        slide = alpha * y + square * x - drag * (alpha * x - square * y - g)
    return slide - alpha * y - square * x, alpha * x - square * y, alpha


def gap(fall: FallingBody, state: Any) -> float:
    """Height of the lowest point that does not stand (m)."""
    c, s = cos(state[2]), sin(state[2])
    others = (point for index, point in enumerate(fall.points) if index != fall.stance)
    return float(state[1]) + min(s * x + c * y for x, y in others)


def integrated(fall: FallingBody, tolerance: float) -> PredictedTouchdown | None:
    """scipy's DOP853 up to the event that a point touches."""

    def rates(_: float, state: Any) -> Any:
        return (*state[3:], *accelerations(fall, state))

    def touches(_: float, state: Any) -> float:
        return gap(fall, state)

    touches.terminal, touches.direction = True, -1.0  # type: ignore[attr-defined]
    found = solve_ivp(rates, (0.0, HORIZON), fall.state, "DOP853", rtol=tolerance, atol=tolerance, events=touches)
    if not found.t_events[0].size:
        return None
    return PredictedTouchdown(float(found.t_events[0][0]), Twist(*found.y_events[0][0][3:].tolist()))


def reference_of(fall: FallingBody) -> PredictedTouchdown:
    """The touchdown to 13 digits."""
    found = integrated(fall, FINEST)
    assert found is not None
    return found


def extrapolated(fall: FallingBody, accelerated: bool) -> PredictedTouchdown | None:
    """The first root of the parabolas of the gaps, with their rates of now and, if so, their accelerations of now."""
    state = fall.state
    ax, ay, alpha = accelerations(fall, state) if accelerated else (0.0, 0.0, 0.0)
    c, s, omega = cos(state.angle), sin(state.angle), state.omega
    first = inf
    for index, (px, py) in enumerate(fall.points):
        if index != fall.stance:
            x, y = c * px - s * py, s * px + c * py
            bend = ay + alpha * x - omega * omega * y if accelerated else 0.0
            first = min(first, _descent(state.y + y, state.vy + omega * x, bend))
    if first == inf:
        return None
    return PredictedTouchdown(first, Twist(state.vx + ax * first, state.vy + ay * first, omega + alpha * first))


def _descent(height: float, rate: float, acceleration: float) -> float:
    """First t > 0 at which height + rate t + acceleration t^2 / 2 is zero, inf if there is none."""
    square = rate * rate - 2.0 * acceleration * height
    down = sqrt(square) - rate if square >= 0.0 else 0.0
    return 2.0 * height / down if down > 0.0 else inf


def own(fall: FallingBody) -> PredictedTouchdown | None:
    """The program's own predictor."""
    end = next_touchdown(*fall, HORIZON, ACCURACY)
    return PredictedTouchdown(end.time, Twist(end.state.vx, end.state.vy, end.state.omega)) if end.point >= 0 else None


FAMILIES: Final = {
    "constant twist": "The gap of the new contact goes on closing at the rate that it has now.",
    "constant acceleration": "Gap and twist go on with the accelerations that they have now.",
    "DOP853": "scipy's solve_ivp of order 8 with adaptive steps; its event function is the gap.",
    "next_touchdown": "What the node uses: closed forms where the stance sticks, steps within a tolerance where it "
    "slips, safe root finding in flight.",
}
"""What the methods do."""

METHODS: Final = [
    Method("constant twist", "constant twist", "", lambda fall: extrapolated(fall, False)),
    Method("constant acceleration", "constant acceleration", "", lambda fall: extrapolated(fall, True)),
    *(
        Method("DOP853", "scipy DOP853 with an event", f"rtol = {rtol:g}", partial(integrated, tolerance=rtol))
        for rtol in (1e-3, 1e-6, 1e-9)
    ),
    Method("next_touchdown", "next_touchdown", f"tolerance = {ACCURACY:g}", own),
]
USED: Final = ("next_touchdown", f"tolerance = {ACCURACY:g}")
"""What the node uses."""


def errors_of(fall: FallingBody, answer: PredictedTouchdown, reference: PredictedTouchdown) -> tuple[float, float]:
    """Error of the time, relative to it, and of the twist at the touchdown, relative to its size."""
    (vx, vy, omega), rho = reference.twist, sqrt(fall.rho_squared)
    wx, wy, turning = answer.twist
    apart = hypot(wx - vx, wy - vy, rho * (turning - omega))
    return abs(answer.time - reference.time) / reference.time, apart / hypot(vx, vy, rho * omega)
