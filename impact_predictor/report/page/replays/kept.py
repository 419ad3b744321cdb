"""The answers of any number of bags in a file, and parts of them that are looked at one by one: none stay in memory."""

from __future__ import annotations

import json
import marshal
import tempfile
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from os import SEEK_END
from typing import Any, overload

from ....errors import InputError

Answer = Mapping[str, Any]
"""What `as_json` says of the replay of one bag."""


class Each(Sequence[Answer]):
    """What a function gives each time that it is called."""

    def __init__(self, give: Callable[[], Iterator[Answer]]) -> None:
        self._give = give

    def __iter__(self) -> Iterator[Answer]:
        return self._give()

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __bool__(self) -> bool:
        return any(True for _ in self)

    @overload
    def __getitem__(self, place: int) -> Answer: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[Answer]: ...
    def __getitem__(self, place: int | slice) -> Answer | Sequence[Answer]:
        return list(self)[place]


class Kept(Sequence[Answer]):
    """Answers in the order in which they were added, in a temporary file without a name: it ends with the process."""

    def __init__(self) -> None:
        """Begin with none.

        Raises:
            InputError: there is no place for a file.
        """
        try:
            self._file = tempfile.TemporaryFile()  # noqa: SIM115 (it lives as long as this object)
        except OSError as error:
            raise _unwritable(error) from error
        self._ends = array("Q", [0])

    def append(self, answer: Answer) -> None:
        """Add the answer of a bag.

        Raises:
            InputError: the file cannot be written.
        """
        try:
            self._file.seek(0, SEEK_END)
            # The page passes over all answers many times, and nothing is read as fast; it takes plain values alone.
            values = json.loads(json.dumps(answer))
            self._file.write(marshal.dumps({key: marshal.dumps(value) for key, value in values.items()}))
            self._file.flush()
        except OSError as error:
            raise _unwritable(error) from error
        self._ends.append(self._file.tell())

    def __len__(self) -> int:
        return len(self._ends) - 1

    def __iter__(self) -> Iterator[Answer]:
        return map(self._load, range(len(self)))

    @overload
    def __getitem__(self, place: int) -> Answer: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[Answer]: ...
    def __getitem__(self, place: int | slice) -> Answer | Sequence[Answer]:
        if isinstance(place, slice):
            return [self._load(one) for one in range(len(self))[place]]
        return self._load(range(len(self))[place])

    def _load(self, place: int) -> Answer:
        begin, end = self._ends[place : place + 2]
        self._file.seek(begin)
        # Nobody but this object can write into the file.
        return _Loaded(marshal.loads(self._file.read(end - begin)))


class _Loaded(Mapping[str, Any]):
    """An answer of which each pass reads what it looks at: the touchdowns are most of it."""

    def __init__(self, values: dict[str, bytes]) -> None:
        self._values = values
        self._read: dict[str, Any] = {}

    def __getitem__(self, key: str) -> Any:
        if key not in self._read:
            self._read[key] = marshal.loads(self._values[key])
        return self._read[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)


def _unwritable(error: OSError) -> InputError:
    return InputError(
        f"the folder of temporary files cannot take what the page needs: {error.strerror}; give another one in TMPDIR"
    )
