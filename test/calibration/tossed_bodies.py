"""Tosses of a body of known tensor and mass centre, whose corners are struck by arbitrary impulses: no impact law."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from spatial_reference import crossed

from impact_predictor.calibration.motions import RecordedMotion
from impact_predictor.prediction.scene import Scene, inertia_matrix

Reals = NDArray[np.float64]

MASS = 0.5
HALF = np.array([0.06, 0.05, 0.04])
CORNERS = HALF * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
GIVEN = MASS / 3.0 * np.array([HALF[1] ** 2 + HALF[2] ** 2, HALF[0] ** 2 + HALF[2] ** 2, HALF[0] ** 2 + HALF[1] ** 2])
"""The moments of a solid box."""

TRUE = np.array([1.3, 1.15, 1.1, 0.05, -0.03, 0.08]) * np.array([*GIVEN, *[GIVEN.mean()] * 3])
CENTER = np.array([0.002, -0.003, 0.005])
SCENE = Scene(MASS, inertia_matrix(GIVEN.tolist() + [0.0] * 3), 0.3)
RADIUS = 0.005
STEP = 2.5e-4
DOWN = np.array([0.0, 0.0, -1.0])


class Toss(NamedTuple):
    """A recorded motion, and when (s) which corner struck, with what approach (m/s)."""

    motion: RecordedMotion
    strikes: list[tuple[float, int, float]]


@lru_cache
def tosses(number: int, rate: float = 200.0, noise: float = 0.0, kind: str = "box", time: float = 0.6) -> list[Toss]:
    """Poses at a rate in Hz, with noise of the corners in m, of bodies that are thrown and bounce on their corners.

    A corner that reaches the floor leaves it with a random part of its speed, and slips by a random speed: the impulse
    that does so follows no law. In flight the angular momentum stays. The kinds "isotropic" and "flat" have the mean
    moment of TRUE, "flat" is struck, and turns, in a plane alone, and "round" has corners of the radius RADIUS.
    """
    rng = np.random.default_rng(number)
    tensor = np.eye(3) * TRUE[:3].mean() if kind in ("isotropic", "flat") else np.array(inertia_matrix(TRUE.tolist()))
    # What moves, and about what: all, or the plane of x and z, in which the corners are those with y < 0, put at y = 0.
    along, about = (np.array([1, 0, 1]), np.array([0, 1, 0])) if kind == "flat" else (np.ones(3), np.ones(3))
    corners, center, inverse = (CORNERS * along)[CORNERS @ (1 - along) <= 0], CENTER * along, np.linalg.inv(tensor)
    radius = RADIUS if kind == "round" else 0.0
    arms = corners - radius * np.sign(corners) - center
    turns = Rotation.from_rotvec(rng.normal(0.0, 2.0, (number, 3)) * about).as_matrix()
    places, velocities = np.tile([0.0, 0.0, 0.35], (number, 1)), rng.normal(0.0, 0.5, (number, 3)) * along
    spin = rng.normal(0.0, 6.0, (number, 3)) * about
    momenta = np.einsum("nij,jk,nlk,nl->ni", turns, tensor, turns, spin)
    poses = []
    strikes: list[list[tuple[float, int, float]]] = [[] for _ in range(number)]

    def rates(turns: Reals) -> Reals:
        rates: Reals = np.einsum("nij,nj->ni", turns @ inverse @ turns.transpose(0, 2, 1), momenta)
        return rates

    for k in range(round(time / STEP) + 1):
        poses.append((places - turns @ center, turns))
        halfway = Rotation.from_rotvec(0.5 * STEP * rates(turns)).as_matrix() @ turns
        turns = Rotation.from_rotvec(STEP * rates(halfway)).as_matrix() @ turns
        places = places + STEP * velocities + 0.5 * 9.81 * STEP**2 * DOWN
        velocities = velocities + 9.81 * STEP * DOWN
        below = places[:, 2, None] + (turns @ arms.T)[:, 2] < radius
        for n, corner in np.argwhere(below).tolist():
            arm, turned = turns[n] @ arms[corner] + radius * DOWN, turns[n] @ inverse @ turns[n].T
            struck = velocities[n] + crossed(turned @ momenta[n], arm)
            if struck[2] < 0.0:
                strikes[n].append(((k + 1) * STEP, corner, -float(struck[2])))
                cross = crossed(np.eye(3), arm)
                after = along * [*rng.normal(0.0, 0.3, 2), -rng.uniform(0.2, 0.6) * struck[2]]
                impulse = np.linalg.solve(np.eye(3) / MASS - cross @ turned @ cross, after - struck)
                velocities[n] += impulse / MASS
                momenta[n] += crossed(arm, impulse)
    every = round(1.0 / rate / STEP)
    positions, orientations = (np.array(values)[::every] for values in zip(*poses, strict=True))
    stamps = np.arange(len(positions)) * round(1e9 * every * STEP)
    found = []
    for n in range(number):
        shaken = Rotation.from_rotvec(rng.normal(0.0, noise / 0.09, (len(stamps), 3))).as_matrix()
        moved = positions[:, n] + rng.normal(0.0, noise, (len(stamps), 3))
        found.append(Toss(RecordedMotion(stamps, moved, shaken @ orientations[:, n], corners), strikes[n]))
    return found
