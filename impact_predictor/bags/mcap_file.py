"""Reading MCAP files, with or without an index, as far as they go.

The mcap library tells what is in a record. From record to record this module goes itself: it passes chunks by without
reading them, and uses what there is of the one that is cut off. Source: https://mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Collection, Iterator
from io import BytesIO
from pathlib import Path
from typing import Final

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Footer, Schema, Statistics
from mcap.stream_reader import StreamReader

from .chunks import LARGEST, BagChannel, Chunk, ChunkedFile, Flaw, RawMessage, ros2_name

MAGIC: Final = b"\x89MCAP0\r\n"

_OPCODES: Final = frozenset(range(0x01, 0x10)) | frozenset(range(0x80, 0x100))
"""Those of the format, and those of applications, which are skipped."""

_MESSAGE: Final = int(Opcode.MESSAGE)
_RECORD: Final = struct.Struct("<BQ")
_MESSAGE_HEAD: Final = struct.Struct("<BQHIQQ")
_LOOSE_HEAD: Final = struct.Struct("<HIQQ")
_CHUNK_HEAD: Final = struct.Struct("<QQQII")
_LONGEST: Final = 1 << 24
"""More bytes than any record has that tells something about others."""

_GROUP: Final = 1 << 20
"""Messages outside of chunks are read in groups of about so many bytes."""


class McapFile(ChunkedFile):
    """An MCAP file."""

    def __init__(self, path: Path) -> None:
        """Find the chunks and channels of a file, up to the first damage; OSError where it cannot be read."""
        self._schemas: dict[int, Schema] = {}
        self._checksum: tuple[int, int] | None = None
        super().__init__(path)

    def messages(self, wanted: Collection[int]) -> Iterator[RawMessage]:
        """The messages of some channels in the order of their log times; Flaw where the file is damaged, after all
        messages before that.
        """
        yield from super().messages(wanted)
        if self._checksum is not None and not self._data_are_right(*self._checksum):
            raise Flaw(self.size, "the checksum of all its data is wrong, so that any message may be")

    def _scan(self) -> None:
        if self._file.read(len(MAGIC)) != MAGIC:
            raise Flaw(0, "it does not begin as an MCAP file does")
        place = len(MAGIC)
        while True:
            self._file.seek(place)
            head = self._file.read(_RECORD.size)
            if len(head) < _RECORD.size:
                raise Flaw(place, "it is cut off")
            opcode, length = _RECORD.unpack(head)
            try:
                self._take(opcode, place, length)
            except (ValueError, struct.error) as error:
                raise Flaw(place, "a record is damaged") from error
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                return
            place += _RECORD.size + length

    def _take(self, opcode: int, place: int, length: int) -> None:
        """Take a record of the data."""
        end = place + _RECORD.size + length
        if opcode not in _OPCODES:
            raise ValueError("unknown")
        if opcode == Opcode.CHUNK:
            self._chunks.append(self._chunk(place, length))
        if end > self.size:
            raise Flaw(place, "it is cut off")
        if opcode == Opcode.MESSAGE:
            self._take_loose(place, end - place)
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            self._learn(opcode, self._body(place, length))
        elif opcode == Opcode.MESSAGE_INDEX and self._chunks:
            channel, entries = struct.unpack("<HI", self._body(place, 6))
            known = self._chunks[-1].channels or frozenset()
            self._chunks[-1] = self._chunks[-1]._replace(channels=known | {channel})
            self._counts[channel] += entries // 16
        elif opcode == Opcode.DATA_END:
            (crc,) = struct.unpack("<I", self._body(place, 4))
            self._checksum = (crc, place) if crc else None
            self._take_summary(end)
        elif opcode == Opcode.FOOTER:
            self._take_summary(place)

    def _take_loose(self, place: int, size: int) -> None:
        """Take a message outside of chunks: those that follow each other are read as a chunk."""
        channel, _, log_time, _ = _LOOSE_HEAD.unpack(self._body(place, _LOOSE_HEAD.size))
        last = self._chunks[-1] if self._chunks else None
        if last is None or last.whole or last.begin + last.size != place or last.size > _GROUP:
            last = Chunk(place, log_time, place, 0, 0, whole=False, channels=frozenset())
            self._chunks.append(last)
        channels = (last.channels or frozenset()) | {channel}
        start, size = min(last.start, log_time), last.size + size
        self._chunks[-1] = last._replace(start=start, length=size, size=size, channels=channels)
        self._counts[channel] += 1

    def _chunk(self, place: int, length: int) -> Chunk:
        head = self._body(place, min(length, _CHUNK_HEAD.size + 255 + 8))
        start, _, size, crc, name = _CHUNK_HEAD.unpack_from(head)
        at = _CHUNK_HEAD.size + name
        (compressed,) = struct.unpack_from("<Q", head, at)
        if at + 8 + compressed != length:
            raise ValueError("the lengths contradict each other")
        begin = place + _RECORD.size + at + 8
        there = max(0, min(compressed, self.size - begin))
        compression = head[_CHUNK_HEAD.size : at].decode()
        return Chunk(place, start, begin, there, size, there == compressed, compression, crc)

    def _body(self, place: int, length: int) -> bytes:
        """The beginning of a record, or all of it."""
        if length > _LONGEST:
            raise ValueError("too long")
        self._file.seek(place + _RECORD.size)
        return self._file.read(length)

    def _take_summary(self, begin: int) -> None:
        """Take what follows the data: the schemas and channels once more, and how many messages there are; Flaw where
        it is damaged, and nothing of it was taken.
        """
        self._file.seek(begin)
        data = self._file.read(min(LARGEST, self.size - begin))
        try:
            records = list(StreamReader(BytesIO(data), skip_magic=True, record_size_limit=_LONGEST).records)
            footer = records[-1]
            assert isinstance(footer, Footer)
            first = footer.summary_start - begin if footer.summary_start else 0
            if footer.summary_crc and zlib.crc32(data[first : -len(MAGIC) - 4]) != footer.summary_crc:
                raise ValueError("the checksum is wrong")
            for record in records:
                if isinstance(record, Schema | Channel):
                    self._know(record)
                elif isinstance(record, Statistics):
                    self._counts = dict(record.channel_message_counts)
        except (McapError, ValueError, struct.error) as error:
            what = "the index behind its messages is damaged; nothing tells whether any are missing"
            raise Flaw(begin, what) from error

    def _learn(self, opcode: int, body: bytes) -> None:
        """Take the bytes of a schema or a channel."""
        kind = Schema if opcode == Opcode.SCHEMA else Channel
        try:
            self._know(kind.read(ReadDataStream(BytesIO(body))))
        except McapError as error:
            raise ValueError("too short") from error

    def _know(self, record: Schema | Channel) -> None:
        if isinstance(record, Schema):
            self._schemas.setdefault(record.id, record)
            return
        schema = self._schemas.get(record.schema_id) or Schema(0, b"", "", "")
        encoding = record.message_encoding
        name = ros2_name(schema.name) if encoding == "ros1" else schema.name
        channel = BagChannel(record.id, record.topic, name, encoding, schema.encoding, schema.data.decode())
        self._channels.setdefault(record.id, channel)

    def _learn_from(self, chunk: Chunk, data: bytes) -> Chunk:
        place = 0
        while place < len(data):
            opcode, length = _RECORD.unpack_from(data, place)
            begin, place = place + _RECORD.size, place + _RECORD.size + length
            if opcode in (Opcode.SCHEMA, Opcode.CHANNEL) and place <= len(data):
                self._learn(opcode, data[begin:place])
        return chunk

    def _data_are_right(self, checksum: int, end: int) -> bool:
        self._file.seek(0)
        crc = 0
        for place in range(0, end, _GROUP):
            crc = zlib.crc32(self._file.read(min(_GROUP, end - place)), crc)
        return crc == checksum

    @staticmethod
    def _messages(chunk: Chunk, data: bytes, wanted: Collection[int]) -> list[RawMessage]:
        head, size = _MESSAGE_HEAD, len(data)
        found = []
        place = 0
        while place + head.size <= size:
            opcode, length, channel, _, log_time, _ = head.unpack_from(data, place)
            end = place + _RECORD.size + length
            if opcode == _MESSAGE and channel in wanted and place + head.size <= end <= size:
                found.append(RawMessage(log_time, chunk.place, channel, data[place + head.size : end]))
            place = end
        if chunk.whole and place != size:
            raise ValueError("a chunk ends within a record")
        return found
