"""Publishers and subscriptions as this node makes them: bytes in, bytes out, no event handlers that are not needed."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from heapq import merge
from itertools import chain, cycle, islice
from math import inf
from operator import itemgetter
from time import perf_counter
from typing import Any, Final

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions, QoSPolicyKind

from .inputs import Misfit
from .process import message_class

QUEUE: Final = 1000
"""Messages that may wait: a second at 1 kHz, longer than a process is held up; the answers to them come at once. The
middleware does not tell what it drops beyond them; what the node drops itself, it counts (`backlog`)."""


def publisher(node: Node, topic: str, type_name: str, durability: Any = None) -> Any:
    """A publisher whose QoS the user can override, also its durability where one is given."""
    overridable = [QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY]
    overridable += [] if durability is None else [QoSPolicyKind.DURABILITY]
    # Every event handler costs the executor about 25 us a round; QoS is looked at once a second instead.
    return node.create_publisher(
        message_class(type_name),
        topic,
        QoSProfile(depth=QUEUE, durability=durability or DurabilityPolicy.VOLATILE),
        event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
        qos_overriding_options=QoSOverridingOptions(overridable),
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


LONGEST: Final = 0.1
"""Seconds that a node may spend on samples that wait before it drops all of them but the newest."""


class Backlog:
    """What waits on the topics of one body when the executor hands over a sample.

    A node that was held up for a moment answers what it missed. One that cannot keep up drops samples, and then answers
    the newest alone until none waits behind it any more, so that it is never behind by more than `longest` and one
    answer. Other messages about the body are taken between the samples between which they came. A user
    who makes the subscription reliable wants every sample: then none is dropped.
    """

    def __init__(
        self, samples: Any, others: Iterable[Any], answer: Callable[[bytes], None], longest: float = LONGEST
    ) -> None:
        """Watch a subscription to samples and those to all else that the answers depend on, each to bytes.

        `answer` takes a sample, and `longest` is in s.
        """
        self._samples, self._others, self._answer = samples, others, answer
        self._longest = inf if samples.qos_profile.reliability == ReliabilityPolicy.RELIABLE else longest
        self._is_behind = False

    def take(self, sample: bytes) -> int:
        """Answer a sample that the executor hands over, and what waits behind it; how many samples were dropped."""
        waiting = _waiting_on(self._samples, self._answer)
        if not waiting:
            self._is_behind = False
            self._answer(sample)
            return 0
        began, newest, dropped = perf_counter(), waiting[-1], 0
        others = [_waiting_on(other, other.callback) for other in self._others]
        # What came on one topic stays in its order, also where the clock was set back meanwhile.
        for message in [(0, self._answer, sample), *merge(*others, waiting, key=itemgetter(0))]:
            _, take, data = message
            if take is self._answer and message is not newest:
                self._is_behind = self._is_behind or perf_counter() - began > self._longest
                if self._is_behind:
                    dropped += 1
                    continue
            take(data)
        return dropped


_Message = tuple[int, Callable[[bytes], None], bytes]


def _waiting_on(subscription: Any, take: Callable[[bytes], None]) -> list[_Message]:
    """The messages that wait on a subscription: when each came (ns), who takes it, and its bytes."""
    found: list[_Message] = []
    # Whoever publishes faster than this takes must not keep the node here.
    while len(found) < QUEUE:
        message = subscription.handle.take_message(subscription.msg_type, True)
        if message is None:
            break
        data, about = message
        found.append((about["received_timestamp"], take, data))
    return found


KEPT: Final = 100
"""Messages that are kept on such a topic: each node that knows fixed frames publishes one on /tf_static."""

REMEMBERED: Final = 16
"""Messages that may have come on one subscription to a topic before they come on the other."""


class LatchedTopic:
    """A topic of messages that stay true until the next, from publishers of either durability.

    A volatile subscription matches every publisher, but gets nothing that was published before it was there; a
    transient-local one gets that, but does not match volatile publishers, and both sides are warned of the misfit. So
    the transient-local one is added once there is a publisher for it, and what comes on both is taken once.
    """

    def __init__(self, node: Node, take: Callable[[bytes], None], topic: str, type_name: str) -> None:
        self._node, self._topic, self._take = node, topic, take
        self._has_latched = False
        # What came on the one subscription alone so far.
        only_live, only_latched = deque[bytes](maxlen=REMEMBERED), deque[bytes](maxlen=REMEMBERED)
        events = SubscriptionEventCallbacks(use_default_callbacks=False)
        self._listen = partial(
            node.create_subscription, message_class(type_name), topic, raw=True, event_callbacks=events
        )
        self._take_latched = partial(self._pass_on, only_latched, only_live)
        self.live = self._listen(
            partial(self._pass_on, only_live, only_latched),
            QoSProfile(depth=KEPT, reliability=ReliabilityPolicy.BEST_EFFORT),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )

    def look_for_history(self) -> None:
        """Ask for what was published before, if there is a publisher that keeps it."""
        if self._has_latched:
            return
        # History is kept for reliable subscriptions only.
        latched = DurabilityPolicy.TRANSIENT_LOCAL, ReliabilityPolicy.RELIABLE
        found = [one.qos_profile for one in self._node.get_publishers_info_by_topic(self.live.topic_name)]
        if latched in [(one.durability, one.reliability) for one in found]:
            self._has_latched = True
            self._listen(self._take_latched, QoSProfile(depth=KEPT, durability=DurabilityPolicy.TRANSIENT_LOCAL))

    def _pass_on(self, here: deque[bytes], there: deque[bytes], data: bytes) -> None:
        """Take a message that has come on one subscription, unless it was taken from the other."""
        if data in there:
            there.remove(data)
        else:
            here.append(data)
            self._take(data)


AT_ONCE: Final = 25
"""Endpoints that are looked at in one turn: that takes a millisecond, for which no message has to wait."""


class Misfits:
    """The endpoints of other nodes that do not match those of this one."""

    def __init__(self, node: Node, subscriptions: Iterable[Any], publishers: Iterable[Any]) -> None:
        self._node = node
        ours = [*((one, True) for one in subscriptions), *((one, False) for one in publishers)]
        self._found: dict[str, list[Misfit]] = {one.topic_name: [] for one, _ in ours}
        self._turns = cycle(ours)
        self._at_once = min(AT_ONCE, len(ours))

    def look(self) -> list[Misfit]:
        """Each that is known; looks at some of many topics in their turn."""
        for ours, is_subscription in islice(self._turns, self._at_once):
            self._found[ours.topic_name] = list(self._of(ours, is_subscription))
        return list(chain.from_iterable(self._found.values()))

    def _of(self, ours: Any, is_subscription: bool) -> Iterator[Misfit]:
        topic, node, kind = ours.topic_name, self._node, ours.msg_type
        type_name = f"{kind.__module__.partition('.')[0]}/msg/{kind.__name__}"
        find = node.get_publishers_info_by_topic if is_subscription else node.get_subscriptions_info_by_topic
        for theirs in find(topic):
            if theirs.topic_type != type_name:
                does, others = ("publishes", "wanted") if is_subscription else ("wants", "published")
                said = f"{theirs.node_name} {does} {theirs.topic_type} on {topic}, where {type_name} is {others}"
                yield Misfit("type", topic, said)
                continue
            offered, requested = ours.qos_profile, theirs.qos_profile
            whose = f"this node's publisher on {topic} for"
            if is_subscription:
                offered, requested, whose = requested, offered, f"the publisher on {topic} from"
            if reason := _reason(offered, requested):
                yield Misfit("QoS", topic, f"{whose} {theirs.node_name} {reason}")


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
