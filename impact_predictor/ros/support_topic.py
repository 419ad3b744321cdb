"""The topic of a moving support: its pose and twist, or the measurements of a sensor on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.node import Node

from ..prediction.inputs import IMU as SENSOR
from ..prediction.types import Status
from .endpoints import subscription
from .messages import IMU, ODOMETRY, MalformedMessage, decode_odometry
from .reporter import Reporter

if TYPE_CHECKING:
    from ..prediction.monitor import Monitor


class SupportTopic:
    """Takes what is told about the support and hands it to the monitor."""

    def __init__(self, node: Node, reporter: Reporter, monitor: Monitor, topic: str, kind: str) -> None:
        self._name = topic
        self._reporter = reporter
        self._deck = monitor.deck
        self._decode: Any = decode_odometry
        self._update: Any = monitor.update_support
        if kind == SENSOR:
            from .messages.imu import decode_imu

            self._decode, self._update = decode_imu, monitor.update_support_imu
        type_name = IMU if kind == SENSOR else ODOMETRY
        self.input = subscription(node, self._name, type_name, self._take, reporter.on_lost)

    def _take(self, data: bytes) -> None:
        try:
            message = self._decode(data)
        except MalformedMessage:
            self._reporter.refuse(self._name, Status.MALFORMED)
            return
        status = self._update(message)
        markers, deck = self._reporter.markers, self._deck
        drawing = markers.drawing if status is Status.ACCEPTED else None
        if drawing is not None and deck is not None and deck.last is not None:
            drawing.take_support(deck.last)
            markers.show(message.stamp)
        self._reporter.took(self._name, status, message.stamp)
