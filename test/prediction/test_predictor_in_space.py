"""Predictions of bodies that fall, pivot and strike in three dimensions, anywhere in space.

The motion up to the touchdown is integrated on its own by Newton's and Euler's laws, in the frame of the support, and
placed with scipy's rotations: any support, any position, any body frame. The impact is that of the law itself.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pytest
from newton_in_space import Newton, tensor
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, SpatialOutcome, solve_spatial_impact
from impact_predictor.mechanics.motion.spatial import Pull, SpatialState
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Sample, Touchdown, Vector3

CLOSE = 1e-5
"""The motion is followed to 1e-6 of its scales, up to some m/s."""
STRUCK = 2e-4
"""... and the impact makes more of it."""
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


def triple(numbers: Any) -> Vector3:
    x, y, z = (float(number) for number in numbers)
    return x, y, z


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


def flying(rng: np.random.Generator) -> tuple[SpatialState, dict[int, str]]:
    turn = Rotation.random(random_state=rng)
    return state_of(0.15, turn, [*rng.normal(size=2), -0.5], 5.0 * rng.normal(size=3)), {}


def tipping(rng: np.random.Generator, slip: float) -> tuple[SpatialState, dict[int, str]]:
    """On one corner, with another one low."""
    turn = Rotation.from_euler("zxy", [rng.uniform(0.0, 6.0), rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.3)])
    corner = int(turn.apply(CUBE)[:, 2].argmin())
    way = rng.uniform(0.0, 2.0 * np.pi)
    state = turning(turn, [corner], rng.normal(size=3), (slip * np.cos(way), slip * np.sin(way)))
    return state, {corner: "+" if slip else "S"}


def on_an_edge(rng: np.random.Generator) -> tuple[SpatialState, dict[int, str]]:
    """Two corners stand, and which of the others come first is up to a skew of their own."""
    turn = Rotation.from_rotvec([0.0, 0.0, rng.uniform(0.0, 6.0)]) * Rotation.from_rotvec([0.0, 0.2, 0.0])
    standing = [int(i) for i in np.argsort(turn.apply(CUBE)[:, 2])[:2]]
    axis = turn.apply(CUBE[standing[1]] - CUBE[standing[0]])
    spin = axis / np.linalg.norm(axis) * np.sign(turn.apply([0.0, 1.0, 0.0]) @ axis) * -1.5
    return turning(turn, standing, spin), dict.fromkeys(standing, "S")


KINDS: dict[str, tuple[Callable[..., tuple[SpatialState, dict[int, str]]], tuple[Any, ...], float]] = {
    "in flight": (flying, (), 0.3),
    "on a corner that sticks": (tipping, (0.0,), 3.0),
    "on a corner that slips": (tipping, (1.5,), 0.15),
    "on an edge": (on_an_edge, (), 3.0),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(6))
def test_a_touchdown_is_foreseen_as_it_happens_in_space(kind: str, seed: int) -> None:
    begin, given, friction = KINDS[kind]
    rng = np.random.default_rng(seed)
    skew = np.where(np.arange(8) == 3, 0.004, 0.0)[:, None] * [0.0, 0.0, -1.0] if begin is on_an_edge else 0.0
    placed = somewhere(seed, CUBE + skew, friction=friction)
    while True:
        start, labels = begin(rng, *given)
        newton = placed.newton(labels)
        rates = np.cross(start.angular_velocity, Rotation.from_quat(start.orientation).apply(placed.points))[:, 2]
        if start.velocity[2] + min(rates) > -0.1:
            continue  # nothing is known to fall yet
        course = newton.strike(start, 0.6)
        if course.point >= 0 and course.time > 0.01 and course.margin > 0.0:
            break
    old = tuple(labels)
    new, outcome = placed.impact(course.state, old)
    for part in (0.0, 0.5, 0.9):
        stamp = round(part * course.time * 1e9) * 1e-9
        now = newton.strike(start, stamp).state if part else np.concatenate(start)
        touchdown = Predictor(placed.scene()).update(placed.sample(stamp, now)).touchdown
        assert touchdown is not None
        assert (set(touchdown.old), touchdown.new) == (set(old), new)
        assert touchdown.lead_time == pytest.approx(course.time - stamp, abs=CLOSE)
        assert_told(touchdown, placed, course.state, np.array(outcome.twist))


def assert_told(touchdown: Touchdown, placed: Somewhere, state: Array, after: Array) -> None:
    position, orientation = placed.pose(state)
    assert touchdown.position == pytest.approx(position, abs=CLOSE)
    assert (Rotation.from_quat(touchdown.orientation).inv() * orientation).magnitude() < 10.0 * CLOSE
    for twist, true in ((touchdown.before_6d, state[7:13]), (touchdown.after_6d, after)):
        close = CLOSE if twist is touchdown.before_6d else STRUCK
        assert twist.linear == pytest.approx(placed.support.apply(true[:3]), abs=close)
        assert HALF * np.array(twist.angular) == pytest.approx(HALF * placed.support.apply(true[3:]), abs=close)
    spin = orientation.inv().apply(placed.support.apply(after[3:]))
    linear = orientation.inv().apply(placed.support.apply(after[:3])) - np.cross(spin, placed.center)
    assert touchdown.linear == pytest.approx(linear, abs=10.0 * STRUCK)
    assert HALF * np.array(touchdown.angular) == pytest.approx(HALF * spin, abs=10.0 * STRUCK)
