"""Bodies anywhere in space, whose motion up to the next touchdown Newton's and Euler's laws tell on their own."""

from __future__ import annotations

from itertools import product
from typing import Any, NamedTuple

import numpy as np
from newton_in_space import Newton, tensor
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, SpatialOutcome, solve_spatial_impact
from impact_predictor.mechanics.motion.spatial import Pull, SpatialState
from impact_predictor.prediction.scene import Scene, triple
from impact_predictor.prediction.types import Sample, Vector3

HALF = 0.05
MERGE, SLOW = 0.0015, 0.005
CUBE = np.array(list(product((-HALF, HALF), repeat=3)))
GENERAL = tuple(4 * HALF * HALF / 6.0 * part for part in (1.0, 1.2, 1.4, 0.05, 0.02, -0.1))
ALIKE = (4 * HALF * HALF / 6.0,) * 3 + (0.0,) * 3
PULL = Pull(gravity=(0.6, -0.3, -9.6))
"""On a slope."""
MASS, RESTITUTION = 0.4, 0.2
ZEROS = (0.0,) * 36

Array = np.ndarray[Any, np.dtype[np.float64]]


class Somewhere(NamedTuple):
    """A body over a support: the rotation and shift of the support's frame, the rotation of the body's axes and the
    mass centre in the body frame, its contact points from there, its inertia over its mass, and its friction.
    """

    support: Rotation
    place: Array
    mount: Rotation
    center: Vector3
    points: Array
    inertia: tuple[float, ...] = GENERAL
    friction: float = 0.3

    def scene(self, **changes: Any) -> Scene:
        own = MASS * self.mount.as_matrix().T @ tensor(self.inertia) @ self.mount.as_matrix()
        normal = self.support.apply([0.0, 0.0, 1.0])
        scene = Scene(
            mass=MASS,
            inertia=(triple(own[0]), triple(own[1]), triple(own[2])),
            friction=self.friction,
            restitution=RESTITUTION,
            center_of_mass=self.center,
            points=tuple(triple(self.mount.inv().apply(point) + self.center) for point in self.points),
            normal=triple(normal),
            height=float(normal @ self.place),
            gravity=triple(self.support.apply(PULL.gravity)),
            contact_time=SLOW,
            merge=MERGE,
            tolerance=1e-4,
            horizon=1.0,
        )
        return scene._replace(**changes)

    def pose(self, state: Array) -> tuple[Array, Rotation]:
        """Of the body frame, of a state as `Newton` has it."""
        orientation = self.support * Rotation.from_quat(state[3:7]) * self.mount
        return self.place + self.support.apply(state[:3]) - orientation.apply(self.center), orientation

    def sample(self, time: float, state: Array, earlier: Array | None = None, window: float = 0.0) -> Sample:
        """A sample of a state; its twist is the mean over a window from an `earlier` state on, if that is given."""
        position, orientation = self.pose(state)
        if earlier is None:
            spin = self.support.apply(state[10:13])
            linear = self.support.apply(state[7:10]) - np.cross(spin, orientation.apply(self.center))
        else:
            place, was = self.pose(earlier)
            linear, spin = (position - place) / window, (orientation * was.inv()).as_rotvec() / window
        x, y, z, w = (float(part) for part in orientation.as_quat())
        twist = triple(orientation.inv().apply(linear)), triple(orientation.inv().apply(spin))
        return Sample(round(time * 1e9), "world", "body", triple(position), (x, y, z, w), *twist, ZEROS, ZEROS)

    def newton(self, labels: dict[int, str]) -> Newton:
        return Newton(self.inertia, self.points, labels, self.friction, PULL)

    def impact(self, state: Array, old: tuple[int, ...]) -> tuple[tuple[int, ...], SpatialOutcome]:
        """Which points take part in the impact that begins in a state, and what it does, in the support's frame."""
        turn = Rotation.from_quat(state[3:7])
        arms = turn.apply(self.points)
        gaps, rates = state[2] + arms[:, 2], state[9] + np.cross(state[10:13], arms)[:, 2]
        new = tuple(
            i for i in range(len(gaps)) if i not in old and rates[i] < 0.0 and gaps[i] < 1e-9 - 2.0 * MERGE * rates[i]
        )
        taking = [*old, *new]
        apart = [0.0 if i in old else max(0.0, gaps[i]) for i in taking]
        contacts = ContactPoints(arms[taking], self.friction, RESTITUTION, gaps=apart)
        body = Body(MASS, MASS * turn.as_matrix() @ tensor(self.inertia) @ turn.as_matrix().T)
        slow = SLOW * float(np.linalg.norm(PULL.gravity))
        return new, solve_spatial_impact(body, contacts, state[7:13], merge=MERGE, threshold=slow)


def somewhere(seed: int, points: Array, **changes: Any) -> Somewhere:
    rng = np.random.default_rng(seed)
    support, mount = Rotation.random(2, random_state=rng)
    placed = Somewhere(support, rng.normal(size=3), mount, triple(0.1 * rng.normal(size=3)), points)
    return placed._replace(**changes)


def state_of(height: float, turn: Rotation, velocity: Any, spin: Any) -> SpatialState:
    x, y, z, w = (float(part) for part in turn.as_quat())
    return SpatialState((0.3, -0.2, height), (x, y, z, w), triple(velocity), triple(spin))


def turning(turn: Rotation, standing: list[int], spin: Any, slip: tuple[float, float] = (0.0, 0.0)) -> SpatialState:
    """A body on some of its points, the first of which moves along the support by `slip`."""
    arms = turn.apply(CUBE)
    stands = arms[standing[0]]
    return state_of(-stands[2], turn, np.cross(stands, spin) + np.array([*slip, 0.0]), spin)
