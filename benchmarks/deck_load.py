"""The load of `bench_deck.py`: crates on a rolling and heaving deck, as prepared messages on their way through ROS.

    python benchmarks/deck_load.py publish FILE BODIES RATE DECK_RATE SECONDS
    python benchmarks/deck_load.py listen FILE BODIES

Both write a JSON file with what they have sent or heard, by the name of the body, in ns of the clock.
"""

from __future__ import annotations

import json
import struct
import sys
import time
from collections.abc import Callable
from functools import partial
from math import cos, pi, sin
from pathlib import Path
from typing import Any, Final, NamedTuple

from impact_predictor.prediction.types import Sample, Vector3
from impact_predictor.prediction.vectors import add, axes_of, composed, cross, to_body, to_world, turned
from impact_predictor.ros.messages import DIAGNOSTIC_ARRAY, ODOMETRY, UINT8, encode_odometry
from impact_predictor.ros.process import Stop, message_class, run, spin

PERIOD: Final = 8.0
"""Seconds of roll and heave, after which everything repeats itself."""
ROLL, HEAVE = 0.14, 1.2
HALF: Final = 0.3
"""Half the side of a crate's base in m."""
ROCKING: Final = 5
"""Every so manieth crate rocks about one edge."""
TILT, BUMPS = 0.05, 10
"""Tilt in rad of those, and how often they strike in a period."""
COVARIANCE: Final = (0.0,) * 36
UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)
HEAD_START: Final = 0.5
"""Seconds that the deck is there before the crates."""
HEARD: Final = 5
"""Every so manieth crate's mode is listened to."""
READY: Final = "ready"


def name_of(k: int) -> str:
    return f"crate_{k:02d}"


def place_of(k: int) -> Vector3:
    return 2.0 * (k // 10) - 4.0, 1.5 * (k % 10) - 6.75, 0.0


def deck_at(time: float) -> Sample:
    """The deck's pose, and its twist along its axes."""
    rate = 2.0 * pi / PERIOD
    orientation = turned(UPRIGHT, (ROLL * sin(rate * time), 0.0, 0.0))
    rise = to_body(axes_of(orientation), (0.0, 0.0, HEAVE * rate * cos(rate * time)))
    place = 0.0, 0.0, HEAVE * sin(rate * time)
    spin = ROLL * rate * cos(rate * time), 0.0, 0.0
    return Sample(0, "world", "deck", place, orientation, rise, spin, COVARIANCE, COVARIANCE)


def crate_at(k: int, time: float) -> Sample:
    """A crate's pose, and its twist along its axes: it stands, or rocks about the edge at its right."""
    deck = deck_at(time)
    tilt = speed = 0.0
    if k % ROCKING == 0:
        phase = pi * BUMPS * time / PERIOD + k
        tilt, speed = TILT * abs(sin(phase)), TILT * pi * BUMPS / PERIOD * cos(phase) * (1 if sin(phase) > 0 else -1)
    edge = 0.0, -HALF, 0.0
    leaning = turned(UPRIGHT, (tilt, 0.0, 0.0))
    place = add(add(place_of(k), edge), to_world(axes_of(leaning), edge), -1.0)
    drift = cross((speed, 0.0, 0.0), add(place, add(place_of(k), edge), -1.0))
    support, orientation = axes_of(deck.orientation), composed(deck.orientation, leaning)
    velocity = add(add(deck.linear, cross(deck.angular, place)), drift)
    return Sample(
        0,
        "world",
        name_of(k),
        add(deck.position, to_world(support, place)),
        orientation,
        to_body(axes_of(leaning), velocity),
        add(deck.angular, (speed, 0.0, 0.0)),
        COVARIANCE,
        COVARIANCE,
    )


class Source(NamedTuple):
    """Who publishes: how often, and from when on, in s."""

    name: str
    sample_at: Callable[[float], Sample]
    rate: float
    begin: float

    def messages(self) -> list[bytearray]:
        """The messages of one period."""
        times = [self.begin + k / self.rate for k in range(round(PERIOD * self.rate))]
        return [bytearray(encode_odometry(self.sample_at(time))) for time in times]

    def times(self, seconds: float) -> list[float]:
        """When they are due."""
        return [self.begin + k / self.rate for k in range(int((seconds - self.begin) * self.rate))]


def publish(stop: Stop, file: str, bodies: int, rate: float, deck_rate: float, seconds: float) -> int:
    """Publish for some seconds, the bodies one after the other all the time; note when."""
    from rclpy.node import Node

    node = Node("load")
    # The deck is known before the bodies, which come one after the other.
    sources = [Source("support", deck_at, deck_rate, 0.0)]
    sources += [Source(name_of(k), partial(crate_at, k), rate, HEAD_START + k / bodies / rate) for k in range(bodies)]
    messages = [source.messages() for source in sources]
    outlets = [node.create_publisher(message_class(ODOMETRY), f"{source.name}/odom", 100) for source in sources]
    while not all(outlet.get_subscription_count() for outlet in outlets):
        if stop.wait(0.01):
            return 0
    print(READY, flush=True)
    if stop.wait(1.0):
        return 0
    due = sorted((when, n, k) for n, source in enumerate(sources) for k, when in enumerate(source.times(seconds)))
    sent: dict[str, list[int]] = {source.name: [] for source in sources}
    begin = time.monotonic()
    for when, n, k in due:
        if stop.wait(max(0.0, begin + when - time.monotonic())):
            break
        data = messages[n][k % len(messages[n])]
        now = time.time_ns()
        struct.pack_into("<iI", data, 4, *divmod(now, 10**9))
        outlets[n].publish(bytes(data))
        sent[sources[n].name].append(now)
    Path(file).write_text(json.dumps(sent))
    node.destroy_node()
    return 0


def listen(stop: Stop, file: str, bodies: int) -> int:
    """Note when each mode of some bodies comes, until asked to end; and read the diagnostics, as a monitor does."""
    from rclpy.node import Node

    node = Node("listener")
    heard: dict[str, list[int]] = {}

    def note(times: list[int]) -> Callable[[Any], None]:
        return lambda _: times.append(time.time_ns())

    for k in range(0, bodies, HEARD):
        name = name_of(k)
        heard[name] = []
        topic = f"/impact_predictor/{name}/mode"
        node.create_subscription(message_class(UINT8), topic, note(heard[name]), 100, raw=True)
    node.create_subscription(message_class(DIAGNOSTIC_ARRAY), "/diagnostics", lambda _: None, 100, raw=True)
    spin(node, stop, lambda: sum(map(len, heard.values())))
    Path(file).write_text(json.dumps({"modes": heard}))
    node.destroy_node()
    return 0


def main() -> int:
    """Publish or listen as the arguments say."""
    kind, file, bodies, *numbers = sys.argv[1:]
    if kind == "publish":
        rate, deck_rate, seconds = map(float, numbers)
        return run(lambda stop: publish(stop, file, int(bodies), rate, deck_rate, seconds), None)
    return run(lambda stop: listen(stop, file, int(bodies)), None)


if __name__ == "__main__":
    sys.exit(main())
