"""What is wrong with an impact: its twist and its mode, against a reference."""

from __future__ import annotations

from ...mechanics.answer import mode_of
from ...mechanics.problem import approach
from ...mechanics.types import Mode, Twist
from .impact_reference import Reference
from .impact_scenes import After, Strike
from .touchdown_reference import distance, size_of

STAYS = 1e-2
"""Of the contact speeds before the impact: slower contacts rest, for methods that tell no mode and are not exact."""


def twist_error(strike: Strike, after: After, reference: Reference) -> float:
    """Error of the twist after an impact, relative to the size of the twist before it."""
    rho_squared = strike.body.inertia / strike.body.mass
    return distance(after.twist, reference.twist, rho_squared) / size_of(strike.twist, rho_squared)


def is_wrong(strike: Strike, after: After, reference: Reference) -> bool:
    """Whether the mode is another one."""
    mode = mode_seen(strike, after.twist) if after.mode is None else after.mode
    return mode != reference.mode


def mode_seen(strike: Strike, twist: Twist) -> Mode:
    """The mode that the contact velocities after an impact show."""
    _, _, old, new = strike.body
    vnb, vtb, _ = approach(new, twist)
    vna, vta, _ = approach(old, twist) if old is not None else (float("inf"), 0.0, 0.0)
    speed = sum(
        abs(part) for contact in (old, new) if contact is not None for part in approach(contact, strike.twist)[:2]
    )
    return Mode(mode_of(STAYS * speed, vna, vta, vnb, vtb))
