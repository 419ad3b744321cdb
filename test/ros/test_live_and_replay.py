"""The promise that a bag gives what the topics gave."""

import importlib.util
import os
import time
from pathlib import Path

import pytest

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.bags.write import BagWriter
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Leftover
from impact_predictor.ros.messages import OUTPUTS, POLYGON, decode_odometry, decode_polygon
from impact_predictor.ros.player import PLAYED, timed
from impact_predictor.ros.processes import Child

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "config/cube_tosses.yaml"
BAG = ROOT / "examples/cube_tosses"
LOSSLESS = ("-p", "qos_overrides./odom.subscription.reliability:=reliable")
PATIENCE = 60.0

needs_ros = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None,
    reason="live topics need ROS 2: source it, or install the extra `ros`",
)


def program(name, *arguments):
    return Child(name, dict(os.environ), "-m", f"impact_predictor.ros.{name}", *arguments)


def wait(until, *running):
    patience = time.monotonic() + PATIENCE
    while not until():
        for child in running:
            child.check()
        assert time.monotonic() < patience, [child.complained() for child in running]
        time.sleep(0.05)


def excerpt(path):
    """Three tosses, cut off right after a touchdown, so that its score comes from the end of the record."""
    types = topics(BAG)
    messages = [message for _, message in timed(read_messages(BAG, types), 3)]
    predictor = Predictor(scene())
    last_score = 0
    for k, message in enumerate(messages):
        if types[message.topic] == POLYGON:
            predictor.tell(decode_polygon(message.data))
        elif predictor.update(decode_odometry(message.data)).score is not None:
            last_score = k
    with BagWriter(path) as writer:
        for message in messages[: last_score - 1]:
            writer.write(message.topic, types[message.topic], message.log_time, message.data)


def scene(**more):
    return Scene.from_parameters(validate({**read_parameters(SCENE), **more}))


@needs_ros
@pytest.mark.slow
@pytest.mark.parametrize(
    ("executor", "more"),
    [
        ("single", {}),
        ("events", {}),
        ("single", {"uncertainty.samples": 32, "uncertainty.friction": 0.02, "margins": True}),
    ],
)
def test_live_topics_give_what_the_replay_of_the_bag_gives_byte_for_byte(tmp_path, executor, more):
    excerpt(tmp_path / "excerpt.mcap")
    replayed = replay(tmp_path / "excerpt.mcap", scene(**more), output=tmp_path / "replayed.mcap")
    assert Leftover.TOO_SHORT in replayed.settled[-1].score.leftover
    remapping = ("--ros-args", "-r", "/cube/odom:=/odom", "-r", "/cube/contact_geometry:=/contact_geometry")
    asked = [part for name, value in {"executor": executor, **more}.items() for part in ("-p", f"{name}:={value}")]
    arguments = ("--ros-args", "--params-file", str(SCENE), "-p", "messages:=strings", *asked, *LOSSLESS)
    played = (str(tmp_path / "excerpt.mcap"), "--record", str(tmp_path / "live.mcap"), *remapping)
    offline = recorded(tmp_path / "replayed.mcap")
    from graph import peer_of_node

    with peer_of_node() as peer, program("player", *played) as player, program("node", *arguments) as node:
        wait(lambda: PLAYED in player.said(), player, node)
        # The player waits for the node and not for the peer, which hears the node's reports whenever it finds them.
        samples = str(len(offline["mode"]))
        peer.until_reported(lambda report: report.values.get("samples.accepted") == samples)
        node.end()
        player.end()
    assert all(offline.values())
    assert recorded(tmp_path / "live.mcap") == offline


def recorded(path):
    """The bytes that a bag has of each output."""
    heard = {name: [] for name in OUTPUTS}
    types = {f"/impact_predictor/{name}": output.type_name for name, output in OUTPUTS.items()}
    for message in read_messages(path, types):
        heard[message.topic.rpartition("/")[2]].append(message.data)
    return heard
