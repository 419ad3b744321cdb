"""The files of one recording, in order, opened by their format."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path, PurePath
from typing import Any, Final, NamedTuple

from ..errors import InputError
from .chunks import Flaw
from .compression import decompress_file
from .find import COMPRESSED, KINDS, METADATA, STORAGES, parts_of, storage_of
from .mcap_file import McapFile
from .ros1_file import Ros1File
from .sqlite_file import SqliteFile

BagFile = McapFile | Ros1File | SqliteFile
Topic = tuple[str, str]
"""A topic and the type of its messages."""

_FORMATS: Final[dict[str, Callable[[Path], BagFile]]] = {".mcap": McapFile, ".db3": SqliteFile, ".bag": Ros1File}


class Part(NamedTuple):
    """An open file of a recording; `flaw` is what is known to be wrong with it as a file."""

    path: Path
    file: BagFile
    flaw: Flaw | None


class Recording(NamedTuple):
    """The open files of a bag in order.

    `counts` has the number of messages of each topic where the metadata tell it, and `flaw` says what is wrong with
    the folder, or "".
    """

    parts: list[Part]
    counts: dict[Topic, int]
    flaw: str


def opened(path: Path, stack: ExitStack) -> Recording:
    """Open a bag; the stack closes it.

    Raises:
        InputError: it is not there, is no bag, or cannot be read.
    """
    files, counts, flaw = _files(path)
    try:
        return Recording([_opened(file, stack) for file in files], counts, flaw)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error


def _files(path: Path) -> tuple[list[Path], dict[Topic, int], str]:
    """The files of a bag, how many messages they have, and what is wrong with their folder."""
    if not path.exists():
        raise InputError(f"{path} does not exist; give {KINDS}")
    if not path.is_dir():
        if not storage_of(path):
            raise InputError(f"{path} is not a bag; give {KINDS}")
        return [path], {}, ""
    flaw = ""
    if (path / METADATA).exists():
        try:
            names, counts = _metadata(path / METADATA)
        except ValueError as error:
            flaw = f"its {METADATA} is damaged ({error})"
        else:
            # Only names: a bag does not decide which folder is read.
            files = [path / PurePath(name).name for name in names]
            missing = [number for number, file in enumerate(files) if not file.is_file()]
            if missing:
                flaw = f"its file {files[missing[0]].name} is missing"
                files = files[: missing[0]]
            return files, counts, flaw
    files = parts_of(path)
    if files:
        return files, {}, flaw
    several = [file for file in path.iterdir() if storage_of(file) in STORAGES]
    if several:
        raise InputError(
            f"{path} has {len(several)} recordings but no {METADATA} that orders them; "
            "make it with `ros2 bag reindex`, or give one of the files"
        )
    raise InputError(f"{path} is not a bag: it has neither {METADATA} nor a recording; give {KINDS}")


def _metadata(path: Path) -> tuple[list[str], dict[Topic, int]]:
    """The names of the files, and how many messages each topic has.

    Raises:
        ValueError: they do not say so.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        told: Any = YAML(typ="safe").load(path.read_text())["rosbag2_bagfile_information"]
        names = list(told["relative_file_paths"])
        if not all(isinstance(name, str) for name in names):
            raise ValueError("a file without a name")
        counts: dict[Topic, int] = {}
        for one in told["topics_with_message_count"]:
            about, count = one["topic_metadata"], one["message_count"]
            if not (isinstance(about["name"], str) and isinstance(about["type"], str) and isinstance(count, int)):
                raise ValueError("a topic without a name, a type or a count")
            counts[about["name"], about["type"]] = count
    except KeyError as error:
        raise ValueError(f"no {error.args[0]}") from error
    except (OSError, UnicodeDecodeError, YAMLError, TypeError, AttributeError) as error:
        raise ValueError("it is not what a recorder writes") from error
    if not all(storage_of(Path(name)) in STORAGES for name in names):
        raise ValueError("it names a file that is no recording")
    return names, counts


def _opened(path: Path, stack: ExitStack) -> Part:
    """Open a file, decompressed as a whole where it is compressed as a whole."""
    storage, flaw = path, None
    if path.name.endswith(COMPRESSED):
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="impact_predictor_")))
        storage = folder / f"bag{storage_of(path)}"
        if not decompress_file(path, storage):
            flaw = Flaw(storage.stat().st_size, "its compressed bytes are damaged or cut off")
    file = _FORMATS[storage_of(path)](storage)
    stack.callback(file.close)
    return Part(path, file, flaw)
