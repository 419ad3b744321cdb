"""The node for a long time: does its memory stay flat, and is every sample answered?

    python benchmarks/soak.py --seconds 1800 --rate 500
    python benchmarks/soak.py --seconds 1800 --rate 500 --disturb 60     (a new publisher every minute)
    python benchmarks/soak.py --seconds 1800 --rate 1500 --parameter uncertainty.samples:=0     (fast: without draws)

Publisher, node, listener and a bare node are four processes over real DDS. The publisher sends the recorded tosses
over and over with stamps that go on; the listener counts the answers on ~/prediction by their stamps. With --disturb
the publisher is killed, and the next sends the same stamps once more, as a bag in a loop does; then it is ended, and
the clock of the next is an hour ahead, and so on. The node refuses the first sample of each loop. The bare node takes
the same samples and publishes them as they are, with the same executor: what its memory does is what ROS and the
middleware do. The exit status is 1 when an answer is missing or came twice, or when the memory of the node grows by
more than that of the bare one.
"""

from __future__ import annotations

import argparse
import gc
import json
import math
import os
import signal
import struct
import sys
import time
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Final

from node_load import cpu_time, resident

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.ros.cdr import decode_diagnostic_array
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY
from impact_predictor.ros.process import Stop, message_class, run, spin
from impact_predictor.ros.processes import Child, ros_environment

ROOT: Final = Path(__file__).resolve().parents[1]
TOSSES: Final = ROOT / "examples/cube_tosses"
POINTS: Final = [half for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05) for half in (x, y, z)]
FIRST_STAMP: Final = 10**9
QUEUE: Final = 10_000
WARM_UP: Final = 0.2
"""Part of the time after which the memory is to stay as it is; at most two minutes."""
WINDOW: Final = 0.1
"""Part of the time over which the memory at its beginning and its end is averaged."""
MOST_GROWTH: Final = 1.0
"""MB from after the warm-up to the end: the pools of Python and of DDS scatter by half of that."""
TELL_EVERY: Final = 30.0
SETTLING: Final = 2.0
"""Seconds for the node's last report."""
BETWEEN: Final = 1.0
"""Seconds in which the node finds a new publisher, which knows it long before: what is sent until then is lost."""
LISTENERS: Final = 2
"""The node and the bare one."""
JUMP: Final = 3600 * 10**9
"""Nanoseconds by which a clock jumps."""


@dataclass(frozen=True)
class Plan:
    """Which samples are sent, and their stamps."""

    step: int
    """Nanoseconds between two samples."""
    count: int
    part: int
    """Samples that one publisher sends."""

    def stamp(self, number: int) -> int:
        """That of a sample: the second publisher repeats those of the first, the third jumps ahead, and so on."""
        part, rest = divmod(number, self.part)
        return FIRST_STAMP + part // 2 * self._pair + rest * self.step

    def number(self, stamp: int) -> int:
        """The first sample with a stamp."""
        pair, rest = divmod(stamp - FIRST_STAMP, self._pair)
        return 2 * pair * self.part + rest // self.step

    @property
    def loops(self) -> int:
        """How often the stamps go back."""
        return math.ceil(self.count / self.part) // 2

    @property
    def _pair(self) -> int:
        return self.part * self.step + JUMP


def main() -> int:
    if sys.argv[1:2] == ["publish"]:
        first, *plan = map(int, sys.argv[2:])
        return run(lambda stop: publish(stop, Plan(*plan), first), [])
    if sys.argv[1:2] == ["pass_on"]:
        return run(lambda stop: pass_on(stop, sys.argv[2]), [])
    if sys.argv[1:2] == ["listen"]:
        return run(lambda stop: listen(stop, Plan(*map(int, sys.argv[2:]))), [])
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--rate", type=float, default=500.0, help="samples a second")
    parser.add_argument("--executor", choices=("single", "events"), default="events")
    parser.add_argument("--parameter", action="append", default=[], help="NAME:=VALUE for the node, besides its scene")
    parser.add_argument(
        "--disturb", type=float, default=0.0, help="seconds after which the publisher is a new one; 0: never"
    )
    return soak(parser.parse_args())


def soak(arguments: argparse.Namespace) -> int:
    """Run the processes, watch the node, and print what came of it."""
    count = round(arguments.seconds * arguments.rate)
    plan = Plan(round(1e9 / arguments.rate), count, round(arguments.disturb * arguments.rate) or count)
    environment = {**ros_environment(), "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    environment.setdefault("AMENT_PREFIX_PATH", sys.prefix)
    ros = (
        "--ros-args",
        "--params-file",
        str(ROOT / "config/cube_tosses.yaml"),
        "-p",
        f"executor:={arguments.executor}",
        *(word for given in arguments.parameter for word in ("-p", given)),
    )
    node = Child("node", environment, "-m", "impact_predictor.ros.node", *ros, "-p", f"body.contact_points:={POINTS}")
    bare = Child("bare node", environment, __file__, "pass_on", arguments.executor)
    listener = Child("listener", environment, __file__, "listen", *map(str, astuple(plan)))
    memory: list[tuple[float, float, float]] = []
    with node, bare, listener:
        while "ready" not in listener.said():
            listener.check()
            node.check()
            time.sleep(0.05)
        began = told = time.monotonic()
        print("seconds      MB  bare MB  answers", flush=True)
        for number, first in enumerate(range(0, count, plan.part)):
            with Child("publisher", environment, __file__, "publish", *map(str, (first, *astuple(plan)))) as publisher:
                while "sent" not in publisher.said():
                    time.sleep(1.0)
                    for process in (node, bare, listener, publisher):
                        process.check()
                    now = time.monotonic()
                    memory.append((now - began, resident(node.process_id), resident(bare.process_id)))
                    if now - told >= TELL_EVERY:
                        told = now
                        numbers = f"{now - began:7.0f} {memory[-1][1]:7.2f} {memory[-1][2]:8.2f}"
                        print(numbers, f"{last_word(listener):>8}", flush=True)
                if arguments.disturb and number % 2 == 0:
                    os.kill(publisher.process_id, signal.SIGKILL)
                else:
                    publisher.end()
        time.sleep(SETTLING)
        cpu = cpu_time(node.process_id)
        node.end()
        bare.end()
        listener.end()
        heard = json.loads(listener.said().splitlines()[-1])
        said = node.complained().strip()
    return judge(arguments, plan, memory, heard, cpu, said)


def judge(
    arguments: argparse.Namespace,
    plan: Plan,
    memory: list[tuple[float, float, float]],
    heard: dict[str, int],
    cpu: float,
    said: str,
) -> int:
    warm = min(WARM_UP * memory[-1][0], 120.0)
    ours, bares = ([(one[0], one[part]) for one in memory if one[0] >= warm] for part in (1, 2))
    growth, of_bare = grown(ours), grown(bares)
    refused = heard["refused"]
    lost = plan.count - heard["heard"] - refused
    rows = [
        ("sent", f"{plan.count} samples at {arguments.rate:g} Hz, executor {arguments.executor}"),
        ("publishers", f"{math.ceil(plan.count / plan.part)}, one after the other"),
        ("loops", f"{plan.loops}, of which the first sample is refused"),
        ("answered", f"{heard['heard']}; {lost} missing, {heard['twice']} twice"),
        (
            "of its own",
            f"{heard['accepted']} accepted, {refused} refused, {heard['dropped']} dropped, {heard['lost']} lost by DDS",
        ),
        ("memory", in_words(ours)),
        ("bare node", f"{plan.count - heard['bare']} missing; {in_words(bares)}"),
        ("processor time", f"{cpu / max(plan.count, 1) * 1e6:.0f} us for each sample, the start included"),
        ("the node said", said or "nothing"),
    ]
    for name, text in rows:
        print(f"{name:15} {text}")
    flat = growth - of_bare <= MOST_GROWTH
    print(
        "the memory is flat" if flat else "the memory grows",
        "and",
        "nothing is lost" if not lost else "answers are missing",
    )
    return int(bool(lost or heard["twice"]) or refused != plan.loops or not flat)


def publish(stop: Stop, plan: Plan, first: int) -> int:
    """Send one part of the samples, and wait for the end."""
    from rclpy.node import Node

    types = {topic: kind for topic, kind in topics(TOSSES).items() if kind == ODOMETRY}
    samples = [bytearray(message.data) for message in read_messages(TOSSES, types)]
    node = Node("source", use_global_arguments=False)
    publisher = node.create_publisher(message_class(ODOMETRY), "odom", 100)
    while publisher.get_subscription_count() < LISTENERS and not stop.wait(0.01):
        pass
    time.sleep(BETWEEN)
    stamp, began = struct.Struct("<iI"), time.monotonic()
    for number in range(first, min(first + plan.part, plan.count)):
        if stop.requested:
            break
        data = samples[number % len(samples)]
        stamp.pack_into(data, 4, *divmod(plan.stamp(number), 10**9))
        publisher.publish(bytes(data))
        time.sleep(max(0.0, began + (number + 1 - first) * plan.step / 1e9 - time.monotonic()))
    time.sleep(BETWEEN)
    print("sent", flush=True)
    while not stop.wait(1.0):
        pass
    node.destroy_node()
    return 0


def pass_on(stop: Stop, executor: str) -> int:
    """The bare node: publish each sample as it is."""
    from rclpy.node import Node
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    node = Node("bare", use_global_arguments=False)
    publisher = node.create_publisher(message_class(ODOMETRY), "bare", QUEUE)
    served = 0

    def take(data: bytes) -> None:
        nonlocal served
        publisher.publish(data)
        served += 1

    qos = QoSProfile(depth=QUEUE, reliability=ReliabilityPolicy.BEST_EFFORT)
    node.create_subscription(message_class(ODOMETRY), "odom", take, qos, raw=True)
    gc.freeze()  # as the predictor does
    spin(node, stop, lambda: served, executor)
    node.destroy_node()
    return 0


def listen(stop: Stop, plan: Plan) -> int:
    """Count the answers by their stamps, until the stop."""
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

    node = Node("listener", use_global_arguments=False)
    seen, stamp = bytearray(plan.count), struct.Struct("<iI")
    numbers = dict.fromkeys(("heard", "twice", "bare", "accepted", "refused", "dropped", "lost"), 0)
    told = time.monotonic()

    def take(data: bytes) -> None:
        nonlocal told
        seconds, rest = stamp.unpack_from(data, 4)
        number = plan.number(seconds * 10**9 + rest)
        if seen[number] and number + plan.part < plan.count:
            number += plan.part
        numbers["twice" if seen[number] else "heard"] += 1
        seen[number] = 1
        if time.monotonic() - told > 5.0:
            told = time.monotonic()
            print(numbers["heard"], flush=True)

    def take_bare(data: bytes) -> None:
        numbers["bare"] += 1

    def report(data: bytes) -> None:
        values = decode_diagnostic_array(data)[0].values
        numbers.update({name: int(values.get(f"samples.{name}", 0)) for name in ("accepted", "dropped", "lost")})
        numbers["refused"] = int(values.get("refused.odom.STAMP_WENT_BACK", 0))

    kind = message_class(DIAGNOSTIC_ARRAY)
    node.create_subscription(kind, "/impact_predictor/prediction", take, QoSProfile(depth=QUEUE), raw=True)
    node.create_subscription(kind, "/diagnostics", report, QoSProfile(depth=QUEUE), raw=True)
    node.create_subscription(message_class(ODOMETRY), "bare", take_bare, QoSProfile(depth=QUEUE), raw=True)

    def look() -> None:
        if node.count_publishers("/impact_predictor/prediction"):
            print("ready", flush=True)
            node.destroy_timer(timer)

    timer = node.create_timer(0.1, look)
    spin(node, stop, lambda: numbers["heard"], "events")
    print(json.dumps(numbers), flush=True)
    node.destroy_node()
    return 0


def grown(points: list[tuple[float, float]]) -> float:
    """What a memory has grown by, in MB."""
    window = max(1, round(WINDOW * len(points)))
    first, last = (sum(mb for _, mb in part) / len(part) for part in (points[:window], points[-window:]))
    return last - first


def in_words(points: list[tuple[float, float]]) -> str:
    """What a memory did from the warm-up on."""
    (warm, first), (_, last) = points[0], points[-1]
    steady = (
        f"{first:.2f} MB after {warm:.0f} s, {last:.2f} MB at the end, {max(mb for _, mb in points):.2f} MB at most"
    )
    return f"{steady}, {slope(points) * 3600:+.2f} MB/h"


def slope(points: list[tuple[float, float]]) -> float:
    """That of the straight line nearest to some points."""
    x, y = (sum(values) / len(points) for values in zip(*points, strict=True))
    spread = sum([(a - x) ** 2 for a, _ in points], 0.0)
    return sum([(a - x) * (b - y) for a, b in points], 0.0) / (spread or 1.0)


def last_word(child: Child) -> str:
    return child.said().split()[-1]


if __name__ == "__main__":
    sys.exit(main())
