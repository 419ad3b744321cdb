"""The node beside what publishes /tf and /tf_static, over real DDS."""

from math import cos, sin

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")
pytest.importorskip("tf2_msgs", reason="transforms need the ROS package tf2_msgs, which PyPI does not have")

from elsewhere import bag_of
from geometry_msgs.msg import TransformStamped
from graph import served_and_replayed
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from recordings import first_messages, write_bag
from test_node import EVERY_SAMPLE, FIXED_POINTS, POINTS, RELIABLE, SCENE, odometry, running
from tf2_msgs.msg import TFMessage

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.ros.messages import decode_diagnostic_array, decode_odometry

STATIC = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def transform(parent, child, z, k=0):
    """A frame above its parent; of a sample k where it moves."""
    link = TransformStamped(child_frame_id=child)
    link.header.stamp, link.header.frame_id = odometry(k).header.stamp, parent
    link.transform.translation.z = z
    return TFMessage(transforms=[link])


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_samples_of_other_frames_wait_for_transforms_and_are_answered_in_the_frames_of_the_scene(peer, executor):
    asked = (
        "-p",
        "tf.body_frame:=cube",
        "-p",
        "odom.twist:=message",
        "-p",
        f"executor:={executor}",
        "-r",
        "__ns:=/robot",
        "-r",
        "odom:=/odom",
    )
    outputs = [part for name in ("post_impact", "prediction") for part in ("-r", f"~/{name}:=/impact_predictor/{name}")]
    # Other nodes in the graph know other fixed frames; each publishes what it knows once, before this node is there.
    for k in range(12):
        peer.publisher(TFMessage, "/tf_static", STATIC).publish(transform("cube", f"camera_{k}", 0.1))
    with running(*FIXED_POINTS, *EVERY_SAMPLE, *asked, *outputs) as node:
        samples = peer.connected(peer.publisher(Odometry, "/odom", RELIABLE))

        def tell(k, frame="map", child="camera_7"):
            sample = odometry(k, frame)
            sample.child_frame_id = child
            samples.publish(sample)

        stamps = iter(range(1, 10_000))
        said = "no transforms on /tf and /tf_static connect 'map' and 'world'"
        peer.until(lambda: said in node.complained(), lambda: tell(next(stamps)))
        assert not peer.heard["prediction"]
        peer.publisher(TFMessage, "/tf_static", STATIC).publish(transform("map", "world", 0.3))
        peer.until(lambda: peer.heard["post_impact"] and peer.heard["prediction"], lambda: tell(next(stamps)))
        told = decode_odometry(peer.heard["post_impact"][0])
        assert (told.frame_id, told.child_frame_id) == ("world", "cube")
        (first, *_) = decode_diagnostic_array(peer.heard["prediction"][0])
        assert first.hardware_id == "cube"
        # The camera is 0.1 m above the middle of the cube, which is tilted by 0.4 rad and does not turn.
        there = decode_odometry(serialize_message(odometry(1)))._replace(
            position=(-0.1 * sin(0.4), 0.0, 0.5 - 0.3 - 0.1 * cos(0.4))
        )
        given = {
            **read_parameters(SCENE),
            "body.contact_points": [x for point in POINTS for x in point],
            "odom.twist": "message",
        }
        touchdown = Predictor(Scene.from_parameters(validate(given))).update(there).touchdown
        assert float(first.values["lead_time"]) == pytest.approx(touchdown.lead_time)
        frames = peer.publisher(TFMessage, "/tf", RELIABLE)
        peer.connected(frames)
        count = len(peer.heard["prediction"])
        for k in (20_001, 20_002):
            frames.publish(transform("cube", "head", 0.1, k))
        peer.until(lambda: len(peer.heard["prediction"]) > count, lambda: tell(20_002, child="head"))


@pytest.mark.slow
@pytest.mark.parametrize("creeps", [False, True], ids=["fixed", "creeping"])
def test_the_node_brings_messages_to_the_frames_of_the_scene_as_the_replay_does_byte_for_byte(tmp_path, creeps):
    whole = bag_of(tmp_path / "whole.mcap", first_messages(80), creeps)
    types = topics(whole)
    named = {topic: "/odom" if topic.endswith("odom") else topic for topic in types}
    told = [one._replace(topic=named[one.topic]) for one in read_messages(whole, types)]
    bag = write_bag(tmp_path / "bag.mcap", told, {named[topic]: kind for topic, kind in types.items()})
    given = {**read_parameters(SCENE), "body.contact_points": [x for point in POINTS for x in point]}
    values = validate({**given, "tf.body_frame": "cube"})
    heard, replayed, read = served_and_replayed(values, bag, tmp_path / "out.mcap")
    assert {"/tf", "/tf_static", "/odom"} <= read
    assert len(replayed["/impact_predictor/prediction"]) == 79
    assert heard == replayed
