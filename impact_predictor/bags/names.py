"""What bags are called, without suffixes and with no more of their folders than tells them apart."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from ..errors import InputError
from .find import COMPRESSED, storage_of


def name_of(bag: str | os.PathLike[str]) -> str:
    """What a bag is called without its folder and suffix."""
    path = Path(bag).resolve()
    return path.name.removesuffix(COMPRESSED).removesuffix(storage_of(path)) if storage_of(path) else path.name


def names_of(bags: Sequence[str | os.PathLike[str]]) -> list[Path]:
    """What each of several bags is called, in their order.

    That is `run`, or where there are several of this name `monday/run` and `tuesday/run`. Two bags of one folder that
    differ by their suffixes alone keep these.

    Raises:
        InputError: a bag is there twice.
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
