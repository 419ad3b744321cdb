"""The compass gait, two legs with a hinge at the hip, against its closed form.

Source: A. Goswami, B. Thuilot, B. Espiau, A study of the passive gait of a compass-like biped robot: symmetry and
chaos (1998), section 2.3: a foot that strikes sticks while the other lifts, so that the impact keeps the angular
momentum of the machine about the striking foot and that of the trailing leg about the hip.
"""

import math
from typing import NamedTuple

import numpy as np
import pytest

from impact_predictor import Mode
from impact_predictor.mechanics.articulated import WholeBody
from impact_predictor.mechanics.contact_space import solve

LAWS = ("path", "total")


class Compass(NamedTuple):
    """A hip and two equal legs: `leg` and `hip` masses in kg, `low` the distance of a leg's mass centre from its foot
    and `high` from the hip in m, `inertia` of a leg about its mass centre in kg m^2."""

    leg: float
    hip: float
    low: float
    high: float
    inertia: float = 0.0

    @property
    def length(self) -> float:
        return self.low + self.high


def point_mass_map(compass, half_angle):
    """Q+^-1 Q- of the paper, whose legs are point masses: rates (swing, stance) before to those after the impact.

    `half_angle` is half the angle between the legs. After the impact the legs have changed their roles.
    """
    beta, mu = compass.high / compass.low, compass.hip / compass.leg
    cos = math.cos(2.0 * half_angle)
    before = [[-beta, -beta + (mu * (1 + beta) ** 2 + 2 * (1 + beta)) * cos], [0.0, -beta]]
    after = [
        [beta * (beta - (1 + beta) * cos), (1 + beta) * (1 + beta - beta * cos) + 1 + mu * (1 + beta) ** 2],
        [beta**2, -beta * (1 + beta) * cos],
    ]
    return np.linalg.solve(after, before)


def momentum_map(compass, half_angle):
    """The same for legs with inertia, from the two angular momenta: rates (old leg, new leg) before to those after.

    The new leg leads: it leans back by `half_angle`, the old one forward.
    """
    new_foot = np.array([compass.length * math.sin(half_angle), 0.0])
    old_foot = -new_foot
    hip = np.array([0.0, compass.length * math.cos(half_angle)])
    rows = []
    for stance in (old_foot, new_foot):
        momenta = np.zeros((2, 2))
        for leg in range(2):
            rates = np.eye(2)[leg]
            # Angles grow counter-clockwise: the velocity by a rate w over an arm (x, y) is w (-y, x).
            stance_rate = rates[0] if stance is old_foot else rates[1]
            at_hip = turning(stance_rate, hip - stance)
            about_new = compass.hip * moment(hip - new_foot, at_hip)
            about_hip = 0.0
            for k, foot in enumerate((old_foot, new_foot)):
                centre = hip + (foot - hip) * compass.high / compass.length
                velocity = at_hip + turning(rates[k], centre - hip)
                spin = compass.inertia * rates[k]
                about_new += compass.leg * moment(centre - new_foot, velocity) + spin
                if k == 0:
                    about_hip = compass.leg * moment(centre - hip, velocity) + spin
            momenta[:, leg] = about_new, about_hip
        rows.append(momenta)
    before, after = rows
    return np.linalg.solve(after, before)


def turning(rate, arm):
    return rate * np.array([-arm[1], arm[0]])


def moment(arm, velocity):
    return arm[0] * velocity[1] - arm[1] * velocity[0]


def by_hand(compass, half_angle):
    """Mass matrix and contact rows (n_old, t_old, n_new, t_new) in the velocities of the hip (x, y) and both rates.

    The floor is level: n = (0, 1), t = (1, 0). A point of a leg at the arm (x, y) from the hip moves with the hip and
    by its leg's rate (-y, x).
    """
    arms = [
        np.array([side * compass.length * math.sin(half_angle), -compass.length * math.cos(half_angle)])
        for side in (-1.0, 1.0)
    ]
    total = compass.hip + 2.0 * compass.leg
    mass = np.diag([total, total, 0.0, 0.0])
    rows = []
    for k, arm in enumerate(arms):
        x, y = arm * compass.high / compass.length
        mass[0, 2 + k] = mass[2 + k, 0] = -compass.leg * y
        mass[1, 2 + k] = mass[2 + k, 1] = compass.leg * x
        mass[2 + k, 2 + k] = compass.leg * (x * x + y * y) + compass.inertia
        normal, tangent = np.zeros(4), np.zeros(4)
        normal[1], normal[2 + k] = 1.0, arm[0]
        tangent[0], tangent[2 + k] = 1.0, -arm[1]
        rows += [normal, tangent]
    return mass, np.array(rows)


def motion_before(compass, half_angle, old_rate, new_rate):
    """Velocities of the hip (x, y) and the rates of a compass whose old foot stands."""
    x, y = compass.length * math.sin(half_angle), compass.length * math.cos(half_angle)
    return np.array([-old_rate * y, old_rate * x, old_rate, new_rate])


def random_compasses(count, seed):
    source = np.random.default_rng(seed)
    for _ in range(count):
        compass = Compass(*source.uniform((0.5, 1.0, 0.2, 0.2, 0.0), (10.0, 40.0, 0.8, 0.8, 0.2)).tolist())
        # A passive gait: both legs turn forward (clockwise), the swing leg slower or faster.
        rates = -source.uniform(0.5, 2.0), -source.uniform(-0.5, 2.0)
        yield compass, source.uniform(0.1, 0.4), rates


def test_the_momenta_of_the_closed_form_are_those_of_goswami():
    for compass, half_angle, _ in random_compasses(50, seed=1):
        points = compass._replace(inertia=0.0)
        swap = np.array([[0.0, 1.0], [1.0, 0.0]])  # (old, new) is (stance, swing) before and (swing, stance) after
        assert momentum_map(points, half_angle) == pytest.approx(point_mass_map(points, half_angle) @ swap, abs=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_a_compass_gait_by_hand_in_contact_space_follows_the_closed_form(law):
    pivots = 0
    for compass, half_angle, rates in random_compasses(300, seed=2):
        mass, rows = by_hand(compass, half_angle)
        motion = motion_before(compass, half_angle, *rates)
        c = rows @ motion
        if c[2] > -0.05:
            continue  # the swing leg does not strike
        W = rows @ np.linalg.solve(mass, rows.T)
        outcome = solve(W, [0.0, 0.0, *c[2:]], (5.0, 5.0), law=law)
        if outcome.mode is not Mode.PIVOT or outcome.impulses[0][0] != 0.0:
            continue
        after = motion + np.linalg.solve(mass, rows.T @ np.array(outcome.impulses).ravel())
        expected = momentum_map(compass, half_angle) @ rates
        assert after[2:] == pytest.approx(expected, abs=1e-10)  # the accuracy that is promised
        pivots += 1
    assert pivots > 100


URDF = """<robot name="compass">
  <link name="hip">{hip}</link>
  <link name="old_leg">{leg}</link>
  <link name="new_leg">{leg}</link>
  <link name="old_foot"/>
  <link name="new_foot"/>
  <joint name="old_hip" type="continuous">
    <parent link="hip"/><child link="old_leg"/><axis xyz="0 -1 0"/>
  </joint>
  <joint name="new_hip" type="continuous">
    <parent link="hip"/><child link="new_leg"/><axis xyz="0 -1 0"/>
  </joint>
  <joint name="old_ankle" type="fixed">
    <parent link="old_leg"/><child link="old_foot"/><origin xyz="0 0 {foot}"/>
  </joint>
  <joint name="new_ankle" type="fixed">
    <parent link="new_leg"/><child link="new_foot"/><origin xyz="0 0 {foot}"/>
  </joint>
</robot>
"""

INERTIAL = """<inertial><origin xyz="0 0 {place}"/><mass value="{mass}"/>
  <inertia ixx="{across}" iyy="{inertia}" izz="{across}" ixy="0" ixz="0" iyz="0"/></inertial>"""


def urdf_of(compass):
    """The compass as a machine in space. What turns its legs off their plane, and the hip at all, is any inertia."""
    hip = INERTIAL.format(place=0.0, mass=compass.hip, across=0.3, inertia=0.2)
    leg = INERTIAL.format(place=-compass.high, mass=compass.leg, across=0.3, inertia=compass.inertia)
    return URDF.format(hip=hip, leg=leg, foot=-compass.length)


@pytest.mark.extras
def test_a_compass_gait_from_its_urdf_follows_the_closed_form(tmp_path):
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    path = tmp_path / "compass.urdf"
    pivots = 0
    for compass, half_angle, rates in random_compasses(60, seed=3):
        path.write_text(urdf_of(compass))
        body = WholeBody(str(path), ("old_foot", "new_foot"))
        assert body.joints == ("new_hip", "old_hip")
        # About -y angles grow counter-clockwise in the plane of x and z.
        assert body.place(np.array([half_angle, -half_angle]))
        W, moved = body.mobility([[0], [1]], [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0)])
        mass, rows = by_hand(compass, half_angle)
        assert pytest.approx(rows @ np.linalg.solve(mass, rows.T), abs=1e-12) == W
        motion = motion_before(compass, half_angle, *rates)
        c = rows @ motion
        if c[2] > -0.05:
            continue
        outcome = solve(W, [0.0, 0.0, *c[2:]], (5.0, 5.0))
        if outcome.mode is not Mode.PIVOT or outcome.impulses[0][0] != 0.0:
            continue
        change = moved @ np.array(outcome.impulses).ravel()
        # A leg turns with the hip, about -y too, and in its joint.
        turned = np.array([change[7], change[6]]) - change[4]
        assert rates + turned == pytest.approx(momentum_map(compass, half_angle) @ rates, abs=1e-10)
        pivots += 1
    assert pivots > 20
