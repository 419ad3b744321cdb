"""Impacts and touchdowns on compliant contacts: Kelvin-Voigt springs of a stiffness, integrated as a stiff ODE."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from scipy.optimize import brentq

from ...mechanics.compliant.impact import compliant_impact
from ...mechanics.compliant.integrator import Status
from ...mechanics.compliant.motion import compliant_motion
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

PIECE = 0.05
EVALUATIONS = 1000
"""s, and evaluations of the right-hand side, in which a touchdown is looked for at a time: what follows it is costly,
and is not asked."""

FAMILIES = {
    "compliant": "Kelvin-Voigt springs of stiffness k at the contacts, with regularised friction, integrated by "
    "scipy's implicit methods.",
}


def impact(strike: Strike, stiffness: float) -> After | None:
    """One impact; None where the integration does not come to its end."""
    outcome = compliant_impact(strike.body, strike.twist, stiffness)
    if outcome.status not in (Status.OVER, Status.NO_IMPACT):
        return None
    return After(Twist(*outcome.twist), outcome.mode)


def touchdown(fall: Falling, stiffness: float) -> Landing | None:
    """The motion on springs, in pieces, until a new point is down."""
    first, *more = [Contact(x, y, fall.friction) for x, y in striking(fall)]
    old = None if fall.stance is None else Contact(*fall.points[fall.stance], fall.friction)
    body, support = TwoPointBody(1.0, fall.rho_squared, old, first), FixedSupport(gravity=-fall.gravity[1])
    state, begun = fall.state, 0.0
    while begun < HORIZON:
        motion = compliant_motion(
            body, state, support, PIECE, more=tuple(more), stiffness=stiffness, evaluations=EVALUATIONS
        )

        def gap(time: float, motion: Any = motion) -> float:
            return float(min(motion.gaps(time)[old is not None :]))

        # The integrator's own steps: none is so long that a contact would close and open in it.
        for before, after in pairwise(motion.way.ts):
            if gap(after) <= 0.0 < gap(before):
                time = brentq(gap, before, after, xtol=1e-16)
                return Landing(begun + float(time), Twist(*motion.state(time)[3:]))
        if not motion.time > 0.0:
            break
        state, begun = motion.state(motion.time), begun + motion.time
    return None


METHODS: list[Method] = over("compliant", "compliant contacts", "k = {:g} N/m", TOUCHDOWN_STIFFNESSES, touchdown)

IMPACT_METHODS: list[Method] = over(
    "compliant", "compliant contacts", "k = {:g} N/m", STIFFNESSES, impact, applies=lambda strike: strike.ordinary
)
