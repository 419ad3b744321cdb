"""Bodies on their way to a touchdown, of many kinds: what the methods for touchdowns are asked."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from random import Random
from typing import NamedTuple

from ...mechanics.motion import MotionKind, PlanarState
from ...mechanics.types import Twist, Vector
from .rows import TOUCHDOWN, Scene

GRAVITY = (0.0, -9.81)

STICKS = 5.0
"""Friction of a stance that sticks all the way: falls in which it would not are left out."""

SLIPS = 0.2
"""Friction of a stance that slips all the way."""

SEED = 4


class Falling(NamedTuple):
    """What `next_touchdown` is asked: state, points and stance, rho^2 in m^2, friction, gravity in m/s^2."""

    state: PlanarState
    points: tuple[Vector, ...]
    stance: int | None
    rho_squared: float
    friction: float
    gravity: Vector = GRAVITY


class Landing(NamedTuple):
    """A touchdown: the time until then in s, and the twist of the mass centre right before it strikes."""

    time: float
    twist: Twist


class Figure(NamedTuple):
    """A body seen at its touchdown: A lies `a` behind, B `b` ahead of and both `height` below the mass centre (m)."""

    a: float
    b: float
    height: float
    rho_squared: float

    @property
    def points(self) -> tuple[Vector, Vector]:
        return (-self.a, -self.height), (self.b, -self.height)


def rectangle(length: float, height: float) -> Figure:
    """A homogeneous plate on its long or short side."""
    return Figure(0.5 * length, 0.5 * length, 0.5 * height, (length * length + height * height) / 12.0)


ROD = Figure(0.1, 0.1, 0.005, 0.4**2 / 12.0)
CRATE = rectangle(1.0, 0.6)
CYLINDER = Figure(0.1 * math.sin(0.7), 0.1 * math.sin(0.7), 0.1 * math.cos(0.7), 0.5 * 0.1**2)


def standing(figure: Figure, angle: float, omega: float, slip: float = 0.0) -> PlanarState:
    """The body with B raised by `angle`, turning about A with `omega`, while A slips with `slip` (m/s)."""
    c, s = math.cos(angle), math.sin(angle)
    x, y = c * figure.a - s * figure.height, s * figure.a + c * figure.height  # of the mass centre from A
    return PlanarState(x, y, angle, slip - omega * y, omega * x, omega)


def turning(figure: Figure, friction: float = STICKS) -> Callable[[Random, int], Falling]:
    """Falls of a body about A: one in eight just released, one in eight still rising, the others somewhere on the way.

    It was at rest in front of its balance, between a twentieth and nine tenths of the way there.
    """
    balance = math.atan2(figure.a, figure.height)
    stiffness = -GRAVITY[1] * math.hypot(figure.a, figure.height)
    stiffness /= figure.rho_squared + figure.a**2 + figure.height**2

    def draw(source: Random, number: int) -> Falling:
        rest = balance * source.uniform(0.05, 0.9)
        part = 1.0 if number % 8 == 0 else source.uniform(0.1, 0.95)
        angle = part * rest
        speed = math.sqrt(2.0 * stiffness * max(0.0, math.cos(balance - rest) - math.cos(balance - angle)))
        omega = speed if number % 8 == 1 else -speed
        return Falling(standing(figure, angle, omega), figure.points, 0, figure.rho_squared, friction)

    return draw


def leaving_balance(source: Random, number: int) -> Falling:
    """A crate at rest, leaning from its balance by 1e-6 to 0.1 rad: most of its fall it hardly moves."""
    angle = math.atan2(CRATE.a, CRATE.height) - 10.0 ** source.uniform(-6.0, -1.0)
    return Falling(standing(CRATE, angle, 0.0), CRATE.points, 0, CRATE.rho_squared, STICKS)


def slipping(source: Random, number: int) -> Falling:
    """A crate whose standing edge slips forwards or back."""
    angle, omega = source.uniform(0.02, 0.4), -source.uniform(0.2, 1.5)
    state = standing(CRATE, angle, omega, source.choice((-1.0, 1.0)) * source.uniform(0.5, 2.0))
    return Falling(state, CRATE.points, 0, CRATE.rho_squared, SLIPS)


def thrown(source: Random, number: int) -> Falling:
    """A crate in the air; any of its corners can strike."""
    x, y = CRATE.b, CRATE.height
    corners = ((-x, -y), (x, -y), (x, y), (-x, y))
    state = PlanarState(
        0.0,
        source.uniform(0.7, 1.5),
        source.uniform(-math.pi, math.pi),
        source.uniform(-2.0, 2.0),
        source.uniform(-2.0, 2.0),
        source.uniform(-6.0, 6.0),
    )
    return Falling(state, corners, None, CRATE.rho_squared, SLIPS)


QUADRATURE = "quadrature of the energy integral in 40 digits"

SCENES: dict[str, tuple[str, str, str, Callable[[Random, int], Falling], MotionKind]] = {
    "rod": (
        "Rod over two supports",
        "A rod of 0.4 m turns about one of two supports, 0.1 m from its middle, and falls onto the other.",
        QUADRATURE,
        turning(ROD),
        MotionKind.TURNING,
    ),
    "plate": (
        "Crate on a floor",
        "A crate of 1 m by 0.6 m has been tipped about an edge and falls back.",
        QUADRATURE,
        turning(CRATE),
        MotionKind.TURNING,
    ),
    "cylinder": (
        "Cylinder between edges",
        "A cylinder of 0.1 m radius rolls over an edge onto the next one, 80 degrees apart.",
        QUADRATURE,
        turning(CYLINDER),
        MotionKind.TURNING,
    ),
    "slender": (
        "Slender plate",
        "A plate a hundred times as long as high falls flat.",
        QUADRATURE,
        turning(rectangle(1.0, 0.01)),
        MotionKind.TURNING,
    ),
    "squat": (
        "Tall block",
        "A block eight times as high as long rocks on its narrow foot.",
        QUADRATURE,
        turning(rectangle(0.2, 1.6)),
        MotionKind.TURNING,
    ),
    "balance": (
        "Out of balance",
        "A crate is released 1e-6 to 0.1 rad from its balance.",
        QUADRATURE,
        leaving_balance,
        MotionKind.TURNING,
    ),
    "sliding": (
        "Sliding stance",
        "The edge on which a crate stands slips while the crate falls, friction 0.2.",
        "extrapolation in 40 digits",
        slipping,
        MotionKind.SLIDING,
    ),
    "flight": (
        "Flight",
        "A crate is thrown, turning; the first of its corners strikes.",
        "root of the corner's path in 40 digits",
        thrown,
        MotionKind.FLIGHT,
    ),
}
"""Title, description, reference, what draws a problem, and the motion that leads to the touchdown."""


def scenes() -> Iterator[Scene]:
    for name, (title, description, reference, _, _) in SCENES.items():
        yield Scene(name, TOUCHDOWN, title, description, reference)
