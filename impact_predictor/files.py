"""Files that have their name only when they are whole, and texts that are read only where they are files and short."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from .errors import InputError


def text_of(path: Path, most: int = 1 << 20) -> str:
    """The text of a file of at `most` so many bytes.

    Raises:
        InputError: it is larger, or no file: a pipe may never end.
        OSError: it cannot be read.
        UnicodeDecodeError: it is not UTF-8.
    """
    about = path.stat()
    if not (S_ISREG(about.st_mode) or S_ISDIR(about.st_mode)):
        raise InputError("it is no file, but a pipe or a device; give a file")
    if about.st_size > most:
        raise InputError(f"it has {about.st_size:,} bytes, more than the {most:,} that are read; give a shorter one")
    return path.read_text(encoding="utf-8")


def named(path: str | os.PathLike[str], what: str, suffixes: Sequence[str] = ()) -> Path:
    """The path of a file that is yet to be made, checked before the work that it is for.

    Raises:
        InputError: the suffix is not one of its format, or there is no such folder.
    """
    path = Path(path)
    if suffixes and path.suffix.lower() not in suffixes:
        raise InputError(f"{path} is no {what}; give a name that ends in {' or '.join(suffixes)}")
    if not path.absolute().parent.is_dir():
        raise InputError(f"the folder of {path} does not exist; make it, or give another name")
    return path


def make_folder(folder: Path) -> None:
    """Make the folder of files that are yet to be made, unless there is one.

    Raises:
        InputError: it cannot be made or written into.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"the folder {folder} cannot be made: {error.strerror}; give another name") from error
    if not os.access(folder, os.W_OK):
        raise InputError(f"the folder {folder} cannot be written into; give another name")


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Where to write a file: `X.partial`, which becomes X at the end; after an exception an older X stays as it was.

    Raises:
        InputError: the file cannot be written.
    """
    partial = Path(f"{path}.partial")
    try:
        yield partial
        partial.replace(path)
    except BrokenPipeError:
        # A new file is no pipe: it is standard output whose reader has gone.
        raise
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}") from error
    finally:
        partial.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file that has its name when it is whole; InputError where it cannot be written."""
    with whole(path) as partial:
        partial.write_text(text, encoding="utf-8")
