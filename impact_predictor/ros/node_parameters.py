"""The parameters of the program as parameters of a ROS node, under the same rules as offline."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, Final

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter as NodeParameter

from ..errors import InputError
from ..parameters.validation import Parameter, Value, parameter_of, validate

_QOS_OVERRIDES: Final = "qos_overrides."


def declare_parameters(node: Node) -> dict[str, Value]:
    """Declare every parameter on a node that was made with those which the user gave, and return their values.

    Raises:
        InputError: the user gave an unknown parameter or a bad value, or left out one that has no default.
    """
    parameters: Mapping[str, Any] = node.get_parameters_by_prefix("")
    given = {name: _plain(parameter.value) for name, parameter in parameters.items()}
    values = validate(given)
    for name, depth in given.items():
        if name.startswith(_QOS_OVERRIDES) and name.endswith(".depth") and not (type(depth) is int and depth > 0):
            raise InputError(f"the parameter {name} is {depth!r}, but it must be a whole number of messages above 0")
    for name, value in values.items():
        parameter = parameter_of(name)
        if name in given:
            node.set_descriptor(name, _descriptor(parameter))
        else:
            node.declare_parameter(name, _ros_value(parameter, value), _descriptor(parameter))
    return values


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
        # The scene is made once.
        read_only=True,
        floating_point_range=ranges,
        integer_range=whole_ranges,
    )
