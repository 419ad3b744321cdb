"""Writing of bags: what is read back, what is replaced, and what is never touched."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.bags.write import BagWriter, left_of
from impact_predictor.errors import InputError
from impact_predictor.ros.messages import UINT8

TOPICS = {"/impact_predictor/mode": UINT8, "/other": UINT8}
MESSAGES = [BagMessage(topic, k * 10**6, bytes([0, 1, 0, 0, k % 7])) for k in range(200) for topic in TOPICS]
NAMES = pytest.mark.parametrize("name", ["out.mcap", "out", "out.v2"])


def write(path: Path, messages: list[BagMessage] = MESSAGES) -> None:
    with BagWriter(path) as writer:
        for topic, log_time, data in messages:
            writer.write(topic, TOPICS[topic], log_time, data)


def write_and_stop(path: Path, stop: type[BaseException]) -> None:
    with BagWriter(path) as writer:
        for topic, log_time, data in MESSAGES[:50]:
            writer.write(topic, TOPICS[topic], log_time, data)
        raise stop


def read(path: Path) -> list[BagMessage]:
    return list(read_messages(path, topics(path)))


def everything_in(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


@NAMES
@pytest.mark.parametrize("messages", [MESSAGES, []])
def test_what_was_written_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, messages: list[BagMessage]
) -> None:
    monkeypatch.chdir(tmp_path)
    write(Path(name), messages)
    assert read(tmp_path / name) == messages
    assert topics(tmp_path / name) == (TOPICS if messages else {})
    assert (tmp_path / name).is_file() == name.endswith(".mcap")
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


def test_the_same_messages_make_the_same_bytes_under_any_name(tmp_path: Path) -> None:
    for name in ("first.mcap", "second.mcap", "first", "second"):
        write(tmp_path / name)
    file = (tmp_path / "first.mcap").read_bytes()
    assert (tmp_path / "second.mcap").read_bytes() == file
    assert everything_in(tmp_path / "first") == everything_in(tmp_path / "second")
    assert everything_in(tmp_path / "first")["bag.mcap"] == file


@NAMES
@pytest.mark.parametrize("stop", [RuntimeError, KeyboardInterrupt])
def test_an_exception_leaves_what_was_written_and_the_older_output(
    tmp_path: Path, name: str, stop: type[BaseException]
) -> None:
    write(tmp_path / name, MESSAGES[:10])
    older = everything_in(tmp_path)
    with pytest.raises(stop):
        write_and_stop(tmp_path / name, stop)
    assert {entry.name for entry in tmp_path.iterdir()} == {name, f"{name}.partial"}
    assert read(tmp_path / f"{name}.partial/bag") == MESSAGES[:50]
    left = everything_in(tmp_path)
    assert {key: left[key] for key in older} == older
    write(tmp_path / name)
    assert read(tmp_path / name) == MESSAGES
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


@NAMES
def test_what_a_stopped_writer_leaves_is_found_and_without_a_message_it_leaves_nothing(
    tmp_path: Path, name: str
) -> None:
    assert left_of(tmp_path / name) is None
    with pytest.raises(KeyboardInterrupt), BagWriter(tmp_path / name):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(KeyboardInterrupt):
        write_and_stop(tmp_path / name, KeyboardInterrupt)
    assert left_of(tmp_path / name) == tmp_path / f"{name}.partial/bag"


def test_of_a_writer_whose_process_was_ended_only_a_bag_with_messages_is_left(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        write_and_stop(tmp_path / "out.mcap", KeyboardInterrupt)
    bag = tmp_path / "out.mcap.partial/bag"
    # It ends somewhere behind its first chunk, or before it; the metadata come last.
    (bag / "metadata.yaml").unlink()
    data = (bag / "bag.mcap").read_bytes()
    (bag / "bag.mcap").write_bytes(data[: len(data) // 2])
    assert left_of(tmp_path / "out.mcap") == bag
    (bag / "bag.mcap").write_bytes(data[:20])
    assert left_of(tmp_path / "out.mcap") is None
    assert list(tmp_path.iterdir()) == []


def refused(path: Path) -> str:
    with pytest.raises(InputError) as caught, BagWriter(path):
        pytest.fail("the writer began")
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_what_others_made_or_put_into_an_output_is_never_replaced(tmp_path: Path) -> None:
    write(tmp_path / "out")
    for file in ("notes.mcap", "file", "folder/notes.txt", "out/notes.txt"):
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text("my notes")
    (tmp_path / "folder.mcap").mkdir()
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/other", UINT8, typestore=get_typestore(Stores.ROS2_JAZZY))
        writer.write(connection, 1, MESSAGES[0].data)
    before = everything_in(tmp_path)
    for name in ("notes.mcap", "file", "folder", "out", "folder.mcap", "bag", "bag/bag.mcap"):
        assert "is not an output of impact_predictor" in refused(tmp_path / name)
    assert everything_in(tmp_path) == before


def test_a_partial_output_with_a_file_of_the_user_in_it_stays(tmp_path: Path) -> None:
    (tmp_path / "out.mcap.partial").mkdir()
    (tmp_path / "out.mcap.partial/notes.txt").write_text("my notes")
    assert "move it away" in refused(tmp_path / "out.mcap")
    assert (tmp_path / "out.mcap.partial/notes.txt").read_text() == "my notes"


def test_a_full_disk_is_one_sentence_and_keeps_the_older_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    write(tmp_path / "out.mcap")
    monkeypatch.setattr(Writer, "write", full)
    with pytest.raises(InputError, match="No space left on device; what was written stays in"):
        write(tmp_path / "out.mcap", MESSAGES[:5])
    assert read(tmp_path / "out.mcap") == MESSAGES
