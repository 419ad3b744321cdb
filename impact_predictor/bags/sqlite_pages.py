"""The messages in a damaged SQLite file of rosbag2, from its pages alone.

Where the tree that leads to them is damaged or cut off, its leaves are still there. Source: the specification of the
format, https://www.sqlite.org/fileformat.html, sections 1.6 and 2.1.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

_LEAF: Final = 0x0D
_INTEGERS: Final = {1: 1, 2: 2, 3: 3, 4: 4, 5: 6, 6: 8}
"""Bytes of the integers of each serial type."""


class _Row(NamedTuple):
    """A message: where its record begins, how long it is, and how much of that lies in the page of its cell."""

    log_time: int
    id: int
    topic: int
    place: int
    size: int
    local: int
    head: int


def rows_of(path: Path, topics: Collection[int], wanted: Collection[int]) -> Iterator[tuple[int, int, int, bytes]]:
    """Log time (ns), id, topic and data of messages, by their log times: all up to the first that is missing.

    `topics` are the ids of all topics, `wanted` those of which messages are given.
    """
    with path.open("rb") as file:
        head = file.read(100)
        if len(head) < 100:
            return
        page_size = struct.unpack_from(">H", head, 16)[0]
        page_size = 65536 if page_size == 1 else page_size
        usable = page_size - head[20]
        if page_size < 512 or page_size & (page_size - 1) or usable < 480:
            return
        rows: dict[int, _Row] = {}
        # The first page is that of the schema.
        number = 1
        while True:
            file.seek(number * page_size)
            page = file.read(page_size)
            if len(page) < 8:
                break
            if page[0] == _LEAF:
                for row in _rows(page, number * page_size, usable):
                    if row.topic in topics:
                        rows[row.id] = row
            number += 1
        # The recorder numbers them from 1 on.
        whole: list[_Row] = []
        while len(whole) + 1 in rows:
            whole.append(rows[len(whole) + 1])
        for row in sorted(row for row in whole if row.topic in wanted):
            data = _record(file, row, page_size, usable)
            if data is None:
                return
            yield row.log_time, row.id, row.topic, data


def _rows(page: bytes, place: int, usable: int) -> Iterator[_Row]:
    """The messages whose cells are in a page, as far as it is there."""
    (count,) = struct.unpack_from(">H", page, 3)
    for at in range(8, min(8 + 2 * count, len(page) - 1), 2):
        try:
            begin = struct.unpack_from(">H", page, at)[0]
            size, begin = _varint(page, begin)
            id_, begin = _varint(page, begin)
            columns, at_end = _varint(page, begin)
            types = []
            while at_end < begin + columns:
                kind, at_end = _varint(page, at_end)
                types.append(kind)
            if len(types) != 4 or types[0] or types[3] < 12 or types[3] % 2:
                continue
            topic, at_value = _integer(page, at_end, types[1])
            log_time, at_value = _integer(page, at_value, types[2])
        except (IndexError, KeyError, struct.error):
            continue
        local = _local(size, usable)
        if at_value - begin + (types[3] - 12) // 2 == size and begin + local <= len(page):
            yield _Row(log_time, id_, topic, place + begin, size, local, at_value - begin)


def _local(size: int, usable: int) -> int:
    """How many bytes of a record are in the page of its cell."""
    most, least = usable - 35, (usable - 12) * 32 // 255 - 23
    if size <= most:
        return size
    fitting = least + (size - least) % (usable - 4)
    return fitting if fitting <= most else least


def _record(file: BinaryIO, row: _Row, page_size: int, usable: int) -> bytes | None:
    """The data of a message, or None where they are not all there."""
    file.seek(row.place)
    data = bytearray(file.read(row.local))
    following = file.read(4) if row.local < row.size else b""
    while len(data) < row.size:
        page = int.from_bytes(following, "big")
        if page < 2:
            return None
        file.seek((page - 1) * page_size)
        following = file.read(4)
        more = file.read(min(usable - 4, row.size - len(data)))
        if not more:
            return None
        data += more
    return bytes(data[row.head :])


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """A number of one to nine bytes, and where it ends."""
    number = 0
    for _ in range(8):
        byte = data[at]
        at += 1
        number = number << 7 | byte & 0x7F
        if byte < 0x80:
            return number, at
    return number << 8 | data[at], at + 1


def _integer(data: bytes, at: int, kind: int) -> tuple[int, int]:
    """A value of a serial type, and where it ends."""
    if kind in (8, 9):
        return kind - 8, at
    end = at + _INTEGERS[kind]
    if end > len(data):
        raise IndexError
    return int.from_bytes(data[at:end], "big", signed=True), end
