"""The ROS side of the predictor: its topics, and what becomes of each message."""

from __future__ import annotations

import time
from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from ..errors import InputError
from ..prediction.predictor import Predictor
from ..prediction.scene import Scene
from ..prediction.types import Prediction, Sample, Status
from .diagnostics import Diagnostics, Refused
from .messages import (
    DIAGNOSTIC_ARRAY,
    ODOMETRY,
    OUTPUTS,
    MalformedMessage,
    decode_odometry,
    decode_polygon,
)
from .node_parameters import check_qos_overrides, declare_parameters
from .process import message_class, sentence
from .qos import misfits

if TYPE_CHECKING:
    from .geometry_topic import GeometryTopic

QUEUE: Final = 100
"""Messages that may wait: a tenth of a second at 1 kHz, which is longer than Python pauses."""

LAST_WORDS: Final = Duration(seconds=1)
"""How long the node waits at its end until its last score is received."""


class PredictorNode(Node):
    """Translates between topics and the predictor."""

    def __init__(self) -> None:
        """Take parameters and topics as the arguments of the process say.

        Raises:
            InputError: a parameter is wrong.
        """
        try:
            self._join()
            values = declare_parameters(self)
            self.executor_kind = str(values["executor"])
            self._connect(Scene.from_parameters(values))
        except InputError:
            raise
        # What rclpy raises for a name, a parameter or a QoS override that it cannot take.
        except (RuntimeError, ValueError, TypeError, AssertionError, ParameterException) as error:
            raise InputError(f"ROS refuses to make the node: {sentence(error)}") from error

    def _join(self) -> None:
        try:
            super().__init__("impact_predictor", automatically_declare_parameters_from_overrides=True)
        except ValueError as error:
            if "PARAMETER_NOT_SET" in str(error):
                raise InputError("a parameter is given as [], which ROS reads as no value; leave it out") from error
            raise

    def _connect(self, scene: Scene) -> None:
        if scene.samples:
            self.get_logger().info("preparing the uncertainty samples; numba compiles once for a machine, about 15 s")
        self._predictor = Predictor(scene)
        self._diagnostics = Diagnostics(self.get_fully_qualified_name().lstrip("/"), perf_counter())
        self._last_sample: Sample | None = None
        self._outputs = {name: self._publisher(f"~/{name}", output.type_name) for name, output in OUTPUTS.items()}
        self._encoders = [(self._outputs[name], output.encode) for name, output in OUTPUTS.items()]
        self._reports = self._publisher("/diagnostics", DIAGNOSTIC_ARRAY)
        # Made before that of the samples, it is served first when messages wait on both.
        self._geometry = None if scene.points else self._geometry_topic()
        # Best effort matches every publisher; a sample that is sent again would come too late.
        self._samples = self.create_subscription(
            message_class(ODOMETRY),
            "odom",
            self._on_odometry,
            QoSProfile(depth=QUEUE, reliability=ReliabilityPolicy.BEST_EFFORT),
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(message_lost=self._on_lost, use_default_callbacks=False),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        # By a steady clock, so that the node reports while simulated time stands still.
        self.create_timer(1.0, self._on_second, clock=Clock(clock_type=ClockType.STEADY_TIME))
        check_qos_overrides(self)

    def _geometry_topic(self) -> GeometryTopic:
        from .geometry_topic import GeometryTopic

        return GeometryTopic(self, self._on_geometry)

    def _publisher(self, topic: str, type_name: str) -> Any:
        # Every event handler costs the executor about 25 us a round; QoS is looked at once a second instead.
        return self.create_publisher(
            message_class(type_name),
            topic,
            QoSProfile(depth=QUEUE),
            event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )

    def _on_geometry(self, data: bytes) -> None:
        try:
            status = self._predictor.set_geometry(decode_polygon(data))
        except MalformedMessage:
            status = Status.MALFORMED
        if status is not Status.ACCEPTED:
            self._refuse("contact_geometry", status)

    def _on_odometry(self, data: bytes) -> None:
        began = perf_counter()
        try:
            sample = decode_odometry(data)
        except MalformedMessage:
            self._refuse("odom", Status.MALFORMED)
            return
        latency = time.time_ns() - sample.stamp
        decoded = perf_counter()
        prediction = self._predictor.update(sample)
        update = perf_counter() - decoded
        if prediction.status is not Status.ACCEPTED:
            self._refuse("odom", prediction.status)
            return
        self._last_sample = sample
        for publisher, encode in self._encoders:
            _publish(publisher, encode, prediction)
        diagnostics = self._diagnostics
        if prediction.score is not None:
            diagnostics.settled(sample.child_frame_id, prediction.score)
        now = perf_counter()
        if diagnostics.accepted(now, sample.stamp, latency, update, now - began):
            self._report()

    def _refuse(self, name: str, status: Status) -> None:
        reason = Refused(name, status)
        if self._diagnostics.refused(perf_counter(), reason):
            self._report()
        if self._diagnostics.is_news(reason):
            self.get_logger().warning(f"refused a message on {reason}")
            if status is Status.NO_GEOMETRY and self._geometry is not None:
                self._geometry.look_for_history()

    def _on_lost(self, event: Any) -> None:
        self._diagnostics.lost += event.total_count_change

    def _on_second(self) -> None:
        if self._geometry is not None:
            self._geometry.look_for_history()
        self._diagnostics.publishers = self.count_publishers(self._samples.topic_name)
        self._diagnostics.misfits = misfits(self, [self._samples], self._outputs.values())
        self._diagnostics.second_over(perf_counter())
        self._report()

    def _report(self) -> None:
        if self._reports.get_subscription_count():
            stamp = self.get_clock().now().nanoseconds
            self._reports.publish(self._diagnostics.report(perf_counter(), stamp))

    def served(self) -> int:
        """How many messages were accepted or refused so far."""
        return self._diagnostics.served

    def finish(self) -> None:
        """End the record: publish the scores that it still settles, and see them received."""
        scores = self._predictor.finish()
        if self._last_sample is None or not scores:
            return
        for score in scores:
            prediction = Prediction(Status.ACCEPTED, self._last_sample, None, score)
            _publish(self._outputs["score"], OUTPUTS["score"].encode, prediction)
        self._outputs["score"].wait_for_all_acked(LAST_WORDS)


def _publish(publisher: Any, encode: Callable[[Prediction], bytes | None], prediction: Prediction) -> None:
    """Publish what there is to say, unless nobody listens: then it is not even encoded."""
    if publisher.get_subscription_count():
        data = encode(prediction)
        if data is not None:
            publisher.publish(data)
