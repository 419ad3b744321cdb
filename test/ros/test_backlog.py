"""Which samples are answered when several wait, and what becomes of a node that cannot keep up."""

import time
from statistics import median

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

from graph import without_numba
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from test_node import FIXED_POINTS, SCENE, odometry

from impact_predictor.ros import endpoints
from impact_predictor.ros.endpoints import LONGEST, Backlog
from impact_predictor.ros.messages import decode_diagnostic_array
from impact_predictor.ros.processes import Child


class Subscription:
    """A subscription on which messages wait: bytes, which came one after the other."""

    msg_type = None

    def __init__(self, waiting=(), take=None, reliability=ReliabilityPolicy.BEST_EFFORT):
        self.waiting = list(waiting)
        self.callback = take
        self.handle = self
        self.qos_profile = QoSProfile(depth=1, reliability=reliability)

    def take_message(self, kind, raw):
        assert raw
        if not self.waiting:
            return None
        data = self.waiting.pop(0)
        return data, {"received_timestamp": data[0]}


def samples(*numbers):
    return [bytes([k]) for k in numbers]


@pytest.fixture
def clock(monkeypatch):
    """A clock that goes on by as many seconds as are appended."""
    passed = [0.0]
    monkeypatch.setattr(endpoints, "perf_counter", lambda: sum(passed))
    return passed


class Slow:
    """A backlog of samples whose answers take some time, in s, and of what else is told."""

    def __init__(self, clock, reliability=ReliabilityPolicy.BEST_EFFORT):
        self.clock, self.taken = clock, []
        self.samples = Subscription(reliability=reliability)
        self.other = Subscription(take=self.taken.append)
        self.backlog = Backlog(self.samples, [self.other], self.answer)

    def answer(self, data):
        self.taken.append(data)
        self.clock.append(self.cost)

    def of(self, cost, *numbers, told=()):
        """What is taken of samples that wait, and of what else is told, by their times."""
        self.cost, self.taken[:] = cost, []
        first, *self.samples.waiting = samples(*numbers)
        self.other.waiting = samples(*told)
        dropped = self.backlog.take(first)
        assert dropped == len(numbers) + len(told) - len(self.other.waiting) - len(self.taken)
        return [data[0] for data in self.taken]


def test_what_came_in_a_pause_is_answered_in_its_order(clock):
    assert Slow(clock).of(LONGEST / 20, *range(20)) == [*range(20)]


def test_what_else_was_told_in_a_pause_is_heard_between_the_samples_between_which_it_came(clock):
    slow = Slow(clock)
    assert slow.of(LONGEST / 20, 1, 4, 6, 9, told=(2, 3, 5, 7, 8, 10)) == [*range(1, 11)]
    # Of a sample behind which nothing waits it is left to the executor.
    assert slow.of(LONGEST / 20, 1, told=(2, 3)) == [1]


def test_samples_stay_in_their_order_where_the_clock_was_set_back_between_them(clock):
    assert Slow(clock).of(LONGEST / 20, 5, 6, 7, 2, 3, told=(1, 4)) == [5, 1, 4, 6, 7, 2, 3]


def test_after_the_longest_time_the_newest_alone_is_answered_until_nothing_waits_behind_a_sample(clock):
    slow = Slow(clock)
    assert slow.of(LONGEST / 2.5, *range(10)) == [0, 1, 2, 9]
    assert slow.of(LONGEST / 100, *range(5), told=(6, 7)) == [4, 6, 7]
    assert slow.of(LONGEST / 100, 0) == [0]
    assert slow.of(LONGEST / 100, *range(5)) == [*range(5)]


def test_nothing_is_dropped_of_a_subscription_that_is_reliable(clock):
    assert Slow(clock, ReliabilityPolicy.RELIABLE).of(1.0, *range(50)) == [*range(50)]


SLOW = f"""
import sys, time
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.ros.node import main
update = Predictor.update
def slow(self, sample):
    print(time.monotonic() - sample.pose_covariance[0])
    time.sleep(0.01)
    return update(self, sample)
Predictor.update = slow
sys.exit(main([sys.argv[0], "--ros-args", "--params-file", {str(SCENE)!r}, *sys.argv[1:]]))
"""
"""The node with answers that take 10 ms; it prints how old in s each sample is that it begins to answer."""


def feed(peer, count, rate):
    """Publish samples at a rate, each with the time of that as the first number of its pose's covariance."""
    samples = peer.found(peer.publisher(Odometry, "odom", QoSProfile(depth=1000)))
    begin = time.monotonic()
    for k in range(count):
        peer.until(lambda k=k: time.monotonic() >= begin + k / rate)
        message = odometry(k)
        message.pose.covariance[0] = time.monotonic()
        samples.publish(message)


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_a_node_that_cannot_keep_up_answers_the_newest_sample_and_tells_what_it_dropped(peer, executor):
    arguments = (*FIXED_POINTS, "-p", f"executor:={executor}")
    with Child("node", without_numba(), "-c", SLOW, *arguments) as node:
        count = 300
        feed(peer, count, 400.0)
        peer.until(lambda: counts(peer) == count)
        assert int(peer.reported("samples.dropped")) > count / 2
        reports = [decode_diagnostic_array(data)[0].message for data in peer.heard["diagnostics"]]
        assert any("samples dropped in the last second" in message for message in reports)
        node.end()
        ages = [float(line) for line in node.said().split()]
    # Were none dropped, these would be 1.7 s old. Once the node is behind it is an answer or two; a busy machine adds.
    assert median(ages[len(ages) // 2 :]) < 0.5


def counts(peer):
    return sum(int(peer.reported(key) or 0) for key in ("samples.accepted", "samples.dropped"))
