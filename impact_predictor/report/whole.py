"""Files that have their name only when they are whole."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import InputError


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Where to write a file: `X.partial`, which becomes X at the end, in the place of an older one.

    After an exception it is gone, and an older file stays as it was.

    Raises:
        InputError: the file cannot be written.
    """
    partial = Path(f"{path}.partial")
    try:
        try:
            yield partial
            partial.replace(path)
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            partial.unlink()
