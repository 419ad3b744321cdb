"""How sure an impact is: modes and twist after it, from the uncertainty of the twist before, friction and restitution.

The inputs are normal, and fixed points carry them through `solve_impacts`: points of low discrepancy in opposite
pairs, whose mean is zero and whose covariance is the identity. So mean and covariance are exact where the impact is
linear in its inputs, and every run gives the same bits.

What the old contact holds stays held: of a change of the twist counts what `allowed_changes` leaves. Friction below 0
counts as 0, restitution outside of 0..1 as its nearest end. Where a changed twist does not approach the new contact,
there is NO_IMPACT.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, lru_cache
from math import sqrt
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mechanics.impact.batch import Outcomes, solve_impacts
from ..mechanics.sensitivity import allowed_changes
from ..mechanics.types import Contact, Mode, Twist, TwoPointBody
from .impact import RESTITUTION
from .planar import ORIGIN, ImpactPlane, Posture
from .scene import Scene
from .types import Covariance, Quaternion, Sample, Uncertainty, Vector3
from .vectors import axes_of, cross, times, to_body, to_world

ROUNDING = 1e-9  # a covariance may miss symmetry and positive semidefiniteness by this part of its variances
LARGEST = 1e24  # variances beyond which products overflow; nothing is known of such a motion


class Sampler:
    """Predicts the uncertainty of impacts of a scene; all that can be prepared is."""

    def __init__(self, scene: Scene) -> None:
        """Prepare the points, and have the impact laws compiled where they can be."""
        self._scene = scene
        self._points = normal_points(scene.samples, 8)
        self._friction = scene.friction_deviation * self._points[6]
        self._restitution = scene.restitution_deviation * self._points[7]
        self._body = TwoPointBody(scene.mass, 1.0, Contact(-1.0, -1.0, 0.0), Contact(1.0, -1.0, 0.0))
        at_rest = np.zeros((3, self._points.shape[1]))
        impacts(self._body, Twist(0.0, 0.0, 0.0), at_rest, self._friction, self._restitution, scene.law)

    def uncertainty(
        self, sample: Sample, posture: Posture, plane: ImpactPlane, body: TwoPointBody, before: Twist, after: Quaternion
    ) -> Uncertainty:
        """The uncertainty of the impact of `body` that comes with the twist `before`, in the plane of a sample.

        `after` is the orientation of the body then. The covariance of the sample's twist counts as that of the twist at
        the impact; what the plane leaves over keeps its own.
        """
        factor, given = factor_of(sample.twist_covariance)
        frame = plane.ahead, posture.normal, plane.axis
        center = self._scene.center_of_mass
        changes = product(product(into_plane(frame, center), factor), self._points[:6])
        outcomes = impacts(body, before, changes[:3], self._friction, self._restitution, self._scene.law)
        mean, spread = moments(outcomes.twist.T)
        now = axes_of(after)
        turned = tuple([to_body(now, to_world(posture.axes, vector)) for vector in frame])
        _, covariance = moments(product(into_space(turned, center), np.concatenate((outcomes.twist.T, changes[3:]))))
        used = given is Covariance.USED
        return Uncertainty(
            given=given,
            probabilities=probabilities(outcomes),
            mean=Twist(*mean.tolist()),
            deviation=Twist(*np.sqrt(spread.diagonal()).tolist()),
            twist_covariance=tuple(covariance.ravel().tolist()) if used else sample.twist_covariance,
        )


@cache
def normal_points(samples: int, dimensions: int) -> NDArray[np.float64]:
    """Points (dimensions, count) of mean zero and unit covariance, normally distributed and in opposite pairs.

    The count is even, at least `samples` and at least twice the dimensions. Half of them are the additive recurrence by
    the powers of 1 / g, where g^(dimensions + 1) = g + 1 (the golden ratio in one dimension).
    """
    pairs = max((samples + 1) // 2, dimensions)
    g = 2.0
    for _ in range(64):  # each time the error is less than half as large
        g = (1.0 + g) ** (1.0 / (dimensions + 1))
    inverse = NormalDist().inv_cdf
    half = np.array([[inverse((0.5 + k * g**-j) % 1.0) for k in range(1, pairs + 1)] for j in range(1, dimensions + 1)])
    points = np.concatenate((half, -half), axis=1)
    factor, _ = factor_of(tuple(moments(points)[1].ravel().tolist()))
    for i, row in enumerate(factor):  # divided by the factor; a linear solver's last bits would depend on the machine
        points[i] = (points[i] - (row[:i, None] * points[:i]).sum(axis=0)) / row[i]
    return points


@lru_cache(maxsize=16)
def factor_of(covariance: tuple[float, ...]) -> tuple[NDArray[np.float64], Covariance]:
    """The lower triangular matrix whose product with its transpose is a covariance (row by row); zero if none is."""
    size = round(sqrt(len(covariance)))
    none = np.zeros((size, size)), Covariance.REFUSED
    if not all(-LARGEST <= number <= LARGEST for number in covariance):
        return none
    rows = [covariance[i * size : (i + 1) * size] for i in range(size)]
    scales = [sqrt(rows[i][i]) if rows[i][i] > 0.0 else 1.0 for i in range(size)]
    factor = [[0.0] * size for _ in range(size)]
    for j in range(size):
        for i in range(j, size):
            rest, other = rows[i][j] / (scales[i] * scales[j]), rows[j][i] / (scales[i] * scales[j])
            if abs(rest - other) > ROUNDING:
                return none
            for k in range(j):
                rest -= factor[i][k] * factor[j][k]
            if i == j:
                if rest < -ROUNDING:
                    return none
                factor[j][j] = sqrt(rest) if rest > ROUNDING else 0.0
            elif factor[j][j] > 0.0:
                factor[i][j] = rest / factor[j][j]
            elif abs(rest) > sqrt(ROUNDING):
                return none
    return np.array(factor) * np.array(scales)[:, None], Covariance.USED


def impacts(
    body: TwoPointBody,
    twist: Twist,
    changes: NDArray[np.float64],
    friction: NDArray[np.float64],
    restitution: NDArray[np.float64],
    law: str,
) -> Outcomes:
    """The impacts with changes of the twist (3, n), of the friction of both contacts (n) and of restitution (n)."""
    changes = product(np.array(allowed_changes(body, twist)), changes)
    old, new = body.old, body.new
    if old is not None:
        held: Any = np.maximum(0.0, old.friction + friction)
        old = old._replace(friction=held)
    grips: Any = np.maximum(0.0, new.friction + friction)
    bounces: Any = np.minimum(1.0, np.maximum(0.0, new.restitution + restitution))
    changed: Any = [part + change for part, change in zip(twist, changes, strict=True)]
    changed_body = body._replace(old=old, new=new._replace(friction=grips, restitution=bounces))
    return solve_impacts(changed_body, Twist(*changed), law, restitution=RESTITUTION[law])


def product(matrix: NDArray[np.float64], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """The matrix product, in an order of operations that is the same everywhere."""
    return np.asarray((matrix[:, :, None] * columns).sum(axis=1))


def moments(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean (k) and covariance (k, k) of values (k, n)."""
    values = np.ascontiguousarray(values)
    count = values.shape[1]
    mean = values.sum(axis=1) / count
    rest = values - mean[:, None]
    return mean, (rest[:, None, :] * rest).sum(axis=2) / count


def probabilities(outcomes: Outcomes) -> tuple[float, ...]:
    return tuple((np.bincount(outcomes.mode, minlength=len(Mode)) / len(outcomes.mode)).tolist())


def into_plane(frame: Sequence[Vector3], center: Vector3) -> NDArray[np.float64]:
    """From a twist at the body frame's origin to vx, vy and omega of the mass centre in the impact plane, and to what
    is left over: its velocity along the axis, roll and yaw. `frame` is (ahead, normal, axis).
    """
    ahead, normal, axis = frame
    # a . (v + w x c) = a . v + (c x a) . w
    a, n, x = [(*way, *cross(center, way)) for way in frame]
    return np.array([a, n, (*ORIGIN, *times(axis, -1.0)), x, (*ORIGIN, *ahead), (*ORIGIN, *normal)])


def into_space(frame: Sequence[Vector3], center: Vector3) -> NDArray[np.float64]:
    """The way back of `into_plane`."""
    ahead, normal, axis = frame
    back, roll, yaw = [(*cross(center, way), *way) for way in (times(axis, -1.0), ahead, normal)]
    return np.array([(*ahead, *ORIGIN), (*normal, *ORIGIN), back, (*axis, *ORIGIN), roll, yaw]).T
