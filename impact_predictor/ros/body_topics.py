"""The topics of one body, and what becomes of its messages."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

from rclpy.duration import Duration
from rclpy.node import Node

from ..prediction.inputs import IMU as SENSOR
from ..prediction.inputs import ODOM, SCHEDULE
from ..prediction.types import Imu, Prediction, Sample, Score, Status
from .backlog import LONGEST, Backlog
from .endpoints import Outlet, publisher, subscription
from .input_topic import InputTopic
from .messages import IMU, ODOMETRY, OUTPUTS, POLYGON, MalformedMessage, decode_odometry, decode_polygon
from .reporter import Reporter

if TYPE_CHECKING:
    from ..prediction.monitor import Monitor
    from .latched_topic import LatchedTopic
    from .markers.scene import MarkerScene

LAST_WORDS: Final = Duration(seconds=1)
"""How long the node waits at its end until its last score is received."""


class BodyTopics:
    """Takes what is told about one body, and publishes what the monitor makes of it.

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
        if kind == SENSOR:
            return self._listen_to_imu(topic)
        if self._monitor.scenes[self._body].walking is None:
            return self._listen_to_geometry(topic)
        from .feet_topics import listen_to_feet, listen_to_schedule

        about = self._node, self._reporter, self._monitor, self._body, topic
        if kind == SCHEDULE:
            self._latched = listen_to_schedule(*about)
            return None
        self._others.append(listen_to_feet(*about, kind))
        return self._others[-1]

    def _listen_to_geometry(self, topic: str) -> None:
        from .latched_topic import LatchedTopic

        self._geometry_name = topic
        self._latched = LatchedTopic(self._node, self._on_geometry, topic, POLYGON)

    def _listen_to_imu(self, topic: str) -> Any:
        from .messages import decode_imu

        def draw(drawing: MarkerScene, imu: Imu) -> None:
            drawing.take_tilt(self._body, imu.stamp, self._monitor.tilts[self._body])

        update = partial(self._monitor.update_imu, self._body)
        one = InputTopic(self._reporter, topic, decode_imu, update, draw)
        return subscription(self._node, topic, IMU, one.take, self._reporter.on_lost)

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

    def _on_geometry(self, data: bytes) -> None:
        status = Status.MALFORMED
        with suppress(MalformedMessage):
            geometry = decode_polygon(data)
            status = self._monitor.set_geometry(self._body, geometry)
        if status is Status.ACCEPTED:
            self._reporter.markers.set_geometry(self._body, geometry)
        else:
            self._reporter.refuse(self._geometry_name, status)

    def _on_odometry(self, data: bytes) -> None:
        if dropped := self._backlog.take(data):
            self._reporter.dropped(dropped)

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
        if prediction.score is not None:
            self._reporter.settled(sample.child_frame_id, prediction.score)
        if prediction.feet:
            self._reporter.walked(self._body, prediction)
        markers = self._reporter.markers
        if markers.drawing is not None:
            markers.drawing.take(self._body, prediction)
            markers.show(sample.stamp)
        self._reporter.answered(self._name, sample.stamp, latency, update, began)

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
