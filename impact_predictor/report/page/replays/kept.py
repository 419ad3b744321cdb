"""The answers of any number of bags in a file, and parts of them that are looked at one by one: none stay in memory."""

from __future__ import annotations

import pickle
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
        self._places = array("Q")

    def append(self, answer: Answer) -> None:
        """Add the answer of a bag.

        Raises:
            InputError: the file cannot be written.
        """
        try:
            place = self._file.seek(0, SEEK_END)
            pickle.dump(answer, self._file, pickle.HIGHEST_PROTOCOL)
            self._file.flush()
        except OSError as error:
            raise _unwritable(error) from error
        self._places.append(place)

    def __len__(self) -> int:
        return len(self._places)

    def __iter__(self) -> Iterator[Answer]:
        return map(self._load, self._places)

    @overload
    def __getitem__(self, place: int) -> Answer: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[Answer]: ...
    def __getitem__(self, place: int | slice) -> Answer | Sequence[Answer]:
        if isinstance(place, slice):
            return [self._load(one) for one in self._places[place]]
        return self._load(self._places[place])

    def _load(self, place: int) -> Answer:
        self._file.seek(place)
        # Nobody but this object can write into the file.
        answer: Answer = pickle.load(self._file)
        return answer


def _unwritable(error: OSError) -> InputError:
    return InputError(
        f"the folder of temporary files cannot take what the page needs: {error.strerror}; give another one in TMPDIR"
    )
