"""The topics of the support and of each body, and what becomes of their messages."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import Any, Final

from rclpy.duration import Duration
from rclpy.node import Node

from ..prediction.monitor import Monitor
from ..prediction.scene import CONTACT_GEOMETRY, IMU, ODOM, SCHEDULE
from ..prediction.types import Geometry, Imu, Prediction, Sample, Score, Status
from .endpoints import LONGEST, Backlog, LatchedTopic, Outlet, publisher, subscription
from .messages import INPUT_TYPES, ODOMETRY, OUTPUTS, MalformedMessage, decode_odometry
from .reporter import Reporter

LAST_WORDS: Final = Duration(seconds=1)
"""How long the node waits at its end until its last score is received."""


class InputTopic:
    """Decodes the messages on a topic, hands them over and tells the reporter what became of them.

    `update` hands a message to the monitor, and `accepted` takes one that the monitor has accepted.
    """

    def __init__(
        self,
        reporter: Reporter,
        name: str,
        kind: str,
        update: Callable[[Any], Status],
        accepted: Callable[[Any], None] | None = None,
    ) -> None:
        self._reporter, self._name, self._update, self._accepted = reporter, name, update, accepted
        self._decode = INPUT_TYPES[kind].decode

    def take(self, data: bytes) -> None:
        """A message, as bytes."""
        try:
            message = self._decode(data)
        except MalformedMessage:
            self._reporter.refuse(self._name, Status.MALFORMED)
            return
        status = self._update(message)
        if self._accepted is not None and status is Status.ACCEPTED:
            self._accepted(message)
        self._reporter.took(self._name, status, message.stamp)


def listen_to_support(node: Node, reporter: Reporter, monitor: Monitor, topic: str, kind: str) -> Any:
    """Take the pose and twist of the support on a topic, or what a sensor on it measures; its subscription."""

    def draw(message: Sample | Imu) -> None:
        drawing = reporter.markers.drawing
        if drawing is not None and monitor.deck is not None and monitor.deck.last is not None:
            drawing.take_support(monitor.deck.last)
            reporter.markers.show(message.stamp)

    update: Any = monitor.update_support_imu if kind == IMU else monitor.update_support
    one = InputTopic(reporter, topic, kind, update, draw)
    return subscription(node, topic, INPUT_TYPES[kind].name, one.take, reporter.on_lost)


class BodyTopics:
    """Takes the messages about one body, and publishes what the monitor makes of it.

    A body without a name has the topics `odom` and `~/mode`, another one `crate/odom` and `~/crate/mode`.
    """

    def __init__(self, node: Node, reporter: Reporter, monitor: Monitor, body: str, of_support: list[Any]) -> None:
        """Have no topic yet; `of_support` are the subscriptions that tell of the support, made before the first."""
        self.outputs: dict[str, Any] = {}
        self._node, self._reporter, self._monitor, self._body = node, reporter, monitor, body
        self._latched: LatchedTopic | None = None
        self._of_support, self._others = of_support, list[Any]()
        self._last_sample: Sample | None = None

    def listen(self, topic: str, kind: str) -> Any:
        """Take messages of a kind from a topic; its subscription where they are to keep coming, else None."""
        if kind == ODOM:
            return self._listen_to_odom(topic)
        monitor, body = self._monitor, self._body
        update: Callable[[Any], Status] = partial(monitor.tell, body)
        accepted: Callable[[Any], None] | None = None
        is_fixed = monitor.scenes[body].walking is None
        if kind == IMU:
            update, accepted = partial(monitor.update_imu, body), self._draw_tilt
        elif kind == CONTACT_GEOMETRY:
            accepted = self._draw_points if is_fixed else None
        one = InputTopic(self._reporter, topic, kind, update, accepted)
        type_name = INPUT_TYPES[kind].name
        # Feet move, and what was published of them before is of no use.
        if kind == SCHEDULE or (kind == CONTACT_GEOMETRY and is_fixed):
            self._latched = LatchedTopic(self._node, one.take, topic, type_name)
            return None
        found = subscription(self._node, topic, type_name, one.take, self._reporter.on_lost)
        if kind != IMU:
            self._others.append(found)
        return found

    def _draw_points(self, geometry: Geometry) -> None:
        self._reporter.markers.set_geometry(self._body, geometry)

    def _draw_tilt(self, imu: Imu) -> None:
        markers = self._reporter.markers
        if markers.drawing is not None:
            markers.drawing.take_tilt(self._body, imu.stamp, self._monitor.tilts[self._body])
            markers.show(imu.stamp)

    def _listen_to_odom(self, topic: str) -> Any:
        """Take the state from a topic, and publish the answers; its subscription."""
        self._name = topic
        self._update = self._monitor.predictors[self._body].update
        if self._monitor.watch is not None:
            self._update = partial(self._monitor.update, self._body)
        samples = subscription(self._node, topic, ODOMETRY, self._on_odometry, self._reporter.on_lost)
        others, longest = self._of_support + self._others, LONGEST / len(self._monitor.predictors)
        self._backlog = Backlog(samples, others, self._answer, longest)
        prefix = f"~/{self._body}/" if self._body else "~/"
        self.outputs = {name: publisher(self._node, prefix + name, one.type_name) for name, one in OUTPUTS.items()}
        self._encoders = [(Outlet(self.outputs[name]), output.encode) for name, output in OUTPUTS.items()]
        return samples

    def look_for_history(self) -> None:
        """Ask for contact points, or a plan, that were published before, if there may be any."""
        if self._latched is not None:
            self._latched.look_for_history()

    def _on_odometry(self, data: bytes) -> None:
        if dropped := self._backlog.take(data):
            self._reporter.diagnostics.dropped(dropped)

    def _answer(self, data: bytes) -> None:
        began = perf_counter()
        try:
            sample = decode_odometry(data)
        except MalformedMessage:
            self._reporter.refuse(self._name, Status.MALFORMED)
            return
        latency = time.time_ns() - sample.stamp
        decoded = perf_counter()
        prediction = self._update(sample)
        update = perf_counter() - decoded
        if prediction.status is not Status.ACCEPTED:
            if prediction.status is Status.NO_GEOMETRY:
                self.look_for_history()
            self._reporter.refuse(self._name, prediction.status)
            return
        self._last_sample = sample
        for outlet, encode in self._encoders:
            _publish(outlet, encode, prediction)
        self._reporter.answered(self._name, self._body, prediction, latency, update, began)

    def publish_scores(self, scores: tuple[Score, ...]) -> None:
        """Publish the scores that the end of the record settles, and see them received."""
        if self._last_sample is None or not scores:
            return
        outlet = Outlet(self.outputs["score"])
        for score in scores:
            prediction = Prediction(Status.ACCEPTED, self._last_sample, None, score)
            _publish(outlet, OUTPUTS["score"].encode, prediction)
        self.outputs["score"].wait_for_all_acked(LAST_WORDS)


def _publish(outlet: Outlet, encode: Callable[[Prediction], bytes | None], prediction: Prediction) -> None:
    """Publish what there is to say, unless nobody listens: then it is not even encoded."""
    if outlet.listeners():
        data = encode(prediction)
        if data is not None:
            outlet.send(data)
