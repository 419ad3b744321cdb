"""The force of one compliant contact: Kelvin-Voigt along the normal, regularised Coulomb friction along the tangent.

A spring and a damper in parallel press where the contact is closed and never pull:

    N = max(0, stiffness depth + damping d depth/dt),    T = -friction N s / sqrt(1 + s^2),  s = slip / regularisation.

The damper makes a restitution that does not depend on the speed: a mass that strikes such a contact alone leaves it,
when the force has fallen to zero, with the part `restitution_of(ratio)` of its speed, where `ratio` is that of the
damping to the critical one. No finite damper stops it dead: for large ratios the restitution is 1 / (4 ratio^2).
"""

from __future__ import annotations

from math import acos, acosh, exp, sqrt
from typing import NamedTuple

PLASTIC = 1e-3
"""The restitution that a contact without any gets: its damping is 15.7 times the critical one."""

HALVINGS = 60
"""Of the interval of damping ratios: enough for all digits."""


class Compliance(NamedTuple):
    """A contact's stiffness (N/m), damping (N s/m) and friction, and the slip (m/s) at which friction is 0.71 of its
    full.
    """

    stiffness: float
    damping: float
    friction: float
    regularisation: float


class Slopes(NamedTuple):
    """Derivatives of a contact's normal and tangential force by the gap, its rate and the slip; the tangential force's
    by the normal velocity and gap are `tangential` times those of the normal force.
    """

    gap: float
    rate: float
    tangential: float
    slip: float


def force(contact: Compliance, gap: float, rate: float, slip: float) -> tuple[float, float]:
    """Normal and tangential force on the body (N), from its gap (m), the gap's rate and the slip along the tangent."""
    stiffness, damping, friction, regularisation = contact
    if gap > 0.0:
        return 0.0, 0.0
    normal = -stiffness * gap - damping * rate
    if normal <= 0.0:
        return 0.0, 0.0
    s = slip / regularisation
    return normal, -friction * normal * s / sqrt(1.0 + s * s)


def slopes(contact: Compliance, gap: float, rate: float, slip: float) -> Slopes:
    """The derivatives of `force`."""
    stiffness, damping, friction, regularisation = contact
    normal = -stiffness * gap - damping * rate
    if gap > 0.0 or normal <= 0.0:
        return Slopes(0.0, 0.0, 0.0, 0.0)
    s = slip / regularisation
    root = sqrt(1.0 + s * s)
    return Slopes(
        -stiffness, -damping, -friction * s / root, -friction * normal / (regularisation * root * root * root)
    )


def restitution_of(ratio: float) -> float:
    """The restitution of a mass that strikes a contact alone, whose damping is `ratio` times the critical one.

    The force is released when it has fallen to zero, not when the spring is slack: it never pulls.
    """
    if ratio < 1.0:
        return exp(-2.0 * ratio * acos(ratio) / sqrt((1.0 - ratio) * (1.0 + ratio)))
    if ratio == 1.0:
        return exp(-2.0)
    return exp(-2.0 * ratio * acosh(ratio) / sqrt((ratio - 1.0) * (ratio + 1.0)))


def damping_ratio(restitution: float) -> float:
    """The damping over the critical one that gives this restitution in 0..1; one below `PLASTIC` counts as that."""
    low, high = 0.0, 1.0 / sqrt(PLASTIC)
    wanted = max(restitution, PLASTIC)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if restitution_of(middle) > wanted:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
