"""Closed forms of a body on a flat floor: the plate (the paper, section 3) and the rod (section 2).

The body turns clockwise about the old contact A, at rest, and strikes the floor with the new contact B. The mass centre
of a plate lies half its height above the floor, that of a rod half its thickness. `f` is the friction of both contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import bodies
from ..bodies import Number
from ..types import Mode, TwoPointBody

Modes = NDArray[np.uint8]
Truths = NDArray[np.bool_]

MODES = (Mode.STOP, Mode.SLIDE, Mode.PIVOT_SLIDE, Mode.PIVOT)
"""The modes of a plastic impact of a body that turned about its old contact at rest."""


class UnitImpact(NamedTuple):
    """What an impact does to a body of mass 1 kg that came with omega = -1 rad/s; a cylinder has the radius 1 m.

    Everything grows in proportion to the angular velocity before, impulses to the mass, lengths to the radius.
    `omega` after the impact in rad/s; `slip` of the contacts that stay, along their tangents in m/s; impulses on the
    body in N s along normals and tangents.
    """

    omega: Number
    slip: Number
    normal_old: Number
    friction_old: Number
    normal_new: Number
    friction_new: Number


class ClosedForm(NamedTuple):
    """An impact by the closed forms, over the broadcast shape (...) of what was asked.

    `mode` (...) numbers of Mode; `twist` (..., 3) as (vx, vy, omega) of the mass centre in m/s and rad/s; `slip` (...)
    of the contacts that stay, along their tangents in m/s; `impulses` (..., 2, 2) as ((N_old, T_old), (N_new, T_new))
    in N s.
    """

    mode: Modes
    twist: NDArray[np.float64]
    slip: NDArray[np.float64]
    impulses: NDArray[np.float64]


class FlatBody(NamedTuple):
    """A body on a flat floor: A lies `a` > 0 behind and B `b` > 0 ahead of the mass centre, `height` >= 0 below it (m).

    `rho2` is the square of the radius of gyration in m^2.
    """

    a: Number
    b: Number
    height: Number
    rho2: Number


def rectangle(delta: Number, a: Number = 0.5, b: Number = 0.5) -> FlatBody:
    """A homogeneous plate of length 1 and height `delta`, as in Fig. 5; `a` and `b` are parts of its length."""
    return FlatBody(a, b, 0.5 * delta, (1.0 + delta * delta) / 12.0)


def bar(length: Number, thickness: Number, a: Number, b: Number) -> FlatBody:
    """A homogeneous rod with the inertia of a line, mass length^2 / 12 (section 2.1); slender with a thickness of 0."""
    return FlatBody(a, b, 0.5 * thickness, length * length / 12.0)


def stop(shape: FlatBody, f: Number) -> UnitImpact:
    """STOP, eq. (3.1), of a rod eq. (2.2), whose first forms lack the height.

    How the contacts share S_FA + S_FB = -m omega h is a choice: equally, as far as the friction of both allows.
    """
    a, b, h, rho2 = shape
    normal_old = (a * b - rho2 - h * h) / (a + b)
    normal_new = (a * a + rho2 + h * h) / (a + b)
    share = np.maximum(np.minimum(0.5 * h, f * normal_old), h - f * normal_new)
    return UnitImpact(0.0, 0.0, normal_old, -share, normal_new, share - h)


def slide(shape: FlatBody, f: Number) -> UnitImpact:
    """SLIDE, eq. (3.2)."""
    a, b, h, rho2 = shape
    normal_old = (a * b - rho2 - f * h * a) / (a + b)
    normal_new = (a * a + rho2 + f * h * a) / (a + b)
    return UnitImpact(0.0, h - f * a, normal_old, -f * normal_old, normal_new, -f * normal_new)


def pivot(shape: FlatBody) -> UnitImpact:
    """PIVOT, eq. (3.3), of a rod eq. (2.6) with the sign of omega_1 in its second line corrected."""
    a, b, h, rho2 = shape
    size = rho2 + h * h + b * b
    normal = (rho2 + h * h) * (a + b) / size
    return UnitImpact((a * b - rho2 - h * h) / size, 0.0, 0.0, 0.0, normal, -h * b * (a + b) / size)


def pivot_slide(shape: FlatBody, f: Number) -> UnitImpact:
    """PIVOT_SLIDE, eq. (3.4) with its v_s corrected."""
    a, b, h, rho2 = shape
    size = rho2 + b * b - f * h * b
    normal = rho2 * (a + b) / size
    slip = (a + b) * (h * b - f * (rho2 + h * h)) / size
    return UnitImpact((a * b - rho2 - f * h * a) / size, slip, 0.0, 0.0, normal, -f * normal)


def old_is_pressed(shape: FlatBody) -> Truths:
    """Whether an impact that stops the body presses A down, ab >= rho^2 + h^2: eq. (2.3), and section 3 after (3.1)."""
    a, b, h, rho2 = shape
    return np.asarray(a * b >= rho2 + h * h)


def stop_domain(shape: FlatBody, f: Number) -> Truths:
    """Where the body stops; the sticking condition after (3.1) is corrected to f >= h / a, as in eq. (2.4)."""
    return old_is_pressed(shape) & (f * shape.a >= shape.height)


def slide_domain(shape: FlatBody, f: Number) -> Truths:
    """Where the body slides on both contacts: section 3, after (3.2)."""
    a, b, h, rho2 = shape
    return np.where(old_is_pressed(shape), f * a < h, f * h * a <= a * b - rho2)


def pivot_domain(shape: FlatBody, f: Number) -> Truths:
    """Where the body turns about B, which sticks: section 3, after (3.3)."""
    _, b, h, rho2 = shape
    return ~old_is_pressed(shape) & (f * (rho2 + h * h) >= h * b)


def pivot_slide_domain(shape: FlatBody, f: Number) -> Truths:
    """Where the body turns about B, which slides: section 3, after (3.4)."""
    a, b, h, rho2 = shape
    return ~old_is_pressed(shape) & (f * h * a > a * b - rho2) & (f * (rho2 + h * h) < h * b)


def stop_friction(shape: FlatBody) -> NDArray[np.float64]:
    """Friction f = h / a between SLIDE below and STOP above (Fig. 5: f = delta); nan where they have no border."""
    a, _, h, _ = shape
    return np.where(old_is_pressed(shape), h / a, np.nan)


def lift_friction(shape: FlatBody) -> NDArray[np.float64]:
    """Friction f = (ab - rho^2) / (ha) between SLIDE below and PIVOT_SLIDE above; nan where they have no border.

    Fig. 5: f = (2 - delta^2) / (3 delta).
    """
    a, b, h, rho2 = shape
    room = a * b - rho2
    borders = (room >= 0.0) & (room <= h * h) & (h > 0.0)
    return np.where(borders, room / (np.where(borders, h, 1.0) * a), np.nan)


def pivot_friction(shape: FlatBody) -> NDArray[np.float64]:
    """Friction f = hb / (rho^2 + h^2) between PIVOT_SLIDE below and PIVOT above; nan where they have no border.

    Fig. 5: f = 3 delta / (4 delta^2 + 1).
    """
    a, b, h, rho2 = shape
    return np.where(a * b <= rho2 + h * h, h * b / (rho2 + h * h), np.nan)


def stop_height(length: Number, a: Number, b: Number) -> NDArray[np.float64]:
    """Height of the highest homogeneous plate that can stop (m), 0 if none does.

    It is the border of STOP and PIVOT, from f = h / a upwards (Fig. 5: delta = 1 / sqrt 2).
    """
    return np.sqrt(np.maximum(3.0 * a * b - 0.25 * length * length, 0.0))


def stop_distance(length: Number, thickness: Number = 0.0) -> NDArray[np.float64]:
    """Distance of both supports from the middle of a rod from which on it stops, eq. (2.3): 0.289 l if slender (m)."""
    return np.sqrt((length * length + 3.0 * thickness * thickness) / 12.0)


def rod_ratio(length: Number, thickness: Number, a: Number, b: Number) -> Number:
    """Part k of its angular velocity that a rod keeps in PIVOT: after (2.6), with 12 b^2 below the line."""
    square = length * length + 3.0 * thickness * thickness
    return (square - 12.0 * a * b) / (square + 12.0 * b * b)


def plate(
    length: Number,
    height: Number,
    mass: Number,
    friction: Number,
    inertia: Number | None = None,
    a: Number | None = None,
    b: Number | None = None,
    *,
    omega: Number,
) -> ClosedForm:
    """The impact of a plate that comes with `omega` < 0 in rad/s; the rest as in `bodies.plate`, a and b above 0."""
    return strike(bodies.plate(length, height, mass, friction, inertia, a, b), omega)


def rod(
    length: Number,
    thickness: Number,
    a: Number,
    b: Number,
    mass: Number,
    friction: Number,
    inertia: Number | None = None,
    *,
    omega: Number,
) -> ClosedForm:
    """The impact of a rod that comes with `omega` < 0 in rad/s; the rest as in `bodies.rod`, a and b above 0."""
    return strike(bodies.rod(length, thickness, a, b, mass, friction, inertia), omega)


def strike(body: TwoPointBody, omega: Number) -> ClosedForm:
    """The impact of a body on a flat floor."""
    mass, inertia, old, new = body
    assert old is not None  # the bodies above stand on one
    a, b, h, f = -old.x, new.x, -new.y, new.friction
    bodies.positive(a=a, b=b)
    w = speed(omega)
    shape = FlatBody(a, b, h, inertia / mass)
    domains = [domain(shape, f) for domain in (stop_domain, slide_domain, pivot_slide_domain, pivot_domain)]
    # More friction than B needs to stick could make the denominator of (3.4) zero.
    sliding = pivot_slide(shape, np.minimum(f, h * b / (shape.rho2 + h * h)))
    mode, unit = select(domains, [stop(shape, f), slide(shape, f), sliding, pivot(shape)])
    after, slip = w * unit.omega, w * unit.slip
    return closed_form(mode, (slip - after * h, 0.0 - after * b, after), slip, [mass * w * part for part in unit[2:]])


def speed(omega: Number) -> Number:
    """The clockwise speed of a body that turns towards its new contact; InputError if it turns away."""
    bodies.refuse({"omega": omega}, lambda value: (value < 0.0) & (value > -inf), "a finite number below 0 (clockwise)")
    return -omega


def select(domains: Sequence[Truths], impacts: Sequence[UnitImpact]) -> tuple[Modes, UnitImpact]:
    """Of impacts in the order of MODES, the one in whose domain a body lies, and its mode."""
    mode = np.select(domains, [np.uint8(mode) for mode in MODES], np.uint8(Mode.NO_IMPACT))
    return mode, UnitImpact(*(np.select(domains, parts) for parts in zip(*impacts, strict=True)))


def closed_form(mode: Modes, twist: Sequence[Number], slip: Number, push: Sequence[Number]) -> ClosedForm:
    """A ClosedForm from its parts, which broadcast: `push` is N_old, T_old, N_new, T_new."""
    modes, *parts = np.broadcast_arrays(mode, slip, *twist, *push)
    impulses = np.stack(parts[4:], axis=-1).reshape(*modes.shape, 2, 2)
    return ClosedForm(modes.copy(), np.stack(parts[1:4], axis=-1), parts[0].copy(), impulses)
