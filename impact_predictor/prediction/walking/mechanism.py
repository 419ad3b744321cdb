"""What impulses at its feet do to a machine: `Mechanism`, and `Trunk`, one rigid body on legs without mass."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..scene import Scene
from ..types import Status, Vector3
from ..vectors import cross, mean

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
        # M^-1 at the base's origin: that of the mass centre, whose velocity less omega x c is the origin's.
        carried = np.eye(6)
        carried[:3, 3:] = np.cross(scene.center_of_mass, np.eye(3)).T
        at_center = np.zeros((6, 6))
        at_center[:3, :3] = np.eye(3) / scene.mass
        at_center[3:, 3:] = np.linalg.inv(inertia)
        self._mobility: NDArray[np.float64] = carried @ at_center @ carried.T

    def response(
        self,
        old: tuple[int, ...],
        new: tuple[int, ...],
        normal: Vector3,
        ahead: Vector3,
        points: tuple[Vector3, ...],
    ) -> Response | Status:
        rows = np.zeros((4, 6))
        for first, those in ((0, old), (2, new)):
            if those:
                arm = mean([points[i] for i in those])
                rows[first] = *normal, *cross(arm, normal)
                rows[first + 1] = *ahead, *cross(arm, ahead)
        twist = self._mobility @ rows.T
        return Response(tuple(map(tuple, (rows @ twist).tolist())), tuple(map(tuple, twist.tolist())))
