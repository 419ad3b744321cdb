"""Impacts and touchdowns on compliant contacts: Kelvin-Voigt springs of a stiffness, integrated as a stiff ODE."""

from __future__ import annotations

from ...mechanics.compliant import compliant_impact, compliant_motion
from ...mechanics.motion.support import FixedSupport
from ...mechanics.types import Contact, Twist, TwoPointBody
from .impact_scenes import After, Strike
from .methods import Method, over
from .touchdown_equations import striking
from .touchdown_scenes import Falling, Landing

STIFFNESSES = (1e4, 1e6, 1e8, 1e10)
TOUCHDOWN_STIFFNESSES = (1e4, 1e6, 1e8)
"""N/m, for a body of 1 kg."""

HORIZON = 20.0
"""s."""

FAMILIES = {
    "compliant": "Kelvin-Voigt springs of stiffness k at the contacts, with regularised friction, integrated by "
    "scipy's implicit methods.",
}


def impact(strike: Strike, stiffness: float) -> After | None:
    """One impact; None where the integration does not come to its end."""
    found = compliant_impact(strike.body, strike.twist, stiffness)
    return None if found is None else After(found[1], found[0])


def touchdown(fall: Falling, stiffness: float) -> Landing | None:
    """The motion on springs until a new point is down."""
    first, *more = [Contact(x, y, fall.friction) for x, y in striking(fall)]
    old = None if fall.stance is None else Contact(*fall.points[fall.stance], fall.friction)
    motion = compliant_motion(
        TwoPointBody(1.0, fall.rho_squared, old, first),
        fall.state,
        FixedSupport(gravity=-fall.gravity[1]),
        HORIZON,
        more=tuple(more),
        stiffness=stiffness,
        until_closed=int(old is not None),
    )
    if not (motion.complete and motion.time < HORIZON):
        return None
    return Landing(motion.time, Twist(*motion.state(motion.time)[3:]))


METHODS: list[Method] = over("compliant", "compliant contacts", "k = {:g} N/m", TOUCHDOWN_STIFFNESSES, touchdown)

IMPACT_METHODS: list[Method] = over(
    "compliant", "compliant contacts", "k = {:g} N/m", STIFFNESSES, impact, applies=lambda strike: strike.ordinary
)
