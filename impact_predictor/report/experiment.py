"""The paper's experiment: rods that fall from one support onto another, predicted and observed (section 2.2)."""

from __future__ import annotations

from math import degrees, inf, radians
from typing import Final, NamedTuple

from ..errors import InputError
from ..mechanics.bodies import rod
from ..mechanics.impact import solve_impact
from ..mechanics.impact.answer import VALIDITY
from ..mechanics.motion import next_touchdown, standing
from ..mechanics.types import Flag, Mode, Outcome, Twist, TwoPointBody

LENGTH: Final = 0.4
"""m, of every rod."""

THICKNESSES: Final = (0.020, 0.010, 0.005, 0.002)
"""m, of wood, metal and plastic."""

FARTHEST: Final = 0.2
"""m from the middle: the ends of the rod, where the farthest supports stood."""

ANGLES: Final = (15.0, 30.0)
"""degrees, the least and the greatest from which the rods were released at rest."""

REBOUNDED: Final = 0.002
"""m, the thickness of the rod that rebounded from both supports wherever they were."""

VERY_SMALL: Final = 0.01
"""m: with the old support about this near to the middle, and the new one farther, the rod turned back."""


class RodTrial(NamedTuple):
    """One rod over two supports at `a` and `b` from its middle (m).

    `gravity_share` is the impulse of gravity while the contact lasts, as a part of the impulse at the new support.
    """

    thickness: float
    a: float
    b: float
    outcome: Outcome
    ratio: float
    gravity_share: float
    observed: Mode

    @property
    def agrees(self) -> bool:
        return self.outcome.mode is self.observed

    @property
    def doubted(self) -> bool:
        """Whether the prediction itself says that rigid theory is too simple here."""
        return bool(self.outcome.flags & (Flag.THIN_BODY | Flag.SLOW_IMPACT))


def trial(thickness: float, a: float, b: float, friction: float, angle: float) -> RodTrial:
    """Release a rod at rest, its new support `angle` degrees below it, and let it strike. Lengths in m.

    The mass plays no part. The old support holds the rod without slip until the impact, as it did in the experiment.
    """
    body = rod(length=LENGTH, thickness=thickness, a=a, b=b, mass=1.0, friction=friction)
    before = falling(body, radians(angle))
    outcome = solve_impact(body, before)
    (_, _), (normal, _) = outcome.impulses
    weight = body.mass * VALIDITY.gravity * VALIDITY.contact_time
    return RodTrial(
        thickness,
        a,
        b,
        outcome,
        outcome.twist.omega / before.omega,
        weight / normal,
        observed(thickness, a, b),
    )


def falling(body: TwoPointBody, angle: float) -> Twist:
    """The twist with which a body strikes its new contact that was raised about the old one by `angle` rad, at rest.

    Raises:
        InputError: it is raised beyond its balance.
    """
    assert body.old is not None
    feet = (body.old.x, body.old.y), (body.new.x, body.new.y)
    fall = next_touchdown(standing(body, angle), feet, 0, body.inertia / body.mass, friction=inf)
    if fall.point != 1 or not fall.state.omega < 0.0:
        raise InputError(f"a body raised by {degrees(angle):g} degrees does not fall back; give a smaller angle")
    state = fall.state
    return Twist(state.vx, state.vy, state.omega)


def observed(thickness: float, a: float, b: float) -> Mode:
    """What the paper says it saw of rods such as this one; it has words for all of them, and no table."""
    if thickness == REBOUNDED:
        return Mode.FLIGHT
    if a <= VERY_SMALL and b > a:
        return Mode.BACK_PIVOT
    return Mode.STOP if 12.0 * a * b > LENGTH * LENGTH else Mode.PIVOT


def border(thickness: float, friction: float) -> float:
    """The distance in m of two supports as far from the middle as each other from which on the rod stops."""
    low, high = 0.0, FARTHEST
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        body = rod(length=LENGTH, thickness=thickness, a=middle, b=middle, mass=1.0, friction=friction)
        if solve_impact(body, body.turning(omega=-1.0)).mode is Mode.STOP:
            high = middle
        else:
            low = middle
    return high
