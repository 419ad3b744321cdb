"""The equations of a compliant impact in units of its own: time sqrt(m / k), speeds V, lengths V sqrt(m / k).

m is the mass, k the stiffness of the new contact and V the sum of the contact speeds before the impact; the mass is 1
in them and angles are measured by rho times the angle, rho the radius of gyration. What is left of the stiffness then
is a single small number,

    depth = V sqrt(m / k) / rho,

how far the body turns and the contacts move during the impact, and the weight g sqrt(m / k) / V. Both vanish as
k**-0.5. All else does not depend on k: the ratio of the two stiffnesses, the damping ratios, the friction, the
regularisation and the shape. With depth and weight zero these are the equations of the limit itself.
"""

from __future__ import annotations

from math import cos, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..types import Vector
from .force import Compliance, force, slopes

Array = NDArray[np.float64]


class Point(NamedTuple):
    """A contact: its place from the mass centre over rho, the support's normal and velocity, its force, and its gap at
    the touchdown.
    """

    place: Vector
    normal: Vector
    velocity: Vector
    compliance: Compliance
    gap: float = 0.0


class Equations(NamedTuple):
    """A body on its contacts. The state is (x, y, q, vx, vy, vq) and then the normal and tangential impulse of each
    contact; x, y, q count from the moment of the touchdown.
    """

    points: tuple[Point, ...]
    depth: float
    weight: Vector

    def contacts(self, time: float, state: Any) -> list[tuple[float, float, float, float, float]]:
        """Gap, its rate, slip and the moments of normal and tangent of each contact."""
        x, y, q, vx, vy, vq = state[:6]
        depth = self.depth
        c, s = cos(depth * q), sin(depth * q)
        # (sin a) / depth and (1 - cos a) / depth, which have a limit.
        if depth > 0.0:
            half = sin(0.5 * depth * q)
            across, along = s / depth, 2.0 * half * half / depth
        else:
            across, along = q, 0.0
        found = []
        for (px, py), (nx, ny), (ux, uy), _, gap in self.points:
            ax, ay = c * px - s * py, s * px + c * py
            dx, dy = x - across * py - along * px - ux * time, y + across * px - along * py - uy * time
            cx, cy = vx - vq * ay - ux, vy + vq * ax - uy
            found.append(
                (gap + nx * dx + ny * dy, nx * cx + ny * cy, ny * cx - nx * cy, ax * ny - ay * nx, -(ax * nx + ay * ny))
            )
        return found

    def rates(self, time: float, state: Any) -> list[float]:
        """The right-hand side."""
        values = state.tolist()
        fx, fy = self.weight
        fq = 0.0
        impulses = []
        contacts = self.contacts(time, values)
        for (_, (nx, ny), _, compliance, _), (gap, rate, slip, mn, mt) in zip(self.points, contacts, strict=True):
            normal, tangential = force(compliance, gap, rate, slip)
            impulses += [normal, tangential]
            fx += normal * nx + tangential * ny
            fy += normal * ny - tangential * nx
            fq += normal * mn + tangential * mt
        return [values[3], values[4], values[5], fx, fy, fq, *impulses]

    def jacobian(self, time: float, state: Array) -> Array:
        """The derivatives of `rates` by the state."""
        values = state.tolist()
        found = np.zeros((len(values), len(values)))
        found[0, 3] = found[1, 4] = found[2, 5] = 1.0
        turning = self.depth * values[5]
        contacts = self.contacts(time, values)
        for i, ((_, (nx, ny), _, compliance, _), (gap, rate, slip, mn, mt)) in enumerate(
            zip(self.points, contacts, strict=True)
        ):
            along_n, along_t = np.array((nx, ny, mn)), np.array((ny, -nx, mt))
            by = slopes(compliance, gap, rate, slip)
            normal, tangential = np.zeros(6), np.zeros(6)
            normal[:3], normal[3:] = by.gap * along_n, by.rate * along_n
            normal[2] += by.rate * turning * mt
            tangential[3:] = by.slip * along_t
            tangential[2] -= by.slip * turning * mn
            tangential += by.tangential * normal
            found[3:6, :6] += np.outer(along_n, normal) + np.outer(along_t, tangential)
            n, t = force(compliance, gap, rate, slip)
            found[5, 2] += self.depth * (n * mt - t * mn)
            found[6 + 2 * i, :6], found[7 + 2 * i, :6] = normal, tangential
        return found


def loaded(equations: Equations, state: Any) -> Equations:
    """With the first contact as deep as its load asks for: it neither lifts nor sinks before the impact.

    It sticks if its friction can hold it, else it slips.
    """
    first, *others = equations.points
    (px, py), (nx, ny), _, compliance, _ = first
    _, _, slip, mn, mt = equations.contacts(0.0, state)[0]
    vq, (gx, gy) = state[5], equations.weight
    # Acceleration of the contact without its force.
    ax, ay = gx - equations.depth * vq * vq * px, gy - equations.depth * vq * vq * py
    an, at = nx * ax + ny * ay, ny * ax - nx * ay
    wnn, wnt, wtt = 1.0 + mn * mn, mn * mt, 1.0 + mt * mt
    determinant = wnn * wtt - wnt * wnt
    normal, tangential = (wnt * at - wtt * an) / determinant, (wnt * an - wnn * at) / determinant
    friction = compliance.friction
    if abs(slip) > compliance.regularisation or abs(tangential) > friction * normal:
        share = -friction if (slip > 0.0 if slip != 0.0 else tangential < 0.0) else friction
        normal = -an / (wnn + share * wnt)
    return equations._replace(points=(first._replace(gap=-max(normal, 0.0) / compliance.stiffness), *others))
