"""`impact-predictor demo`: recorded tosses of a cube through real ROS topics, and what was predicted of them.

The node and a player, which also records, run as processes of their own, in a ROS domain of their own.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import click

from ..errors import InputError
from .options import examples

if TYPE_CHECKING:
    from ..report.summary import SpanErrors
    from ..report.touchdowns import TouchdownRow
    from ..ros.messages import Diagnostic

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


@click.command(
    short_help="Play recorded tosses through ROS topics and show the predictions.",
    epilog=examples(
        "impact-predictor demo",
        "impact-predictor demo --tosses 5 -o /tmp/tosses",
    ),
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default="out/demo",
    show_default=True,
    help="Folder in which predictions and a picture are written.",
)
@click.option(
    "--tosses",
    type=click.IntRange(min=1, max=285),
    help="Tosses to play of the 285 recorded, as many as take about half a minute unless given.",
)
def demo(output: Path, tosses: int | None) -> None:
    """Play recorded tosses of a cube through ROS topics, and show what was predicted and what happened.

    The node and a player, which also records, run as processes of their own; ROS 2 must be installed.
    """
    from rich.console import Console

    from ..files import make_folder
    from ..parameters.file import read_parameters
    from ..parameters.validation import validate
    from ..prediction.monitor import Monitor
    from ..prediction.scene import scenes_of
    from ..report.figures import write_touchdowns
    from ..report.replay import lead_time_table, of_each_kind, touchdown_table
    from ..report.summary import Tally
    from ..report.table import show
    from ..resources import find
    from .progress import compiling_is_said

    make_folder(output)
    tosses, predictions, picture = tosses or TOSSES, output / "predictions.mcap", output / "touchdowns.png"
    scene = find("config/cube_tosses.yaml")
    with compiling_is_said():
        # What the node would compile while the player waits for it.
        Monitor(scenes_of(validate(read_parameters(scene))))
    play(find("examples/cube_tosses"), scene, tosses, predictions)
    rows, errors = read_recording(predictions)
    console = Console()
    console.print(f"{tosses} recorded tosses of a cube, played through ROS topics", style="bold")
    show(console, touchdown_table(of_each_kind(rows)))
    console.print()
    show(console, lead_time_table(errors))
    console.print()
    for sentence in Tally(rows).sentences():
        console.print(sentence, soft_wrap=True)
    write_touchdowns(picture, rows, errors, f"{tosses} tosses of a cube, live on ROS topics")
    console.print(f"Predictions: {predictions}\nPicture: {picture}", soft_wrap=True)


def play(bag: Path, scene: Path, tosses: int, output: Path) -> None:
    """Play the first tosses of a bag to the node, and record what it publishes.

    Raises:
        InputError: a process ended before its time, or did not start.
    """
    from ..bags.read import read_messages, topics
    from ..ros.player import PLAYED, PLAYING, timed
    from ..ros.processes import Child, ros_environment
    from .progress import progress

    seconds = sum(pause for pause, _ in timed(read_messages(bag, topics(bag)), tosses))
    environment = ros_environment()
    arguments = {
        "node": ("--ros-args", "--params-file", str(scene)),
        "player": (str(bag), "--runs", str(tosses), "--record", str(output), "--ros-args", *REMAPPING),
    }
    if not sys.stderr.isatty():
        click.echo(f"playing {tosses} tosses through ROS topics: about {seconds + 10.0:.0f} s", err=True)
    with progress(f"playing {tosses} tosses", "s", round(seconds)) as tell, ExitStack() as children:
        node, player = (
            children.enter_context(Child(name, environment, "-m", f"impact_predictor.ros.{name}", *given))
            for name, given in arguments.items()
        )

        def wait(mark: str, most: float, what: str) -> None:
            began = time.monotonic()
            while mark not in player.said():
                for child in (player, node):
                    child.check()
                elapsed = time.monotonic() - began
                if elapsed > most:
                    raise InputError(f"{what} did not happen within {most:.0f} s; is the machine overloaded?")
                tell(round(elapsed) if mark == PLAYED else 0)
                time.sleep(0.05)

        wait(PLAYING, START, "the connection of player and node")
        wait(PLAYED, 3.0 * seconds + START, "the end of the recorded tosses")
        time.sleep(PROCESSING)
        # The last scores come at the end of the node, so the player, which records them, ends after it.
        node.end()
        player.end()


def read_recording(path: Path) -> Recording:
    """The touchdowns that the node has settled, with the cost that it reported next, as in its diagnostics.

    Raises:
        InputError: nothing can be read there.
    """
    from ..bags.read import read_messages
    from ..report.summary import errors_ahead
    from ..report.touchdowns import row_of_message
    from ..ros.messages import DIAGNOSTIC_ARRAY, decode_diagnostic_array
    from ..ros.player import NODE, RECORDED

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
    from ..report.summary import LEAD_TIME_EDGES

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
