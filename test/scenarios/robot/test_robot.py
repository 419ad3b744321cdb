"""Robots in MuJoCo: the forces carry them, the truth is that of the forces, and the sensors tell what was."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.vectors import add, axes_of, to_world
from impact_predictor.ros.messages import INPUT_TYPES
from impact_predictor.scenarios.record import write_messages
from impact_predictor.scenarios.robot.description import RobotFiles, Sole
from impact_predictor.scenarios.robot.gait import PlannedGait
from impact_predictor.scenarios.robot.ground import SimulatedGround, blocks, stairs
from impact_predictor.scenarios.robot.machine import STEP, Machine, Physics
from impact_predictor.scenarios.robot.scene import scene_of
from impact_predictor.scenarios.robot.sensors import WalkSensors, walk_messages
from impact_predictor.scenarios.robot.walk import STANDS, SWING, Walk, landings_of, walk
from impact_predictor.scenarios.truth import LANDING_TOPIC, TrueLanding, decode_truths

pytest.importorskip("mujoco", reason="needs the extra robot (make test-extras)")

pytestmark = pytest.mark.extras

FEET = ("LF", "RF", "LH", "RH")
RADIUS = 0.02


def urdf(feet: tuple[str, ...] = FEET) -> str:
    """A trunk of 8 kg on legs of three joints, two links of 0.2 m and a ball each."""

    def link(name: str, mass: float, size: float, ball: float = 0.0) -> str:
        inertia = 0.4 * mass * size * size
        shape = f'<collision><geometry><sphere radius="{ball}"/></geometry></collision>' if ball else ""
        return (
            f'<link name="{name}"><inertial><mass value="{mass}"/><inertia ixx="{inertia}" iyy="{inertia}" '
            f'izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial>{shape}</link>'
        )

    def joint(kind: str, parent: str, child: str, place: str, axis: str = "0 1 0", limits: str = "-2 2") -> str:
        lower, upper = limits.split()
        return (
            f'<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{place}"/><axis xyz="{axis}"/><limit lower="{lower}" upper="{upper}"/></joint>'
        )

    parts = [link("base", 8.0, 0.2)]
    for foot in feet:
        x = (0.0 if len(feet) == 2 else 0.2) * (1.0 if foot[1] == "F" else -1.0)
        y = 0.1 if foot[0] == "L" else -0.1
        for mass, size, name, ball in ((0.3, 0.04, "hip", 0.0), (0.5, 0.07, "thigh", 0.0), (0.2, 0.07, "shank", 0.0)):
            parts.append(link(f"{foot}_{name}", mass, size, ball))
        parts += [
            link(foot, 0.05, RADIUS, RADIUS),
            joint("revolute", "base", f"{foot}_hip", f"{x} {y} 0", "1 0 0"),
            joint("revolute", f"{foot}_hip", f"{foot}_thigh", "0 0 0", limits="-1 2"),
            joint("revolute", f"{foot}_thigh", f"{foot}_shank", "0 0 -0.2", limits="-2.5 -0.3"),
            joint("fixed", f"{foot}_shank", foot, "0 0 -0.2"),
        ]
    return f'<robot name="dog">{"".join(parts)}</robot>'


@pytest.fixture(scope="module")
def dog(tmp_path_factory: pytest.TempPathFactory) -> RobotFiles:
    path = tmp_path_factory.mktemp("robot") / "dog.urdf"
    path.write_text(urdf())
    return RobotFiles(path, FEET)


def walked(robot: RobotFiles, ground: SimulatedGround, duration: float = 2.0, **physics: Any) -> Walk:
    return walk(Machine(robot, ground, Physics(**physics)), ground, PlannedGait("trot"), duration)


@pytest.fixture(scope="module")
def level(dog: RobotFiles) -> Walk:
    return walked(dog, SimulatedGround(), 3.0)


def test_a_robot_without_a_known_posture_stands_on_bent_legs(dog: RobotFiles) -> None:
    machine = Machine(dog, SimulatedGround(), Physics())
    assert machine.sole == Sole(radius=RADIUS)
    assert machine.mass == pytest.approx(8.0 + 4 * 1.05)
    # The legs are 0.4 m long and squat by a part of it.
    assert machine.height == pytest.approx(0.85 * 0.4 + RADIUS, abs=1e-6)
    assert all(machine.posture[2::3] < -0.3)


def test_joints_are_found_that_put_level_soles_where_they_are_wanted(tmp_path: Path) -> None:
    legs = ("LF", "RF")
    (tmp_path / "biped.urdf").write_text(urdf(legs).replace('type="fixed"', 'type="revolute"'))  # with ankles
    sole = Sole(heel=-0.05, toe=0.1, width=0.05)
    machine = Machine(RobotFiles(tmp_path / "biped.urdf", legs, sole=sole), SimulatedGround(), Physics())
    wanted = machine.at_rest(machine.posture) + np.array([[[0.05, 0.0, 0.02]], [[-0.05, 0.0, 0.0]]])
    assert wanted[:, 1] - wanted[:, 0] == pytest.approx(np.array([[0.15, 0.0, 0.0]] * 2), abs=1e-6)
    assert machine.at_rest(machine.reach(wanted, machine.posture)) == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("ground", [SimulatedGround(), SimulatedGround(-0.1), blocks(0.02, 1), stairs(-0.03)])
def test_the_ground_carries_the_robot(dog: RobotFiles, ground: SimulatedGround) -> None:
    run = walked(dog, ground)
    assert not run.fallen
    stride = round(run.gait.period / STEP)
    pushed = run.forces[-4 * stride :].sum(axis=1).mean(axis=0) / (9.81 * run.machine.mass)
    assert pushed == pytest.approx([0.0, 0.0, 1.0], abs=0.05)
    assert run.positions[-1, 0] > 0.2


def test_each_stride_has_a_landing_of_each_foot_with_about_the_planned_speed(level: Walk) -> None:
    landings = landings_of(level)
    strides = (level.duration - STANDS) / level.gait.period
    for foot in FEET:
        mine = [one for one in landings if one.foot == foot]
        assert len(mine) == pytest.approx(strides, abs=2.5)
        assert np.median([one.speed for one in mine]) == pytest.approx(level.gait.strike, rel=0.3)
    assert [one.stamp for one in landings] == sorted(one.stamp for one in landings)


def test_a_landing_tells_the_impulses_of_the_forces_and_the_twists_of_the_trunk(level: Walk) -> None:
    landing = landings_of(level)[5]
    step, foot = round(landing.stamp * 1e-9 / STEP), FEET.index(landing.foot)
    assert not level.forces[step - 1, foot].any()
    assert level.forces[step, foot, 2] > 0.0
    assert [state.time for state in landing.after[:3]] == [0.001, 0.002, 0.005]
    for state in landing.after:
        steps = round(state.time / STEP)
        summed = level.forces[step : step + steps].sum(axis=0) * STEP
        assert np.array(state.impulses) == pytest.approx(summed)
        assert state.rates == pytest.approx(level.velocities[step + steps, 6:])
    peak = landing.after[3].time
    force = level.forces[step : step + round(0.01 / STEP), foot, 2]
    assert 0.0003 < peak < 0.005
    assert force[round(peak / STEP)] == force[: round(peak / STEP) + 5].max()


def test_contacts_that_do_not_last_and_feet_that_have_not_swung_make_no_landing(level: Walk) -> None:
    forces = np.zeros((round(1.0 / STEP), 4, 3))

    def touch(foot: int, begin: float, end: float) -> None:
        forces[round(begin / STEP) : round(end / STEP), foot, 2] = 50.0

    for foot in range(4):
        touch(foot, 0.0, 0.1)
    touch(0, 0.3, 0.6)  # lands
    touch(1, 0.2, 0.208)  # scuffs
    touch(1, 0.3, 0.6)
    touch(2, 0.12, 0.6)  # comes down again too soon
    touch(3, 0.3, 0.6)
    forces[round(0.32 / STEP) : round(0.326 / STEP), 3] = 0.0  # bounces, and stays
    made = level._replace(forces=forces, positions=level.positions[: len(forces)].copy())
    assert landings_of(made) == []  # the feet stand all the while
    made.positions[round(0.15 / STEP) : round(0.25 / STEP), 2] += 0.01
    told = [(one.foot, one.stamp) for one in landings_of(made)]
    assert told == [("LF", 300_000_000), ("RF", 300_000_000), ("RH", 300_000_000)]


def test_a_landing_is_the_first_step_with_a_force_after_a_swing_while_other_feet_carry_ever_so_little(
    level: Walk,
) -> None:
    forces, lift, swing = np.full((round(1.0 / STEP), 4, 3), [0.0, 0.0, 0.5]), 401, round(SWING / STEP)
    forces[lift : lift + swing, 0] = forces[lift : lift + swing - 1, 1] = 0.0  # the other one is back too soon
    made = level._replace(forces=forces, positions=level.positions[: len(forces)].copy())
    made.positions[lift : lift + swing, 2] += 0.01
    (landing,) = landings_of(made)
    assert (landing.foot, landing.standing) == ("LF", ("LH", "RH"))
    assert landing.stamp == round((lift + swing) * STEP * 1e9)


def messages(run: Walk, **sensors: Any) -> dict[str, list[Any]]:
    """What a bag tells, read by topic."""
    read: dict[str, list[Any]] = {}
    for stream in walk_messages(run, landings_of(run), WalkSensors(**sensors)):
        for one in stream:
            if one.topic.strip("/") in INPUT_TYPES:
                read.setdefault(one.topic[1:], []).append(INPUT_TYPES[one.topic[1:]].decode(one.data))
            elif one.topic == LANDING_TOPIC:
                read.setdefault(one.topic, []).extend(decode_truths(TrueLanding, one.data))
    return read


@pytest.fixture(scope="module")
def ideal(level: Walk) -> dict[str, list[Any]]:
    return messages(level)


def test_a_bag_tells_where_trunk_and_feet_are_and_when_they_are_to_stand(level: Walk) -> None:
    told = messages(level, rate=1000.0)
    assert told[LANDING_TOPIC] == landings_of(level)
    stands = [np.all(level.forces[round(one.stamp * 1e-9 / STEP), :, 2] > 0.0) for one in told["odom"]]
    for k in np.flatnonzero(stands)[:50]:
        sample, geometry = told["odom"][k], told["contact_geometry"][k]
        places = [to_world(axes_of(sample.orientation), point) for point in geometry.points]
        heights = [sample.position[2] + place[2] for place in places]
        assert heights == pytest.approx([0.0] * 4, abs=2e-3)
    # The twist is that of the poses.
    for before, now, after in zip(told["odom"][:-2], told["odom"][1:-1], told["odom"][2:], strict=True):
        moved = to_world(axes_of(now.orientation), now.linear)
        assert np.array(add(after.position, before.position, -1.0)) * 500.0 == pytest.approx(moved, abs=0.1)
    (schedule,) = told["schedule"]
    times = np.array(schedule.times[1:]) * 1e-9 - STANDS
    assert [list(stands) for stands in schedule.stands[1:]] == level.gait.stands(times + 1e-6).tolist()
    assert np.median([wrench.force[2] for wrench in told["contact_wrench"]]) > 10.0
    efforts = np.array([joints.efforts for joints in told["joint_states"]])
    assert np.abs(efforts).max() > 1.0


def test_feet_by_their_names_have_velocities_and_forces_too(level: Walk, ideal: dict[str, list[Any]]) -> None:
    by_name = messages(level, by_names=True)
    assert "contact_geometry" not in by_name
    assert "feet_states" not in ideal
    total = []
    for geometry, feet, sample in zip(ideal["contact_geometry"], by_name["feet_states"], by_name["odom"], strict=True):
        assert feet.names == FEET
        assert np.array(feet.positions) == pytest.approx(np.array(geometry.points), abs=1e-6)
        total.append(sum(to_world(axes_of(sample.orientation), force)[2] for force in feet.forces))
    assert np.mean(total) == pytest.approx(9.81 * level.machine.mass, rel=0.1)


def test_the_heights_of_blocks_are_told_where_the_feet_come_to_stand(dog: RobotFiles) -> None:
    run = walked(dog, blocks(0.03, 2), 3.0)
    (terrain,) = messages(run)["terrain"]
    feet = run.states(np.array([run.duration])).points.reshape(-1, 3)
    heights = []
    for foot in feet[np.any(run.forces[-1] != 0.0, axis=1)]:
        nearest = terrain.points[np.argmin(np.linalg.norm(terrain.points[:, :2] - foot[:2], axis=1))]
        heights.append(foot[2] - nearest[2])
    assert heights == pytest.approx([0.0] * len(heights), abs=2e-3)
    assert set(np.round(terrain.points[:, 2], 6)) == {0.0, 0.03}


def test_the_velocities_of_the_feet_are_theirs_against_the_trunk(level: Walk) -> None:
    seen = level.states(np.arange(0.5, 2.0, 0.01))
    later = level.states(np.arange(0.5, 2.0, 0.01) + STEP)
    moved = (later.points - seen.points) / STEP
    # Along the normal the point that touches first moves as the foot does; across it the ball turns.
    wrong = np.abs(moved[..., 2] - seen.point_velocities[..., 2])
    assert np.median(wrong) < 1e-3
    assert wrong.max() < 0.2


def test_late_feet_are_those_of_earlier_and_a_height_drifts(level: Walk, ideal: dict[str, list[Any]]) -> None:
    late = messages(level, delay=0.005, drift=0.01)
    for before, after in zip(ideal["contact_geometry"][:-2], late["contact_geometry"][2:], strict=True):
        assert after.points == before.points
        assert after.stamp == before.stamp + 5_000_000
    for before, after in zip(ideal["odom"], late["odom"], strict=True):
        assert after.position[2] - before.position[2] == pytest.approx(0.01 * before.stamp * 1e-9)


def test_noise_has_the_deviations_that_are_asked_for_and_a_seed_makes_it(
    level: Walk, ideal: dict[str, list[Any]]
) -> None:
    noisy, again, other = (messages(level, position=1e-3, velocity=0.02, seed=seed) for seed in (1, 1, 2))
    assert noisy == again
    assert noisy["odom"] != other["odom"]
    wrong = np.array([one.points for one in noisy["contact_geometry"]]) - np.array(
        [one.points for one in ideal["contact_geometry"]]
    )
    assert wrong.std() == pytest.approx(1e-3, rel=0.05)
    wrong = np.array([one.linear for one in noisy["odom"]]) - np.array([one.linear for one in ideal["odom"]])
    assert wrong.std() == pytest.approx(0.02, rel=0.05)
    sample = noisy["odom"][0]
    assert (sample.pose_covariance[0], sample.twist_covariance[7]) == pytest.approx((1e-6, 4e-4))


def test_a_replay_with_the_scene_finds_the_landings(tmp_path: Path, level: Walk) -> None:
    landings = landings_of(level)
    write_messages(tmp_path / "dog.mcap", walk_messages(level, landings, WalkSensors()))
    (tmp_path / "dog.yaml").write_text(scene_of(level, by_joints=False, on_terrain=False))
    scenes = scenes_of(read_values(str(tmp_path / "dog.yaml")))
    assert scenes[""].mass == pytest.approx(level.machine.mass)
    result = replay(tmp_path / "dog.mcap", scenes)
    assert result.truth is not None
    assert result.truth.touchdowns == len(landings)
    assert result.truth.found >= 0.8 * len(landings)


def test_the_inertia_of_the_scene_is_that_of_locked_joints(dog: RobotFiles) -> None:
    machine = Machine(dog, SimulatedGround(), Physics())
    center, inertia = machine.inertia()
    model, data = machine.model, machine.data
    machine.at_rest(machine.posture)
    data.qvel[:] = 0.0
    for axis in range(3):
        # What turns at 1 rad/s has its inertia as angular momentum.
        data.qvel[3:6] = np.eye(3)[axis]
        machine.mujoco.mj_comVel(model, data)
        machine.mujoco.mj_subtreeVel(model, data)
        assert data.subtree_angmom[1] == pytest.approx(inertia[axis], abs=1e-9)
    assert data.subtree_com[1] == pytest.approx(center)


def test_a_robot_on_two_feet_steps_on_its_gantry(tmp_path: Path) -> None:
    (tmp_path / "biped.urdf").write_text(urdf(("LF", "RF")))
    robot, ground = RobotFiles(tmp_path / "biped.urdf", ("LF", "RF")), SimulatedGround()
    run = walk(Machine(robot, ground, Physics()), ground, PlannedGait("step"), 3.0, gantry=1.0)
    assert not run.fallen
    assert len(landings_of(run)) >= 6
    assert walk(Machine(robot, ground, Physics()), ground, PlannedGait("step"), 3.0).fallen


@pytest.mark.parametrize(
    ("text", "feet", "says"),
    [
        ("<robot", FEET, "cannot be read as XML"),
        (urdf().replace("LF_thigh", "RF_thigh"), FEET, "is not a URDF that MuJoCo can read|MuJoCo cannot move"),
        (urdf(), (*FEET[:3], "tail"), "has no link 'tail'; --feet names the links of the feet"),
        (urdf().replace("<sphere", "<mesh"), FEET, "are not balls of one size; give --radius"),
    ],
)
def test_what_is_no_such_robot_is_refused(tmp_path: Path, text: str, feet: tuple[str, ...], says: str) -> None:
    (tmp_path / "robot.urdf").write_text(text)
    with pytest.raises(InputError, match=says):
        Machine(RobotFiles(tmp_path / "robot.urdf", feet), SimulatedGround(), Physics())


def test_a_gait_is_refused_that_the_robot_cannot_walk(dog: RobotFiles) -> None:
    machine, ground = Machine(dog, SimulatedGround(), Physics()), SimulatedGround()
    with pytest.raises(InputError, match="a gait for 2 feet, but the robot has 4"):
        walk(machine, ground, PlannedGait("step"), 1.0)
    with pytest.raises(InputError, match="the legs do not reach"):
        walk(machine, ground, PlannedGait("trot", speed=3.0), 1.0)
