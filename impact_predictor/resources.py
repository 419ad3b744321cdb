"""Where the files that come with the package are: recorded tosses and scenes."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from .errors import InputError

SHARE = Path("share") / "impact_predictor"


def find(name: str) -> Path:
    """The path of a shipped file or folder, for example config/cube_tosses.yaml or examples/cube_tosses.

    Raises:
        InputError: it is not there.
    """
    for place in _places():
        if (place / name).exists():
            return place / name
    raise InputError(
        f"{name} is not installed; install the package with pip or colcon, or run it in a clone of its repository"
    )


def _places() -> Iterator[Path]:
    """The source tree, then wherever pip and colcon install share/."""
    here = Path(__file__).resolve().parent
    if (here.parent / "package.xml").is_file():
        yield here.parent
    # With pip and with colcon, share/ is beside the lib/ that holds this package.
    prefixes = [*here.parents, Path(sys.prefix), Path(sys.base_prefix)]
    prefixes += [Path(prefix) for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    for prefix in prefixes:
        yield prefix / SHARE
