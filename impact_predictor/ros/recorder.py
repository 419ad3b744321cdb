"""Records what the predictor publishes into an MCAP file, byte for byte, until SIGINT or SIGTERM.

    python3 -m impact_predictor.ros.recorder predictions.mcap

Once it hears the predictor on every topic it prints a line. The log time of a message is when it was received.
"""

from __future__ import annotations

import argparse
import sys
import time
from functools import partial
from typing import Final

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
    from rclpy.qos import QoSProfile

    node = Node("recorder")
    received = [0]

    def write(topic: str, kind: str, data: bytes) -> None:
        writer.write(topic, kind, time.time_ns(), data)
        received[0] += 1

    def announce() -> None:
        if all(map(node.count_publishers, TOPICS)):
            print(LISTENING, flush=True)
            node.destroy_timer(timer)

    try:
        with BagWriter(output) as writer:
            for topic, kind in TOPICS.items():
                take = partial(write, topic, kind)
                node.create_subscription(message_class(kind), topic, take, QoSProfile(depth=QUEUE), raw=True)
            timer = node.create_timer(0.05, announce)
            spin(node, stop, lambda: received[0])
    finally:
        node.destroy_node()
    return 0


if __name__ == "__main__":
    sys.exit(main())
