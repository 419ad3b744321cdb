"""The paper's bodies: rod, plate and cylinder."""

from __future__ import annotations

from math import cos, isfinite, pi, sin

from ..errors import InputError
from .types import Contact, TwoPointBody


def plate(
    length: float,
    height: float,
    mass: float,
    friction: float,
    inertia: float | None = None,
    a: float | None = None,
    b: float | None = None,
    restitution: float = 0.0,
) -> TwoPointBody:
    """A plate (crate, block) of `length` and `height` in m on a flat floor (the paper, section 3, Fig. 4).

    The old contact lies `a` behind the mass centre and the new one `b` ahead (m; half the length unless given), half
    the height below it. `inertia` in kg m^2 is that of a homogeneous rectangle unless given.
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
    length: float,
    thickness: float,
    a: float,
    b: float,
    mass: float,
    friction: float,
    inertia: float | None = None,
    restitution: float = 0.0,
) -> TwoPointBody:
    """A rod of `length` and `thickness` in m on two supports `a` behind and `b` ahead of its middle (Fig. 1).

    `inertia` in kg m^2 is that of a slender homogeneous rod, mass length^2 / 12, unless given.
    """
    positive(length=length, mass=mass)
    if thickness != 0.0:
        positive(thickness=thickness)
    if inertia is None:
        inertia = mass * length * length / 12.0
    return flat(mass, inertia, a, b, 0.5 * thickness, friction, restitution)


def cylinder(
    radius: float,
    gamma: float,
    mass: float,
    friction: float,
    gamma_new: float | None = None,
    inertia: float | None = None,
    restitution: float = 0.0,
) -> TwoPointBody:
    """A cylinder of `radius` in m between two edges (the paper, section 4, Fig. 6).

    The old edge lies at the central angle `gamma` in rad behind the vertical, the new one at `gamma_new` ahead (the
    same unless given); the normals point to the axis. `inertia` in kg m^2 is mass radius^2 / 2 unless given.
    """
    positive(radius=radius, mass=mass)
    if inertia is None:
        inertia = 0.5 * mass * radius * radius
    positive(inertia=inertia)
    not_negative(friction=friction)
    fraction(restitution=restitution)
    ahead = gamma if gamma_new is None else gamma_new
    if not 0.0 < gamma + ahead < pi:
        raise InputError(f"gamma is {gamma} and gamma_new {ahead}; give angles in rad with a sum between 0 and pi")
    old = Contact(-radius * sin(gamma), -radius * cos(gamma), friction, (sin(gamma), cos(gamma)))
    new = Contact(radius * sin(ahead), -radius * cos(ahead), friction, (-sin(ahead), cos(ahead)), restitution)
    return TwoPointBody(mass, inertia, old, new)


def flat(
    mass: float, inertia: float, a: float, b: float, height: float, friction: float, restitution: float
) -> TwoPointBody:
    """A body on a flat floor, its contacts `a` behind, `b` ahead of and `height` below the mass centre."""
    positive(inertia=inertia)
    not_negative(friction=friction)
    fraction(restitution=restitution)
    for name, value in {"a": a, "b": b}.items():
        if not isfinite(value):
            raise InputError(f"{name} is {value}; give a finite number")
    if not a + b > 0.0:
        raise InputError(f"the contacts are {a} m behind and {b} m ahead of the mass centre; give a + b > 0")
    return TwoPointBody(
        mass, inertia, Contact(-a, -height, friction), Contact(b, -height, friction, restitution=restitution)
    )


def positive(**values: float) -> None:
    for name, value in values.items():
        if not (value > 0.0 and isfinite(value)):
            raise InputError(f"{name} is {value}; give a finite number above 0")


def not_negative(**values: float) -> None:
    for name, value in values.items():
        if not (value >= 0.0 and isfinite(value)):
            raise InputError(f"{name} is {value}; give a finite number, 0 or above")


def fraction(**values: float) -> None:
    for name, value in values.items():
        if not 0.0 <= value <= 1.0:
            raise InputError(f"{name} is {value}; give a number from 0 to 1")
