"""How the twist after an impact answers small changes of what it follows from: exact derivatives."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..native import as_python
from .impact import NOWHERE, approach, number_of, see
from .impact.answer import answer
from .types import Contact, Flag, Twist, TwoPointBody

Triple = tuple[float, float, float]
TwistMatrix = tuple[Triple, Triple, Triple]

STEP = 1e-9
"""Part of an input, or of the contact speeds, within which a change of the contact states counts as a border."""

INPUTS = ("friction_old", "friction_new", "restitution", "vx", "vy", "omega")

Parts = NDArray[np.float64]

NONE: Parts = np.zeros(len(INPUTS))

Inputs = tuple[Any, ...]
"""Values of the INPUTS, or Duals of them."""

NO_CHANGE: Triple = (0.0, 0.0, 0.0)

FREE: TwistMatrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

INVALID_INPUT, NO_SOLUTION = int(Flag.INVALID_INPUT), int(Flag.NO_SOLUTION)


class Sensitivity(NamedTuple):
    """Derivatives of the twist (vx, vy, omega) after an impact.

    By the friction of the old and of the new contact and by the restitution of the new one, each (3,) in m/s, m/s and
    rad/s per 1; by the twist before as a 3 x 3 matrix with a row for each part of the twist after. `one_sided` names
    the INPUTS at a border, where the contact states change: there the derivative is that towards greater values, or
    towards smaller ones where there are no greater ones.
    """

    friction_old: Triple
    friction_new: Triple
    restitution: Triple
    twist: TwistMatrix
    one_sided: tuple[str, ...]


def sensitivity(body: TwoPointBody, twist: Twist, law: str = "path", restitution: str = "poisson") -> Sensitivity:
    """Derivatives of the twist after `solve_impact`, exact up to rounding; the arguments are the same.

    The old contact stays as it is, at rest or slipping along its support: of a change of the twist before only the part
    counts that leaves it so (`allowed_changes`). A body that turns about A at rest has one such freedom, omega. Where
    no impact happens, or none can be solved, the twist after is the one before. An unknown law or rule raises
    ValueError.

    The law code is differentiated as it runs (see `Dual`). The outcome is a piecewise rational function, with
    one-sided derivatives at its borders, which are taken a STEP away from them.
    """
    number = number_of(law, restitution)
    old, new = body.old or NOWHERE, body.new
    inputs = (old.friction, new.friction, new.restitution, *twist)
    states, flags = states_at(body, inputs, number)
    if flags & (INVALID_INPUT | NO_SOLUTION) or not states:
        return Sensitivity(NO_CHANGE, NO_CHANGE, NO_CHANGE, FREE, ())
    directions = np.eye(len(INPUTS))
    directions[3:, 3:] = np.transpose(allowed_changes(body, twist))
    columns = derivatives(body, inputs, directions, number)
    one_sided = []
    for i, (direction, step) in enumerate(zip(directions, steps_of(body, inputs), strict=True)):
        if not direction.any() or (i == 0 and body.old is None):
            continue
        ways = list(zip(inputs, direction.tolist(), strict=True))
        more, less = (tuple([value + change * part for value, part in ways]) for change in (step, -step))
        (above, flags_above), (below, flags_below) = states_at(body, more, number), states_at(body, less, number)
        if flags_above & flags_below & INVALID_INPUT:
            continue  # so near to the mass centre is the contact that no finite turn moves it
        if not states == above == below or (flags_above | flags_below) & INVALID_INPUT:
            one_sided.append(INPUTS[i])
        side, there = (less, below) if flags_above & INVALID_INPUT else (more, above)
        # A contact velocity of zero would count as zero whatever the change.
        if there != states or rests(body, side) != rests(body, inputs):
            columns[i] = derivatives(body, side, directions, number)[i]
    friction_old, friction_new, bounce, vx, vy, omega = columns
    first, second, third = zip(vx, vy, omega, strict=True)
    return Sensitivity(friction_old, friction_new, bounce, (first, second, third), tuple(one_sided))


def allowed_changes(body: TwoPointBody, twist: Twist) -> TwistMatrix:
    """The part of any change of a twist that leaves a resting old contact at rest, as the matrix that gives it.

    A closed contact has no normal velocity, and one that does not slip no velocity at all; what a change would give it
    is taken back by a translation, so that the omega of the change stays.
    """
    if body.old is None:
        return FREE
    _, normal, tangential, _, nx, ny, _, _ = see(body.old, twist)
    if normal != 0.0:
        return FREE
    x, y = body.old.x, body.old.y
    if tangential == 0.0:
        return (0.0, 0.0, y), (0.0, 0.0, -x), (0.0, 0.0, 1.0)
    lever = nx * y - ny * x  # the normal velocity at the contact is nx vx + ny vy - lever omega
    return (1.0 - nx * nx, -nx * ny, nx * lever), (-nx * ny, 1.0 - ny * ny, ny * lever), (0.0, 0.0, 1.0)


def steps_of(body: TwoPointBody, inputs: Inputs) -> tuple[float, ...]:
    """How far each input is moved to look for a border."""
    friction_old, friction_new, _, vx, vy, omega = inputs
    speed = reach = 0.0
    for contact in (body.old, body.new):
        if contact is not None:
            normal, tangential = approach(contact, Twist(vx, vy, omega))
            speed += abs(normal) + abs(tangential)
            reach += abs(contact.x) + abs(contact.y)
    turn = speed / reach if reach > 0.0 else abs(omega) + speed
    return tuple([STEP * size for size in (1.0 + friction_old, 1.0 + friction_new, 1.0, speed, speed, turn)])


def rests(body: TwoPointBody, inputs: Inputs) -> list[tuple[bool, bool]]:
    """Whether each contact has no normal and no tangential velocity before the impact."""
    approaches = [approach(contact, Twist(*inputs[3:])) for contact in (body.old or NOWHERE, body.new)]
    return [(normal == 0.0, tangential == 0.0) for normal, tangential in approaches]


def problem_at(body: TwoPointBody, inputs: Inputs, law: int) -> tuple[float, float, bool, Contact, Contact, Twist, int]:
    """What `answer` is asked about a body with other INPUTS."""
    friction_old, friction_new, restitution, vx, vy, omega = inputs
    old = (body.old or NOWHERE)._replace(friction=friction_old)
    new = body.new._replace(friction=friction_new, restitution=restitution)
    return body.mass, body.inertia, body.old is not None, old, new, Twist(vx, vy, omega), law


def states_at(body: TwoPointBody, inputs: Inputs, law: int) -> tuple[int, int]:
    """The contact states along the impact, none without one, and the bits of `Flag`."""
    _, _, _, _, _, _, states, flags, _, _, _ = answer(*problem_at(body, inputs, law))
    return states, flags


def derivatives(body: TwoPointBody, inputs: Inputs, directions: Parts, law: int) -> list[Triple]:
    """Derivatives of the twist after the impact along each of the directions."""
    duals = tuple(map(Dual, inputs, directions.T))
    with np.errstate(all="ignore"):
        _, after, *_ = dual_answer()(*problem_at(body, duals, law))
    vx, vy, omega = (part.parts.tolist() for part in after)
    return list(zip(vx, vy, omega, strict=True))


class Dual:
    """A value and its derivatives (`parts`, an array) by the inputs.

    The law code (see `impact.contacts`) takes it for any other number and compares its value; so one impact of Duals
    gives the exact derivatives of its outcome, on the branch that it takes.
    """

    __slots__ = ("parts", "value")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: float, parts: Parts) -> None:
        self.value, self.parts = value, parts

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.parts)

    def __add__(self, other: Dual | float) -> Dual:
        value, parts = parted(other)
        return Dual(self.value + value, self.parts + parts)

    __radd__ = __add__

    def __sub__(self, other: Dual | float) -> Dual:
        value, parts = parted(other)
        return Dual(self.value - value, self.parts - parts)

    def __rsub__(self, other: float) -> Dual:
        return Dual(other - self.value, -self.parts)

    def __mul__(self, other: Dual | float) -> Dual:
        value, parts = parted(other)
        return Dual(self.value * value, self.parts * value + self.value * parts)

    __rmul__ = __mul__

    def __truediv__(self, other: Dual | float) -> Dual:
        value, parts = parted(other)
        ratio = self.value / value
        return Dual(ratio, (self.parts - ratio * parts) / value)

    def __rtruediv__(self, other: float) -> Dual:
        ratio = other / self.value
        return Dual(ratio, -ratio * self.parts / self.value)

    def __abs__(self) -> Dual:
        return -self if self.value < 0.0 else self

    def __eq__(self, other: object) -> bool:
        return self.value == (other.value if isinstance(other, Dual) else other)

    def __lt__(self, other: Dual | float) -> bool:
        return self.value < parted(other)[0]

    def __le__(self, other: Dual | float) -> bool:
        return self.value <= parted(other)[0]

    def __gt__(self, other: Dual | float) -> bool:
        return self.value > parted(other)[0]

    def __ge__(self, other: Dual | float) -> bool:
        return self.value >= parted(other)[0]


def parted(number: Dual | float) -> tuple[float, Parts]:
    """The value of a number and its derivatives: none of a float."""
    return (number.value, number.parts) if isinstance(number, Dual) else (number, NONE)


def sqrt(number: Dual | float) -> Dual | float:
    """The square root; that of zero, which has no derivative, counts as constant."""
    if not isinstance(number, Dual):
        return math.sqrt(number)
    root = math.sqrt(number.value)
    return Dual(root, number.parts * (0.5 / root if root > 0.0 else 0.0))


@cache
def dual_answer() -> Callable[..., Any]:
    """`answer.answer` for Duals: the law code loaded a second time, with a square root that knows them."""
    as_python("mechanics.impact.restitution", "of_duals").sqrt = sqrt  # type: ignore[attr-defined]
    return as_python("mechanics.impact.answer", "of_duals").answer  # type: ignore[no-any-return]
