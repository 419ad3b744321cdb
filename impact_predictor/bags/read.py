"""Reading recorded messages as bytes: MCAP files, rosbag2 folders (MCAP or SQLite) and ROS 1 bags."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinitionFormat
from rosbags.rosbag1 import Reader as Ros1Reader
from rosbags.rosbag2 import Reader as Ros2Reader
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from ..errors import InputError
from ..ros.messages import MalformedMessage

Reader = Ros1Reader | Ros2Reader

_STORAGE_SUFFIXES: Final = (".mcap", ".db3")
_KINDS: Final = "an .mcap file, a rosbag2 folder or a ROS 1 .bag file"
_REPAIRS: Final = {
    ".mcap": "repair a copy with `mcap recover`",
    ".bag": "repair a copy with `rosbag reindex`",
}
_HEADER: Final = "std_msgs/msg/Header"
_IDL: Final = f"{'=' * 80}\nIDL: "
_MOST_TOPICS_NAMED: Final = 20


class UnusableMessage(MalformedMessage):
    """A whole message that its adapter refuses; says which adapter, and why."""


class BagMessage(NamedTuple):
    """A recorded message: `log_time` in ns, `data` in CDR."""

    topic: str
    log_time: int
    data: bytes


def topics(path: str | os.PathLike[str]) -> dict[str, str]:
    """The topics of a bag with the types of their messages, as in {"/odom": "nav_msgs/msg/Odometry"}, in order.

    Raises:
        InputError: the bag is not there or cannot be read.
    """
    with ExitStack() as stack:
        return _types(_open(Path(path), stack).connections)


def read_messages(path: str | os.PathLike[str], wanted: Mapping[str, str]) -> Iterator[BagMessage]:
    """The messages of some topics of a bag in the order of their log times, read while they are asked for.

    `wanted` has the topics and the types that their messages must have. Messages of a ROS 1 bag are converted to CDR.
    What can be known before the first message is checked at once.

    Raises:
        InputError: the bag is not there, cannot be read, or lacks a topic, or a topic has another type; while
            reading: the bag is damaged, after every message before the damage.
    """
    path = Path(path)
    with ExitStack() as stack:
        reader = _open(path, stack)
        connections = _select(path, reader.connections, wanted)
        to_cdr = _ros1_converter(path, connections) if isinstance(reader, Ros1Reader) else None
        return _stream(path, reader, connections, to_cdr, stack.pop_all())


def _open(path: Path, stack: ExitStack) -> Reader:
    storage = _storage(path)
    try:
        reader = Ros1Reader(storage) if storage.suffix == ".bag" and storage.is_file() else Ros2Reader(storage)
        reader.open()
        # Metadata that were edited by hand, or damaged, may hold anything where a name or a count belongs.
        for one in reader.connections:
            if not (isinstance(one.topic, str) and isinstance(one.msgtype, str) and isinstance(one.msgcount, int)):
                raise ValueError(f"the metadata name a topic {one.topic!r} of type {one.msgtype!r}")
    # A damaged file may raise anything from the depths of the reader, not only its own errors.
    except Exception as error:
        raise InputError(_unreadable(path, error)) from error
    stack.callback(_close, reader)
    return reader


def _close(reader: Reader) -> None:
    with suppress(OSError):
        reader.close()


def _storage(path: Path) -> Path:
    """What the reader opens: the path itself, or the only file of a folder that lost its metadata."""
    if not path.exists():
        raise InputError(f"{path} does not exist; give {_KINDS}")
    if not path.is_dir():
        if path.suffix not in (*_STORAGE_SUFFIXES, ".bag"):
            raise InputError(f"{path} is not a bag; give {_KINDS}")
        return path
    if (path / "metadata.yaml").exists():
        return path
    files = sorted(file for file in path.iterdir() if file.suffix in _STORAGE_SUFFIXES)
    if not files:
        raise InputError(f"{path} is not a bag: it has neither metadata.yaml nor a recording; give {_KINDS}")
    if len(files) > 1:
        raise InputError(
            f"{path} has {len(files)} recordings but no metadata.yaml that orders them; "
            "make it with `ros2 bag reindex`, or give one of the files"
        )
    return files[0]


def _unreadable(path: Path, error: Exception, read: int | None = None) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{path} cannot be read: {error.strerror}"
    reason = " ".join(str(error).split()).rstrip(".") or type(error).__name__
    where = "" if read is None else f" after {read} messages"
    repair = _REPAIRS.get(path.suffix, "repair a copy with `ros2 bag reindex`")
    return f"{path} is damaged or cut off{where} ({reason}); {repair}, or record it again"


def _types(connections: Collection[Connection]) -> dict[str, str]:
    types: dict[str, set[str]] = {}
    for connection in connections:
        types.setdefault(connection.topic, set()).add(connection.msgtype)
    return {topic: " and ".join(sorted(types[topic])) for topic in sorted(types)}


def _select(path: Path, connections: Collection[Connection], wanted: Mapping[str, str]) -> list[Connection]:
    """The connections of the wanted topics in the order of the bag, which decides between equal log times."""
    types = _types(connections)
    for topic, type_name in wanted.items():
        if topic not in types:
            raise InputError(f"{path} has no topic {topic} of type {type_name}; it has {listing(types, type_name)}")
        if not any(one.topic == topic and one.msgtype == type_name for one in connections):
            raise InputError(f"the topic {topic} of {path} has the type {types[topic]}, but {type_name} is needed")
    selected = [one for one in connections if wanted.get(one.topic) == one.msgtype]
    for one in selected:
        if isinstance(one.ext, ConnectionExtRosbag2) and one.ext.serialization_format != "cdr":
            encoding = one.ext.serialization_format
            raise InputError(f"the topic {one.topic} of {path} is recorded as {encoding!r}, but CDR is needed")
    return selected


def listing(types: Mapping[str, str], type_name: str) -> str:
    """The topics of a bag for an error message, those of the right type first."""
    if not types:
        return "no topics at all"
    ordered = sorted(types, key=lambda topic: types[topic] != type_name)
    named = ", ".join(f"{topic} ({types[topic]})" for topic in ordered[:_MOST_TOPICS_NAMED])
    more = len(ordered) - _MOST_TOPICS_NAMED
    return named if more <= 0 else f"{named} and {more} more"


Converter = Callable[[bytes, str], memoryview]


def _ros1_converter(path: Path, connections: Collection[Connection]) -> Converter:
    """The conversion with the definitions that the bag itself holds, so it needs no installed message packages."""
    return _typestore(path, connections, ros1=True).ros1_to_cdr


def decoders(path: str | os.PathLike[str], wanted: Mapping[str, str]) -> dict[str, Callable[[bytes], Any]]:
    """What makes objects of the messages (in CDR) of some topics, by the definitions that the bag itself holds.

    `wanted` has the topics and the types of their messages, as for `read_messages`.

    Raises:
        InputError: as `read_messages` does before the first message, or the bag holds no definition of a type.
    """
    path = Path(path)
    with ExitStack() as stack:
        reader = _open(path, stack)
        connections = _select(path, reader.connections, wanted)
    typestore = _typestore(path, connections, ros1=isinstance(reader, Ros1Reader))
    return {one.topic: partial(typestore.deserialize_cdr, typename=one.msgtype) for one in connections}


def _typestore(path: Path, connections: Collection[Connection], *, ros1: bool) -> Typestore:
    """The types of the messages of some connections."""
    typestore = get_typestore(Stores.EMPTY)
    definitions = {}
    for one in connections:
        if one.msgdef.format is MessageDefinitionFormat.NONE:
            raise InputError(f"{path} holds no definition of {one.msgtype} on {one.topic}; record it again as MCAP")
    try:
        for one in connections:
            if one.msgdef.format is MessageDefinitionFormat.IDL:
                # One section for each type, under a line with its name.
                for section in one.msgdef.data.split(_IDL)[1:]:
                    definitions.update(get_types_from_idl(section.partition("\n")[2]))
            else:
                definitions.update(get_types_from_msg(one.msgdef.data, one.msgtype))
        if ros1:
            # The conversion drops the sequence number of ROS 1 headers itself, and expects the definition without it.
            definitions[_HEADER] = get_typestore(Stores.ROS2_JAZZY).fielddefs[_HEADER]
        typestore.register(definitions)
    except Exception as error:
        raise InputError(_unreadable(path, error)) from error
    return typestore


def _stream(
    path: Path,
    reader: Reader,
    connections: list[Connection],
    to_cdr: Converter | None,
    stack: ExitStack,
) -> Iterator[BagMessage]:
    announced = sum(connection.msgcount for connection in connections)
    read = 0
    with stack:
        # An empty selection would mean every topic to the reader.
        messages = reader.messages(connections) if connections else ()
        try:
            for connection, log_time, data in messages:
                message = data if to_cdr is None else to_cdr(data, connection.msgtype)
                yield BagMessage(connection.topic, log_time, bytes(message))
                read += 1
        except Exception as error:
            raise InputError(_unreadable(path, error, read)) from error
        if read < announced:
            raise InputError(_unreadable(path, EOFError(f"only {read} of {announced} messages are there")))
