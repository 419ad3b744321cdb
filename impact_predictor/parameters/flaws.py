"""What is wrong with a list as the parameter of bodies or a support: a part of a sentence, or ""."""

from __future__ import annotations

import math
import re
from typing import Final

ROUNDED: Final = 0.01
"""By this part of its trace an inertia may miss the triangle inequality: thin plates are given with few digits."""

_PART_OF_A_NAME: Final = re.compile(r"[A-Za-z](_?[A-Za-z0-9])*")
"""No two underscores in a row: ROS keeps those for itself."""


SIZES_OF_INERTIA: Final = (1e-30, 1e30)
"""kg m^2: of a grain of dust and of a moon; products of three still are numbers."""


def inertia_flaw(inertia: tuple[float, ...]) -> str:
    """Of one number, or of ixx, iyy, izz, ixy, ixz, iyz (kg m^2)."""
    _, greatest = SIZES_OF_INERTIA
    if max(inertia) > greatest:
        return f"it must be at most {greatest:g} kg m^2"
    if len(inertia) == 1:
        return _small_flaw(inertia[0]) if inertia[0] > 0.0 else "it must be positive"
    xx, yy, zz, xy, xz, yz = inertia
    # Sylvester's criterion: the leading minors of a positive definite matrix are positive.
    minors = (
        xx,
        xx * yy - xy * xy,
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz),
    )
    if not min(minors) > 0.0:
        return "its matrix must be positive definite"
    if not _is_of_masses(inertia):
        return "no body has it: about each axis, inertia is at most the sum of that about the two axes across it"
    return _small_flaw(min(xx, yy, zz))


def _small_flaw(inertia: float) -> str:
    least, _ = SIZES_OF_INERTIA
    return "" if inertia >= least else f"it must be at least {least:g} kg m^2"


def _is_of_masses(inertia: tuple[float, ...]) -> bool:
    """Whether the principal moments keep the triangle inequality: the second moments of the mass are not negative.

    Those are the matrix trace / 2 - inertia. It is positive semidefinite when the coefficients of its characteristic
    polynomial alternate in sign; that of its trace does.
    """
    xx, yy, zz, xy, xz, yz = inertia
    half = (0.5 + ROUNDED) * (xx + yy + zz)
    x, y, z = half - xx, half - yy, half - zz
    minors = x * y + y * z + z * x - xy * xy - xz * xz - yz * yz
    # The products of inertia are the second moments with the other sign.
    return minors >= 0.0 and x * (y * z - yz * yz) - xy * (xy * z + xz * yz) - xz * (xy * yz + y * xz) >= 0.0


def points_flaw(numbers: tuple[float, ...]) -> str:
    """Of contact points, x y z of each (m)."""
    if len(numbers) % 3:
        return f"it must have three numbers for each point, not {len(numbers)} in all"
    points = [numbers[k : k + 3] for k in range(0, len(numbers), 3)]
    if len(points) == 1:
        return "a body needs at least two contact points"
    for k, point in enumerate(points):
        if point in points[:k]:
            return f"the points {points.index(point)} and {k} coincide"
    return ""


def normal_flaw(normal: tuple[float, ...]) -> str:
    """Of a direction."""
    return "" if 0.0 < math.hypot(*normal) < math.inf else "it must have a direction"


def edges_flaw(numbers: tuple[float, ...]) -> str:
    """Of two edges, x y z of a point of each (m)."""
    return "the two edges coincide" if numbers[:3] == numbers[3:] else ""


def extent_flaw(extent: tuple[float, ...]) -> str:
    """Of a rectangle: least x, greatest x, least y, greatest y (m)."""
    least_x, greatest_x, least_y, greatest_y = extent
    return "" if least_x < greatest_x and least_y < greatest_y else "each least must be below its greatest"


def names_flaw(names: tuple[str, ...]) -> str:
    """Of the names of bodies, which become parts of the names of topics."""
    for name in names:
        if not _PART_OF_A_NAME.fullmatch(name):
            return (
                f"{name!r} is no part of a ROS name: take letters, digits and single underscores, and begin and end "
                "with a letter or a digit, the first one a letter"
            )
    return _twice(names)


def feet_flaw(names: tuple[str, ...]) -> str:
    """Of the names of feet or of frames, by which messages and models call them."""
    return "a name is empty" if "" in names else _twice(names)


def _twice(names: tuple[str, ...]) -> str:
    return next((f"{name!r} is there twice" for k, name in enumerate(names) if name in names[:k]), "")
