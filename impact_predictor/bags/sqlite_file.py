"""Reading SQLite files of rosbag2, as far as they go.

The database reads them itself. Where it finds them damaged or cut off, it loses what the tree that leads to the
messages does not reach any more (of a file cut in the middle often all of them), though the leaves of the tree are
there: then the messages are taken from the pages of the file. Source: https://www.sqlite.org/fileformat.html, sections
1.3, 1.6 and 2.1.
"""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Collection, Iterator
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

from .chunks import LARGEST, BagChannel, Flaw, RawMessage

_DAMAGED: Final = "SQLite finds it damaged"
_LEAF: Final = 0x0D
_INTEGERS: Final = {1: 1, 2: 2, 3: 3, 4: 4, 5: 6, 6: 8, 8: 0, 9: 0}
"""Bytes of the integers of each serial type; the last two are 0 and 1 themselves."""


class SqliteFile:
    """A file of one database; `flaw` is the damage that is known before messages are read."""

    def __init__(self, path: Path) -> None:
        """Find the topics of a file; OSError where it cannot be read."""
        self.path, self._storage = path, path
        self.size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(100)
        page, reserved, changes, pages, counted = struct.unpack(">16xHxxB3xII60xI4x", head.ljust(100, b"\0"))
        self._page: int = 65536 if page == 1 else page
        self._usable: int = self._page - reserved
        self.flaw: Flaw | None = None
        self.channels: list[BagChannel] = []
        # The database itself would fill up a page that was cut off with zeros. Only a version that counts the pages
        # says how many there are.
        self._cut = len(head) < 100 or self.size % max(self._page, 1) > 0
        self._cut |= changes == counted and pages * self._page > self.size
        if self._cut:
            self.flaw = Flaw(self.size, "it is cut off")
        elif path.with_name(f"{path.name}-wal").exists() and path.with_name(f"{path.name}-wal").stat().st_size:
            what = f"its recorder left messages in {path.name}-wal; bring them in with sqlite3 {path.name} .tables"
            self.flaw = Flaw(self.size, what)
        # Nothing is ever written, not even the lock of a reader.
        self._database = sqlite3.connect(f"{path.absolute().as_uri()}?immutable=1", uri=True)
        try:
            # Lets a file be opened that is shorter than it says.
            self._database.execute("PRAGMA writable_schema = ON")
            self.channels = self._read_channels()
        except (sqlite3.Error, TypeError, ValueError) as error:
            self.flaw = self.flaw or Flaw(0, f"{_DAMAGED}: {error}")

    def close(self) -> None:
        self._database.close()

    def messages(self, wanted: Collection[int]) -> Iterator[RawMessage]:
        """The messages of some topics in the order of their log times; Flaw where the file is damaged, after all
        messages before that.
        """
        last = None
        flaw = self.flaw
        try:
            if self._cut:
                raise sqlite3.DatabaseError
            rows = f"topic_id IN ({', '.join('?' for _ in wanted)}) ORDER BY timestamp, id"
            # SQLite holds several copies of what it reads.
            bounded = f"CASE WHEN length(data) <= {LARGEST} THEN data ELSE length(data) END"
            select = f"SELECT timestamp, id, topic_id, {bounded} FROM messages WHERE {rows}"
            for log_time, row, topic, data in self._database.execute(select, tuple(wanted)):
                if isinstance(data, int) and data > LARGEST:
                    raise Flaw(0, f"a message has {data:,} bytes, more than the {LARGEST:,} that any may have")
                if not (isinstance(log_time, int) and isinstance(data, bytes)):
                    raise sqlite3.DatabaseError("a message has no time or no bytes")
                yield RawMessage(log_time, 0, topic, data)
                last = log_time, row
        except sqlite3.Error as error:
            flaw = flaw or Flaw(0, f"{_DAMAGED}: {error}")
            with self._storage.open("rb") as file:
                for row in self._whole_rows(file):
                    if row.topic in wanted and (last is None or (row.log_time, row.id) > last):
                        data = self._data(file, row)
                        if data is None:
                            break
                        yield RawMessage(row.log_time, 0, row.topic, data)
        if flaw is not None:
            raise flaw

    def _read_channels(self) -> list[BagChannel]:
        database = self._database
        # What is computed when it is read would let a file decide what is done, and for how long.
        computed = "SELECT 1 FROM sqlite_master WHERE type IN ('table', 'view') AND rootpage = 0"
        hidden = "SELECT 1 FROM pragma_table_xinfo('messages') WHERE hidden"
        if database.execute(f"{computed} UNION {hidden}").fetchone():
            raise sqlite3.DatabaseError("it has a view or a computed table or column, as no recorder makes them")
        definitions = {}
        if database.execute("SELECT 1 FROM sqlite_master WHERE name = 'message_definitions'").fetchone():
            columns = "topic_type, encoding, encoded_message_definition"
            for name, schema, definition in database.execute(f"SELECT {columns} FROM message_definitions"):
                definitions[name] = (str(schema), str(definition))
        topics = database.execute("SELECT id, name, type, serialization_format FROM topics ORDER BY id")
        return [
            BagChannel(int(id_), str(topic), str(type_name), str(encoding), *definitions.get(type_name, ("", "")))
            for id_, topic, type_name, encoding in topics
        ]

    def _whole_rows(self, file: BinaryIO) -> list[_MessageRow]:
        """The messages by their log times, as their pages have them: all up to the first that is missing."""
        topics = {channel.id for channel in self.channels}
        rows = {row.id: row for row in self._rows(file) if row.topic in topics}
        # The recorder numbers them from 1 on.
        number = 1
        while number in rows:
            number += 1
        return sorted(row for id_, row in rows.items() if id_ < number)

    def _rows(self, file: BinaryIO) -> Iterator[_MessageRow]:
        """The messages whose cells are in any page, as far as it is there."""
        if self._page < 512 or self._usable < 480:
            return
        # The first page is that of the schema.
        place = self._page
        file.seek(place)
        while len(page := file.read(self._page)) >= 8:
            if page[0] == _LEAF:
                (count,) = struct.unpack_from(">H", page, 3)
                for at in range(8, min(8 + 2 * count, len(page) - 1), 2):
                    with suppress(LookupError, ValueError):
                        yield self._row(page, struct.unpack_from(">H", page, at)[0], place)
            place += self._page

    def _row(self, page: bytes, at: int, place: int) -> _MessageRow:
        """The message of a cell; raises LookupError or ValueError where it is none, or not all there."""
        size, at = _varint(page, at)
        id_, begin = _varint(page, at)
        columns, at = _varint(page, begin)
        types = []
        while at < begin + columns:
            kind, at = _varint(page, at)
            types.append(kind)
        null, topic_kind, time_kind, data_kind = types
        topic, at = _integer(page, at, topic_kind)
        log_time, at = _integer(page, at, time_kind)
        if null or data_kind < 12 or data_kind % 2 or at - begin + (data_kind - 12) // 2 != size:
            raise ValueError("no message")
        local, least = size, (self._usable - 12) * 32 // 255 - 23
        if size > self._usable - 35:
            fitting = least + (size - least) % (self._usable - 4)
            local = fitting if fitting <= self._usable - 35 else least
        if begin + local > len(page):
            raise ValueError("cut off")
        return _MessageRow(
            log_time=log_time, id=id_, topic=topic, place=place + begin, head=at - begin, local=local, size=size
        )

    def _data(self, file: BinaryIO, row: _MessageRow) -> bytes | None:
        """The data of a message, or None where they are not all there."""
        if row.size > LARGEST:
            return None
        file.seek(row.place)
        record = bytearray(file.read(row.local))
        following = file.read(4)
        while len(record) < row.size:
            page = int.from_bytes(following, "big")
            file.seek(max(0, page - 1) * self._page)
            following = file.read(4)
            more = file.read(min(self._usable - 4, row.size - len(record)))
            if page < 2 or not more:
                return None
            record += more
        return bytes(record[row.head :])


class _MessageRow(NamedTuple):
    """A message: where its record begins, how long its head is, and how much of its `size` lies in its own page."""

    log_time: int
    id: int
    topic: int
    place: int
    head: int
    local: int
    size: int


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """A number of one to eight bytes, and where it ends. No message has one of nine: negative, or 2^56 or more."""
    number = 0
    for _ in range(8):
        byte = data[at]
        at += 1
        number = number << 7 | byte & 0x7F
        if byte < 0x80:
            return number, at
    raise ValueError("no message")


def _integer(data: bytes, at: int, kind: int) -> tuple[int, int]:
    """A value of a serial type, and where it ends."""
    end = at + _INTEGERS[kind]
    if end > len(data):
        raise IndexError
    return (kind - 8 if kind >= 8 else int.from_bytes(data[at:end], "big", signed=True)), end
