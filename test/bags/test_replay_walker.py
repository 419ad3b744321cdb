"""Replay of a machine that walks: every input by its kind, and the same answers as from its predictor alone."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from made_motions import made

from impact_predictor.bags.read import BagMessage
from impact_predictor.bags.replay import replay
from impact_predictor.bags.write import BagWriter
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Geometry, Sample, Schedule, Status, Wrench
from impact_predictor.ros.messages import (
    JOINT_TRAJECTORY,
    ODOMETRY,
    POLYGON,
    WRENCH,
    encode_odometry,
    encode_polygon,
)
from impact_predictor.ros.messages.walker_inputs import encode_schedule, encode_wrench

GIVEN: dict[str, Any] = {
    "body.mass": 20.0,
    "body.inertia": [0.5, 0.6, 0.7, 0.0, 0.0, 0.0],
    "contact.friction": 0.6,
    "feet.names": ["left", "right"],
    "feet.points": 2,
    "feet.force": 20.0,
    "feet.has_schedule": True,
}
SCENE = Scene.from_parameters(validate(GIVEN))
TYPES = {
    "/odom": (Sample, ODOMETRY, encode_odometry),
    "/contact_geometry": (Geometry, POLYGON, encode_polygon),
    "/contact_wrench": (Wrench, WRENCH, encode_wrench),
    "/schedule": (Schedule, JOINT_TRAJECTORY, encode_schedule),
}


@pytest.fixture(scope="module")
def messages() -> list[BagMessage]:
    """A machine that steps on the spot, with its sensors and its planner."""
    return [
        BagMessage(topic, one.stamp, encode(one))  # type: ignore[operator, union-attr]
        for one in made(SCENE)
        for topic, (kind, _, encode) in TYPES.items()
        if isinstance(one, kind)
    ]


def write_bag(path: Path, messages: list[BagMessage], prefix: str = "") -> Path:
    with BagWriter(path) as writer:
        for topic, log_time, data in messages:
            writer.write(prefix + topic, TYPES[topic][1], log_time, data)
    return path


def test_every_input_tells_what_became_of_its_messages(tmp_path: Path, messages: list[BagMessage]) -> None:
    bad = [
        BagMessage("/contact_wrench", 0, encode_wrench(Wrench(10**9, "hand", (0.0, 0.0, 30.0)))),
        *[BagMessage(topic, 0, b"\x00\x01\x00\x00\x01") for topic in TYPES],
    ]
    result = replay(write_bag(tmp_path / "walk.mcap", [*bad, *messages]), SCENE)
    for name, counts in result.inputs.items():
        assert counts[Status.MALFORMED] == 1, name
        assert counts[Status.ACCEPTED] > 0, name
    assert result.inputs["contact_wrench"][Status.WRONG_FRAME] == 1
    (note,) = result.notes
    assert (
        "messages on /contact_wrench were refused as WRONG_FRAME: frame_id is 'hand', which is none of feet.names"
        in note
    )
    assert result.samples == 401
    assert result.statuses[Status.ACCEPTED] == 400


def test_landings_are_confirmed_by_the_sensors_of_a_bag_and_late_by_its_plan(
    tmp_path: Path, messages: list[BagMessage]
) -> None:
    result = replay(write_bag(tmp_path / "walk.mcap", messages), SCENE)
    landings = [settled.score.landing for settled in result.settled if settled.score.landing is not None]
    assert {landing.foot for landing in landings} == {"left", "right"}
    assert all(landing.confirmed for landing in landings)
    assert all(landing.late is not None and abs(landing.late) < 0.02 for landing in landings)
    assert result.notes == ()


def test_without_points_of_its_feet_it_is_said_which_topic_to_give(tmp_path: Path, messages: list[BagMessage]) -> None:
    alone = write_bag(tmp_path / "walk.mcap", [one for one in messages if one.topic == "/odom"])
    result = replay(alone, SCENE)
    assert result.unpredictable == (
        "no contact points are known, so nothing was predicted: there is no geometry_msgs/msg/PolygonStamped in the "
        "bag; --remap contact_geometry:=TOPIC"
    )
    assert result.settled == ()


def test_a_replay_over_a_floor_loads_nothing_of_feet_and_adapters(tmp_path: Path, messages: list[BagMessage]) -> None:
    path = write_bag(tmp_path / "still.mcap", [one for one in messages if one.topic == "/odom"])
    code = f"""
import sys
from impact_predictor.bags.replay import replay
from impact_predictor.prediction.scene import Scene
unit = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
points = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
assert replay({str(path)!r}, Scene(1.0, unit, 0.5, points=points)).samples == 400
own = [name for name in sys.modules if name.startswith("impact_predictor.")]
words = "adapters", "feet", "gait", "landings", "walking"
print(*[name for name in own for word in words if word in name])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    loaded = set(done.stdout.split())
    assert loaded == set()
