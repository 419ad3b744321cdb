"""A cylinder that slides along its axis while it strikes an edge, against friction by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from impact_predictor.mechanics.types import ContactState
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene, triple
from impact_predictor.prediction.spatial import PLANAR
from impact_predictor.prediction.types import Sample, Touchdown

MASS, INERTIA, RADIUS, HALF = 500.0, 90.0, 0.6, 0.3
HEIGHT = np.sqrt(RADIUS**2 - HALF**2)
ZEROS = (0.0,) * 36
SOMEWHERE = Rotation.from_rotvec([0.3, -0.5, 0.9])
"""Of the support: the cylinder lies along its x, on edges at y = -HALF and HALF."""
MOUNT = Rotation.from_rotvec([0.0, 0.7, 0.4])
"""From the axes of the cylinder's inertia to its frame."""


def told(center: Any, velocity: Any, spin: Any, **changes: Any) -> Touchdown:
    """What is announced of a cylinder with its mass centre somewhere over the edges, in the support's axes."""
    inertia = MOUNT.as_matrix() @ np.diag([INERTIA, 3 * INERTIA, 3 * INERTIA]) @ MOUNT.as_matrix().T
    scene = Scene(
        mass=MASS,
        inertia=(triple(inertia[0]), triple(inertia[1]), triple(inertia[2])),
        friction=0.2,
        radius=RADIUS,
        normal=triple(SOMEWHERE.apply([0.0, 0.0, 1.0])),
        edges=(triple(SOMEWHERE.apply([0.0, -HALF, 0.0])), triple(SOMEWHERE.apply([0.0, HALF, 0.0]))),
        gravity=triple(SOMEWHERE.apply([0.0, 0.0, -9.81])),
        center_of_mass=(0.1, -0.2, 0.3),
    )._replace(**changes)
    pose = SOMEWHERE * MOUNT.inv()
    turning = MOUNT.apply(spin)
    linear = MOUNT.apply(velocity) - np.cross(turning, scene.center_of_mass)
    x, y, z, w = (float(part) for part in pose.as_quat())
    place = SOMEWHERE.apply(center) - pose.apply(scene.center_of_mass)
    sample = Sample(0, "", "", triple(place), (x, y, z, w), triple(linear), triple(turning), ZEROS, ZEROS)
    touchdown = Predictor(scene).update(sample).touchdown
    assert touchdown is not None
    return touchdown


def rocking(along: float, turning: float = 1.0, **changes: Any) -> Touchdown:
    """It turns about the edge at -HALF, a little before it reaches the other one, and slides along both."""
    up = Rotation.from_rotvec([1e-3, 0.0, 0.0])
    arm, spin = up.apply([0.0, HALF, HEIGHT]), np.array([-turning, 0.0, 0.0])
    return told(np.array([0.0, -HALF, 0.0]) + arm, np.cross(spin, arm) + np.array([along, 0.0, 0.0]), spin, **changes)


def falling(along: float, spin: float, **changes: Any) -> Touchdown:
    """It falls on the edge at -HALF, its axis above that and a little beside."""
    direction = np.array([0.0, 0.2, np.sqrt(0.96)])
    velocity = [along, 0.1, -1.0]
    return told(np.array([0.0, -HALF, 0.0]) + (RADIUS + 1e-4) * direction, velocity, [spin, 0.0, 0.0], **changes)


def twist_of(touchdown: Touchdown, after: bool = True) -> np.ndarray[Any, Any]:
    """Along the support's axes."""
    twist = touchdown.after_6d if after else touchdown.before_6d
    return np.concatenate([SOMEWHERE.inv().apply(twist.linear), SOMEWHERE.inv().apply(twist.angular)])


@pytest.mark.parametrize("restitution", [0.0, 0.3])
@pytest.mark.parametrize("friction", [0.1, 0.6])
def test_both_laws_agree_where_one_takes_over_from_the_other(friction: float, restitution: float) -> None:
    speed = 2.0 * HALF * HEIGHT / RADIUS  # along the normal of the new edge
    close = (0.01 if restitution else 4.0 * PLANAR) * speed  # what bounces has the error of the law's steps
    plane = rocking(0.99 * PLANAR * speed, friction=friction, restitution=restitution)
    space = rocking(1.02 * PLANAR * speed, friction=friction, restitution=restitution)
    assert (len(plane.contacts), len(space.contacts)) == (0, 2)
    assert space.mode is plane.mode
    assert space.before == pytest.approx(plane.before, abs=1e-12)
    assert twist_of(space) == pytest.approx(twist_of(plane), abs=close)
    assert np.array(space.impulses) == pytest.approx(np.array(plane.impulses), abs=close * MASS)
    assert space.energy_lost == pytest.approx(plane.energy_lost, rel=0.02)


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_enough_friction_ends_the_slide_and_leaves_the_plane_as_it_is(restitution: float) -> None:
    still, slides = (rocking(along, friction=20.0, restitution=restitution) for along in (0.0, 0.8))
    assert twist_of(slides, after=False)[0] == pytest.approx(0.8)
    assert twist_of(slides) == pytest.approx(twist_of(still), abs=0.01)
    assert slides.mode is still.mode
    lost = slides.energy_lost - still.energy_lost
    assert lost == pytest.approx(0.5 * MASS * 0.8**2, rel=0.02)


def by_hand(touchdown: Touchdown, friction: float, restitution: float) -> np.ndarray[Any, Any]:
    """Slip across and along after one contact, whose normal runs through the mass centre and so changes no slip.

    d slip / dN = -f W slip / |slip|, with W = diag(1/m + R^2/I, 1/m), up to N = (1 + e) m |c_n|.
    """
    vx, vy, vz, wx, _, _ = twist_of(touchdown, after=False)
    arm = edge_arm(touchdown)
    normal = -arm / RADIUS
    tangent = np.array([0.0, normal[2], -normal[1]])
    velocity = np.array([vx, vy, vz]) + np.cross([wx, 0.0, 0.0], arm)
    push = -(1.0 + restitution) * MASS * float(normal @ velocity)
    mobility = np.array([1.0 / MASS + RADIUS**2 / INERTIA, 1.0 / MASS])

    def slows(_: float, slip: Any) -> Any:
        size = np.hypot(*slip)
        return -friction * mobility * slip / max(size, 1e-12)

    def sticks(_: float, slip: Any) -> Any:
        return np.hypot(*slip) - 1e-6

    sticks.terminal = True  # type: ignore[attr-defined]
    start = [float(tangent @ velocity), float(velocity[0])]
    done = solve_ivp(slows, (0.0, push), start, events=sticks, rtol=1e-10, atol=1e-12)
    return np.zeros(2) if done.t_events[0].size else np.array(done.y[:, -1])


def edge_arm(touchdown: Touchdown) -> np.ndarray[Any, Any]:
    """From the mass centre at the touchdown to the edge that it strikes, across the axis."""
    pose = Rotation.from_quat(touchdown.orientation)
    center = SOMEWHERE.inv().apply(np.array(touchdown.position) + pose.apply([0.1, -0.2, 0.3]))
    arm = np.array([0.0, -HALF, 0.0]) - center
    return np.array([0.0, arm[1], arm[2]])


@pytest.mark.parametrize(("along", "spin"), [(0.5, 0.0), (-0.5, 0.4), (2.0, 1.5), (0.05, -1.0), (0.3, -0.1667)])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_one_contact_slows_the_whole_slip_as_coulomb_says(along: float, spin: float, restitution: float) -> None:
    touchdown = falling(along, spin, friction=0.2, restitution=restitution)
    (contact,) = touchdown.contacts
    arm = edge_arm(touchdown)
    tangent = np.array([0.0, -arm[2], arm[1]]) / RADIUS
    velocity = SOMEWHERE.inv().apply(contact.velocity)
    slip = np.array([tangent @ velocity, velocity[0]])
    expected = by_hand(touchdown, 0.2, restitution)
    assert slip == pytest.approx(expected, abs=2e-3)
    # Its twist is that of its contact, and it turns about nothing but its axis.
    after = twist_of(touchdown)
    assert after[:3] + np.cross(after[3:], arm) == pytest.approx(velocity, abs=1e-9)
    assert after[4:] == pytest.approx(np.zeros(2), abs=1e-8)
    assert (contact.state is ContactState.STICKS) is (restitution == 0.0 and not expected.any())


def test_what_is_told_in_the_bodys_frame_is_the_whole_twist() -> None:
    touchdown = rocking(0.7)
    pose = Rotation.from_quat(touchdown.orientation)
    linear = pose.apply(np.array(touchdown.linear) + np.cross(touchdown.angular, [0.1, -0.2, 0.3]))
    assert linear == pytest.approx(np.array(touchdown.after_6d.linear), abs=1e-12)
    assert pose.apply(touchdown.angular) == pytest.approx(np.array(touchdown.after_6d.angular), abs=1e-12)
    before, after = twist_of(touchdown, after=False), twist_of(touchdown)
    impulse = SOMEWHERE.inv().apply(np.sum([contact.impulse for contact in touchdown.contacts], axis=0))
    assert MASS * (after[:3] - before[:3]) == pytest.approx(impulse, abs=1e-8)
    assert 0.0 < after[0] < before[0]


def test_a_slide_the_other_way_is_the_mirror_image() -> None:
    one, other = twist_of(rocking(0.4)), twist_of(rocking(-0.4))
    assert other == pytest.approx(one * [-1, 1, 1, 1, -1, -1], abs=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.6])
def test_a_cylinder_that_slides_across_its_axis_only_is_struck_in_its_plane(friction: float) -> None:
    assert rocking(0.0, friction=friction).contacts == ()
    smooth = rocking(0.5, friction=0.0)
    assert smooth.contacts == ()
    assert twist_of(smooth)[0] == pytest.approx(0.5)


def test_turning_across_the_axis_slips_too() -> None:
    arm = np.array([0.0, HALF, HEIGHT])
    touchdown = told(np.array([0.0, -HALF, 0.0]) + 1.0005 * arm, np.cross([-1.0, 0.0, 0.0], arm), [-1.0, 0.0, 0.3])
    assert len(touchdown.contacts) > 0


@pytest.mark.parametrize(("side", "contacts"), [(1.0, 0), (-1.0, 2)])
def test_what_rolls_as_fast_as_it_drifts_slips_at_its_edges_or_not_by_the_side_to_which_it_rolls(
    side: float, contacts: int
) -> None:
    arm, drift = np.array([0.0, HALF, HEIGHT]), 0.3
    velocity = np.cross([-1.0, 0.0, 0.0], arm) + np.array([drift, 0.0, 0.0])
    touchdown = told(np.array([0.0, -HALF, 0.0]) + 1.0005 * arm, velocity, [-1.0, side * drift / HEIGHT, 0.0])
    assert len(touchdown.contacts) == contacts
