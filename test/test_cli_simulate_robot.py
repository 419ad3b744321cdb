"""`impact-predictor simulate robot`: what it prints and writes, and one sentence for each mistake."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import pytest
from command_line import answer_of, invoke

from impact_predictor.bags.read import topics
from impact_predictor.commands import simulate_robot
from impact_predictor.scenarios.robot import description, gait
from impact_predictor.scenarios.truth import LANDING_TOPIC

FOUR = "FL_foot,FR_foot,RL_foot,RR_foot"


pytestmark = pytest.mark.usefixtures("folder")

run = partial(invoke, "simulate", "robot")


def test_the_names_of_robots_and_gaits_are_those_of_the_library() -> None:
    assert simulate_robot.NAMES == description.NAMES
    assert simulate_robot.GAITS == tuple(gait.OFFSETS) == tuple(gait.DUTY)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--feet", "a,b"), "--feet, --srdf, --radius and --sole are those of a robot by --urdf"),
        (("go1", "--urdf", "x.urdf", "--feet", "a,b"), "--urdf takes the place of a name, and needs --feet"),
        (("--urdf", "x.urdf"), "--urdf takes the place of a name, and needs --feet"),
        (("--slope", "3", "--stairs", "0.05"), "--slope, --blocks and --stairs are three grounds; give one of them"),
        (("--strike", "-1"), "strike is -1.0; give a number from 0"),
        (("--armature", "nan"), "armature is nan; give a number from 0"),
        (("--rate", "5000", "-o", "x.mcap"), "rate is 5000.0; give a number above 0, up to 4000"),
        (("--duration", "0"), "duration is 0.0; give a finite number above 0"),
        (
            ("--params-out", "x.yaml"),
            "--params-out is that of a bag: give -o BAG too",
        ),
        (("--delay", "0.005"), "--delay is that of a bag: give -o BAG too"),
        (("--terrain", "-o", "x.mcap"), "--terrain is that of --blocks or --stairs: give one of them too"),
        (("spot",), "'spot' is not one of 'a1', 'anymal', 'bolt', 'go1', 'hyq', 'solo12', 'talos'"),
    ],
)
def test_a_mistake_is_told_in_a_sentence(arguments: tuple[str, ...], says: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert says in result.stderr


def test_without_mujoco_or_models_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(_: str) -> None:
        raise description.PackageNotFoundError

    with monkeypatch.context() as without:
        without.setattr(description, "files", nothing)
        assert "example-robot-data, which is not installed: install the extra `robot`" in run().stderr
    monkeypatch.setitem(sys.modules, "mujoco", None)
    Path("x.urdf").write_text("<robot name='x'/>")
    result = run("--urdf", "x.urdf", "--feet", "a,b")
    assert result.exit_code == 2
    assert "`pip install mujoco`, or `pip install 'impact_predictor[robot]'`" in result.stderr


@pytest.mark.extras
def test_a_robot_trots_and_its_bag_comes_with_a_scene() -> None:
    pytest.importorskip("mujoco", reason="needs the extra robot")
    answer = answer_of(run("--duration", "2", "-o", "trot.mcap", "--json"))
    assert (answer["robot"], answer["fallen"]) == ("go1", False)
    assert answer["mass"] == pytest.approx(13.1, abs=0.1)
    assert len(answer["landings"]) > 8
    for landing in answer["landings"]:
        assert [one["after"] for one in landing["impulses"][:3]] == [0.001, 0.002, 0.005]
    assert {"/odom", "/contact_geometry", "/joint_states", LANDING_TOPIC} <= set(topics("trot.mcap"))
    replayed = answer_of(invoke("replay", "trot.mcap", "--params", "trot.yaml", "--json"))
    assert replayed["truth"]["touchdowns"] == len(answer["landings"])
    Path("trot.yaml").write_text("mine: true\n")
    result = run("--duration", "1", "-o", "trot.mcap")
    assert result.exit_code == 2
    assert "trot.yaml is no scene of a simulated robot, so it stays as it is; give --params-out" in result.stderr


@pytest.mark.extras
@pytest.mark.parametrize("options", [("--by-joints",), ("--by-names",), ("--blocks", "0.01", "--terrain")])
def test_feet_may_be_told_by_joints_or_names_and_the_ground_by_a_map(options: tuple[str, ...]) -> None:
    pytest.importorskip("mujoco", reason="needs the extra robot")
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    assert run(*options, "--duration", "3", "-o", "trot.mcap").exit_code == 0
    replayed = answer_of(invoke("replay", "trot.mcap", "--params", "trot.yaml", "--json"))
    assert replayed["truth"]["touchdowns"] > 15
    assert replayed["truth"]["missed"] <= 0.2 * replayed["truth"]["touchdowns"]


@pytest.mark.extras
def test_flat_feet_told_by_joints_land_with_heel_or_toe_or_both_at_once() -> None:
    pytest.importorskip("mujoco", reason="needs the extra robot")
    pytest.importorskip("pinocchio", reason="needs the extra articulated")
    result = run("talos", "--swing", "0.4", "--strike", "0.3", "--by-joints", "--duration", "4", "-o", "steps.mcap")
    assert result.exit_code == 0, result.stderr
    replayed = answer_of(invoke("replay", "steps.mcap", "--params", "steps.yaml", "--json"))
    points = [one["point"] for one in replayed["touchdowns"] if one["landing_speed"] > 0.4]
    assert {"heel", "toe"} <= set(points) <= {"heel", "toe", None}


@pytest.mark.extras
def test_the_same_options_and_seed_make_the_same_bytes() -> None:
    pytest.importorskip("mujoco", reason="needs the extra robot")
    for name in ("one", "two"):
        result = run("solo12", "--duration", "1", "--blocks", "0.01", "--noise-position", "0.001", "-o", f"{name}.mcap")
        assert "Scene: " in result.stdout
    assert Path("one.mcap").read_bytes() == Path("two.mcap").read_bytes()
    assert Path("one.yaml").read_bytes() == Path("two.yaml").read_bytes()


@pytest.mark.extras
def test_a_humanoid_steps_and_one_that_falls_ends_with_status_1() -> None:
    pytest.importorskip("mujoco", reason="needs the extra robot")
    result = run("talos", "--swing", "0.4", "--strike", "0.3", "--duration", "2.5")
    assert result.exit_code == 0, result.stderr
    assert "left_sole_link" in result.stdout
    result = run("--urdf", "humanoid.urdf", "--feet", "l_sole,r_sole", "--sole", "0.1,-0.1,0.1")
    assert "--sole is 0.1,-0.1,0.1: give heel, toe and width in m, as in -0.1,0.1,0.12" in result.stderr
    result = run("--duration", "1", "--slope", "30")
    assert result.exit_code == 1
    assert "it falls after" in result.stdout
