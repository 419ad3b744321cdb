"""What every test run shares: quick tests first, and ROS graphs that do not see each other."""

import os

import pytest
from hypothesis import settings

from impact_predictor.ros.processes import is_free

# The same draws on every machine, so that a change is judged by what it changes. New ones are drawn by
# `make test ARGS=--hypothesis-profile=search`.
settings.register_profile("search")
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")

LONGEST = "test_heavy_sea.py"


def pytest_configure() -> None:
    """Give each worker of a parallel run a ROS domain of its own, before anything imports rclpy."""
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    # Domains up to 101 keep clear of the ports that Linux hands to ordinary sockets; up to eight workers try others.
    domains = [1 + (os.getppid() + worker + k) % 101 for k in range(0, 96, 8)]
    os.environ["ROS_DOMAIN_ID"] = str(next(filter(is_free, domains), domains[0]))
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    # The longest one comes first of the slow ones, so that no worker of a parallel run waits for it at the end.
    items.sort(key=lambda item: (item.get_closest_marker("slow") is not None, item.path.name != LONGEST))
