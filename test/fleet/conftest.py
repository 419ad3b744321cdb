"""Short bags for the tests of fleets."""

from __future__ import annotations

from pathlib import Path

import pytest

from impact_predictor.bags.read import read_messages
from impact_predictor.bags.write import BagWriter
from impact_predictor.ros.messages import ODOMETRY, POLYGON

TOPICS = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def bags(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Three bags of one toss each."""
    folder = tmp_path_factory.mktemp("fleet")
    paths = [str(folder / f"toss_{number}.mcap") for number in range(3)]
    messages = read_messages(ROOT / "examples/cube_tosses/cube_tosses.mcap", TOPICS)
    tosses: list[list[tuple[str, int, bytes]]] = [[] for _ in paths]
    for topic, log_time, data in messages:
        # The tosses begin every 20 s, from 10 s on.
        number = (log_time - 5_000_000_000) // 20_000_000_000
        if number >= len(paths):
            break
        tosses[max(number, 0)].append((topic, log_time, data))
    geometry = next(message for message in tosses[0] if message[0] == "/cube/contact_geometry")
    for path, toss in zip(paths, tosses, strict=True):
        with BagWriter(path) as writer:
            for topic, log_time, data in [(geometry[0], toss[0][1], geometry[2]), *toss]:
                writer.write(topic, TOPICS[topic], log_time, data)
    return paths
