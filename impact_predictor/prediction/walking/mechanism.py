"""What impulses at its feet do to a machine: `Mechanism`, and `Trunk`, one rigid body on legs without mass."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from ...errors import InputError
from ..planar import ORIGIN
from ..scene import Scene
from ..types import Status, Vector3
from ..vectors import add, cross, dot, mean

Row = tuple[float, float, float, float]

SINGULAR = 1e-12
"""A principal moment of inertia below this part of the largest one is rounding."""


class Response(NamedTuple):
    """What unit impulses at two contacts do, in the order n_old, t_old, n_new, t_new.

    `W` (4, 4) = G M^-1 G^T in 1/kg gives the change of the contact velocities; `twist` (6, 4), the base's rows of
    M^-1 G^T, that of the velocity of the base's origin in m/s and of its angular velocity in rad/s, along its axes.
    What belongs to an old contact that there is not is 0.
    """

    W: tuple[Row, ...]
    twist: tuple[Row, ...]


class Mechanism(Protocol):
    """A machine with contact points, as its impulses see it; `is_rigid` where its feet move with its base alone."""

    is_rigid: bool

    def response(
        self,
        old: tuple[int, ...],
        new: tuple[int, ...],
        normal: Vector3,
        ahead: Vector3,
        points: tuple[Vector3, ...],
    ) -> Response | Status:
        """The response at the mean of the `old` and at the mean of the `new` points, by their indices.

        `points` are in m in the base's frame, as are the unit vectors `normal` of the support and `ahead`, the
        tangent. Where the machine has none a status says why.
        """


class Trunk:
    """One rigid body, the scene's, with its whole inertia tensor; its legs have no mass and are held by their joints.

    Raises:
        InputError: the inertia of the scene has no inverse.
    """

    is_rigid = True

    def __init__(self, scene: Scene) -> None:
        inertia = np.array(scene.inertia)
        moments = np.linalg.eigvalsh(inertia)
        if not moments[0] > SINGULAR * moments[-1]:
            raise InputError(
                f"the inertia {scene.inertia} of the body has no inverse: give one that is positive about every axis"
            )
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = np.linalg.inv(inertia).tolist()
        self._agility = xx, xy, xz, yy, yz, zz
        self._lightness = 1.0 / scene.mass
        self._center = scene.center_of_mass

    def response(
        self,
        old: tuple[int, ...],
        new: tuple[int, ...],
        normal: Vector3,
        ahead: Vector3,
        points: tuple[Vector3, ...],
    ) -> Response | Status:
        xx, xy, xz, yy, yz, zz = self._agility
        center, lightness = self._center, self._lightness
        arms: list[Vector3] = []
        spins: list[Vector3] = []
        kicks: list[Vector3] = []
        for those in (old, new):
            if not those:
                arms, spins, kicks = [ORIGIN, ORIGIN], [ORIGIN, ORIGIN], [ORIGIN, ORIGIN]
                continue
            place = add(mean([points[i] for i in those]), center, -1.0)
            for way in (normal, ahead):
                # About the mass centre, whose velocity less omega x c is that of the base's origin.
                x, y, z = arm = cross(place, way)
                spin = xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z
                arms.append(arm)
                spins.append(spin)
                kicks.append(add(cross(center, spin), way, lightness))
        rows = [[dot(arm, spin) for spin in spins] for arm in arms]
        for i in range(0 if old else 2, 4):
            rows[i][i] += lightness
            rows[i][(i + 2) % 4] += lightness if old else 0.0
        W = [(a, b, c, d) for a, b, c, d in rows]
        twist = [*zip(*kicks, strict=True), *zip(*spins, strict=True)]
        return Response(tuple(W), tuple(twist))
