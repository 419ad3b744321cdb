"""The node of Solo12 and its controller."""

from __future__ import annotations

import json
import time
from typing import Any, Final

from controller import FEET, TICK, Gains, Landing, Measured, Trot
from experiment import GAINS, SPEED, TICKS, trial
from robot import Robot
from sources import geometry_of, sample_of

from impact_predictor.ros.endpoints import publisher, subscription
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    ODOMETRY,
    POLYGON,
    decode_diagnostic_array,
    encode_odometry,
    encode_polygon,
)
from impact_predictor.ros.process import Stop, spin

PAUSE: Final = 1.0
"""Seconds after the end of a walk; longer than what the predictor takes for one record."""
KEYS: Final = ("lead_time", "gap", "approach")


class Heard:
    """What the predictor has told over its topic: a few ticks old, and its times counted down."""

    senses = True

    def __init__(self) -> None:
        self._told: dict[str, tuple[float, Landing]] = {}
        self.told = self.used = 0

    def take(self, data: bytes) -> None:
        """Take a message of ~/prediction."""
        self.told += 1
        now = time.monotonic()
        for foot in decode_diagnostic_array(data)[1:]:
            self._told.pop(foot.hardware_id, None)
            if "lead_time" in foot.values:
                self._told[foot.hardware_id] = now, Landing(*(float(foot.values[key]) for key in KEYS))

    def tell(self, measured: Measured, planned: Landing) -> list[Landing | None]:
        """The landings of the feet, as they were told last."""
        now, landings = time.monotonic(), []
        for foot in FEET:
            when, told = self._told.get(foot, (now, None))
            landings.append(None if told is None else told._replace(time=told.time - (now - when)))
        self.used += any(landings)
        return landings


class WalkerNode:
    """Walks in real time, and says how it went."""

    def __init__(self, node: Any) -> None:
        self._node = node
        self._trial = trial(node.declare_parameter("seed", 1).value)
        self._gains = Gains(**json.loads(GAINS.read_text(encoding="utf-8"))["predictor"]["gains"])
        self.heard = Heard()
        self._feet, self._odom = publisher(node, "contact_geometry", POLYGON), publisher(node, "odom", ODOMETRY)
        subscription(node, "/impact_predictor/prediction", DIAGNOSTIC_ARRAY, self.heard.take, None)
        self._begin()
        node.create_timer(TICK, self._tick)
        node.create_timer(2.0, self.report)

    def _begin(self) -> None:
        self._robot = Robot(self._trial)
        self._trot = Trot(self._robot.mass, SPEED, self._gains, self.heard)
        self._offset, self._ended = time.time_ns(), 0.0

    def _tick(self) -> None:
        robot = self._robot
        if self._ended:
            if time.monotonic() - self._ended > PAUSE:
                self._begin()
            return
        measured = robot.measure()
        geometry, sample = geometry_of(measured), sample_of(measured)
        self._feet.publish(encode_polygon(geometry._replace(stamp=geometry.stamp + self._offset)))
        self._odom.publish(encode_odometry(sample._replace(stamp=sample.stamp + self._offset)))
        robot.tick(self._trot.commands(measured))
        if robot.fallen or robot.ticks >= TICKS:
            self._ended = time.monotonic()
            self.report()

    def report(self) -> None:
        """Say how far the walk has come."""
        robot = self._robot
        how = "fell" if robot.fallen else "walks" if robot.ticks < TICKS else "arrived"
        self._node.get_logger().info(
            f"{how}: {robot.data.qpos[0]:.2f} m in {robot.ticks * TICK:.1f} s, "
            f"{self.heard.used} ticks with a landing told by the predictor"
        )


def walk(stop: Stop) -> int:
    """Walk until it is to stop; the exit status."""
    from rclpy.node import Node

    node = Node("walker")
    walker = WalkerNode(node)
    try:
        spin(node, stop, lambda: walker.heard.told)
    finally:
        walker.report()
        node.destroy_node()
    return 0
