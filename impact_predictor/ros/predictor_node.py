"""The ROS side of the predictor: its parameters and topics around a monitor."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from difflib import get_close_matches
from functools import partial
from itertools import chain
from time import perf_counter
from typing import Any, Final

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter as NodeParameter
from rclpy.service import Service

from ..errors import InputError
from ..mechanics.compiled import told_of_compiling
from ..parameters.validation import Parameter, Value, check_change, foreign, is_of_every_node, parameter_of, validate
from ..prediction.monitor import Monitor
from ..prediction.scene import CONTACT_GEOMETRY, FEET_STATES, ODOM, TRANSFORMS, Scene, features_of, inputs_of, scenes_of
from ..wording import listed
from .endpoints import Misfits
from .messages import is_typed
from .process import flaw_of_file, overrides_of, sentence
from .reporter import Reporter
from .topics import BodyTopics, InputTopic

_QOS_OVERRIDES: Final = "qos_overrides."
_OF_ROS: Final = ("/clock", "/parameter_events")
_TYPES: Final = frozenset(one.value for one in NodeParameter.Type)


class PredictorNode(Node):
    """Translates between topics and the monitor of the scenes."""

    def __init__(self, is_over: Callable[[], bool] = bool, args: list[str] | None = None) -> None:
        """Take parameters and topics as `args` say, with which ROS was initialised too; InputError where a parameter is
        wrong; KeyboardInterrupt where `is_over` says so while the impact laws are compiled, which may take minutes.
        """
        try:
            super().__init__(
                "impact_predictor", cli_args=overrides_of(args), automatically_declare_parameters_from_overrides=True
            )
            self._settings = NodeParameters(self, args)
            self.executor_kind = str(self._settings.values["executor"])
            self._connect(scenes_of(self._settings.values), is_over)
        except InputError:
            raise
        # What rclpy raises for a name, a parameter or a QoS override that it cannot take.
        except (RuntimeError, ValueError, TypeError, AssertionError, ParameterException) as error:
            if "PARAMETER_NOT_SET" in str(error):
                raise InputError("a parameter is given as [], which ROS reads as no value; leave it out") from error
            raise InputError(f"ROS refuses to make the node: {sentence(error)}") from error

    def _connect(self, scenes: dict[str, Scene], is_over: Callable[[], bool]) -> None:
        compiles = any(scene.samples or not scene.radius for scene in scenes.values())
        with told_of_compiling(self.get_logger().info, is_over) if compiles else nullcontext():
            self._monitor = Monitor(scenes)
        # Each subscription that tells what was lost costs the single-threaded executor as much as another topic.
        counts_losses = self.executor_kind == "events" or len(scenes) == 1
        messages = str(self._settings.values["messages"])
        self._reporter = reporter = Reporter(self, self._monitor, counts_losses, is_typed(messages))
        self._told: list[InputTopic] = []
        self._bodies: dict[str, BodyTopics] = {}
        self._inputs: dict[str, Any] = {}
        # What is subscribed to first is served first when messages wait on several; the samples come last.
        for one in inputs_of(scenes):
            if one.kind == ODOM and one.body is not None:
                told = [other for other in self._told if other.body in (None, one.body)]
                self._bodies[one.body] = BodyTopics(self, reporter, self._monitor, one, told, messages)
                self._inputs[one.name] = self._bodies[one.body].subscription
            else:
                self._told.append(InputTopic(self, reporter, self._monitor, one))
                # Nobody need move frames, so silence about them is none.
                if self._told[-1].subscription is not None and one.kind not in TRANSFORMS:
                    self._inputs[one.name] = self._told[-1].subscription
        reporter.listen([name for name in self._inputs if not name.endswith(FEET_STATES)])
        outputs = chain.from_iterable(body.outputs.values() for body in self._bodies.values())
        self._misfits = Misfits(self, self._inputs.values(), outputs)
        # By a steady clock, so that the node reports while simulated time stands still.
        self.create_timer(1.0, self._on_second, clock=Clock(clock_type=ClockType.STEADY_TIME))
        for name in self._settings.foreign:
            self.get_logger().warning(f"{name} is no parameter of impact_predictor, and passed over")
        for said in _overrides_of_others(self):
            self.get_logger().warning(said)
        names = listed([*scenes])
        has = listed([one.name for one in features_of(self._settings.values) if one.on], last="and")
        inputs = sorted({one.topic_name for one in self.subscriptions} - set(_OF_ROS))
        self.get_logger().info(
            f"{f'the bodies {names} are' if names else 'one body is'} predicted from {listed(inputs)}; "
            f"executor {self.executor_kind}; the scene has {has}"
        )

    def create_service(
        self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any], **options: Any
    ) -> Service:
        """As of any node; but parameters of a type that ROS does not have are refused, and do not end the node."""
        if srv_type in (SetParameters, SetParametersAtomically):
            callback = partial(_of_known_types, callback)
        return super().create_service(srv_type, srv_name, callback, **options)

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
        ours = self._settings.ours(parameter_list)
        others = [one for one in parameter_list if one.name not in ours]
        if others:
            result = super().set_parameters_atomically(others)
            if not result.successful:
                return result
        change()
        taken = self._settings.take([one for one in parameter_list if one.name in ours], values)
        if not taken:
            return SetParametersResult(successful=True)
        self._reporter.markers.begin_anew()
        self.get_logger().info(f"from now on {', '.join(f'{one.name} is {one.value}' for one in taken)}")
        return super().set_parameters_atomically(taken)

    def _on_second(self) -> None:
        for one in self._told:
            one.look_for_history()
        inputs, topics = self._reporter.diagnostics.inputs, {name: one.topic_name for name, one in self._inputs.items()}
        counts = {name: self.count_publishers(topic) for name, topic in topics.items()}
        for name in [name for name in counts if name.endswith(FEET_STATES)]:
            # One of both ways to tell of feet is enough.
            other = name.removesuffix(FEET_STATES) + CONTACT_GEOMETRY
            is_told = counts[name] or (inputs.has_heard(name) and not counts[other])
            del counts[other if is_told else name]
        inputs.publishers, inputs.misfits = counts, self._misfits.look()
        for said in inputs.fallen_silent(perf_counter(), topics):
            self.get_logger().warning(said)
        self._reporter.second_over()

    def served(self) -> int:
        """How many messages were accepted or refused so far."""
        return self._reporter.diagnostics.served

    def finish(self) -> None:
        """End the record: publish the scores that it still settles, and see them received."""
        for body, scores in self._monitor.finish().items():
            self._bodies[body].publish_scores(scores)


class NodeParameters:
    """The parameters of the program as those of a node, under the same rules as offline: those that it began with, and
    what is set while it runs. `values` are those that hold now.
    """

    def __init__(self, node: Node, args: list[str] | None) -> None:
        """Declare every parameter on a node that was made with those which the user gave, in the arguments; InputError
        where the user gave an unknown parameter or a bad value, or left out one that has no default.
        """
        parameters: Mapping[str, Any] = node.get_parameters_by_prefix("")
        self._node = node
        self._given = {name: _plain(parameter.value) for name, parameter in parameters.items()}
        self.foreign = foreign(self._given)
        """Parameters in the place of ours that are surely meant for other nodes."""
        if all(is_of_every_node(name) or name in self.foreign for name in self._given):
            name = node.get_fully_qualified_name()
            flaw = flaw_of_file(args, name) or "give --params-file scene.yaml, as config/cube_tosses.yaml"
            raise InputError(f"no parameter of the scene was given to {name}: {flaw}")
        self.values = validate(self._given)
        for name, depth in self._given.items():
            if name.startswith(_QOS_OVERRIDES) and name.endswith(".depth") and not (type(depth) is int and depth > 0):
                raise InputError(
                    f"the parameter {name} is {depth!r}, but it must be a whole number of messages above 0"
                )
        for name, value in self.values.items():
            if name in self._given:
                node.set_descriptor(name, _descriptor(parameter_of(name)))
            else:
                self._declare(name, value)

    def _declare(self, name: str, value: Value) -> None:
        # An empty list does not say of what; and one parameter that is declared without a value is enough for the
        # parameter services to tell none at all.
        if value != ():
            plain = list(value) if isinstance(value, tuple) else value
            self._node.declare_parameter(name, plain, _descriptor(parameter_of(name)))

    def ours(self, parameters: Sequence[NodeParameter]) -> dict[str, Any]:
        """The values of parameters that are neither of every node nor foreign."""
        values = {one.name: _plain(one.value) for one in parameters if not is_of_every_node(one.name)}
        passed_over = foreign({**self._given, **values})
        return {name: value for name, value in values.items() if name not in passed_over}

    def changed(self, parameters: Sequence[NodeParameter]) -> dict[str, Value]:
        """The values that would hold with others for some parameters; nothing is changed. InputError where one is
        refused as at the start, or cannot change while the node runs.
        """
        others = self.ours(parameters)
        for one in parameters:
            if not (one.name in others or is_of_every_node(one.name) or self._node.has_parameter(one.name)):
                raise InputError(f"there is no parameter {one.name}")
        for name, value in others.items():
            if value is None:
                raise InputError(f"the parameter {name} cannot be deleted while the node runs; give it another value")
        values = validate({**self._given, **others})
        check_change(self.values, values)
        return values

    def take(self, parameters: Sequence[NodeParameter], values: dict[str, Value]) -> list[NodeParameter]:
        """Take values that `changed` has made; the parameters that the node itself has still to set."""
        others = self.ours(parameters)
        for name in others:
            if not self._node.has_parameter(name):
                self._declare(name, values[name])
        was, self.values = self.values, values
        self._given |= others
        return [one for one in parameters if one.name not in others or was.get(one.name) != values[one.name]]


def _of_known_types(callback: Callable[[Any, Any], Any], request: Any, response: Any) -> Any:
    """The answer to a request to set parameters, refused where a type is unknown, which rclpy would raise at."""
    for one in request.parameters:
        if one.value.type not in _TYPES:
            reason = f"the parameter {one.name} has the type {one.value.type}, which ROS does not have"
            refused = SetParametersResult(successful=False, reason=reason)
            if hasattr(response, "results"):
                response.results = [refused] * len(request.parameters)
            else:
                response.result = refused
            return response
    return callback(request, response)


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, array) else value


def _descriptor(parameter: Parameter) -> ParameterDescriptor:
    largest = sys.float_info.max
    is_bounded = parameter.low > -largest or parameter.high < largest
    ranges: dict[str, Any] = {}
    if parameter.kind == "double" and is_bounded:
        low, high = max(parameter.low, -largest), min(parameter.high, largest)
        ranges = {"floating_point_range": [FloatingPointRange(from_value=low, to_value=high)]}
    elif parameter.kind == "integer":
        ranges = {"integer_range": [IntegerRange(from_value=int(parameter.low), to_value=int(parameter.high))]}
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return ParameterDescriptor(
        type=NodeParameter.Type[parameter.kind.upper()].value,
        description=f"{parameter.description}{unit}",
        additional_constraints=" or ".join(parameter.choices),
        read_only=bool(parameter.fixed),
        **ranges,
    )


def _overrides_of_others(node: Node) -> list[str]:
    """What is to say of overrides of QoS that fit no topic of a node that has all its topics."""
    known = [f"{one.topic_name}.subscription" for one in node.subscriptions]
    known += [f"{one.topic_name}.publisher" for one in node.publishers if one.topic_name != "/parameter_events"]
    overrides = {name: name.rpartition(".")[0] for name in node.get_parameters_by_prefix("qos_overrides")}
    return [
        f"the parameter {_QOS_OVERRIDES}{name} is of no topic of this node; near it there are "
        f"{', '.join(get_close_matches(endpoint, known, 5, 0.0))}"
        for name, endpoint in overrides.items()
        if endpoint not in known
    ]
