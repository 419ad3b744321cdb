"""The demonstration: recorded tosses of a cube through real ROS topics, and what was predicted of their touchdowns.

The node and a player, which also records, run as processes of their own, in a ROS domain of their own.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from math import hypot
from pathlib import Path
from typing import Final, NamedTuple

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from .bags.read import read_messages, topics
from .errors import InputError
from .report.figures import write_touchdowns
from .report.replay import lead_time_table, touchdown_table
from .report.summary import LEAD_TIME_EDGES, SpanErrors, Tally, errors_ahead
from .report.table import show
from .report.touchdowns import TouchdownRow, row_of_message
from .resources import find
from .ros.messages import DIAGNOSTIC_ARRAY, Diagnostic, decode_diagnostic_array
from .ros.player import NODE, PLAYED, PLAYING, RECORDED, timed
from .ros.processes import Child, ros_environment

BAG: Final = "examples/cube_tosses"
SCENE: Final = "config/cube_tosses.yaml"
TOSSES: Final = 18
REMAPPING: Final = ("-r", "/cube/odom:=/odom", "-r", "/cube/contact_geometry:=/contact_geometry")

START: Final = 30.0
"""Seconds within which the processes must be there, on a machine that is busy."""

PROCESSING: Final = 0.5
"""Seconds that the node gets for what it has just received."""


class Recording(NamedTuple):
    """What was recorded: settled touchdowns, and the errors of the predictions of the scored ones by lead time."""

    rows: list[TouchdownRow]
    lead_time_errors: Sequence[SpanErrors]


def run_demo(output: Path = Path("out/demo"), tosses: int = TOSSES) -> int:
    """Play the first tosses, print the table of touchdowns, and write predictions and a picture; the exit status.

    Raises:
        InputError: something is not installed, a process ended before its time, or the output cannot be written.
    """
    bag, scene = find(BAG), find(SCENE)
    predictions, picture = output / "predictions.mcap", output / "touchdowns.png"
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"the folder {output} cannot be made: {error.strerror}") from error
    play(bag, scene, tosses, predictions)
    recording = read_recording(predictions)
    console = Console()
    scored = [row for row in recording.rows if row.scored]
    console.print(f"{tosses} recorded tosses of a cube, played through ROS topics", style="bold")
    show(console, touchdown_table(scored))
    console.print()
    show(console, lead_time_table(recording.lead_time_errors))
    console.print()
    for sentence in Tally(recording.rows).sentences():
        console.print(sentence, soft_wrap=True)
    write_touchdowns(
        picture, recording.rows, recording.lead_time_errors, f"{tosses} tosses of a cube, live on ROS topics"
    )
    console.print(f"Predictions: {predictions}\nPicture: {picture}", soft_wrap=True)
    return 0


def play(bag: Path, scene: Path, tosses: int, output: Path) -> None:
    """Play the first tosses of a bag to the node, and record what it publishes.

    Raises:
        InputError: a process ended before its time, or did not start.
    """
    pauses = [pause for pause, _ in timed(read_messages(bag, topics(bag)), tosses)]
    environment = ros_environment()
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as progress, ExitStack() as children:
        task = progress.add_task("starting player and predictor", total=None)
        if not console.is_terminal:
            console.print(f"playing {tosses} tosses through ROS topics: about {sum(pauses) + 10.0:.0f} s")

        def start(name: str, *arguments: str) -> Child:
            child = Child(name, environment, "-m", f"impact_predictor.ros.{name}", *arguments)
            return children.enter_context(child)

        def wait(until: Callable[[], bool], running: list[Child], seconds: float, what: str) -> None:
            patience = time.monotonic() + seconds
            while not until():
                for child in running:
                    child.check()
                if time.monotonic() > patience:
                    raise InputError(f"{what} did not happen within {seconds:.0f} s; is the machine overloaded?")
                time.sleep(0.05)

        node = start("node", "--ros-args", "--params-file", str(scene))
        options = ("--runs", str(tosses), "--record", str(output))
        player = start("player", str(bag), *options, "--ros-args", *REMAPPING)
        wait(lambda: PLAYING in player.said(), [player, node], START, "the connection of player and node")
        progress.update(task, description=f"playing {tosses} tosses", total=sum(pauses))
        began = time.monotonic()

        def played() -> bool:
            progress.update(task, completed=time.monotonic() - began)
            return PLAYED in player.said()

        wait(played, [player, node], 3.0 * sum(pauses) + START, "the end of the recorded tosses")
        time.sleep(PROCESSING)
        # The last scores come at the end of the node, so the player, which records them, ends after it.
        node.end()
        player.end()


def read_recording(path: Path) -> Recording:
    """The touchdowns that the node has settled, with the cost that it reported next, as in its diagnostics.

    Raises:
        InputError: nothing can be read there.
    """
    wanted = {topic: kind for topic, kind in RECORDED.items() if kind == DIAGNOSTIC_ARRAY}
    rows: list[TouchdownRow] = []
    predictions: list[Diagnostic] = []
    errors: list[tuple[float, float]] = []
    without_cost = 0
    for topic, _, data in read_messages(path, wanted):
        (message,) = decode_diagnostic_array(data)
        if topic == f"{NODE}/prediction":
            predictions.append(message)
        elif topic == f"{NODE}/score":
            row = row_of_message("", message.values)
            rows.append(row)
            errors += _errors(row, predictions)
        elif "cost_us.update.median" in message.values:
            cost = float(message.values["cost_us.update.median"]) * 1e-6
            rows[without_cost:] = [row._replace(cost=cost) for row in rows[without_cost:]]
            without_cost = len(rows)
    return Recording(rows, errors_ahead(errors))


def _errors(row: TouchdownRow, predictions: list[Diagnostic]) -> list[tuple[float, float]]:
    """Lead time (s) and relative error of every prediction of a scored touchdown that named the same contacts."""
    earlier = [one.values for one in predictions if int(one.values["stamp"]) <= row.stamp]
    if not row.scored or row.measured_twist is None or not earlier or "old" not in earlier[-1]:
        return []
    scale = hypot(row.before_twist.vx, row.before_twist.omega * row.half_distance)
    found = []
    for values in reversed(earlier):
        lead_time = (row.stamp - int(values["stamp"])) * 1e-9
        if lead_time >= LEAD_TIME_EDGES[-1] or "old" not in values:
            break
        if (values["old"], values["new"]) == (earlier[-1]["old"], earlier[-1]["new"]):
            dvx = float(values["after.vx"]) - row.measured_twist.vx
            domega = float(values["after.omega"]) - row.measured_twist.omega
            found.append((lead_time, hypot(dvx, domega * row.half_distance) / scale))
    return found
