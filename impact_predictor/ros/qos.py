"""Who is kept apart from this node by QoS: found in the graph, because event handlers would slow every message."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain, cycle, islice
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

AT_ONCE: Final = 25
"""Endpoints that are looked at in one turn: that takes a millisecond, for which no message has to wait."""


class Misfits:
    """The endpoints of other nodes that do not match those of this one."""

    def __init__(self, node: Node, subscriptions: Iterable[Any], publishers: Iterable[Any]) -> None:
        self._node = node
        ours = [*((one, True) for one in subscriptions), *((one, False) for one in publishers)]
        self._found: dict[str, list[str]] = {one.topic_name: [] for one, _ in ours}
        self._turns = cycle(ours)
        self._at_once = min(AT_ONCE, len(ours))

    def look(self) -> list[str]:
        """A text for each that is known, with topic, node and reason; looks at some of many topics in their turn."""
        for ours, is_subscription in islice(self._turns, self._at_once):
            find = self._publishers if is_subscription else self._subscriptions
            self._found[ours.topic_name] = list(find(ours))
        return list(chain.from_iterable(self._found.values()))

    def _publishers(self, ours: Any) -> Iterator[str]:
        for theirs in self._node.get_publishers_info_by_topic(ours.topic_name):
            if reason := _reason(theirs.qos_profile, ours.qos_profile):
                yield f"the publisher on {ours.topic_name} from {theirs.node_name} {reason}"

    def _subscriptions(self, ours: Any) -> Iterator[str]:
        for theirs in self._node.get_subscriptions_info_by_topic(ours.topic_name):
            if reason := _reason(ours.qos_profile, theirs.qos_profile):
                yield f"this node's publisher on {ours.topic_name} for {theirs.node_name} {reason}"


def _reason(offered: QoSProfile, requested: QoSProfile) -> str:
    """Why a publisher does not match a subscription, or "".

    Only the two policies that differ in practice: rclpy's own comparison takes an unset deadline for one of zero.
    """
    best_effort, volatile = ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE
    if offered.reliability == best_effort and requested.reliability == ReliabilityPolicy.RELIABLE:
        return "is best effort, but the subscription wants reliable"
    if offered.durability == volatile and requested.durability == DurabilityPolicy.TRANSIENT_LOCAL:
        return "is volatile, but the subscription wants transient local"
    return ""
