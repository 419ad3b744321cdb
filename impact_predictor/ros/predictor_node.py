"""The ROS side of the predictor: its parameters and topics around a monitor."""

from __future__ import annotations

from itertools import chain
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter as NodeParameter

from ..errors import InputError
from ..parameters.validation import is_of_every_node
from ..prediction.monitor import Monitor
from ..prediction.scene import Scene, inputs_of, scenes_of
from .endpoints import Misfits
from .node_parameters import NodeParameters, check_qos_overrides
from .process import sentence
from .reporter import Reporter
from .topics import BodyTopics, listen_to_support


class PredictorNode(Node):
    """Translates between topics and the monitor of the scenes."""

    def __init__(self) -> None:
        """Take parameters and topics as the arguments of the process say.

        Raises:
            InputError: a parameter is wrong.
        """
        try:
            self._join()
            self._settings = NodeParameters(self)
            self.executor_kind = str(self._settings.values["executor"])
            self._connect(scenes_of(self._settings.values))
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

    def _connect(self, scenes: dict[str, Scene]) -> None:
        if any(scene.samples for scene in scenes.values()):
            self.get_logger().info("preparing the uncertainty samples; numba compiles once for a machine, about 15 s")
        self._monitor = Monitor(scenes)
        # Each subscription that tells what was lost costs the single-threaded executor as much as another topic.
        counts_losses = self.executor_kind == "events" or len(scenes) == 1
        self._reporter = reporter = Reporter(self, self._monitor, counts_losses)
        of_support: list[Any] = []
        self._bodies = {body: BodyTopics(self, reporter, self._monitor, body, of_support) for body in scenes}
        self._inputs: dict[str, Any] = {}
        # What is subscribed to first is served first when messages wait on several; the samples come last.
        for topic, kind, body in inputs_of(scenes):
            if body is None:
                self._inputs[topic] = listen_to_support(self, reporter, self._monitor, topic, kind)
                of_support.append(self._inputs[topic])
            elif (expected := self._bodies[body].listen(topic, kind)) is not None:
                self._inputs[topic] = expected
        reporter.listen(list(self._inputs))
        outputs = chain.from_iterable(body.outputs.values() for body in self._bodies.values())
        self._misfits = Misfits(self, self._inputs.values(), outputs)
        # By a steady clock, so that the node reports while simulated time stands still.
        self.create_timer(1.0, self._on_second, clock=Clock(clock_type=ClockType.STEADY_TIME))
        check_qos_overrides(self)

    def set_parameters_atomically(self, parameter_list: list[NodeParameter]) -> SetParametersResult:
        """Set parameters while the node runs: all of them, for the next sample, or none, with the reason.

        This is what the parameter services call.
        """
        try:
            values = self._settings.changed(parameter_list)
            change = self._monitor.changed(scenes_of(values))
        except InputError as error:
            return SetParametersResult(successful=False, reason=str(error))
        # What is left are parameters of ROS itself, which it may refuse, and values that it cannot refuse any more.
        others = [one for one in parameter_list if is_of_every_node(one.name)]
        if others:
            result = super().set_parameters_atomically(others)
            if not result.successful:
                return result
        change()
        ours = self._settings.take([one for one in parameter_list if one not in others], values)
        if not ours:
            return SetParametersResult(successful=True)
        self._reporter.markers.begin_anew()
        self.get_logger().info(f"from now on {', '.join(f'{one.name} is {one.value}' for one in ours)}")
        return super().set_parameters_atomically(ours)

    def _on_second(self) -> None:
        for body in self._bodies.values():
            body.look_for_history()
        diagnostics = self._reporter.diagnostics
        diagnostics.publishers = {name: self.count_publishers(one.topic_name) for name, one in self._inputs.items()}
        diagnostics.misfits = self._misfits.look()
        self._reporter.second_over()

    def served(self) -> int:
        """How many messages were accepted or refused so far."""
        return self._reporter.diagnostics.served

    def finish(self) -> None:
        """End the record: publish the scores that it still settles, and see them received."""
        for body, scores in self._monitor.finish().items():
            self._bodies[body].publish_scores(scores)
