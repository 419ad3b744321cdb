"""Reading recorded messages as bytes: MCAP files, rosbag2 folders (MCAP or SQLite) and ROS 1 bags."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

from ..errors import InputError
from ..ros.messages import MalformedMessage
from ..wording import counted, listed, plain
from .chunks import UNKNOWN, ZSTD_MAGIC, BagChannel, Expansion, Flaw, decompress_file, decompressed_message
from .find import COMPRESSED, files_of, storage_of
from .mcap_file import McapFile
from .ros1_file import Ros1File
from .sqlite_file import SqliteFile

MessageFile = McapFile | Ros1File | SqliteFile
_FORMATS: Final[dict[str, Callable[[Path], MessageFile]]] = {".mcap": McapFile, ".db3": SqliteFile, ".bag": Ros1File}
_ENCODINGS: Final = ("cdr", "ros1")
_REPAIRS: Final = {
    ".mcap": "repair a copy with `mcap recover`",
    ".bag": "repair a copy with `rosbag reindex`",
}


class UnusableMessage(MalformedMessage):
    """A whole message that its adapter refuses; says which adapter, and why."""


class BagMessage(NamedTuple):
    """A recorded message: `log_time` in ns, `data` in CDR."""

    topic: str
    log_time: int
    data: bytes


class Bag:
    """A bag that is open; a context manager. However much is asked of it, it is looked through, and decompressed, once.

    `wanted` has topics and the types that their messages must have, as in {"/odom": "nav_msgs/msg/Odometry"}.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Open it; raises InputError where it is not there, is no bag, or cannot be read."""
        self.path = Path(path)
        files, self._counts, self._flaw = files_of(self.path)
        with ExitStack() as stack:
            try:
                self._files = [_opened(file, stack) for file in files]
            except OSError as error:
                raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
            self._stack = stack.pop_all()
        self._channels = [channel for one in self._files for channel in one.channels]

    def __enter__(self) -> Bag:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def topics(self) -> dict[str, str]:
        """The topics with the types of their messages, in order; of a damaged bag those that can be read. InputError
        where the bag is so damaged that none can be read.
        """
        if not self._channels:
            self._refuse_damaged()
        types: dict[str, set[str]] = {}
        for one in self._channels:
            name = one.type_name if one.encoding in _ENCODINGS else f"{one.type_name} as {one.encoding}"
            types.setdefault(one.topic, set()).add(name)
        return {topic: " and ".join(sorted(types[topic])) for topic in sorted(types)}

    def messages(self, wanted: Mapping[str, str]) -> Iterator[BagMessage]:
        """The messages of some topics in the order of their log times, read while they are asked for.

        Messages of ROS 1 are converted to CDR. What can be known before the first message is checked at once. Of a bag
        in several files, one is read after the other. InputError where the bag lacks a topic, or a topic has another
        type, and while reading where the bag is damaged, after every message before the damage.
        """
        ros1 = [one for one in self._select(wanted) if one.encoding == "ros1"]
        to_cdr = None
        if ros1:
            from .definitions import typestore_of

            to_cdr = typestore_of(self.path, ros1).ros1_to_cdr
        return self._stream(wanted, to_cdr)

    def decoders(self, wanted: Mapping[str, str]) -> dict[str, Callable[[bytes], Any]]:
        """What makes objects of the messages (in CDR) of some topics, by the definitions that the bag itself holds;
        InputError where the bag lacks a topic or the definition of a type, or a topic has another type.
        """
        from .definitions import typestore_of

        selected = self._select(wanted)
        typestore = typestore_of(self.path, selected)
        return {one.topic: partial(typestore.deserialize_cdr, typename=one.type_name) for one in selected}

    def _select(self, wanted: Mapping[str, str]) -> list[BagChannel]:
        """The channels of the wanted topics."""
        selected = [one for one in self._channels if _is_wanted(one, wanted)]
        there = {one.topic for one in selected}
        for topic, type_name in wanted.items():
            if topic not in there:
                raise InputError(self._why_lacking(topic, type_name))
        return selected

    def _why_lacking(self, topic: str, type_name: str) -> str:
        """Why a topic cannot be read as a type; InputError where the bag is damaged, and the topic may be in what is
        lost.
        """
        of_topic = [one for one in self._channels if one.topic == topic]
        for one in of_topic or [one for one in self._channels if one.type_name == type_name]:
            if one.encoding not in _ENCODINGS:
                return (
                    f"the topic {one.topic} ({one.type_name or 'no type'}) of {self.path} is recorded as "
                    f"{one.encoding!r}, but CDR is needed, as `ros2 bag record` writes it; record or convert it so"
                )
        types = self.topics()
        if not of_topic:
            self._refuse_damaged()
            return f"{self.path} has no topic {topic} of type {type_name}; it has {listing(types, type_name)}"
        has = f"has the type {types[topic]}" if types[topic] else "tells no type"
        return (
            f"the topic {topic} of {self.path} {has}, but {type_name} is needed; "
            f"give another topic by --remap, or record it as {type_name}"
        )

    def _stream(
        self, wanted: Mapping[str, str], to_cdr: Callable[[bytes, str], memoryview] | None
    ) -> Iterator[BagMessage]:
        announced = self._announced(wanted)
        read = first = last = 0
        for one in self._files:
            chosen = {channel.id: channel for channel in one.channels if _is_wanted(channel, wanted)}
            expansion = Expansion(one.size)
            try:
                for log_time, _, id_, data in one.messages(chosen):
                    channel = chosen[id_]
                    if data[:4] == ZSTD_MAGIC:
                        data = decompressed_message(data)
                        expansion.take(len(data))
                    if to_cdr is not None and channel.encoding == "ros1":
                        data = bytes(to_cdr(data, channel.type_name))
                    yield BagMessage(channel.topic, log_time, data)
                    first, last = first if read else log_time, log_time
                    read += 1
            # Damaged messages may raise anything from the depths of a converter, not only its own errors.
            except Exception as error:
                where = f" after {counted(read, 'message')}"
                if read:
                    where += f", {(last - first) / 1e9:.3f} s after the first"
                reason = self._reason(one, error, max(0, announced - read))
                raise InputError(self._damaged(reason, where)) from error
        if self._flaw:
            raise InputError(self._damaged(self._flaw, f" after {counted(read, 'message')}"))
        if read < announced:
            raise InputError(self._damaged(f"only {read:,} of {counted(announced, 'message')} are there"))

    def _announced(self, wanted: Mapping[str, str]) -> int:
        """How many messages there should be: at least so many."""
        if self._counts:
            return sum(self._counts.get(topic, 0) for topic in wanted.items())
        counts = [one.announced for one in self._channels if wanted.get(one.topic) == one.type_name]
        return 0 if UNKNOWN in counts else sum(counts)

    def _refuse_damaged(self) -> None:
        """Refuse a bag so damaged that what is asked for may be in what is lost."""
        if self._flaw:
            raise InputError(self._damaged(self._flaw))
        for one in self._files:
            if one.flaw is not None:
                raise InputError(self._damaged(self._reason(one, one.flaw, 0)))

    def _reason(self, one: MessageFile, error: Exception, lost: int) -> str:
        """What is wrong, where, and what is lost by it."""
        said = [plain(str(error)).rstrip(".") or type(error).__name__]
        if isinstance(error, Flaw) and error.place > 0:
            said[0] += f", at byte {error.place:,} of {one.size:,}"
        if len(self._files) > 1:
            said[0] += f" of {one.path.name}"
            unread = len(self._files) - self._files.index(one) - 1
            if unread:
                said.append("the file after it was not read" if unread == 1 else f"the {unread} after it were not read")
        if lost:
            said.append(f"{counted(lost, 'message')} {'is' if lost == 1 else 'are'} lost")
        return "; ".join(said)

    def _damaged(self, reason: str, where: str = "") -> str:
        repair = _REPAIRS.get(self.path.suffix, "repair a copy with `ros2 bag reindex`")
        return f"{self.path} is damaged or cut off{where} ({reason}); {repair}, or record it again"


def topics(path: str | os.PathLike[str]) -> dict[str, str]:
    """The topics of a bag with the types of their messages: `Bag.topics`."""
    with Bag(path) as bag:
        return bag.topics()


def read_messages(path: str | os.PathLike[str], wanted: Mapping[str, str]) -> Iterator[BagMessage]:
    """The messages of some topics of a bag: `Bag.messages`."""
    with ExitStack() as stack:
        messages = stack.enter_context(Bag(path)).messages(wanted)
        return _read_and_close(messages, stack.pop_all())


def _read_and_close(messages: Iterator[BagMessage], stack: ExitStack) -> Iterator[BagMessage]:
    with stack:
        yield from messages


def listing(types: Mapping[str, str], type_name: str) -> str:
    """The topics of a bag for an error message, those of the right type first."""
    if not types:
        return "no topics at all"
    ordered = sorted(types, key=lambda topic: types[topic] != type_name)
    return listed([f"{topic} ({types[topic] or 'no type'})" for topic in ordered])


def _is_wanted(channel: BagChannel, wanted: Mapping[str, str]) -> bool:
    return wanted.get(channel.topic) == channel.type_name and channel.encoding in _ENCODINGS


def _opened(path: Path, stack: ExitStack) -> MessageFile:
    """Open a file, decompressed as a whole where it is compressed as a whole."""
    storage, flaw = path, None
    if path.name.endswith(COMPRESSED):
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="impact_predictor_")))
        storage = folder / f"bag{storage_of(path)}"
        if not decompress_file(path, storage):
            flaw = Flaw(storage.stat().st_size, "its compressed bytes are damaged or cut off")
    file = _FORMATS[storage_of(path)](storage)
    stack.callback(file.close)
    file.path, file.flaw = path, flaw or file.flaw
    return file
