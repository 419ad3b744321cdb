"""Publishers and subscriptions as this node makes them: bytes in, bytes out, no event handlers that are not needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from .process import message_class

QUEUE: Final = 1000
"""Messages that may wait: a second at 1 kHz, longer than a process is held up; the answers to them come at once. The
middleware does not tell what it drops beyond them; what the node drops itself, it counts (`backlog`)."""


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


class Outlet:
    """A publisher without the ten microseconds that rclpy adds to each look at its listeners and each message.

    `listeners()` is their number, and `send` takes a message as bytes.
    """

    __slots__ = ("listeners", "send")

    def __init__(self, publisher: Any) -> None:
        self.listeners: Callable[[], int] = publisher.handle.get_subscription_count
        self.send: Callable[[bytes], None] = publisher.handle.publish_raw


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
