"""The parameters of the program as parameters of a ROS node, under the same rules as offline."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Final

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter as NodeParameter

from ..errors import InputError
from ..parameters.validation import Parameter, Value, check_change, is_of_every_node, parameter_of, validate

_QOS_OVERRIDES: Final = "qos_overrides."


class NodeParameters:
    """The parameters of a node: those that it began with, and what is set while it runs.

    `values` are those that hold now.
    """

    def __init__(self, node: Node) -> None:
        """Declare every parameter on a node that was made with those which the user gave.

        Raises:
            InputError: the user gave an unknown parameter or a bad value, or left out one that has no default.
        """
        parameters: Mapping[str, Any] = node.get_parameters_by_prefix("")
        self._node = node
        self._given = {name: _plain(parameter.value) for name, parameter in parameters.items()}
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
        parameter = parameter_of(name)
        self._node.declare_parameter(name, _ros_value(parameter, value), _descriptor(parameter))

    def changed(self, parameters: Sequence[NodeParameter]) -> dict[str, Value]:
        """The values that would hold with others for some parameters; nothing is changed.

        Raises:
            InputError: one is refused as at the start, or cannot change while the node runs.
        """
        others = _ours(parameters)
        for name, value in others.items():
            if value is None:
                raise InputError(f"the parameter {name} cannot be deleted while the node runs; give it another value")
        values = validate({**self._given, **others})
        check_change(self.values, values)
        return values

    def take(self, parameters: Sequence[NodeParameter], values: dict[str, Value]) -> list[NodeParameter]:
        """Take values that `changed` has made; the parameters that the node itself has still to set."""
        others = _ours(parameters)
        for name in others:
            if not self._node.has_parameter(name):
                self._declare(name, values[name])
        was, self.values = self.values, values
        self._given |= others
        return [one for one in parameters if one.name not in others or was.get(one.name) != values[one.name]]


def _ours(parameters: Sequence[NodeParameter]) -> dict[str, Any]:
    """The values of parameters that are not of every node."""
    return {one.name: _plain(one.value) for one in parameters if not is_of_every_node(one.name)}


def check_qos_overrides(node: Node) -> None:
    """Find overrides of QoS that fit no topic of a node that has all its topics.

    Raises:
        InputError: there is one.
    """
    known = [f"{_QOS_OVERRIDES}{one.topic_name}.subscription" for one in node.subscriptions]
    known += [
        f"{_QOS_OVERRIDES}{one.topic_name}.publisher"
        for one in node.publishers
        if one.topic_name != "/parameter_events"
    ]
    for name in node.get_parameters_by_prefix("qos_overrides"):
        endpoint = f"{_QOS_OVERRIDES}{name}".rpartition(".")[0]
        if endpoint not in known:
            near = get_close_matches(endpoint, known, 5, 0.0)
            raise InputError(
                f"the parameter {_QOS_OVERRIDES}{name} is of no topic of this node; near it there are "
                f"{', '.join(one.removeprefix(_QOS_OVERRIDES) for one in near)}"
            )


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, array) else value


def _ros_value(parameter: Parameter, value: Value) -> Any:
    if not isinstance(value, tuple):
        return value
    # An empty list does not say of what; declared by its type alone, the parameter is not set.
    return list(value) or NodeParameter.Type[parameter.kind.upper()]


def _descriptor(parameter: Parameter) -> ParameterDescriptor:
    largest = sys.float_info.max
    ranges = []
    if parameter.kind == "double" and (parameter.low > -largest or parameter.high < largest):
        ranges = [FloatingPointRange(from_value=max(parameter.low, -largest), to_value=min(parameter.high, largest))]
    whole_ranges = []
    if parameter.kind == "integer":
        whole_ranges = [IntegerRange(from_value=int(parameter.low), to_value=int(parameter.high))]
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return ParameterDescriptor(
        type=NodeParameter.Type[parameter.kind.upper()].value,
        description=f"{parameter.description}{unit}",
        additional_constraints=" or ".join(parameter.choices),
        read_only=bool(parameter.fixed),
        floating_point_range=ranges,
        integer_range=whole_ranges,
    )
