"""How sure an impact in three dimensions is: modes, lifts and twist after it, from what is uncertain before it.

Uncertain are the gaps of the points that strike, whose order of closing decides what lifts; the twist; friction and
restitution; and the law itself, which a measured contact follows only so far. Fixed points carry the first of these
through the law, all of them at once; the last one blurs what each contact does after it.
"""

from __future__ import annotations

from itertools import product as product_of
from math import erf, inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanics.impact.spatial_body import ANSWER, BODY, CONTACT, RESULT, determinant
from ..mechanics.types import Mode
from .planar import mode_of
from .scene import Scene
from .types import Covariance, Sample, SpatialTwist, Vector3
from .uncertainty import factor_of, moments, normal_points, product
from .vectors import Axes, cross

RESTS = 1e-5
"""A group of contacts holds that leaves more slowly than this part of the approach."""

ROUNDING = 1e-9

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
        self._coefficients = bool(scene.friction_deviation or scene.restitution_deviation)

    def drawn(
        self, sample: Sample, axes: Axes, problem: NDArray[np.float64], standing: int, rates: list[float], gap: float
    ) -> DrawnImpact:
        """The draws of an impact.

        `problem` is as `SpatialModel` makes it, and the first `standing` of its contacts stand; the axes of the sample
        turn the covariance of its twist; `rates` in m/s are those of the other gaps, whose standard deviation is `gap`.
        """
        scene, n = self._scene, (len(problem) - BODY) // CONTACT
        approach = -min(rates)
        factor, given = factor_of(sample.twist_covariance)
        turns = bool(factor.any())
        striking = n - standing if gap > 0.0 and n - standing > 1 else 0
        dimensions = (6 if turns else 0) + (2 if self._coefficients else 0) + striking
        points = normal_points(scene.samples, dimensions) if dimensions else np.zeros((0, 1))
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
        answers, notes = np.zeros((count, ANSWER + RESULT * n)), np.zeros(count, np.int64)
        self._solve(problems, answers, notes)
        of_each = answers[:, ANSWER:].reshape(count, n, RESULT)
        normals = contacts[:, :, 3:6]
        leaving = (of_each[:, :, 3:6] * normals).sum(axis=2)
        # What holds would go into its support by as much as its impulse takes it back.
        pressed = (of_each[:, :, :3] * normals).sum(axis=2) * mobilities(problem, n)
        slips = of_each[:, :, 6] == 1.0
        groups = slice(0, standing), slice(standing, n)
        margins, lifts, slides = [], [], []
        for group in groups:
            rate = leaving[:, group].sum(axis=1) / max(1, group.stop - group.start)
            press = pressed[:, group].sum(axis=1) / max(1, group.stop - group.start)
            lifts.append((rate > RESTS * approach).tolist())
            margins.append(np.where(rate > RESTS * approach, rate, -press).tolist())
            slides.append(slips[:, group].any(axis=1).tolist())
        if not standing:
            lifts[0], margins[0] = [True] * count, [inf] * count
        modes = [mode_of(*one) for one in zip(*lifts, *slides, strict=True)]
        blur = self._blur(problem, n)
        weights = [0.0] * len(Mode)
        for k in range(count):
            old, new = over(margins[0][k], blur), over(margins[1][k], blur)
            for old_lifts, new_lifts in product_of((True, False), (True, False)):
                share = (old if old_lifts else 1.0 - old) * (new if new_lifts else 1.0 - new)
                weights[mode_of(old_lifts, new_lifts, slides[0][k], slides[1][k])] += share / count
        mode = max(sorted(set(modes)), key=lambda one: weights[one])
        mean = moments(answers[[one == mode for one in modes], :6].T)[0].tolist()
        of_contacts = np.where(leaving > RESTS * approach, leaving, -pressed).T.tolist()
        return DrawnImpact(
            given=given,
            probabilities=tuple(weights),
            lifts=tuple([sum([over(one, blur) for one in each]) / count for each in of_contacts]),
            mode=mode,
            after=SpatialTwist((mean[0], mean[1], mean[2]), (mean[3], mean[4], mean[5])),
            twists=np.ascontiguousarray(answers[:, :6].T),
        )

    def _blur(self, problem: NDArray[np.float64], n: int) -> float:
        """The standard deviation in m/s of what a contact does after the impact against what the law says."""
        arms, v, w = problem[BODY:].reshape(n, CONTACT)[:, :3], problem[7:10], problem[10:13]
        reach = sqrt(float((arms * arms).sum()) / n)
        speed = sqrt(float((v * v).sum())) + reach * sqrt(float((w * w).sum()))
        return max(self._scene.law_deviation, ROUNDING) * speed


def over(margin: float, blur: float) -> float:
    """The probability that a quantity of a mean and a standard deviation is above zero."""
    return 0.5 * (1.0 + erf(margin / (blur * sqrt(2.0))))


def gaps_of(contacts: NDArray[np.float64], rates: list[float], changes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The gaps (k, n) of contacts that approach at some rates, with changes, when the first of them closes."""
    gaps, speeds = contacts[:, :, 11] + changes, -np.array(rates)
    first = (gaps / speeds).min(axis=1)
    return np.asarray(np.maximum(0.0, gaps - first[:, None] * speeds))


def mobilities(problem: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """How fast each contact (n) goes along its normal by an impulse there, in 1/kg."""
    mass, xx, yy, zz, xy, xz, yz = problem[:7].tolist()
    det = determinant(xx, yy, zz, xy, xz, yz)
    inverse = [
        [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy],
        [xz * yz - xy * zz, xx * zz - xz * xz, xy * xz - xx * yz],
        [xy * yz - xz * yy, xy * xz - xx * yz, xx * yy - xy * xy],
    ]
    contacts = problem[BODY:].reshape(n, CONTACT)
    levers = np.cross(contacts[:, :3], contacts[:, 3:6])
    turned = (levers[:, None, :] * np.array(inverse)).sum(axis=2) / det
    return np.asarray((levers * turned).sum(axis=1) + 1.0 / mass)


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
