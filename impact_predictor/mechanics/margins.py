"""How far an impact is from another mode: in friction, in geometry and in speed.

Along each way the nearest border is looked for outwards on both sides at the STEPS, and between two of them where the
contact states differ. So a mode is found that holds over a thirty-second of the way's unit and over half of its
distance; a narrower one if the contact states beyond it differ too. A border is then halved down to its place.
"""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, hypot, inf
from typing import NamedTuple

from .impact import MODES, NOWHERE, number_of, see
from .impact.answer import NO_IMPACT, answer
from .types import Contact, Flag, Mode, Outcome, Twist, TwoPointBody, Vector

STEPS = tuple([k / 32.0 for k in (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)])
"""How far is looked, in the unit of a way."""

PROBES = 5
"""How often an interval is halved in which the contact states change but the mode does not."""

ACCURACY = 1e-10
"""A border is halved down to this, in the unit of its way: a contact velocity below 1e-10 is zero for the mode."""

BEYOND = 1e-6
"""How far behind a border the mode is asked for, in the unit of its way."""

UNSOLVED = int(Flag.INVALID_INPUT | Flag.NO_SOLUTION)


class Margin(NamedTuple):
    """The smallest change that changes the mode, up or down, and the mode beyond; inf and None where none was found."""

    change: float
    mode: Mode | None


class Margins(NamedTuple):
    """How far an impact is from the nearest border of its mode, by one change at a time.

    `friction`: the same change of the friction of both contacts (1), not below zero; `center`: a shift of the mass
    centre along the line from the old to the new contact (m); `height`: its shift across that line, out of the support
    (m), and not through the line; `reach`: a shift of the new contact along its tangent (m); `slip`: a change of the
    velocity of the old contact along its tangent (m/s), with the angular velocity as it is. Mass and inertia stay, and
    the body moves as before where its mass centre or its new contact shifts. It is looked up to a change of friction of
    2, twice the distance of the contacts and twice the sum of the contact speeds.

    Of a body without an old contact, the new contact and its tangent stand for the old contact and the line, and its
    distance from the mass centre for that of the contacts.
    """

    friction: Margin
    center: Margin
    height: Margin
    reach: Margin
    slip: Margin


NO_MARGIN = Margin(inf, None)
NO_MARGINS = Margins(NO_MARGIN, NO_MARGIN, NO_MARGIN, NO_MARGIN, NO_MARGIN)

Case = tuple[Contact, Contact, Twist]
"""Old contact, new contact and twist before the impact."""


class ChangedImpact(NamedTuple):
    """An impact after a change: its mode, contact states and flags."""

    change: float
    mode: int
    states: int
    flags: int


class Change(NamedTuple):
    """A way to change an impact: the impact after a change, the unit of changes, and the least one."""

    at: Callable[[float], ChangedImpact]
    unit: float
    least: float = -inf


def margins(body: TwoPointBody, twist: Twist, law: str = "path") -> Margins:
    """How far the impact of `solve_impact` with the same arguments is from another mode.

    Where there is no impact, or none can be solved, there are no margins. An unknown law raises ValueError.
    """
    number, twist = number_of(law), Twist(*twist)
    mass, inertia, stands = body.mass, body.inertia, body.old is not None
    old, new = body.old or NOWHERE, body.new

    def at(change: float, case: Case) -> ChangedImpact:
        mode, _, _, _, _, _, states, flags, _, _, _ = answer(mass, inertia, stands, *case, number)
        return ChangedImpact(change=change, mode=mode, states=states, flags=flags)

    here = at(0.0, (old, new, twist))
    if here.mode == NO_IMPACT or here.flags & UNSOLVED:
        return NO_MARGINS

    stood = old if stands else new
    along, across, distance, height = frame_of(stood, new, stands)
    tangent = stood.normal[1], -stood.normal[0]
    speed = speed_of(old, twist) + speed_of(new, twist) if stands else speed_of(new, twist)
    ways = (
        Change(lambda s: at(s, rubbed(old, new, twist, s)), 1.0, -max(old.friction, new.friction)),
        Change(lambda s: at(s, centered(old, new, twist, along, s)), distance),
        Change(lambda s: at(s, centered(old, new, twist, across, s)), distance, -height if height >= 0.0 else -inf),
        Change(lambda s: at(s, (old, reaching(old, new, s), twist)), distance),
        Change(lambda s: at(s, (old, new, slipping(twist, tangent, s))), speed),
    )
    return Margins(*[nearest_border(way, here) for way in ways])


def margins_of(outcome: Outcome) -> Margins:
    """The margins of an impact that was solved. ValueError where the body also moved across the impact plane."""
    if outcome.body is None or outcome.before is None:
        raise ValueError("an impact with slip across the plane has no margins; ask solve_impact for those of the plane")
    # Where the total law answered for the path law, it was the path law that was asked.
    asked = "path" if outcome.flags & (Flag.BOTH_STRUCK | Flag.LAST_RESORT) else outcome.law
    return margins(outcome.body, outcome.before, asked)


def frame_of(stood: Contact, new: Contact, stands: bool) -> tuple[Vector, Vector, float, float]:
    """Unit vectors along the line of the contacts and across it, their distance, and the height of the mass centre."""
    nx, ny = stood.normal
    dx, dy = new.x - stood.x, new.y - stood.y
    distance = hypot(dx, dy)
    if distance > 0.0:
        dx, dy = dx / distance, dy / distance
    else:
        dx, dy = ny, -nx
    up = 1.0 if dx * (ny + new.normal[1]) >= dy * (nx + new.normal[0]) else -1.0
    x, y = -up * dy, up * dx
    height = -x * stood.x - y * stood.y
    return (dx, dy), (x, y), distance if stands else hypot(new.x, new.y), height


def speed_of(contact: Contact, twist: Twist) -> float:
    _, normal, tangential, *_ = see(contact, twist)
    return abs(normal) + abs(tangential)


def rubbed(old: Contact, new: Contact, twist: Twist, change: float) -> Case:
    """The impact with more friction at both contacts."""
    return (
        old._replace(friction=max(0.0, old.friction + change)),
        new._replace(friction=max(0.0, new.friction + change)),
        twist,
    )


def placed(contact: Contact, direction: Vector, shift: float) -> Contact:
    """The contact shifted in the body."""
    x, y = direction
    return contact._replace(x=contact.x + shift * x, y=contact.y + shift * y)


def centered(old: Contact, new: Contact, twist: Twist, direction: Vector, shift: float) -> Case:
    """The impact with the mass centre shifted in a body that moves as before."""
    vx, vy, omega = twist
    x, y = direction
    moved = Twist(vx - omega * shift * y, vy + omega * shift * x, omega)
    return placed(old, direction, -shift), placed(new, direction, -shift), moved


def reaching(old: Contact, new: Contact, shift: float) -> Contact:
    """The new contact shifted along its tangent, on a support that turns with that of the old contact."""
    nx, ny = new.normal
    x, y = new.x - old.x, new.y - old.y
    (ux, uy), (vx, vy), square = old.velocity, new.velocity, x * x + y * y
    turn = (x * (vy - uy) - y * (vx - ux)) / square if square > 0.0 else 0.0
    there = placed(new, (ny, -nx), shift)
    return there._replace(velocity=(vx + turn * shift * nx, vy + turn * shift * ny))


def slipping(twist: Twist, direction: Vector, change: float) -> Twist:
    return Twist(twist.vx + change * direction[0], twist.vy + change * direction[1], twist.omega)


def nearest_border(way: Change, here: ChangedImpact) -> Margin:
    """The nearest change of the mode along a way."""
    if not 0.0 < way.unit < inf:
        return NO_MARGIN
    last = {1.0: here, -1.0: here}
    for step in STEPS:
        found = []
        for side in tuple(last):
            change = max(side * step * way.unit, way.least)
            trial = way.at(change)
            if trial.flags & UNSOLVED:
                del last[side]
                continue
            border = border_between(way, last[side], trial)
            if border is not None:
                found.append(border)
            if trial.mode == here.mode:
                last[side] = trial
            if change == way.least:
                del last[side]
        if found:
            return min(found, key=lambda margin: abs(margin.change))
    return NO_MARGIN


def border_between(way: Change, near: ChangedImpact, far: ChangedImpact) -> Margin | None:
    """The border between two changes, if there is one; `near` has the mode of the unchanged impact."""
    if near.mode != far.mode:
        return border_in(way, near, far)
    if near.states != far.states:
        first = near
        for _ in range(PROBES):
            middle = way.at(0.5 * (near.change + far.change))
            if middle.mode != first.mode and not middle.flags & UNSOLVED:
                return border_in(way, near, middle)
            near, far = (middle, far) if middle.states == first.states else (near, middle)
    return None


def border_in(way: Change, near: ChangedImpact, far: ChangedImpact) -> Margin | None:
    """The border between two changes with different modes; None where the other mode is that of a single point."""
    outwards = copysign(BEYOND * way.unit, far.change - near.change)
    while abs(far.change - near.change) > ACCURACY * max(way.unit, abs(near.change)):
        trial = way.at(0.5 * (near.change + far.change))
        if trial.mode == near.mode:
            near = trial
        else:
            far = trial
    beyond = way.at(far.change + outwards).mode
    return None if beyond == near.mode else Margin(far.change, MODES[beyond])
