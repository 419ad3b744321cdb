"""The same messages from every format in which they may have been recorded, and a sentence for what is none of them."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import BinaryIO

import pytest
from mcap.writer import CompressionType
from recordings import WANTED, first_messages, write_mcap, write_ros1, write_ros2
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2.enums import CompressionMode

from impact_predictor.bags import read as reading
from impact_predictor.bags.chunks import Chunk, Expansion
from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.prediction.scene import Scene
from impact_predictor.ros.messages import ODOMETRY, POLYGON

COUNT = 200
MESSAGES = first_messages(COUNT)


def read(path: Path, wanted: dict[str, str] = WANTED) -> list[BagMessage]:
    return list(read_messages(path, wanted))


def refusal(path: Path, wanted: dict[str, str] = WANTED) -> str:
    """What is said about a bag before its first message, one sentence in one line that names the bag."""
    with pytest.raises(InputError) as caught:
        read_messages(path, wanted)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("indexed", [True, False])
@pytest.mark.parametrize("chunked", [True, False])
@pytest.mark.parametrize("compression", list(CompressionType))
def test_an_mcap_file_is_read_whatever_its_compression_and_index(
    tmp_path: Path, compression: CompressionType, chunked: bool, indexed: bool
) -> None:
    bag = write_mcap(tmp_path / "a.mcap", MESSAGES, compression, chunked=chunked, indexed=indexed)
    assert topics(bag) == WANTED
    assert read(bag) == MESSAGES
    odometry = [message for message in MESSAGES if message.topic == "/cube/odom"]
    assert read(bag, {"/cube/odom": ODOMETRY}) == odometry
    assert read(bag, {}) == []


@pytest.mark.parametrize("indexed", [True, False])
@pytest.mark.parametrize("chunked", [True, False])
def test_messages_of_an_mcap_file_are_put_in_the_order_of_their_times(
    tmp_path: Path, chunked: bool, indexed: bool
) -> None:
    mixed = [*MESSAGES[50:80], *MESSAGES[:50], *MESSAGES[80:][::-1]]
    bag = write_mcap(tmp_path / "a.mcap", mixed, chunked=chunked, indexed=indexed)
    assert read(bag) == sorted(mixed, key=lambda message: message.log_time)


@pytest.mark.parametrize("compression", [None, *Ros1Writer.CompressionFormat])
def test_a_ros1_bag_is_read_whatever_its_compression(
    tmp_path: Path, compression: Ros1Writer.CompressionFormat | None
) -> None:
    bag = write_ros1(tmp_path / "a.bag", MESSAGES, compression)
    assert topics(bag) == WANTED
    # The geometry of a toss has the log time of its first sample, and must come first to be of use to it.
    assert read(bag) == read(bag, dict(reversed(WANTED.items()))) == MESSAGES
    polygons = [message for message in MESSAGES if message.topic != "/cube/odom"]
    assert read(bag, {"/cube/contact_geometry": POLYGON}) == polygons


def test_messages_of_ros1_in_an_mcap_file_are_converted(tmp_path: Path) -> None:
    types = {topic: name.replace("/msg/", "/") for topic, name in WANTED.items()}
    bag = write_mcap(tmp_path / "a.mcap", MESSAGES, encoding="ros1", types=types)
    assert topics(bag) == WANTED
    assert read(bag) == MESSAGES


@pytest.mark.parametrize("plugin", list(StoragePlugin))
@pytest.mark.parametrize("mode", [CompressionMode.NONE, CompressionMode.MESSAGE, CompressionMode.FILE])
def test_a_folder_is_read_with_and_without_its_metadata_and_so_is_its_file_alone(
    tmp_path: Path, plugin: StoragePlugin, mode: CompressionMode
) -> None:
    bag = write_ros2(tmp_path / "bag", MESSAGES, plugin, mode)
    assert topics(bag) == WANTED
    assert read(bag) == MESSAGES
    (bag / "metadata.yaml").unlink()
    (file,) = bag.iterdir()
    assert (file.suffix == ".zstd") == (mode is CompressionMode.FILE)
    assert topics(file) == WANTED
    assert read(bag) == read(file) == MESSAGES


@pytest.mark.parametrize("kept", [True, False])
def test_the_files_of_a_split_recording_are_read_in_order_with_and_without_metadata(tmp_path: Path, kept: bool) -> None:
    bag = write_ros2(tmp_path / "run", [], StoragePlugin.MCAP)
    text = (bag / "metadata.yaml").read_text()
    shutil.rmtree(bag)
    bag.mkdir()
    # Ten of them, so that the order of the names is not that of the numbers.
    files = [f"run_{number}.mcap" for number in range(11)]
    for number, name in enumerate(files):
        write_mcap(bag / name, MESSAGES[18 * number : 18 * (number + 1)])
    if kept:
        listed = "".join(f"\n  - {name}" for name in files)
        (bag / "metadata.yaml").write_text(text.replace("\n  - run.mcap", listed, 1))
    assert read(bag, {"/cube/odom": ODOMETRY}) == [one for one in MESSAGES[:198] if one.topic == "/cube/odom"]


def test_a_name_that_is_an_address_of_something_is_a_name(tmp_path: Path) -> None:
    bag = write_ros2(tmp_path / "bag", MESSAGES, StoragePlugin.SQLITE3)
    odd = tmp_path / "100% of #1?mode=rwc.db3"
    shutil.copy(bag / "bag.db3", odd)
    before = set(tmp_path.iterdir())
    assert read(odd) == MESSAGES
    assert set(tmp_path.iterdir()) == before


def test_metadata_lead_to_no_file_outside_of_their_folder(tmp_path: Path) -> None:
    bag = write_ros2(tmp_path / "bag", MESSAGES, StoragePlugin.MCAP)
    shutil.move(bag / "bag.mcap", tmp_path / "bag.mcap")
    text = (bag / "metadata.yaml").read_text()
    for name in ("../bag.mcap", str(tmp_path / "bag.mcap")):
        (bag / "metadata.yaml").write_text(text.replace("- bag.mcap", f"- {name}"))
        assert "its file bag.mcap is missing" in refusal(bag)


@pytest.mark.parametrize("kind", ["mcap", "bag"])
def test_chunks_without_wanted_topics_are_not_even_decompressed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    path = tmp_path / f"a.{kind}"
    bag = write_ros1(path, MESSAGES) if kind == "bag" else write_mcap(path, MESSAGES)
    opened: list[int] = []
    unpacked = Chunk.unpacked

    def counted(chunk: Chunk, file: BinaryIO, expansion: Expansion) -> bytes:
        opened.append(chunk.place)
        return unpacked(chunk, file, expansion)

    monkeypatch.setattr(Chunk, "unpacked", counted)
    assert read(path) == MESSAGES
    every = len(opened)
    opened.clear()
    polygons = read(bag, {"/cube/contact_geometry": POLYGON})
    # At most one chunk for each of them, of many.
    assert 0 < len(opened) <= len(polygons) < every
    opened.clear()
    assert topics(bag) == WANTED
    assert opened == []


def test_a_compressed_file_is_decompressed_once_for_all_that_a_replay_asks_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = write_ros2(tmp_path / "bag", MESSAGES, StoragePlugin.MCAP, CompressionMode.FILE)
    decompress, decompressed = reading.decompress_file, list[Path]()

    def counted(source: Path, target: Path) -> bool:
        decompressed.append(target)
        return decompress(source, target)

    monkeypatch.setattr(reading, "decompress_file", counted)
    scene = Scene(0.37, ((1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1e-3)), 0.2)
    assert replay(bag, scene).samples > 0.9 * COUNT
    (target,) = decompressed
    assert not target.parent.exists()


def test_a_wrong_encoding_is_named_with_topic_type_and_file(tmp_path: Path) -> None:
    bag = write_mcap(tmp_path / "a.mcap", MESSAGES, encoding="json")
    # Neither named nor the only one that there is.
    for wanted in ({"/cube/odom": ODOMETRY}, {"/odom": ODOMETRY}):
        assert refusal(bag, wanted) == (
            f"the topic /cube/odom ({ODOMETRY}) of {bag} is recorded as 'json', but CDR is needed, "
            "as `ros2 bag record` writes it; record or convert it so"
        )
    assert topics(bag) == {topic: f"{name} as json" for topic, name in WANTED.items()}
    other = write_mcap(tmp_path / "b.mcap", MESSAGES, encoding="protobuf", types=dict.fromkeys(WANTED, "foxglove.Pose"))
    assert "/cube/odom (foxglove.Pose)" in refusal(other)
    assert "is recorded as 'protobuf', but CDR is needed" in refusal(other)


def test_messages_that_a_recorder_left_beside_the_database_are_told(tmp_path: Path) -> None:
    bag = write_ros2(tmp_path / "bag", MESSAGES, StoragePlugin.SQLITE3)
    (bag / "bag.db3-wal").write_bytes(b"what was written last")
    stream = read_messages(bag, WANTED)
    assert [next(stream) for _ in range(COUNT)] == MESSAGES
    with pytest.raises(InputError, match=r"left messages in bag\.db3-wal; bring them in with sqlite3 bag\.db3"):
        next(stream)
