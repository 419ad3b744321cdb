"""The processes of `bench_node.py`: a source of samples, a bare node beside the predictor, and a listener.

    python benchmarks/node_load.py bare single|events
    python benchmarks/node_load.py publish FILE SCENE PROCESS,PROCESS SEGMENTS
    python benchmarks/node_load.py listen FILE

The time at which a sample is published (ns of the machine's monotonic clock) travels as the first number of its pose's
covariance, which both nodes pass on as it is. Publisher and listener write a pickle at their end.
"""

from __future__ import annotations

import json
import pickle
import struct
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

if TYPE_CHECKING:
    from impact_predictor.ros.process import Stop

ROOT: Final = Path(__file__).resolve().parents[1]
TOSSES: Final = ROOT / "examples/cube_tosses"
HALF: Final = 0.05
"""Half the side of the cube in m."""
BARE: Final = "bare"
PREDICTOR: Final = "impact_predictor"
NODES: Final = (BARE, PREDICTOR)
INPUTS: Final = {BARE: "/bare/odom", PREDICTOR: "/odom"}
OUTPUTS: Final = {BARE: "/bare/post_impact", PREDICTOR: "/impact_predictor/post_impact"}
READY: Final = "ready"
QUEUE: Final = 100
HEARD_QUEUE: Final = 10_000
SETTLING: Final = 1.2
"""Seconds after each segment, in which the node answers what waits and reports on itself."""
STEP: Final = 6_757_000
"""ns between the stamps of samples, those of the tosses, at whatever rate they are published."""
PLACE: Final = 92
"""Of the pose's covariance, in the bytes of a message with the frames of the tosses."""


class Segment(NamedTuple):
    """What the publisher sends to one node: at a rate in Hz, for some seconds."""

    node: str
    rate: float
    seconds: float


class Sent(NamedTuple):
    """A segment that was sent: how many, from when to when (monotonic ns); the node's CPU time in s."""

    node: str
    rate: float
    samples: int
    begin: int
    end: int
    cpu: float


def bare(executor: str) -> None:
    """Pass each nav_msgs/Odometry on, as one writes it with rclpy: a message in, the same message out."""
    import rclpy
    from nav_msgs.msg import Odometry
    from rclpy.node import Node
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    rclpy.init()
    node = Node(BARE)
    publisher = node.create_publisher(Odometry, OUTPUTS[BARE], QUEUE)
    # The QoS of the predictor's own topics.
    best_effort = QoSProfile(depth=QUEUE, reliability=ReliabilityPolicy.BEST_EFFORT)
    node.create_subscription(Odometry, INPUTS[BARE], publisher.publish, best_effort)
    runner: Any
    if executor == "events":
        from rclpy.experimental import EventsExecutor

        runner = EventsExecutor()
    else:
        from rclpy.executors import SingleThreadedExecutor

        runner = SingleThreadedExecutor()
    runner.add_node(node)
    try:
        while True:
            runner.spin_once(timeout_sec=1.0)
    except KeyboardInterrupt:
        pass


def samples_of(scene: str) -> list[bytearray]:
    """The messages of a scene, to be sent over and over."""
    from impact_predictor.bags.read import read_messages
    from impact_predictor.prediction.types import Sample
    from impact_predictor.ros.messages import ODOMETRY, encode_odometry

    if scene == "tosses":
        return [bytearray(message.data) for message in read_messages(str(TOSSES), {"/cube/odom": ODOMETRY})]
    zero, none = (0.0, 0.0, 0.0), (0.0,) * 36
    rest = Sample(0, "world", "cube", (0.0, 0.0, HALF), (0.0, 0.0, 0.0, 1.0), zero, zero, none, none)
    return [bytearray(encode_odometry(rest))]


def publish(stop: Stop, file: str, scene: str, processes: str, segments: str) -> int:
    """Publish segment after segment; note what was sent, and what that cost the nodes."""
    from rclpy.node import Node

    from impact_predictor.ros.messages import ODOMETRY
    from impact_predictor.ros.process import message_class

    ids = dict(zip(NODES, map(int, processes.split(",")), strict=True))
    node = Node("source", use_global_arguments=False)
    publishers = {name: node.create_publisher(message_class(ODOMETRY), topic, QUEUE) for name, topic in INPUTS.items()}
    samples = samples_of(scene)
    while not all(one.get_subscription_count() for one in publishers.values()):
        if stop.wait(0.01):
            return 1
    print(READY, flush=True)
    number = 0
    sent = []
    for segment in (Segment(*words) for words in json.loads(segments)):
        if stop.wait(SETTLING):
            return 1
        publisher, process = publishers[segment.node], ids[segment.node]
        count = round(segment.rate * segment.seconds)
        cpu, begin = cpu_time(process), time.monotonic_ns()
        for k in range(count):
            wait = begin * 1e-9 + k / segment.rate - time.monotonic()
            if wait > 0.0:
                time.sleep(wait)
            number += 1
            data = samples[number % len(samples)]
            struct.pack_into("<iI", data, 4, *divmod(number * STEP, 10**9))
            struct.pack_into("<d", data, PLACE, float(time.monotonic_ns()))
            publisher.publish(bytes(data))
        end = time.monotonic_ns()
        stop.wait(0.1)
        cost = cpu_time(process) - cpu
        sent.append(Sent(segment.node, segment.rate, count, begin, end, cost))
    stop.wait(SETTLING)
    node.destroy_node()
    Path(file).write_bytes(pickle.dumps([tuple(one) for one in sent]))
    return 0


def cpu_time(process: int) -> float:
    """Seconds of CPU time of the threads of a process so far."""
    return sum(int(one.read_text().split()[0]) for one in Path(f"/proc/{process}/task").glob("*/schedstat")) * 1e-9


def resident(process: int) -> float:
    """MB of a process in memory."""
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * 4096e-6


def listen(stop: Stop, file: str) -> int:
    """Note when each answer was sent for and received, and what the predictor reports; until asked to end."""
    from rclpy.node import Node

    from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, decode_diagnostic_array
    from impact_predictor.ros.process import message_class, spin

    node = Node("listener", use_global_arguments=False)
    heard: dict[str, list[tuple[float, int]]] = {name: [] for name in NODES}
    reports: list[tuple[int, dict[str, str]]] = []

    def note(data: bytes, times: list[tuple[float, int]]) -> None:
        times.append((struct.unpack_from("<d", data, PLACE)[0], time.monotonic_ns()))

    def read(data: bytes) -> None:
        reports.append((time.monotonic_ns(), decode_diagnostic_array(data)[0].values))

    for name, topic in OUTPUTS.items():
        kept = heard[name]
        node.create_subscription(
            message_class(ODOMETRY), topic, lambda data, kept=kept: note(data, kept), HEARD_QUEUE, raw=True
        )
    node.create_subscription(message_class(DIAGNOSTIC_ARRAY), "/diagnostics", read, 10, raw=True)
    spin(node, stop, lambda: sum(map(len, heard.values())), "events")
    Path(file).write_bytes(pickle.dumps((heard, reports)))
    return 0


if __name__ == "__main__":
    role, *arguments = sys.argv[1:]
    if role == "bare":
        bare(*arguments)
    else:
        from impact_predictor.ros.process import run

        play = publish if role == "publish" else listen
        sys.exit(run(lambda stop: play(stop, *arguments), sys.argv[:1]))
