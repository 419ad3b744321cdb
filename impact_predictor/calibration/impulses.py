"""Impacts of a single point as equations in mass centre and inertia over mass, and their solution.

Whatever the impulse P at a single struck point, it changes the momentum by P, and the angular momentum about the mass
centre by (r - d) x P, with r from the body frame's origin to the point and d to the mass centre. So for each impact

    J dw = (r - d) x m dv,

linear in J/m and, but for the small part of d in dv, in d.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from ..prediction.scene import InertiaTensor, Scene
from .impacts import RecordedImpact
from .motions import Reals

Weights = NDArray[np.number]

ENDS: Final = 1e-4
"""A search ends with a step that changes no more than this part of what is left: a hundredth of what chance does."""

STEPS: Final = 50
AGAIN: Final = 8
"""Steps of a search in all, and where it begins with the answer to almost the same problem."""

_PLACES: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class SinglePoint(NamedTuple):
    """An impact of a single one of the points (m, 3) of a body, and where its paths before and after it meet: `time` in
    s, `height` above the support in m.
    """

    points: Reals
    impact: RecordedImpact
    time: float
    height: float

    @property
    def turn(self) -> Reals:
        """The rotation when the point is struck (3, 3)."""
        return self.impact.before.turned(self.time)

    def of_struck(self, values: Reals) -> Reals:
        """What belongs to the struck point of values for each of them (m, 3)."""
        struck: Reals = values[self.impact.new[0]]
        return struck


SinglePoints = Sequence[SinglePoint]


class Impulses:
    """Impacts of single points as equations in x: the moments over the mass (m^2), and the mass centre (m).

    The body frame moves over an impact: the angular momentum is that of the frames before and after it, in world axes.
    """

    def __init__(self, scene: Scene, struck: SinglePoints, moments: int, radius: float = 0.0) -> None:
        pairs = [(one.impact.before, one.impact.after) for one in struck]
        self._turns = np.array([one.turn for one in struck])
        points = np.array([one.of_struck(rounded(one.points, radius)) for one in struck])
        self._arms = np.einsum("nij,nj->ni", self._turns, points) - radius * np.array(scene.normal)
        self._turning = np.array([after.turning - before.turning for before, after in pairs])
        fallen = np.outer([after.time - before.time for before, after in pairs], scene.gravity)
        self._jumps = np.array([after.linear - before.linear for before, after in pairs]) - fallen
        early, late = (
            momenta(np.array([one.rotation for one in side]), np.array([one.angular for one in side]))
            for side in zip(*pairs, strict=True)
        )
        given, spin = np.array(parts_of(scene.inertia)) / scene.mass, late - early
        self._moments = moments
        self._columns = spin[:, :, :3].sum(axis=2, keepdims=True) if moments == 1 else spin[:, :, :moments]
        self._rest = spin[:, :, 3:] @ given[3:] * (moments == 3)
        self.start = np.array([*([given[:3].mean()] if moments == 1 else given[:moments]), *scene.center_of_mass])
        """The given body."""

    def solve(self, weights: Weights, free: NDArray[np.bool_], start: Reals, steps: int = STEPS) -> Reals:
        """The x of the least weighted sum of |J dw - (r - d) x m dv|, from a start, changed only where it is free."""

        def linear(x: Reals) -> tuple[Reals, Reals]:
            missed, jumps, arms = self.misses(x)
            by_center = np.cross(self._turns.transpose(0, 2, 1), jumps[:, None])
            by_center -= np.cross(arms[:, None], self._turning.transpose(0, 2, 1))
            return missed, np.concatenate((self._columns, by_center.transpose(0, 2, 1)), axis=2)

        return least_lengths(linear, weights, free, start, steps)

    def inconsistency(self, x: Reals, lever: float) -> Reals:
        """|J dw - (r - d) x m dv| / (m |dv| lever) of each impact (n,)."""
        missed, jumps, _ = self.misses(x)
        errors: Reals = np.linalg.norm(missed, axis=1) / np.linalg.norm(jumps, axis=1) / lever
        return errors

    def misses(self, x: Reals) -> tuple[Reals, Reals, Reals]:
        """What the equations leave, the change of the mass centre's velocity, and its way to the point: (n, 3) each."""
        inertia, center = x[: self._moments], x[self._moments :]
        jumps, arms = self._jumps + self._turning @ center, self._arms - self._turns @ center
        return self._columns @ inertia + self._rest - np.cross(arms, jumps), jumps, arms


def least_lengths(
    linear: Callable[[Reals], tuple[Reals, Reals]],
    weights: Weights,
    free: NDArray[np.bool_],
    start: Reals,
    steps: int = STEPS,
) -> Reals:
    """The x of the least weighted sum of the lengths of vectors (n, k) with slopes (n, k, p), changed where it is free.

    Lengths, not their squares: an impact that has something else in it pulls no more than any other.
    """
    x = start.copy()
    for _ in range(steps if free.any() else 0):
        missed, slopes = linear(x)
        lengths = np.linalg.norm(missed, axis=1)
        roots = np.sqrt(weights / np.maximum(lengths, 1e-12 + 1e-3 * np.median(lengths)))[:, None]
        rows = (slopes[:, :, free] * roots[..., None]).reshape(-1, int(free.sum()))
        sizes = np.linalg.norm(rows, axis=0) + 1e-300
        rows /= sizes
        # What the impacts do not tell stays where it is: of all best steps the shortest.
        step = np.linalg.lstsq(rows.T @ rows, -rows.T @ (missed * roots).ravel(), rcond=1e-10)[0]
        x[free] += step / sizes
        if np.linalg.norm(step) <= ENDS * np.linalg.norm(missed * roots):
            break
    return x


def momenta(rotations: Reals, rates: Reals) -> Reals:
    """The angular momenta in world axes (n, 3, 6) of each of ixx, iyy, izz, ixy, ixz, iyz, from rates there (n, 3)."""
    rates = np.einsum("nji,nj->ni", rotations, rates)
    columns = np.zeros((len(rates), 3, 6))
    for k, (i, j) in enumerate(_PLACES):
        columns[:, i, k], columns[:, j, k] = rates[:, j], rates[:, i]
    momentum: Reals = rotations @ columns
    return momentum


def parts_of(inertia: InertiaTensor) -> tuple[float, ...]:
    return tuple(inertia[i][j] for i, j in _PLACES)


def is_solid(points: Reals) -> bool:
    """Whether points are the corners of a solid, which can be rounded."""
    return len(points) > 3 and np.linalg.matrix_rank(points - points[0], 1e-6 * np.abs(points).max()) == 3


def rounded(points: Reals, radius: float) -> Reals:
    """The centres of the spheres of a radius that touch the faces at each corner of a solid."""
    if radius == 0.0:
        return points
    hull, centers = ConvexHull(points), points.copy()
    for corner in hull.vertices:
        normals = hull.equations[(hull.simplices == corner).any(axis=1), :3]
        centers[corner] -= radius * np.linalg.lstsq(normals, np.ones(len(normals)), rcond=1e-9)[0]
    return centers
