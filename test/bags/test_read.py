"""Reading of bags in every format, and the sentences for those that cannot be read."""

from __future__ import annotations

import shutil
import tracemalloc
from pathlib import Path

import pytest
from recordings import RECORDED, WANTED, first_messages, write_ros2
from rosbags.rosbag2 import StoragePlugin

from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.errors import InputError
from impact_predictor.ros.messages import ODOMETRY, decode_odometry, decode_polygon

COUNT = 300


@pytest.fixture(scope="module")
def messages() -> list[BagMessage]:
    return first_messages(COUNT)


def test_the_recorded_tosses_are_read_in_order_of_time() -> None:
    counts = dict.fromkeys(WANTED, 0)
    last = 0
    for topic, log_time, data in read_messages(RECORDED, WANTED):
        counts[topic] += 1
        assert log_time >= last
        last = log_time
        if topic == "/cube/odom":
            assert decode_odometry(data).stamp == log_time
        else:
            assert len(decode_polygon(data).points) == 8
    assert counts == {"/cube/odom": 29791, "/cube/contact_geometry": 285}


def test_a_bag_is_not_loaded_as_a_whole() -> None:
    tracemalloc.start()
    for _ in read_messages(RECORDED, WANTED):
        pass
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # The messages are 21 MB; one chunk of them 1 MB, which is held compressed, decompressed and cut into messages.
    assert peak < 8e6


def refusal(path: Path, wanted: dict[str, str] | None = None) -> str:
    """What is said about a bag before its first message, one sentence in one line."""
    with pytest.raises(InputError) as caught:
        read_messages(path, WANTED if wanted is None else wanted)
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert str(path) in sentence
    return sentence


def test_a_bag_that_is_not_there_is_named(tmp_path: Path) -> None:
    assert "does not exist" in refusal(tmp_path / "nothing.mcap")
    with pytest.raises(InputError, match="does not exist"):
        topics(tmp_path / "nothing.mcap")


def test_a_file_that_is_no_bag_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("hello")
    assert "is not a bag" in refusal(tmp_path / "notes.txt")
    assert "is not a bag" in refusal(tmp_path)


@pytest.mark.parametrize("name", ["a.mcap", "a.db3", "a.bag"])
@pytest.mark.parametrize("content", [b"", b"hello, this is no bag at all, though it is longer than any header" * 9])
def test_a_file_that_only_has_the_name_of_a_bag_is_damaged(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    assert "damaged or cut off" in refusal(tmp_path / name)


def test_a_folder_of_several_files_without_metadata_asks_for_one(tmp_path: Path) -> None:
    for k in range(2):
        shutil.copy(RECORDED, tmp_path / f"a_{k}.mcap")
    assert "ros2 bag reindex" in refusal(tmp_path)


def test_a_lacking_topic_is_named_with_those_there_are() -> None:
    sentence = refusal(RECORDED, {"/odom": ODOMETRY})
    assert "has no topic /odom of type nav_msgs/msg/Odometry" in sentence
    # The topics of the right type come first: one of them is probably meant.
    assert sentence.endswith(
        "it has /cube/odom (nav_msgs/msg/Odometry), /cube/contact_geometry (geometry_msgs/msg/PolygonStamped)"
    )


def test_messages_that_the_index_announces_but_are_not_there_are_missed(
    tmp_path: Path, messages: list[BagMessage]
) -> None:
    bag = write_ros2(tmp_path / "bag", messages, StoragePlugin.MCAP)
    text = (bag / "metadata.yaml").read_text()
    count = sum(message.topic == "/cube/odom" for message in messages)
    assert f"message_count: {count}\n" in text
    (bag / "metadata.yaml").write_text(text.replace(f"message_count: {count}\n", f"message_count: {count + 5}\n"))
    with pytest.raises(InputError, match=f"only {COUNT} of {COUNT + 5} messages are there"):
        list(read_messages(bag, WANTED))
