"""The planned gait of HyQ: its 49 touchdowns, predicted from base and feet alone, end to end and with noise."""

from __future__ import annotations

import importlib
import json
import re
from collections import Counter
from collections.abc import Callable
from math import copysign
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from command_line import invoke
from rosbags.rosbag1 import Reader, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from scipy.spatial.transform import Rotation

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.mechanics.types import ContactState
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.scenarios.comparison import Warned

ROOT = Path(__file__).parents[1]
BAG = ROOT / "examples/hyq/hyq.bag"
SCENE = ROOT / "config/walker_hyq.yaml"
TOPIC, TYPE = "/xpp/state_des", "xpp_msgs/msg/RobotStateCartesian"

pytestmark = pytest.mark.slow


def replay(*arguments: object) -> Result:
    return invoke("replay", *map(str, arguments))


@pytest.fixture(scope="module")
def answer() -> dict[str, Any]:
    result = replay(BAG, "--params", SCENE, "--json")
    assert result.exit_code == 0, result.stderr
    assert "took /xpp/state_des as odom and contact_geometry: its messages have an adapter" in result.stderr
    told: dict[str, Any] = json.loads(result.stdout)
    return told


@pytest.fixture(scope="module")
def noise() -> ModuleType:
    """The benchmark, whose folder is on the path of the tests."""
    return importlib.import_module("walker_times")


def test_all_touchdowns_of_the_plan_are_found_50_ms_ahead_to_2_ms_and_none_besides(answer: dict[str, Any]) -> None:
    assert answer["samples"] == 3601
    assert answer["statuses"] == answer["geometry_statuses"] == {"ACCEPTED": 3601}
    truth = answer["truth"]
    assert (truth["touchdowns"], truth["missed"], truth["false"]) == (49, 0, 0)
    assert truth["least_lead_time"] >= 0.05
    # The flags change at the first of the plan's samples, 2.5 ms apart, that follows the landing: half of that at best.
    assert truth["median_time_error"] <= 0.002
    assert set(truth["time_error_by_lead_time"]) == {"0.02", "0.05"}
    assert all(error <= 0.002 for error in truth["time_error_by_lead_time"].values())


def test_the_document_names_every_key(answer: dict[str, Any]) -> None:
    page = (ROOT / "docs/replay.md").read_text()
    watched = {*Warned._fields, "bodies_with_slide_or_impact", "warned_before_first_impact"}
    of_some = {"inputs", "damaged", "error", *watched}
    keys = {*answer, *answer["touchdowns"][0], *answer["error_by_lead_time"][0], *answer["truth"]}
    told = {name for names in re.findall(r"`([\w` ,]+)`", page) for name in re.split("[` ,]+", names)}
    assert keys | of_some <= told


def test_every_foot_is_told_to_land_as_often_as_it_does(answer: dict[str, Any]) -> None:
    landed = Counter(one["foot"] for one in answer["touchdowns"])
    assert landed == {"LF": 12, "RF": 13, "LH": 12, "RH": 12}
    for one in answer["touchdowns"]:
        # No planner told when, no sensor whether; what a record shows after a landing is not its impact alone.
        assert one["late"] is None
        assert one["confirmed"] is None
        assert not one["scored"]
        assert "DRIVEN" in one["flags"]
        assert copysign(1.0, one["landing_speed"]) > 0.0


def test_the_plans_own_flags_and_forces_are_no_input(tmp_path: Path) -> None:
    def invert(number: int, message: Any) -> None:
        message.ee_contact = np.logical_not(message.ee_contact)
        for force in message.ee_forces:
            force.x = force.y = force.z = 0.0

    outputs = []
    for name, change in (("as_planned", lambda number, message: None), ("inverted", invert)):
        bag, output = rewrite(tmp_path / f"{name}.bag", change), tmp_path / f"{name}.mcap"
        result = replay(bag, "--params", SCENE, "-o", output, "--json")
        assert result.exit_code == 0, result.stderr
        outputs.append(list(read_messages(output, topics(output))))
    # At least a mode and a prediction for each of 1200 samples.
    assert len(outputs[0]) >= 2400
    assert outputs[0] == outputs[1]


def test_bad_messages_are_counted_by_what_is_wrong_and_the_others_still_predict(tmp_path: Path) -> None:
    def spoil(number: int, message: Any) -> None:
        base = message.base
        if number % 100 == 50:
            message.ee_motion = message.ee_motion[:3]
        elif number % 100 == 51:
            base.pose.position.x = float("nan")
        elif number % 100 == 52:
            base.pose.orientation = type(base.pose.orientation)(0.0, 0.0, 0.0, 0.0)
        elif number % 100 == 70:
            message.time_from_start.nanosec -= 2_500_000

    bag = rewrite(tmp_path / "spoilt.bag", spoil)
    result = replay(bag, "--params", SCENE, "--json")
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    assert answer["geometry_statuses"]["FEET_CHANGED"] == 12
    assert answer["statuses"]["NOT_FINITE"] == 12
    assert answer["statuses"]["MALFORMED"] == answer["geometry_statuses"]["MALFORMED"] == 12
    assert answer["statuses"]["STAMP_REPEATED"] == 12
    assert sum(answer["statuses"].values()) == answer["samples"] == 1201
    assert answer["truth"]["missed"] == 0
    assert answer["truth"]["touchdowns"] >= 12


def rewrite(path: Path, change: Callable[[int, Any], None]) -> Path:
    """The first 3 s of the plan with changed messages, told their numbers."""
    store = get_typestore(Stores.EMPTY)
    with Reader(BAG) as reader, Writer(path) as writer:
        (connection,) = (one for one in reader.connections if one.topic == TOPIC)
        store.register(get_types_from_msg(connection.msgdef.data, TYPE))
        written = writer.add_connection(TOPIC, TYPE, typestore=store)
        for number, (_, stamp, data) in enumerate(reader.messages([connection], stop=3_000_010_000)):
            message = store.deserialize_ros1(data, TYPE)
            change(number, message)
            writer.write(written, stamp, store.serialize_ros1(message, TYPE))
    return path


@pytest.mark.parametrize("on_robot", [False, True], ids=["in the world", "on the robot"])
@pytest.mark.parametrize("seed", [0, 1])
def test_with_noise_none_is_missed_and_none_is_false(noise: ModuleType, seed: int, on_robot: bool) -> None:
    walk = noise.hyq()
    # The walk and the change to a trot.
    landings = {foot: [one for one in stamps if one < 4 * 10**9] for foot, stamps in walk.landings.items()}
    walk = noise.with_noise(walk._replace(messages=walk.messages[:3200], landings=landings), seed, on_robot=on_robot)
    (product,) = noise.figures(walk, ["product"])
    assert (product["landings"], product["false"], product["none"], product["noticed"]) == (16, 0, 0, 1.0)
    assert product["20"]["told"] == 1.0
    # Twice the medians over 20 seeds, for 16 landings scatter.
    assert product["20"]["median"] < 3.0
    assert product["50"]["median"] < 4.0


def test_the_plan_brakes_its_feet_and_their_impacts_are_those_of_the_last_samples(noise: ModuleType) -> None:
    machine, samples, scores = noise.scene(), {}, []
    walker = Predictor(machine)
    for told in noise.plan():
        walker.tell(told.geometry)
        prediction = walker.update(told.sample)
        samples[told.sample.stamp] = told
        scores += [] if prediction.score is None else [prediction.score]
    scores += walker.finish()
    assert len(scores) == 49
    assert {score.touchdown.mode.name for score in scores} == {"NO_IMPACT"}
    sticking = 0
    for score in scores:
        impact = score.landing.impact
        told = samples[max(stamp for stamp in samples if stamp < score.stamp)]
        linear, angular, velocities = by_newton(told, impact, machine)
        # The same numbers in another order: rounding of speeds of 2 m/s.
        assert np.allclose(impact.linear, linear, rtol=0.0, atol=1e-12)
        assert np.allclose(impact.angular, angular, rtol=0.0, atol=1e-12)
        (foot,) = impact.new
        assert score.landing.speed == pytest.approx(np.linalg.norm(velocity_in_world(told, foot)), abs=1e-12)
        for contact, velocity in zip(impact.contacts, velocities, strict=True):
            assert np.allclose(contact.velocity, velocity, rtol=0.0, atol=1e-12)
            # No foot goes on into the ground; friction is in its cone, and opposes the slip that is left.
            x, y, normal = contact.impulse
            assert normal >= 0.0
            assert velocity[2] > -1e-11
            assert np.hypot(x, y) <= normal * machine.friction + 1e-12
            if contact.state is ContactState.SLIPS:
                assert np.dot(contact.impulse[:2], velocity[:2]) <= 0.0
            sticking += contact.state is ContactState.STICKS
    assert sticking > 20


def velocity_in_world(told: Any, foot: int) -> np.ndarray:
    sample, geometry = told.sample, told.geometry
    moves = np.add(sample.linear, np.cross(sample.angular, geometry.points[foot])) + geometry.velocities[foot]
    velocity: np.ndarray = Rotation.from_quat(sample.orientation).apply(moves)
    return velocity


def by_newton(told: Any, impact: Any, machine: Any) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """The trunk's twist after the impulses of an impact, in its own axes, by Newton's and Euler's laws in the world.

    Then the velocities of the contacts, changed from what they were: rest, or its own of a foot that lands. Legs have
    no mass: a foot's velocity changes as that of a point of the trunk.
    """
    sample = told.sample
    turned = Rotation.from_quat(sample.orientation)
    arms = turned.apply(np.array(told.geometry.points))[[contact.point for contact in impact.contacts]]
    pushes = np.array([contact.impulse for contact in impact.contacts])
    inertia = turned.as_matrix() @ np.array(machine.inertia) @ turned.as_matrix().T
    linear = np.sum(pushes, axis=0) / machine.mass
    angular = np.linalg.solve(inertia, np.sum(np.cross(arms, pushes), axis=0))
    velocities = []
    for contact, arm in zip(impact.contacts, arms, strict=True):
        before = velocity_in_world(told, contact.point) if contact.is_new else np.zeros(3)
        # What leaves the ground already, or grazes it, rests.
        before[2] = min(0.0, before[2])
        velocities.append(before + linear + np.cross(angular, arm))
    twist = (old + turned.inv().apply(new) for old, new in ((sample.linear, linear), (sample.angular, angular)))
    return *twist, velocities
