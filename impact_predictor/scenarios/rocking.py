"""The paper's bodies, released at rest at an angle: they rock from contact to contact until they stay."""

from __future__ import annotations

from math import pi
from typing import Final, NamedTuple

from ..errors import InputError
from ..mechanics.bodies import Number, cylinder, plate, refuse, rod
from ..mechanics.motion import End, Trajectory, rock, standing
from ..mechanics.motion.support import FixedSupport
from ..mechanics.types import TwoPointBody, Vector

STICKS: Final = 100.0
"""Friction against which no body of these scenes slips."""

_LEAST_THICKNESS: Final = 0.015
"""A thin rod is drawn as thick as this part of its length."""

_MOST_EVENTS: Final = 10_000
"""A motion with more is given up: a few seconds of work."""


class Rocker(NamedTuple):
    """A body that can rock, and how it looks: its outline (x, y) in m from the mass centre, none for a disc."""

    name: str
    label: str
    body: TwoPointBody
    outline: tuple[Vector, ...]


class Rocking(NamedTuple):
    """A body and how it rocked."""

    rocker: Rocker
    run: Trajectory

    @property
    def broke_off(self) -> bool:
        """Whether the motion was lost before its end."""
        return self.run.end in (End.NO_SOLUTION, End.TOO_MANY_EVENTS)


def rocking_rod(
    length: float,
    thickness: float,
    a: float,
    b: float,
    mass: float,
    friction: float | None,
    inertia: float | None,
    restitution: float,
) -> Rocker:
    """The paper's rod on supports `a` behind and `b` ahead of its middle (Fig. 1)."""
    body = bouncing(rod(length, thickness, a, b, mass, grip(friction), inertia, restitution))
    within(0.5 * length, a=a, b=b)
    label = f"a = b = {a:g} m" if a == b else f"a = {a:g} m, b = {b:g} m"
    height = max(thickness, _LEAST_THICKNESS * length)
    bottom = -0.5 * thickness
    return Rocker("rod", label, body, _rectangle(length, bottom, bottom + height))


def rocking_plate(
    length: float,
    height: float,
    a: float | None,
    b: float | None,
    mass: float,
    friction: float | None,
    inertia: float | None,
    restitution: float,
) -> Rocker:
    """The paper's plate on the floor (Fig. 4)."""
    body = bouncing(plate(length, height, mass, grip(friction), inertia, a, b, restitution))
    within(length, a=a or 0.0, b=b or 0.0)
    return Rocker("plate", f"{length:g} m x {height:g} m", body, _rectangle(length, -0.5 * height, 0.5 * height))


def rocking_cylinder(
    radius: float,
    gamma: float,
    gamma_new: float,
    mass: float,
    friction: float | None,
    inertia: float | None,
    restitution: float,
) -> Rocker:
    """The paper's cylinder between two edges (Fig. 6); angles in rad."""
    body = bouncing(cylinder(radius, gamma, mass, grip(friction), gamma_new, inertia, restitution))
    return Rocker("cylinder", f"R = {radius:g} m", body, ())


def release(
    rocker: Rocker, angle: float, slope: float = 0.0, gravity: float = 9.81, law: str = "path", duration: float = 10.0
) -> Rocking:
    """Let a body go at rest, turned by `angle` in rad from the pose in which both contacts are closed.

    It stands on the contact behind where the angle is positive. `slope` in rad, uphill is forwards; `duration` in s.
    InputError where a number is out of its range.
    """
    refuse({"angle": angle, "slope": slope}, lambda value: abs(value) < 0.5 * pi, "an angle between -90 and 90 degrees")
    refuse({"gravity": gravity, "duration": duration}, lambda value: 0.0 < value < 1e9, "a number between 0 and 1e9")
    start, support = standing(rocker.body, angle), FixedSupport(slope, gravity)
    run = rock(rocker.body, start, support, law, duration, max_events=_MOST_EVENTS)
    if run.end is End.INVALID_INPUT:
        raise InputError("a number of the body is infinite, not a number or far out of range; give ordinary numbers")
    return Rocking(rocker, run)


def bouncing(body: TwoPointBody) -> TwoPointBody:
    """The body with the restitution of its new contact at both: a body that rocks strikes with each in turn."""
    assert body.old is not None
    return body._replace(old=body.old._replace(restitution=body.new.restitution))


def within(most: float, **distances: Number) -> None:
    """Refuse contacts beyond the ends of a body."""
    refuse(distances, lambda value: value <= most, f"a distance in m that ends within the body, at most {most:g}")


def grip(friction: float | None) -> float:
    """The friction coefficient, where none is given one against which nothing slips."""
    return STICKS if friction is None else friction


def _rectangle(length: float, bottom: float, top: float) -> tuple[Vector, ...]:
    x = 0.5 * length
    return (-x, bottom), (x, bottom), (x, top), (-x, top)
