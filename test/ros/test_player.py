import pytest

from impact_predictor.bags.read import BagMessage
from impact_predictor.bags.write import BagWriter
from impact_predictor.ros import player
from impact_predictor.ros.messages import JOINT_TRAJECTORY, ODOMETRY, POLYGON
from impact_predictor.ros.player import GEOMETRY_AHEAD, LONGEST_GAP, SHORTENED_GAP, _await_others, _publish_all, timed

SECOND = 1_000_000_000
WITHOUT_ROS = "the player needs ROS 2: source it, or install the extra `ros`"


def messages(*seconds):
    return [BagMessage("/odom", round(second * SECOND), b"") for second in seconds]


def pauses(runs, *seconds):
    return [pause for pause, _ in timed(messages(*seconds), runs)]


def test_messages_keep_their_pauses_and_idle_gaps_are_shortened():
    assert pauses(0, 10.0, 10.25, 10.5, 30.0, 30.25) == [0.0, 0.25, 0.25, SHORTENED_GAP, 0.25]


def test_a_gap_that_is_shortened_is_longer_than_the_longest_pause():
    assert pauses(1, 10.0, 10.0 + LONGEST_GAP) == [0.0, LONGEST_GAP]
    assert pauses(1, 10.0, 10.001 + LONGEST_GAP) == [0.0]


def test_an_excerpt_ends_where_the_last_of_its_runs_ends():
    assert [message.log_time // SECOND for _, message in timed(messages(1.0, 1.0, 20.0, 40.0), 2)] == [1, 1, 20]


def test_log_times_that_go_back_make_no_negative_pause():
    assert pauses(0, 2.0, 1.0, 1.25) == [0.0, 0.0, 0.25]


class Listening:
    """A stop that is never asked for, which notes how long it is waited for, and a publisher."""

    def __init__(self):
        self.waits = []

    def wait(self, seconds):
        self.waits.append(seconds)
        return False

    def publish(self, data):
        pass


def test_contact_points_are_given_time_where_they_come_now_and_then_but_not_those_of_feet_that_keep_coming():
    listening = Listening()
    types = {"/points": POLYGON, "/odom": ODOMETRY}
    record = [
        (topic, round(k * 2.5e6 + later * SECOND))
        for later in (0, 5)
        for k in range(4)
        for topic in ("/points", "/odom")
    ]
    told = ((0.0, BagMessage(topic, time, b"")) for topic, time in record)
    _publish_all(told, types, dict.fromkeys(types, listening), 1.0, listening)
    before = [k for k in range(1, len(record)) if listening.waits[k] > listening.waits[k - 1]]
    # More time only before what follows the first points, and the first after a pause.
    assert before == [1, 9]
    assert all(listening.waits[k] > 0.5 * GEOMETRY_AHEAD for k in before)


class Lonely(Listening):
    """A publisher without subscribers on a node that knows of no other, and a stop that is asked for."""

    topic_name = "/odom"

    def get_subscription_count(self):
        return 0

    def count_publishers(self, topic):
        return 0

    def wait(self, seconds):
        super().wait(seconds)
        return True


def test_nobody_is_waited_for_any_more_once_the_player_is_to_stop():
    for publishers, recorded in (([Lonely()], ()), ([], ("~/mode",))):
        stop = Lonely()
        assert _await_others(stop, publishers, recorded, stop) is False
        assert len(stop.waits) == 1
    assert _await_others(stop, [], (), stop) is True


def test_how_long_messages_are_kept_may_be_overridden_where_a_publisher_keeps_them():
    rclpy = pytest.importorskip("rclpy", reason=WITHOUT_ROS)
    from rclpy.qos import DurabilityPolicy

    from impact_predictor.ros.endpoints import publisher

    context = rclpy.Context()
    rclpy.init(context=context, args=["--ros-args", "-p", "qos_overrides./points.publisher.durability:=volatile"])
    node = rclpy.create_node("player", context=context)
    try:
        kept = [publisher(node, one, POLYGON, DurabilityPolicy.TRANSIENT_LOCAL) for one in ("/points", "/others")]
        assert [one.qos_profile.durability for one in kept] == [
            DurabilityPolicy.VOLATILE,
            DurabilityPolicy.TRANSIENT_LOCAL,
        ]
    finally:
        node.destroy_node()
        context.shutdown()


def test_messages_that_stay_true_are_kept_for_late_subscribers_and_no_others(monkeypatch, tmp_path, capsys):
    pytest.importorskip("rclpy", reason=WITHOUT_ROS)
    from impact_predictor.ros import endpoints

    kinds, kept, publisher = {"/points": POLYGON, "/plan": JOINT_TRAJECTORY, "/odom": ODOMETRY}, {}, endpoints.publisher

    def noted(node, topic, *others):
        made = publisher(node, topic, *others)
        kept[topic] = made.qos_profile.durability.name
        return made

    monkeypatch.setattr(endpoints, "publisher", noted)
    monkeypatch.setattr(player, "DISCOVERY", 0.0)
    with BagWriter(tmp_path / "bag.mcap") as writer:
        for topic, kind in kinds.items():
            writer.write(topic, kind, 0, b"")
    assert player.main(["player", str(tmp_path / "bag.mcap")]) == 1
    assert "nobody has subscribed to" in capsys.readouterr().err
    assert kept == {"/points": "TRANSIENT_LOCAL", "/plan": "TRANSIENT_LOCAL", "/odom": "VOLATILE"}
