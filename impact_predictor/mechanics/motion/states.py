"""Which contact states the forces allow, by Coulomb's law and non-penetration in accelerations; how long a rest lasts.

A contact that is closed sticks, slips or opens. Sticking is tried first, then slip on all closed contacts, then
opening: what rests stays at rest while it can.
"""

from __future__ import annotations

import math
from typing import Any

from ..impact.contacts import MINUS, OPEN, PLUS, STICK
from .equations import RockingBody
from .events import Event
from .phases import ContactPhase, PhaseEnd
from .support import FrameAcceleration, MovingSupport

JAM = -1
"""No state is allowed: slip that no finite reaction can go with (Painleve)."""
_ROUNDING = 1e-12
"""A condition violated by less than this part of the weight holds."""
_SAMPLES = 16
"""Samples of the conditions of a rest in a shortest period of the support."""
_FIRST_BLOCK, _LAST_BLOCK = 4, 128
"""Pairs of samples that are taken at once."""
_DEPTH = 40
"""Halvings down to which a graze is told from a crossing."""


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


def rest(phase: ContactPhase, after: float, last: float, most: int) -> PhaseEnd:
    """Rest on both contacts of a moving support until the reactions leave their cones of friction.

    They are looked at from `after` s on and for `last` s, but for at most `most` swings of the support.
    """
    import numpy as np

    body, support, start, here = phase.body, phase.support, phase.start, phase.instants[0]
    assert isinstance(support, MovingSupport)
    if not body.facets:  # friction locks the body between its contacts
        after = max(after, last)
    spacing, patient = support.period / _SAMPLES, min(last, most * support.period)
    time, block = after, _FIRST_BLOCK
    while time < patient:
        times = np.minimum(time + spacing * np.arange(2 * block + 1), last)
        felt = support.felt_at(start + times)
        values: Any = np.array(body.hold_margins((felt[:, 0], felt[:, 1], felt[:, 2], felt[:, 3]), here.z))
        low, middle, high = values[:, :-2:2], values[:, 1:-1:2], values[:, 2::2]
        for k in np.flatnonzero(_may_fall(low, middle, high).any(axis=0)).tolist():
            sides = low[:, k].tolist(), middle[:, k].tolist(), high[:, k].tolist()
            at = _first_fall(phase, float(times[2 * k]), float(times[2 * k + 2]), *sides, _DEPTH)
            if at is not None:
                phase.instants.append(here._replace(time=at))
                return PhaseEnd(Event.YIELDS, phase.contact, phase.instants[-1])
        time, block = float(times[-1]), min(2 * block, _LAST_BLOCK)
    phase.instants.append(here._replace(time=max(time, here.time)))
    event = Event.TIME_IS_UP if time >= last else Event.TAKES_TOO_LONG
    return PhaseEnd(event, phase.contact, phase.instants[-1])


def _may_fall(first: Any, half: Any, last: Any) -> Any:
    """Where a margin may fall below zero between three samples: their parabola does, with what it may be wrong by."""
    bend, slope = first - 2.0 * half + last, last - first
    bends = abs(bend) + (bend == 0.0)  # no division by zero
    dips = (bend > 0.0) & (abs(slope) < 2.0 * bend) & (half - 0.125 * slope * slope / bends - 0.1 * bend < 0.0)
    return dips | (first < 0.0) | (half < 0.0) | (last < 0.0)


def _first_fall(
    phase: ContactPhase,
    start: float,
    end: float,
    low: list[float],
    middle: list[float],
    high: list[float],
    depth: int,
) -> float | None:
    """First time in an interval at which a margin of a rest falls below zero; None where none does."""
    if not any(_may_fall(*samples) for samples in zip(low, middle, high, strict=True)):
        return None
    centre = 0.5 * (start + end)
    if depth == 0 or not start < centre < end:
        return end if min(high) < 0.0 else None
    support, z = phase.support, phase.instants[0].z
    assert isinstance(support, MovingSupport)
    early, late = (
        phase.body.hold_margins(support.felt_exactly(phase.start + time), z)
        for time in (0.5 * (start + centre), 0.5 * (centre + end))
    )
    found = _first_fall(phase, start, centre, low, early, middle, depth - 1)
    return _first_fall(phase, centre, end, middle, late, high, depth - 1) if found is None else found
