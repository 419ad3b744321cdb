"""What a scene consists of: one body, the support it strikes and how it is observed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot
from typing import Any, NamedTuple

from ..mechanics.answer import VALIDITY
from ..mechanics.types import Validity
from .types import Vector3

Matrix3 = tuple[Vector3, Vector3, Vector3]


class Scene(NamedTuple):
    """A body over a plane; SI units, the body's quantities in the body frame.

    `inertia` is about the mass centre; `points` are the contact points, empty where they come with the samples;
    `normal` is the support's unit normal and `height` its distance from the origin along it, in the frame of the
    samples; `tolerance` the gap in m below which a point touches; `contact_time` in s how long a contact lasts;
    `twist_window` in s the time over which the source averages its twist, 0 for a twist of the very instant;
    `horizon` in s how far ahead a touchdown is announced; `transverse_slip` whether friction also opposes slip across
    the impact plane, which only the path law knows; `samples` how many points carry uncertainty through an impact, 0
    for none, with the standard deviations of friction and restitution; `margins` whether a touchdown keeps the impact
    whose margins can be read; `validity` from where on rigid theory is too simple.
    """

    mass: float
    inertia: Matrix3
    friction: float
    restitution: float = 0.0
    center_of_mass: Vector3 = (0.0, 0.0, 0.0)
    points: tuple[Vector3, ...] = ()
    frame: str = ""
    normal: Vector3 = (0.0, 0.0, 1.0)
    height: float = 0.0
    gravity: Vector3 = (0.0, 0.0, -9.81)
    tolerance: float = 0.005
    contact_time: float = 0.005
    twist_window: float = 0.0
    horizon: float = 0.25
    law: str = "path"
    transverse_slip: bool = True
    samples: int = 0
    friction_deviation: float = 0.0
    restitution_deviation: float = 0.0
    margins: bool = False
    validity: Validity = VALIDITY

    @classmethod
    def from_parameters(cls, values: Mapping[str, Any]) -> Scene:
        """The scene of validated parameters (see `impact_predictor.parameters`)."""
        normal = values["support.normal"]
        length = hypot(*normal)
        points = values["body.contact_points"]
        return cls(
            mass=values["body.mass"],
            inertia=inertia_matrix(values["body.inertia"]),
            friction=values["contact.friction"],
            restitution=values["contact.restitution"],
            center_of_mass=triple(values["body.center_of_mass"]),
            points=tuple(triple(points[i : i + 3]) for i in range(0, len(points), 3)),
            frame=values["support.frame"],
            normal=triple([part / length for part in normal]),
            height=values["support.height"],
            gravity=triple(values["gravity"]),
            tolerance=values["contact.tolerance"],
            contact_time=values["contact.time"],
            twist_window=values["odom.twist_window"],
            horizon=values["horizon"],
            law=values["law"],
            transverse_slip=values["transverse_slip"],
            samples=values["uncertainty.samples"],
            friction_deviation=values["uncertainty.friction"],
            restitution_deviation=values["uncertainty.restitution"],
            margins=values["margins"],
            validity=Validity(
                slenderness=values["validity.slenderness"],
                gravity=hypot(*values["gravity"]),
                contact_time=values["contact.time"],
                gravity_share=values["validity.gravity_share"],
            ),
        )


def inertia_matrix(numbers: Sequence[float]) -> Matrix3:
    """The inertia tensor of one number (the same about every axis) or of ixx, iyy, izz, ixy, ixz, iyz."""
    xx, yy, zz, xy, xz, yz = (*(numbers[0],) * 3, 0.0, 0.0, 0.0) if len(numbers) == 1 else numbers
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def triple(numbers: Sequence[float]) -> Vector3:
    x, y, z = numbers
    return float(x), float(y), float(z)
