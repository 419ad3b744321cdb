"""Publishers and subscriptions as this node makes them: bytes in, bytes out, no event handlers that are not needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from .process import message_class

QUEUE: Final = 100
"""Messages that may wait: a tenth of a second at 1 kHz, which is longer than Python pauses."""


def publisher(node: Node, topic: str, type_name: str) -> Any:
    """A publisher whose QoS the user can override."""
    # Every event handler costs the executor about 25 us a round; QoS is looked at once a second instead.
    return node.create_publisher(
        message_class(type_name),
        topic,
        QoSProfile(depth=QUEUE),
        event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
        qos_overriding_options=QoSOverridingOptions.with_default_policies(),
    )


def subscription(
    node: Node, topic: str, type_name: str, take: Callable[[bytes], None], lost: Callable[[Any], None] | None
) -> Any:
    """A subscription that hands over bytes, and tells what the middleware has lost."""
    # Best effort matches every publisher; a message that is sent again would come too late.
    return node.create_subscription(
        message_class(type_name),
        topic,
        take,
        QoSProfile(depth=QUEUE, reliability=ReliabilityPolicy.BEST_EFFORT),
        raw=True,
        event_callbacks=SubscriptionEventCallbacks(message_lost=lost, use_default_callbacks=False),
        qos_overriding_options=QoSOverridingOptions.with_default_policies(),
    )
