"""What the node costs beside a bare one that passes the same messages on.

    python benchmarks/bench_node.py [--seconds 4] [--repeats 5] [--executor both] [--only cost]

Publisher, bare node, predictor and listener are processes of their own, over real DDS. The bare node takes and sends
nav_msgs/Odometry as messages, as one writes it with rclpy; the predictor's `~/post_impact` is listened to, and its
/diagnostics. Both are fed in turn in one run, so that what else the machine does meets both. Costs are CPU time of all
threads of the node; latencies are from before the publisher's call to the listener's callback, of those samples that
announce a touchdown. What is not answered was dropped by the node or lost on its way.
"""

from __future__ import annotations

import json
import os
import pickle
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from typing import Final, NamedTuple

import click
from node_load import BARE, HALF, INPUTS, NODES, PREDICTOR, ROOT, SETTLING, Segment, Sent
from rich.console import Console
from rich.table import Table

from impact_predictor.ros.processes import Child, ros_environment

LOAD: Final = str(Path(__file__).with_name("node_load.py"))
PARAMETERS: Final = str(ROOT / "config/cube_tosses.yaml")
POINTS: Final = [x for a in (-HALF, HALF) for b in (-HALF, HALF) for c in (-HALF, HALF) for x in (a, b, c)]
RATE: Final = 500.0
RATES: Final = (500.0, 1000.0, 1250.0, 1500.0, 2000.0)
RATE_SECONDS: Final = 2.0
TWICE: Final = 2
SCENES: Final = {"tosses": "cube tosses", "rest": "a body at rest"}
STARTS: Final = 15


class Figures(NamedTuple):
    """Of one segment: CPU time for each sample and median latency in us, samples that were not served, Hz reached."""

    cost: float
    latency: float
    lost: int
    reached: float


def run(executor: str, scene: str, segments: list[Segment]) -> tuple[list[Sent], list[Figures]]:
    """Send segments to both nodes."""
    environment = ros_environment()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        sent_file, heard_file = (str(Path(folder) / name) for name in ("sent", "heard"))

        def start(name: str, *arguments: str) -> Child:
            return stack.enter_context(Child(name, environment, *arguments))

        listener = start("listener", LOAD, "listen", heard_file)
        bare = start("bare node", LOAD, "bare", executor)
        node = start("predictor", *node_arguments(executor))
        processes = f"{bare.process_id},{node.process_id}"
        publisher = start("publisher", LOAD, "publish", sent_file, scene, processes, json.dumps(segments))
        while not publisher.ended:
            time.sleep(0.1)
            for one in (listener, bare, node):
                one.check()
        publisher.end()
        listener.end()
        sent = [Sent(*one) for one in pickle.loads(Path(sent_file).read_bytes())]
        heard, reports = pickle.loads(Path(heard_file).read_bytes())
    return sent, [figures(one, heard[one.node], reports) for one in sent]


def node_arguments(executor: str) -> tuple[str, ...]:
    """How the predictor is started."""
    given = {"executor": executor, "body.contact_points": POINTS}
    words = [word for name, value in given.items() for word in ("-p", f"{name}:={value}")]
    return "-m", "impact_predictor.ros.node", "--ros-args", "--params-file", PARAMETERS, *words


def figures(sent: Sent, heard: list[tuple[float, int]], reports: list[tuple[int, dict[str, str]]]) -> Figures:
    """What became of one segment."""
    answered = [(begin, end) for begin, end in heard if sent.begin <= begin <= sent.end]
    served = len(answered)
    if sent.node == PREDICTOR:
        served = accepted(reports, sent.end + int(SETTLING * 1e9)) - accepted(reports, sent.begin)
    latency = median([end - begin for begin, end in answered]) * 1e-3 if answered else float("nan")
    reached = sent.samples / (sent.end - sent.begin) * 1e9
    return Figures(sent.cpu / sent.samples * 1e6, latency, sent.samples - served, reached)


def accepted(reports: list[tuple[int, dict[str, str]]], when: int) -> int:
    """How many samples the predictor had accepted, by its last report until then."""
    return max((int(values["samples.accepted"]) for told, values in reports if told <= when), default=0)


def costs(executor: str, scene: str, seconds: float, repeats: int) -> list[str]:
    """A row: CPU time and latency of both nodes, medians over the repetitions, and of their ratios and differences."""
    turns = [Segment(name, RATE, seconds) for _ in range(repeats + 1) for name in NODES]
    found = run(executor, scene, turns)[1][len(NODES) :]  # the first of each finds caches empty
    bare, node = found[::2], found[1::2]
    ratio = median(ours.cost / theirs.cost for ours, theirs in zip(node, bare, strict=True))
    added = median(ours.latency - theirs.latency for ours, theirs in zip(node, bare, strict=True))
    return [
        executor,
        SCENES[scene],
        f"{median(one.cost for one in bare):.0f}",
        f"{median(one.cost for one in node):.0f}",
        f"{ratio:.2f}",
        f"{median(one.latency for one in bare):.0f}",
        f"{median(one.latency for one in node):.0f}" if scene == "tosses" else "-",
        f"{added:+.0f}" if scene == "tosses" else "-",
        str(sum(one.lost for one in node)),
    ]


def rates(executor: str, scene: str) -> list[list[str]]:
    """A row for each rate: samples that each node has lost."""
    turns = [Segment(name, rate, RATE_SECONDS) for rate in RATES for _ in range(TWICE) for name in NODES]
    _, found = run(executor, scene, [Segment(name, RATE, 1.0) for name in NODES] + turns)
    rows = []
    for k, rate in enumerate(RATES):
        some = found[len(NODES) * (1 + TWICE * k) :][: len(NODES) * TWICE]
        bare, node = (" + ".join(str(one.lost) for one in some[n :: len(NODES)]) for n in range(len(NODES)))
        rows.append([executor, f"{rate:.0f}", f"{median(one.reached for one in some):.0f}", bare, node])
    return rows


def starts() -> list[str]:
    """A row: seconds until a subscription is found by others, bare and predictor in turn, and the ratio.

    The fastest of each: now and then DDS waits for its next announcement, which adds up to three seconds to any.
    """
    environment = ros_environment()
    os.environ |= environment
    import rclpy
    from nav_msgs.msg import Odometry

    # With bytecode, as pip installs it and the first start of a clone leaves it behind, whatever this shell says of it.
    folder = tempfile.mkdtemp()
    environment = {**environment, "PYTHONPYCACHEPREFIX": folder}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    rclpy.init()
    node = rclpy.create_node("observer")
    publishers = {name: node.create_publisher(Odometry, topic, 1) for name, topic in INPUTS.items()}
    programs = {BARE: (LOAD, BARE, "single"), PREDICTOR: node_arguments("single")}
    took: dict[str, list[float]] = {name: [] for name in NODES}
    for _ in range(STARTS + 1):
        for name in NODES:
            began = time.monotonic()
            with Child(name, environment, *programs[name]) as child:
                while not publishers[name].get_subscription_count():
                    child.check()
                    time.sleep(0.001)
                took[name].append(time.monotonic() - began)
            while publishers[name].get_subscription_count():
                time.sleep(0.01)
    node.destroy_node()
    rclpy.shutdown()
    bare, ours = (min(took[name][1:]) for name in NODES)
    return [f"{bare:.2f}", f"{ours:.2f}", f"{ours / bare:.2f}"]


@click.command()
@click.option("--seconds", default=4.0, help="Of each segment.")
@click.option("--repeats", default=5)
@click.option("--executor", type=click.Choice(["both", "single", "events"]), default="both")
@click.option("--only", type=click.Choice(["cost", "rate", "start"]), default=None)
def main(seconds: float, repeats: int, executor: str, only: str | None) -> None:
    """Print the tables."""
    console = Console(width=110)
    kinds = ("single", "events") if executor == "both" else (executor,)
    if only in (None, "cost"):
        columns = "executor", "scene", "bare us", "node us", "ratio", "bare latency us", "node", "added", "lost"
        table = Table(*columns, title=f"CPU time for each sample and median latency, {RATE:.0f} Hz")
        for kind in kinds:
            for scene in SCENES:
                table.add_row(*costs(kind, scene, seconds, repeats))
        console.print(table)
    if only in (None, "rate"):
        title = f"Samples not answered, cube tosses, twice {RATE_SECONDS:g} s"
        table = Table("executor", "Hz", "sent at", "bare node", "predictor", title=title)
        for kind in kinds:
            for row in rates(kind, "tosses"):
                table.add_row(*row)
        console.print(table)
    if only in (None, "start"):
        table = Table(
            "bare s", "node s", "ratio", title=f"Start until others find the subscription, fastest of {STARTS}"
        )
        table.add_row(*starts())
        console.print(table)


if __name__ == "__main__":
    main()
