"""What MCAP files and ROS 1 bags have in common: chunks of messages, read in the order of their log times."""

from __future__ import annotations

import re
import struct
import zlib
from bisect import bisect_left
from collections.abc import Callable, Collection, Iterable, Iterator
from operator import itemgetter
from typing import BinaryIO, Final, NamedTuple

from .compression import LARGEST, decompressed

UNKNOWN: Final = -1
"""Number of messages that nothing tells."""


class Flaw(Exception):
    """What is wrong with a file; `place` is the byte from which on nothing of it is used."""

    def __init__(self, place: int, what: str) -> None:
        super().__init__(what)
        self.place = place


class Channel(NamedTuple):
    """What is recorded of a topic.

    `encoding` is that of the messages ("cdr", "ros1" or what cannot be read), `definition` that of their type, in the
    language of `schema` ("ros2msg", "ros2idl", "ros1msg" or ""); `announced` is how many messages there should be, or
    `UNKNOWN`.
    """

    id: int
    topic: str
    type_name: str
    encoding: str
    schema: str
    definition: str
    announced: int = UNKNOWN


class Message(NamedTuple):
    """A message in a chunk; `place` is that of the chunk in the file, `log_time` in ns."""

    log_time: int
    place: int
    channel: int
    data: bytes


class Chunk(NamedTuple):
    """Messages that lie together: `place` is where they begin in the file, `start` their first log time in ns.

    `data` are place and length of their bytes, `size` the number that they have without compression, `crc` the checksum
    of those, or 0. Bytes beyond the end of the file were cut off: `whole` is False. `channels` are those that have
    messages here, as far as that is told.
    """

    place: int
    start: int
    data: tuple[int, int]
    compression: str
    size: int
    crc: int
    whole: bool
    channels: frozenset[int] | None


def unpacked(chunk: Chunk, file: BinaryIO) -> bytes:
    """The bytes of a chunk without compression; of one that was cut off, those that there are.

    Raises:
        Flaw: they are damaged.
    """
    size = max(chunk.size, chunk.data[1])
    if size > LARGEST:
        raise Flaw(chunk.place, f"a chunk says that it has {size:,} bytes, more than the {LARGEST:,} that any may have")
    file.seek(chunk.data[0])
    data = file.read(chunk.data[1])
    try:
        # Damaged bytes may become any number of others: one more than there should be is enough to know.
        data = decompressed(data, chunk.compression, chunk.size + 1)
    except KeyError as error:
        raise Flaw(chunk.place, f"a chunk is compressed by {chunk.compression!r}, which is not known") from error
    except Exception as error:
        raise Flaw(chunk.place, "a chunk cannot be decompressed") from error
    if chunk.whole and len(data) != chunk.size:
        raise Flaw(chunk.place, f"a chunk has {len(data)} bytes instead of {chunk.size}")
    if chunk.whole and chunk.crc and zlib.crc32(data) != chunk.crc:
        raise Flaw(chunk.place, "the checksum of a chunk is wrong")
    return data


def in_order(chunks: Iterable[Chunk], load: Callable[[Chunk], Iterable[Message]]) -> Iterator[Message]:
    """The messages of chunks by their log times, those of one log time in the order of the file.

    A chunk is loaded when its first message is due. From where one is damaged on nothing is used any more; what lies
    before it is.

    Raises:
        Flaw: that of the first chunk that is damaged, after all messages before it.
    """
    by_time = itemgetter(0, 1)
    waiting: list[Message] = []
    flaw: Flaw | None = None
    for chunk in sorted(chunks, key=lambda one: (one.start, one.place)):
        if flaw is not None and chunk.place >= flaw.place:
            continue
        due = bisect_left(waiting, (chunk.start, chunk.place), key=by_time)
        yield from waiting[:due]
        del waiting[:due]
        try:
            messages = list(load(chunk))
            if any(message.log_time < chunk.start for message in messages):
                raise Flaw(chunk.place, "a chunk has messages from before its beginning")
        except Flaw as found:
            flaw = found
            waiting = [message for message in waiting if message.place < found.place]
            continue
        waiting = sorted(waiting + messages, key=by_time)
    yield from waiting
    if flaw is not None:
        raise flaw


def wanted_of(chunks: Iterable[Chunk], wanted: Collection[int]) -> list[Chunk]:
    """The chunks that have messages of some channels, or do not tell."""
    return [one for one in chunks if one.channels is None or not one.channels.isdisjoint(wanted)]


def ros2_name(type_name: str) -> str:
    """The name that a type of ROS 1 has in ROS 2."""
    return re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", type_name)


def text(data: bytes, at: int) -> tuple[str, int]:
    """A string behind its length in 4 bytes, and where it ends.

    Raises:
        ValueError, struct.error: there is no such string.
    """
    (length,) = struct.unpack_from("<I", data, at)
    end = at + 4 + length
    if end > len(data):
        raise ValueError("a string ends beyond its record")
    return data[at + 4 : end].decode(), end
