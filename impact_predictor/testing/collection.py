"""Bags as tests of pytest: what is collected where bags are given."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from glob import glob, has_magic
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from ..bags.find import names_of
from ..bags.replay import Result, remapping, replay
from ..errors import InputError
from ..parameters.file import read_values
from ..prediction.scene import read_scenes
from .checks import Check, baseline_check, checks_of, read_tolerances
from .plugin import TOLERANCES, folder_of, path_of, setting

if TYPE_CHECKING:
    from ..report.baseline import Earlier


_REPLAYS = pytest.StashKey[dict[tuple[Path, Path, tuple[tuple[str, str], ...]], Result]]()


def replayed(config: pytest.Config, bag: Path, params: Path, remap: Mapping[str, str]) -> Result:
    """The replay of a bag by a parameter file, with a remapping of its topics; done once in a session.

    Raises:
        InputError: one of them cannot be read, or is wrong.
    """
    done = config.stash.setdefault(_REPLAYS, {})
    key = bag.resolve(), params.resolve(), tuple(sorted(remap.items()))
    if key not in done:
        done[key] = replay(bag, read_scenes(params), remap)
    return done[key]


class CheckItem(pytest.Item):
    """A check of a run as a test."""

    def __init__(self, *, check: Check, **others: Any) -> None:
        super().__init__(**others)
        self.check = check
        # What was measured comes into the JUnit report too.
        self.user_properties.extend(check.figures.items())

    def runtest(self) -> None:
        """Pass, fail or be skipped as the check says."""
        if self.check.skipped:
            pytest.skip(self.check.skipped)
        if self.check.flaw:
            pytest.fail(self.check.flaw, pytrace=False)

    def reportinfo(self) -> tuple[Path, None, str]:
        """The bag, and what stands above a failure."""
        return self.path, None, f"{self.path.name}: {self.name}"


class _Bag(pytest.Collector):
    """A bag, whose tests are known once it is replayed."""

    def __init__(self, *, bags: BagCollection, **others: Any) -> None:
        super().__init__(**others)
        self._bags = bags

    def collect(self) -> Iterator[CheckItem]:
        """Replay the bag."""
        for check in self._bags.checks(self.path):
            yield CheckItem.from_parent(self, name=check.name, check=check)


class BagFileTests(_Bag, pytest.File):
    """A bag that is one file."""


class BagFolderTests(_Bag, pytest.Directory):
    """A bag that is a folder."""


class BagCollection:
    """The plugin that knows the bags that are tests, and what they are tested against."""

    def __init__(self, config: pytest.Config, bags: list[Path]) -> None:
        """Take the settings.

        Raises:
            InputError: one of them is wrong.
        """
        self._bags = set(bags)
        params = path_of(config, "params")
        if params is None:
            raise InputError("bags are tested by a parameter file of the scene: give --impact-params FILE")
        read_values(params)  # what is wrong there is wrong for every bag
        self._params = params
        self._earlier: Earlier | None = None
        baseline = path_of(config, "baseline")
        if baseline is not None:
            from ..report.baseline import Earlier

            self._earlier = Earlier(baseline, len(bags))
            self._names = dict(zip(bags, names_of(bags), strict=True))
        self._remap = remapping(setting(config, "remap"))
        self._tolerances = read_tolerances({name: str(setting(config, name)) for name in TOLERANCES})
        self._config = config

    def checks(self, bag: Path) -> list[Check]:
        """All checks of a bag; what is wrong with one bag keeps no other from being tested."""
        try:
            result = replayed(self._config, bag, self._params, self._remap)
        except InputError as error:
            return [Check("samples", str(error))]
        against = [] if self._earlier is None else [baseline_check(result, self._earlier, self._names[bag])]
        return [*checks_of(result, self._tolerances), *against]

    def pytest_collect_file(self, file_path: Path, parent: pytest.Collector) -> BagFileTests | None:
        """A bag, where the file is one of them."""
        return BagFileTests.from_parent(parent, path=file_path, bags=self) if file_path in self._bags else None

    @pytest.hookimpl(tryfirst=True)
    def pytest_collect_directory(self, path: Path, parent: pytest.Collector) -> BagFolderTests | None:
        """A bag, where the folder is one of them."""
        if path not in self._bags:
            return None
        # pytest itself has no id for a folder outside of the project.
        nodeid = Path(os.path.relpath(path, parent.config.rootpath)).as_posix()
        return BagFolderTests.from_parent(parent, path=path, nodeid=nodeid, bags=self)


def collect_bags(config: pytest.Config) -> None:
    """Have the bags of the options or of the ini-file collected.

    Bags that are named on the command line are what is to be tested, as paths there are; those of the ini-file come
    with all other tests, and by their paths.

    Raises:
        UsageError: a setting is wrong, or a pattern fits no bag.
    """
    try:
        bags = _bags(setting(config, "bag"), folder_of(config, "bag"))
        config.pluginmanager.register(BagCollection(config, bags), "impact_predictor.bags")
    except InputError as error:
        raise pytest.UsageError(str(error)) from error
    by_option = config.getoption("impact_bag") is not None
    paths_named = config.args_source is config.ArgsSource.ARGS
    if paths_named and not by_option:
        return
    others = config.args if paths_named or not by_option else []
    # Whoever gives the id of a test of a bag does not want all of them.
    named = {_absolute(config.invocation_params.dir / arg.partition("::")[0]) for arg in others}
    config.args = [*others, *(str(bag) for bag in bags if bag not in named)]
    if by_option:
        config.args_source = config.ArgsSource.ARGS


def _bags(patterns: Iterable[str], folder: Path) -> list[Path]:
    """The bags of paths and patterns, each once."""
    bags: list[Path] = []
    for pattern in patterns:
        found = sorted(glob(str(folder / pattern), recursive=True))  # noqa: PTH207, a Path has no absolute patterns
        if not found:
            why = "no bag fits the pattern" if has_magic(pattern) else "there is no bag"
            raise InputError(f"{why} {pattern} in {folder}; correct --impact-bag, or impact_bag in the ini-file")
        bags += map(Path, found)
    return list(dict.fromkeys(map(_absolute, bags)))


def _absolute(path: Path) -> Path:
    """A path as pytest names what it collects: without `..`, and links as they are."""
    return Path(os.path.abspath(path))  # noqa: PTH100, that follows links
