"""The topics that tell of the feet of a walking machine: where they are, what they feel, when they are to stand."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Final, NamedTuple

from rclpy.node import Node

from ..prediction.inputs import CONTACT_GEOMETRY, JOINTS
from ..prediction.inputs import WRENCH as FORCE
from ..prediction.monitor import Monitor
from ..prediction.types import Status
from .endpoints import subscription
from .input_topic import InputTopic
from .latched_topic import LatchedTopic
from .messages.inputs import (
    JOINT_STATE,
    JOINT_TRAJECTORY,
    POLYGON,
    WRENCH,
    decode_joints,
    decode_polygon,
    decode_schedule,
    decode_wrench,
)
from .reporter import Reporter


class _Kind(NamedTuple):
    """How the messages of a kind are read, and who takes them."""

    type_name: str
    decode: Callable[[bytes], Any]
    update: Callable[[Monitor, str, Any], Status]


_KINDS: Final = {
    CONTACT_GEOMETRY: _Kind(POLYGON, decode_polygon, Monitor.set_geometry),
    JOINTS: _Kind(JOINT_STATE, decode_joints, Monitor.tell),
    FORCE: _Kind(WRENCH, decode_wrench, Monitor.tell),
}


def listen_to_feet(node: Node, reporter: Reporter, monitor: Monitor, body: str, topic: str, kind: str) -> Any:
    """Take what keeps being told about the feet of a body on a topic; its subscription.

    There is no history of it to be asked for: feet move, and what was published before is of no use.
    """
    type_name, decode, update = _KINDS[kind]

    one = InputTopic(reporter, topic, decode, partial(update, monitor, body))
    return subscription(node, topic, type_name, one.take, reporter.on_lost)


def listen_to_schedule(node: Node, reporter: Reporter, monitor: Monitor, body: str, topic: str) -> LatchedTopic:
    """Take when the feet of a body are to stand, which may have been published before."""
    one = InputTopic(reporter, topic, decode_schedule, partial(monitor.tell, body))
    return LatchedTopic(node, one.take, topic, JOINT_TRAJECTORY)
