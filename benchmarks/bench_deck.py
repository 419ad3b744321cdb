"""What a deck full of cargo costs the node: its share of a core, latency, losses, start-up and memory.

    python benchmarks/bench_deck.py [--bodies 50] [--rate 20] [--deck-rate 100] [--seconds 10] [--highest]

The node is a process of its own, fed by another that publishes prepared messages, and heard by a third. With --highest
the rate is raised until messages are lost or late, with either executor.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from bisect import bisect_right
from functools import partial
from pathlib import Path
from statistics import median
from typing import Final, NamedTuple

import click
from deck_load import HALF, READY, name_of, place_of
from forms import in_both_forms
from node_load import cpu_time, resident
from rich.console import Console
from rich.table import Table

from impact_predictor.ros.processes import Child, ros_environment

LOAD: Final = str(Path(__file__).with_name("deck_load.py"))
SETTLING: Final = 2.0
"""Seconds of messages before the measurement begins."""
LATE: Final = 0.05
"""Seconds of latency (99 of 100 below) beyond which a rate counts as too high."""
STEP: Final = 1.25


class Measured(NamedTuple):
    """Cores that the node took, and its time of a processor for a message in s; latency in s of the median, and of 99
    in 100; messages; s until it listens; MB.
    """

    cores: float
    each: float
    latency: float
    late: float
    sent: int
    lost: int
    start: float
    memory: float


def scene(bodies: int) -> str:
    """The parameters of crates on a moving deck."""
    points = [part for x in (-HALF, HALF) for y in (-HALF, HALF) for z in (0.0, 1.0) for part in (x, y, z)]
    common = f"""
        bodies: [{", ".join(map(name_of, range(bodies)))}]
        body.mass: 80.0
        body.inertia: [9.1, 9.1, 4.8, 0.0, 0.0, 0.0]
        body.center_of_mass: [0.0, 0.0, 0.5]
        body.contact_points: {points}
        contact.friction: 0.6
        support.motion: odom
        support.frame: deck
        onset.watch: true
"""
    places = [f"        {name_of(k)}.place.position: {list(place_of(k))}\n" for k in range(bodies)]
    return "/**:\n    ros__parameters:" + common + "".join(places)


def measure(executor: str, bodies: int, rate: float, deck_rate: float, seconds: float) -> Measured:
    """One run of the node."""
    environment = ros_environment()
    with tempfile.TemporaryDirectory() as folder:
        sent_file, heard_file, parameters = (Path(folder) / name for name in ("sent.json", "heard.json", "scene.yaml"))
        parameters.write_text(scene(bodies))
        numbers = [str(number) for number in (bodies, rate, deck_rate, seconds + SETTLING)]
        publisher = Child("publisher", environment, LOAD, "publish", str(sent_file), *numbers)
        listener = Child("listener", environment, LOAD, "listen", str(heard_file), str(bodies))
        ros = "--ros-args", "--params-file", str(parameters), "-p", f"executor:={executor}"
        node = Child("node", environment, "-m", "impact_predictor.ros.node", *ros)
        with publisher, listener:
            time.sleep(3.0)  # they load, and prepare their messages
            began = time.monotonic()
            with node:
                while READY not in publisher.said():
                    publisher.check()
                    node.check()
                    time.sleep(0.01)
                start = time.monotonic() - began
                time.sleep(SETTLING + 1.0)
                cpu, clock = cpu_time(node.process_id), time.time_ns()
                time.sleep(seconds - 1.0)
                now = time.time_ns()
                taken, window = cpu_time(node.process_id) - cpu, (now - clock) * 1e-9
                size = resident(node.process_id)
                while not publisher.ended:
                    node.check()
                    time.sleep(0.05)
                publisher.end()
                time.sleep(0.5)
                listener.end()
                node.end()
                complaint = node.complained()
        sent, heard = json.loads(sent_file.read_text()), json.loads(heard_file.read_text())
    if complaint:
        print(complaint[:2000], file=sys.stderr)
    latencies = sorted(
        late - sent[body][bisect_right(sent[body], late) - 1]
        for body, times in heard["modes"].items()
        for late in times
    )
    expected = sum(len(sent[body]) for body in heard["modes"])
    if not latencies:
        raise click.ClickException("no mode was heard")
    late = latencies[len(latencies) * 99 // 100] * 1e-9
    lost = expected - len(latencies)
    # What is dropped costs next to nothing.
    served = sum(clock <= when < now for times in sent.values() for when in times) * (1.0 - lost / expected)
    return Measured(taken / window, taken / served, median(latencies) * 1e-9, late, expected, lost, start, size)


def row(*values: str | float) -> list[str]:
    return [value if isinstance(value, str) else f"{value:g}" for value in values]


@click.command()
@click.option("--bodies", default=50)
@click.option("--rate", default=20.0, help="Hz of each body.")
@click.option("--deck-rate", default=100.0, help="Hz of the deck.")
@click.option("--seconds", default=10.0)
@click.option("--executor", type=click.Choice(["both", "single", "events"]), default="both")
@click.option("--highest", is_flag=True, help="Raise the rate until messages are lost or late.")
def main(bodies: int, rate: float, deck_rate: float, seconds: float, executor: str, highest: bool) -> None:
    """Print the table."""
    columns = "executor", "Hz", "cores", "us each", "median ms", "99 % ms", "lost", "of", "start s", "MB"
    table = Table(*columns, title=f"{bodies} bodies on a deck at {deck_rate:g} Hz", min_width=70)
    for kind in ("single", "events") if executor == "both" else (executor,):
        hertz = rate
        while True:
            found = measure(kind, bodies, hertz, deck_rate, seconds)
            table.add_row(
                kind,
                f"{hertz:.0f}",
                f"{found.cores:.2f}",
                f"{1e6 * found.each:.0f}",
                f"{1e3 * found.latency:.2f}",
                f"{1e3 * found.late:.2f}",
                str(found.lost),
                str(found.sent),
                f"{found.start:.2f}",
                f"{found.memory:.0f}",
            )
            if not highest or found.lost or found.late > LATE:
                break
            hertz *= STEP
    Console().print(table)


if __name__ == "__main__":
    sys.exit(in_both_forms(partial(main, standalone_mode=False)))
