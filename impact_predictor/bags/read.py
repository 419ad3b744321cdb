"""Reading recorded messages as bytes: MCAP files, rosbag2 folders (MCAP or SQLite) and ROS 1 bags."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

from ..errors import InputError
from ..ros.messages import MalformedMessage
from ..wording import counted
from .chunks import UNKNOWN, Channel, Flaw
from .compression import ZSTD_MAGIC, decompressed_message
from .parts import Part, Recording, opened

_ENCODINGS: Final = ("cdr", "ros1")
_REPAIRS: Final = {
    ".mcap": "repair a copy with `mcap recover`",
    ".bag": "repair a copy with `rosbag reindex`",
}

_MOST_TOPICS_NAMED: Final = 20


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
        """Open it.

        Raises:
            InputError: it is not there, is no bag, or cannot be read.
        """
        self.path = Path(path)
        with ExitStack() as stack:
            self._recording = opened(self.path, stack)
            self._stack = stack.pop_all()

    def __enter__(self) -> Bag:
        """Nothing more is to be done."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close its files."""
        self._stack.close()

    def topics(self) -> dict[str, str]:
        """The topics with the types of their messages, in order; of a damaged bag those that can be read.

        Raises:
            InputError: the bag is so damaged that none can be read.
        """
        types = _types(_channels(self._recording))
        if not types:
            _check_whole(self.path, self._recording)
        return types

    def messages(self, wanted: Mapping[str, str]) -> Iterator[BagMessage]:
        """The messages of some topics in the order of their log times, read while they are asked for.

        Messages of ROS 1 are converted to CDR. What can be known before the first message is checked at once. Of a
        bag in several files, one is read after the other.

        Raises:
            InputError: the bag lacks a topic, or a topic has another type; while reading: the bag is damaged, after
                every message before the damage.
        """
        selected = _select(self.path, self._recording, wanted)
        ros1 = [one for one in selected if one.encoding == "ros1"]
        to_cdr = _ros1_converter(self.path, ros1) if ros1 else None
        return _stream(self.path, self._recording, wanted, to_cdr)

    def decoders(self, wanted: Mapping[str, str]) -> dict[str, Callable[[bytes], Any]]:
        """What makes objects of the messages (in CDR) of some topics, by the definitions that the bag itself holds.

        Raises:
            InputError: the bag lacks a topic or the definition of a type, or a topic has another type.
        """
        from .definitions import typestore_of

        selected = _select(self.path, self._recording, wanted)
        typestore = typestore_of(self.path, selected)
        return {one.topic: partial(typestore.deserialize_cdr, typename=one.type_name) for one in selected}


def topics(path: str | os.PathLike[str]) -> dict[str, str]:
    """The topics of a bag with the types of their messages: `Bag.topics`.

    Raises:
        InputError: the bag is not there or cannot be read.
    """
    with Bag(path) as bag:
        return bag.topics()


def read_messages(path: str | os.PathLike[str], wanted: Mapping[str, str]) -> Iterator[BagMessage]:
    """The messages of some topics of a bag: `Bag.messages`.

    Raises:
        InputError: the bag is not there or cannot be read, and what `Bag.messages` raises.
    """
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
    named = ", ".join(f"{topic} ({types[topic] or 'no type'})" for topic in ordered[:_MOST_TOPICS_NAMED])
    more = len(ordered) - _MOST_TOPICS_NAMED
    return named if more <= 0 else f"{named} and {more} more"


def _channels(recording: Recording) -> list[Channel]:
    return [channel for part in recording.parts for channel in part.file.channels]


def _types(channels: Collection[Channel]) -> dict[str, str]:
    types: dict[str, set[str]] = {}
    for one in channels:
        name = one.type_name if one.encoding in _ENCODINGS else f"{one.type_name} as {one.encoding}"
        types.setdefault(one.topic, set()).add(name)
    return {topic: " and ".join(sorted(types[topic])) for topic in sorted(types)}


def _select(path: Path, recording: Recording, wanted: Mapping[str, str]) -> list[Channel]:
    """The channels of the wanted topics."""
    channels = _channels(recording)
    types = _types(channels)
    for topic, type_name in wanted.items():
        of_topic = [one for one in channels if one.topic == topic]
        if any(one.type_name == type_name and one.encoding in _ENCODINGS for one in of_topic):
            continue
        similar = of_topic or [one for one in channels if one.type_name == type_name]
        foreign = [one for one in similar if one.encoding not in _ENCODINGS]
        if foreign:
            raise InputError(_wrongly_encoded(path, foreign[0]))
        if not of_topic:
            _check_whole(path, recording)
            raise InputError(f"{path} has no topic {topic} of type {type_name}; it has {listing(types, type_name)}")
        has = f"has the type {types[topic]}" if types[topic] else "tells no type"
        raise InputError(
            f"the topic {topic} of {path} {has}, but {type_name} is needed; "
            f"give another topic by --remap, or record it as {type_name}"
        )
    return [one for one in channels if wanted.get(one.topic) == one.type_name and one.encoding in _ENCODINGS]


def _wrongly_encoded(path: Path, channel: Channel) -> str:
    what = f"{channel.topic} ({channel.type_name or 'no type'}) of {path} is recorded as {channel.encoding!r}"
    return f"the topic {what}, but CDR is needed, as `ros2 bag record` writes it; record or convert it so"


Converter = Callable[[bytes, str], memoryview]


def _ros1_converter(path: Path, channels: Collection[Channel]) -> Converter:
    from .definitions import typestore_of

    return typestore_of(path, channels).ros1_to_cdr


def _stream(
    path: Path, recording: Recording, wanted: Mapping[str, str], to_cdr: Converter | None
) -> Iterator[BagMessage]:
    announced = _announced(recording, wanted)
    read = first = last = 0
    for part in recording.parts:
        chosen = {
            one.id: one
            for one in part.file.channels
            if wanted.get(one.topic) == one.type_name and one.encoding in _ENCODINGS
        }
        names = {id_: one.topic for id_, one in chosen.items()}
        ros1 = {id_ for id_, one in chosen.items() if one.encoding == "ros1"}
        try:
            for log_time, _, channel, data in part.file.messages(chosen):
                if data[:4] == ZSTD_MAGIC:
                    data = decompressed_message(data)
                if to_cdr is not None and channel in ros1:
                    data = bytes(to_cdr(data, chosen[channel].type_name))
                yield BagMessage(names[channel], log_time, data)
                first = first if read else log_time
                last = log_time
                read += 1
            if part.flaw is not None:
                raise part.flaw
        # Damaged messages may raise anything from the depths of a converter, not only its own errors.
        except Exception as error:
            where = f" after {counted(read, 'message')}"
            if read:
                where += f", {(last - first) / 1e9:.3f} s after the first"
            lost = max(0, announced - read)
            raise InputError(_unreadable(path, _reason(part, part.flaw or error, recording, lost), where)) from error
    if recording.flaw:
        raise InputError(_unreadable(path, recording.flaw, f" after {counted(read, 'message')}"))
    if read < announced:
        raise InputError(_unreadable(path, f"only {read:,} of {counted(announced, 'message')} are there"))


def _announced(recording: Recording, wanted: Mapping[str, str]) -> int:
    """How many messages there should be: at least so many."""
    if recording.counts:
        return sum(recording.counts.get(topic, 0) for topic in wanted.items())
    counts = [one.announced for one in _channels(recording) if wanted.get(one.topic) == one.type_name]
    return 0 if UNKNOWN in counts else sum(counts)


def _check_whole(path: Path, recording: Recording) -> None:
    """Refuse a bag so damaged that what is asked for may be in what is lost."""
    if recording.flaw:
        raise InputError(_unreadable(path, recording.flaw))
    for part in recording.parts:
        flaw = part.flaw or part.file.flaw
        if flaw is not None:
            raise InputError(_unreadable(path, _reason(part, flaw, recording, 0)))


def _reason(part: Part, error: Exception, recording: Recording, lost: int) -> str:
    """What is wrong, where, and what is lost by it."""
    said = [" ".join(str(error).split()).rstrip(".") or type(error).__name__]
    if isinstance(error, Flaw) and error.place > 0:
        said[0] += f", at byte {error.place:,} of {part.file.size:,}"
    if len(recording.parts) > 1:
        said[0] += f" of {part.path.name}"
        unread = len(recording.parts) - recording.parts.index(part) - 1
        if unread:
            said.append("the file after it was not read" if unread == 1 else f"the {unread} after it were not read")
    if lost:
        said.append(f"{counted(lost, 'message')} {'is' if lost == 1 else 'are'} lost")
    return "; ".join(said)


def _unreadable(path: Path, reason: str, where: str = "") -> str:
    repair = _REPAIRS.get(path.suffix, "repair a copy with `ros2 bag reindex`")
    return f"{path} is damaged or cut off{where} ({reason}); {repair}, or record it again"
