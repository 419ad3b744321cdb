"""Records what the predictor publishes into an MCAP file, byte for byte, until SIGINT or SIGTERM.

    python3 -m impact_predictor.ros.recorder predictions.mcap

Once it hears the predictor on every topic it prints a line. The log time of a message is when it was received.
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any, Final

from ..bags.write import BagWriter
from .messages import DIAGNOSTIC_ARRAY, OUTPUTS
from .process import Stop, message_class, run, spin

NODE: Final = "/impact_predictor"

TOPICS: Final[dict[str, str]] = {
    **{f"{NODE}/{name}": output.type_name for name, output in OUTPUTS.items()},
    "/diagnostics": DIAGNOSTIC_ARRAY,
}
"""What is recorded, with the types of the messages."""

LISTENING: Final = "listening"
"""What it prints when it hears the predictor."""

QUEUE: Final = 1000


def main(args: list[str] | None = None) -> int:
    """Record into the file that the arguments name; the exit status."""
    args = sys.argv if args is None else args
    return run(lambda stop: _record(_output(args), stop), args)


def _output(args: list[str]) -> str:
    from rclpy.utilities import remove_ros_args

    parser = argparse.ArgumentParser(prog="recorder", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("output")
    return str(parser.parse_args(remove_ros_args(args)[1:]).output)


def _record(output: str, stop: Stop) -> int:
    from rclpy.node import Node

    node = Node("recorder")
    try:
        with BagWriter(output) as writer:
            log = _Log(writer)
            subscriptions = [_subscription(node, topic, kind, log) for topic, kind in TOPICS.items()]
            _announce(node, subscriptions)
            spin(node, stop, lambda: log.written)
    finally:
        node.destroy_node()
    return 0


class _Log:
    """Writes what is received, and counts it."""

    def __init__(self, writer: BagWriter) -> None:
        self.written = 0
        self._writer = writer

    def write(self, topic: str, kind: str, data: bytes) -> None:
        self._writer.write(topic, kind, time.time_ns(), data)
        self.written += 1


def _subscription(node: Any, topic: str, kind: str, log: _Log) -> Any:
    from rclpy.qos import QoSProfile

    def write(data: bytes) -> None:
        log.write(topic, kind, data)

    return node.create_subscription(message_class(kind), topic, write, QoSProfile(depth=QUEUE), raw=True)


def _announce(node: Any, subscriptions: list[Any]) -> None:
    """Print a line as soon as every topic has a publisher."""

    def look() -> None:
        if all(node.count_publishers(one.topic_name) for one in subscriptions):
            print(LISTENING, flush=True)
            node.destroy_timer(timer)

    timer = node.create_timer(0.05, look)


if __name__ == "__main__":
    sys.exit(main())
