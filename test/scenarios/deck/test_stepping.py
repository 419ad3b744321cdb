"""Small steps of a body on a deck: against Newton's and Euler's laws in a frame that turns, and a block that slides."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from impact_predictor.scenarios.deck.stepping import FINE, HOLDER, advance

MASS = 3.0
INERTIA = np.array([[0.5, 0.05, -0.02], [0.05, 0.4, 0.03], [-0.02, 0.03, 0.3]])
GRAVITY, SPIN, TURNING = np.array([[0.5, -0.3, -9.0], [0.4, -0.5, 0.8], [2.0, 3.0, -1.0]])
POINT, ANCHOR = np.array([[0.3, -0.2, 0.25], [0.9, 0.8, -0.4]])
LENGTH, STIFFNESS, DAMPING, MOST = 0.5, 200.0, 30.0, 1e3


def advanced(
    step: float,
    steps: int,
    start: Any,
    felt: Any,
    points: Any,
    lashings: Any,
    friction: float,
    stiffness: float,
    inertia: Any = INERTIA,
) -> tuple[Any, Any]:
    """The states, loads and times (steps, 15), and which points press and slip (steps, 2 n)."""
    n = len(points)
    contact = friction, 0.0, stiffness, 2.0 * np.sqrt(stiffness * MASS / max(1, n))
    given = [step, 0.0, MASS, *contact, *inertia.ravel(), *np.linalg.inv(inertia).ravel()]
    rows, marks, work = [0.0] * (15 * FINE * steps), [0] * (2 * n * FINE * steps), [0.0] * (11 * n + 1)
    count = advance(steps, n, given, np.ravel(felt), list(start), np.ravel(points), lashings, work, rows, marks)
    assert count == steps  # nothing strikes
    return np.reshape(rows, (-1, 15))[:steps], np.reshape(marks, (-1, 2 * n))[:steps] if n else None


def newton(time: float, y: Any) -> Any:
    """Derivative of place, rotation matrix, velocity and angular velocity in the frame of the deck."""
    place, turn, velocity, angular = y[:3], y[3:12].reshape(3, 3), y[12:15], y[15:]
    spin, arm = SPIN + TURNING * time, turn @ POINT
    rope = ANCHOR - place - arm
    length = np.linalg.norm(rope)
    rate = -rope @ (velocity + np.cross(angular, arm)) / length
    force = (STIFFNESS * (length - LENGTH) + DAMPING * rate) * rope / length
    free = GRAVITY - np.cross(TURNING, place) - np.cross(spin, np.cross(spin, place)) - 2.0 * np.cross(spin, velocity)
    tensor, whole = turn @ INERTIA @ turn.T, spin + angular
    turned = np.linalg.solve(tensor, np.cross(arm, force) - np.cross(whole, tensor @ whole))
    change = np.cross(angular, turn.T).T
    return np.concatenate([velocity, change.ravel(), free + force / MASS, turned - np.cross(spin, whole) - TURNING])


def test_a_lashed_body_moves_by_newtons_and_eulers_laws_on_a_deck_that_turns() -> None:
    step, steps = 5e-5, 1000
    pose = Rotation.from_rotvec([0.3, -0.5, 0.7])
    start = np.array([0.1, -0.2, 0.6]), np.array([0.8, -0.5, 0.3]), np.array([2.0, -1.5, 2.5])
    course = solve_ivp(
        newton, (0.0, step * steps), np.concatenate([start[0], pose.as_matrix().ravel(), *start[1:]]), rtol=1e-9
    ).y[:, -1]
    felt = [[*GRAVITY, *(SPIN + TURNING * step * k), *TURNING] for k in range(steps)]
    lashing = [*POINT, *ANCHOR, LENGTH, STIFFNESS, DAMPING, MOST]
    assert len(lashing) == HOLDER
    y0 = [*start[0], *pose.as_quat(), *start[1], *start[2]]
    rows, _ = advanced(step, steps, y0, felt, [], lashing, 0.0, 1.0)
    end = rows[-1]
    assert end[:3] == pytest.approx(course[:3], abs=1e-4)
    assert Rotation.from_quat(end[3:7]).as_matrix().ravel() == pytest.approx(course[3:12], abs=3e-4)
    assert end[7:13] == pytest.approx(course[12:], abs=3e-3)
    assert np.abs(end[7:13] - y0[7:]).min() > 0.05  # all of it changes


@pytest.mark.parametrize("friction", [0.3, 1.5])
def test_a_block_slides_with_the_deceleration_of_friction_under_its_whole_weight(friction: float) -> None:
    step, steps, stiffness = 1e-4, 200, 1e6
    points = [(x, y, -0.01) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    start = [0.0, 0.0, 0.01 - MASS * 9.81 / (4.0 * stiffness), 0.0, 0.0, 0.0, 1.0, 0.6, -0.8, 0.0, 0.0, 0.0, 0.0]
    felt = [[0.0, 0.0, -9.81] + [0.0] * 6] * steps
    rows, marks = advanced(step, steps, start, felt, points, [], friction, stiffness)
    assert rows[:, 14] == pytest.approx(step * np.arange(1, steps + 1))
    assert rows[:, 13] == pytest.approx(1.0, abs=1e-3)  # of the weight
    slower = 1.0 - friction * 9.81 * step * steps
    assert rows[-1, 7:10] == pytest.approx([0.6 * slower, -0.8 * slower, 0.0], abs=1e-3)
    assert (marks == 1).all()


@pytest.mark.parametrize("across", [0, 1])
def test_a_plate_on_two_feet_that_hold_tips_over_them_as_a_pendulum_about_its_lower_edge(across: int) -> None:
    step, steps, stiffness, high, push = 1e-4, 100, 1e6, 0.5, 2.0
    moments = np.full(3, MASS * high**2 / 6.0)
    moments[across] *= 2.0  # it is thin this way, and tips so
    points = np.full((2, 3), -high)
    points[:, across], points[:, 1 - across] = 0.0, [-high, high]
    start = [0.0, 0.0, high - MASS * 9.81 / (2.0 * stiffness), 0.0, 0.0, 0.0, 1.0] + [0.0] * 6
    felt = np.array([0.0, 0.0, -9.81] + [0.0] * 6)
    felt[across] = push
    rows, marks = advanced(step, steps, start, [felt] * steps, points, [], 1.0, stiffness, np.diag(moments))
    about_edge = moments[1 - across] + MASS * high**2
    faster = push * MASS * high**2 / about_edge * step * steps
    assert rows[-1, 7 + across] == pytest.approx(faster, rel=1e-3)
    assert (marks == [1, 1, 0, 0]).all()  # both press, and none slips
