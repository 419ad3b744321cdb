"""Reading SQLite files of rosbag2, as far as they go."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Final

from .chunks import Channel, Flaw, Message

_DAMAGED: Final = "SQLite finds it damaged"


class SqliteFile:
    """A file that the database itself reads, and where that finds it damaged, its pages one by one.

    `flaw` is the damage that is known before messages are read.
    """

    def __init__(self, path: Path) -> None:
        """Find the topics of a file.

        Raises:
            OSError: it cannot be read.
        """
        self._path = path
        with path.open("rb") as file:
            head = file.read(100)
        self.size = path.stat().st_size
        self.flaw: Flaw | None = None
        self.channels: list[Channel] = []
        page = int.from_bytes(head[16:18], "big")
        page = 65536 if page == 1 else page
        pages = int.from_bytes(head[28:32], "big") if head[24:28] == head[92:96] else 0
        # The database itself would fill up a page that was cut off with zeros.
        self._cut = len(head) < 100 or pages * page > self.size or self.size % max(page, 1) > 0
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
        """Close the file."""
        self._database.close()

    def messages(self, wanted: Collection[int]) -> Iterator[Message]:
        """The messages of some topics in the order of their log times.

        Raises:
            Flaw: the file is damaged, after all messages before that.
        """
        last = None
        flaw = self.flaw
        try:
            if self._cut:
                raise sqlite3.DatabaseError
            rows = f"topic_id IN ({', '.join('?' for _ in wanted)}) ORDER BY timestamp, id"
            select = f"SELECT timestamp, id, topic_id, data FROM messages WHERE {rows}"
            for log_time, row, topic, data in self._database.execute(select, tuple(wanted)):
                if not (isinstance(log_time, int) and isinstance(data, bytes)):
                    raise sqlite3.DatabaseError("a message has no time or no bytes")
                yield Message(log_time, 0, topic, data)
                last = log_time, row
        except sqlite3.Error as error:
            from .sqlite_pages import rows_of

            flaw = flaw or Flaw(0, f"{_DAMAGED}: {error}")
            topics = {channel.id for channel in self.channels}
            for log_time, row, topic, data in rows_of(self._path, topics, wanted):
                if last is None or (log_time, row) > last:
                    yield Message(log_time, 0, topic, data)
        if flaw is not None:
            raise flaw

    def _read_channels(self) -> list[Channel]:
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
            Channel(int(id_), str(topic), str(type_name), str(encoding), *definitions.get(type_name, ("", "")))
            for id_, topic, type_name, encoding in topics
        ]
