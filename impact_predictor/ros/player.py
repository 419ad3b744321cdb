"""Plays the inputs of a recorded bag onto topics, byte for byte and in recorded time, without the idle gaps.

    python3 -m impact_predictor.ros.player examples/cube_tosses --runs 3 --ros-args -r /cube/odom:=/odom

Stamps stay as they are. It waits for subscribers, and ends when they have received everything. With `--record FILE` it
also records what the predictor publishes, byte for byte, with the time of its receipt as log time, until it is stopped.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from functools import partial
from typing import Any, Final

from ..bags.read import BagMessage, read_messages, topics
from ..bags.write import BagWriter
from ..errors import InputError
from ..stamps import NANOSECONDS
from .messages import IMU, JOINT_STATE, JOINT_TRAJECTORY, MULTI_DOF_JOINT_STATE, ODOMETRY, OUTPUTS, POLYGON, WRENCH
from .process import Stop, message_class, run, spin

AWAITED: Final = (ODOMETRY, IMU, POLYGON)
"""Types of the messages that are played when somebody has subscribed to them."""

INPUTS: Final = (*AWAITED, JOINT_STATE, MULTI_DOF_JOINT_STATE, WRENCH, JOINT_TRAJECTORY)
"""Types of all messages that are played: not every scene of a robot needs the others that its bag has."""

LATCHED: Final = (POLYGON, JOINT_TRAJECTORY)
"""Those of messages that stay true until the next, which late subscribers get too."""

LONGEST_GAP: Final = 0.5
"""Seconds without a message after which nothing happens: a run of the recording ends, and the next may begin."""

SHORTENED_GAP: Final = 0.1
"""Seconds that are left of such a gap."""

GEOMETRY_AHEAD: Final = 0.05
"""Seconds that such a message has before what follows it, unless they keep coming: topics are not ordered among
themselves."""

DISCOVERY: Final = 20.0
"""Seconds within which subscribers must be found."""

SETTLING: Final = 0.5
"""Seconds that they get in turn, because each side finds the other by itself."""

QUEUE: Final = 1000

PLAYING, PLAYED = "playing", "played"
"""What it prints when it has found its subscribers, and at the end of the recording."""

NODE: Final = "/impact_predictor"

RECORDED: Final = (*(f"{NODE}/{name}" for name in OUTPUTS), "/diagnostics")
"""Topics that are recorded, with the types that their publishers have."""


def main(args: list[str] | None = None) -> int:
    """Play a bag as the arguments say; the exit status."""
    args = sys.argv if args is None else args
    return run(lambda stop: _play(_options(args), stop), args)


def _options(args: list[str]) -> argparse.Namespace:
    from rclpy.utilities import remove_ros_args

    parser = argparse.ArgumentParser(prog="player", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("bag")
    parser.add_argument("--runs", type=int, default=0, help="how many runs between idle gaps; 0, the default, is all")
    parser.add_argument("--rate", type=float, default=1.0, help="times the recorded speed; default 1")
    parser.add_argument("--record", metavar="FILE", help="bag for what the predictor publishes; none unless given")
    given = parser.parse_args(remove_ros_args(args)[1:])
    if given.runs < 0 or not 0.0 < given.rate < 1e6:
        raise InputError("--runs must not be negative, and --rate must be positive")
    return given


def timed(messages: Iterable[BagMessage], runs: int) -> Iterator[tuple[float, BagMessage]]:
    """The messages of the first runs (0: all), each with the seconds since the one before, idle gaps shortened."""
    last: int | None = None
    run_number = 1
    for message in messages:
        pause = 0.0 if last is None else max(0.0, (message.log_time - last) / NANOSECONDS)
        if pause > LONGEST_GAP:
            run_number += 1
            pause = SHORTENED_GAP
        if runs and run_number > runs:
            return
        last = message.log_time
        yield pause, message


def _play(options: argparse.Namespace, stop: Stop) -> int:
    types = {topic: kind for topic, kind in topics(options.bag).items() if kind in INPUTS}
    if not types:
        raise InputError(f"{options.bag} has no topic of type {' or '.join(INPUTS)}, so there is nothing to play")
    messages = timed(read_messages(options.bag, types), options.runs)
    from rclpy.duration import Duration
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy

    from .endpoints import publisher

    kept = {kind: DurabilityPolicy.TRANSIENT_LOCAL if kind in LATCHED else DurabilityPolicy.VOLATILE for kind in INPUTS}
    node = Node("player")
    try:
        publishers = {topic: publisher(node, topic, kind, kept[kind]) for topic, kind in types.items()}
        awaited = [publishers[topic] for topic, kind in types.items() if kind in AWAITED]
        if not _await_others(node, awaited, RECORDED if options.record else (), stop):
            return 0
        with _recording(node, options.record, stop) if options.record else nullcontext():
            if not stop.wait(SETTLING):
                print(PLAYING, flush=True)
                _publish_all(messages, types, publishers, options.rate, stop)
                for one in publishers.values():
                    one.wait_for_all_acked(Duration(seconds=2))
                print(PLAYED, flush=True)
            while options.record and not stop.wait(1.0):
                pass
    finally:
        node.destroy_node()
    return 0


@contextmanager
def _recording(node: Any, output: str, stop: Stop) -> Iterator[None]:
    """Write what the predictor publishes, until the stop."""
    received = [0]

    def write(topic: str, kind: str, data: bytes) -> None:
        writer.write(topic, kind, time.time_ns(), data)
        received[0] += 1

    with BagWriter(output) as writer:
        for topic in RECORDED:
            kind = node.get_publishers_info_by_topic(topic)[0].topic_type
            node.create_subscription(message_class(kind), topic, partial(write, topic, kind), QUEUE, raw=True)
        with ThreadPoolExecutor(max_workers=1) as pool:
            receiving = pool.submit(spin, node, stop, lambda: received[0])
            try:
                yield
            finally:
                stop.request()
            receiving.result()


def _await_others(node: Any, publishers: list[Any], recorded: Iterable[str], stop: Stop) -> bool:
    """Wait until every topic has a subscriber, or a publisher if it is recorded; whether the stop left time for it.
    InputError where a topic has none.
    """
    patience = time.monotonic() + DISCOVERY
    while True:
        lonely = [one.topic_name for one in publishers if not one.get_subscription_count()]
        silent = [topic for topic in recorded if not node.count_publishers(topic)]
        if not lonely and not silent:
            break
        if time.monotonic() > patience:
            what = f"nobody has subscribed to {' and '.join(lonely)}" if lonely else f"nobody publishes {silent[0]}"
            raise InputError(
                f"{what} within {DISCOVERY:.0f} s; start the other program, or remap: --ros-args -r /from:=/to"
            )
        if stop.wait(0.05):
            return False
    return True


def _publish_all(
    messages: Iterable[tuple[float, BagMessage]],
    types: dict[str, str],
    publishers: dict[str, Any],
    rate: float,
    stop: Stop,
) -> None:
    due = time.monotonic()
    last = dict.fromkeys(publishers, -math.inf)
    for pause, message in messages:
        due += pause / rate
        if stop.wait(max(0.0, due - time.monotonic())):
            return
        publishers[message.topic].publish(message.data)
        if types[message.topic] in LATCHED and message.log_time - last[message.topic] > LONGEST_GAP * NANOSECONDS:
            due = time.monotonic() + GEOMETRY_AHEAD
        last[message.topic] = message.log_time


if __name__ == "__main__":
    sys.exit(main())
