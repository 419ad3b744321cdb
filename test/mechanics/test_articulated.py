"""Whole-body mechanics through Pinocchio, beside its own algorithms and a rigid body written out."""

import sys
from importlib.metadata import PackageNotFoundError, files

import numpy as np
import pytest

from impact_predictor.errors import InputError
from impact_predictor.mechanics.articulated import WholeBody
from impact_predictor.mechanics.contact_space import solve

FEET = ("lf_foot", "rf_foot", "lh_foot", "rh_foot")
WAYS = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)

INERTIAL = '<inertial><mass value="{}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def needs_pinocchio():
    return pytest.importorskip("pinocchio", reason="needs the extra articulated")


def model_of(name):
    """The path of a robot's URDF in the package of examples."""
    try:
        listed = files("example-robot-data") or []
    except PackageNotFoundError:
        pytest.skip("needs the extra robot")
    return next(str(path.locate()) for path in listed if path.name == name)


def hyq():
    """Pinocchio, its model of the quadruped HyQ, and the robot with its feet as contacts."""
    pinocchio, path = needs_pinocchio(), model_of("hyq_no_sensors.urdf")
    return (
        pinocchio,
        pinocchio.buildModelFromUrdf(path, pinocchio.JointModelFreeFlyer()),
        WholeBody(path, FEET, (0.0,) * 4),
    )


def random_posture(source):
    """Joint positions of a quadruped whose knees are bent."""
    return source.uniform(-0.5, 0.5, 12) + np.tile([0.0, 0.6, -1.2, 0.0, -0.6, 1.2], 2)


def one_link(tmp_path, inertial, child="", kind="revolute"):
    path = tmp_path / "robot.urdf"
    path.write_text(
        f'<robot name="r"><link name="base">{inertial}</link><link name="arm">{child}</link>'
        f'<joint name="shoulder" type="{kind}"><parent link="base"/><child link="arm"/>{LIMIT}'
        '<axis xyz="0 1 0"/></joint></robot>'
    )
    return str(path)


@pytest.mark.extras
def test_sticking_feet_change_the_velocities_as_in_pinocchio():
    pinocchio, model, body = hyq()
    source = np.random.default_rng(1)
    for _ in range(50):
        positions, motion = random_posture(source), source.normal(size=model.nv)
        assert body.place(positions)
        sticking = np.concatenate([body.jacobians[k] for k in (0, 3)])
        data = model.createData()
        q = np.concatenate([[0, 0, 0, 0, 0, 0, 1], positions])
        expected = pinocchio.impulseDynamics(model, data, q, motion, sticking, 0.0, 0.0)

        across = (0.0, 1.0, 0.0)
        W, moved = body.mobility([0, 3], np.array([*WAYS, across]))
        rows = np.concatenate([np.array([*WAYS, across]) @ body.jacobians[k] for k in (0, 3)])
        after = motion - moved @ np.linalg.solve(W, rows @ motion)
        # Rates of about 10 rad/s, and a condition number of about 1e4.
        assert after == pytest.approx(expected, abs=1e-10)


def of_links(pinocchio, model, positions, motion):
    """Kinetic energy and both momenta about the base's origin, summed link by link from their own velocities."""
    data = model.createData()
    pinocchio.forwardKinematics(model, data, np.concatenate([[0, 0, 0, 0, 0, 0, 1], positions]), motion)
    energy, momentum = 0.0, np.zeros(6)
    for link in range(1, model.njoints):
        inertia, twist = model.inertias[link], data.v[link]
        centre, spin = inertia.lever, twist.angular
        velocity = twist.linear + np.cross(spin, centre)
        turned = inertia.inertia @ spin
        energy += 0.5 * (inertia.mass * velocity @ velocity + spin @ turned)
        axes, origin = data.oMi[link].rotation, data.oMi[link].translation
        push = axes @ velocity * inertia.mass
        momentum += np.concatenate([push, axes @ turned + np.cross(origin + axes @ centre, push)])
    return energy, momentum


@pytest.mark.extras
@pytest.mark.parametrize("law", ["path", "total"])
def test_an_impact_changes_the_momentum_of_the_links_by_its_impulses_and_their_energy_by_what_it_says(law):
    pinocchio, model, body = hyq()
    source = np.random.default_rng(5)
    modes = set()
    for _ in range(100):
        positions, friction = random_posture(source), source.uniform(0.1, 1.0)
        body.place(positions)
        W, moved = body.mobility([0, 1], np.array(WAYS))
        feet = body.jacobians[0], body.jacobians[1]
        rows = np.concatenate([np.array(WAYS) @ jacobian for jacobian in feet])
        motion = source.normal(size=model.nv)
        c = [0.0, 0.0, -source.uniform(0.1, 1.0), source.normal()]
        motion -= moved @ np.linalg.solve(W, rows @ motion - c)
        outcome = solve(W, c, (friction, friction), law=law)
        after = motion + moved @ np.array(outcome.impulses).ravel()

        (energy, momentum), (less, changed) = (of_links(pinocchio, model, positions, one) for one in (motion, after))
        wrench = np.zeros(6)
        places = body.points[0], body.points[1]
        for place, (normal, tangent) in zip(places, outcome.impulses, strict=True):
            push = np.array([tangent, 0.0, normal])
            wrench += np.concatenate([push, np.cross(place, push)])
            assert normal >= 0.0
            assert abs(tangent) <= friction * normal + 1e-10
        # Rounding of energies of about 100 J and momenta of about 100 N s.
        assert changed - momentum == pytest.approx(wrench, abs=1e-11)
        assert outcome.energy_lost == pytest.approx(energy - less, abs=1e-11)
        assert outcome.energy_lost >= 0.0
        for jacobian in feet:
            assert (jacobian @ after)[2] >= -1e-11
        modes.add(outcome.mode)
    assert len(modes) > 2


@pytest.mark.extras
def test_points_and_their_velocities_are_those_of_the_frames():
    _, _, body = hyq()
    source = np.random.default_rng(4)
    positions, rates, step = random_posture(source), source.normal(size=12), 1e-6
    places = []
    for side in (-step, step):
        body.place(positions + side * rates)
        places.append(body.points.copy())
    body.place(positions)
    # The error of a central difference is of the order of its step squared, and of rounding over the step.
    assert body.velocities(rates) == pytest.approx((places[1] - places[0]) / (2.0 * step), abs=1e-8)


@pytest.mark.extras
def test_an_endless_joint_is_placed_by_its_angle():
    needs_pinocchio()
    path = model_of("double_pendulum_continuous.urdf")
    simple = model_of("double_pendulum_simple.urdf")
    endless, plain = (WholeBody(name, ("link2",)) for name in (path, simple))
    for angles in ([0.3, -2.0], [7.0, 1.0]):
        endless.place(np.array(angles))
        turned = endless.points.copy(), endless.inertia.copy()
        endless.place(np.array(angles) + 2.0 * np.pi)
        assert endless.points == pytest.approx(turned[0], abs=1e-12)
        assert endless.inertia == pytest.approx(turned[1], abs=1e-12)
    assert plain.joints == endless.joints


@pytest.mark.extras
def test_a_link_that_moves_without_mass_leaves_the_inertia_without_an_inverse(tmp_path):
    needs_pinocchio()
    whole = INERTIAL.format(1.0)
    assert WholeBody(one_link(tmp_path, whole, whole), ("arm",)).place(np.zeros(1))
    assert not WholeBody(one_link(tmp_path, whole, ""), ("arm",)).place(np.zeros(1))
    assert not WholeBody(one_link(tmp_path, "", ""), ("arm",)).place(np.zeros(1))


@pytest.mark.extras
@pytest.mark.parametrize(
    ("urdf", "frames", "sentence"),
    [
        ("missing.urdf", ("arm",), "there is no file 'missing.urdf'"),
        ("no xml", ("arm",), "is not a URDF that Pinocchio can read; check it"),
        ("empty", ("arm",), "is not a URDF that Pinocchio can read; check it"),
        ("floating", ("arm",), "joint shoulder has 6 degrees of freedom"),
        ("revolute", ("arm", "toe"), "has no link or joint 'toe'"),
    ],
)
def test_what_is_no_model_of_a_machine_is_said_in_one_sentence(tmp_path, urdf, frames, sentence):
    needs_pinocchio()
    if urdf in ("no xml", "empty"):
        (tmp_path / "robot.urdf").write_text("a robot" if urdf == "no xml" else "")
        urdf = str(tmp_path / "robot.urdf")
    elif urdf != "missing.urdf":
        urdf = one_link(tmp_path, INERTIAL.format(1.0), INERTIAL.format(1.0), urdf)
    with pytest.raises(InputError, match=sentence) as error:
        WholeBody(urdf, frames)
    assert "\n" not in str(error.value)


@pytest.mark.extras
@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('name="stick"', 'name="a & b"', "is not a URDF that Pinocchio can read"),
        ('radius="0.02"', 'radius="wide"', "the sphere of 'tip' in .* has no radius"),
        ('radius="0.02"', 'radius="-1"', "the sphere of 'tip' in .* has no radius"),
        ('radius="0.02"', 'radius="nan"', "the sphere of 'tip' in .* has no radius"),
        ('xyz="0 0 0.1"', 'xyz="0 0 0.1 2"', "or no centre of three numbers"),
        ('xyz="0 0 0.1"', 'xyz="0 0 high"', "or no centre of three numbers"),
    ],
)
def test_a_ball_that_is_none_is_said_in_one_sentence(tmp_path, old, new, sentence):
    needs_pinocchio()
    path = tmp_path / "robot.urdf"
    text = """<robot name="stick"><link name="base"/><joint name="hip" type="fixed"><parent link="base"/>
        <child link="tip"/></joint><link name="tip"><collision><origin xyz="0 0 0.1"/><geometry>
        <sphere radius="0.02"/></geometry></collision></link></robot>"""
    path.write_text(text)
    assert WholeBody(str(path), ("tip",)).radii == [0.02]
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=sentence) as error:
        WholeBody(str(path), ("tip",))
    assert "\n" not in str(error.value)


@pytest.mark.extras
def test_a_relative_path_begins_where_the_process_runs_and_a_sentence_says_where_that_is(tmp_path, monkeypatch):
    needs_pinocchio()
    one_link(tmp_path, INERTIAL.format(1.0), INERTIAL.format(2.0))
    monkeypatch.chdir(tmp_path)
    assert WholeBody("robot.urdf", ("arm",)).mass == pytest.approx(3.0)
    with pytest.raises(
        InputError, match=f"no file 'other.urdf' in {tmp_path}, where this program runs; give the whole"
    ):
        WholeBody("other.urdf", ("arm",))


def test_a_model_without_pinocchio_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    with pytest.raises(InputError, match="needs Pinocchio, which is not installed"):
        WholeBody("robot.urdf", ())


@pytest.mark.extras
def test_a_ball_touches_with_its_lowest_point_which_rests_as_it_rolls(tmp_path):
    needs_pinocchio()
    ball = '<collision><origin xyz="0 0 -0.3"/><geometry><sphere radius="0.04"/></geometry></collision>'
    path = one_link(tmp_path, INERTIAL.format(2.0), INERTIAL.format(1.0) + ball)
    body = WholeBody(path, ["shoulder"])
    assert body.radii == [0.04]
    down = np.array((0.6, 0.0, -0.8))
    assert body.place(np.array([0.5]), down)
    center = -0.3 * np.array((np.sin(0.5), 0.0, np.cos(0.5)))
    assert body.points[0] == pytest.approx(center + 0.04 * down)
    # With the base at the velocity of a ball that rolls on the plane across `down`, its lowest point is at rest.
    spin = np.array((0.0, 2.0, 0.0))
    base = -np.cross(spin, center + 0.04 * down)
    assert body.jacobians[0] @ np.concatenate([base, np.zeros(3), [2.0]]) == pytest.approx(np.zeros(3), abs=1e-12)
    assert WholeBody(path, ["arm"], [0.0]).radii == [0.0]


@pytest.mark.extras
def test_a_sole_has_a_heel_and_a_toe_that_move_with_its_frame(tmp_path):
    needs_pinocchio()
    path = one_link(tmp_path, INERTIAL.format(2.0), INERTIAL.format(1.0))
    heel, toe, radius = (-0.1, 0.0, -0.3), (0.15, 0.02, -0.3), 0.01
    for radii in ((), (radius, radius)):
        body = WholeBody(path, ["shoulder"], radii, [heel, toe])
        assert body.place(np.array([0.5]))
        turned = np.array([[np.cos(0.5), 0.0, np.sin(0.5)], [0.0, 1.0, 0.0], [-np.sin(0.5), 0.0, np.cos(0.5)]])
        expected = np.array([heel, toe]) @ turned.T - np.array((0.0, 0.0, radius if radii else 0.0))
        assert body.points == pytest.approx(expected, abs=1e-12)
        assert body.velocities(np.array([2.0])) == pytest.approx(np.cross((0.0, 2.0, 0.0), expected), abs=1e-12)
