"""The pytest plugin: options, and the fixture `impact_replay`.

It is loaded at every start of pytest, so what reads bags is imported only when a bag is to be read.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ..bags.replay import Result

StrPath = str | os.PathLike[str]
PLACES: Final = {
    "bag": ("BAG", "test a recorded bag, or all that fit a pattern; may be repeated"),
    "remap": ("FROM:=TO", "topic of an input in the bags, as in odom:=/cube/odom; may be repeated"),
    "params": ("FILE", "ROS 2 parameter file of the scene"),
    "baseline": ("RUN", "JSON of an earlier replay of the bags; a test fails if anything has changed"),
}
TOLERANCES: Final = {
    "error": ("0.5", "greatest relative error of a scored touchdown, as a fraction of 1"),
    "median_error": ("0.2", "greatest median of the relative errors of a run"),
    "time_error": ("0.02", "greatest error in s of the time told 20 ms ahead, of a foot's landing or against a truth"),
    "mode_accuracy": ("0.9", "least part of the clear modes that are right, where the bag has the truth"),
    "missed": ("0", "most touchdowns that may be missed, where the bag has the truth"),
    "false": ("0", "most false alarms, where the bag has the truth"),
    "touchdowns": ("1..", "how many touchdowns a run has: N, N..M, or N.. for at least N"),
}
"""Defaults of the tolerances, and what they are."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options, and for each a setting of the ini-file: `impact_bag` is that of `--impact-bag`."""
    group = parser.getgroup("impact_predictor", "recorded runs as tests (impact_predictor)")
    for name, (metavar, text) in PLACES.items():
        several = name in ("bag", "remap")
        group.addoption(f"--impact-{name}", action="append" if several else "store", metavar=metavar, help=text)
        if several:
            parser.addini(f"impact_{name}", text, type="args", default=[])
        else:
            parser.addini(f"impact_{name}", text, default="")
    for name, (default, text) in TOLERANCES.items():
        option = f"--impact-{name.replace('_', '-')}"
        group.addoption(option, metavar="LIMIT", help=f"{text} (default: {default})")
        parser.addini(f"impact_{name}", text, default=default)


def pytest_configure(config: pytest.Config) -> None:
    """Have the bags collected, if any are given."""
    if setting(config, "bag"):
        from .collection import collect_bags

        collect_bags(config)


def setting(config: pytest.Config, name: str) -> str | list[str]:
    """An option, or else the setting of the ini-file or its default."""
    given: str | list[str] | None = config.getoption(f"impact_{name}")
    return config.getini(f"impact_{name}") if given is None else given


def folder_of(config: pytest.Config, name: str) -> Path:
    """The folder from which the paths of an option are seen, or else those of a setting: that of the ini-file."""
    if config.getoption(f"impact_{name}") is not None:
        return config.invocation_params.dir
    return config.rootpath if config.inipath is None else config.inipath.parent


def path_of(config: pytest.Config, name: str) -> Path | None:
    """The path in an option or setting, if it is given."""
    found = setting(config, name)
    return folder_of(config, name) / str(found) if found else None


@pytest.fixture(scope="module")
def impact_replay(request: pytest.FixtureRequest) -> Callable[..., Result]:
    """Replay a recorded bag: impact_replay("run.mcap", "scene.yaml", remap={"odom": "/cube/odom"}).

    It returns an impact_predictor.bags.replay.Result, and raises InputError where the bag or the parameter file cannot
    be read, or is wrong; without a file it is that of `--impact-params` or `impact_params`. Paths are seen from the
    folder of the test. A bag is replayed once in a session, whoever asks for it.
    """
    from .collection import replayed

    config, folder = request.config, request.path.parent
    default = path_of(config, "params")

    def replay(bag: StrPath, params: StrPath | None = None, remap: Mapping[str, str] | None = None) -> Result:
        file = default if params is None else folder / params
        if file is None:
            raise pytest.UsageError(f"no parameter file for {bag}: give it after the bag, or with --impact-params")
        return replayed(config, folder / bag, file, remap or {})

    return replay
