"""The impact: bodies right before it, methods that tell what follows, and what they are held against.

That the path law itself is right, which other bodies than the paper's are held against, is shown by exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import hypot, sqrt
from random import Random
from typing import Any, Final, NamedTuple

import numpy as np

from ...mechanics import bodies, closed_forms
from ...mechanics.impact import LAWS, solve_impact
from ...mechanics.invariants import problem_at
from ...mechanics.random_problems import problems_of
from ...mechanics.types import Mode, Twist, TwoPointBody
from . import IMPACT, AccuracyScene, Methods


class Aftermath(NamedTuple):
    """Right after an impact: the twist of the mass centre, and the mode, None where a method tells none."""

    twist: Twist
    mode: Mode | None = None


class Struck(NamedTuple):
    """A body and its twist right before the impact, and what follows if known."""

    body: TwoPointBody
    twist: Twist
    known: Aftermath | None = None


def of_paper(source: Random) -> Struck:
    """A plastic rod, plate or cylinder that turns about A at rest, ordinary or stiff, with its closed form."""

    def decades(low: float, high: float) -> float:
        return float(10.0 ** source.uniform(low, high))

    size, a, b = decades(-6.0, 6.0), 0.5 * decades(-6.0, 0.0), 0.5 * decades(-6.0, 0.0)
    shape, given = source.choice(
        (
            ("rod", {"length": size, "thickness": size * decades(-8.0, -1.0), "a": a * size, "b": b * size}),
            ("plate", {"length": size, "height": size * decades(-8.0, 3.0)}),
            ("cylinder", {"radius": size, "gamma": 1.4 * decades(-6.0, 0.0)}),
        )
    )
    given |= {"mass": decades(-1.0, 1.0), "friction": decades(-3.0, 3.0)}
    body, omega = getattr(bodies, shape)(**given), -decades(-1.0, 1.0)
    right = getattr(closed_forms, shape)(**given, omega=omega)
    return Struck(body, body.turning(omega), known=Aftermath(Twist(*right.twist.tolist()), Mode(int(right.mode))))


def drawn(source: Random, kind: str) -> Struck:
    """One of the `random_problems`."""
    _, body, twist = problems_of(kind, np.random.default_rng(source.getrandbits(32)), 1)
    return Struck(problem_at(body, 0), problem_at(twist, 0))


FORMULA: Final = "the paper's closed forms, which share no code with the laws"
LONG: Final = "the path law with the longest floats of the machine: its own error is rounding"
PAPER: Final = "Rods, plates and cylinders of 1e-6 to 1e6 m, to 1e8 times as long as high, friction of 0.001 to 1000."
SCENES: Final[dict[AccuracyScene, Callable[[Random], Struck]]] = {
    AccuracyScene(name, IMPACT, title, description, reference): draw
    for name, title, description, reference, draw in (
        ("paper", "Bodies of the paper, also stiff ones", PAPER, FORMULA, of_paper),
        ("floor", "Any body on a floor", "Half of them slip at A, half bounce.", LONG, partial(drawn, kind="floor")),
        ("slender", "Slender bodies", "Lengths, friction over 8 decades.", LONG, partial(drawn, kind="slender")),
    )
}
"""What the laws are compared on, and what draws a body."""


def reference_of(strike: Struck) -> Aftermath:
    if strike.known is not None:
        return strike.known
    return law(strike._replace(body=with_long_floats(strike.body), twist=with_long_floats(strike.twist)), "path")


def with_long_floats(value: Any) -> Any:
    """Nested tuples of numbers with more digits than a double has, where the machine has such numbers."""
    if isinstance(value, tuple):
        parts = [with_long_floats(part) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return value if value is None else np.longdouble(value)


def law(strike: Struck, name: str) -> Aftermath:
    """One impact by one of the laws."""
    outcome = solve_impact(strike.body, strike.twist, name)
    return Aftermath(outcome.twist, outcome.mode)


def no_slip(strike: Struck) -> Aftermath:
    """The angular momentum about the new contact stays, and the body turns about it (Housner)."""
    (mass, inertia, _, new), (vx, vy, omega) = strike.body, strike.twist
    after = inertia * omega + mass * (new.y * vx - new.x * vy)
    after /= inertia + mass * (new.x * new.x + new.y * new.y)
    return Aftermath(Twist(after * new.y, -after * new.x, after), Mode.PIVOT)


def errors_of(strike: Struck, after: Aftermath, right: Aftermath) -> dict[str, float]:
    """Error of the twist after an impact, relative to the size of the one before by kinetic energy, and of the mode."""
    rho = sqrt(strike.body.inertia / strike.body.mass)
    apart = [one - other for one, other in zip(after.twist, right.twist, strict=True)]
    error = hypot(apart[0], apart[1], rho * apart[2]) / hypot(*strike.twist[:2], rho * strike.twist.omega)
    return {"twist_error": error} | ({} if after.mode is None else {"wrong_modes": after.mode != right.mode})


USED: Final = ("path law", "")
METHODS: Final[Methods] = {
    **{(f"{name} law", ""): partial(law, name=name) for name in LAWS},
    ("no slip", ""): no_slip,
}
