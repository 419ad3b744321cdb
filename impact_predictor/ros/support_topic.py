"""The topic of a moving support: its pose and twist, or the measurements of a sensor on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.node import Node

from ..prediction.inputs import IMU as SENSOR
from .endpoints import subscription
from .input_topic import InputTopic
from .messages import IMU, ODOMETRY, decode_odometry
from .reporter import Reporter

if TYPE_CHECKING:
    from ..prediction.monitor import Monitor
    from .markers.scene import MarkerScene


def listen_to_support(node: Node, reporter: Reporter, monitor: Monitor, topic: str, kind: str) -> Any:
    """Take what is told about the support on a topic; its subscription."""
    type_name = ODOMETRY
    decode: Any = decode_odometry
    update: Any = monitor.update_support
    if kind == SENSOR:
        from .messages import decode_imu

        type_name, decode, update = IMU, decode_imu, monitor.update_support_imu

    def draw(drawing: MarkerScene, _: object) -> None:
        if monitor.deck is not None and monitor.deck.last is not None:
            drawing.take_support(monitor.deck.last)

    return subscription(
        node, topic, type_name, InputTopic(reporter, topic, decode, update, draw).take, reporter.on_lost
    )
