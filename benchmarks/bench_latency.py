"""The predictor beside a controller: from the call that publishes a sample to the return of the answer's publish.

    python benchmarks/bench_latency.py [SECONDS] [--real-time]

Three processes over real DDS: a publisher of contact points and pose of a trotting machine with four feet, at 500 Hz;
the predictor with config/walker_hyq.yaml; and a sink that listens to its answers. Each sample has its own stamp. The
publisher notes the time right before it publishes the contact points of a stamp, so that both messages count; the node
notes the time right after its last answer to that stamp was published; the clock is the machine's monotonic one, which
all processes share. Only this benchmark makes the node note times. What the sink has not received is lost.

With --real-time the three processes run under SCHED_FIFO, as root may, so that other programs of a busy machine do not
count. The CPU time that the node spends on a sample hardly depends on them.
"""

from __future__ import annotations

import os
import pickle
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from impact_predictor.ros.messages import ODOMETRY, OUTPUTS, POLYGON, encode_odometry, encode_polygon
from impact_predictor.ros.process import Stop, message_class, run, spin
from impact_predictor.ros.processes import Child, ros_environment
from impact_predictor.scenarios.walking.trot import trot

PARAMETERS: Final = Path(__file__).resolve().parents[1] / "config/walker_hyq.yaml"
RATE: Final = 500.0
SECONDS: Final = 20.0
SETTLED: Final = 1.0
"""Seconds of answers that do not count: the first ones find caches empty."""
EXECUTORS: Final = ("single", "events")
HEARD: Final = {
    "heard: post_impact, mode": ("post_impact", "mode"),
    "heard: everything": tuple(OUTPUTS),
}
QUEUE: Final = 100
REAL_TIME: Final = "--real-time"
LOAD: Final = "load average"
PRIORITY: Final = 10
"""Of SCHED_FIFO, where it is asked for."""


def publish(stop: Stop, file: str, seconds: str) -> int:
    """Publish contact points, then the pose, at each step; note when, by the stamp."""
    from rclpy.node import Node

    node = Node("publisher", use_global_arguments=False)
    points = node.create_publisher(message_class(POLYGON), "contact_geometry", QUEUE)
    poses = node.create_publisher(message_class(ODOMETRY), "odom", QUEUE)
    while not (points.get_subscription_count() and poses.get_subscription_count()):
        if stop.wait(0.05):
            return 1
    stop.wait(1.0)  # the other side finds this one by itself
    begin = time.time_ns()
    messages = [
        (sample.stamp, encode_polygon(geometry), encode_odometry(sample))
        for geometry, sample in trot(RATE, float(seconds), begin)
    ]
    called: dict[int, int] = {}
    first = time.monotonic_ns()
    for stamp, geometry, sample in messages:
        time.sleep(max(0.0, (first + stamp - begin - time.monotonic_ns()) * 1e-9))
        called[stamp] = time.monotonic_ns()
        points.publish(geometry)
        poses.publish(sample)
    stop.wait(0.5)
    node.destroy_node()
    return _write(file, called)


def predict(file: str) -> int:
    """The predictor's own program, but for a note of when its answers to a stamp are published."""
    from impact_predictor.ros.node import main as run_node
    from impact_predictor.ros.reporter import Reporter

    answered = Reporter.answered
    returned: dict[int, tuple[int, float, float]] = {}

    def note(self: Reporter, name: str, stamp: int, latency: int, update: float, began: float) -> None:
        # It is called right after the last answer is published.
        returned[stamp] = time.monotonic_ns(), update, time.process_time()
        answered(self, name, stamp, latency, update, began)

    Reporter.answered = note  # type: ignore[method-assign]
    return run_node(sys.argv) or _write(file, returned)


def listen(stop: Stop, file: str, *names: str) -> int:
    """Hear answers; count them by their topics."""
    from rclpy.node import Node

    node = Node("sink", use_global_arguments=False)
    counts = dict.fromkeys(names, 0)

    def counter(name: str) -> Callable[[bytes], None]:
        def count(_: bytes) -> None:
            counts[name] += 1

        return count

    for name in names:
        kind = message_class(OUTPUTS[name].type_name)
        node.create_subscription(kind, f"/impact_predictor/{name}", counter(name), QUEUE, raw=True)
    spin(node, stop, lambda: sum(counts.values()))
    node.destroy_node()
    return _write(file, counts)


def _write(file: str, content: object) -> int:
    Path(file).write_bytes(pickle.dumps(content))
    return 0


ROLES: Final = ("publish", "predict", "listen")


def measure(executor: str, heard: tuple[str, ...], seconds: float, *how: str) -> dict[str, float]:
    """Figures of one run by their names."""
    # Here, so that the processes under test load what the program itself does, and no more.
    import numpy as np

    with TemporaryDirectory() as folder, ExitStack() as stack:
        files = {role: str(Path(folder) / role) for role in ROLES}
        environment = ros_environment()

        def start(role: str, *more: str) -> Child:
            return stack.enter_context(Child(role, environment, __file__, *how, role, files[role], *more))

        arguments = ("--ros-args", "--params-file", str(PARAMETERS), "-p", f"executor:={executor}")
        sink, node = start("listen", *heard), start("predict", *arguments)
        publisher = start("publish", str(seconds + SETTLED))
        while not publisher.ended:
            time.sleep(0.1)
            sink.check()
            node.check()
        for one in (publisher, node, sink):
            one.end()
        called, returned, counts = (pickle.loads(Path(files[role]).read_bytes()) for role in ROLES)
    stamps = sorted(called)[round(RATE * SETTLED) :]
    answered = [stamp for stamp in stamps if stamp in returned]
    latency = np.array([returned[stamp][0] - called[stamp] for stamp in answered]) * 1e-3
    update = np.array([returned[stamp][1] for stamp in answered]) * 1e6
    if len(answered) < 2:
        raise SystemExit("the node answered next to no sample; see what it says on /diagnostics")
    return {
        "samples": len(stamps),
        "not answered": len(stamps) - len(answered),
        "lost to the sink": len(returned) - counts["mode"],
        **{f"p{part} us": float(np.percentile(latency, part)) for part in (50, 90, 99, 99.9)},
        "max us": float(latency.max()),
        "update p50 us": float(np.median(update)),
        "update p99 us": float(np.percentile(update, 99)),
        "node's CPU us": (returned[answered[-1]][2] - returned[answered[0]][2]) / (len(answered) - 1) * 1e6,
        LOAD: os.getloadavg()[0],
    }


def main(words: list[str]) -> int:
    """Print the latencies for both executors and two kinds of listeners."""
    from rich.console import Console
    from rich.table import Table

    how = [word for word in words if word == REAL_TIME]
    seconds = next((float(word) for word in words if word not in how), SECONDS)
    title = f"us from the publisher's call to the return of the predictor's publish; {RATE:.0f} Hz, {seconds:g} s each"
    columns: dict[str, list[str]] = {}
    for listener, heard in HEARD.items():
        for executor in EXECUTORS:
            figures = measure(executor, heard, seconds, *how)
            columns[f"{listener}\n{executor}"] = [f"{number:.{int(name == LOAD)}f}" for name, number in figures.items()]
    table = Table("", *columns, title=title)
    for name, *numbers in zip(figures, *columns.values(), strict=True):
        table.add_row(name, *numbers)
    Console(width=120).print(table, f"{os.cpu_count()} processors" + (", SCHED_FIFO" if how else ""))
    return 0


def play(words: list[str]) -> int:
    """Play a role as a process of its own."""
    if REAL_TIME in words:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    name, *arguments = [word for word in words if word != REAL_TIME]
    if name == "predict":
        return predict(arguments[0])
    role = publish if name == "publish" else listen
    return run(lambda stop: role(stop, *arguments), sys.argv)


if __name__ == "__main__":
    given = sys.argv[1:]
    sys.exit(play(given) if set(ROLES) & set(given) else main(given))
