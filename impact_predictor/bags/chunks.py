"""What MCAP files and ROS 1 bags have in common: chunks of messages, read in the order of their log times."""

from __future__ import annotations

import os
import re
import struct
import sys
import zlib
from abc import ABC, abstractmethod
from bisect import bisect_left
from bz2 import BZ2Decompressor
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from operator import itemgetter
from pathlib import Path
from typing import Any, BinaryIO, Final, NamedTuple

from lz4.frame import LZ4FrameDecompressor

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

ZSTD_MAGIC: Final = b"\x28\xb5\x2f\xfd"
"""What zstd begins with, and no message in CDR does."""

_DECOMPRESSORS: Final[dict[str, Callable[[], Any]]] = {
    "zstd": zstd.ZstdDecompressor,
    "lz4": LZ4FrameDecompressor,
    "bz2": BZ2Decompressor,
}
_PIECE: Final = 1 << 20

LARGEST: Final = 1 << 28
"""Bytes above which nothing is read or decompressed at once: a bag of a few bytes may claim any number."""

EXPANSION: Final = 100
"""A file may become so many times as long when it is decompressed, besides `LARGEST`: else it would take hours."""

UNKNOWN: Final = -1
"""Number of messages that nothing tells."""

_DAMAGE: Final = (ValueError, LookupError, struct.error)
"""What reading damaged records raises."""


class Flaw(Exception):
    """What is wrong with a file; `place` is the byte from which on nothing of it is used."""

    def __init__(self, place: int, what: str) -> None:
        super().__init__(what)
        self.place = place


class Expansion:
    """What the compressed parts of a file may still become."""

    def __init__(self, size: int) -> None:
        """Of a file of so many bytes."""
        self._left = EXPANSION * size + LARGEST

    def take(self, count: int, place: int = 0) -> None:
        """Take that the part at a place has become so many bytes; raises Flaw where all together are too many."""
        self._left -= count
        if self._left < 0:
            raise Flaw(place, f"it decompresses to more than {EXPANSION} times its size")


class BagChannel(NamedTuple):
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


class RawMessage(NamedTuple):
    """A message in a file; `place` is that of its chunk, `log_time` in ns."""

    log_time: int
    place: int
    channel: int
    data: bytes


class Chunk(NamedTuple):
    """Messages that lie together: `place` is where they begin in the file, `start` their first log time in ns.

    `begin` and `length` are those of their bytes, `size` the number that they have without compression, `crc` the
    checksum of those, or 0. Bytes beyond the end of the file were cut off: `whole` is False. `channels` are those that
    have messages here, as far as that is known.
    """

    place: int
    start: int
    begin: int
    length: int
    size: int
    whole: bool
    compression: str = ""
    crc: int = 0
    channels: frozenset[int] | None = None

    def unpacked(self, file: BinaryIO, expansion: Expansion) -> bytes:
        """Its bytes without compression; of a chunk that was cut off, those that there are. Flaw where they are
        damaged.
        """
        size = max(self.size, self.length)
        if size > LARGEST:
            what = f"a chunk says that it has {size:,} bytes, more than the {LARGEST:,} that any may have"
            raise Flaw(self.place, what)
        file.seek(self.begin)
        data = file.read(self.length)
        try:
            # Damaged bytes may become any number of others: one more than there should be is enough to know.
            data = decompressed(data, self.compression, self.size + 1)
        except KeyError as error:
            raise Flaw(self.place, f"a chunk is compressed by {self.compression!r}, which is not known") from error
        except Exception as error:
            raise Flaw(self.place, "a chunk cannot be decompressed") from error
        if self.compression:
            expansion.take(len(data), self.place)
        if self.whole and len(data) != self.size:
            raise Flaw(self.place, f"a chunk has {len(data)} bytes instead of {self.size}")
        if self.whole and self.crc and zlib.crc32(data) != self.crc:
            raise Flaw(self.place, "the checksum of a chunk is wrong")
        return data


class ChunkedFile(ABC):
    """A file that is read up to its first damage outside of chunks, which is its `flaw`."""

    def __init__(self, path: Path) -> None:
        """Find the chunks and channels of a file; messages are read when they are asked for. OSError where it cannot be
        read.
        """
        self.path = path
        self._file: BinaryIO = path.open("rb")
        self.size = os.fstat(self._file.fileno()).st_size
        self.flaw: Flaw | None = None
        self._channels: dict[int, BagChannel] = {}
        self._chunks: list[Chunk] = []
        self._counts: dict[int, int] = defaultdict(int)
        self._expansion = Expansion(self.size)
        known = True
        try:
            self._scan()
        except Flaw as flaw:
            self.flaw, known = flaw, False
            if self._chunks:
                # What tells of its channels may be cut off.
                self._chunks[-1] = self._chunks[-1]._replace(channels=None)
        try:
            self._look_into_chunks()
        except Flaw as flaw:
            self.flaw = flaw
        self.channels = [
            channel._replace(announced=self._counts.get(id_, 0) if known else UNKNOWN)
            for id_, channel in sorted(self._channels.items())
        ]

    def close(self) -> None:
        self._file.close()

    def messages(self, wanted: Collection[int]) -> Iterator[RawMessage]:
        """The messages of some channels by their log times, those of one log time in the order of the file.

        A chunk is loaded when its first message is due, and not where none of the channels is in it. From where one is
        damaged on nothing is used any more; what lies before it is. Flaw where the file is damaged, after all messages
        before that.
        """
        by_time = itemgetter(0, 1)
        waiting: list[RawMessage] = []
        self._expansion = Expansion(self.size)
        flaw: Flaw | None = None
        for chunk in sorted(self._chunks, key=lambda one: (one.start, one.place)):
            if chunk.channels is not None and chunk.channels.isdisjoint(wanted):
                continue
            if flaw is not None and chunk.place >= flaw.place:
                continue
            due = bisect_left(waiting, (chunk.start, chunk.place), key=by_time)
            yield from waiting[:due]
            del waiting[:due]
            try:
                waiting = sorted(waiting + self._loaded(chunk, wanted), key=by_time)
            except Flaw as found:
                flaw = found
                waiting = [message for message in waiting if message.place < found.place]
        yield from waiting
        flaw = flaw or self.flaw
        if flaw is not None:
            raise flaw

    def _loaded(self, chunk: Chunk, wanted: Collection[int]) -> list[RawMessage]:
        data = chunk.unpacked(self._file, self._expansion)
        try:
            messages = self._messages(chunk, data, wanted)
        except _DAMAGE as error:
            raise Flaw(chunk.place, "a chunk is damaged") from error
        if any(message.log_time < chunk.start for message in messages):
            raise Flaw(chunk.place, "a chunk has messages from before its beginning")
        return messages

    def _look_into_chunks(self) -> None:
        """Take what only the chunks themselves tell of their channels; raises the Flaw of a damaged one."""
        for number, chunk in enumerate(self._chunks):
            if chunk.channels is not None and chunk.channels <= self._channels.keys():
                continue
            try:
                self._chunks[number] = self._learn_from(chunk, chunk.unpacked(self._file, self._expansion))
            except _DAMAGE as error:
                if chunk.whole:
                    raise Flaw(chunk.place, "a chunk is damaged") from error

    @abstractmethod
    def _scan(self) -> None:
        """Go from record to record, and take chunks, channels and numbers of messages; Flaw where a record is damaged
        or cut off.
        """

    @abstractmethod
    def _learn_from(self, chunk: Chunk, data: bytes) -> Chunk:
        """Take the channels in the bytes of a chunk; the chunk as it is known then. Raises any of `_DAMAGE`."""

    @staticmethod
    @abstractmethod
    def _messages(chunk: Chunk, data: bytes, wanted: Collection[int]) -> list[RawMessage]:
        """The whole messages of some channels in the bytes of a chunk. Raises any of `_DAMAGE`."""


def ros2_name(type_name: str) -> str:
    """The name that a type of ROS 1 has in ROS 2."""
    return re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", type_name)


def decompressed(data: bytes, name: str, most: int) -> bytes:
    """What there is without a compression of some name ("" and "none" are none), and never more than `most` bytes.

    Of data that were cut off it is the beginning. Raises KeyError where there is no such compression, and of damaged
    data the errors of the libraries.
    """
    if name in ("", "none"):
        return data
    decompressor = _DECOMPRESSORS[name]()
    pieces: list[bytes] = []
    while most > 0:
        piece = decompressor.decompress(data, most)
        pieces.append(piece)
        most -= len(piece)
        data = b""
        if decompressor.eof:
            data = decompressor.unused_data or b""
            if not data:
                break
            decompressor = _DECOMPRESSORS[name]()
        elif not piece:
            break
    return b"".join(pieces)


def decompressed_message(data: bytes) -> bytes:
    """A message that is compressed by itself; of a damaged or too large one the errors of the libraries are raised."""
    message = decompressed(data, "zstd", LARGEST + 1)
    if len(message) > LARGEST:
        raise ValueError(f"a message has more than {LARGEST:,} bytes")
    return message


def decompress_file(source: Path, target: Path) -> bool:
    """Decompress a file as far as it goes; whether that is to its end. OSError where one cannot be read or written."""
    expansion = Expansion(source.stat().st_size)
    with zstd.open(source, "rb") as packed, target.open("wb") as file:
        try:
            # Not `read`: it keeps back what comes right before the damage.
            while piece := packed.read1(_PIECE):
                expansion.take(len(piece))
                file.write(piece)
        except (EOFError, zstd.ZstdError, Flaw):
            return False
    return True
