"""Replay of recorded bags: the same answers as from the predictor itself, and what becomes of odd messages and bags."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from recordings import RECORDED, WANTED, write_bag

from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.mechanics.types import Mode
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.predictor import Predictor
from impact_predictor.prediction.scene import Scene
from impact_predictor.prediction.types import Leftover, Prediction, Status
from impact_predictor.ros.messages import (
    DIAGNOSTIC_ARRAY,
    ODOMETRY,
    OUTPUTS,
    UINT8,
    decode_odometry,
    decode_polygon,
)
from impact_predictor.scenarios.truth import TRUTH_TOPIC, TrueImpact, encode_truth

ROOT = Path(__file__).parents[2]
END = 75_000_000_000
"""Log time in ns that ends the excerpt: four tosses."""
TWIST_OFFSET = -8 * 36 - 8
"""Place of the last number of the twist in the bytes of an Odometry: 36 covariances follow it."""

Output = tuple[str, int, bytes]


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.from_parameters(validate(read_parameters(ROOT / "config/cube_tosses.yaml")))


@pytest.fixture(scope="module")
def messages() -> list[BagMessage]:
    excerpt = []
    for message in read_messages(RECORDED, WANTED):
        if message.log_time > END:
            break
        excerpt.append(message)
    return excerpt


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory, messages: list[BagMessage]) -> Path:
    return write_bag(tmp_path_factory.mktemp("excerpt") / "tosses.mcap", messages)


def read_outputs(path: Path) -> list[Output]:
    return [tuple(message) for message in read_messages(path, topics(path))]


def samples_of(messages: list[BagMessage]) -> list[BagMessage]:
    return [message for message in messages if message.topic == "/cube/odom"]


def predicted_directly(scene: Scene, messages: list[BagMessage]) -> list[Output]:
    """What the node would publish, from the predictor and the encoders alone."""
    predictor = Predictor(scene)
    outputs = []
    for topic, log_time, data in messages:
        if topic == "/cube/contact_geometry":
            predictor.tell(decode_polygon(data))
            continue
        last = predictor.update(decode_odometry(data))
        for name, output in OUTPUTS.items():
            encoded = output.encode(last)
            if encoded is not None:
                outputs.append((f"/impact_predictor/{name}", log_time, encoded))
    for score in predictor.finish():
        encoded = OUTPUTS["score"].encode(Prediction(Status.ACCEPTED, last.sample, None, score))
        assert encoded is not None
        outputs.append(("/impact_predictor/score", log_time, encoded))
    return outputs


def test_a_bag_gives_what_the_predictor_gives(
    tmp_path: Path, bag: Path, scene: Scene, messages: list[BagMessage]
) -> None:
    replay(bag, scene, output=tmp_path / "out.mcap")
    assert sorted(read_outputs(tmp_path / "out.mcap")) == sorted(predicted_directly(scene, messages))
    assert topics(tmp_path / "out.mcap") == {
        "/impact_predictor/mode": UINT8,
        "/impact_predictor/post_impact": ODOMETRY,
        "/impact_predictor/prediction": DIAGNOSTIC_ARRAY,
        "/impact_predictor/score": DIAGNOSTIC_ARRAY,
    }


def test_what_the_end_of_the_record_settles_is_written_with_the_time_of_the_last_sample(
    tmp_path: Path, bag: Path, scene: Scene, messages: list[BagMessage]
) -> None:
    landed = replay(bag, scene).settled[0].score.stamp
    after = [message for message in samples_of(messages) if decode_odometry(message.data).stamp > landed]
    cut = write_bag(tmp_path / "cut.mcap", messages[: messages.index(after[2])])
    result = replay(cut, scene, output=tmp_path / "out.mcap")
    assert Leftover.TOO_SHORT in result.settled[-1].score.leftover
    scores = [log_time for topic, log_time, _ in read_outputs(tmp_path / "out.mcap") if topic.endswith("score")]
    assert scores == [after[1].log_time] * len(result.settled)


def test_odd_messages_are_counted_and_leave_the_others_as_they_are(
    tmp_path: Path, scene: Scene, messages: list[BagMessage]
) -> None:
    half = len(messages) // 2
    good = messages[half]
    nan = bytearray(good.data)
    nan[TWIST_OFFSET : TWIST_OFFSET + 8] = b"\xff" * 8
    assert math.isnan(decode_odometry(bytes(nan)).angular[2])
    odd = [
        good._replace(data=bytes(nan)),
        good._replace(data=good.data[:100]),
        good._replace(data=b""),
        good,
        messages[half - 1]._replace(log_time=good.log_time),
        BagMessage("/cube/contact_geometry", good.log_time, messages[0].data[:20]),
    ]
    spoilt = write_bag(tmp_path / "odd.mcap", [*messages[: half + 1], *odd, *messages[half + 1 :]])
    result = replay(spoilt, scene, output=tmp_path / "out.mcap")
    assert result.samples == len(samples_of(messages)) + 5
    assert result.statuses == {
        Status.ACCEPTED: len(samples_of(messages)),
        Status.NOT_FINITE: 1,
        Status.STAMP_REPEATED: 1,
        Status.STAMP_WENT_BACK: 1,
        Status.MALFORMED: 2,
    }
    assert result.geometry_statuses == {Status.ACCEPTED: 4, Status.MALFORMED: 1}
    said = "messages on /cube/odom were refused as NOT_FINITE: angular[2] is nan: look at its source"
    assert any(note.endswith(said) for note in result.notes)
    assert sorted(read_outputs(tmp_path / "out.mcap")) == sorted(predicted_directly(scene, messages))


def test_without_any_geometry_there_is_no_touchdown_and_a_sentence_says_why(
    tmp_path: Path, scene: Scene, messages: list[BagMessage]
) -> None:
    alone = write_bag(tmp_path / "alone.mcap", samples_of(messages))
    result = replay(alone, scene, output=tmp_path / "out.mcap")
    assert result.settled == ()
    assert result.statuses == {Status.NO_GEOMETRY: result.samples}
    assert "give body.contact_points in the parameter file" in result.unpredictable


def test_the_bag_itself_is_no_output(tmp_path: Path, scene: Scene, messages: list[BagMessage]) -> None:
    # Of this package's making, as the output of an earlier replay is, which may be replaced.
    own = write_bag(tmp_path / "own.mcap", messages)
    before = own.read_bytes()
    with pytest.raises(InputError, match="is the bag itself; give the predictions another name"):
        replay(own, scene, output=tmp_path / "." / "own.mcap")
    assert own.read_bytes() == before


def test_the_name_of_a_file_is_no_scene(bag: Path) -> None:
    with pytest.raises(InputError, match=r"give read_scenes\('scene\.yaml'\)"):
        replay(bag, "scene.yaml")  # type: ignore[arg-type]


def test_progress_is_told(bag: Path, scene: Scene) -> None:
    told: list[int] = []
    result = replay(bag, scene, progress=told.append)
    assert told
    assert told == sorted(told)
    assert told[-1] <= result.samples


def test_a_bag_of_which_every_sample_is_refused_says_why(bag: Path, scene: Scene) -> None:
    result = replay(bag, scene._replace(frame="map"))
    assert result.statuses == {Status.WRONG_FRAME: result.samples}
    assert "WRONG_FRAME" in result.unpredictable
    assert "support.frame" in result.unpredictable


def test_true_impacts_in_a_bag_are_compared_and_change_no_prediction(
    tmp_path: Path, bag: Path, scene: Scene, messages: list[BagMessage]
) -> None:
    plain = replay(bag, scene, output=tmp_path / "plain.mcap")
    assert plain.truth is None
    # Two of the impacts happened when they were predicted, one an hour after the record.
    stamps = [settled.score.stamp for settled in plain.settled[:2]] + [END + 3600 * 10**9]
    zero = (0.0, 0.0, 0.0)
    impacts = [
        TrueImpact(stamp, "cube", Mode.PIVOT, (0, 1), (2, 3), 1.0, 0.05, 0.1, (1.0, 0.0, 0.0), zero, zero, zero)
        for stamp in stamps
    ]
    told = [BagMessage(TRUTH_TOPIC, one.stamp, encode_truth(one, "world")) for one in impacts]
    other = BagMessage(TRUTH_TOPIC, told[0].log_time, b"of another program")
    both = sorted([*messages, *told, other], key=lambda message: message.log_time)
    known = write_bag(tmp_path / "known.mcap", both, {**WANTED, TRUTH_TOPIC: DIAGNOSTIC_ARRAY})
    result = replay(known, scene, output=tmp_path / "out.mcap")
    assert result.truth is not None
    assert (result.truth.touchdowns, result.truth.missed, result.truth.unresolved) == (2, 0, 0)
    assert result.truth.false > 0
    assert read_outputs(tmp_path / "out.mcap") == read_outputs(tmp_path / "plain.mcap")
