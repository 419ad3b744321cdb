"""Reading MCAP files, with or without an index, as far as they go.

Source: the specification of the format, https://mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Final

from .chunked_file import ChunkedFile
from .chunks import Channel, Chunk, Flaw, Message, ros2_name, text, unpacked
from .compression import LARGEST

MAGIC: Final = b"\x89MCAP0\r\n"

_FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _MESSAGE_INDEX = 0x02, 0x03, 0x04, 0x05, 0x06, 0x07
_STATISTICS, _DATA_END = 0x0B, 0x0F
_OPCODES: Final = frozenset(range(0x01, 0x10)) | frozenset(range(0x80, 0x100))
"""Those of the format, and those of applications, which are skipped."""

_RECORD: Final = struct.Struct("<BQ")
_MESSAGE_HEAD: Final = struct.Struct("<BQHIQQ")
_CHUNK_HEAD: Final = struct.Struct("<QQQI")
_LONGEST: Final = 1 << 24
"""More bytes than any record has that tells something about others."""

_GROUP: Final = 1 << 20
"""Messages outside of chunks are read in groups of about so many bytes."""


class McapFile(ChunkedFile):
    """An MCAP file."""

    def __init__(self, path: Path) -> None:
        """Find the chunks and channels of a file, up to the first damage.

        Raises:
            OSError: it cannot be read.
        """
        self._schemas: dict[int, tuple[str, str, str]] = {}
        self._tells_channels = False
        self._checksum: tuple[int, int] | None = None
        super().__init__(path)

    def messages(self, wanted: Collection[int]) -> Iterator[Message]:
        """The messages of some channels in the order of their log times.

        Raises:
            Flaw: the file is damaged, after all messages before that.
        """
        yield from super().messages(wanted)
        if self._checksum is not None and not self._data_are_right(*self._checksum):
            raise Flaw(self.size, "the checksum of all its data is wrong, so that any message may be")

    def _scan(self) -> None:
        file = self._file
        if file.read(len(MAGIC)) != MAGIC:
            raise Flaw(0, "it does not begin as an MCAP file does")
        place = begin = len(MAGIC)
        loose: list[tuple[int, int]] = []
        while True:
            file.seek(place)
            head = file.read(_MESSAGE_HEAD.size)
            opcode, length = _RECORD.unpack_from(head) if len(head) >= _RECORD.size else (0, 0)
            end = place + _RECORD.size + length
            if opcode == _MESSAGE and length >= _MESSAGE_HEAD.size - _RECORD.size and end <= self.size:
                _, _, channel, _, log_time, _ = _MESSAGE_HEAD.unpack(head)
                loose.append((channel, log_time))
            if loose and (opcode != _MESSAGE or end > self.size or end - begin > _GROUP):
                self._group(begin, min(end, self.size) if opcode == _MESSAGE else place, loose)
                loose = []
            if opcode != _MESSAGE or end > self.size:
                if len(head) < _RECORD.size:
                    raise Flaw(place, "it is cut off")
                try:
                    self._take(opcode, place, length)
                except (ValueError, struct.error) as error:
                    raise Flaw(place, "a record is damaged") from error
                if opcode in (_DATA_END, _FOOTER):
                    return
            place = end
            begin = begin if loose else end

    def _group(self, begin: int, end: int, loose: list[tuple[int, int]]) -> None:
        """Take messages that lie outside of chunks as a chunk."""
        channels = frozenset(channel for channel, _ in loose)
        start = min(log_time for _, log_time in loose)
        self._chunks.append(Chunk(begin, start, (begin, end - begin), "", end - begin, 0, False, channels))
        for channel, _ in loose:
            self._counts[channel] += 1

    def _take(self, opcode: int, place: int, length: int) -> None:
        """Take a record of the data that is no message."""
        end = place + _RECORD.size + length
        if opcode not in _OPCODES:
            raise ValueError("unknown")
        if opcode == _CHUNK:
            self._chunks.append(self._chunk(place, length))
        if end > self.size:
            raise Flaw(place, "it is cut off")
        if opcode in (_SCHEMA, _CHANNEL):
            self._learn(opcode, self._body(place, length))
        elif opcode == _MESSAGE_INDEX and self._chunks:
            channel, entries = struct.unpack("<HI", self._body(place, 6))
            told = self._chunks[-1].channels or frozenset()
            self._chunks[-1] = self._chunks[-1]._replace(channels=told | {channel})
            self._counts[channel] += entries // 16
        elif opcode == _DATA_END:
            (crc,) = struct.unpack("<I", self._body(place, 4))
            self._checksum = (crc, place) if crc else None
            self._take_summary(end)
        elif opcode == _FOOTER:
            self._take_summary(place)

    def _chunk(self, place: int, length: int) -> Chunk:
        head = self._body(place, min(length, _CHUNK_HEAD.size + 4 + 255 + 8))
        start, _, size, crc = _CHUNK_HEAD.unpack_from(head)
        compression, at = text(head, _CHUNK_HEAD.size)
        (compressed,) = struct.unpack_from("<Q", head, at)
        begin = place + _RECORD.size + at + 8
        if at + 8 + compressed != length:
            raise ValueError("the lengths contradict each other")
        there = max(0, min(compressed, self.size - begin))
        return Chunk(place, start, (begin, there), compression, size, crc, there == compressed, None)

    def _body(self, place: int, length: int) -> bytes:
        """The beginning of a record, or all of it."""
        if length > _LONGEST:
            raise ValueError("too long")
        self._file.seek(place + _RECORD.size)
        return self._file.read(length)

    def _take_summary(self, begin: int) -> None:
        """Take what follows the data: the schemas and channels once more, and how many messages there are.

        Raises:
            Flaw: it is damaged, and nothing of it was taken.
        """
        self._file.seek(begin)
        data = self._file.read(min(LARGEST, self.size - begin))
        footer = len(data) - len(MAGIC) - _RECORD.size - 20
        flaw = Flaw(begin, "the index behind its messages is damaged; nothing tells whether any are missing")
        if footer < 0 or data[footer : footer + _RECORD.size] != _RECORD.pack(_FOOTER, 20) or data[-8:] != MAGIC:
            raise flaw
        summary, _, crc = struct.unpack_from("<QQI", data, footer + _RECORD.size)
        first = summary - begin if summary else footer
        if not 0 <= first <= footer or (crc and zlib.crc32(data[first : footer + _RECORD.size + 16]) != crc):
            raise flaw
        try:
            for opcode, body in _records(data[first:footer]):
                if opcode in (_SCHEMA, _CHANNEL):
                    self._learn(opcode, body)
                    self._tells_channels |= opcode == _CHANNEL
                elif opcode == _STATISTICS:
                    self._counts = dict(struct.iter_unpack("<HQ", body[46:]))
        except (ValueError, struct.error) as error:
            raise flaw from error

    def _learn(self, opcode: int, body: bytes) -> None:
        """Take a schema or a channel."""
        (id_,) = struct.unpack_from("<H", body)
        if opcode == _SCHEMA:
            name, at = text(body, 2)
            encoding, at = text(body, at)
            definition, _ = text(body, at)
            self._schemas.setdefault(id_, (name, encoding, definition))
        else:
            (schema,) = struct.unpack_from("<H", body, 2)
            topic, at = text(body, 4)
            encoding, _ = text(body, at)
            name, language, definition = self._schemas.get(schema, ("", "", ""))
            name = ros2_name(name) if encoding == "ros1" else name
            self._channels.setdefault(id_, Channel(id_, topic, name, encoding, language, definition))

    def _look_into_chunks(self) -> None:
        for chunk in self._chunks:
            if chunk.channels is None and self._tells_channels:
                continue
            if chunk.channels is None or not chunk.channels <= self._channels.keys():
                try:
                    for opcode, body in _records(unpacked(chunk, self._file)):
                        if opcode in (_SCHEMA, _CHANNEL):
                            self._learn(opcode, body)
                except (ValueError, struct.error) as error:
                    if chunk.whole:
                        raise Flaw(chunk.place, "a chunk is damaged") from error

    def _data_are_right(self, checksum: int, end: int) -> bool:
        self._file.seek(0)
        crc = 0
        for place in range(0, end, _GROUP):
            crc = zlib.crc32(self._file.read(min(_GROUP, end - place)), crc)
        return crc == checksum

    @staticmethod
    def _messages(chunk: Chunk, data: bytes, wanted: Collection[int]) -> list[Message]:
        head, size = _MESSAGE_HEAD, len(data)
        found = []
        place = 0
        while place + head.size <= size:
            opcode, length, channel, _, log_time, _ = head.unpack_from(data, place)
            end = place + _RECORD.size + length
            if opcode == _MESSAGE and channel in wanted and place + head.size <= end <= size:
                found.append(Message(log_time, chunk.place, channel, data[place + head.size : end]))
            place = end
        if chunk.whole and place != size:
            raise Flaw(chunk.place, "a chunk ends within a record")
        return found


def _records(data: bytes) -> Iterator[tuple[int, bytes]]:
    """The records of a chunk, each its opcode and body.

    Raises:
        ValueError: the last one is not whole.
    """
    place = 0
    while place < len(data):
        opcode, length = _RECORD.unpack_from(data, place)
        body = data[place + _RECORD.size : place + _RECORD.size + length]
        if len(body) < length:
            raise ValueError("cut off")
        yield opcode, body
        place += _RECORD.size + length
