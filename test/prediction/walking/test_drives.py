"""What armature and drives make of an impact: beside matrices written out, and the motion of a drive step by step."""

import numpy as np
import pytest

from impact_predictor.errors import InputError
from impact_predictor.mechanics.impact.spatial import ContactPoints
from impact_predictor.mechanics.types import ContactState
from impact_predictor.prediction.scene import Robot, Scene
from impact_predictor.prediction.types import Bound, Joints

pytestmark = pytest.mark.extras

LINK = """<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>
    <inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{place}"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>"""
LEGS = ("front", "hind")
JOINTS = tuple(f"{leg}_{name}" for leg in LEGS for name in ("hip", "knee"))
BENT = (0.7, -1.4, 0.6, -1.3)
FEET = tuple(f"{leg}_foot" for leg in LEGS)
AXES = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
MASS = 12.0


@pytest.fixture(scope="module")
def urdf(tmp_path_factory):
    """A trunk on two legs of two joints each, one behind the other."""
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    parts = [LINK.format(name="trunk", z=0.0, mass=10.0, i=2.0)]
    for leg, x in zip(LEGS, (0.3, -0.3), strict=True):
        for name, length in (("hip", 0.2), ("knee", 0.2)):
            parent = "trunk" if name == "hip" else f"{leg}_hip_link"
            place = f"{x} 0 0" if name == "hip" else "0 0 -0.2"
            child = f"{leg}_{name}_link"
            parts.append(LINK.format(name=child, z=-0.5 * length, mass=0.5, i=0.002))
            told = {"name": f"{leg}_{name}", "parent": parent, "child": child, "place": place}
            parts.append(JOINT.format(kind="revolute", **told))
        told = {"name": f"{leg}_end", "parent": f"{leg}_knee_link", "child": f"{leg}_foot", "place": "0 0 -0.2"}
        parts += [f'<link name="{leg}_foot"/>', JOINT.format(kind="fixed", **told)]
    path = tmp_path_factory.mktemp("legs") / "legs.urdf"
    path.write_text(f'<robot name="legs">{"".join(parts)}</robot>')
    return str(path)


def machine(urdf, **told):
    from impact_predictor.prediction.walking.articulated import ArticulatedMachine

    made = ArticulatedMachine(Robot(urdf, FEET, **told))
    made.geometry_of(Joints(0, JOINTS, BENT, ()))
    return made


def scene_of(**told):
    return Scene(**{"mass": MASS, "inertia": AXES, "friction": 0.0, **told})


def struck(made, scene=None, points=(0,), speed=0.5, pulls=()):
    """The impact of the front foot, which comes down; the hind one, where it is among the points, stands."""
    scene = scene or scene_of()
    support = [(0.0, 0.0, speed if i == 0 else 0.0) for i in points]
    return made.struck(list(points), ContactPoints((), scene.friction, velocities=support), AXES, scene, pulls)


def effective_mass(made, added=0.0):
    inertia = made.body.inertia.copy()
    inertia[range(6, 10), range(6, 10)] += added
    row = made.body.jacobians[0][2]
    return 1.0 / (row @ np.linalg.solve(inertia, row))


def test_armature_is_inertia_of_its_joint_whatever_the_order_in_which_it_is_told(urdf):
    bare, armature = machine(urdf), np.array([0.01, 0.02, 0.03, 0.04])
    one = machine(urdf, joints=JOINTS, armature=tuple(armature))
    other = machine(urdf, joints=JOINTS[::-1], armature=tuple(armature[::-1]))
    expected = bare.body.inertia + np.diag([0.0] * 6 + armature.tolist())
    for made in (one, other):
        assert made.body.inertia == pytest.approx(expected, abs=1e-15)
        found = struck(made)
        assert found.impact.impulses[0] == pytest.approx((0.0, 0.0, 0.5 * effective_mass(made)), rel=1e-6)
        assert found.bound is Bound.ESTIMATE


def test_what_an_impact_changes_keeps_the_momentum_of_trunk_and_joints(urdf):
    made = machine(urdf, armature=(0.02,), drives="pd", kd=(2.0,))
    scene = scene_of(friction=0.8, merge=0.005)
    found = struck(made, scene, (0, 1))
    inertia = made.body.inertia + np.diag([0.0] * 6 + [0.5 * 0.005 * 2.0] * 4)
    change = np.concatenate([found.impact.twist, found.jumps])
    pushed = made.body.jacobians.reshape(6, -1).T @ found.impact.impulses.ravel()
    assert inertia @ change == pytest.approx(pushed, abs=1e-12)


@pytest.mark.parametrize(("whole", "squeezed"), [(0.005, 0.005), (0.005, 0.0015), (0.01, 0.0)])
def test_the_inertia_of_gains_is_the_impulse_of_a_drive_followed_step_by_step(urdf, whole, squeezed):
    kp, kd, steps = 200.0, 3.0, 100_000
    made = machine(urdf, armature=(0.01,), drives="pd", kp=(kp,), kd=(kd,))
    found = struck(made, scene_of(contact_time=whole, merge=squeezed))
    # A joint whose velocity changes evenly to 1 in the compression, and stays so; its drive opposes it.
    times = (np.arange(steps) + 0.5) * whole / steps
    velocity = np.minimum(times / squeezed, 1.0) if squeezed else np.ones(steps)
    position = (np.cumsum(velocity) - 0.5 * velocity) * whole / steps
    opposed = float(np.mean(kd * velocity + kp * position)) * whole
    assert found.impact.impulses[0][2] == pytest.approx(0.5 * effective_mass(made, opposed), rel=1e-5)
    # What the drives oppose of the work: all but what turns links and rotors.
    work = found.impact.impulses[0][2] * 0.5
    assert found.drives == pytest.approx(opposed * float(np.square(found.jumps).sum()) / work, rel=1e-5)


def test_a_soft_contact_is_compressed_for_a_quarter_of_its_oscillation(urdf):
    made, stiffness = machine(urdf, drives="pd", kp=(200.0,), kd=(3.0,)), 5e4
    told = struck(made, scene_of(stiffness=stiffness))
    time = 0.5 * np.pi * np.sqrt(told.impact.impulses[0][2] / 0.5 / stiffness)
    assert time > 0.005  # longer than the contact time, so that the drives work as long
    same = struck(made, scene_of(contact_time=time, merge=time))
    assert told.impact.impulses[0][2] == pytest.approx(same.impact.impulses[0][2], rel=0.01)


def test_an_estimate_stops_what_the_foot_gains_while_the_contact_lasts_too(urdf):
    falls = [(0.0, 0.0, -9.81)] * 2
    made, bare, scene = machine(urdf, armature=(0.01,)), machine(urdf), scene_of(contact_time=0.01)
    gained = struck(made, scene, pulls=falls[:1])
    assert gained.impact.impulses[0][2] == pytest.approx((0.5 + 0.0981) * effective_mass(made), rel=1e-6)
    # A foot that stands carries the weight all the while, and bounds tell of the blow alone.
    assert struck(made, scene, (0, 1), pulls=falls).impact.velocities[1][2] == pytest.approx(0.0, abs=1e-9)
    blow, pulled = struck(bare, scene).impact, struck(bare, scene, pulls=falls[:1]).impact
    assert pulled.impulses[0] == pytest.approx(blow.impulses[0], rel=1e-12)


@pytest.mark.parametrize(("slip", "state"), [(0.04, ContactState.STICKS), (0.06, ContactState.SLIPS)])
def test_an_estimate_tells_no_slip_that_is_slower_than_gravity_in_a_contact_time(urdf, slip, state):
    made, scene = machine(urdf, armature=(0.01,)), scene_of(contact_time=0.005)

    def after(ahead):
        contacts = ContactPoints((), 0.0, velocities=[(-ahead, 0.0, 0.5)])
        return made.struck([0], contacts, AXES, scene)

    # Without friction the slip after the impact is that before it and what the blow adds.
    found = after(slip - after(0.0).impact.velocities[0][0])
    assert found.impact.velocities[0] == pytest.approx((slip, 0.0, 0.0), abs=1e-12)
    assert found.impact.states == (state,)


def test_what_is_known_of_the_joints_is_between_the_bounds(urdf):
    kinds = [{}, {"armature": (0.01,)}, {"armature": (0.01,), "drives": "pd", "kd": (2.0,)}, {"drives": "held"}]
    found = [struck(machine(urdf, **kind)) for kind in kinds]
    impulses = [one.impact.impulses[0][2] for one in found]
    assert impulses == sorted(impulses)
    assert impulses[0] < 0.5 * impulses[-1]
    assert [one.bound for one in found] == [Bound.LOWER, Bound.ESTIMATE, Bound.ESTIMATE, Bound.UPPER]
    assert found[-1].jumps == (0.0,) * 4


def test_held_joints_make_one_rigid_body(urdf):
    made = machine(urdf, drives="held")
    inertia, row = made.body.inertia[:6, :6], made.body.jacobians[0][2, :6]
    found = struck(made)
    assert found.impact.impulses[0][2] == pytest.approx(0.5 / (row @ np.linalg.solve(inertia, row)), rel=1e-6)


def test_a_foot_that_carries_the_weight_is_lifted_by_a_hard_blow_alone(urdf):
    made, scene = machine(urdf, armature=(0.02,)), scene_of(friction=0.8)
    states = [struck(made, scene, (0, 1), speed).impact.states[1] for speed in (0.2, 20.0)]
    assert states == [ContactState.STICKS, ContactState.LEAVES]
    # What is told of it is the change of its load, and no blow is no change.
    weight = MASS * 9.81 * scene.contact_time
    assert -weight <= struck(made, scene, (0, 1), 20.0).impact.impulses[1][2] < 0.0
    rest = struck(made, scene, (0, 1), 0.0)
    assert not rest.impact.impulses.any()
    assert not rest.impact.twist.any()


def test_joints_that_the_model_does_not_have_are_refused_in_one_sentence(urdf):
    with pytest.raises(InputError, match=r"^robot.joints are front_hip, tail, but .* has the joints front_hip, "):
        machine(urdf, joints=("front_hip", "tail"), armature=(0.1, 0.2))
