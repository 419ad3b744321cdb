"""How a fleet scales: from one worker to two, and in memory from 10 bags to 1,000.

    python benchmarks/bench_fleet.py

Replays copies of one excerpt of the cube tosses (hard links in a temporary folder) into the Parquet table and the
page, as `impact-predictor replay --workers N --table ... --report ...` does. Prints bags per second after the workers
have started and have replayed a bag each, the ratio of two workers to one in the same run, and the peak of resident
memory of the process that collects and makes the page, and of its workers. Needs the extra `fleet`; runs for about two
minutes.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Final, NamedTuple

from rich.console import Console
from rich.table import Table

from impact_predictor import read_scenes
from impact_predictor.bags.read import read_messages
from impact_predictor.bags.write import BagWriter
from impact_predictor.fleet.cluster import Fleet, connected
from impact_predictor.fleet.job import Job
from impact_predictor.report.tables import TOUCHDOWNS, table_file, touchdown_rows
from impact_predictor.resources import find
from impact_predictor.ros.messages import ODOMETRY, POLYGON

TOPICS: Final = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
TOSS: Final = 15_000_000_000
"""Log time in ns that ends the excerpt, the first toss: so short that what a fleet adds to a bag shows."""

SCALING: Final = 100
FEW: Final = 10
MANY: Final = 1000
GROWTH: Final = 1.15
"""Memory for 1,000 bags against that for 10."""


def main() -> int:
    job = Job(read_scenes(str(find("config/cube_tosses.yaml"))), {}, answers=True)
    columns = ("bags", "workers", "bags/s", "collector MB", "largest worker MB", "page s", "page MB")
    table = Table(*columns, title="Peaks of resident memory; the page is made after the bags", title_justify="left")
    with tempfile.TemporaryDirectory() as name:
        bags = links(Path(name))
        # The smallest first: the peak of a process never falls.
        runs = [(FEW, 2), (SCALING, 1), (SCALING, 2), (MANY, 2)]
        measured = {run: measure(job, bags[: run[0]], run[1], Path(name)) for run in runs}
    for (count, workers), one in measured.items():
        table.add_row(f"{count:,}", str(workers), f"{one.rate:.1f}", *(f"{number:.1f}" for number in one[1:]))
    Console().print(table)
    few, many = measured[FEW, 2], measured[MANY, 2]
    scaling = measured[SCALING, 2].rate / measured[SCALING, 1].rate
    growth = many.collector / few.collector, many.worker / few.worker
    print(f"2 workers against 1: {scaling:.2f} times the bags per second, on {os.cpu_count()} cores")
    print(f"1,000 bags against 10: {growth[0]:.2f} times the memory of the collector, {growth[1]:.2f} of a worker")
    return int(max(growth) > GROWTH)


def links(folder: Path) -> list[str]:
    """An excerpt of the cube tosses under many names."""
    excerpt = folder / "excerpt.mcap"
    with BagWriter(excerpt) as writer:
        for topic, log_time, data in read_messages(find("examples/cube_tosses/cube_tosses.mcap"), TOPICS):
            if log_time > TOSS:
                break
            writer.write(topic, TOPICS[topic], log_time, data)
    bags = [folder / f"run_{number:04}.mcap" for number in range(MANY)]
    for bag in bags:
        bag.hardlink_to(excerpt)
    return list(map(str, bags))


class Measured(NamedTuple):
    """Bags per second, the peaks of resident memory in MB of this process and of the largest worker, and the s and the
    MB of the page.
    """

    rate: float
    collector: float
    worker: float
    page: float
    size: float


def measure(job: Job, bags: Sequence[str], workers: int, folder: Path) -> Measured:
    """Replay some bags."""
    answers = []
    with connected(workers) as client, table_file(folder / "table.parquet", TOUCHDOWNS) as table:
        # What is loaded and compiled once is no part of the rate.
        for _ in Fleet(client, job, bags[: 2 * workers], [None] * 2 * workers).outcomes(lambda _: None):
            pass
        begin = perf_counter()
        for outcome in Fleet(client, job, bags, [None] * len(bags)).outcomes(lambda _: None):
            assert outcome.result is not None, outcome.error
            table.add(touchdown_rows(outcome.answer))
            answers.append(outcome.answer)
        rate = len(bags) / (perf_counter() - begin)
        worker = max(client.run(peak).values())
    # Here, because the workers import what stands at the head of this file.
    from impact_predictor.report.page.replay import write_replay_page

    begin = perf_counter()
    page = folder / "replay.html"
    write_replay_page(page, answers)
    return Measured(rate, peak(), worker, perf_counter() - begin, page.stat().st_size * 1e-6)


def peak() -> float:
    """The peak of resident memory of this process in MB; that of `getrusage` would begin with that of its parent."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith("VmHWM:")) / 1024.0


if __name__ == "__main__":
    sys.exit(main())
