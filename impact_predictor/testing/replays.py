"""The replays of a session of pytest."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import pytest

from ..bags.replay import Result, replay
from ..parameters.file import read_values
from ..prediction.scene import scenes_of

StrPath = str | os.PathLike[str]


class ImpactReplay(Protocol):
    """Type of the fixture `impact_replay`."""

    def __call__(self, bag: StrPath, params: StrPath | None = None, remap: Mapping[str, str] | None = None) -> Result:
        """Replay a bag; without `params`, by the parameter file of `--impact-params` or `impact_params`.

        Raises:
            InputError: the bag or the parameter file cannot be read, or is wrong.
            UsageError: there is no parameter file.
        """


class Replays:
    """Replays, each done once."""

    def __init__(self) -> None:
        self._results: dict[tuple[Path, Path, tuple[tuple[str, str], ...]], Result] = {}

    def get(self, bag: Path, params: Path, remap: Mapping[str, str]) -> Result:
        """The replay of a bag by a parameter file, with a remapping of its topics.

        Raises:
            InputError: one of them cannot be read, or is wrong.
        """
        key = bag.resolve(), params.resolve(), tuple(sorted(remap.items()))
        if key not in self._results:
            self._results[key] = replay(bag, scenes_of(read_values(params)), remap)
        return self._results[key]


_REPLAYS = pytest.StashKey[Replays]()


def replays_of(config: pytest.Config) -> Replays:
    """The replays of a session."""
    return config.stash.setdefault(_REPLAYS, Replays())
