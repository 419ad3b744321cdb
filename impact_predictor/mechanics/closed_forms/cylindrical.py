"""Closed forms of a cylinder that rolls over the edge A and strikes the edge B (the paper, section 4).

`t` > 0 is the tangent of gamma, the central angle of each edge, and `f` the friction of both edges. Angles gamma_1 and
gamma_2 that differ are their mean, seen from a frame that is turned. `k` is the inertia by mass and radius squared:
1/2 if homogeneous, 1 of a thin tube.

A lifts if the first impulse at B lifts it; the cylinder then turns on about B, unless A closes again, which stops it.
While A holds, the cylinder spins in place, and stops if friction stops that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import bodies
from ..bodies import Number
from .flat import ClosedForm, Truths, UnitImpact, closed_form, select, speed

HOMOGENEOUS = 0.5


def stop(t: Number, f: Number, k: Number = HOMOGENEOUS) -> UnitImpact:
    """STOP: both edges stick.

    S_FA + S_FB = k and S_NB - S_NA = (1 + k) / t are determined. How much the edges push against each other besides
    is a choice: the least that friction allows.
    """
    less, more = 1.0 - k, (1.0 + k) / t
    # u = 1 + S_FA - S_FB grows with the push; it is least where -S_FA or S_FB is all that friction can give.
    u = np.maximum(less + f * more, 1.0 + k - f * more) / (1.0 + f * t)
    return UnitImpact(0.0, 0.0, 0.5 * (t * u - more), 0.5 * (u - less), 0.5 * (t * u + more), 0.5 * (1.0 + k - u))


def slide(t: Number, f: Number, k: Number = HOMOGENEOUS) -> UnitImpact:
    """SLIDE, eq. (4.1) with its omega_1 corrected: the cylinder spins in place."""
    size = 1.0 + f * f
    normal_old = (t * t - 2.0 * f * t - 1.0) / (2.0 * t * size)
    normal_new = (t * t + 1.0) / (2.0 * t * size)
    omega = f * (t - f) / (k * size) - 1.0
    return UnitImpact(omega, omega, normal_old, f * normal_old, normal_new, f * normal_new)


def pivot(t: Number, k: Number = HOMOGENEOUS) -> UnitImpact:
    """PIVOT, eq. (4.2) with its S_FB corrected: the cylinder rolls over B."""
    size = 1.0 + t * t
    friction = 2.0 * k * t * t / ((1.0 + k) * size)
    return UnitImpact(2.0 * t * t / ((1.0 + k) * size) - 1.0, 0.0, 0.0, 0.0, 2.0 * t / size, friction)


def pivot_slide(t: Number, f: Number, k: Number = HOMOGENEOUS) -> UnitImpact:
    """PIVOT_SLIDE, eq. (4.3) with its v_s corrected: B slips backwards."""
    normal = 2.0 * t / (1.0 + t * t)
    return UnitImpact(f * normal / k - 1.0, normal * (f * (1.0 + 1.0 / k) - t), 0.0, 0.0, normal, f * normal)


def old_lifts(t: Number, f: Number) -> Truths:
    """Whether the first impulse at B lifts A: tan(gamma) < f + sqrt(1 + f^2), from S_NA of eq. (4.1)."""
    return np.asarray(t * t - 1.0 < 2.0 * f * t)


def stop_domain(t: Number, f: Number, k: Number = HOMOGENEOUS) -> Truths:
    """Where the cylinder stops: after (4.1), without the printed upper bound on f."""
    stays = (1.0 - k) * t * t >= 1.0 + k
    sticks = f * (1.0 + k) >= k * t
    return np.where(old_lifts(t, f), sticks & stays, (1.0 + k) * f * f - f * t + k <= 0.0)


def slide_domain(t: Number, f: Number, k: Number = HOMOGENEOUS) -> Truths:
    """Where the cylinder spins in place: after (4.1)."""
    return ~old_lifts(t, f) & ((1.0 + k) * f * f - f * t + k > 0.0)


def pivot_slide_domain(t: Number, f: Number, k: Number = HOMOGENEOUS) -> Truths:
    """Where the cylinder turns about B, which slides: after (4.3), corrected."""
    return old_lifts(t, f) & (f * (1.0 + k) < k * t)


def pivot_domain(t: Number, f: Number, k: Number = HOMOGENEOUS) -> Truths:
    """Where the cylinder rolls over B: after (4.2), corrected."""
    return old_lifts(t, f) & (f * (1.0 + k) >= k * t) & ((1.0 - k) * t * t < 1.0 + k)


def locks(t: Number, f: Number) -> Truths:
    """Whether the edges can hold the cylinder between them against any load, f >= 1 / t.

    The total law then allows STOP too, in whichever domain the cylinder lies; the impulse path does not go there.
    """
    return np.asarray(f * t >= 1.0)


def stop_tangent(k: Number = HOMOGENEOUS) -> NDArray[np.float64]:
    """Tangent of the gamma from which on a cylinder cannot roll over B, inf if there is none (Fig. 7: sqrt 3).

    It is the border of PIVOT and STOP, from `pivot_friction` there upwards.
    """
    less = np.asarray(1.0 - k)
    return np.where(less > 0.0, np.sqrt((1.0 + k) / np.where(less > 0.0, less, 1.0)), np.inf)


def stop_friction(t: Number, k: Number = HOMOGENEOUS) -> NDArray[np.float64]:
    """Friction between SLIDE below and STOP above; nan where they have no border (Fig. 7: (t - sqrt(t^2 - 3)) / 3)."""
    room = t * t - 4.0 * k * (1.0 + k)
    borders = (room >= 0.0) & ((k > 0.5) | (t >= stop_tangent(k)))
    return np.where(borders, 2.0 * k / (t + np.sqrt(np.where(borders, room, 0.0))), np.nan)


def spin_friction(t: Number, k: Number = HOMOGENEOUS) -> NDArray[np.float64]:
    """Friction between STOP below and SLIDE above, which meet so if k > 1/2; nan where they have no border."""
    room = t * t - 4.0 * k * (1.0 + k)
    borders = (room >= 0.0) & (k > 0.5) & (t <= stop_tangent(k))
    return np.where(borders, (t + np.sqrt(np.where(borders, room, 0.0))) / (2.0 * (1.0 + k)), np.nan)


def lift_friction(t: Number, k: Number = HOMOGENEOUS) -> NDArray[np.float64]:
    """Friction between SLIDE below and PIVOT_SLIDE above; nan where they have no border.

    Fig. 7: tan(gamma) = f + sqrt(1 + f^2), which is f = (t - 1 / t) / 2.
    """
    return np.where((t >= 1.0) & (t <= stop_tangent(k)), 0.5 * (t - 1.0 / t), np.nan)


def pivot_friction(t: Number, k: Number = HOMOGENEOUS) -> NDArray[np.float64]:
    """Friction between PIVOT_SLIDE below and PIVOT above; nan where they have no border (Fig. 7: t / 3)."""
    return np.where(t <= stop_tangent(k), k * t / (1.0 + k), np.nan)


def cylinder(
    radius: Number,
    gamma: Number,
    mass: Number,
    friction: Number,
    gamma_new: Number | None = None,
    inertia: Number | None = None,
    *,
    omega: Number,
) -> ClosedForm:
    """The impact of a cylinder that comes with `omega` < 0 (rad/s); the rest as in `bodies.cylinder`."""
    body = bodies.cylinder(radius, gamma, mass, friction, gamma_new, inertia)
    w, ahead = speed(omega), gamma if gamma_new is None else gamma_new
    t, k, f = np.tan(0.5 * (gamma + ahead)), body.inertia / (mass * radius * radius), friction
    domains = [domain(t, f, k) for domain in (stop_domain, slide_domain, pivot_slide_domain, pivot_domain)]
    mode, unit = select(domains, [stop(t, f, k), slide(t, f, k), pivot_slide(t, f, k), pivot(t, k)])
    after, slip = w * unit.omega, w * radius * unit.slip
    along = slip - after * radius
    twist = along * np.cos(ahead), along * np.sin(ahead), after
    return closed_form(mode, twist, slip, [mass * w * radius * part for part in unit[2:]])
