"""A machine with joints: its feet from the messages of its joints, and what is wrong with those."""

from math import inf, nan

import numpy as np
import pytest

from impact_predictor.mechanics.impact.spatial import ContactPoints
from impact_predictor.prediction.scene import Robot, Scene
from impact_predictor.prediction.types import Joints, Status

pytestmark = pytest.mark.extras

LINK = """<link name="{name}"><inertial><origin xyz="{place}"/><mass value="{mass}"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
URDF = """<robot name="frog">
  {body} {left} {right}
  <joint name="left_hip" type="revolute"><parent link="body"/><child link="left"/><axis xyz="0 1 0"/>{limit}</joint>
  <joint name="right_hip" type="revolute"><parent link="body"/><child link="right"/><axis xyz="0 1 0"/>{limit}</joint>
  <link name="left_foot"/><link name="right_foot"/>
  <joint name="left_end" type="fixed"><parent link="left"/><child link="left_foot"/><origin xyz="0 0.1 -1"/></joint>
  <joint name="right_end" type="fixed"><parent link="right"/><child link="right_foot"/><origin xyz="0 -0.1 -1"/></joint>
</robot>
"""
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
NAMES = ("left_hip", "right_hip")
AXES = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
CONTACTS = ContactPoints((), 0.6, velocities=((0.0, 0.0, 0.0), (-0.1, -0.2, 1.0)))


def struck(machine):
    return machine.struck([0, 1], CONTACTS, AXES, Scene(1.0, AXES, 0.6))


def outcome(machine):
    return [part.tolist() for part in struck(machine).impact[:3]]


@pytest.fixture
def frog(tmp_path):
    return articulated(tmp_path)


def articulated(tmp_path, massless=False):
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    from impact_predictor.prediction.walking.articulated import ArticulatedMachine

    path = tmp_path / "frog.urdf"
    body = LINK.format(name="body", place="0 0 0", mass=10.0)
    left, right = (LINK.format(name=name, place="0 0 -0.5", mass=1.0) for name in ("left", "right"))
    path.write_text(URDF.format(body=body, left='<link name="left"/>' if massless else left, right=right, limit=LIMIT))
    return ArticulatedMachine(Robot(str(path), ("left_foot", "right_foot")))


def test_the_feet_follow_the_joints_in_whatever_order_their_names_come(frog):
    found = frog.geometry_of(Joints(7, NAMES, (0.3, -0.2), (1.0, 2.0)))
    assert found.stamp == 7
    # A leg of 1 m that has turned by q about y, and turns on.
    expected = [(-np.sin(q), y, -np.cos(q)) for q, y in ((0.3, 0.1), (-0.2, -0.1))]
    assert np.array(found.points) == pytest.approx(np.array(expected), abs=1e-15)
    moving = [(-rate * np.cos(q), 0.0, rate * np.sin(q)) for q, rate in ((0.3, 1.0), (-0.2, 2.0))]
    assert np.array(found.velocities) == pytest.approx(np.array(moving), abs=1e-15)
    assert frog.geometry_of(Joints(7, NAMES[::-1], (-0.2, 0.3), (2.0, 1.0))) == found


@pytest.mark.parametrize(
    ("names", "positions", "velocities", "status"),
    [
        (("left_hip",), (0.0,), (), Status.WRONG_JOINTS),
        (("left_hip", "knee"), (0.0, 0.0), (), Status.WRONG_JOINTS),
        (("left_hip", "left_hip"), (0.0, 0.0), (), Status.WRONG_JOINTS),
        (("left_hip", "left_hip", "right_hip"), (0.0, 0.0, 0.0), (), Status.WRONG_JOINTS),
        ((), (), (), Status.WRONG_JOINTS),
        (NAMES, (0.0,), (), Status.WRONG_JOINTS),
        (NAMES, (0.0, 0.0), (1.0,), Status.WRONG_JOINTS),
        (NAMES, (0.0, nan), (), Status.NOT_FINITE),
        (NAMES, (0.0, 0.0), (inf, 0.0), Status.NOT_FINITE),
    ],
)
def test_joints_that_are_not_the_models_are_a_status_and_leave_the_last_ones(
    frog, names, positions, velocities, status
):
    frog.geometry_of(Joints(0, NAMES, (0.3, -0.2), ()))
    before = outcome(frog)
    assert frog.geometry_of(Joints(1, names, positions, velocities)) is status
    assert outcome(frog) == before
    assert frog.geometry_of(Joints(2, NAMES, (0.3, -0.2), ())).stamp == 2


def test_joints_that_the_model_does_not_know_are_left_out_whatever_they_are(frog):
    plain = frog.geometry_of(Joints(7, NAMES, (0.3, -0.2), (1.0, 2.0)))
    assert frog.unknown == ()
    names = ("arm", "left_hip", "gripper", "right_hip", "arm")
    assert frog.geometry_of(Joints(7, names, (nan, 0.3, 4.0, -0.2, 0.0), (0.0, 1.0, inf, 2.0, 0.0))) == plain
    assert frog.unknown == ("arm", "gripper", "arm")


def test_joints_that_are_told_in_degrees_are_doubtful_until_they_are_told_in_rad(frog):
    frog.geometry_of(Joints(7, NAMES, (0.3, -1.1), ()))
    assert frog.doubt == ""  # hardly beyond a limit, as robots are
    frog.geometry_of(Joints(8, NAMES, (1.7, -63.0), ()))
    assert frog.doubt == (
        "joint right_hip is told at -63, but robot.urdf lets it go from -1 to 1: compare the units (rad, m) and the "
        "zeros of the joints"
    )
    frog.geometry_of(Joints(9, NAMES, (0.3, -1.1), ()))
    assert frog.doubt == ""


@pytest.mark.parametrize("velocities", [(), (nan, nan), (1.0, nan)])
def test_velocities_that_a_driver_does_not_measure_are_none(frog, velocities):
    assert frog.geometry_of(Joints(7, NAMES, (0.3, -0.2), velocities)).velocities == ()


def test_efforts_tell_the_force_that_presses_a_foot_beside_the_weight_of_its_leg(frog):
    frog.geometry_of(Joints(7, NAMES[::-1], (-0.2, 0.3), ()))
    # Each leg is 1 kg half a metre below its hip, and pushes 1 m from it across itself with 40 N, or not at all.
    for way, lean in (((0.0, 0.0, -9.81), 0.0), ((-9.81 * np.sin(0.4), 0.0, -9.81 * np.cos(0.4)), 0.4)):
        held = [0.5 * 9.81 * np.sin(q - lean) for q in (0.3, -0.2)]
        found = frog.forces_of(Joints(7, NAMES[::-1], (-0.2, 0.3), (), (held[1], held[0] - 40.0)), way)
        assert np.array(found[0]) == pytest.approx(40.0 * np.array([-np.cos(0.3), 0.0, np.sin(0.3)]), abs=1e-12)
        assert np.array(found[1]) == pytest.approx(np.zeros(3), abs=1e-12)


@pytest.mark.parametrize("efforts", [(), (1.0,), (1.0, nan)])
def test_efforts_that_are_missing_tell_no_force(frog, efforts):
    joints = Joints(7, NAMES, (0.3, -0.2), (), efforts)
    frog.geometry_of(joints)
    assert frog.forces_of(joints, (0.0, 0.0, -9.81)) is None


def test_a_first_message_without_joints_is_refused_as_a_later_one(frog):
    assert frog.geometry_of(Joints(7, (), (), ())) is Status.WRONG_JOINTS
    assert struck(frog) is Status.NO_GEOMETRY


def test_before_any_joints_there_is_no_response_but_a_status(frog):
    assert struck(frog) is Status.NO_GEOMETRY


def test_a_leg_without_mass_is_a_status_and_never_a_number(tmp_path):
    frog = articulated(tmp_path, massless=True)
    assert frog.geometry_of(Joints(0, NAMES, (0.3, -0.2), ())) is Status.SINGULAR_INERTIA
    assert struck(frog) is Status.SINGULAR_INERTIA
