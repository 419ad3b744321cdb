"""Damaged bags: everything before the damage is used, and it is said what was lost."""

from __future__ import annotations

import random
import re
import sqlite3
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest
from mcap.writer import CompressionType
from recordings import CHUNK, WANTED, first_messages, in_ros1, write_mcap, write_ros1, write_ros2
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2.enums import CompressionMode

from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.prediction.scene import Scene

COUNT = 120
MESSAGES = first_messages(COUNT)
PER_CHUNK = CHUNK // 700 + 1
"""More messages than a chunk has: each is of 716 bytes and more."""

PER_PAGE = 5
"""Messages in a page of SQLite."""

CUTS = 60


def mcap(compression: CompressionType, *, chunked: bool = True, indexed: bool = True) -> Callable[[Path], Path]:
    return lambda folder: write_mcap(folder / "a.mcap", MESSAGES, compression, chunked=chunked, indexed=indexed)


def sqlite(folder: Path) -> Path:
    return write_ros2(folder / "bag", MESSAGES, StoragePlugin.SQLITE3) / "bag.db3"


def ros1(compression: Ros1Writer.CompressionFormat | None) -> Callable[[Path], Path]:
    return lambda folder: write_ros1(folder / "a.bag", MESSAGES, compression)


PLAIN = {
    "chunks": mcap(CompressionType.NONE),
    "no chunks": mcap(CompressionType.NONE, chunked=False),
    "no chunks, no index": mcap(CompressionType.NONE, chunked=False, indexed=False),
    "sqlite": sqlite,
    "ros1": ros1(None),
}
"""Those in which the bytes of the messages can be found."""

COMPRESSED = {
    "zstd": mcap(CompressionType.ZSTD),
    "lz4": mcap(CompressionType.LZ4),
    "zstd, no index": mcap(CompressionType.ZSTD, indexed=False),
    "ros1 bz2": ros1(Ros1Writer.CompressionFormat.BZ2),
    "ros1 lz4": ros1(Ros1Writer.CompressionFormat.LZ4),
}
BOTH = {**PLAIN, **COMPRESSED}


def read_before(path: Path) -> tuple[list[BagMessage], str]:
    """What can be read of a bag, and what is said about the rest."""
    messages: list[BagMessage] = []
    said = ""
    try:
        # One by one, so that those before the damage are kept.
        messages.extend(iter(read_messages(path, WANTED)))
    except InputError as error:
        said = str(error)
        assert "\n" not in said
        assert str(path) in said
    return messages, said


def ends_of(data: bytes, kind: str) -> list[int]:
    """Where each message ends in the bytes of a bag."""
    ends, place = [], 0
    for message in MESSAGES:
        body = in_ros1(message.topic, message.data) if kind == ".bag" else message.data
        # SQLite fills its pages from behind.
        begin = data.index(body, 0 if kind == ".db3" else place)
        place = begin + len(body)
        ends.append(place)
    return ends


def cuts_of(data: bytes, seed: int) -> list[int]:
    """Places to cut at: near the beginning and the end, and anywhere."""
    anywhere = random.Random(seed).sample(range(len(data)), CUTS)
    return sorted({0, 1, 7, 8, 9, 12, 13, 30, 100, len(data) - 30, len(data) - 8, len(data) - 1, *anywhere})


@pytest.mark.parametrize("kind", BOTH)
def test_of_a_bag_cut_anywhere_everything_before_is_read(tmp_path: Path, kind: str) -> None:
    whole = BOTH[kind](tmp_path)
    data = whole.read_bytes()
    assert read_before(whole) == (MESSAGES, "")
    ends = ends_of(data, whole.suffix) if kind in PLAIN else []
    cut = tmp_path / f"cut{whole.suffix}"
    most = 0
    for place in cuts_of(data, seed=1):
        cut.write_bytes(data[:place])
        messages, said = read_before(cut)
        assert "is damaged or cut off" in said, place
        assert messages == MESSAGES[: len(messages)], place
        if ends:
            there = next((k for k, end in enumerate(ends) if end > place), COUNT)
            # Before the first odometry a wanted topic is not there at all.
            assert len(messages) == there or (len(messages) == 0 and there < 2), place
        # What was there of a shorter bag is there of a longer one, and no chunk before the cut is missing.
        assert len(messages) >= most, place
        assert len(messages) > COUNT * place / len(data) - 2 * PER_CHUNK, place
        most = len(messages)
        if messages:
            assert f"after {len(messages)} message" in said
    # SQLite writes the last page as a whole.
    assert most > COUNT - PER_PAGE


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("indexed", [True, False])
def test_a_flipped_byte_in_an_mcap_file_is_found_and_everything_before_its_chunk_is_read(
    tmp_path: Path, compression: CompressionType, indexed: bool
) -> None:
    whole = write_mcap(tmp_path / "a.mcap", MESSAGES, compression, indexed=indexed)
    data = whole.read_bytes()
    flipped = tmp_path / "flipped.mcap"
    draw = random.Random(2)
    found = 0
    for place in draw.sample(range(len(data)), CUTS):
        flipped.write_bytes(data[:place] + bytes([data[place] ^ 1 << draw.randrange(8)]) + data[place + 1 :])
        messages, said = read_before(flipped)
        assert messages == MESSAGES[: len(messages)], place
        assert said or messages == MESSAGES, place
        found += bool(said)
        if said and indexed and len(messages) < COUNT and "messages are lost" in said:
            assert f"{COUNT - len(messages)} messages are lost" in said
        assert len(messages) > COUNT * place / len(data) - 2 * PER_CHUNK - 1, place
    # What no checksum guards, like the name of a library or the indices, makes no difference to the messages.
    assert found > 0.8 * CUTS


def test_it_is_said_how_much_is_lost_and_where(tmp_path: Path) -> None:
    whole = write_mcap(tmp_path / "a.mcap", MESSAGES)
    data = bytearray(whole.read_bytes())
    chunks = [match.start() for match in re.finditer(rb"\x28\xb5\x2f\xfd", data)]
    data[chunks[2] + 50] ^= 1
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data)
    messages, said = read_before(damaged)
    seconds = (messages[-1].log_time - messages[0].log_time) / 1e9
    assert re.fullmatch(
        rf"{re.escape(str(damaged))} is damaged or cut off after {len(messages)} messages, {seconds:.3f} s after the "
        rf"first \(.*, at byte {chunks[2] - 53:,} of {len(data):,}; {COUNT - len(messages)} messages are lost\); "
        "repair a copy with `mcap recover`, or record it again",
        said,
    )
    assert topics(damaged) == WANTED


def test_where_one_checksum_guards_all_data_it_is_said_that_any_message_may_be_wrong(tmp_path: Path) -> None:
    whole = write_mcap(tmp_path / "a.mcap", MESSAGES, CompressionType.NONE, chunked=False, checksum=True)
    assert read_before(whole) == (MESSAGES, "")
    data = bytearray(whole.read_bytes())
    data[len(data) // 2] ^= 1
    whole.write_bytes(data)
    messages, said = read_before(whole)
    assert len(messages) == COUNT
    assert "the checksum of all its data is wrong, so that any message may be" in said


def test_a_chunk_that_is_damaged_does_not_matter_where_no_wanted_topic_is_in_it(tmp_path: Path) -> None:
    polygons = [message for message in MESSAGES if message.topic != "/cube/odom"]
    odometry = [message for message in MESSAGES if message.topic == "/cube/odom"]
    whole = write_mcap(tmp_path / "a.mcap", [*polygons, *odometry], CompressionType.NONE)
    data = bytearray(whole.read_bytes())
    # In the last chunk, where there is only odometry.
    data[data.index(odometry[-1].data) + 100] ^= 1
    whole.write_bytes(data)
    wanted = {topic: name for topic, name in WANTED.items() if topic != "/cube/odom"}
    assert list(read_messages(whole, wanted)) == polygons
    assert read_before(whole)[1]


def test_bytes_that_are_no_text_do_not_get_into_the_sentence_about_them(tmp_path: Path) -> None:
    with sqlite3.connect(sqlite(tmp_path)) as database:
        database.execute("UPDATE message_definitions SET encoded_message_definition = CAST(x'80140a41' AS TEXT)")
    with pytest.raises(InputError, match="SQLite finds it damaged") as refused:
        topics(tmp_path / "bag")
    assert str(refused.value).isprintable()


def test_a_damaged_page_of_sqlite_stops_the_reading_there(tmp_path: Path) -> None:
    whole = sqlite(tmp_path)
    data = bytearray(whole.read_bytes())
    place = data.index(MESSAGES[60].data)
    page = place // 4096 * 4096
    data[page : page + 4096] = bytes(4096)
    whole.write_bytes(data)
    messages, said = read_before(whole)
    assert messages == MESSAGES[: len(messages)]
    assert 60 - PER_PAGE < len(messages) <= 60
    assert "SQLite finds it damaged" in said


def test_a_message_with_a_number_that_no_recorder_gives_ends_what_is_read_of_an_sqlite_file_that_is_cut_off(
    tmp_path: Path,
) -> None:
    whole = sqlite(tmp_path)
    with sqlite3.connect(whole) as database:
        database.execute("UPDATE messages SET id = ? WHERE id = 61", (2**56,))
    whole.write_bytes(whole.read_bytes()[:-1])
    messages, said = read_before(whole)
    assert messages == MESSAGES[:60]
    assert "it is cut off" in said


@pytest.mark.parametrize("longer", [4, 16], ids=["messages within a page", "messages over several pages"])
def test_a_large_sqlite_file_is_read_up_to_the_cut_though_its_tree_is_lost(tmp_path: Path, longer: int) -> None:
    # More than one page can point to, so that the root of the tree points to pages written late.
    many = [BagMessage(one.topic, one.log_time + k, one.data * longer) for k in range(6) for one in MESSAGES]
    many = sorted(many, key=lambda one: one.log_time)
    whole = write_ros2(tmp_path / "bag", many, StoragePlugin.SQLITE3) / "bag.db3"
    data = whole.read_bytes()
    whole.write_bytes(data[: len(data) // 3])
    messages, said = read_before(whole)
    assert messages == many[: len(messages)]
    assert len(messages) > len(many) / 3 - 20
    assert "it is cut off" in said


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_a_compressed_file_that_was_cut_off_is_read_up_to_there(tmp_path: Path, plugin: StoragePlugin) -> None:
    bag = write_ros2(tmp_path / "bag", first_messages(8 * COUNT), plugin, CompressionMode.FILE)
    (file,) = bag.glob("*.zstd")
    data = file.read_bytes()
    file.write_bytes(data[: len(data) * 3 // 4])
    for path in (bag, file):
        messages, said = read_before(path)
        assert len(messages) > COUNT
        assert "its compressed bytes are damaged or cut off" in said


def test_what_follows_a_damaged_file_of_a_split_recording_is_named(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    for number in range(3):
        write_mcap(folder / f"run_{number}.mcap", MESSAGES[40 * number : 40 * (number + 1)])
    data = (folder / "run_1.mcap").read_bytes()
    (folder / "run_1.mcap").write_bytes(data[: len(data) // 2])
    messages, said = read_before(folder)
    assert 40 < len(messages) < 80
    assert messages == MESSAGES[: len(messages)]
    assert "of run_1.mcap; the file after it was not read" in said


@pytest.mark.parametrize("text", ["", "rosbag2_bagfile_information:\n  version: 9\n", "a: [", "- 1\n", "\0"])
def test_a_folder_with_damaged_metadata_is_read_and_it_is_said(tmp_path: Path, text: str) -> None:
    bag = write_ros2(tmp_path / "bag", MESSAGES, StoragePlugin.MCAP)
    (bag / "metadata.yaml").write_text(text)
    messages, said = read_before(bag)
    assert messages == MESSAGES
    assert "its metadata.yaml is damaged" in said


def test_a_file_of_a_recording_that_is_missing_is_named(tmp_path: Path) -> None:
    bag = write_ros2(tmp_path / "bag", MESSAGES, StoragePlugin.MCAP)
    text = (bag / "metadata.yaml").read_text()
    (bag / "metadata.yaml").write_text(text.replace("\n  - bag.mcap", "\n  - bag.mcap\n  - bag_1.mcap", 1))
    messages, said = read_before(bag)
    assert messages == MESSAGES
    assert "its file bag_1.mcap is missing" in said


def test_a_bag_that_its_recorder_did_not_close_is_read(tmp_path: Path) -> None:
    whole = write_ros1(tmp_path / "whole.bag", MESSAGES)
    data = whole.read_bytes()
    index = int.from_bytes(re.search(rb"index_pos=(.{8})", data, re.DOTALL)[1], "little")  # type: ignore[index]
    live = tmp_path / "live.bag.active"
    live.write_bytes(re.sub(rb"index_pos=.{8}", b"index_pos=" + bytes(8), data[:index], count=1, flags=re.DOTALL))
    messages, said = read_before(live)
    assert messages == MESSAGES
    assert "its recorder did not close it" in said


def test_a_bag_whose_index_ends_before_its_last_record_is_read(tmp_path: Path) -> None:
    bag = write_ros1(tmp_path / "a.bag", MESSAGES)
    data = bag.read_bytes()
    end = last = int.from_bytes(re.search(rb"index_pos=(.{8})", data, re.DOTALL)[1], "little")  # type: ignore[index]
    while end < len(data):
        last = end
        for _ in ("header", "data"):
            end += 4 + int.from_bytes(data[end : end + 4], "little")
    bag.write_bytes(data[:last])
    messages, said = read_before(bag)
    assert messages == MESSAGES
    assert "it is cut off" in said


def test_a_replay_uses_what_is_before_the_cut_and_says_what_is_lost(tmp_path: Path) -> None:
    whole = write_mcap(tmp_path / "a.mcap", MESSAGES)
    data = whole.read_bytes()
    whole.write_bytes(data[: len(data) // 2])
    messages, said = read_before(whole)
    scene = Scene(0.37, ((1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1e-3)), 0.2)
    result = replay(whole, scene)
    assert result.samples == sum(message.topic == "/cube/odom" for message in messages) > 40
    assert result.damaged == said


def test_overlapping_chunks_are_read_up_to_the_damaged_one(tmp_path: Path) -> None:
    # Times go up and down, so that each chunk has messages from before the end of the one before it.
    mixed = [one._replace(log_time=one.log_time + 10**12 * (k % 3)) for k, one in enumerate(MESSAGES)]
    whole = write_mcap(tmp_path / "a.mcap", mixed, CompressionType.NONE)
    data = bytearray(whole.read_bytes())
    place = data.index(mixed[90].data) + 100
    data[place] ^= 1
    whole.write_bytes(data)
    messages, said = read_before(whole)
    assert said
    assert all(first.log_time <= second.log_time for first, second in pairwise(messages))
    assert {one.log_time for one in mixed[: 90 - PER_CHUNK]} <= {one.log_time for one in messages}
