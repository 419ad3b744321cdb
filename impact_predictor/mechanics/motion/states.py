"""Which contact states the forces allow, by Coulomb's law and non-penetration in accelerations; how long a rest lasts.

A contact that is closed sticks, slips or opens. Sticking is tried first, then slip on all closed contacts, then
opening: what rests stays at rest while it can.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..impact.contacts import MINUS, OPEN, PLUS, STICK
from .equations import RockingBody
from .events import End, Event, may_fall
from .felt import FrameAcceleration
from .phases import MotionPhase, PhaseEnd
from .support import MovingSupport

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

JAM = -1
"""No state is allowed: slip that no finite reaction can go with (Painleve)."""
_ROUNDING = 1e-12
"""A condition violated by less than this part of the weight holds."""
_SAMPLES = 16
"""Samples of the conditions of a rest in a shortest period of the support."""
_FIRST_BLOCK, _LAST_BLOCK = 4, 128
"""Pairs of samples that are taken at once."""
_FINER = 17
"""Samples that an interval is divided by in which a margin may fall."""
_FINEST = 1e-13
"""Intervals, in shortest periods, down to which a graze is told from a crossing."""


def state_of_one(body: RockingBody, i: int, felt: FrameAcceleration, u: float, w: float, z: float, s: float) -> int:
    """State of contact i, the other one being open."""
    if s != 0.0:
        slides = PLUS if s > 0.0 else MINUS
        forces = body.forces(i, slides, felt, u, w, z, s)
        if forces.free >= 0.0:
            return OPEN
        return slides if forces.normal >= 0.0 else JAM
    forces = body.forces(i, STICK, felt, u, w, z, 0.0)
    small = _ROUNDING * (abs(forces.normal) + abs(forces.tangential))
    if forces.normal >= -small and abs(forces.tangential) <= body.friction[i] * forces.normal + small:
        return STICK
    if forces.free >= 0.0:
        return OPEN
    for slides in (PLUS, MINUS) if forces.tangential < 0.0 else (MINUS, PLUS):
        forces = body.forces(i, slides, felt, u, w, z, 0.0)
        if forces.normal >= 0.0 and (forces.beta if slides == PLUS else -forces.beta) > 0.0:
            return slides
    return STICK


def states_of_both(body: RockingBody, felt: FrameAcceleration, z: float, s: float) -> tuple[int, int]:
    """States of the two contacts when both are closed and slip with `s` or not at all; JAM at the one that jams."""
    weight = math.hypot(felt[0], felt[1]) + body.length * (abs(felt[3]) + felt[2] * felt[2])
    if s == 0.0 and min(body.hold_margins(felt, z), default=0.0) >= -_ROUNDING * weight:
        return STICK, STICK
    directions = (PLUS, MINUS) if s == 0.0 else (PLUS,) if s > 0.0 else (MINUS,)
    for slides in directions:
        beta, normal, normal_b = body.forces_of_both(slides, felt, z, s)
        if normal >= -_ROUNDING * weight and normal_b >= -_ROUNDING * weight:
            if s != 0.0 or (beta if slides == PLUS else -beta) > 0.0:
                return slides, slides
    jammed = -1
    for i in (0, 1):
        state = state_of_one(body, i, felt, 0.0, 0.0, z, s)
        if state == JAM:
            jammed = i
        if state <= OPEN:
            continue
        alpha = body.forces(i, state, felt, 0.0, 0.0, z, s).alpha
        if (alpha if i == 0 else -alpha) > 0.0:
            return (state, OPEN) if i == 0 else (OPEN, state)
    if jammed >= 0:
        return (JAM, OPEN) if jammed == 0 else (OPEN, JAM)
    free = [body.forces(i, STICK, felt, 0.0, 0.0, z, s).free for i in (0, 1)]
    if min(free) >= -_ROUNDING * weight:
        return OPEN, OPEN
    # A slip that wedges the body ends at once; at rest it is rounding at a border of two states, and the body holds.
    return (JAM, JAM) if s != 0.0 else (STICK, STICK)


def rest(phase: MotionPhase, after: float, last: float, most: int) -> PhaseEnd:
    """Rest on both contacts of a moving support until the reactions leave their cones of friction.

    They are looked at from `after` s on and for `last` s, but for at most `most` swings of the support.
    """
    import numpy as np

    support, here = phase.support, phase.instants[0]
    assert isinstance(support, MovingSupport)
    if not phase.body.facets:  # friction locks the body between its contacts
        after = max(after, last)
    spacing, patient = support.period / _SAMPLES, min(last, most * support.period)
    time, block = after, _FIRST_BLOCK
    while time < patient:
        times = np.minimum(time + spacing * np.arange(2 * block + 1), last)
        at = _first_fall(phase, support, times)
        if at is not None:
            phase.instants.append(here.at(at))
            return PhaseEnd(Event.YIELDS, phase.contact, phase.instants[-1])
        time, block = float(times[-1]), min(2 * block, _LAST_BLOCK)
    phase.instants.append(here.at(max(time, here.time)))
    event = End.TIME_UP if time >= last else End.TOO_MANY_EVENTS
    return PhaseEnd(event, phase.contact, phase.instants[-1])


def _first_fall(phase: MotionPhase, support: MovingSupport, times: NDArray[np.float64]) -> float | None:
    """First time at which a margin of a rest falls below zero, looked for between three samples each; or None."""
    import numpy as np

    felt = support.felt_at(phase.start + times).T
    values: Any = np.array(phase.body.hold_margins((felt[0], felt[1], felt[2], felt[3]), phase.instants[0].z))
    falls = may_fall(values[:, :-2:2], values[:, 1:-1:2], values[:, 2::2]).any(axis=0)
    for k in np.flatnonzero(falls).tolist():
        finer = np.linspace(times[2 * k], times[2 * k + 2], _FINER)
        if finer[-1] - finer[0] <= _FINEST * support.period or not finer[0] < finer[1]:
            found = float(finer[-1]) if values[:, 2 * k + 2].min() < 0.0 else None
        else:
            found = _first_fall(phase, support, finer)
        if found is not None:
            return found
    return None
