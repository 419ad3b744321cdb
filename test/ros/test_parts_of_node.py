"""What a scene leaves out is neither loaded by the node nor subscribed to, and what it has is."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from impact_predictor.parameter_file import read_values
from impact_predictor.parameters import validate
from impact_predictor.prediction.parts import ladder, modules_of
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Sample
from impact_predictor.report.parts.record import made
from impact_predictor.report.parts.start import arguments_of
from impact_predictor.ros.messages import encode_odometry, encode_polygon

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

ROOT = Path(__file__).parents[2]
BOX = {
    "body.mass": 12.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.4,
    "body.contact_points": [x for a in (-0.3, 0.3) for b in (-0.2, 0.2) for x in (a, b, -0.2)],
}
SCENES: dict[str, Any] = {
    **{path.stem: read_values(path) for path in sorted((ROOT / "config").glob("*.yaml"))},
    "nothing": ladder(validate(BOX))[0][1],
    "everything": ladder(validate(BOX))[-1][1],
    "events": validate({**BOX, "executor": "events"}),
}

# The node, with somebody who publishes to it and one who reads what it publishes.
SERVE = """
import pickle, sys, time
messages = pickle.load(sys.stdin.buffer)
import impact_predictor.ros.node
import rclpy
rclpy.init(args=sys.argv)
from rclpy.node import Node
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, POLYGON
from impact_predictor.ros.predictor_node import PredictorNode
from impact_predictor.ros.process import executor_of, message_class
node, other = PredictorNode(), Node("other", use_global_arguments=False)
runner, _ = executor_of(node, node.executor_kind)
runner.add_node(node)
inputs = {kind: other.create_publisher(message_class(kind), topic, 100)
          for kind, topic in ((ODOMETRY, "odom"), (POLYGON, "contact_geometry"))}
prediction = "/impact_predictor/prediction"
reader = other.create_subscription(message_class(DIAGNOSTIC_ARRAY), prediction, print, 100, raw=True)
patience = time.monotonic() + 20.0
def until(true):
    while not true():
        assert time.monotonic() < patience
        runner.spin_once(timeout_sec=0.05)
until(lambda: inputs[ODOMETRY].get_subscription_count() and node.count_subscribers(prediction))
topics = {one.topic_name for one in node.subscriptions}
for kind, data in messages:
    if kind == POLYGON:
        if "/contact_geometry" in topics and not node._predictor._points:
            inputs[kind].publish(data)
            until(lambda: node._predictor._points)
        continue
    served = node.served()
    inputs[kind].publish(data)
    until(lambda: node.served() > served)
print("TOPICS", *topics)
print("MODULES", *sys.modules)
sys.stdout.flush()
import os; os._exit(0)
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_the_node_loads_the_core_and_the_parts_of_its_scene_and_nothing_else(name: str) -> None:
    values = SCENES[name]
    record = made(Scene.from_parameters(values))
    messages = [
        ("nav_msgs/msg/Odometry", encode_odometry(message))
        if isinstance(message, Sample)
        else ("geometry_msgs/msg/PolygonStamped", encode_polygon(message))
        for message in record.messages[:60]
    ]
    done = subprocess.run(
        [sys.executable, "-c", SERVE, *arguments_of(values)],
        input=pickle.dumps(messages),
        capture_output=True,
        cwd=ROOT,
        timeout=90.0,  # numba may have to compile
    )
    assert done.returncode == 0, done.stderr.decode()
    found = {line.split()[0]: set(line.split()[1:]) for line in done.stdout.decode().splitlines() if line}
    modules = {name.removeprefix("impact_predictor.") for name in found["MODULES"]}
    rooms = {name for name in modules if name.split(".")[0] in ("mechanics", "prediction", "ros")}
    assert rooms == modules_of(values, node=True)
    unwanted = {"click", "matplotlib", "rich", "rosbags", "ruamel", "scipy", "statistics"}
    assert not (unwanted if not values["uncertainty.samples"] else unwanted - {"statistics", "scipy"}) & modules
    assert ("numba" in modules) <= bool(values["uncertainty.samples"])
    assert ("/contact_geometry" in found["TOPICS"]) == (not values["body.contact_points"])
    assert "/odom" in found["TOPICS"]
