"""A body that turns about a contact which sticks on a fixed support, in closed form.

(rho^2 + R^2) phi'' = -g R cos(phi + beta), (R, beta) the polar place of the mass centre seen from the contact, as in
eq. (2.1) and (2.5) of Polukoshko and Sokolova with the height of the mass centre. Energy gives the rate and the
reaction at every angle, Carlson's integral R_F the time.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from ..types import Vector
from .events import ROUNDING, Event, first_descent

FULL_TURN: Final = 2.0 * math.pi


class Pivot(NamedTuple):
    """A phase of turning about one point of a fixed support, which sticks or slips, and how it ends.

    `time` it lasts in s; `turned` meanwhile in rad, CCW positive; `omega` in rad/s and `slip`, the velocity of the
    contact in m/s, at its end; `moved`, how far the contact slipped, in m; `direction` +1 or -1, of the turning.
    """

    event: Event
    time: float
    turned: float
    omega: float
    slip: float = 0.0
    moved: float = 0.0
    direction: int = 0


def turn(arm: Vector, omega: float, travel: Vector, rho_squared: float, friction: float, gravity: Vector) -> Pivot:
    """Turn about a contact that sticks until the first event.

    `arm` from the contact to the mass centre in m; `omega` in rad/s; `travel` how far in rad the body can turn
    clockwise and counter-clockwise until another point touches; `rho_squared` in m^2; `gravity` in m/s^2. The event
    is TOUCHES, SLIPS, SLIPS_BACK, TURNS_BACK or NEVER.
    """
    weight, radius = math.hypot(*gravity), math.hypot(*arm)
    inertia = rho_squared + radius * radius
    stiffness = radius * weight / inertia if radius > 0.0 else 0.0
    slope = math.atan2(gravity[0], -gravity[1])  # of "up" against the support's normal, CCW
    tilt = math.remainder(math.atan2(-arm[0], arm[1]) - slope, FULL_TURN)  # from the balance, CCW
    fall = omega or (tilt if stiffness > 0.0 else 0.0)
    direction = (fall > 0.0) - (fall < 0.0)
    reach = travel[direction > 0] if direction else math.inf
    if reach <= 0.0:
        return Pivot(
            event=Event.TOUCHES if omega else Event.NEVER, time=0.0, turned=0.0, omega=omega, direction=direction
        )
    lean, rate = direction * tilt, abs(omega)
    crest = _to_standstill(stiffness, lean, rate) if direction else 0.0
    last = min(reach, crest, FULL_TURN)

    if friction < math.inf:
        energy = omega * omega + 2.0 * stiffness * math.cos(tilt)
        reaction = weight, radius * energy, radius * stiffness
        edge = math.atan2(1.0, friction)
        forward = _first_slip(reaction, tilt, direction, -edge - slope, last)
        backward = _first_slip(reaction, tilt, direction, edge - slope, last)
        slip_at, slip_direction = min((forward, 1), (backward, -1))
        if forward == backward == 0.0:
            # Sticking would take a pull, yet the contact is pressed down: only this slip leaves it on the support.
            slip_direction = 1 if arm[0] * arm[1] > 0.0 else -1
        if slip_at <= last:
            end_rate = _rate(stiffness, lean, rate, slip_at)
            time = _swing(stiffness, lean, rate, slip_at, end_rate)
            event = Event.SLIPS if slip_direction > 0 else Event.SLIPS_BACK
            return Pivot(event=event, time=time, turned=direction * slip_at, omega=direction * end_rate)
    if reach <= crest and reach < math.inf:
        end_rate = _rate(stiffness, lean, rate, reach)
        time = _swing(stiffness, lean, rate, reach, end_rate)
        turned, omega = direction * reach, direction * end_rate
        return Pivot(event=Event.TOUCHES, time=time, turned=turned, omega=omega, direction=direction)
    if rate > 0.0 and crest < math.inf:
        time = _swing(stiffness, lean, rate, crest, 0.0)
        return Pivot(event=Event.TURNS_BACK, time=time, turned=direction * crest, omega=0.0)
    return Pivot(event=Event.NEVER, time=0.0, turned=0.0, omega=omega)


def roll(arm: Vector, omega: float, travel: Vector, rho_squared: float, friction: float, gravity: Vector) -> Pivot:
    """As `turn`, for a disc about an edge: its normal turns with it."""
    pivot = turn(arm, omega, travel, rho_squared, math.inf, gravity)
    if not pivot.turned:
        return pivot
    direction = 1.0 if pivot.turned > 0.0 else -1.0
    nearest, event = _first_slip_of_disc(arm, omega, direction, rho_squared, friction, gravity, abs(pivot.turned))
    if nearest == 0.0:
        return Pivot(event=event, time=0.0, turned=0.0, omega=omega)
    if nearest < math.inf:
        return turn(arm, omega, (nearest, nearest), rho_squared, math.inf, gravity)._replace(event=event)
    return pivot


def _to_standstill(stiffness: float, lean: float, rate: float) -> float:
    """How far in rad the body turns until it stands still: inf when it passes the balance.

    `lean` is the angle from the balance (rad, positive when turning away from it), `rate` the angular speed.
    """
    height = math.sin(0.5 * lean) ** 2  # of the balance above the mass centre
    if rate * rate > 4.0 * stiffness * height or stiffness <= 0.0:
        return math.inf
    climb = rate * rate / (4.0 * stiffness)
    stop = 2.0 * math.asin(math.sqrt(height - climb)) if height > climb else 0.0
    if lean >= 0.0:
        return FULL_TURN - stop - lean
    # The difference stop + lean would lose a small climb.
    return 2.0 * math.asin(min(1.0, climb / math.sin(0.5 * (stop - lean))))


def _rate(stiffness: float, lean: float, rate: float, travel: float) -> float:
    """The angular speed after some travel, from the energy."""
    gain = 4.0 * stiffness * math.sin(0.5 * travel) * math.sin(lean + 0.5 * travel)
    return math.sqrt(max(0.0, rate * rate + gain))


def _swing(stiffness: float, lean: float, rate: float, travel: float, end_rate: float) -> float:
    """Time in s that a swing takes, from the energy integral."""
    half_turn = math.floor(lean / math.pi)
    time, turned, part_rate = 0.0, 0.0, rate
    while turned < travel:
        half_turn += 1
        border = half_turn * math.pi - lean  # next passage over the balance or under the contact
        if border <= turned:
            continue
        part = min(border, travel) - turned
        next_rate = end_rate if border >= travel else _rate(stiffness, lean, rate, border)
        # Angles from the balance on the same side of it: the second half of a turn is the first one backwards.
        if half_turn % 2:
            low = lean + turned - (half_turn - 1) * math.pi
            time += _half_swing(low, part_rate, low + part, next_rate, part)
        else:
            low = border - turned - part
            time += _half_swing(low, next_rate, low + part, part_rate, part)
        turned += part
        part_rate = next_rate
    return time


def _half_swing(low: float, low_rate: float, high: float, high_rate: float, part: float) -> float:
    """Time between two angles in 0..pi from the balance, `part` apart.

    With u = tan^2(angle/2) the time is the integral of du / sqrt(u (1 + u) (a + b u)), an R_F of both ends (NIST
    Digital Library of Mathematical Functions, 19.29.4) in which nothing cancels.
    """
    low_sine, low_cosine = math.sin(0.5 * low), math.cos(0.5 * low)
    high_sine, high_cosine = math.sin(0.5 * high), math.cos(0.5 * high)
    across, along = high_sine * low_cosine, low_sine * high_cosine
    first = across * low_rate + along * high_rate
    second = across * high_rate + along * low_rate
    third = high_sine * high_cosine * low_rate + low_sine * low_cosine * high_rate
    scale = 2.0 * math.sin(0.5 * part) * math.sin(0.5 * (low + high))
    return scale * _carlson(first * first, second * second, third * third)


def _carlson(x: float, y: float, z: float) -> float:
    """Carlson's R_F(x, y, z) by duplication (Numer. Algorithms 10, 1995); inf when two arguments are zero."""
    if (x <= 0.0) + (y <= 0.0) + (z <= 0.0) > 1:
        return math.inf
    mean = (x + y + z) / 3.0
    # Where the arguments differ by less the series below is exact to rounding.
    while max(abs(mean - x), abs(mean - y), abs(mean - z)) > 0.008 * mean:
        root_x, root_y, root_z = math.sqrt(x), math.sqrt(y), math.sqrt(z)
        shift = root_x * (root_y + root_z) + root_y * root_z
        x, y, z, mean = 0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift), 0.25 * (mean + shift)
    x, y, z = (mean - x) / mean, (mean - y) / mean, (mean - z) / mean
    second, third = x * y - z * z, x * y * z
    series = second * (-1.0 / 10.0 + second / 24.0 - 3.0 * third / 44.0 - 5.0 * second * second / 208.0) + third * (
        1.0 / 14.0 + 3.0 * third / 104.0
    )
    return (1.0 + series) / math.sqrt(mean)


def _first_slip(reaction: tuple[float, float, float], tilt: float, direction: int, edge: float, last: float) -> float:
    """How far in rad the body turns until the reaction leaves one edge of the friction cone.

    The reaction of the support, for a mass of 1 and with r = (weight, R energy, R stiffness), has the part
    (r0 + r2/2) cos(edge) - r1 cos(tilt - edge) + (3/2) r2 cos(2 tilt - edge) inside an edge, whose inward normal lies
    `edge` rad from "up".
    """
    weight, spin, pull = reaction
    level = (weight + 0.5 * pull) * math.cos(edge)
    single = -spin * math.cos(tilt - edge), direction * spin * math.sin(tilt - edge)
    double = 1.5 * pull * math.cos(2.0 * tilt - edge), -1.5 * direction * pull * math.sin(2.0 * tilt - edge)
    inside = level + single[0] + double[0]
    if inside < -ROUNDING * (weight + abs(spin) + 2.0 * pull):
        return 0.0
    cosine, sine = math.cos(last), math.sin(last)
    inside_last = level + single[0] * cosine + single[1] * sine
    inside_last += double[0] * (1.0 - 2.0 * sine * sine) + double[1] * 2.0 * sine * cosine
    # A function that bends no more than this keeps above its chord less an eighth of it.
    if min(inside, inside_last) > 0.125 * (abs(spin) + 6.0 * pull) * last * last:
        return math.inf
    return first_descent(level, 0.0, 0.0, ((*single, 1.0), (*double, 2.0)), last)


def _first_slip_of_disc(
    arm: Vector, omega: float, direction: float, rho_squared: float, friction: float, gravity: Vector, last: float
) -> tuple[float, Event]:
    """How far in rad a disc turns about an edge until friction cannot hold it, inf if it can, and which way it slips.

    With the angle x turned, energy gives omega^2, and f N + T and f N - T are a constant, a cosine and a sine of x.
    """
    (dx, dy), (gx, gy) = arm, gravity
    radius = math.hypot(dx, dy)
    inertia = rho_squared + radius * radius
    # g . d and d x g turn into each other; N = -(g . d)/R - omega^2 R, T = rho^2 (d x g)/(R I), and omega^2 grows by
    # twice what g . d does, over I.
    along, across = gx * dx + gy * dy, dx * gy - dy * gx
    load = friction * (1.0 / radius + 2.0 * radius / inertia)
    level = friction * radius * (2.0 * along / inertia - omega * omega)
    nearest, event = math.inf, Event.NEVER
    for slip, slips in ((1.0, Event.SLIPS), (-1.0, Event.SLIPS_BACK)):
        drag = slip * rho_squared / (radius * inertia)
        cosine, sine = -load * along + drag * across, direction * (-load * across - drag * along)
        at = 0.0 if level + cosine < 0.0 else first_descent(level, 0.0, 0.0, ((cosine, sine, 1.0),), last)
        if at < nearest:
            nearest, event = at, slips
    return nearest, event
