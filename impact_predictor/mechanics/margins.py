"""How far an impact is from another mode: in friction, in geometry and in speed.

Along each way the nearest border is looked for outwards on both sides at the STEPS, and between two of them where the
contact states differ; it is halved down to its place. So a mode is found that holds over a thirty-second of the way's
unit and over half of its distance; a narrower one if the contact states beyond it differ too.
"""

from __future__ import annotations

from math import copysign, hypot, inf
from typing import NamedTuple

from .impact import MODES, NOWHERE, approach, number_of
from .impact.answer import NO_IMPACT, answer
from .types import Contact, Flag, Mode, Twist, TwoPointBody, Vector

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

AskedImpact = tuple[float, float, bool, Contact, Contact, Twist, int]
"""Mass, inertia, whether there is an old contact, both contacts, the twist before the impact, and the law's number."""


class ChangedImpact(NamedTuple):
    """An impact after a change: its mode, contact states and flags."""

    change: float
    mode: int
    states: int
    flags: int


class Change(NamedTuple):
    """A way to change an impact: the unit of changes, the least one, and what grows by how much with a change of 1.

    That is the friction of both contacts, their places, the velocity of the new one's support, and that of the body.
    """

    asked: AskedImpact
    unit: float = 1.0
    least: float = -inf
    friction: float = 0.0
    old: Vector = (0.0, 0.0)
    new: Vector = (0.0, 0.0)
    support: Vector = (0.0, 0.0)
    velocity: Vector = (0.0, 0.0)

    def at(self, change: float) -> ChangedImpact:
        """The impact after a change."""
        mass, inertia, stands, old, new, (vx, vy, omega), law = self.asked
        (ax, ay), (bx, by), (ux, uy), (wx, wy) = self.old, self.new, self.support, self.velocity
        (old_x, old_y, old_friction, *_), (new_x, new_y, new_friction, _, _, (sx, sy)) = old, new
        rougher = change * self.friction
        old = old._replace(x=old_x + change * ax, y=old_y + change * ay, friction=max(0.0, old_friction + rougher))
        new = new._replace(x=new_x + change * bx, y=new_y + change * by, friction=max(0.0, new_friction + rougher))
        new = new._replace(velocity=(sx + change * ux, sy + change * uy))
        twist = Twist(vx + change * wx, vy + change * wy, omega)
        mode, _, _, _, _, _, states, flags, _, _, _ = answer(mass, inertia, stands, old, new, twist, law)
        return ChangedImpact(change=change, mode=mode, states=states, flags=flags)


def margins(body: TwoPointBody, twist: Twist, law: str = "path", restitution: str = "poisson") -> Margins:
    """How far the impact of `solve_impact` with the same arguments is from another mode.

    Where there is no impact, or none can be solved, there are no margins. An unknown law or rule raises
    ValueError.
    """
    twist, stands, old, new = Twist(*twist), body.old is not None, body.old or NOWHERE, body.new
    asked = body.mass, body.inertia, stands, old, new, twist, number_of(law, restitution)
    here = Change(asked).at(0.0)
    if here.mode == NO_IMPACT or here.flags & UNSOLVED:
        return NO_MARGINS

    # The line of the contacts, across it out of the support, and the height of the mass centre above it.
    stood = old if stands else new
    (nx, ny), (bx, by) = stood.normal, new.normal
    dx, dy = new.x - stood.x, new.y - stood.y
    distance = hypot(dx, dy)
    along_x, along_y = (dx / distance, dy / distance) if distance > 0.0 else (ny, -nx)
    up = 1.0 if along_x * (ny + by) >= along_y * (nx + bx) else -1.0
    across_x, across_y = -up * along_y, up * along_x
    height = -across_x * stood.x - across_y * stood.y

    def shifted(x: float, y: float, least: float = -inf) -> Change:
        """The mass centre shifts in a body that moves as before."""
        velocity = -twist.omega * y, twist.omega * x
        return Change(asked, unit=unit, least=least, old=(-x, -y), new=(-x, -y), velocity=velocity)

    unit = distance if stands else hypot(new.x, new.y)
    speed = 0.0
    for contact in (old, new) if stands else (new,):
        normal, slip = approach(contact, twist)
        speed += abs(normal) + abs(slip)
    # The support of the new contact turns with that of the old one.
    (ux, uy), (wx, wy) = old.velocity, new.velocity
    x, y = new.x - old.x, new.y - old.y
    square = x * x + y * y
    turn = (x * (wy - uy) - y * (wx - ux)) / square if square > 0.0 else 0.0
    ways = (
        Change(asked, least=-max(old.friction, new.friction), friction=1.0),
        shifted(along_x, along_y),
        shifted(across_x, across_y, -height if height >= 0.0 else -inf),
        Change(asked, unit=unit, new=(by, -bx), support=(turn * bx, turn * by)),
        Change(asked, unit=speed, velocity=(ny, -nx)),
    )
    return Margins(*[nearest_border(way, here) for way in ways])


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
    probes, mode = PROBES if near.states != far.states else 0, near.mode
    for _ in range(probes):
        middle = way.at(0.5 * (near.change + far.change))
        if middle.mode != mode and not middle.flags & UNSOLVED:
            return border_in(way, near, middle)
        near, far = (middle, far) if middle.states == near.states else (near, middle)
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
