"""Who is kept apart from this node by QoS: found in the graph, because event handlers would slow every message."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def misfits(node: Node, subscriptions: Iterable[Any], publishers: Iterable[Any]) -> list[str]:
    """A text for each endpoint of another node that does not match one of these, with topic, node and reason."""
    return list(_misfits(node, subscriptions, publishers))


def _misfits(node: Node, subscriptions: Iterable[Any], publishers: Iterable[Any]) -> Iterator[str]:
    for ours in subscriptions:
        for theirs in node.get_publishers_info_by_topic(ours.topic_name):
            if reason := _reason(theirs.qos_profile, ours.qos_profile):
                yield f"the publisher on {ours.topic_name} from {theirs.node_name} {reason}"
    for ours in publishers:
        for theirs in node.get_subscriptions_info_by_topic(ours.topic_name):
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
