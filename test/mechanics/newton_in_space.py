"""Newton's and Euler's laws of a rigid body on points over a plane in three dimensions, for tests of its motion.

What each standing point does is told, not found: the reactions are those that make it stick, or slip with Coulomb's
friction, and the reference says whether they are within their cones on the way.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.motion.spatial import Pull, SpatialState

EXACT = 1e-12


class SpatialCourse(NamedTuple):
    """The touchdown, what has happened to the energy of free motion by then, and the least margin of the reactions."""

    time: float
    point: int
    state: Any
    margin: float


def numbers_of(state: SpatialState) -> Any:
    return np.concatenate(state)


def tensor(inertia: Sequence[float]) -> Any:
    xx, yy, zz, xy, xz, yz = inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class Newton:
    """A body on points that stick ("S") or slip ("+"), by their indices."""

    def __init__(
        self, inertia: Sequence[float], points: Any, labels: dict[int, str], friction: float, pull: Pull
    ) -> None:
        self.inertia, self.points, self.labels = tensor(inertia), np.asarray(points, float), labels
        self.friction, self.pull = friction, [np.asarray(part, float) for part in pull]

    def solve(self, time: float, y: Any) -> tuple[Any, Any]:
        """Acceleration of the mass centre and of the angle, and the reactions (n, 3) of the standing points."""
        turn = Rotation.from_quat(y[3:7]).as_matrix()
        v, w = y[7:10], y[10:13]
        gravity, growth, spin, turning = self.pull
        spin = spin + turning * time
        inertia = turn @ self.inertia @ turn.T
        absolute = w + spin
        felt = gravity + growth * time - 2.0 * np.cross(spin, v) - np.cross(spin, np.cross(spin, y[:3]))
        felt = felt - np.cross(turning, y[:3])
        gyro = -np.linalg.solve(inertia, np.cross(absolute, inertia @ absolute)) - turning - np.cross(spin, w)
        rows, targets, columns = [], [], []
        for i, label in self.labels.items():
            r = turn @ self.points[i]
            slip = v + np.cross(w, r)
            drag = -self.friction * slip / np.linalg.norm(slip[:2]) if label == "+" else np.zeros(3)
            drag[2] = 1.0
            forces = [drag] if label == "+" else list(np.eye(3))
            columns += [(i, r, force) for force in forces]
            bias = felt + np.cross(gyro, r) + np.cross(w, np.cross(w, r))
            for axis in [2] if label == "+" else [0, 1, 2]:
                rows.append((r, axis))
                targets.append(-bias[axis])
        parts = [(force, np.linalg.solve(inertia, np.cross(r, force))) for _, r, force in columns]
        if parts:
            W = np.array([[(a + np.cross(b, r))[axis] for a, b in parts] for r, axis in rows])
            sizes = np.linalg.lstsq(W, np.array(targets), rcond=1e-10)[0]
        else:
            sizes = np.zeros(0)
        reactions = np.zeros((len(self.points), 3))
        for size, (a, b), (i, _, force) in zip(sizes, parts, columns, strict=True):
            felt, gyro, reactions[i] = felt + size * a, gyro + size * b, reactions[i] + size * force
        return np.concatenate([felt, gyro]), reactions

    def rates(self, time: float, y: Any) -> Any:
        x, y_, z, s = y[3:7]
        wx, wy, wz = y[10:13]
        quaternion = [wx * s + wy * z - wz * y_, wy * s + wz * x - wx * z, wz * s + wx * y_ - wy * x]
        quaternion.append(-wx * x - wy * y_ - wz * z)
        return np.concatenate([y[7:10], 0.5 * np.array(quaternion), self.solve(time, y)[0]])

    def gaps(self, y: Any) -> Any:
        return y[2] + Rotation.from_quat(y[3:7]).apply(self.points)[:, 2]

    def strike(self, start: SpatialState, last: float) -> SpatialCourse:
        """Follow the body until a point that does not stand reaches the plane."""

        def gap(i: int) -> Any:
            def of(time: float, y: Any) -> float:
                return float(self.gaps(y)[i])

            of.terminal, of.direction = True, -1.0  # type: ignore[attr-defined]
            return of

        free = [i for i in range(len(self.points)) if i not in self.labels]
        found = solve_ivp(
            self.rates, (0.0, last), numbers_of(start), "DOP853", rtol=EXACT, atol=EXACT, events=[gap(i) for i in free]
        )
        margin = np.inf
        for time, y in zip(found.t, found.y.T, strict=True):
            for i, label in self.labels.items():
                tx, ty, normal = self.solve(time, y)[1][i]
                cone = self.friction * normal - np.hypot(tx, ty) if label == "S" else normal
                margin = min(margin, normal, cone)
        for i, times, states in zip(free, found.t_events, found.y_events, strict=True):
            if len(times):
                return SpatialCourse(float(times[0]), i, states[0], margin)
        return SpatialCourse(np.inf, -1, found.y[:, -1], margin)
