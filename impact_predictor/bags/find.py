"""Where bags are: a file, a folder of one recording, a folder of many, or a pattern of names."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from glob import glob, has_magic
from pathlib import Path
from typing import Final

from ..errors import InputError

STORAGES: Final = (".mcap", ".db3")
"""Suffixes of the files in a rosbag2 folder, each also with `COMPRESSED` behind it."""

COMPRESSED: Final = ".zstd"
ACTIVE: Final = ".active"
"""Follows the name of a ROS 1 bag until its recorder closes it."""

METADATA: Final = "metadata.yaml"
KINDS: Final = "an .mcap, .db3 or ROS 1 .bag file, or a rosbag2 folder"

_UNFINISHED: Final = ".partial"
"""Ending of the folders in which outputs are being written."""


def storage_of(path: Path) -> str:
    """The suffix that tells the format of a file, without that of its compression; "" where it is no bag."""
    suffix = Path(path.name.removesuffix(COMPRESSED)).suffix
    if suffix in STORAGES:
        return suffix
    return ".bag" if path.name.removesuffix(ACTIVE).endswith(".bag") else ""


def bags_of(arguments: Sequence[str]) -> list[str]:
    """The bags that some arguments stand for.

    A folder that is not itself a bag stands for all bags in it and below it, and a pattern like `runs/**/*.mcap` for
    all bags that it matches, in natural order (run_2 before run_10), each of them once. Any other argument is kept as
    it is.

    Raises:
        InputError: a name is empty, there is no bag in a folder, or none that a pattern matches, or a folder cannot be
            read.
    """
    try:
        return _bags_of(arguments)
    except OSError as error:
        raise InputError(f"{error.filename} cannot be read: {error.strerror}") from error


def _bags_of(arguments: Sequence[str]) -> list[str]:
    bags: list[str] = []
    for argument in arguments:
        if not argument:
            raise InputError(f"the name of a bag is empty; give {KINDS}")
        if Path(argument).is_dir() and not _is_bag(Path(argument)):
            found = list(_below(Path(argument)))
            flaw = f"{argument} holds no bag, and no folder below it does; give {KINDS}"
        elif has_magic(argument) and not os.path.lexists(argument):
            found = list(_matching(argument))
            flaw = f"no bag matches {argument}; give {KINDS}, or a pattern that matches some"
        else:
            bags.append(argument)
            continue
        if not found:
            raise InputError(flaw)
        known = set(bags)
        bags += [bag for bag in dict.fromkeys(map(str, found)) if bag not in known]
    return bags


def parts_of(folder: Path) -> list[Path]:
    """The files of the one recording in a folder without metadata, in order; empty where it is not one recording.

    That is the only recording in it, or the parts x/x_0, x/x_1 ... into which the recorder splits x: it writes the
    metadata last, so they are missing after a crash.
    """
    files = natural([file for file in folder.iterdir() if storage_of(file) in STORAGES and file.is_file()])
    if len(files) < 2:
        return files
    parts = [f"{folder.resolve().name}_{number}{storage_of(files[0])}" for number in range(len(files))]
    return files if [file.name.removesuffix(COMPRESSED) for file in files] == parts else []


def natural(paths: Iterable[Path]) -> list[Path]:
    """Paths in the order in which a person would list them."""

    def key(path: Path) -> tuple[list[list[tuple[int, str]]], str]:
        split = [re.split(r"(\d+)", part) for part in path.parts]
        # At odd places there are always digits, so that like is compared with like.
        return [
            [(int(text), "") if k % 2 else (0, text) for k, text in enumerate(pieces)] for pieces in split
        ], os.fspath(path)

    return sorted(paths, key=key)


def _is_bag(folder: Path) -> bool:
    return (folder / METADATA).exists() or len(parts_of(folder)) > 1


def _below(folder: Path) -> Iterator[Path]:
    """The bags in a folder and below it."""
    for child in natural(folder.iterdir()):
        if child.name.startswith(".") or child.name.endswith(_UNFINISHED):
            continue
        if child.is_dir() and not child.is_symlink():
            yield from [child] if _is_bag(child) else _below(child)
        elif child.is_file() and storage_of(child):
            yield child


def _matching(pattern: str) -> Iterator[Path]:
    """The bags that a pattern matches, and those below the folders that it matches."""
    found = map(Path, glob(pattern, recursive=True))  # noqa: PTH207 (a pattern may be absolute)
    matched = natural(path for path in found if not any(part.endswith(_UNFINISHED) for part in path.parts))
    bags = {path for path in matched if path.is_dir() and _is_bag(path)}
    for path in matched:
        if path in bags:
            yield path
        elif path.is_dir():
            yield from _below(path)
        elif storage_of(path) and path.parent not in bags:
            yield path
