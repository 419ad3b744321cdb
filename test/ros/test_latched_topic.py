import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

from types import SimpleNamespace

from rclpy.qos import DurabilityPolicy, QoSProfile

from impact_predictor.ros.endpoints import REMEMBERED, LatchedTopic
from impact_predictor.ros.messages import POLYGON


class Topic:
    """A latched topic of a node with one publisher that keeps its messages; `taken` are those passed on."""

    def __init__(self):
        self.taken, listeners = [], []
        latched = SimpleNamespace(qos_profile=QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))

        def create_subscription(kind, topic, take, qos, **_):
            listeners.append(take)
            return SimpleNamespace(topic_name=f"/{topic}")

        node = SimpleNamespace(
            create_subscription=create_subscription, get_publishers_info_by_topic={"/points": [latched]}.get
        )
        topic = LatchedTopic(node, self.taken.append, "points", POLYGON)
        topic.look_for_history()
        topic.look_for_history()
        self.live, self.latched = listeners


@pytest.mark.parametrize(
    ("heard", "taken"),
    [
        ([("live", b"a"), ("latched", b"a"), ("latched", b"b"), ("live", b"b")], [b"a", b"b"]),
        ([("live", b"a"), ("live", b"b"), ("latched", b"a"), ("latched", b"b")], [b"a", b"b"]),
        (2 * [("live", b"a"), ("latched", b"a")], [b"a", b"a"]),
    ],
    ids=["whichever is first", "one ahead", "published again"],
)
def test_what_comes_on_both_subscriptions_is_taken_once(heard, taken):
    topic = Topic()
    for subscription, data in heard:
        getattr(topic, subscription)(data)
    assert topic.taken == taken


def test_what_only_volatile_publishers_send_is_all_taken():
    topic = Topic()
    for k in range(3 * REMEMBERED):
        topic.live(bytes([k]))
    topic.latched(b"latched before")
    assert len(topic.taken) == 3 * REMEMBERED + 1
