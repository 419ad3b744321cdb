"""A topic of messages that stay true until the next, such as contact points, from publishers of either durability.

A volatile subscription matches every publisher, but gets nothing that was published before it was there; a
transient-local one gets that, but does not match volatile publishers, and both sides are warned of the misfit. So the
transient-local one is added once there is a publisher for it, and what comes twice is taken once.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from .process import message_class

LIVE: Final = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)

# History is kept for reliable subscriptions only.
LATCHED: Final = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)

REMEMBERED: Final = 16
"""Messages that may have come on one subscription before they come on the other."""


class Once:
    """Passes on each message of two subscriptions to one topic once, whichever has it first."""

    def __init__(self, take: Callable[[bytes], None]) -> None:
        self._take = take
        self._only_live: deque[bytes] = deque(maxlen=REMEMBERED)
        self._only_latched: deque[bytes] = deque(maxlen=REMEMBERED)

    def live(self, data: bytes) -> None:
        """A message of the volatile subscription."""
        self._pass_on(data, self._only_live, self._only_latched)

    def latched(self, data: bytes) -> None:
        """A message of the transient-local subscription."""
        self._pass_on(data, self._only_latched, self._only_live)

    def _pass_on(self, data: bytes, here: deque[bytes], there: deque[bytes]) -> None:
        if data in there:
            there.remove(data)
        else:
            here.append(data)
            self._take(data)


class LatchedTopic:
    """Hands every message on a topic to `take`, as bytes."""

    def __init__(self, node: Node, take: Callable[[bytes], None], topic: str, type_name: str) -> None:
        self._node = node
        self._topic = topic
        self._once = Once(take)
        self._type = message_class(type_name)
        self._events = SubscriptionEventCallbacks(use_default_callbacks=False)
        self._has_latched = False
        self.live = node.create_subscription(
            self._type,
            topic,
            self._once.live,
            LIVE,
            raw=True,
            event_callbacks=self._events,
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )

    def look_for_history(self) -> None:
        """Ask for what was published before, if there is a publisher that keeps it."""
        if self._has_latched:
            return
        topic = self.live.topic_name
        for publisher in self._node.get_publishers_info_by_topic(topic):
            qos = publisher.qos_profile
            if (qos.durability, qos.reliability) == (DurabilityPolicy.TRANSIENT_LOCAL, ReliabilityPolicy.RELIABLE):
                self._has_latched = True
                self._node.create_subscription(
                    self._type, self._topic, self._once.latched, LATCHED, raw=True, event_callbacks=self._events
                )
                return
