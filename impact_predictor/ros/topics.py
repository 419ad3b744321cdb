"""The topics of the support and of each body, and what becomes of their messages."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from time import perf_counter
from typing import Any, Final

from rclpy.duration import Duration
from rclpy.node import Node

from ..prediction.monitor import Monitor
from ..prediction.scene import CONTACT_GEOMETRY, SCHEDULE, TERRAIN, TRANSFORMS, Input
from ..prediction.types import Prediction, Score, Status
from .endpoints import LONGEST, Backlog, LatchedTopic, Outlet, publisher, subscription
from .inputs import route
from .messages import INPUT_TYPES, MalformedMessage, Output, decode_odometry, outputs_of
from .reporter import Reporter

LAST_WORDS: Final = Duration(seconds=1)
"""How long the node waits at its end until its last score is received."""


class InputTopic:
    """What is told of the support, or of a body besides its states: decoded, handed to the monitor, and reported.

    `subscription` is None where messages stay true until the next, so that they need not keep coming.
    """

    def __init__(self, node: Node, reporter: Reporter, monitor: Monitor, one: Input) -> None:
        self.body = one.body
        self.subscription: Any = None
        self._reporter, self._input = reporter, one
        self._update = route(monitor, one)
        type_name, self._decode = INPUT_TYPES[one.kind]
        # Feet move, and what was published of them before is of no use.
        stays_true = one.kind == CONTACT_GEOMETRY and monitor.scenes[one.body or ""].walking is None
        self._latched: LatchedTopic | None = None
        # Transforms are told to all nodes on one topic, whatever their namespace.
        name = f"/{one.name}" if one.kind in TRANSFORMS else one.name
        if stays_true or one.kind in (SCHEDULE, TERRAIN, TRANSFORMS[0]):
            self._latched = LatchedTopic(node, self._take, name, type_name)
        else:
            self.subscription = subscription(node, name, type_name, self._take, reporter.on_lost)

    def look_for_history(self) -> None:
        """Ask for what was published before, if it is still true and there may be any."""
        if self._latched is not None:
            self._latched.look_for_history()

    def _take(self, data: bytes) -> None:
        try:
            message = self._decode(data)
        except MalformedMessage:
            self._reporter.refuse(self._input.name, Status.MALFORMED)
            return
        status = self._update(message)
        if status is Status.ACCEPTED:
            self._reporter.took(self._input, message)
        else:
            self._reporter.refuse(self._input.name, status, self.body, message)


class BodyTopics:
    """Takes the states of one body, and publishes what the monitor makes of them.

    A body without a name has the topics `odom` and `~/mode`, another one `crate/odom` and `~/crate/mode`.
    """

    def __init__(
        self,
        node: Node,
        reporter: Reporter,
        monitor: Monitor,
        one: Input,
        told: Iterable[InputTopic],
        messages: str = "auto",
    ) -> None:
        """Listen to the states on an input; `told` is what else the answers depend on, `messages` the parameter."""
        self._reporter, self._told = reporter, list(told)
        self._topic, self._body = one.name, one.body or ""
        self._last: Prediction | None = None
        self._update = monitor.predictors[self._body].update
        if monitor.watch is not None:
            self._update = partial(monitor.update, self._body)
        type_name = INPUT_TYPES[one.kind].name
        self.subscription = subscription(node, one.name, type_name, self._on_odometry, reporter.on_lost)
        others = [one.subscription for one in self._told if one.subscription is not None]
        self._backlog = Backlog(self.subscription, others, self._answer, LONGEST / len(monitor.predictors))
        prefix = f"~/{one.body}/" if one.body else "~/"
        outputs = outputs_of(messages)
        self.outputs = {name: publisher(node, prefix + name, output.type_name) for name, output in outputs.items()}
        self._outlets = [(Outlet(self.outputs[name]), output) for name, output in outputs.items()]
        self._score = outputs["score"]

    def _on_odometry(self, data: bytes) -> None:
        self._reporter.diagnostics.dropped += self._backlog.take(data)

    def _answer(self, data: bytes) -> None:
        began = perf_counter()
        try:
            sample = decode_odometry(data)
        except MalformedMessage:
            self._reporter.refuse(self._topic, Status.MALFORMED)
            return
        latency = self._reporter.clock() - sample.stamp
        decoded = perf_counter()
        prediction = self._update(sample)
        update = perf_counter() - decoded
        if prediction.status is not Status.ACCEPTED:
            if prediction.status in (Status.NO_GEOMETRY, Status.NO_TRANSFORM):
                for one in self._told:
                    one.look_for_history()
            self._reporter.refuse(self._topic, prediction.status, self._body, sample)
            return
        self._last = prediction
        for outlet, output in self._outlets:
            _publish(outlet, output, prediction)
        self._reporter.answered(self._topic, self._body, prediction, latency, update, began)

    def publish_scores(self, scores: tuple[Score, ...]) -> None:
        """Publish the scores that the end of the record settles, and see them received."""
        if self._last is None or not scores:
            return
        outlet = Outlet(self.outputs["score"])
        for score in scores:
            _publish(outlet, self._score, self._last._replace(score=score))
        self.outputs["score"].wait_for_all_acked(LAST_WORDS)


def _publish(outlet: Outlet, output: Output, prediction: Prediction) -> None:
    """Publish what there is to say, unless nobody listens: then it is not even encoded."""
    # To ask for listeners costs as much as to encode a mode.
    if getattr(prediction, output.needs) is not None and outlet.listeners():
        data = output.encode(prediction)
        if data is not None:
            outlet.send(data)
