"""Reading ROS 1 bags (version 2.0), as far as they go.

Source: the specification of the format, http://wiki.ros.org/Bags/Format/2.0.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Collection, Iterator
from typing import Final

from .chunks import UNKNOWN, BagChannel, Chunk, ChunkedFile, Flaw, RawMessage, ros2_name

MAGIC: Final = b"#ROSBAG V2.0\n"

_MESSAGE, _BAG, _INDEX, _CHUNK, _CHUNK_INFO, _CONNECTION = 2, 3, 4, 5, 6, 7
_OPERATIONS: Final = range(_MESSAGE, _CONNECTION + 1)
_LONGEST: Final = 1 << 24
"""More bytes than any header has."""

_INDEX_ENTRY: Final = struct.Struct("<IIi")

Fields = dict[bytes, bytes]


class Ros1File(ChunkedFile):
    """A bag of ROS 1; its channels are called connections there."""

    def _scan(self) -> None:
        if self._file.read(len(MAGIC)) != MAGIC:
            raise Flaw(0, "it does not begin as a bag of version 2.0 does")
        place = len(MAGIC)
        chunks, connections, listed = UNKNOWN, 0, 0
        while place < self.size:
            try:
                fields, begin, length = self._head(place)
                operation = fields[b"op"][0]
                if operation not in _OPERATIONS or (chunks == UNKNOWN) != (operation == _BAG):
                    raise ValueError("not expected here")
                if operation == _BAG:
                    chunks, connections = _number(fields[b"chunk_count"]), _number(fields[b"conn_count"])
                    if fields.get(b"encryptor"):
                        raise Flaw(place, "it is encrypted")
                elif operation == _CHUNK:
                    self._chunks.append(self._chunk(fields, place, begin, length))
                if begin + length > self.size:
                    raise Flaw(place, "it is cut off")
                if operation == _INDEX:
                    self._take_index(fields, self._body(begin, length))
                elif operation == _CONNECTION:
                    self._learn(fields, self._body(begin, length))
                listed += operation == _CHUNK_INFO
            except (ValueError, KeyError, IndexError, struct.error) as error:
                raise Flaw(place, "a record is damaged") from error
            place = begin + length
        if not listed and self._chunks:
            raise Flaw(self.size, "its recorder did not close it")
        if chunks != len(self._chunks) or chunks != listed or connections > len(self._channels):
            raise Flaw(self.size, "it is cut off")

    def _head(self, place: int) -> tuple[Fields, int, int]:
        """The header of a record, and where its data begin and how long they are."""
        self._file.seek(place)
        first = self._file.read(4)
        (length,) = struct.unpack("<I", first) if len(first) == 4 else (0,)
        if length > self.size - place - 8:
            raise Flaw(place, "it is cut off")
        if not 0 < length <= _LONGEST:
            raise ValueError("no header is so long")
        header = self._file.read(length)
        (data,) = struct.unpack("<I", self._file.read(4))
        return _fields(header), place + 8 + length, data

    def _body(self, begin: int, length: int) -> bytes:
        self._file.seek(begin)
        return self._file.read(length)

    def _chunk(self, fields: Fields, place: int, begin: int, length: int) -> Chunk:
        there = max(0, min(length, self.size - begin))
        compression = fields[b"compression"].decode()
        return Chunk(place, 0, begin, there, _number(fields[b"size"]), there == length, compression)

    def _take_index(self, fields: Fields, data: bytes) -> None:
        """Take where the messages of one connection are in the last chunk."""
        channel, count = _number(fields[b"conn"]), _number(fields[b"count"])
        times = [seconds * 1_000_000_000 + rest for seconds, rest, _ in _INDEX_ENTRY.iter_unpack(data)]
        if len(times) != count or not times:
            raise ValueError("an index has another number of entries than it says")
        chunk = self._chunks[-1]
        start = min(times) if chunk.channels is None else min(chunk.start, *times)
        self._chunks[-1] = chunk._replace(start=start, channels=(chunk.channels or frozenset()) | {channel})
        self._counts[channel] += count

    def _learn(self, fields: Fields, data: bytes) -> None:
        """Take a connection."""
        about = _fields(data)
        id_ = _number(fields[b"conn"])
        # As ROS 2 writes them.
        topic = re.sub("/+", "/", fields[b"topic"].decode())
        type_name = ros2_name(about[b"type"].decode())
        definition = about[b"message_definition"].decode(errors="replace")
        self._channels.setdefault(id_, BagChannel(id_, topic, type_name, "ros1", "ros1msg", definition))

    def _learn_from(self, chunk: Chunk, data: bytes) -> Chunk:
        times = []
        for fields, body in _records(chunk, data):
            if fields[b"op"][0] == _CONNECTION:
                self._learn(fields, body)
            elif fields[b"op"][0] == _MESSAGE:
                times.append(_time(fields[b"time"]))
        return chunk._replace(start=min(times, default=0), channels=None)

    @staticmethod
    def _messages(chunk: Chunk, data: bytes, wanted: Collection[int]) -> list[RawMessage]:
        found = []
        for fields, body in _records(chunk, data):
            if fields[b"op"] == b"\x02":
                channel = _number(fields[b"conn"])
                if channel in wanted:
                    found.append(RawMessage(_time(fields[b"time"]), chunk.place, channel, body))
        return found


def _records(chunk: Chunk, data: bytes) -> Iterator[tuple[Fields, bytes]]:
    """The records of a chunk, each its header and data, and of a chunk that was cut off those that are whole."""
    place = 0
    while place < len(data):
        try:
            (length,) = struct.unpack_from("<I", data, place)
            begin = place + 8 + length
            (more,) = struct.unpack_from("<I", data, begin - 4)
            if begin + more > len(data):
                raise ValueError("cut off")
            fields = _fields(data[place + 4 : begin - 4])
        except (ValueError, struct.error):
            if chunk.whole:
                raise
            return
        yield fields, data[begin : begin + more]
        place = begin + more


def _fields(header: bytes) -> Fields:
    fields = {}
    place = 0
    while place < len(header):
        (length,) = struct.unpack_from("<I", header, place)
        name, equals, value = header[place + 4 : place + 4 + length].partition(b"=")
        if not equals or place + 4 + length > len(header):
            raise ValueError("not a field")
        fields[name] = value
        place += 4 + length
    return fields


def _number(field: bytes) -> int:
    (number,) = struct.unpack("<I", field)
    return int(number)


def _time(field: bytes) -> int:
    seconds, rest = struct.unpack("<II", field)
    return int(seconds) * 1_000_000_000 + int(rest)
