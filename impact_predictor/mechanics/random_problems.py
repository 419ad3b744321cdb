"""Random impacts of many kinds, as arrays: what the laws are soaked with."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from .types import Contact, Twist, TwoPointBody

Drawn = Any
"""An array (count,) in the place of a number."""

CHUNK = 100_000
"""Problems that are made at a time."""


class Problems(NamedTuple):
    """Problems of one kind: a body and a twist in SI units whose fields are arrays (count,)."""

    kind: str
    body: TwoPointBody
    twist: Twist


class ContactPair(NamedTuple):
    """Square of the radius of gyration; places of A and B from the mass centre; angles of their normals from y."""

    square: Drawn
    old: tuple[Drawn, Drawn]
    new: tuple[Drawn, Drawn]
    old_angle: Drawn = 0.0
    new_angle: Drawn = 0.0


class Draw:
    """Draws arrays of `count` numbers from a source."""

    def __init__(self, source: np.random.Generator, count: int) -> None:
        self.source, self.count = source, count

    def uniform(self, low: float, high: float) -> Drawn:
        return self.source.uniform(low, high, self.count)

    def decades(self, low: float, high: float) -> Drawn:
        """Drawn between 10**low and 10**high, whose logarithms are uniform."""
        return np.asarray(10.0 ** self.uniform(low, high))

    def chance(self, part: float) -> Drawn:
        """1 in this part of the cases, else 0."""
        return np.asarray(self.source.random(self.count) < part, np.float64)

    def pick(self, *values: float) -> Drawn:
        return self.source.choice(values, self.count)

    def wild(self) -> Drawn:
        """Drawn of both signs over twelve decades, and zeros."""
        return self.decades(-6.0, 6.0) * (2.0 * self.chance(0.5) - 1.0) * self.chance(0.9)


def plate(draw: Draw) -> ContactPair:
    """A rectangle on a floor."""
    a = draw.decades(-1.0, 1.0)
    height = a * draw.decades(-2.0, 1.0)
    return ContactPair((a * a + height * height) / 3.0, (-a, -height), (a, -height))


def cylinder(draw: Draw) -> ContactPair:
    """A cylinder between two edges."""
    radius, old, new = draw.decades(-1.0, 1.0), -draw.uniform(0.01, 1.56), draw.uniform(0.01, 1.56)
    old_at, new_at = ((radius * np.sin(angle), -radius * np.cos(angle)) for angle in (old, new))
    return ContactPair(radius * radius * draw.uniform(0.1, 1.0), old_at, new_at, old_angle=old, new_angle=new)


def floor(draw: Draw) -> ContactPair:
    """Any body on a floor."""
    a, b, height = (draw.uniform(0.02, 2.0) for _ in range(3))
    return ContactPair(draw.uniform(0.01, 2.0), (-a, -height), (b, -height))


def wedge(draw: Draw) -> ContactPair:
    """A on a floor, B anywhere ahead on a slope."""
    flat = floor(draw)
    b, _ = flat.new
    return flat._replace(new=(b, draw.uniform(-2.0, 0.5)), new_angle=draw.uniform(-1.5, 1.5))


def tilted(draw: Draw) -> ContactPair:
    """Two contacts anywhere, with any normals."""
    return wedge(draw)._replace(old_angle=draw.uniform(-np.pi, np.pi), new_angle=draw.uniform(-np.pi, np.pi))


def slender(draw: Draw) -> ContactPair:
    """On a floor or a slope, lengths over eight decades."""
    square, a, b, height, drop = (draw.decades(-4.0, 4.0) for _ in range(5))
    sloped = draw.chance(0.5)
    drop = np.where(sloped > 0.0, drop, height)
    return ContactPair(square, (-a, -height), (b, -drop), new_angle=sloped * draw.uniform(-1.5, 1.5))


def extreme(draw: Draw) -> ContactPair:
    """Every length over twelve decades."""
    ax, ay, bx, by = (draw.wild() for _ in range(4))
    old, new = (draw.pick(0.0, 0.0, 1e-9, 0.5, -1.2, np.pi / 2, np.pi) for _ in range(2))
    return ContactPair(draw.decades(-12.0, 12.0), (ax, ay), (bx, by), old_angle=old, new_angle=new)


KINDS: dict[str, tuple[Callable[[Draw], ContactPair], str]] = {
    "plate": (plate, "turns"),
    "cylinder": (cylinder, "turns"),
    "floor": (floor, "slips"),
    "wedge": (wedge, "slips"),
    "tilted": (tilted, "slips"),
    "deck": (tilted, "deck"),
    "apart": (tilted, "apart"),
    "both": (floor, "falls"),
    "one-point": (tilted, "alone"),
    "slender": (slender, "slips"),
    "extreme": (extreme, "slips"),
    "extreme-apart": (extreme, "apart"),
}
"""Kinds of problems: a geometry, and how the body moves. It turns about A; or it may slip on A or leave it, on supports
at rest, on a deck, whose points move as one body, or on supports that move apart; it falls on A; or there is no A."""


def random_problems(seed: int, count: int, chunk: int = CHUNK, done: int = 0) -> Iterator[Problems]:
    """`count` problems in all, without the chunks that are `done`; each is of one kind, and the `KINDS` take turns."""
    kinds = list(KINDS)
    for start in range(done, count, chunk):
        number = start // chunk
        source = np.random.default_rng((seed, number))
        yield problems_of(kinds[number % len(kinds)], source, min(chunk, count - start))


def problems_of(kind: str, source: np.random.Generator, count: int) -> Problems:
    """`count` problems of one of the `KINDS`: B is approached in nearly all, restitution is zero in half of them."""
    draw = Draw(source, count)
    shape, motion = KINDS[kind]
    wide = shape is extreme
    pair = shape(draw)
    (ax, ay), (bx, by) = pair.old, pair.new
    old_normal, new_normal = (
        (-np.sin(turn + 0.0 * ax), np.cos(turn + 0.0 * ax)) for turn in (pair.old_angle, pair.new_angle)
    )
    mass = draw.decades(-6.0, 6.0) if wide else draw.decades(-1.0, 1.0)

    def speed() -> Drawn:
        return draw.wild() if wide else draw.uniform(-2.0, 2.0)

    # It turns about A and slips on it, in the sense in which it approaches B.
    turns = motion == "turns"
    omega, slip = speed(), speed() * draw.chance(0.0 if turns else 0.6)
    vx, vy = omega * ay + slip * old_normal[1], -omega * ax - slip * old_normal[0]
    approach = new_normal[0] * (vx - omega * by) + new_normal[1] * (vy + omega * bx)
    sense = np.where(approach > 0.0, -1.0, 1.0)
    lift = -np.abs(speed()) if motion == "falls" else np.abs(speed()) * draw.chance(0.0 if turns else 0.1)
    vx, vy, omega = sense * vx + lift * old_normal[0], sense * vy + lift * old_normal[1], sense * omega

    old_support = new_support = (0.0 * vx, 0.0 * vx)
    ux, uy, turning = speed(), speed(), speed()
    if motion == "apart":
        old_support, new_support = (ux, uy), (turning, speed())
        vx, vy = vx + ux, vy + uy
    elif motion == "deck":
        old_support, new_support = ((ux - turning * y, uy + turning * x) for x, y in ((ax, ay), (bx, by)))
        vx, vy, omega = vx + ux, vy + uy, omega + turning
    # Friction at A and B, none in some cases and often the same at both: up to 4, or over decades.
    if shape in (slender, extreme):
        old_friction, new_friction = (draw.decades(-4.0, 4.0) * draw.chance(0.9) for _ in range(2))
    else:
        old_friction, new_friction = (
            draw.uniform(0.0, 1.0) * draw.pick(0.0, 0.5, 1.0, 1.0, 2.0, 4.0) for _ in range(2)
        )
    new_friction = np.where(draw.chance(0.5), old_friction, new_friction)
    old = Contact(ax, ay, old_friction, old_normal, draw.chance(0.1) * 0.5, old_support)
    new = Contact(bx, by, new_friction, new_normal, draw.chance(0.5) * draw.pick(0.125, 0.5, 1.0), new_support)
    return Problems(
        kind, TwoPointBody(mass, mass * pair.square, None if motion == "alone" else old, new), Twist(vx, vy, omega)
    )
