"""What every test run shares: quick tests first, law code compiled once, ROS graphs that do not see each other."""

import fcntl
import gc
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from impact_predictor.ros.processes import is_free

# The same draws on every machine, so that a change is judged by what it changes. New ones are drawn by
# `make test ARGS=--hypothesis-profile=search`.
settings.register_profile("search")
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")

LONGEST = ("test_heavy_sea.py", "test_features.py", "test_cli_calibrate.py")


def pytest_configure() -> None:
    """Before anything imports rclpy: a ROS domain for each worker of a parallel run, and messages as strings."""
    # A shell lets what it starts in the background ignore SIGINT, and so would the processes that tests start and end.
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    # Tests read strings, also where the package of typed messages is installed; those of `auto` have one of their own.
    sys.modules["impact_predictor_msgs"] = None  # type: ignore[assignment]
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    # Domains up to 101 keep clear of the ports that Linux hands to ordinary sockets; up to eight workers try others.
    domains = [1 + (os.getppid() + worker + k) % 101 for k in range(0, 96, 8)]
    os.environ["ROS_DOMAIN_ID"] = str(next(filter(is_free, domains), domains[0]))
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    # Threads that wait for each other while other workers compute take twice the time; numpy is not loaded yet.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if "PYTEST_XDIST_WORKER" in os.environ:
        compile_once()


def compile_once() -> None:
    """Let one worker compile law code while the others wait for what it keeps: on a new machine that is half a minute.

    A compilation takes minutes where each worker does the same at the same time.
    """
    try:
        from numba.core.caching import NullCache
        from numba.core.dispatcher import Dispatcher
    except ImportError:
        return
    compile_alone = Dispatcher.compile

    def compile_in_turn(self: Any, signature: Any) -> Any:
        # What has no cache is compiled as a part of what has one.
        if isinstance(self._cache, NullCache):
            return compile_alone(self, signature)
        with Path(__file__).open() as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            return compile_alone(self, signature)

    Dispatcher.compile = compile_in_turn


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    # The longest ones come first of the slow ones, so that no worker of a parallel run waits for one at the end.
    items.sort(key=lambda item: (item.get_closest_marker("slow") is not None, item.path.name not in LONGEST))


def pytest_collection_finish() -> None:
    """What was loaded to collect thousands of tests stays to the end: the collector need not look at it in each."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, in which the test runs."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def few_resamples() -> Iterator[None]:
    """Intervals of identified bodies from a fifth of the usual resamples: as wide as theirs to a tenth."""
    from impact_predictor.calibration import search

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "RESAMPLES", 200)
        yield
