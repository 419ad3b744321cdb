"""What tests run of marked code, and how long they take: for tools/mutate.py, which marks a copy of the tree.

A plugin of pytest (-p ran). Processes that tests start belong to the test.
"""

from __future__ import annotations

import os
import signal
from typing import Any, Final

LONGEST: Final = 30
"""Seconds of computing after which a test fails: some are quick only where the law code is compiled."""
FILE: Final = os.environ["RAN_FILE"]
test = os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" (")[0]
seen: set[str] = set()


def ran(mark: str, of: str | None = None) -> None:
    """Tell once for each test that it runs a marked place; what runs as its module is loaded is of no test, ""."""
    if mark not in seen:
        seen.add(mark)
        tell(mark, test if of is None else of)


def tell(what: str, of: str) -> None:
    with open(FILE, "a") as file:  # noqa: PTH123  also within tests that change what a path does
        file.write(f"{what}\t{of}\n")


def pytest_runtest_logstart(nodeid: str) -> None:
    global test
    test = nodeid
    seen.clear()
    signal.signal(signal.SIGPROF, end)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)


def pytest_runtest_logfinish() -> None:
    signal.setitimer(signal.ITIMER_PROF, 0)


def pytest_runtest_logreport(report: Any) -> None:
    if report.when == "call" and report.passed:
        tell(str(report.duration), report.nodeid)


def end(*_: object) -> None:
    raise TimeoutError
