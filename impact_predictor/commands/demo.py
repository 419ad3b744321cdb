"""`impact-predictor demo`: tosses of a cube live on ROS topics, a crate on a deck and a robot, on one page.

The node and a player, which also records, run as processes of their own, in a ROS domain of their own.
"""

from __future__ import annotations

import sys
import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from ..errors import InputError
from .options import examples
from .simulate_deck import simulate_deck

if TYPE_CHECKING:
    from ..report.touchdowns import TouchdownRow

TOSSES: Final = 18
REMAPPING: Final = ("-r", "/cube/odom:=/odom", "-r", "/cube/contact_geometry:=/contact_geometry")

LISTED: Final = 8
"""Touchdowns that are listed."""

VOYAGE: Final = "--seed", "1", "--duration", "150", "--deck-rate", "50"
"""A sea that lifts the crate after two minutes, when the watch knows it."""

START: Final = 30.0
"""Seconds within which the processes must be there, on a machine that is busy."""

PROCESSING: Final = 0.5
"""Seconds that the node gets for what it has just received."""


@click.command(
    short_help="Tosses live on ROS topics, a crate on a deck, a robot: what is predicted.",
    epilog=examples("impact-predictor demo", "impact-predictor demo --tosses 5 -o /tmp/demo"),
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default="out/demo",
    show_default=True,
    help="Folder in which the page and the recorded predictions are written.",
)
@click.option(
    "--tosses",
    type=click.IntRange(min=1, max=285),
    help="Tosses to play of the 285 recorded, as many as take about half a minute unless given.",
)
def demo(output: Path, tosses: int | None) -> None:
    """Show in about a minute what is predicted, and what happened, on one page.

    Recorded tosses of a cube are played to a node on ROS topics, both processes of their own; ROS 2 must be installed.
    A crate on a deck in a simulated sea and the plan of a robot that walks are replayed.
    """
    from rich.console import Console

    from ..bags.replay import replay
    from ..files import make_folder
    from ..prediction.monitor import Monitor
    from ..prediction.scene import read_scenes
    from ..report.answers import as_json
    from ..report.page.demo import Shown, live_answer, write_demo_page
    from ..report.replay import CHOSEN, MEASURED_LATER, TWO_LINES, of_each_kind, sentences_of, touchdown_table
    from ..report.skill import skill_tables
    from ..report.summary import Tally
    from ..report.table import more, say, show, table_of
    from ..resources import find
    from .progress import compiling_is_said

    make_folder(output)
    tosses = tosses or TOSSES
    predictions, cargo, page = [output / name for name in ("predictions.mcap", "cargo.mcap", "demo.html")]
    scene, console = find("config/cube_tosses.yaml"), Console()
    with compiling_is_said():
        # What the node would compile while the player waits for it.
        Monitor(read_scenes(scene))
    play(find("examples/cube_tosses"), scene, tosses, predictions)
    rows = read_recording(predictions)
    console.print(f"{tosses} recorded tosses of a cube, played through ROS topics", style="bold")
    say(console, TWO_LINES)
    listed = of_each_kind(rows)[:LISTED]
    show(console, touchdown_table(listed))
    say(console, *more(len(rows) - len(listed), "touchdown", f"{CHOSEN}, {LISTED} at most"), MEASURED_LATER)
    for _, columns, scores in skill_tables(rows, {}):
        console.print()
        show(console, table_of(columns, scores))
    said = Tally(rows).sentences()
    say(console, "", *said, "")
    shown = [Shown(f"{tosses} tosses of a real cube, live on ROS topics", said, live_answer(rows))]
    console.print("A crate on a deck in a simulated sea, under watch", style="bold")
    simulate_deck.main([*VOYAGE, "-o", str(cargo)], standalone_mode=False)
    for title, bag, its_scene in (
        ("The watch over the crate, which learns the sea", cargo, "config/deck_crate.yaml"),
        ("A robot that walks: the recorded plan of HyQ", find("examples/hyq/hyq.bag"), "config/walker_hyq.yaml"),
    ):
        result = replay(bag, read_scenes(find(its_scene)))
        console.print(f"\n{title}", style="bold")
        say(console, *sentences_of(result))
        shown.append(Shown(title, sentences_of(result), as_json(result)))
    write_demo_page(page, *shown)
    console.print(f"\nPredictions: {predictions}\nPage: {page}", soft_wrap=True)


def play(bag: Path, scene: Path, tosses: int, output: Path) -> None:
    """Play the first tosses of a bag to the node, and record what it publishes; InputError where a process ended before
    its time, or did not start.
    """
    from ..bags.read import read_messages, topics
    from ..ros.player import PLAYED, PLAYING, timed
    from ..ros.processes import Child, ros_environment
    from .progress import progress

    seconds = sum(pause for pause, _ in timed(read_messages(bag, topics(bag)), tosses))
    environment = ros_environment()
    # What is recorded is read as strings.
    arguments = {
        "node": ("--ros-args", "--params-file", str(scene), "-p", "messages:=strings"),
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


def read_recording(path: Path) -> list[TouchdownRow]:
    """The touchdowns that the node has settled, with the cost that it reported next, as in its diagnostics; InputError
    where nothing can be read there.
    """
    from ..bags.read import read_messages
    from ..report.touchdowns import row_of_message
    from ..ros.messages import DIAGNOSTIC_ARRAY, decode_diagnostic_array
    from ..ros.player import NODE

    score = f"{NODE}/score"
    wanted = dict.fromkeys((score, "/diagnostics"), DIAGNOSTIC_ARRAY)
    rows: list[TouchdownRow] = []
    without_cost = 0
    for topic, _, data in read_messages(path, wanted):
        if topic == score:
            rows += [row_of_message("", one.values) for one in decode_diagnostic_array(data)]
            continue
        (message,) = decode_diagnostic_array(data)
        if "cost_us.update.median" in message.values:
            cost = float(message.values["cost_us.update.median"]) * 1e-6
            rows[without_cost:] = [row._replace(cost=cost) for row in rows[without_cost:]]
            without_cost = len(rows)
    return rows
