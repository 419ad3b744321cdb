"""Tosses of the cube as sensors in other frames would have told of them, connected by /tf and /tf_static."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from elsewhere import bag_of
from recordings import RECORDED, WANTED, write_bag

from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Status
from impact_predictor.ros.messages import ODOMETRY, decode_diagnostic_array, decode_odometry

ROOT = Path(__file__).parents[2]
END = 75_000_000_000
"""Log time in ns that ends the excerpt: four tosses."""
NUMBER = re.compile(r"-?(inf|\d[\d.e+-]*)")


def scene_with(**changes: Any) -> Scene:
    return Scene.from_parameters(read_values(ROOT / "config/cube_tosses.yaml"))._replace(**changes)


@pytest.fixture(scope="module")
def messages() -> list[BagMessage]:
    return [one for one in read_messages(RECORDED, WANTED) if one.log_time <= END]


def numbers(path: Path) -> list[Any]:
    """Every value that is told, numbers as such."""
    found: list[Any] = []
    types = topics(path)
    for topic, _, data in read_messages(path, types):
        if types[topic] == ODOMETRY:
            sample = decode_odometry(data)
            found += [sample.frame_id, sample.child_frame_id, *sample.position, *sample.linear, *sample.angular]
        elif topic.endswith(("prediction", "score")):
            for key, value in decode_diagnostic_array(data)[0].values.items():
                found += [float(one) if NUMBER.fullmatch(one) else (key, one) for one in value.split()]
    return found


@pytest.mark.parametrize("poses", [True, False], ids=["poses", "twists"])
@pytest.mark.parametrize("creeps", [False, True], ids=["fixed", "creeping"])
def test_a_sensor_in_other_frames_gives_the_predictions_of_the_body_to_rounding(
    tmp_path: Path, messages: list[BagMessage], creeps: bool, poses: bool
) -> None:
    plain, scene = write_bag(tmp_path / "plain.mcap", messages), scene_with(poses=poses)
    expected = replay(plain, scene, output=tmp_path / "expected.mcap")
    elsewhere = bag_of(tmp_path / "elsewhere.mcap", messages, creeps)
    result = replay(elsewhere, scene._replace(body_frame="cube"), output=tmp_path / "predictions.mcap")
    assert result.statuses == expected.statuses
    assert len(result.settled) == len(expected.settled) > 3
    for told, known in zip(numbers(tmp_path / "predictions.mcap"), numbers(tmp_path / "expected.mcap"), strict=True):
        # Positions of 1 m are rounded at 1e-16, their differences in 7 ms make rates that err by 1e-13.
        assert told == (pytest.approx(known, rel=1e-7, abs=1e-9) if isinstance(known, float) else known)


def test_without_the_parameter_transforms_are_not_read_and_other_frames_stay_wrong(
    tmp_path: Path, messages: list[BagMessage]
) -> None:
    result = replay(bag_of(tmp_path / "elsewhere.mcap", messages, creeps=False), scene_with())
    assert result.statuses == {Status.WRONG_FRAME: result.samples}
    assert not {"tf", "tf_static"} & result.inputs.keys()
    assert "frame_id is 'map', but 'world' is wanted" in result.unpredictable
    assert "give tf.body_frame where /tf connects them" in result.unpredictable


@pytest.mark.parametrize(
    ("left_out", "said"),
    [
        ("/tf_static", "no transforms on /tf and /tf_static connect 'map' and 'world'"),
        ("/tf", "no transforms on /tf and /tf_static connect 'cube' and 'imu'"),
    ],
)
def test_of_a_bag_that_lacks_transforms_it_is_said_which_frames_they_do_not_connect(
    tmp_path: Path, messages: list[BagMessage], left_out: str, said: str
) -> None:
    whole = bag_of(tmp_path / "whole.mcap", messages, creeps=True)
    types = topics(whole)
    kept = [one for one in read_messages(whole, types) if one.topic != left_out]
    points = {**read_values(ROOT / "config/cube_tosses.yaml"), "body.contact_points": (0.05,) * 3 + (-0.05,) * 3}
    scene = Scene.from_parameters({**points, "tf.body_frame": "cube"})
    result = replay(write_bag(tmp_path / "cut.mcap", kept, types), scene)
    assert result.statuses == {Status.NO_TRANSFORM: result.samples}
    assert said in result.unpredictable


def test_a_sample_ahead_of_its_transform_is_refused_and_those_in_time_are_not(
    tmp_path: Path, messages: list[BagMessage]
) -> None:
    whole = bag_of(tmp_path / "whole.mcap", messages, creeps=True)
    types, moved = topics(whole), list(read_messages(whole, topics(whole)))
    late = next(k for k, one in enumerate(moved) if k > 50 and one.topic == "/tf")
    moved[late], moved[late + 1] = moved[late + 1], moved[late]
    bag = write_bag(tmp_path / "late.mcap", moved, types)
    result = replay(bag, scene_with(body_frame="cube"))
    assert result.statuses == {Status.ACCEPTED: result.samples - 1, Status.NO_TRANSFORM: 1}
    (note,) = [note for note in result.notes if "NO_TRANSFORM" in note]
    assert "what /tf tells of 'imu' in 'cube' ended 0.001 s before the stamp" in note
