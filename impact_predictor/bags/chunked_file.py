"""Files of chunks, of which only what tells of the chunks is read before messages are asked for."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import BinaryIO

from .chunks import UNKNOWN, Channel, Chunk, Flaw, Message, in_order, unpacked, wanted_of


class ChunkedFile(ABC):
    """A file that is read up to its first damage outside of chunks, which is its `flaw`."""

    def __init__(self, path: Path) -> None:
        """Find the chunks and channels of a file.

        Raises:
            OSError: it cannot be read.
        """
        self._file: BinaryIO = path.open("rb")
        self.size = os.fstat(self._file.fileno()).st_size
        self.flaw: Flaw | None = None
        self._channels: dict[int, Channel] = {}
        self._chunks: list[Chunk] = []
        self._counts: dict[int, int] = defaultdict(int)
        self._counts_are_whole = False
        try:
            self._scan()
            self._counts_are_whole = True
        except Flaw as flaw:
            self.flaw = flaw
            if self._chunks:
                # What tells of its channels may be cut off.
                self._chunks[-1] = self._chunks[-1]._replace(channels=None)
        try:
            self._look_into_chunks()
        except Flaw as flaw:
            self.flaw = flaw

    @property
    def channels(self) -> list[Channel]:
        """In the order of their ids."""
        known = self._counts_are_whole
        return [
            channel._replace(announced=self._counts.get(id_, 0) if known else UNKNOWN)
            for id_, channel in sorted(self._channels.items())
        ]

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def messages(self, wanted: Collection[int]) -> Iterator[Message]:
        """The messages of some channels in the order of their log times.

        Raises:
            Flaw: the file is damaged, after all messages before that.
        """

        def load(chunk: Chunk) -> list[Message]:
            return self._messages(chunk, unpacked(chunk, self._file), wanted)

        yield from in_order(wanted_of(self._chunks, wanted), load)
        if self.flaw is not None:
            raise self.flaw

    @abstractmethod
    def _scan(self) -> None:
        """Go from record to record, and take chunks, channels and numbers of messages.

        Raises:
            Flaw: a record is damaged or cut off.
        """

    @abstractmethod
    def _look_into_chunks(self) -> None:
        """Take what only the chunks themselves tell of their channels.

        Raises:
            Flaw: a chunk is damaged.
        """

    @staticmethod
    @abstractmethod
    def _messages(chunk: Chunk, data: bytes, wanted: Collection[int]) -> list[Message]:
        """The whole messages of some channels in the bytes of a chunk.

        Raises:
            Flaw: a record is damaged, or not whole though the chunk is.
        """
