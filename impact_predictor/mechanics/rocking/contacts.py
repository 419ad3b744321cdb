"""Which contact states the forces allow at one instant: Coulomb's law and non-penetration in accelerations.

A contact that is closed sticks, slips or opens. Sticking is tried first, then slip on all closed contacts, then
opening: what rests stays at rest while it can.
"""

from __future__ import annotations

import math

from ..pair import MINUS, OPEN, PLUS, STICK
from ..support import Felt
from .shape import Shape

JAM = -1
"""No state is allowed: slip that no finite reaction can go with (Painleve)."""
_ROUNDING = 1e-12
"""A condition violated by less than this part of the weight holds."""


def state_of_one(shape: Shape, i: int, felt: Felt, u: float, w: float, z: float, s: float) -> int:
    """State of contact i, the other one being open."""
    if s != 0.0:
        slides = PLUS if s > 0.0 else MINUS
        forces = shape.forces(i, slides, felt, u, w, z, s)
        if forces.free >= 0.0:
            return OPEN
        return slides if forces.normal >= 0.0 else JAM
    forces = shape.forces(i, STICK, felt, u, w, z, 0.0)
    small = _ROUNDING * (abs(forces.normal) + abs(forces.tangential))
    if forces.normal >= -small and abs(forces.tangential) <= shape.friction[i] * forces.normal + small:
        return STICK
    if forces.free >= 0.0:
        return OPEN
    for slides in (PLUS, MINUS) if forces.tangential < 0.0 else (MINUS, PLUS):
        forces = shape.forces(i, slides, felt, u, w, z, 0.0)
        if forces.normal >= 0.0 and (forces.beta if slides == PLUS else -forces.beta) > 0.0:
            return slides
    return STICK


def states_of_both(shape: Shape, felt: Felt, z: float, s: float) -> tuple[int, int]:
    """States of the two contacts when both are closed and slip with `s` or not at all; JAM at the one that jams."""
    weight = math.hypot(felt[0], felt[1]) + shape.length * (abs(felt[3]) + felt[2] * felt[2])
    if s == 0.0 and min(shape.hold_margins(felt, z), default=0.0) >= -_ROUNDING * weight:
        return STICK, STICK
    directions = (PLUS, MINUS) if s == 0.0 else (PLUS,) if s > 0.0 else (MINUS,)
    for slides in directions:
        beta, normal, normal_b = shape.forces_of_both(slides, felt, z, s)
        if normal >= -_ROUNDING * weight and normal_b >= -_ROUNDING * weight:
            if s != 0.0 or (beta if slides == PLUS else -beta) > 0.0:
                return slides, slides
    jammed = -1
    for i in (0, 1):
        state = state_of_one(shape, i, felt, 0.0, 0.0, z, s)
        if state == JAM:
            jammed = i
        if state <= OPEN:
            continue
        alpha = shape.forces(i, state, felt, 0.0, 0.0, z, s).alpha
        if (alpha if i == 0 else -alpha) > 0.0:
            return (state, OPEN) if i == 0 else (OPEN, state)
    if jammed >= 0:
        return (JAM, OPEN) if jammed == 0 else (OPEN, JAM)
    free = [shape.forces(i, STICK, felt, 0.0, 0.0, z, s).free for i in (0, 1)]
    if min(free) >= -_ROUNDING * weight:
        return OPEN, OPEN
    # A slip that wedges the body ends at once; at rest it is rounding at a border of two states, and the body holds.
    return (JAM, JAM) if s != 0.0 else (STICK, STICK)
