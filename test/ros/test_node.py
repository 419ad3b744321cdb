"""The node as a process of its own, over real DDS."""

import math
import sys
import time
from pathlib import Path

import pytest

from impact_predictor.ros.cdr import ERROR, OK
from impact_predictor.ros.messages import OUTPUTS, decode_diagnostic_array

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

import rclpy
from geometry_msgs.msg import Point32, PolygonStamped
from graph import PATIENCE, peer_of_node, running_node
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import UInt8

from impact_predictor.ros.process import executor_of, message_class

SCENE = Path(__file__).parents[2] / "config/cube_tosses.yaml"
HALF = 0.05

RELIABLE = QoSProfile(depth=100)
BEST_EFFORT = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
POINTS = [[x, y, z] for x in (-HALF, HALF) for y in (-HALF, HALF) for z in (-HALF, HALF)]
FIXED_POINTS = ("-p", f"body.contact_points:={[number for point in POINTS for number in point]}")
# Nothing is lost or dropped then, however busy the machine is.
EVERY_SAMPLE = ("-p", "qos_overrides./odom.subscription.reliability:=reliable")


def running(*arguments):
    return running_node(SCENE, *arguments)


def odometry(k, frame="world", **changes):
    """A cube that falls, tilted; sample k of 100 a second."""
    message = Odometry()
    message.header.stamp.sec, hundredths = divmod(k, 100)
    message.header.stamp.nanosec = hundredths * 10_000_000
    message.header.frame_id, message.child_frame_id = frame, "cube"
    message.pose.pose.position.z = 0.5
    message.pose.pose.orientation.y, message.pose.pose.orientation.w = math.sin(0.2), math.cos(0.2)
    message.twist.twist.linear.z = changes.get("vz", -1.0)
    if "quaternion" in changes:
        message.pose.pose.orientation.y = message.pose.pose.orientation.w = changes["quaternion"]
    return message


def polygon(points=POINTS):
    message = PolygonStamped()
    message.header.frame_id = "cube"
    message.polygon.points = [Point32(x=x, y=y, z=z) for x, y, z in points]
    return message


@pytest.mark.slow
@pytest.mark.parametrize("qos", [RELIABLE, BEST_EFFORT], ids=["reliable", "best_effort"])
@pytest.mark.parametrize("executor", ["single", "events"])
def test_every_accepted_sample_is_answered_with_one_mode_and_one_prediction(peer, executor, qos):
    with running(*FIXED_POINTS, "-p", f"executor:={executor}"):
        samples = peer.found(peer.publisher(Odometry, "odom", qos))
        for k in range(30):
            # One after the other, so that none is dropped for a newer one on a busy machine.
            samples.publish(odometry(k))
            peer.until(lambda k=k: len(peer.heard["mode"]) > k and len(peer.heard["prediction"]) > k)
        stamps = [decode_diagnostic_array(data)[0].values["stamp"] for data in peer.heard["prediction"]]
        assert stamps == [str(k * 10_000_000) for k in range(30)]
        assert len(peer.heard["mode"]) == 30
        peer.until(lambda: peer.reported("samples.accepted") == "30" and peer.reported("cost_us.update.median"))


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_samples_before_the_geometry_are_refused_by_name_and_those_after_it_answered(peer, executor):
    with running(*EVERY_SAMPLE, "-p", f"executor:={executor}"):
        samples = peer.connected(peer.publisher(Odometry, "odom", RELIABLE))
        samples.publish(odometry(0))
        peer.until(lambda: peer.reported("refused.odom.NO_GEOMETRY") == "1")
        geometry = peer.connected(peer.publisher(PolygonStamped, "contact_geometry", RELIABLE))
        until_answered(peer, samples, lambda: geometry.publish(polygon()))


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_geometry_that_was_latched_before_the_node_started_is_found(peer, executor):
    peer.publisher(PolygonStamped, "contact_geometry", LATCHED).publish(polygon())
    with running("-p", f"executor:={executor}"):
        until_answered(peer, peer.connected(peer.publisher(Odometry, "odom", RELIABLE)))


def until_answered(peer, samples, before=bool):
    """Publish samples until the node answers to one of them."""
    stamps = iter(range(1, 10_000))
    peer.until(lambda: peer.heard["mode"], lambda: (before(), samples.publish(odometry(next(stamps)))))


@pytest.mark.slow
@pytest.mark.parametrize("qos", [RELIABLE, BEST_EFFORT, LATCHED], ids=["reliable", "best_effort", "latched"])
def test_geometry_that_changes_while_the_node_runs_is_taken_from_every_kind_of_publisher(peer, qos):
    with running():
        geometry = peer.connected(peer.publisher(PolygonStamped, "contact_geometry", qos))
        # One point is refused, and two are taken. Best effort may lose a message, so each is told until it is known.
        few = "refused.contact_geometry.TOO_FEW_POINTS"
        peer.until_reported(lambda report: few in report.values, lambda: geometry.publish(polygon(POINTS[:1])))
        for points in (POINTS, POINTS[:2]):
            geometry.publish(polygon(points))
        until_answered(peer, peer.connected(peer.publisher(Odometry, "odom", RELIABLE)))


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_bad_messages_are_counted_by_name_and_the_node_goes_on(peer, executor):
    with running(*FIXED_POINTS, *EVERY_SAMPLE, "-p", f"executor:={executor}") as node:
        samples = peer.connected(peer.publisher(Odometry, "odom", RELIABLE))
        samples.publish(odometry(10))
        peer.until(lambda: peer.heard["mode"])
        whole = serialize_message(odometry(11))
        for bad in (
            odometry(11, vz=math.nan),
            odometry(11, vz=math.inf),
            odometry(11, quaternion=0.0),
            odometry(11, quaternion=2.0),
            odometry(10),
            odometry(9),
            odometry(11, frame="elsewhere"),
            whole[:100],
            whole[:2],
        ):
            samples.publish(bad)
        samples.publish(odometry(12))
        counts = {
            "refused.odom.NOT_FINITE": "2",
            "refused.odom.BAD_QUATERNION": "2",
            "refused.odom.STAMP_REPEATED": "1",
            "refused.odom.STAMP_WENT_BACK": "1",
            "refused.odom.WRONG_FRAME": "1",
            # None without any bytes: Fast DDS never gets past one on its way to a reliable subscription.
            "refused.odom.MALFORMED": "2",
        }
        # A warning is over in a second, so it is looked for in each report that comes.
        peer.until_reported(lambda report: report.level > OK and counts.items() <= report.values.items())
        peer.until(lambda: len(peer.heard["mode"]) == 2)
        good = iter(range(13, 10_000))
        peer.until_reported(lambda report: report.level == OK, lambda: samples.publish(odometry(next(good))))
        said = node.complained()
        assert "refused a message on odom NOT_FINITE: linear[2] is nan: look at its source" in said
        assert "odom WRONG_FRAME: frame_id is 'elsewhere', but 'world' is wanted: correct it, or support.frame" in said
        assert "Traceback" not in node.complained()


@pytest.mark.slow
def test_publishers_and_subscribers_that_qos_keeps_apart_from_the_node_are_named(peer):
    with running(*FIXED_POINTS, *EVERY_SAMPLE):
        peer.until(lambda: peer.reported("incompatible_qos") == "0")
        peer.publisher(Odometry, "odom", BEST_EFFORT)
        named = peer.until_reported(lambda report: report.values["incompatible_qos"] == "1").message
        assert "the publisher on /odom from peer is best effort, but" in named
        peer.node.create_subscription(UInt8, "/impact_predictor/mode", print, LATCHED)
        peer.until(lambda: peer.reported("incompatible_qos") == "2")


@pytest.mark.slow
def test_publishers_and_subscribers_of_another_type_are_named_in_diagnostics_and_in_the_log(peer):
    with running(*FIXED_POINTS) as node:
        peer.publisher(PolygonStamped, "odom", RELIABLE)
        wanted = "peer publishes geometry_msgs/msg/PolygonStamped on /odom, where nav_msgs/msg/Odometry is wanted"
        assert wanted in peer.until_reported(lambda report: report.values["incompatible_type"] == "1").message
        peer.until(lambda: f"nothing has come on /odom for 5 s: {wanted}" in node.complained())
        # The peer itself hears this topic, and one participant knows a topic by one type.
        with peer_of_node(()) as viewer:
            viewer.node.create_subscription(UInt8, "/impact_predictor/prediction", print, RELIABLE)
            peer.until_reported(lambda report: report.values["incompatible_type"] == "2" and report.level == ERROR)


@pytest.mark.slow
def test_stamps_are_compared_with_the_simulated_clock_where_there_is_one(peer):
    with running(*FIXED_POINTS, "-p", "use_sim_time:=true") as node:
        samples = peer.found(peer.publisher(Odometry, "odom", RELIABLE))
        clock = peer.publisher(Clock, "/clock", RELIABLE)

        def tell(k, ahead):
            clock.publish(Clock(clock=odometry(k).header.stamp))
            samples.publish(odometry(k + ahead))

        steps = iter(range(1, 10_000))
        peer.until_reported(
            lambda report: report.level == OK and abs(float(report.values.get("samples.latency", "1"))) < 0.2,
            lambda: tell(next(steps), 0),
        )
        said = "stamps on odom are 3.0 s ahead of the simulated clock"
        peer.until_reported(lambda report: report.message.startswith(said), lambda: tell(next(steps), 300))
        assert said in node.complained()


@pytest.fixture
def node_without_peers(monkeypatch):
    """The node in this process, and the names of what it encodes."""
    from impact_predictor.ros import predictor_node, topics

    encoded = []

    def counting(name, output):
        return output._replace(encode=lambda prediction: encoded.append(name) or output.encode(prediction))

    counted = {name: counting(name, output) for name, output in OUTPUTS.items()}
    monkeypatch.setattr(topics, "outputs_of", lambda messages: counted)
    rclpy.init(args=["--ros-args", "--params-file", str(SCENE), *FIXED_POINTS])
    node = predictor_node.PredictorNode()
    yield node, encoded
    node.destroy_node()
    rclpy.shutdown()


def test_nothing_is_encoded_for_a_topic_without_subscribers(node_without_peers):
    node, encoded = node_without_peers
    node._bodies[""]._on_odometry(serialize_message(odometry(0)))
    assert encoded == []
    node.create_subscription(message_class(OUTPUTS["mode"].type_name), "~/mode", print, 10)
    until(node._bodies[""].outputs["mode"].get_subscription_count)
    node._bodies[""]._on_odometry(serialize_message(odometry(1)))
    assert encoded == ["mode"]


def test_nothing_is_drawn_until_somebody_looks_nor_when_nobody_does_any_more(node_without_peers):
    node, _ = node_without_peers
    markers = node._reporter.markers
    shown = []
    viewer = rclpy.create_node("viewer", use_global_arguments=False)
    looking = viewer.create_subscription(
        message_class("visualization_msgs/msg/MarkerArray"), "/impact_predictor/markers", shown.append, 10, raw=True
    )
    until(lambda: markers.publisher.get_subscription_count() == 1)
    node._on_second()
    node._bodies[""]._on_odometry(serialize_message(odometry(0)))
    assert "impact_predictor.ros.markers.scene" in sys.modules
    executor = SingleThreadedExecutor()
    executor.add_node(viewer)
    until(lambda: executor.spin_once(timeout_sec=0.02) or shown)
    viewer.destroy_subscription(looking)
    until(lambda: markers.publisher.get_subscription_count() == 0)
    node._on_second()
    assert markers.drawing is None
    executor.shutdown()
    viewer.destroy_node()


def until(condition):
    patience = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < patience
        time.sleep(0.01)


def test_without_an_events_executor_the_single_threaded_one_is_used_and_one_sentence_says_so(
    node_without_peers, monkeypatch, capfd
):
    node, _ = node_without_peers
    monkeypatch.setitem(sys.modules, "rclpy.experimental", None)
    executor = executor_of(node, "events")
    assert type(executor) is SingleThreadedExecutor
    executor.shutdown()
    said = capfd.readouterr().err
    assert said.count("\n") == 1
    assert "this rclpy has no events executor, so the single-threaded one is used" in said
