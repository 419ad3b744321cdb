import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

from impact_predictor.ros.endpoints import REMEMBERED, Once


@pytest.fixture
def taken():
    return []


@pytest.fixture
def once(taken):
    return Once(taken.append)


def test_what_comes_on_both_subscriptions_is_taken_once_whichever_is_first(once, taken):
    once.live(b"a")
    once.latched(b"a")
    once.latched(b"b")
    once.live(b"b")
    assert taken == [b"a", b"b"]


def test_one_subscription_that_runs_ahead_changes_nothing(once, taken):
    once.live(b"a")
    once.live(b"b")
    once.latched(b"a")
    once.latched(b"b")
    assert taken == [b"a", b"b"]


def test_the_same_message_published_again_is_taken_again(once, taken):
    for _ in range(2):
        once.live(b"a")
        once.latched(b"a")
    assert taken == [b"a", b"a"]


def test_what_only_volatile_publishers_send_is_all_taken(once, taken):
    for k in range(3 * REMEMBERED):
        once.live(bytes([k]))
    once.latched(b"latched before")
    assert len(taken) == 3 * REMEMBERED + 1
