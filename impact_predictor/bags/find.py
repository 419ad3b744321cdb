"""Where bags are, as a file, a folder of one recording, of many, or a pattern of names, and what they are called."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from glob import glob, has_magic
from pathlib import Path, PurePath
from typing import Any, Final

from ..errors import InputError
from ..files import text_of

STORAGES: Final = (".mcap", ".db3")
"""Suffixes of the files in a rosbag2 folder, each also with `COMPRESSED` behind it."""

COMPRESSED: Final = ".zstd"
ACTIVE: Final = ".active"
"""Follows the name of a ROS 1 bag until its recorder closes it."""

METADATA: Final = "metadata.yaml"
_LARGEST_METADATA: Final = 1 << 22
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
    it is. InputError where a name is empty, there is no bag in a folder, or none that a pattern matches, or a folder
    cannot be read.
    """
    bags: list[str] = []
    for argument in arguments:
        if not argument:
            raise InputError(f"the name of a bag is empty; give {KINDS}")
        try:
            if Path(argument).is_dir() and not _is_bag(Path(argument)):
                found = list(_bags_among(Path(argument).iterdir()))
                flaw = f"{argument} holds no bag, and no folder below it does; give {KINDS}"
            elif has_magic(argument) and not os.path.lexists(argument):
                matched = map(Path, glob(argument, recursive=True))  # noqa: PTH207 (a pattern may be absolute)
                whole = [path for path in matched if not any(part.endswith(_UNFINISHED) for part in path.parts)]
                found = list(_bags_among(whole))
                flaw = f"no bag matches {argument}; give {KINDS}, or a pattern that matches some"
            else:
                bags.append(argument)
                continue
        except OSError as error:
            raise InputError(f"{error.filename} cannot be read: {error.strerror}") from error
        if not found:
            raise InputError(flaw)
        known = set(bags)
        bags += [bag for bag in dict.fromkeys(map(str, found)) if bag not in known]
    return bags


def _bags_among(paths: Iterable[Path]) -> Iterator[Path]:
    """The bags among some paths, and those below the folders among them."""
    ordered = [path for path in natural(paths) if not (path.name.startswith(".") or path.name.endswith(_UNFINISHED))]
    bags = {path for path in ordered if path.is_dir() and _is_bag(path)}
    for path in ordered:
        if path in bags:
            yield path
        elif path.is_dir():
            # Not through a link, which may lead back.
            yield from () if path.is_symlink() else _bags_among(path.iterdir())
        elif storage_of(path) and path.parent not in bags:
            yield path


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


def files_of(path: Path) -> tuple[list[Path], dict[tuple[str, str], int], str]:
    """The files of a bag in order, how many messages each topic and type has, and what is wrong with their folder.

    The numbers are empty where no metadata tell them, and what is wrong is "" where nothing is. InputError where it is
    not there, or is no bag.
    """
    if not path.exists():
        raise InputError(f"{path} does not exist; give {KINDS}")
    if not path.is_dir():
        if not storage_of(path):
            raise InputError(f"{path} is not a bag; give {KINDS}")
        if not path.is_file():
            raise InputError(f"{path} is not a bag, but a pipe or a device; give {KINDS}")
        return [path], {}, ""
    flaw = ""
    if (path / METADATA).exists():
        try:
            names, counts = _metadata(path / METADATA)
        except ValueError:
            flaw = f"its {METADATA} is damaged"
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
    several = sum(storage_of(file) in STORAGES for file in path.iterdir())
    if several:
        raise InputError(
            f"{path} has {several} recordings but no {METADATA} that orders them; "
            "make it with `ros2 bag reindex`, or give one of the files"
        )
    raise InputError(f"{path} is not a bag: it has neither {METADATA} nor a recording; give {KINDS}")


def _metadata(path: Path) -> tuple[list[str], dict[tuple[str, str], int]]:
    """The names of the files, and how many messages each topic has; raises ValueError where they do not say so."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        about: Any = YAML(typ="safe").load(text_of(path, _LARGEST_METADATA))["rosbag2_bagfile_information"]
        names = list(about["relative_file_paths"])
        topics = [(one["topic_metadata"], one["message_count"]) for one in about["topics_with_message_count"]]
        counts = {(topic["name"], topic["type"]): count for topic, count in topics}
    except (OSError, YAMLError, LookupError, TypeError, AttributeError) as error:
        raise ValueError from error
    words = [*names, *[word for topic in counts for word in topic]]
    if not all(isinstance(word, str) for word in words) or not all(isinstance(one, int) for one in counts.values()):
        raise ValueError
    if not all(storage_of(Path(name)) in STORAGES for name in names):
        raise ValueError
    return names, counts


def natural(paths: Iterable[Path]) -> list[Path]:
    """Paths in the order in which a person would list them."""

    def key(path: Path) -> list[str | int]:
        # At odd places there are always digits, so that like is compared with like.
        pieces = re.split(r"(\d+)", "\0".join(path.parts))
        return [int(text) if k % 2 else text for k, text in enumerate(pieces)]

    return sorted(sorted(paths), key=key)


def _is_bag(folder: Path) -> bool:
    return (folder / METADATA).exists() or len(parts_of(folder)) > 1


def name_of(bag: str | os.PathLike[str]) -> str:
    """What a bag is called without its folder and suffix."""
    path = Path(bag).resolve()
    return path.name.removesuffix(COMPRESSED).removesuffix(storage_of(path)) if storage_of(path) else path.name


def names_of(bags: Sequence[str | os.PathLike[str]]) -> list[Path]:
    """What each of several bags is called, in their order.

    That is `run`, or where there are several of this name `monday/run` and `tuesday/run`. Two bags of one folder that
    differ by their suffixes alone keep these. InputError where a bag is there twice.
    """
    paths = [Path(bag).resolve() for bag in bags]
    plain = [path.parent / name_of(path) for path in paths]
    counts = Counter(plain)
    full = [path if counts[short] > 1 else short for path, short in zip(paths, plain, strict=True)]
    twice = [path for path, count in Counter(full).items() if count > 1]
    if twice:
        raise InputError(f"the predictions of {twice[0]} would be written for two bags; give each bag once")
    return told_apart(full)


def told_apart(paths: Sequence[Path]) -> list[Path]:
    """The last part of each path, and as many before it as tell it from the others; never the root.

    What is given twice cannot be told apart, and stays alike.
    """
    parts = [path.relative_to(path.anchor).parts for path in paths]
    depths = [1] * len(parts)
    while True:
        tails = [part[-depth:] for part, depth in zip(parts, depths, strict=True)]
        counted = Counter(tails)
        short = [k for k, tail in enumerate(tails) if counted[tail] > 1 and depths[k] < len(parts[k])]
        if not short:
            return [Path(*tail) for tail in tails]
        for k in short:
            depths[k] += 1
