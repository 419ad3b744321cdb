"""What the node goes through in a long life, over real DDS: clocks, bursts, restarts, new shapes, and its end."""

import math
import random
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")

from geometry_msgs.msg import PolygonStamped
from graph import PATIENCE, running_node
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.qos import QoSProfile

from impact_predictor.bags.read import read_messages
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.monitor import Monitor
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import Geometry, Status
from impact_predictor.ros.messages import (
    ODOMETRY,
    OUTPUTS,
    decode_diagnostic_array,
    decode_odometry,
    encode_odometry,
    encode_polygon,
)

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "config/cube_tosses.yaml"
POINTS = tuple((x, y, z) for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05))
FIXED_POINTS = ("-p", f"body.contact_points:={[number for point in POINTS for number in point]}")
# Nothing is dropped then, however busy the machine is.
EVERY_SAMPLE = ("-p", "qos_overrides./odom.subscription.reliability:=reliable")
RELIABLE = QoSProfile(depth=1000)
HOUR = 3600 * 10**9


@pytest.fixture(scope="module")
def toss():
    """A recorded toss of the cube: 60 samples that follow each other."""
    messages = read_messages(ROOT / "examples/cube_tosses", {"/cube/odom": ODOMETRY})
    return [decode_odometry(next(messages).data) for _ in range(60)]


def shifted(samples, nanoseconds):
    return [sample._replace(stamp=sample.stamp + nanoseconds) for sample in samples]


def troubled(toss):
    """The samples of one source to which everything happens that happens to clocks and networks."""
    second = toss[-1].stamp - toss[0].stamp + 10**9
    disordered = toss[:]
    random.Random(1).shuffle(disordered)
    return [
        *toss,
        *shifted(toss, HOUR),  # the clock is set forward,
        *shifted(toss, -HOUR),  # and back, before where it was;
        *toss,  # a bag
        *toss,  # is played in a loop;
        *shifted([one for sample in toss for one in (sample, sample)], second),  # each message comes twice,
        *shifted(disordered, 2 * second),  # in any order,
        *shifted(toss, 2 * second),  # and a source begins anew a second before its end;
        *[one._replace(stamp=toss[0].stamp) for one in toss[:20]],  # then it has no clock any more,
        *shifted(toss, 9 * HOUR),  # and all is well.
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("executor", "simulated"), [("single", "false"), ("events", "true")], ids=["single", "events_with_simulated_time"]
)
def test_whatever_happens_to_clocks_and_order_the_node_answers_like_the_library_byte_for_byte(
    peer, toss, executor, simulated
):
    sent = troubled(toss)
    given = {**read_parameters(SCENE), "body.contact_points": [number for point in POINTS for number in point]}
    monitor = Monitor(scenes_of(validate(given)))
    answers = [monitor.update("", sample) for sample in sent]
    accepted = [answer for answer in answers if answer.status is Status.ACCEPTED]
    refused = {answer.status for answer in answers} - {Status.ACCEPTED}
    assert refused == {Status.STAMP_REPEATED, Status.STAMP_WENT_BACK}
    assert any(answer.score for answer in accepted)
    expected = {
        name: [data for data in map(output.encode, accepted) if data is not None] for name, output in OUTPUTS.items()
    }
    options = (*FIXED_POINTS, *EVERY_SAMPLE, "-p", f"executor:={executor}", "-p", f"use_sim_time:={simulated}")
    with running_node(SCENE, *options, numba=True) as node:
        # What the node answers before it has found its listeners nobody hears.
        samples = peer.found(peer.publisher(Odometry, "odom", RELIABLE))
        half, whole = len(sent) // 2, len(sent)
        for begin, end in ((0, half), (half, whole)):
            # A burst of as many as may wait, again and again.
            for first in range(begin, end, 50):
                for sample in sent[first : min(first + 50, end)]:
                    samples.publish(encode_odometry(sample))
                count = sum(answer.status is Status.ACCEPTED for answer in answers[: min(first + 50, end)])
                peer.until(lambda count=count: len(peer.heard["prediction"]) >= count)
            if end == half:
                # The source is another process from now on: to the node it is another publisher.
                peer.node.destroy_publisher(samples)
                peer.until(lambda: not peer.node.count_publishers("/odom"))
                samples = peer.connected(peer.publisher(Odometry, "odom", RELIABLE))
        peer.until(lambda: all(len(peer.heard[name]) >= len(data) for name, data in expected.items()))
        assert {name: peer.heard[name] for name in OUTPUTS} == expected
        refusals = len(answers) - len(accepted)
        peer.until(lambda: sum(int(n) for key, n in peer.report().values.items() if "refused." in key) == refusals)
        assert "Traceback" not in node.complained()


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_contact_points_that_change_in_mid_flight_count_from_the_next_sample_on(peer, toss, executor):
    moving = ("-p", "odom.twist:=message")  # its samples have one pose
    with running_node(SCENE, *EVERY_SAMPLE, *moving, "-p", f"executor:={executor}") as node:
        shapes = peer.connected(peer.publisher(PolygonStamped, "contact_geometry", RELIABLE))
        samples = peer.connected(peer.publisher(Odometry, "odom", RELIABLE))
        tilted = (0.0, math.sin(0.05), 0.0, math.cos(0.05))
        falling = toss[0]._replace(
            position=(0.0, 0.0, 0.08), orientation=tilted, linear=(0.0, 0.0, -1.0), angular=(0.0, 0.0, 0.0)
        )
        stamps = iter(range(10**9, 10**12, 10**7))

        def fall():
            samples.publish(encode_odometry(falling._replace(stamp=next(stamps))))

        def strikes_with():
            """The points with which the body is announced to strike."""
            heard = peer.heard["prediction"]
            return decode_diagnostic_array(heard[-1])[0].values.get("new") if heard else None

        def tell_and_fall():
            shapes.publish(encode_polygon(Geometry(0, "", POINTS)))
            fall()

        # The lower edge of the cube; a message of best effort may come before the node has found its publisher.
        peer.until(lambda: strikes_with() == "4 6", tell_and_fall)
        # Then that of its hind side, drawn out, and then the only lower point that is left.
        for count, size, striking in ((4, 2.0, "0 2"), (0, 1.0, "0 2"), (2, 1.0, "0")):
            points = tuple((x, size * y, z) for x, y, z in POINTS[:count])
            shapes.publish(encode_polygon(Geometry(0, "", points)))
            peer.until(lambda striking=striking: strikes_with() == striking, fall)
        peer.until(lambda: peer.reported("refused.contact_geometry.TOO_FEW_POINTS") == "1")
        assert "Traceback" not in node.complained()


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["single", "events"])
def test_sigint_in_the_midst_of_samples_ends_the_node_in_order_after_the_last_of_them(peer, toss, executor):
    with running_node(SCENE, *FIXED_POINTS, *EVERY_SAMPLE, "-p", f"executor:={executor}") as node:
        samples = peer.connected(peer.publisher(Odometry, "odom", RELIABLE))
        peer.until(lambda: peer.node.count_publishers("/impact_predictor/mode"))
        for sample in toss:
            samples.publish(encode_odometry(sample))
        # What is acknowledged has arrived, and so is answered before the end.
        assert samples.wait_for_all_acked(Duration(seconds=PATIENCE))
        node.end()
        peer.until(lambda: len(peer.heard["mode"]) == len(toss))
        assert "[INFO]" in node.complained()
        assert node.complained().count("\n") == 1
