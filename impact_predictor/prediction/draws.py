"""How sure an impact in three dimensions is: modes, lifts and twist after it, from what is uncertain before it.

Uncertain are the gaps of the points that strike, whose order of closing decides what lifts; the twist; friction and
restitution; and the law itself, which a measured contact follows only so far. Fixed points carry the first of these
through the law, all of them at once; the last one blurs what each contact does after it.
"""

from __future__ import annotations

from math import erf, inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanics.impact.spatial_body import ANSWER, BODY, CONTACT, RESULT, determinant
from ..mechanics.types import ContactState, Mode
from .planar import hardly, mode_of
from .scene import Scene
from .types import Covariance, Sample, SpatialTwist, Vector3
from .uncertainty import factor_of, normal_points, product
from .vectors import Axes, cross, total

RESTS = 1e-5
"""A group of contacts holds that leaves more slowly than this part of the approach."""

ROUNDING = 1e-9
DRAW_STEPS = 5
"""Steps of the law for a draw: its error is small beside what the draws differ by."""

ROOT = sqrt(2.0)
SLIPS = float(ContactState.SLIPS)

UNITS: tuple[Vector3, Vector3, Vector3] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class DrawnImpact(NamedTuple):
    """What the draws say of an impact.

    `probabilities` of the modes, by their numbers, and of the `lifts` of each contact; `mode` is the likeliest of those
    that a draw has, and `after` the mean twist of the draws with this mode; `twists` (6, k) are those of all.
    """

    given: Covariance
    probabilities: tuple[float, ...]
    lifts: tuple[float, ...]
    mode: Mode
    after: SpatialTwist
    twists: NDArray[np.float64]


class Draws:
    """Carries what is uncertain about the impacts of a scene through the law that `solve` solves."""

    def __init__(self, scene: Scene, solve: Any) -> None:
        self._scene, self._solve = scene, solve
        self._normal = np.array(scene.normal)
        self._coefficients = bool(scene.friction_deviation or scene.restitution_deviation)

    def drawn(
        self,
        sample: Sample,
        axes: Axes,
        problem: NDArray[np.float64],
        answer: NDArray[np.float64],
        standing: int,
        rates: list[float],
        gap: float,
    ) -> DrawnImpact:
        """The draws of an impact.

        `problem` and `answer` are as `SpatialModel` makes them, and the first `standing` of the contacts stand; the
        axes of the sample turn the covariance of its twist; `rates` in m/s are those of the other gaps, whose standard
        deviation is `gap`.
        """
        scene, n, approach = self._scene, (len(problem) - BODY) // CONTACT, -min(rates)
        factor, given = factor_of(sample.twist_covariance)
        turns = given is Covariance.USED and any(sample.twist_covariance)
        striking = n - standing if gap > 0.0 and n - standing > 1 else 0
        dimensions = (6 if turns else 0) + (2 if self._coefficients else 0) + striking
        answers = answer[None]
        if dimensions:
            points = normal_points(scene.samples, dimensions)
            count = points.shape[1]
            problems = np.repeat(problem[None], count, axis=0)
            contacts = problems[:, BODY:].reshape(count, n, CONTACT)
            if turns:
                problems[:, 7:13] += product(product(into_world(axes, scene.center_of_mass), factor), points[:6]).T
                points = points[6:]
            if self._coefficients:
                contacts[:, :, 6] = np.maximum(0.0, contacts[:, :, 6] + scene.friction_deviation * points[0][:, None])
                bounces = contacts[:, :, 7] + scene.restitution_deviation * points[1][:, None]
                contacts[:, :, 7] = np.minimum(1.0, np.maximum(0.0, bounces))
                points = points[2:]
            if striking:
                contacts[:, standing:, 11] = gaps_of(contacts[:, standing:], rates, gap * points.T)
            answers = np.zeros((count, len(answer)))
            self._solve(problems, answers, np.zeros(count, np.int64), DRAW_STEPS)
        return self._read(given, problem, answers, standing, RESTS * approach)

    def _read(
        self, given: Covariance, problem: NDArray[np.float64], answers: NDArray[np.float64], standing: int, least: float
    ) -> DrawnImpact:
        """What the answers of all draws say; a group holds that leaves more slowly than `least`, in m/s."""
        count, n = len(answers), (len(problem) - BODY) // CONTACT
        of_each = answers[:, ANSWER:].reshape(count, n, RESULT)
        # Along the normal: impulse and velocity of each contact of each draw.
        normals = (of_each[:, :, :6].reshape(count, n, 2, 3) * self._normal).sum(axis=3).tolist()
        slips = (of_each[:, :, 6] == SLIPS).tolist()
        numbers = problem.tolist()
        # What leaves more slowly than gravity takes back in a contact time does not lift.
        soft, blur, slow = mobilities(numbers, n), self._blur(numbers, n), hardly(self._scene)
        modes, weights, lifts = [], [0.0] * len(Mode), [0.0] * n
        for along, slipping in zip(normals, slips, strict=True):
            # What holds would go into its support by as much as its impulse takes it back.
            rates = [rate for _, rate in along]
            margins = [
                rate if rate > least else -mobility * push for (push, rate), mobility in zip(along, soft, strict=True)
            ]
            for i in range(n):
                lifts[i] += over(margins[i] - slow, blur) / count
            found = []
            for begin, end in ((0, standing), (standing, n)):
                rate = total(rates[begin:end]) / (end - begin) if end > begin else inf
                margin = rate if rate > least else total([min(0.0, one) for one in margins[begin:end]]) / (end - begin)
                found.append((rate > least, True in slipping[begin:end], over(margin - slow, blur)))
            (old_lifts, old_slips, old), (new_lifts, new_slips, new) = found
            modes.append(mode_of(old_lifts, new_lifts, old_slips, new_slips))
            weights[Mode.FLIGHT] += old * new / count
            weights[Mode.BACK_PIVOT] += (1.0 - old) * new / count
            weights[mode_of(True, False, old_slips, new_slips)] += old * (1.0 - new) / count
            weights[mode_of(False, False, old_slips, new_slips)] += (1.0 - old) * (1.0 - new) / count
        mode = max(sorted(set(modes)), key=lambda one: weights[one])
        columns = np.ascontiguousarray(answers[:, :6].T)
        mean = (columns[:, [one == mode for one in modes]].sum(axis=1) / modes.count(mode)).tolist()
        return DrawnImpact(
            given=given,
            probabilities=tuple(weights),
            lifts=tuple(lifts),
            mode=mode,
            after=SpatialTwist((mean[0], mean[1], mean[2]), (mean[3], mean[4], mean[5])),
            twists=columns,
        )

    def _blur(self, problem: list[float], n: int) -> float:
        """The standard deviation in m/s of what a contact does after the impact against what the law says."""
        square = total([part * part for i in range(n) for part in problem[BODY + CONTACT * i : BODY + CONTACT * i + 3]])
        vx, vy, vz, wx, wy, wz = problem[7:13]
        speed = sqrt(vx * vx + vy * vy + vz * vz) + sqrt((wx * wx + wy * wy + wz * wz) * square / n)
        return max(self._scene.law_deviation, ROUNDING) * speed


def over(margin: float, blur: float) -> float:
    """The probability that a quantity of a mean and a standard deviation is above zero."""
    return 0.5 * (1.0 + erf(margin / (blur * ROOT)))


def gaps_of(contacts: NDArray[np.float64], rates: list[float], changes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The gaps (k, n) of contacts that approach at some rates, with changes, when the first of them closes."""
    gaps, speeds = contacts[:, :, 11] + changes, -np.array(rates)
    first = (gaps / speeds).min(axis=1)
    return np.asarray(np.maximum(0.0, gaps - first[:, None] * speeds))


def mobilities(problem: list[float], n: int) -> list[float]:
    """How fast each contact goes along its normal by an impulse there, in 1/kg."""
    mass, xx, yy, zz, xy, xz, yz = problem[:7]
    det = determinant(xx, yy, zz, xy, xz, yz)
    found = []
    for i in range(n):
        x, y, z, nx, ny, nz = problem[BODY + CONTACT * i : BODY + CONTACT * i + 6]
        a, b, c = y * nz - z * ny, z * nx - x * nz, x * ny - y * nx
        found.append(
            1.0 / mass
            + (
                (yy * zz - yz * yz) * a * a
                + (xx * zz - xz * xz) * b * b
                + (xx * yy - xy * xy) * c * c
                + 2.0 * ((xz * yz - xy * zz) * a * b + (xy * yz - xz * yy) * a * c + (xy * xz - xx * yz) * b * c)
            )
            / det
        )
    return found


def into_world(axes: Axes, center: Vector3) -> NDArray[np.float64]:
    """From a twist at the body frame's origin to that of the mass centre in the world (6, 6)."""
    # a . R (v + w x c) = (R^T a) . v + (c x R^T a) . w
    rows = [(*world, *cross(center, world)) for world in zip(*axes, strict=True)]
    rows += [(0.0, 0.0, 0.0, *world) for world in zip(*axes, strict=True)]
    return np.array(rows)


def in_body(axes: Axes, center: Vector3) -> NDArray[np.float64]:
    """The way back of `into_world`."""
    rows = []
    for i, axis in enumerate(axes):
        # v - w x c along an axis of the body.
        lever = cross(UNITS[i], center)
        spin = [lever[0] * axes[0][j] + lever[1] * axes[1][j] + lever[2] * axes[2][j] for j in range(3)]
        rows.append((*axis, *spin))
    rows += [(0.0, 0.0, 0.0, *axis) for axis in axes]
    return np.array(rows)
