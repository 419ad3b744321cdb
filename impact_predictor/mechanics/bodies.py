"""The paper's bodies: rod, plate and cylinder.

Every argument may be an array; the fields of the body are then arrays that broadcast together (see `solve_impacts`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from math import inf, pi
from typing import TYPE_CHECKING, Any, Union

from ..errors import InputError
from .types import Contact, TwoPointBody

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Number = Union[float, "NDArray[np.float64]"]


def plate(
    length: Number,
    height: Number,
    mass: Number,
    friction: Number,
    inertia: Number | None = None,
    a: Number | None = None,
    b: Number | None = None,
    restitution: Number = 0.0,
) -> TwoPointBody:
    """A plate (crate, block) of `length` and `height` in m on a flat floor (the paper, section 3, Fig. 4).

    The old contact lies `a` behind the mass centre and the new one `b` ahead (m; half the length unless given), half
    the height below it. `inertia` in kg m^2 is that of a homogeneous rectangle unless given. `friction` is that of both
    contacts; `restitution` (0 to 1) is that of the new one, which strikes. A body that strikes with each in turn (see
    `rock`) needs it at the old one, too: `body._replace(old=body.old._replace(restitution=restitution))`.
    """
    positive(length=length, height=height, mass=mass)
    if inertia is None:
        inertia = mass * (length * length + height * height) / 12.0
    return flat(
        mass,
        inertia,
        0.5 * length if a is None else a,
        0.5 * length if b is None else b,
        0.5 * height,
        friction,
        restitution,
    )


def rod(
    length: Number,
    thickness: Number,
    a: Number,
    b: Number,
    mass: Number,
    friction: Number,
    inertia: Number | None = None,
    restitution: Number = 0.0,
) -> TwoPointBody:
    """A rod of `length` and `thickness` in m on two supports `a` behind and `b` ahead of its middle (Fig. 1).

    `inertia` in kg m^2 is that of a slender homogeneous rod, mass length^2 / 12, unless given. `friction` and
    `restitution` are as those of `plate`.
    """
    positive(length=length, mass=mass)
    not_negative(thickness=thickness)
    if inertia is None:
        inertia = mass * length * length / 12.0
    return flat(mass, inertia, a, b, 0.5 * thickness, friction, restitution)


def cylinder(
    radius: Number,
    gamma: Number,
    mass: Number,
    friction: Number,
    gamma_new: Number | None = None,
    inertia: Number | None = None,
    restitution: Number = 0.0,
) -> TwoPointBody:
    """A cylinder of `radius` in m between two edges (the paper, section 4, Fig. 6).

    The old edge lies at the central angle `gamma` in rad behind the vertical, the new one at `gamma_new` ahead (the
    same unless given); the normals point to the axis. `inertia` in kg m^2 is mass radius^2 / 2 unless given. `friction`
    and `restitution` are as those of `plate`.
    """
    positive(radius=radius, mass=mass)
    if inertia is None:
        inertia = 0.5 * mass * radius * radius
    positive(inertia=inertia)
    not_negative(friction=friction)
    fraction(restitution=restitution)
    ahead = gamma if gamma_new is None else gamma_new
    refuse(
        {"the angle gamma + gamma_new between the edges": gamma + ahead},
        lambda value: (value > 0.0) & (value < pi),
        "angles in rad with a sum between 0 and pi",
    )
    return wedged(mass, inertia, radius, gamma, ahead, friction, restitution)


def flat(mass: Any, inertia: Any, a: Any, b: Any, height: Any, friction: Any, restitution: Any) -> TwoPointBody:
    """A body on a flat floor, its contacts `a` behind, `b` ahead of and `height` below the mass centre."""
    positive(inertia=inertia)
    not_negative(friction=friction)
    fraction(restitution=restitution)
    refuse({"a": a, "b": b}, lambda value: abs(value) < inf, "a finite number")
    refuse({"the distance a + b of the contacts": a + b}, lambda value: value > 0.0, "a + b > 0")
    return TwoPointBody(
        mass, inertia, Contact(-a, -height, friction), Contact(b, -height, friction, restitution=restitution)
    )


def wedged(
    mass: Any, inertia: Any, radius: Any, gamma: Any, gamma_new: Any, friction: Any, restitution: Any
) -> TwoPointBody:
    """A body whose contact normals point to its mass centre, from the distance `radius`."""
    sin_old, cos_old = sine_and_cosine(gamma)
    sin_new, cos_new = sine_and_cosine(gamma_new)
    old = Contact(-radius * sin_old, -radius * cos_old, friction, (sin_old, cos_old))
    new = Contact(radius * sin_new, -radius * cos_new, friction, (-sin_new, cos_new), restitution)
    return TwoPointBody(mass, inertia, old, new)


def positive(**values: Number) -> None:
    refuse(values, lambda value: (value > 0.0) & (value < inf), "a finite number above 0")


def not_negative(**values: Number) -> None:
    refuse(values, lambda value: (value >= 0.0) & (value < inf), "a finite number, 0 or above")


def fraction(**values: Number) -> None:
    refuse(values, lambda value: (value >= 0.0) & (value <= 1.0), "a number from 0 to 1")


def refuse(values: dict[str, Number], allowed: Callable[[Any], Any], wanted: str) -> None:
    """Raise InputError where a value, or an element of an array, is not allowed."""
    for name, value in values.items():
        try:
            good = allowed(value)
        except TypeError:
            raise InputError(f"{name} is {value!r}; give {wanted}") from None
        if good is not True and not (good is not False and good.all()):
            bad: Any = value if good is False else value[~good].flat[0]  # type: ignore[index]
            raise InputError(f"{name} is {bad}; give {wanted}")


def sine_and_cosine(angle: Any) -> tuple[Any, Any]:
    if isinstance(angle, (float, int)):
        return math.sin(angle), math.cos(angle)
    import numpy as np  # a single body does without

    return np.sin(angle), np.cos(angle)
