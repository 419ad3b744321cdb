"""Bodies right before an impact, of many kinds: what the methods for impacts are asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple
from zlib import crc32

import numpy as np

from ...mechanics import bodies
from ...mechanics.random_problems import Draw, Problems, problems_of
from ...mechanics.transverse import Transverse
from ...mechanics.types import Mode, Twist, TwoPointBody
from .rows import IMPACT, Scene

SEED = 4

Given = dict[str, Any]
"""Arguments of a closed form."""


class Strike(NamedTuple):
    """What the laws are asked: a body and its twist right before the impact.

    `shape` is the name of the closed form that the paper has for it and `given` its arguments; "" where there is none.
    `across` is the motion across the impact plane. Where sizes and speeds are `ordinary` a time step means something.
    """

    body: TwoPointBody
    twist: Twist
    shape: str = ""
    given: Given = {}  # noqa: RUF012  # never changed
    across: Transverse | None = None
    ordinary: bool = True


class After(NamedTuple):
    """Right after an impact: the twist of the mass centre, and the mode, None where a method tells none."""

    twist: Twist
    mode: Mode | None = None


def one_of(value: Any, index: int) -> Any:
    """The element of arrays in nested tuples, as floats."""
    if isinstance(value, tuple):
        parts = [one_of(part, index) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return float(value[index]) if isinstance(value, np.ndarray) else value


def turning(shape: str, given: Given, omega: Any) -> list[Strike]:
    """Bodies of the paper, which turn about A at rest: no restitution, one friction."""
    body: TwoPointBody = getattr(bodies, shape)(**given)
    arguments = {**given, "omega": omega}
    return [
        Strike(
            one_of(body, i),
            one_of(body, i).turning(float(omega[i])),
            shape,
            {name: one_of(value, i) for name, value in arguments.items()},
        )
        for i in range(len(omega))
    ]


def rods(draw: Draw) -> list[Strike]:
    length = draw.decades(-1.0, 0.5)
    given = {
        "length": length,
        "thickness": length * draw.decades(-2.0, -1.0),
        "a": length * draw.uniform(0.05, 0.5),
        "b": length * draw.uniform(0.05, 0.5),
        "mass": draw.decades(-1.0, 1.0),
        "friction": draw.uniform(0.0, 1.0),
    }
    return turning("rod", given, -draw.decades(-1.0, 1.0))


def plates(draw: Draw) -> list[Strike]:
    length = draw.decades(-1.0, 0.5)
    height = length * draw.decades(-0.7, 0.7)
    given = {"length": length, "height": height, "mass": draw.decades(-1.0, 1.0), "friction": draw.uniform(0.0, 1.5)}
    return turning("plate", given, -draw.decades(-1.0, 1.0))


def cylinders(draw: Draw) -> list[Strike]:
    given = {
        "radius": draw.decades(-1.0, 0.5),
        "gamma": draw.uniform(0.05, 1.4),
        "mass": draw.decades(-1.0, 1.0),
        "friction": draw.uniform(0.0, 1.0),
    }
    return turning("cylinder", given, -draw.decades(-1.0, 1.0))


def slipping(draw: Draw, least: float, most: float) -> list[Strike]:
    """Plates with 10**least to 10**most for height over length; half of them slip at A, half of them bounce at B."""
    length = draw.decades(-1.0, 0.5)
    body = bodies.plate(
        length,
        length * draw.decades(least, most),
        draw.decades(-1.0, 1.0),
        draw.uniform(0.0, 1.0),
        restitution=draw.pick(0.0, 0.0, 0.125, 0.5),
    )
    twist = body.turning(-draw.decades(-1.0, 1.0))
    slip = draw.chance(0.5) * draw.speed() * twist.omega * length
    twist = twist._replace(vx=twist.vx + slip)
    return [Strike(one_of(body, i), one_of(twist, i)) for i in range(draw.count)]


def of_kinds(draw: Draw, *kinds: str) -> list[Strike]:
    """Problems that the laws are soaked with, the kinds in equal parts."""
    sets: list[Problems] = [problems_of(kind, draw.source, draw.count) for kind in kinds]
    return [
        Strike(one_of(sets[i % len(sets)].body, i), one_of(sets[i % len(sets)].twist, i), ordinary=False)
        for i in range(draw.count)
    ]


def crossing(draw: Draw) -> list[Strike]:
    """Cubes that strike with an edge and slip along it, too, as tossed ones do."""
    side = draw.uniform(0.05, 0.2)
    friction = draw.uniform(0.05, 0.5)
    body = bodies.plate(side, side, draw.uniform(0.2, 2.0), friction, restitution=draw.pick(0.0, 0.125, 0.3))
    twist = body.turning(-draw.uniform(2.0, 20.0))
    slip, across = (draw.sign() * draw.uniform(0.05, 1.0) * twist.omega * side for _ in range(2))
    twist = twist._replace(vx=twist.vx + slip)
    return [Strike(one_of(body, i), one_of(twist, i), across=Transverse(float(across[i]))) for i in range(draw.count)]


PATH = "the impulse-path law in 40 digits"

SCENES: dict[str, tuple[str, str, str, Callable[[Draw], list[Strike]]]] = {
    "rod": (
        "Rod over two supports",
        "Rods of many sizes that turn about one support, plastic, friction to 1.",
        PATH,
        rods,
    ),
    "plate": (
        "Crate on a floor",
        "Plates with heights from a fifth to five times the length that turn about an edge, plastic, friction to 1.5.",
        PATH,
        plates,
    ),
    "cylinder": (
        "Cylinder between edges",
        "Cylinders that roll from one edge onto another, 6 to 160 degrees apart, plastic, friction to 1.",
        PATH,
        cylinders,
    ),
    "slender": (
        "Slender plates",
        "Plates a hundred to a thousand times as long as high; half of them slip, half of them bounce.",
        PATH,
        lambda draw: slipping(draw, -3.0, -2.0),
    ),
    "squat": (
        "Tall blocks",
        "Blocks three to ten times as high as long; half of them slip, half of them bounce.",
        PATH,
        lambda draw: slipping(draw, 0.5, 1.0),
    ),
    "stiff": (
        "Stiff set",
        "Lengths and frictions over eight decades, or contacts nearly at one place: a rounding decides much.",
        PATH,
        lambda draw: of_kinds(draw, "slender", "close"),
    ),
    "extreme": (
        "Extreme set",
        "Every length, mass and speed over twelve decades, on supports at rest or moving apart.",
        PATH,
        lambda draw: of_kinds(draw, "extreme", "extreme-apart"),
    ),
    "across": (
        "Slip across the plane",
        "Cubes that also slip along the edge that they strike with, as tossed ones do.",
        "the path law with both slips at its finest tolerance, 1e-7: no exact solution is known",
        crossing,
    ),
}
"""Title, description, reference, and what draws the problems."""


def scenes() -> Iterator[Scene]:
    for name, (title, description, reference, _) in SCENES.items():
        yield Scene(name, IMPACT, title, description, reference)


def strikes(name: str, count: int) -> list[Strike]:
    """`count` problems of a scene, always the same ones."""
    return SCENES[name][3](Draw(np.random.default_rng((SEED, crc32(name.encode()))), count))


def joined(problems: Sequence[Strike]) -> tuple[TwoPointBody, Twist]:
    """Problems as one whose numbers are arrays."""
    return together([problem.body for problem in problems]), together([problem.twist for problem in problems])


def together(values: Sequence[Any]) -> Any:
    """Values of one form, tuples in tuples, as one of arrays; what is None in one is None in all."""
    first = values[0]
    if isinstance(first, tuple):
        parts = [together(column) for column in zip(*values, strict=True)]
        return type(first)(*parts) if hasattr(first, "_fields") else tuple(parts)
    return None if first is None else np.array(values)
