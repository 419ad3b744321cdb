"""The predictor beside a controller: from the call that publishes a sample to the return of the answer's publish.

    python benchmarks/bench_latency.py [SECONDS] [--real-time]

Four processes over real DDS: a publisher of contact points and pose at 500 Hz, of a trotting machine with four feet;
the predictor with config/walker_hyq.yaml; a bare node that takes the same messages as bytes and publishes the pose as
often as the predictor answers; and a sink that listens to both. Half a second goes to the one, the next to the other,
in turn: what the bare node takes is the machine's, ROS's and the publisher's, and the difference the predictor's.

Each sample has its own stamp. The publisher notes the time right before it publishes the contact points of a stamp, so
that both messages count; the nodes note the time right after their last answer to that stamp was published; the clock
is the machine's monotonic one, which all processes share. Only this benchmark makes the predictor note times. What the
sink has not received is lost. Stolen is the time that the host of a virtual machine gave to others.

With --real-time the processes run under SCHED_FIFO, as root may, so that other programs of a busy machine do not count,
and both nodes, which work in turn, have a processor without publisher and sink.
"""

from __future__ import annotations

import gc
import os
import pickle
import struct
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from trot import trot

from impact_predictor.prediction.types import Prediction
from impact_predictor.ros.messages import ODOMETRY, OUTPUTS, POLYGON, encode_odometry, encode_polygon
from impact_predictor.ros.process import Stop, message_class, run, spin
from impact_predictor.ros.processes import Child, ros_environment

SCENE: Final = Path(__file__).resolve().parents[1] / "config/walker_hyq.yaml"
RATE: Final = 500.0
SECONDS: Final = 20.0
SETTLED: Final = 1.0
"""Seconds of answers that do not count: the first ones find caches empty."""
PARTS: Final = (50, 90, 99, 99.9, 100)
EXECUTORS: Final = ("single", "events")
BY_CONTROLLER: Final = ("post_impact", "mode")
"""What a controller listens to."""
CASES: Final = {"four feet": BY_CONTROLLER, "four feet, everything heard": tuple(OUTPUTS)}
"""What is heard in each."""
TOPICS: Final = {"contact_geometry": POLYGON, "odom": ODOMETRY}
QUEUE: Final = 100
REAL_TIME: Final = "--real-time"
TURN: Final = 250
"""Samples that a node gets in its turn."""
BARE: Final = "bare"
INPUTS: Final = {"predictor": "", BARE: "bare/"}
"""The nodes, and what their inputs begin with."""
STAMP: Final = struct.Struct("<iI")
"""Of a message, after the four bytes that tell its encoding."""
LOAD: Final = "load average"
ROUGH: Final = (LOAD, "later than 1 ms, %: predictor", "later than 1 ms, %: bare node")
"""Figures with a digit behind the point."""
PRIORITY: Final = 10
"""Of SCHED_FIFO, where it is asked for."""


def publish(stop: Stop, file: str, seconds: str) -> int:
    """Publish contact points, then the pose, at each step, to each node in its turn; note when, by the stamp."""
    from rclpy.node import Node

    node = Node("publisher", use_global_arguments=False)
    publishers = [
        [node.create_publisher(message_class(kind), prefix + topic, QUEUE) for topic, kind in TOPICS.items()]
        for prefix in INPUTS.values()
    ]
    while not all(one.get_subscription_count() for both in publishers for one in both):
        if stop.wait(0.05):
            return 1
    stop.wait(1.0)  # the other side finds this one by itself
    messages = [
        (sample.stamp, encode_polygon(geometry), encode_odometry(sample))
        for geometry, sample in trot(RATE, float(seconds), time.time_ns())
    ]
    called: list[dict[int, int]] = [{} for _ in INPUTS]
    begin, step = time.monotonic(), 0
    for first in range(0, len(messages), TURN):
        for notes, (points, poses) in zip(called, publishers, strict=True):
            for stamp, geometry, sample in messages[first : first + TURN]:
                time.sleep(max(0.0, begin + step / RATE - time.monotonic()))
                step += 1
                notes[stamp] = time.monotonic_ns()
                points.publish(geometry)
                poses.publish(sample)
    stop.wait(0.5)
    node.destroy_node()
    return _write(file, dict(zip(INPUTS, called, strict=True)))


def pass_on(stop: Stop, file: str, executor: str, *names: str) -> int:
    """The bare node: publish each pose as it is, once for each answer of the predictor."""
    from rclpy.node import Node
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    node = Node(BARE, use_global_arguments=False)
    outlets = [node.create_publisher(message_class(ODOMETRY), INPUTS[BARE] + name, QUEUE) for name in names]
    returned: dict[int, int] = {}

    def take(data: bytes) -> None:
        for one in outlets:
            one.publish(data)
        seconds, nanoseconds = STAMP.unpack_from(data, 4)
        returned[seconds * 10**9 + nanoseconds] = time.monotonic_ns()

    takers = {POLYGON: lambda _: None, ODOMETRY: take}
    qos = QoSProfile(depth=QUEUE, reliability=ReliabilityPolicy.BEST_EFFORT)
    for topic, kind in TOPICS.items():
        node.create_subscription(message_class(kind), INPUTS[BARE] + topic, takers[kind], qos, raw=True)
    gc.freeze()  # as the predictor does
    spin(node, stop, lambda: len(returned), executor)
    node.destroy_node()
    return _write(file, returned)


def predict(file: str) -> int:
    """The predictor's own program, but for a note of when its answers to a stamp are published."""
    from impact_predictor.ros.node import main as run_node
    from impact_predictor.ros.reporter import Reporter

    answered = Reporter.answered
    returned: dict[int, tuple[int, float, float]] = {}

    def note(self: Reporter, name: str, body: str, prediction: Prediction, *costs: Any) -> None:
        # It is called right after the last answer is published; `costs` are the latency, the update's and the begin.
        returned[prediction.sample.stamp] = time.monotonic_ns(), costs[1], time.process_time()
        answered(self, name, body, prediction, *costs)

    Reporter.answered = note  # type: ignore[assignment, method-assign]
    return run_node([sys.argv[0], *sys.argv[sys.argv.index("--ros-args") :]]) or _write(file, returned)


def listen(stop: Stop, file: str, *names: str) -> int:
    """Hear answers; count the modes, of which each sample has one."""
    from rclpy.node import Node

    node = Node("sink", use_global_arguments=False)
    heard = 0

    def count(_: bytes) -> None:
        nonlocal heard
        heard += 1

    def ignore(_: bytes) -> None:
        pass

    for name in names:
        kind, take = message_class(OUTPUTS[name].type_name), count if name == "mode" else ignore
        node.create_subscription(kind, f"/impact_predictor/{name}", take, QUEUE, raw=True)
        node.create_subscription(message_class(ODOMETRY), INPUTS[BARE] + name, ignore, QUEUE, raw=True)
    spin(node, stop, lambda: heard)
    node.destroy_node()
    return _write(file, heard)


def _write(file: str, content: object) -> int:
    Path(file).write_bytes(pickle.dumps(content))
    return 0


ROLES: Final = ("publish", "predict", "pass_on", "listen")


def measure(executor: str, heard: tuple[str, ...], seconds: float, *how: str) -> dict[str, float]:
    """Figures of one run by their names."""
    # Here, so that the processes under test load what the program itself does, and no more.
    import numpy as np

    with TemporaryDirectory() as folder, ExitStack() as stack:
        files = {role: str(Path(folder) / role) for role in ROLES}
        environment = ros_environment()

        def start(role: str, *more: str) -> Child:
            return stack.enter_context(Child(role, environment, __file__, *how, role, files[role], *more))

        arguments = ("--ros-args", "--params-file", str(SCENE), "-p", f"executor:={executor}")
        sink, node, bare = start("listen", *heard), start("predict", *arguments), start("pass_on", executor, *heard)
        publisher, stolen = start("publish", str(seconds + SETTLED)), stolen_time()
        while not publisher.ended:
            time.sleep(0.1)
            for one in (sink, node, bare):
                one.check()
        stolen = stolen_time() - stolen
        for one in (publisher, node, bare, sink):
            one.end()
        called, returned, passed_on, received = (
            pickle.loads(Path(files[role]).read_bytes()) for role in ("publish", "predict", "pass_on", "listen")
        )
    stamps = sorted(called["predictor"])[round(RATE * SETTLED) :]
    answered = [stamp for stamp in stamps if stamp in returned]
    latency = np.array([returned[stamp][0] - called["predictor"][stamp] for stamp in answered]) * 1e-3
    of_bare = np.array([passed_on[one] - called[BARE][one] for one in stamps if one in passed_on]) * 1e-3
    update = np.array([returned[stamp][1] for stamp in answered]) * 1e6
    if len(answered) < 2 or not len(of_bare):
        raise SystemExit("a node answered next to no sample; see what the predictor says on /diagnostics")
    parts = {f"p{part}": (np.percentile(latency, part), np.percentile(of_bare, part)) for part in PARTS}
    return {
        "samples": len(stamps),
        "not answered": len(stamps) - len(answered),
        "lost to the sink": len(returned) - received,
        **{f"{part} us: predictor": float(ours) for part, (ours, _) in parts.items()},
        **{f"{part} us: bare node": float(theirs) for part, (_, theirs) in parts.items()},
        "p50 us: difference": float(parts["p50"][0] - parts["p50"][1]),
        "later than 1 ms, %: predictor": float(100.0 * np.mean(latency > 1000.0)),
        "later than 1 ms, %: bare node": float(100.0 * np.mean(of_bare > 1000.0)),
        "update us: p50": float(np.median(update)),
        "update us: p99": float(np.percentile(update, 99)),
        "node's CPU us": (returned[answered[-1]][2] - returned[answered[0]][2]) / (len(answered) - 1) * 1e6,
        "stolen, ms of each s": stolen / (2.0 * seconds) * 1e3,
        LOAD: os.getloadavg()[0],
    }


def stolen_time() -> float:
    """Seconds of all processors that the host of this virtual machine gave to others."""
    return int(Path("/proc/stat").read_text(encoding="ascii").split()[8]) / os.sysconf("SC_CLK_TCK")


def main(words: list[str]) -> int:
    """Print the latencies for each case and both executors."""
    from rich.console import Console
    from rich.table import Table

    how = [word for word in words if word == REAL_TIME]
    seconds = next((float(word) for word in words if word not in how), SECONDS)
    title = f"us from the publisher's call to the return of the predictor's publish; {RATE:.0f} Hz, {seconds:g} s each"
    columns: dict[str, list[str]] = {}
    for case, heard in CASES.items():
        for executor in EXECUTORS:
            figures = measure(executor, heard, seconds, *how)
            columns[f"{case}\n{executor}"] = [f"{number:.{int(name in ROUGH)}f}" for name, number in figures.items()]
    table = Table("", *columns, title=title)
    for name, *numbers in zip(figures, *columns.values(), strict=True):
        table.add_row(name, *numbers)
    Console(width=120).print(table, f"{os.cpu_count()} processors" + (", SCHED_FIFO" if how else ""))
    return 0


def play(words: list[str]) -> int:
    """Play a role as a process of its own."""
    name, *arguments = [word for word in words if word != REAL_TIME]
    if REAL_TIME in words:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        *others, last = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, [last] if name in ("predict", "pass_on") else others or [last])
    if name == "predict":
        return predict(arguments[0])
    roles: dict[str, Callable[..., int]] = {"publish": publish, "pass_on": pass_on, "listen": listen}
    return run(lambda stop: roles[name](stop, *arguments), sys.argv)


if __name__ == "__main__":
    given = sys.argv[1:]
    sys.exit(play(given) if set(ROLES) & set(given) else main(given))
