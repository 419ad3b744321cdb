"""The biped and its controller as a ROS 2 node at 500 Hz, with the predictor in the loop over topics.

    python3 examples/walker_controller/node.py --ros-args -p seed:=1
    predictor --ros-args --params-file config/walker.yaml

It publishes `odom` and `contact_geometry`, and listens to `/impact_predictor/post_impact` and `/impact_predictor/mode`
(remap them for a predictor of another name). A walk that has ended begins anew after a pause. Parameters: `seed` of the
walk, `slope` and `friction` of its ground, `predict`: whether to listen.
"""

from __future__ import annotations

import json
import random
import sys
import time
from pathlib import Path
from typing import Any, Final

from controller import Controller, Feedback, FeedbackGains, Predictive, PredictiveGains
from machine import PERIOD, RATE, Ground, Walk
from sensors import geometry_of, sample_of
from values import Announcement, Estimate, Machine

from impact_predictor.ros.endpoints import publisher, subscription
from impact_predictor.ros.messages import ODOMETRY, POLYGON, UINT8, decode_odometry, encode_odometry, encode_polygon
from impact_predictor.ros.process import Stop, run, spin

SLABS: Final = 20_000
PAUSE: Final = 1.0
"""Seconds after the end of a walk; longer than what the predictor takes for one record."""


class WalkerNode:
    """Walks in real time, and says how it went."""

    def __init__(self, node: Any) -> None:
        self._node = node
        given = {"seed": 0, "slope": 0.03, "friction": 0.45, "predict": True}
        seed, slope, friction, predicts = (node.declare_parameter(name, value).value for name, value in given.items())
        heights = random.Random(seed)
        self._ground = Ground(slope, friction, tuple(heights.uniform(-0.003, 0.003) for _ in range(SLABS)))
        self._estimate, self._predicts = Estimate(slope, friction), predicts
        self._odom = publisher(node, "odom", ODOMETRY)
        self._feet = publisher(node, "contact_geometry", POLYGON)
        self._mode = 0
        self._ahead: Announcement | None = None
        self.announced = self.served = 0
        if predicts:
            subscription(node, "/impact_predictor/mode", UINT8, self._on_mode, None)
            subscription(node, "/impact_predictor/post_impact", ODOMETRY, self._on_post_impact, None)
        self._begin()
        node.create_timer(PERIOD, self._tick)
        node.create_timer(2.0, self.report)

    def _begin(self) -> None:
        gains = json.loads(Path(__file__).with_name("gains.json").read_text())
        machine = Machine()
        self._walk = Walk(machine, self._ground)
        self._controller: Controller
        if self._predicts:
            self._controller = Predictive(machine, self._estimate, PredictiveGains(**gains["predictive"]["gains"]))
        else:
            self._controller = Feedback(machine, self._estimate, FeedbackGains(**gains["informed"]["gains"]))
        self._offset = time.time_ns()
        self._ended: int | None = None

    def _on_mode(self, data: bytes) -> None:
        self.served += 1
        self._mode = data[4]
        if self._mode == 0:
            self._ahead = None

    def _on_post_impact(self, data: bytes) -> None:
        self.served += 1
        self.announced += 1
        sample = decode_odometry(data)
        self._ahead = Announcement(sample.stamp - self._offset, self._mode, sample.angular[1])

    def _tick(self) -> None:
        walk = self._walk
        now = time.time_ns()
        if self._ended is not None:
            if now - self._ended > PAUSE * 1e9:
                self._begin()
            return
        command = self._controller.command(walk.seen, self._ahead)
        geometry, sample = geometry_of(walk), sample_of(walk)
        self._feet.publish(encode_polygon(geometry._replace(stamp=geometry.stamp + self._offset)))
        self._odom.publish(encode_odometry(sample._replace(stamp=sample.stamp + self._offset)))
        walk.tick(command)
        if walk.failure is not None:
            self._ended = now
            self.report()

    def report(self) -> None:
        """Say how far the walk has come."""
        walk = self._walk
        how = f"ended by a {walk.failure.value}" if walk.failure else "walks"
        self._node.get_logger().info(
            f"{how}: {walk.steps} steps, {walk.x:.2f} m in {walk.ticks / RATE:.1f} s, "
            f"{self.announced} announcements of the predictor"
        )


def main(args: list[str] | None = None) -> int:
    """Walk until SIGINT or SIGTERM; the exit status."""
    return run(_serve, args)


def _serve(stop: Stop) -> int:
    from rclpy.node import Node

    node = Node("walker")
    walker = WalkerNode(node)
    try:
        spin(node, stop, lambda: walker.served)
    finally:
        walker.report()
        node.destroy_node()
    return 0


if __name__ == "__main__":
    sys.exit(main())
