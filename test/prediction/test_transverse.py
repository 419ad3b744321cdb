"""Predictions of bodies that also slip across their impact plane."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.transverse import Transverse, solve_transverse_impact
from impact_predictor.mechanics.types import Contact, Flag, Twist, TwoPointBody, Validity
from impact_predictor.prediction.impact import SLIPS, TOLERANCE
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Sample, Touchdown, Vector3

ROUNDING = 1e-6
"""The gap of 1e-9 m takes 1e-9 s, in which gravity adds 1e-8 m/s; the rest is what the motion is followed to."""

GAP = 1e-9
"""m, under the front of the box."""

LENGTH, WIDTH, HEIGHT = 0.3, 0.4, 0.2
"""m, of a box along x, y, z; its sides lie along those of the world."""

BOTTOM = tuple((x, y, -HEIGHT / 2) for x in (-LENGTH / 2, LENGTH / 2) for y in (-WIDTH / 2, WIDTH / 2))
INERTIA = (0.03, 0.05, 0.07)
SCENE = Scene(
    2.0,
    ((INERTIA[0], 0.0, 0.0), (0.0, INERTIA[1], 0.0), (0.0, 0.0, INERTIA[2])),
    0.3,
    restitution=0.3,
    points=BOTTOM,
    gravity=(0.0, 0.0, -9.81),
)


def box(linear: Vector3, angular: Vector3, front: float = GAP) -> Sample:
    """A sample of the box with its back edge on the floor and its front edge this far above it."""
    tilt = front / LENGTH
    height = HEIGHT / 2 + front / 2
    orientation = (0.0, -tilt / 2, 0.0, 1.0)
    zeros = (0.0,) * 36
    return Sample(0, "world", "box", (0.0, 0.0, height), orientation, linear, angular, zeros, zeros)


def turning(omega: float, slip: float, lateral: float, yaw: float = 0.0) -> Sample:
    """The box turns about its back edge and slips on it, forward along x and to the left along y; it yaws about z."""
    velocity = (omega * -HEIGHT / 2 + slip, lateral, -omega * -LENGTH / 2)
    # About its edge it turns clockwise as seen from the right, where y points away.
    return box(velocity, (0.0, -omega, yaw))


def announced(sample: Sample, scene: Scene = SCENE) -> Touchdown:
    touchdown = Predictor(scene).update(sample).touchdown
    assert touchdown is not None
    return touchdown


def planar(scene: Scene = SCENE) -> TwoPointBody:
    """The box in the plane of x and z."""
    back, front = (Contact(x, -HEIGHT / 2, scene.friction) for x in (-LENGTH / 2, LENGTH / 2))
    return TwoPointBody(scene.mass, INERTIA[1], back, front._replace(restitution=scene.restitution))


@pytest.mark.parametrize("lateral", [0.4, -1.5])
@pytest.mark.parametrize("yaw", [0.0, 0.8])
def test_friction_of_a_box_that_slips_along_its_edge_opposes_the_whole_slip(lateral: float, yaw: float) -> None:
    omega, slip = -4.0, 0.5
    touchdown = announced(turning(omega, slip, lateral, yaw))
    before = Twist(*planar().turning(omega)) + np.array([slip, 0.0, 0.0])
    # z = x cross up is to the right, against y.
    motion = Transverse(-lateral, 0.0, yaw, yaw_inertia=INERTIA[2])
    expected, after, _ = solve_transverse_impact(planar(), Twist(*before), motion, TOLERANCE)
    assert touchdown.after == pytest.approx(expected.twist, abs=ROUNDING)
    assert touchdown.mode is expected.mode
    assert touchdown.energy_lost == pytest.approx(expected.energy_lost, abs=ROUNDING)
    assert touchdown.impulses == pytest.approx(np.array(expected.impulses), abs=ROUNDING)
    now = Rotation.from_quat(touchdown.orientation)
    linear = (expected.twist.vx, -after.velocity, expected.twist.vy)
    assert now.apply(touchdown.linear) == pytest.approx(linear, abs=ROUNDING)
    assert now.apply(touchdown.angular) == pytest.approx((0.0, -expected.twist.omega, after.yaw), abs=ROUNDING)
    assert abs(after.velocity) < 0.9 * abs(lateral)
    assert touchdown.lateral == pytest.approx(lateral + 0.5 * LENGTH * -yaw, abs=ROUNDING)


@pytest.mark.parametrize("part", [0.0, 0.5 * SLIPS, 0.98 * SLIPS])
def test_less_slip_than_can_be_measured_leaves_the_planar_law_to_the_last_bit(part: float) -> None:
    speed = 4.0 * LENGTH  # of the front, with a slip that its height above the edge takes away
    sample = turning(-4.0, 0.0, part * speed)
    on, off = announced(sample), announced(sample, SCENE._replace(transverse_slip=False))
    assert on == off


def test_a_body_on_an_edge_cannot_roll_and_one_that_lands_on_a_point_can() -> None:
    edge = announced(turning(-4.0, 0.5, 1.0))
    assert Rotation.from_quat(edge.orientation).apply(edge.angular)[0] == pytest.approx(0.0, abs=ROUNDING)

    point = SCENE._replace(points=((0.1, 0.0, -HEIGHT / 2), (0.0, 0.0, HEIGHT / 2)), restitution=0.0)
    sample = box((0.0, 1.0, -1.0), (0.0, 0.5, 0.0))
    landing = announced(sample._replace(position=(0.0, 0.0, HEIGHT / 2 + GAP)), point)
    roll, _, yaw = Rotation.from_quat(landing.orientation).apply(landing.angular)
    # Friction to the right at its foot, ahead of the mass centre, turns it to the right and tips it to the left.
    assert yaw < -0.1
    assert roll < -0.1
    foot = np.array(landing.linear) + np.cross(landing.angular, (0.1, 0.0, -HEIGHT / 2))
    assert 0.0 <= foot[1] < 0.95


@pytest.mark.parametrize("lateral", [0.0, 1.0])
def test_an_impact_beyond_the_validity_of_a_scene_is_flagged(lateral: float) -> None:
    sample = turning(-4.0, 0.5, lateral)
    assert not announced(sample).flags & Flag.SLOW_IMPACT
    slow = SCENE._replace(validity=Validity(gravity_share=1e-3))
    assert announced(sample, slow).flags & Flag.SLOW_IMPACT


def test_no_landing_gains_energy() -> None:
    """In space, of boxes that slip and yaw on an edge, and of boxes that land on it in flight."""
    rng = np.random.default_rng(0)
    inertia = np.array(INERTIA)
    count = 0
    for _ in range(200):
        omega, slip, lateral, yaw = (rng.normal(size=4) * (4.0, 1.0, 1.0, 1.0)).tolist()
        sample = turning(-abs(omega), slip, lateral, yaw)
        touchdown = Predictor(SCENE._replace(restitution=float(rng.uniform()))).update(sample).touchdown
        if touchdown is None:
            continue
        count += 1
        before, after = (
            SCENE.mass * np.dot(linear, linear) + inertia @ np.square(angular)
            for linear, angular in ((sample.linear, sample.angular), (touchdown.linear, touchdown.angular))
        )
        assert after <= before + 1e-4
        assert touchdown.energy_lost == pytest.approx(0.5 * (before - after), abs=2e-3 * before)
    assert count > 150
