"""Time stepping after Moreau: the touchdown and the impact with contact laws in velocities and no events.

A step of length h: contacts are closed whose gaps, half a step ahead, are zero or less; there Signorini's and Coulomb's
laws hold for the velocities at the end of the step, and the impulses of the step change the velocities at once, with
the geometry of half a step ahead. The contact problem of a step is solved by this program's total law, exactly.
"""

from __future__ import annotations

from math import cos, inf, sin

from ...mechanics.answer import TOTAL, answer
from ...mechanics.impact import MODES, NOWHERE
from ...mechanics.types import Contact, Twist
from .impact_scenes import After, Strike
from .methods import Method, over
from .touchdown_scenes import Falling, Landing

TIME_STEPS = (1e-2, 1e-3, 1e-4)
HORIZON = 20.0

IMPACT_STEPS = (1e-2, 1e-3, 1e-4, 1e-5)

BEFORE = 0.6
"""Where in its grid of steps an impact happens: so many steps after the start."""

STEPS = 3
"""Steps through an impact: one before it, the impact, and one after it."""

LEAVES = 1e-9
"""A contact leaves that opens faster than this part of the body's speed."""

FAMILIES = {
    "time stepping": "Moreau's scheme with the step dt: contact laws in velocities at the end of each step, no events; "
    "each step's contact problem is solved exactly, by the total law.",
}


def touchdown(fall: Falling, h: float) -> Landing | None:
    """Steps until the gap of a new point is closed; its time is interpolated within the step."""
    (x, y, angle, vx, vy, omega), points, stance, rho_squared, friction, (pull_x, pull_y) = fall
    others = [point for index, point in enumerate(points) if index != stance]
    foot = None if stance is None else points[stance]
    half, time, above = 0.5 * h, -0.5 * h, inf
    while time < HORIZON:
        time += h
        x, y, angle = x + half * vx, y + half * vy, angle + half * omega
        c, s = cos(angle), sin(angle)
        gap = y + min([s * px + c * py for px, py in others])
        if gap <= 0.0:
            back = h * gap / (gap - above) if above < inf else 0.0
            return Landing(max(0.0, time - back), Twist(vx, vy, omega))
        above = gap
        vx, vy = vx + h * pull_x, vy + h * pull_y
        if foot is not None:
            px, py = c * foot[0] - s * foot[1], s * foot[0] + c * foot[1]
            if y + py <= 0.0:
                closed = Contact(px, py, friction)
                vx, vy, omega = answer(1.0, rho_squared, False, NOWHERE, closed, Twist(vx, vy, omega), TOTAL)[1]
        x, y, angle = x + half * vx, y + half * vy, angle + half * omega
    return None


def impact(strike: Strike, h: float) -> After:
    """A few steps of a body that comes with its twist, without gravity; its old contact is closed until it leaves."""
    body, (vx, vy, omega) = strike.body, strike.twist
    mass, inertia, old, new = body
    back = -BEFORE * h
    x, y, angle = back * vx, back * vy, back * omega
    half, mode, closed = 0.5 * h, 0, old is not None
    for _ in range(STEPS):
        x, y, angle = x + half * vx, y + half * vy, angle + half * omega
        c, s = cos(angle), sin(angle)
        b, gap = moved(new, x, y, c, s)
        a = NOWHERE
        if old is not None:
            a, gap_old = moved(old, x, y, c, s)
            closed = closed or gap_old <= 0.0
        if gap <= 0.0:
            found = answer(mass, inertia, closed, a, b, Twist(vx, vy, omega), TOTAL)
        elif closed:
            found = answer(mass, inertia, False, NOWHERE, a, Twist(vx, vy, omega), TOTAL)
        else:
            break
        vx, vy, omega = found[1]
        mode = mode or (found[0] if gap <= 0.0 else 0)
        nx, ny = a.normal
        closed = closed and nx * (vx - omega * a.y) + ny * (vy + omega * a.x) <= LEAVES * (abs(vx) + abs(vy))
        x, y, angle = x + half * vx, y + half * vy, angle + half * omega
    return After(Twist(vx, vy, omega), MODES[mode])


def moved(contact: Contact, x: float, y: float, c: float, s: float) -> tuple[Contact, float]:
    """A contact of a body that is away from its place at the impact by x, y and a turn, and its gap."""
    px, py = c * contact.x - s * contact.y, s * contact.x + c * contact.y
    nx, ny = contact.normal
    return contact._replace(x=px, y=py), nx * (x + px - contact.x) + ny * (y + py - contact.y)


METHODS: list[Method] = over("time stepping", "Moreau time stepping", "dt = {:g} s", TIME_STEPS, touchdown)

IMPACT_METHODS: list[Method] = over(
    "time stepping",
    "Moreau time stepping",
    "dt = {:g} s",
    IMPACT_STEPS,
    impact,
    applies=lambda strike: strike.ordinary,
)
