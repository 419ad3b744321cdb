"""Predictions of bodies that fall, pivot and strike in three dimensions, anywhere in space.

The motion up to the touchdown is integrated on its own by Newton's and Euler's laws, in the frame of the support, and
placed with scipy's rotations: any support, any position, any body frame. The impact is that of the law itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from bodies_in_space import ALIKE, CUBE, HALF, Array, Somewhere, somewhere, state_of, turning
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.motion.spatial import SpatialState
from impact_predictor.mechanics.types import ContactState, Flag
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.types import Touchdown

CLOSE = 1e-5
"""The motion is followed to 1e-6 of its scales, up to some m/s."""
STRUCK = 2e-4
"""... and the impact makes more of it."""


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


def test_a_face_that_is_level_strikes_with_all_its_corners() -> None:
    placed = somewhere(1, CUBE, inertia=ALIKE)
    start = state_of(0.06, Rotation.from_rotvec([0.0, 0.0, 0.5]), [0.8, 0.3, -1.0], [0.0, 0.0, 2.0])
    course = placed.newton({}).strike(start, 0.6)
    new, outcome = placed.impact(course.state, ())
    touchdown = Predictor(placed.scene()).update(placed.sample(0.0, np.concatenate(start))).touchdown
    assert touchdown is not None
    assert (touchdown.old, touchdown.new) == ((), new)
    assert len(new) == 4
    assert_told(touchdown, placed, course.state, np.array(outcome.twist))


def test_a_touchdown_in_space_is_announced_up_to_the_horizon() -> None:
    placed = somewhere(2, CUBE)
    start, labels = flying(np.random.default_rng(2))
    time = placed.newton(labels).strike(start, 0.6).time
    sample = placed.sample(0.0, np.concatenate(start))
    for horizon, is_announced in ((time - 1e-5, False), (time + 1e-5, True)):
        assert (Predictor(placed.scene(horizon=horizon)).update(sample).touchdown is not None) is is_announced


@pytest.mark.parametrize("poses", [False, True], ids=["averaged twists", "differenced poses"])
def test_the_twist_of_a_body_in_space_is_that_of_half_its_window_ago(poses: bool) -> None:
    window, placed = 0.01, somewhere(3, CUBE, inertia=ALIKE)
    start, labels = flying(np.random.default_rng(4))
    newton = placed.newton(labels)
    end = newton.strike(start, 0.6).time
    aware = Predictor(placed.scene(twist_window=window, poses=poses))
    naive = Predictor(placed.scene())
    late: list[float] = []
    too_late: list[float] = []
    for time in np.arange(0.02, end - 0.005, window):
        now, earlier = (newton.strike(start, moment).state for moment in (time, time - window))
        averaged = placed.sample(time, now, earlier, window)
        told = averaged._replace(linear=(9.0, 9.0, 9.0), angular=(0.0, 0.0, 0.0)) if poses else averaged
        first = poses and time == 0.02
        for predictor, sample, errors in ((aware, told, late), (naive, averaged, too_late)):
            touchdown = predictor.update(sample).touchdown
            if not first:
                assert touchdown is not None
                errors.append(abs(touchdown.lead_time - (end - time)))
    assert max(late) < 1e-3
    assert max(late) < 0.25 * max(too_late)


def test_a_touchdown_right_after_another_is_told_by_the_impact_that_the_twist_does_not_show_yet() -> None:
    """An edge that is askew by 10 mm strikes in flight: one corner, and within the twist window the other one."""
    window = 0.012
    placed = somewhere(5, CUBE, inertia=ALIKE)
    edge = Rotation.from_rotvec([0.1, 0.0, 0.0]) * Rotation.from_rotvec([0.0, 0.5, 0.0])
    start = state_of(0.11, edge, [0.3, 0.0, -1.0], [0.0, 0.0, 0.0])
    first = placed.newton({}).strike(start, 0.6)
    new, outcome = placed.impact(first.state, ())
    assert len(new) == 1
    again = SpatialState(
        *(tuple(part) for part in (first.state[:3], first.state[3:7], outcome.twist[:3], outcome.twist[3:]))
    )
    freely = placed.newton({})
    second = freely.strike(again, 0.2)
    assert 0.6 * window < second.time < window
    assert second.point not in new

    def state(time: float) -> Array:
        if time < first.time:
            return placed.newton({}).strike(start, time).state
        return freely.strike(again, time - first.time).state

    predictor, told = Predictor(placed.scene(twist_window=window, tolerance=0.005)), []
    end = first.time + second.time
    for time in np.arange(first.time - 0.03, end - 5e-4, 0.001):
        touchdown = predictor.update(placed.sample(time, state(time), state(time - window), window)).touchdown
        if touchdown is not None and time > first.time + 0.6 * window:  # half of it shows that it has landed
            told.append((touchdown.new, touchdown.lead_time - (end - time)))
    assert {points for points, _ in told} == {(second.point,)}
    assert max(abs(error) for _, error in told) < 1e-3


def test_what_noise_hides_of_the_space_beside_a_plane_is_not_told_from_it() -> None:
    """A block at rest shows how far gaps and rates scatter; as little motion across its plane makes no other law."""
    placed = somewhere(6, CUBE, inertia=ALIKE, friction=1.2)
    x, y, z = placed.support.apply([0.6, 0.0, -9.6]).tolist()
    scene, rng = placed.scene(tolerance=0.003, gravity=(x, y, z)), np.random.default_rng(6)
    stood = np.concatenate(state_of(HALF, Rotation.identity(), 3 * [0.0], 3 * [0.0]))
    lifted = Rotation.from_rotvec([0.0, 0.2, 0.0])
    corner = lifted.apply(CUBE)[:, 2].argmin()
    falls = np.concatenate(turning(lifted, [int(corner)], [0.0, -1.5, 0.0]))
    noise = 3e-4 * np.concatenate([[0.0, 0.0, 1.0], np.zeros(4), np.ones(3), np.zeros(3)])
    fresh, watched = Predictor(scene), Predictor(scene)
    for k in range(200):
        watched.update(placed.sample(0.001 * k, stood + noise * rng.normal(size=13)))
    askew = falls + noise * np.where(np.arange(13) < 9, 2.0, 0.0)
    answers = [predictor.update(placed.sample(0.3, askew)).touchdown for predictor in (fresh, watched)]
    assert [touchdown is not None and bool(touchdown.segments) for touchdown in answers] == [False, True]


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("samples", [0, 16])
def test_no_point_of_what_is_told_approaches_its_support(samples: int, law: str) -> None:
    """Of those that take part, but for one that has not closed yet; where it cannot be, a flag names it."""
    rng, told, named = np.random.default_rng(9), 0, 0
    for seed in range(120):
        points = CUBE if seed % 3 else 0.1 * rng.uniform(-1.0, 1.0, (12, 3))
        placed = somewhere(seed, points, friction=float(rng.choice([0.05, 0.3, 1.0, 3.0])))
        turn = Rotation.random(random_state=rng)
        start = state_of(0.2, turn, [*rng.normal(size=2), -1.0], 6.0 * rng.normal(size=3))
        scene = placed.scene(law=law, samples=samples, restitution=float(rng.uniform(0.0, 1.0)))
        touchdown = Predictor(scene).update(placed.sample(0.0, np.concatenate(start))).touchdown
        if touchdown is None:
            continue
        told += 1
        speed = np.linalg.norm(touchdown.before_6d.linear) + 0.1 * np.linalg.norm(touchdown.before_6d.angular)
        rates = [
            float(np.dot(scene.normal, contact.velocity))
            for contact in touchdown.contacts
            if contact.state is not ContactState.NEARS
        ]
        if min(rates) < -1e-4 * speed:
            named += 1
            assert touchdown.flags & Flag.NOT_CONVERGED
    assert told > 100
    assert named <= 1
