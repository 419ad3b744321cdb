"""The node for a walking machine as a process of its own, over real DDS: bad input is named, and it goes on."""

import importlib.util
import time
from itertools import count
from math import cos
from pathlib import Path

import pytest

from impact_predictor.ros.messages.walker_inputs import encode_feet, encode_joints, encode_schedule, encode_wrench

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

from graph import running_node, served_and_replayed
from trot import FEET, plan, trot

from impact_predictor.bags.write import BagWriter
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.types import FeetStates, Geometry, Joints, Schedule, Wrench
from impact_predictor.ros.cdr import OK
from impact_predictor.ros.messages import (
    ODOMETRY,
    POLYGON,
    decode_diagnostic_array,
    encode_odometry,
    encode_polygon,
)
from impact_predictor.ros.messages.inputs import JOINT_STATE, JOINT_TRAJECTORY, MULTI_DOF_JOINT_STATE, WRENCH
from impact_predictor.ros.process import message_class

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "config/walker_hyq.yaml"
RATE = 200.0


class Machine:
    """Publishes one step of a walking machine after the other, as it is told to."""

    def __init__(self, peer, types, steps):
        self.publishers = {
            topic: peer.connected(peer.publisher(message_class(kind), topic, 100)) for topic, kind in types.items()
        }
        self._steps = steps

    def step(self, spoil=lambda message: message):
        """The messages of a step, by their topics in order, each spoilt if that is asked for."""
        for topic, message in next(self._steps):
            told = spoil(message)
            if told is not None:
                encode = encode_polygon if isinstance(told, Geometry) else ENCODERS.get(type(told), encode_odometry)
                self.publishers[topic].publish(encode(told))


ENCODERS = {FeetStates: encode_feet, Joints: encode_joints, Wrench: encode_wrench, Schedule: encode_schedule}


def trotting():
    return ((("contact_geometry", geometry), ("odom", sample)) for geometry, sample in trot(RATE, 1000.0))


def walk_until(peer, machine, condition, spoil=lambda message: message):
    """Let the machine go on, in real time so that no queue overflows, until something is so."""

    def so():
        due = time.monotonic() + 1.0 / RATE
        machine.step(spoil)
        while (left := due - time.monotonic()) > 0.0:
            peer.executor.spin_once(timeout_sec=left)
        return condition()

    peer.until(so)


def predicts(peer):
    """A condition: a touchdown was predicted since now."""
    seen = len(peer.heard["post_impact"])
    return lambda: len(peer.heard["post_impact"]) > seen


def feet_of(peer):
    return {one.values["name"]: one for one in decode_diagnostic_array(peer.heard["prediction"][-1])[1:]}


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_feet_that_are_too_many_or_below_the_ground_are_named_and_the_node_predicts_again_afterwards(peer, executor):
    def more_feet(message):
        if isinstance(message, Geometry):
            return message._replace(points=(*message.points, (0.0, 0.0, -0.58)))
        return message

    def below(message):
        if isinstance(message, Geometry):
            return message._replace(points=tuple((x, y, z - 1.5) for x, y, z in message.points))
        return message

    def no_feet(message):
        return None if isinstance(message, Geometry) else message

    with running_node(SCENE, "-p", f"executor:={executor}") as node:
        machine = Machine(peer, {"contact_geometry": POLYGON, "odom": ODOMETRY}, trotting())
        walk_until(peer, machine, predicts(peer))
        for spoil, reasons in (
            (more_feet, ("contact_geometry.FEET_CHANGED", "odom.GEOMETRY_STALE")),
            (no_feet, ("odom.GEOMETRY_STALE",)),
            (below, ("odom.BELOW_GROUND",)),
        ):
            for reason in reasons:
                before = int(peer.reported(f"refused.{reason}") or 0)
                walk_until(
                    peer,
                    machine,
                    lambda reason=reason, before=before: int(peer.reported(f"refused.{reason}") or 0) > before,
                    spoil,
                )
            assert peer.report().level > OK
            walk_until(peer, machine, predicts(peer))
            walk_until(peer, machine, lambda: peer.report().level == OK)
        assert "Traceback" not in node.complained()


@pytest.mark.slow
def test_diagnostics_say_which_feet_stand_how_late_they_land_and_which_sensor_disagrees(peer):
    # RF feels nothing, whatever it does; LF feels that it stands all the time.
    felt = {"RF": 0.0, "LF": 300.0}

    def steps():
        for geometry, sample in trot(RATE, 1000.0):
            yield [
                *(("contact_wrench", Wrench(sample.stamp, name, (0.0, 0.0, force))) for name, force in felt.items()),
                ("feet_states", FeetStates(geometry.stamp, "base", FEET, geometry.points)),
                ("odom", sample),
            ]

    types = {
        "feet_states": MULTI_DOF_JOINT_STATE,
        "odom": ODOMETRY,
        "contact_wrench": WRENCH,
        "schedule": JOINT_TRAJECTORY,
    }
    with running_node(SCENE, "-p", "feet.force:=50.0", "-p", "feet.has_schedule:=true"):
        machine = Machine(peer, types, steps())
        schedule = machine.publishers["schedule"]
        # What is published before the node has found the publisher is lost; a message that is none tells when it has.
        peer.until(lambda: peer.reported("refused.schedule.MALFORMED"), lambda: schedule.publish(b"\0"))
        schedule.publish(encode_schedule(plan(100.0, earlier=0.01)))
        walk_until(peer, machine, lambda: int(peer.reported("feet.landings") or 0) >= 8)
        walk_until(peer, machine, lambda: "force sensor of RF does not agree" in peer.report().message)
        assert set(FEET) == feet_of(peer).keys()
        assert set(peer.reported("feet.standing").split()) <= set(FEET)
        assert peer.reported("feet.landings.late") == peer.reported("feet.landings")
        # The plan wants each landing 10 ms earlier; a sample is 5 ms.
        assert float(peer.reported("feet.landings.median_late")) == pytest.approx(0.01, abs=0.005)
        scores = [decode_diagnostic_array(data)[0].values for data in peer.heard["score"]]
        assert {one["foot"] for one in scores} == set(FEET)
        assert {one["confirmed"] for one in scores if one["foot"] == "RF"} == {"false"}
        assert not {"confirmed"} & {key for one in scores if one["foot"] == "LH" for key in one}


@pytest.mark.slow
def test_a_walking_machine_is_told_by_the_node_what_the_replay_tells_byte_for_byte(tmp_path):
    values = validate({**read_parameters(SCENE), "feet.force": 50.0, "feet.has_schedule": True})
    messages = [("/schedule", JOINT_TRAJECTORY, encode_schedule(plan(2.0, earlier=0.004)))]
    for geometry, sample in trot(RATE, 2.0):
        force = Wrench(sample.stamp, "LF", (0.0, 0.0, 100.0 * (sample.stamp % 3)))
        messages.append(("/contact_wrench", WRENCH, encode_wrench(force)))
        # Every other time the trunk is told of first, and in the end the feet are told by their names.
        both = [("/contact_geometry", POLYGON, encode_polygon(geometry)), ("/odom", ODOMETRY, encode_odometry(sample))]
        if len(messages) > RATE * 3:
            named = FeetStates(geometry.stamp, geometry.frame_id, FEET, geometry.points, geometry.velocities)
            both[0] = "/feet_states", MULTI_DOF_JOINT_STATE, encode_feet(named)
        messages += both if len(messages) % 2 else reversed(both)
    bag = tmp_path / "trot.mcap"
    with BagWriter(bag) as writer:
        for k, (topic, kind, data) in enumerate(messages):
            writer.write(topic, kind, k, data)
    heard, replayed, read = served_and_replayed(values, bag, tmp_path / "replayed.mcap")
    assert read - {"/parameter_events"} == {topic for topic, _, _ in messages}
    assert len(replayed["/impact_predictor/score"]) >= 10
    assert heard == replayed


LEG = """
  <link name="{n}_thigh"/>
  <link name="{n}_foot"><inertial><origin xyz="0 0 -0.3"/><mass value="1.0"/>
    <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="{n}_sole"/>
  <joint name="{n}_hip" type="revolute"><parent link="base"/><child link="{n}_thigh"/><origin xyz="{x} {y} 0"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="{n}_knee" type="revolute"><parent link="{n}_thigh"/><child link="{n}_foot"/><origin xyz="0 0 -0.3"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="{n}_end" type="fixed"><parent link="{n}_foot"/><child link="{n}_sole"/><origin xyz="0 0 -0.3"/></joint>
"""
"""A leg whose mass is a point at its end: where it is stretched, its joints can turn so that no mass moves."""

URDF = """<robot name="stilts">
  <link name="base"><inertial><mass value="20"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
{legs}</robot>
"""
PLACES = {"LF": (0.3, 0.3), "RF": (0.3, -0.3), "LH": (-0.3, 0.3), "RH": (-0.3, -0.3)}
BENT = 0.6
"""Angle of the thigh in rad; the knee bends twice as much to the other side, so that the foot is below the hip."""


def stepping(bent=BENT):
    """A machine that stands on bent legs and lifts the left front one again and again."""
    for (_, sample), k in zip(trot(RATE, 1000.0), count(), strict=False):
        phase = k / RATE % 0.6
        # Up and down with a corner at the ground, so that the foot lands with a speed.
        lifted = max(0.0, 0.3 - abs(phase - 0.3) - 0.1) * 0.8
        hips = [bent + (lifted if name == "LF" else 0.0) for name in FEET]
        names = tuple(f"{name}_{joint}" for name in FEET for joint in ("hip", "knee"))
        positions = tuple(angle for hip in hips for angle in (hip, -2.0 * hip))
        stands = sample._replace(position=(0.0, 0.0, 0.6 * cos(bent)), linear=(0.0, 0.0, 0.0))
        yield [("joint_states", Joints(sample.stamp, names, positions, ())), ("odom", stands)]


@pytest.mark.slow
@pytest.mark.extras
@pytest.mark.skipif(importlib.util.find_spec("pinocchio") is None, reason="needs the extra `articulated`")
def test_joints_of_another_machine_or_without_an_inverse_inertia_or_too_many_are_named_and_the_node_goes_on(
    peer, tmp_path
):
    urdf = tmp_path / "stilts.urdf"
    legs = "".join(LEG.format(n=name, x=x, y=y) for name, (x, y) in PLACES.items())
    urdf.write_text(URDF.format(legs=legs))
    frames = [f"{name}_sole" for name in FEET]

    def other_names(message):
        return message._replace(names=("elsewhere", *message.names[1:])) if isinstance(message, Joints) else message

    def with_arm(message):
        if isinstance(message, Joints):
            return message._replace(names=("arm", *message.names), positions=(1.0, *message.positions))
        return message

    def stretched(message):
        return message._replace(positions=(0.0,) * 8) if isinstance(message, Joints) else message

    arguments = ("-p", f"robot.urdf:={urdf}", "-p", f"robot.frames:={frames}")
    with running_node(SCENE, *arguments) as node:
        machine = Machine(peer, {"joint_states": JOINT_STATE, "odom": ODOMETRY}, stepping())
        assert not peer.node.count_subscribers("/contact_geometry")
        walk_until(peer, machine, predicts(peer))
        for spoil, reason in ((other_names, "WRONG_JOINTS"), (stretched, "SINGULAR_INERTIA")):
            walk_until(peer, machine, lambda reason=reason: peer.reported(f"refused.joint_states.{reason}"), spoil)
            assert peer.report().level > OK
            walk_until(peer, machine, predicts(peer))
            walk_until(peer, machine, lambda: peer.report().level == OK)
        assert peer.reported("feet.joints_left_out") is None
        walk_until(peer, machine, lambda: peer.reported("feet.joints_left_out") == "arm", with_arm)
        walk_until(peer, machine, predicts(peer), with_arm)
        assert peer.report().level == OK
        assert "Traceback" not in node.complained()
